//! Source: the files that a release is made of.
//! Goal: what is released together says one version and oldest compiler; the container file builds what
//!   is there. No container was ever built here: its text is what can be checked.
//! Data: manifests, the action, files for CI, CHANGELOG.md, docs/ci/Dockerfile.

use crate::program::repository as read;

/// What follows `before` in the lines that begin with it, up to a character that no version has.
fn after<'a>(text: &'a str, before: &str) -> Vec<&'a str> {
    let rests = text.match_indices(before).map(|(at, _)| &text[at + before.len()..]);
    let ends = |c: char| !(c.is_ascii_digit() || c == '.');
    rests.map(|rest| rest.split(ends).next().unwrap_or("")).collect()
}

/// File, words before a version there, and how many there are at least.
const VERSIONS: [(&str, &str, usize); 6] = [
    ("Cargo.toml", "\nversion = \"", 1),
    ("Cargo.toml", "path = \"crates/", 0),
    ("CITATION.cff", "\nversion: ", 1),
    (".github/actions/gate/action.yml", "default: gronwall==", 1),
    ("docs/ci/github.yml", "gate@v", 1),
    ("docs/ci/gitlab.yml", "gronwall==", 1),
];

/// What does not say `version`. The released part of the changelog begins with it, once something is released.
fn others(version: &str, read: impl Fn(&str) -> String) -> Vec<String> {
    let mut wrong = Vec::new();
    for (file, before, least) in VERSIONS {
        let text = read(file);
        let found = match before.ends_with('/') {
            true => {
                let lines = text.lines().filter(|line| line.contains(before));
                lines.flat_map(|line| after(line, "version = \"")).collect()
            }
            false => after(&text, before),
        };
        if found.len() < least || found.iter().any(|found| *found != version) {
            wrong.push(format!("{file}: {before:?} {found:?}"));
        }
    }
    let changes = read("CHANGELOG.md");
    let mut headings = changes.lines().filter_map(|line| line.strip_prefix("## ["));
    let unreleased = headings.next().is_some_and(|heading| heading.starts_with("Unreleased]"));
    let released =
        headings.next().is_none_or(|heading| heading.starts_with(&format!("{version}]")));
    if !unreleased || !released {
        wrong.push("CHANGELOG.md".to_owned());
    }
    wrong
}

#[test]
fn versions_agree() {
    let version = env!("CARGO_PKG_VERSION");
    assert_eq!(others(version, read), Vec::<String>::new());
    // The package takes its version from its crate.
    assert!(read("python/pyproject.toml").contains("dynamic = [\"version\"]"));
    // Another one in any of the files is found.
    for file in VERSIONS.map(|(file, ..)| file) {
        let forgotten = |path: &str| match path == file {
            true => read(path).replace(version, "0.0.9"),
            false => read(path),
        };
        assert!(!others(version, forgotten).is_empty(), "{file}");
    }
    let old = |path: &str| match path {
        "CHANGELOG.md" => "## [Unreleased]\n\n## [0.0.9] - 2026-01-01\n".to_owned(),
        _ => read(path),
    };
    assert_eq!(others(version, old), ["CHANGELOG.md"]);
}

#[test]
fn oldest_compilers_agree() {
    let oldest = env!("CARGO_PKG_RUST_VERSION");
    assert_eq!(after(&read(".ci/run"), "\noldest="), [oldest]);
}

#[test]
fn licences_go_with_the_package() {
    for file in ["LICENSE-APACHE", "LICENSE-MIT"] {
        assert_eq!(read(file), read(&format!("python/{file}")), "{file}");
    }
}

/// Actions of others that are named by a tag, which can be moved, in place of a commit.
fn movable(text: &str) -> Vec<&str> {
    let used = text.lines().filter_map(|line| line.split_once("uses: ").map(|(_, rest)| rest));
    let fixed = |commit: &str| commit.len() == 40 && commit.chars().all(|c| c.is_ascii_hexdigit());
    let commit =
        |of: &str| of.split('@').nth(1).and_then(|at| at.split(' ').next()).is_some_and(fixed);
    used.filter(|of| !of.starts_with("OWNER/") && !commit(of)).collect()
}

