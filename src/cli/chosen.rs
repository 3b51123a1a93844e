//! Arguments that select scenes and grids, shared by several commands.

use clap::Args;

use super::{CliError, Scenes, no_case, subject};
use run::sweep::{MemoryLimit, Overrides, ScenePlan};
use scene::{Scene, SceneError};

/// Meshes and numbers of steps (at most `STEPS`) in place of the scene's.
#[derive(Args, Default)]
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

    /// Refuses numbers that the scene cannot have.
    pub(super) fn check(&self, scene: &Scene) -> Result<(), SceneError> {
        self.overrides().check(scene)
    }

    pub(super) fn overrides(&self) -> Overrides {
        Overrides { n: self.n.clone(), steps: self.steps.clone() }
    }
}

/// Scenes and grids.
#[derive(Args, Default)]
pub(super) struct Chosen {
    /// Names of scenes, or paths of TOML files; none: all that are not marked long
    #[arg(value_name = "SCENE")]
    pub(super) scenes: Vec<String>,
    #[command(flatten)]
    pub(super) grid: Grid,
    /// Take the scenes marked long as well
    #[arg(long)]
    pub(super) all: bool,
}

impl Chosen {
    pub(super) fn named(&self) -> bool {
        !self.scenes.is_empty()
    }

    /// The plan of a scene; `overrides` are the grids of the command line. None for scenes that have to be named: long
    /// ones, and those without a grid.
    pub(super) fn plan_of(
        &self,
        scene: Scene,
        overrides: &Overrides,
        limit: &MemoryLimit,
    ) -> Result<Option<ScenePlan>, CliError> {
        if scene.long && !self.all && !self.named() {
            return Ok(None);
        }
        self.grid.check(&scene)?;
        let plan = ScenePlan::new(subject(scene, limit)?, overrides);
        if plan.cases.is_empty() && !self.named() {
            // A scene without a grid is meant for `sweep solve`.
            return Ok(None);
        }
        if plan.cases.is_empty() {
            return Err(no_case(plan.scene(), "run"));
        }
        if let Some(remark) = plan.step_remark()? {
            super::progress::remark(&plan.scene().name, &remark);
        }
        Ok(Some(plan))
    }

    /// The error if there is no plan at all.
    pub(super) fn none(scenes: &Scenes, purpose: &str) -> CliError {
        let place = scenes.place();
        CliError::Other(format!("no scene to {purpose} {place}: name one, or add --all"))
    }
}
