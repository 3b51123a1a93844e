//! The scenes of a command, and whether they fit into memory.

use std::path::{Path, PathBuf};

use ::run::sweep::{MemoryLimit, admit_constants, admit_run};
use scene::setup::{Setup, Subject};
use scene::{Registry, Scene};

use super::CliError;

/// Source of the scenes.
pub(super) struct Scenes {
    /// None: the scenes inside the program.
    pub(super) folder: Option<PathBuf>,
    /// The command line names the folder.
    pub(super) named: bool,
}

const FOLDER: &str = "manufactured";

impl Scenes {
    pub(super) fn new(folder: Option<PathBuf>) -> Self {
        let named = folder.is_some();
        let here = || Some(PathBuf::from(FOLDER)).filter(|folder| folder.is_dir());
        Self { folder: folder.or_else(here), named }
    }

    /// Its description for users.
    pub(super) fn place(&self) -> String {
        match &self.folder {
            Some(folder) => format!("in {}", folder.display()),
            None => "inside this program".to_owned(),
        }
    }

    /// A scene by name or path, made computable.
    pub(super) fn subject(&self, name: &str, limit: &MemoryLimit) -> Result<Subject, CliError> {
        subject(self.scene(name)?, limit)
    }

    pub(super) fn scene(&self, name: &str) -> Result<Scene, CliError> {
        // A path needs no folder of scenes.
        if name.ends_with(".toml") {
            return Ok(Scene::read(Path::new(name))?);
        }
        Ok(self.registry()?.load(name)?)
    }

    pub(super) fn registry(&self) -> Result<Registry, CliError> {
        match &self.folder {
            Some(folder) => Ok(Registry::open(folder)?),
            None => Ok(crate::shipped::scenes()),
        }
    }

    /// The named scenes, or all.
    pub(super) fn select(&self, names: &[String]) -> Result<Vec<Scene>, CliError> {
        if !names.is_empty() {
            return names.iter().map(|name| self.scene(name)).collect();
        }
        let registry = self.registry()?;
        let all: Vec<String> = registry.names().map(str::to_owned).collect();
        all.iter().map(|name| Ok(registry.load(name)?)).collect()
    }
}

/// Makes a scene computable, if its constants fit into memory.
pub(super) fn subject(scene: Scene, limit: &MemoryLimit) -> Result<Subject, CliError> {
    admit_constants(&scene, false, limit)?;
    Ok(Subject::new(scene)?)
}

/// Refuses a scene whose meshes do not fit into memory, before any is made.
pub(super) fn meshes_fit(setup: &Setup, limit: &MemoryLimit) -> Result<(), CliError> {
    let sweep = setup.scene.sweep.iter();
    let mut ns =
        sweep.flat_map(|sweep| sweep.n.iter().copied().chain(sweep.reference.map(|r| r.n)));
    ns.try_for_each(|n| {
        admit_run(setup, None, (n, 1), limit)
            .map_err(|error| CliError::about(format!("{} n = {n}", setup.scene.name), error))
    })
}

/// The error for a scene without cases; `purpose` is e.g. `run` or `audit`.
pub(super) fn no_case(scene: &Scene, purpose: &str) -> CliError {
    let hint = "add [sweep] with n and steps, or give --n and --steps";
    scene.error("scene.name", format!("the scene has no case to {purpose}"), hint).into()
}
