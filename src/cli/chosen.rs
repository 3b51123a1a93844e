//! Arguments that select scenes and grids, shared by several commands.

use clap::Args;
use rayon::prelude::*;

use super::machine::share_threads;
use super::{CliError, Scenes, no_case, subject};
use run::sweep::{MemoryLimit, Overrides, ScenePlan};
use scene::{Scene, SceneError};

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

    /// Refuses numbers that the scene cannot have.
    pub(super) fn check(&self, scene: &Scene) -> Result<(), SceneError> {
        self.overrides().check(scene)
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

    /// What `then` makes of the plans of scenes, a scene at a time per thread, in their order; `overrides` are the grids of
    /// the command line. Scenes that have to be named are left out: long ones, and those without a grid.
    pub(super) fn plans<T: Send>(
        &self,
        scenes: Vec<Scene>,
        overrides: &Overrides,
        limit: &MemoryLimit,
        then: impl Fn(ScenePlan) -> Result<T, CliError> + Sync,
    ) -> Result<Vec<T>, CliError> {
        share_threads()?;
        let one = |scene: Scene| {
            let Some(plan) = self.plan_of(scene, overrides, limit)? else { return Ok(None) };
            let (name, remark) = (plan.scene().name.clone(), plan.step_remark()?);
            Ok::<_, CliError>(Some((name, remark, then(plan)?)))
        };
        let found: Vec<_> = scenes.into_par_iter().map(one).collect();
        let mut made = Vec::new();
        for scene in found {
            let Some((name, remark, value)) = scene? else { continue };
            if let Some(remark) = remark {
                super::progress::remark(&name, &remark);
            }
            made.push(value);
        }
        Ok(made)
    }

    fn plan_of(
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
        match (plan.cases.is_empty(), self.named()) {
            // A scene without a grid is meant for `sweep solve`.
            (true, false) => Ok(None),
            (true, true) => Err(no_case(plan.scene(), "run")),
            (false, _) => Ok(Some(plan)),
        }
    }

    /// The error if there is no plan at all.
    pub(super) fn none(scenes: &Scenes, purpose: &str) -> CliError {
        let place = scenes.place();
        CliError::Other(format!("no scene to {purpose} {place}: name one, or add --all"))
    }
}
