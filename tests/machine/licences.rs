//! Licences of all dependencies, from their manifests.

use std::process::Command;

use serde_json::Value;

/// Licences under which this program may be passed on as it is: permissive ones. A file under the Mozilla licence stays
/// under it, which asks nothing of the rest.
const ALLOWED: [&str; 14] = [
    "MIT",
    "MIT-0",
    "Apache-2.0",
    "Apache-2.0 WITH LLVM-exception",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "BSL-1.0",
    "CC0-1.0",
    "0BSD",
    "ISC",
    "MPL-2.0",
    "Unicode-3.0",
    "Unlicense",
    "Zlib",
];

/// Whether an SPDX expression can be met by allowed licences: all of those joined by AND, one of those joined by OR. The
/// old `A/B` is `A OR B`.
fn is_allowed(expression: &str) -> bool {
    let spaced = expression.replace('(', " ( ").replace(')', " ) ").replace('/', " OR ");
    let words: Vec<&str> = spaced.split_whitespace().collect();
    let mut at = 0;
    let allowed = any(&words, &mut at);
    allowed && at == words.len()
}

fn any(words: &[&str], at: &mut usize) -> bool {
    let mut allowed = all(words, at);
    while words.get(*at) == Some(&"OR") {
        *at += 1;
        allowed |= all(words, at);
    }
    allowed
}

fn all(words: &[&str], at: &mut usize) -> bool {
    let mut allowed = one(words, at);
    while words.get(*at) == Some(&"AND") {
        *at += 1;
        allowed &= one(words, at);
    }
    allowed
}

fn one(words: &[&str], at: &mut usize) -> bool {
    let Some(&word) = words.get(*at) else { return false };
    *at += 1;
    if word == "(" {
        let allowed = any(words, at);
        let closed = words.get(*at) == Some(&")");
        *at += 1;
        return allowed && closed;
    }
    if words.get(*at) == Some(&"WITH") {
        let exception = words.get(*at + 1).copied().unwrap_or_default();
        *at += 2;
        return ALLOWED.contains(&&*format!("{word} WITH {exception}")) || ALLOWED.contains(&word);
    }
    ALLOWED.contains(&word)
}

/// Packages whose licence is not allowed, or not stated.
fn forbidden(metadata: &Value) -> Vec<String> {
    let packages = metadata["packages"].as_array().expect("a list of packages");
    let refused = |package: &&Value| !package["license"].as_str().is_some_and(is_allowed);
    let named = |package: &Value| {
        format!("{} {}: {}", package["name"], package["version"], package["license"])
    };
    packages.iter().filter(refused).map(named).collect()
}

/// Manifests as cargo has them. Where the crates of other systems were never fetched, those of this one are all there is.
fn metadata() -> Value {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let ask = |platform: &[&str]| {
        let mut command = Command::new(&cargo);
        command.args(["metadata", "--format-version", "1", "--locked"]);
        command.args(platform).current_dir(env!("CARGO_MANIFEST_DIR"));
        command.output().expect("cargo")
    };
    let mut output = ask(&["--offline"]);
    if !output.status.success() {
        let version = Command::new("rustc").arg("-vV").output().expect("rustc");
        let text = String::from_utf8_lossy(&version.stdout).into_owned();
        let host = text.lines().find_map(|line| line.strip_prefix("host: ")).expect("a host");
        output = ask(&["--filter-platform", host]);
    }
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("JSON")
}

#[test]
fn every_dependency_has_a_licence_that_is_allowed() {
    let metadata = metadata();
    let found = forbidden(&metadata);
    assert!(found.is_empty(), "{}", found.join("\n"));
    let packages = metadata["packages"].as_array().map_or(0, Vec::len);
    println!("{packages} packages, licences allowed");
    assert!(packages > 50, "{packages} packages");
    // A licence that is not on the list, one of two that both bind, and none at all.
    for licence in ["\"GPL-3.0-only\"", "\"MIT AND AGPL-3.0-only\"", "null"] {
        let mut seeded = metadata.clone();
        seeded["packages"][7]["license"] = serde_json::from_str(licence).expect("JSON");
        assert_eq!(forbidden(&seeded).len(), 1, "{licence}");
    }
}

#[test]
fn expressions_are_read_as_spdx_means_them() {
    for allowed in [
        "MIT",
        "MIT OR Apache-2.0",
        "MIT/Apache-2.0",
        "GPL-2.0 OR MIT",
        "(MIT OR Apache-2.0) AND Unicode-3.0",
        "Apache-2.0 WITH LLVM-exception OR GPL-2.0",
    ] {
        assert!(is_allowed(allowed), "{allowed}");
    }
    for refused in [
        "",
        "GPL-3.0-only",
        "MIT AND GPL-2.0",
        "(MIT OR Apache-2.0) AND SSPL-1.0",
        "(MIT",
        "MIT Apache-2.0",
        "mit",
        "LGPL-2.1 WITH MIT",
    ] {
        assert!(!is_allowed(refused), "{refused}");
    }
}
