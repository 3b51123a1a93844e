//! A list of the files that were written into a directory; only these are removed when obsolete.

use std::collections::BTreeSet;
use std::path::{Component, Path, PathBuf};

use crate::{FileError, if_there, read_text, remove_if_there, replace_file};

/// Why listed files cannot be written or removed.
#[derive(Debug, thiserror::Error)]
pub enum ListError {
    #[error(transparent)]
    Io(#[from] FileError),
    /// An invalid list of earlier files.
    #[error("{}: {reason}; delete this list, and the pictures that you have no use for", path.display())]
    List { path: PathBuf, reason: String },
}

const LIST: &str = "files.json";

/// The names listed in a directory; empty without a list.
fn listed(dir: &Path) -> Result<BTreeSet<String>, ListError> {
    let path = dir.join(LIST);
    let Some(text) = if_there(read_text(&path))? else { return Ok(BTreeSet::new()) };
    let names: BTreeSet<String> = serde_json::from_str(&text)
        .map_err(|error| ListError::List { path: path.clone(), reason: error.to_string() })?;
    // A list that points out of its directory is not ours: nothing may be removed by it.
    let outside = |name: &&String| {
        let mut parts = Path::new(name.as_str()).components();
        !matches!((parts.next(), parts.next()), (Some(Component::Normal(_)), None))
    };
    match names.iter().find(outside) {
        Some(name) => {
            let reason = format!("`{name}` is no file of this directory");
            Err(ListError::List { path, reason })
        }
        None => Ok(names),
    }
}

fn write_list(dir: &Path, names: &BTreeSet<String>) -> Result<(), ListError> {
    let text = serde_json::json!(names).to_string() + "\n";
    Ok(replace_file(&dir.join(LIST), text.as_bytes())?)
}

fn remove(dir: &Path, name: &str) -> Result<(), ListError> {
    Ok(remove_if_there(&dir.join(name))?)
}

/// Writes the files, lists them, and removes obsolete ones of an earlier list. If killed at any point, the list
/// includes every written file.
///
/// # Errors
/// [`ListError`].
pub fn write_listed(dir: &Path, files: &[(String, &str)]) -> Result<(), ListError> {
    let earlier = listed(dir)?;
    let now: BTreeSet<String> = files.iter().map(|(name, _)| name.clone()).collect();
    write_list(dir, &earlier.union(&now).cloned().collect())?;
    for (name, text) in files {
        replace_file(&dir.join(name), text.as_bytes())?;
    }
    earlier.difference(&now).try_for_each(|name| remove(dir, name))?;
    write_list(dir, &now)
}

/// Removes the files of an earlier list.
///
/// # Errors
/// [`ListError`].
pub fn remove_listed(dir: &Path) -> Result<(), ListError> {
    let earlier = listed(dir)?;
    if earlier.is_empty() {
        return Ok(());
    }
    earlier.iter().try_for_each(|name| remove(dir, name))?;
    remove(dir, LIST)
}

#[cfg(test)]
mod tests {
    use std::{fs, io};

    use super::*;

    #[test]
    fn only_listed_files_of_the_directory_go() {
        let root = std::env::temp_dir().join(format!("gronwall-written-{}", std::process::id()));
        let dir = root.join("out");
        fs::create_dir_all(&dir).unwrap();
        let put = |name: &str| fs::write(dir.join(name), "mine").unwrap();
        let names = || {
            let entries = fs::read_dir(&dir).unwrap();
            let name = |e: io::Result<fs::DirEntry>| e.unwrap().file_name().into_string().unwrap();
            entries.map(name).collect::<BTreeSet<String>>()
        };
        put("c-h.svg");
        let file = |name: &str| (name.to_owned(), "text");
        write_listed(&dir, &[file("a-h.svg"), file("index.html")]).unwrap();
        write_listed(&dir, &[file("b-h.svg"), file("index.html")]).unwrap();
        let expected = ["b-h.svg", "c-h.svg", LIST, "index.html"];
        assert_eq!(names(), expected.map(str::to_owned).into());
        remove_listed(&dir).unwrap();
        assert_eq!(names(), ["c-h.svg".to_owned()].into());
        remove_listed(&dir).unwrap();
        // A list that was tampered with removes nothing.
        fs::write(root.join("mine.svg"), "mine").unwrap();
        for list in [r#"["c-h.svg", "../mine.svg"]"#, r#"["/etc/mine"]"#, r#"{"a": 1}"#, r#"[""]"#]
        {
            fs::write(dir.join(LIST), list).unwrap();
            assert!(matches!(remove_listed(&dir), Err(ListError::List { .. })), "{list}");
            assert!(write_listed(&dir, &[file("b-h.svg")]).is_err());
            assert!(root.join("mine.svg").exists() && dir.join("c-h.svg").exists());
        }
        fs::remove_dir_all(&root).unwrap();
    }
}