#[test]
fn actions_are_named_by_their_commit() {
    for file in
        [".github/workflows/ci.yml", ".github/actions/gate/action.yml", "docs/ci/github.yml"]
    {
        let text = read(file);
        assert!(text.contains("uses: "), "{file}");
        assert_eq!(movable(&text), Vec::<&str>::new(), "{file}");
    }
    assert_eq!(movable("  - uses: actions/checkout@v4\n"), ["actions/checkout@v4"]);
}

/// Every crate says whose it is, what it is, and where to read more.
#[test]
fn packages_describe_themselves() {
    let crates = std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/crates")).expect("crates");
    let crates = crates.map(|entry| {
        format!("crates/{}/Cargo.toml", entry.expect("an entry").file_name().display())
    });
    for file in crates.chain(["Cargo.toml".to_owned()]) {
        let text = read(&file);
        for key in
            ["description = \"", "authors.workspace", "documentation = \"", "keywords.workspace"]
        {
            assert!(text.contains(&format!("\n{key}")), "{file}: {key}");
        }
    }
}

/// What is wrong with a container file, as far as its text tells.
fn faults(file: &str, ignored: &str) -> Vec<&'static str> {
    let lines: Vec<&str> = file.lines().filter(|line| !line.starts_with('#')).collect();
    let line =
        |start: &str| lines.iter().copied().find(|line| line.starts_with(start)).unwrap_or("");
    let numbers = |text: &str| -> Vec<u32> { text.split('.').flat_map(str::parse).collect() };
    let compiler = after(line("FROM rust:"), "rust:").first().map_or(vec![], |text| numbers(text));
    let suite = |line: &str| ["bookworm", "trixie"].into_iter().find(|name| line.contains(name));
    let root = line("RUN cargo install").split("--root ").nth(1).unwrap_or("?");
    let wanted = [
        "src",
        "crates",
        "manufactured",
        "reports/baseline.json",
        "docs",
        "Cargo.lock",
        "build.rs",
        "python",
    ];
    let left_out = |path: &str| ignored.lines().any(|ignored| path.starts_with(ignored));
    [
        (compiler < numbers(env!("CARGO_PKG_RUST_VERSION")), "the compiler is too old"),
        (!line("RUN cargo install").contains("--locked --path ."), "not built from the lock file"),
        // The program is linked to the C library of the one and runs on that of the other.
        (suite(line("FROM rust:")) != suite(line("FROM debian:")), "built and run on two systems"),
        (
            !line("COPY --from=build").contains(&format!(" {root}/bin/sweep ")),
            "another program is copied",
        ),
        (line("ENTRYPOINT") != "ENTRYPOINT [\"sweep\"]", "it does not start the program"),
        (wanted.into_iter().any(left_out), "what is built from is not copied"),
    ]
    .into_iter()
    .filter_map(|(wrong, what)| wrong.then_some(what))
    .collect()
}

#[test]
fn the_container_file_builds_what_is_here() {
    let (file, ignored) = (read("docs/ci/Dockerfile"), read(".dockerignore"));
    assert_eq!(faults(&file, &ignored), Vec::<&str>::new());
    let caught = |old: &str, new: &str| {
        assert!(file.contains(old), "{old}");
        faults(&file.replace(old, new), &ignored)
    };
    assert_eq!(caught("rust:1.95", "rust:1.80"), ["the compiler is too old"]);
    assert_eq!(caught("--locked ", ""), ["not built from the lock file"]);
    assert_eq!(caught("debian:bookworm", "debian:trixie"), ["built and run on two systems"]);
    assert_eq!(caught("build /opt/gronwall/bin", "build /opt/bin"), ["another program is copied"]);
    assert_eq!(caught("[\"sweep\"]", "[\"sh\"]"), ["it does not start the program"]);
    assert_eq!(faults(&file, "target\nmanufactured"), ["what is built from is not copied"]);
}
