//! The scenes of a folder or inside a program, found by name; any other scene, by path.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::diagnostic::{Result, SceneError};
use super::nearest::by_distance;
use super::source::{Inside, Source};
use super::validated::Scene;

/// Depth of the search in subfolders.
const DEEPEST: usize = 8;

/// Folder shown in messages for files inside the program.
const INSIDE: &str = "<sweep>";

pub(super) fn place(folder: &Path) -> String {
    if folder == Path::new(INSIDE) {
        return "inside the program".into();
    }
    format!("under {}", folder.display())
}

/// Scene files by name.
#[derive(Debug, Clone)]
pub struct Registry {
    folder: PathBuf,
    files: BTreeMap<String, PathBuf>,
    /// Texts in place of files; empty for a folder.
    inside: Inside,
}

impl Registry {
    /// Lists the TOML files below a folder without reading them.
    ///
    /// # Errors
    /// The folder cannot be read, or two files have one name.
    pub fn open(folder: &Path) -> Result<Registry> {
        let (folder, files) = (folder.to_path_buf(), BTreeMap::new());
        let mut registry = Registry { folder, files, inside: &[] };
        registry.enter(&registry.folder.clone(), DEEPEST)?;
        Ok(registry)
    }

    /// The scenes among texts inside the program, with their meshes.
    pub fn inside(texts: Inside) -> Registry {
        let folder = PathBuf::from(INSIDE);
        let scenes = texts.iter().filter(|(name, _)| name.ends_with(".toml"));
        let files = scenes.map(|(name, _)| (stem(Path::new(name)), folder.join(name))).collect();
        Registry { folder, files, inside: texts }
    }

    /// The names, sorted.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.files.keys().map(String::as_str)
    }

    /// The file of a scene given by name, or by a path, which has a `/` or ends in `.toml`.
    ///
    /// # Errors
    /// No scene has that name; the nearest names are given.
    pub(crate) fn find(&self, scene: &str) -> Result<PathBuf> {
        if let Some(path) = self.files.get(scene) {
            return Ok(path.clone());
        }
        if scene.contains('/') || scene.ends_with(".toml") {
            return Ok(PathBuf::from(scene));
        }
        Err(self.unknown(scene))
    }

    /// Reads a scene given by name or by path.
    ///
    /// # Errors
    /// The scene is unknown or invalid, or a file of the folder holds a scene of another name.
    pub fn load(&self, scene: &str) -> Result<Scene> {
        let path = self.find(scene)?;
        let loaded = match self.text(&path) {
            Some(text) => Scene::from_source(Source {
                beside: self.inside,
                ..Source::from_text(&path, text)
            })?,
            None => Scene::read(&path)?,
        };
        let expected = stem(&path);
        let other = self.files.contains_key(scene) && loaded.name != expected;
        let message = format!("the scene is called `{}`, its file `{expected}.toml`", loaded.name);
        let hint = format!("write name = \"{expected}\", or rename the file");
        loaded.refuse_if(other, "scene.name", message, hint).map(|()| loaded)
    }

    /// The text of a file inside the program.
    fn text(&self, path: &Path) -> Option<&'static str> {
        let below = path.strip_prefix(&self.folder).ok()?;
        let (_, text) = self.inside.iter().find(|(name, _)| Path::new(name) == below)?;
        Some(text)
    }

    fn unknown(&self, name: &str) -> SceneError {
        let near = by_distance(name, self.names()).into_iter().take(3);
        let near: Vec<String> = near.map(|name| format!("`{name}`")).collect();
        let way_out = if !near.is_empty() {
            format!("did you mean {}?", near.join(" or "))
        } else if self.files.is_empty() {
            "the folder holds no scene; give the path of a TOML file".to_string()
        } else {
            let known = self.names().collect::<Vec<_>>().join(", ");
            format!("known: {known}; or give the path of a TOML file")
        };
        SceneError::Unknown { name: name.to_string(), folder: self.folder.clone(), way_out }
    }

    fn enter(&mut self, folder: &Path, deeper: usize) -> Result<()> {
        let unreadable = |error: std::io::Error| SceneError::Unreadable {
            path: folder.to_path_buf(),
            reason: error.to_string(),
        };
        let mut paths = Vec::new();
        for entry in std::fs::read_dir(folder).map_err(unreadable)? {
            paths.push(entry.map_err(unreadable)?.path());
        }
        paths.sort();
        for path in paths {
            if path.is_dir() && deeper > 0 {
                self.enter(&path, deeper - 1)?;
            } else if path.extension().is_some_and(|ending| ending == "toml") {
                self.add(path)?;
            }
        }
        Ok(())
    }

    fn add(&mut self, path: PathBuf) -> Result<()> {
        let name = stem(&path);
        match self.files.insert(name.clone(), path.clone()) {
            None => Ok(()),
            Some(first) => Err(SceneError::Duplicate { name, first, second: path }),
        }
    }
}

fn stem(path: &Path) -> String {
    path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default()
}
