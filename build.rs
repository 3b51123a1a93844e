//! What a report says of its origin and the compiler alone knows: commit, compiler, target; and the table of the scenes
//! that the program comes with.
//!
//! The commit is read from `.git` without the git program, or in a published crate from what cargo keeps of it, and is
//! "unknown" elsewhere. Cargo runs this again
//! when HEAD or what it names has moved, and not otherwise; equal sources at an equal commit give equal programs. In
//! development builds the commit is none: their sources are mostly ahead of it, and every commit would cost a build.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let released = env::var("PROFILE").is_ok_and(|profile| profile == "release");
    let commit = match released {
        true => {
            let found =
                commit(Path::new(".git")).or_else(|| packaged(Path::new(".cargo_vcs_info.json")));
            found.unwrap_or_else(|| "unknown".into())
        }
        false => "development build".into(),
    };
    shipped(Path::new("manufactured")).expect("the scenes of the package");
    let told = |name: &str| env::var(name).unwrap_or_else(|_| "unknown".into());
    println!("cargo::rustc-env=GRONWALL_COMMIT={commit}");
    println!("cargo::rustc-env=GRONWALL_TARGET={}", told("TARGET"));
    println!("cargo::rustc-env=GRONWALL_OPTIMISATION={}", told("OPT_LEVEL"));
    println!(
        "cargo::rustc-env=GRONWALL_COMPILER={}",
        compiler().unwrap_or_else(|| "unknown".into())
    );
}

/// Writes the files of a folder as `&[(NAME, TEXT), …]`, sorted by name: scenes and the meshes that they name.
fn shipped(folder: &Path) -> std::io::Result<()> {
    println!("cargo::rerun-if-changed={}", folder.display());
    let mut names = Vec::new();
    for entry in fs::read_dir(folder)? {
        let name = entry?.file_name().to_string_lossy().into_owned();
        if name.ends_with(".toml") || name.ends_with(".msh") {
            names.push(name);
        }
    }
    names.sort();
    let root = "env!(\"CARGO_MANIFEST_DIR\")";
    let row = |name: &String| {
        let path = format!("/{}/{name}", folder.display());
        format!("({name:?}, include_str!(concat!({root}, {path:?}))),\n")
    };
    let table = format!("&[\n{}]", names.iter().map(row).collect::<String>());
    let out = env::var_os("OUT_DIR").map(PathBuf::from).unwrap_or_default();
    fs::write(out.join("shipped.rs"), table)
}

/// `rustc 1.95.0 (59807616e 2026-04-14)`.
fn compiler() -> Option<String> {
    let output = Command::new(env::var_os("RUSTC")?).arg("--version").output().ok()?;
    Some(String::from_utf8(output.stdout).ok()?.trim().to_owned())
}

/// The commit that HEAD is at; every file that decides it is watched.
pub fn commit(git: &Path) -> Option<String> {
    let git = folder(git)?;
    // A work tree has a HEAD; its branches are in the common folder.
    let common = match fs::read_to_string(git.join("commondir")) {
        Ok(path) => git.join(path.trim()),
        Err(_) => git.clone(),
    };
    let head = watched(&git.join("HEAD"))?;
    let Some(name) = head.trim().strip_prefix("ref: ") else { return hash(head.trim()) };
    if let Some(commit) = watched(&common.join(name)) {
        return hash(commit.trim());
    }
    let packed = watched(&common.join("packed-refs"))?;
    packed.lines().find_map(|line| hash(line.strip_suffix(name)?.trim()))
}

/// The commit that `cargo package` took the sources from, unless they were ahead of it.
pub fn packaged(kept: &Path) -> Option<String> {
    let text = watched(kept)?;
    if text.contains("\"dirty\"") {
        return None;
    }
    let (_, after) = text.split_once("\"sha1\"")?;
    hash(after.split('"').nth(1)?)
}

/// `.git` itself, or the folder that a file of this name points to.
fn folder(git: &Path) -> Option<PathBuf> {
    if git.is_dir() {
        return Some(git.to_owned());
    }
    let text = watched(git)?;
    let path = Path::new(text.trim().strip_prefix("gitdir: ")?);
    Some(git.parent()?.join(path))
}

/// The text of a file. One that does not exist is not watched: cargo would run this at every build.
fn watched(path: &Path) -> Option<String> {
    let text = fs::read_to_string(path).ok()?;
    println!("cargo::rerun-if-changed={}", path.display());
    Some(text)
}

fn hash(text: &str) -> Option<String> {
    let plain = text.len() >= 40 && text.chars().all(|c| c.is_ascii_hexdigit());
    plain.then(|| text.to_owned())
}
