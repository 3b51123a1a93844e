//! The scenes of a command, and whether they fit into memory.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::CliError;
use super::machine::share_threads;
use ::run::sweep::{MemoryLimit, Overrides, ScenePlan, admit_constants, admit_run};
use clap::Args;
use fem::contact::Discretization;
use rayon::prelude::*;
use scene::setup::{Setup, Subject};
use scene::{Registry, Scene, SceneError};

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
        let folder = self.folder.as_ref().map(|folder| format!("in {}", folder.display()));
        folder.unwrap_or_else(|| "inside this program".into())
    }

    /// A scene by name or path.
    pub(super) fn scene(&self, name: &str) -> Result<Scene, CliError> {
        // A path needs no folder of scenes.
        if name.ends_with(".toml") {
            return Ok(Scene::read(Path::new(name))?);
        }
        let file = PathBuf::from(format!("{name}.toml"));
        self.registry()?.load(name).map_err(|error| match error {
            SceneError::Unknown { name, folder, .. } if file.is_file() => {
                let way_out = format!("did you mean the file `{}`?", file.display());
                SceneError::Unknown { name, folder, way_out }.into()
            }
            error => error.into(),
        })
    }

    pub(super) fn registry(&self) -> Result<Registry, CliError> {
        match &self.folder {
            Some(folder) => Ok(Registry::open(folder)?),
            None => Ok(crate::shipped::scenes()),
        }
    }

    /// The named scenes, or all.
    pub(super) fn select(&self, names: &[String]) -> Result<Vec<Scene>, CliError> {
        if names.is_empty() {
            let registry = self.registry()?;
            return registry.names().map(|name| Ok(registry.load(name)?)).collect();
        }
        let scenes: Vec<Scene> =
            names.iter().map(|name| self.scene(name)).collect::<Result<_, _>>()?;
        let mut seen: BTreeMap<&str, &Path> = BTreeMap::new();
        for Scene { name, source, .. } in &scenes {
            if let Some(first) = seen.insert(name, &source.path) {
                let (name, first, second) = (name.clone(), first.into(), source.path.clone());
                return Err(SceneError::Duplicate { name, first, second }.into());
            }
        }
        Ok(scenes)
    }
}

/// Makes a scene computable, if its constants fit into memory.
pub(super) fn subject(scene: Scene, limit: &MemoryLimit) -> Result<Subject, CliError> {
    admit_constants(&scene, false, limit)?;
    note_groups(&scene);
    Ok(Subject::new(scene)?)
}

/// Says which groups of a mesh file bound nothing.
pub(super) fn note_groups(scene: &Scene) {
    let inner = scene.as_contact().map_or(&[][..], |body| body.domain.inner_groups());
    if !inner.is_empty() {
        let groups = inner.join(", ");
        let line = format!(
            "note: {}: groups of the mesh that bound nothing are passed over: {groups}",
            scene.name
        );
        super::output::note(&line);
    }
}

/// Refuses a run on n and N that does not fit into memory, if possible before the mesh is made.
pub(super) fn admit(
    setup: &Setup,
    space: Option<&Discretization>,
    grid: (u32, u32),
    limit: &MemoryLimit,
) -> Result<(), CliError> {
    let about = |error| CliError::about(format!("{} n = {}", setup.scene.name, grid.0), error);
    admit_run(setup, space, grid, limit).map_err(about)
}

// Arguments that select scenes and grids, shared by several commands.

/// Meshes and numbers of steps (at most `STEPS`) in place of the scene's.
#[derive(Args, Default, Clone)]
pub(super) struct Grid<const STEPS: i64 = 10_000_000> {
    /// Cells per unit length, h = 1/n, in place of the scene's list
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(1..=4096))]
    pub(super) n: Option<Vec<u32>>,
    /// Numbers N of time steps, k = T/N, in place of the scene's list
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(1..=STEPS))]
    pub(super) steps: Option<Vec<u32>>,
}

impl<const STEPS: i64> Grid<STEPS> {
    /// Whether the grids are those of the scenes.
    pub(super) fn is_own(&self) -> bool {
        self.n.is_none() && self.steps.is_none()
    }

    pub(super) fn overrides(&self) -> Overrides {
        Overrides { n: self.n.clone(), steps: self.steps.clone() }
    }
}

/// Scenes and grids.
#[derive(Args, Default, Clone)]
pub(super) struct Chosen {
    /// Names of scenes, or paths of TOML files; none: all that are not marked long
    #[arg(value_name = "SCENE")]
    pub(super) scenes: Vec<String>,
    #[command(flatten)]
    pub(super) grid: Grid,
    /// Include the scenes marked long
    #[arg(long)]
    pub(super) all: bool,
}

impl Chosen {
    pub(super) fn named(&self) -> bool {
        !self.scenes.is_empty()
    }

    /// The plans of the scenes, a scene at a time per thread, in their order. Scenes that have to be named are left out:
    /// long ones, and those without a grid.
    pub(super) fn plans(
        &self,
        scenes: &Scenes,
        limit: &MemoryLimit,
    ) -> Result<Vec<ScenePlan>, CliError> {
        let (overrides, selected) = (self.grid.overrides(), scenes.select(&self.scenes)?);
        share_threads()?;
        let one = |scene: Scene| {
            if scene.long && !self.all && !self.named() {
                return Ok(None);
            }
            overrides.check(&scene)?;
            let plan = ScenePlan::new(subject(scene, limit)?, &overrides);
            if plan.cases.is_empty() {
                return if self.named() {
                    Err(plan.scene().no_case("run").into())
                } else {
                    Ok(None)
                };
            }
            let remark = plan.step_remark()?;
            Ok::<_, CliError>(Some((plan, remark)))
        };
        let found: Vec<_> = selected.into_par_iter().map(one).collect();
        let mut plans = Vec::new();
        for scene in found {
            let Some((plan, remark)) = scene? else { continue };
            if let Some(remark) = remark {
                super::output::remark(&plan.scene().name, &remark);
            }
            plans.push(plan);
        }
        if plans.is_empty() {
            let place = scenes.place();
            return Err(CliError::other(format!(
                "no scene to run {place}: name one, or add --all"
            )));
        }
        Ok(plans)
    }
}
