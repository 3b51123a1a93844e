//! A sweep in one call.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use crate::external::{look_for_cause, solver_first};
use crate::sweep::{
    Machine, OutputDirectory, OutputError, Overrides, Progress, ScenePlan, SweepError, judge_plan,
    run_sweep,
};
use judge::record::CaseRecord;
use judge::verdict::Verdict;
use scene::setup::{Scheme, Setup, SetupError, Subject};
use scene::{Norm, Scene, SceneError, Source};

/// Why a sweep has no verdicts.
#[derive(Debug, thiserror::Error)]
pub enum FrontError {
    #[error(transparent)]
    Scene(#[from] SceneError),
    #[error(transparent)]
    Setup(#[from] SetupError),
    #[error(transparent)]
    Output(#[from] OutputError),
    #[error(transparent)]
    Sweep(#[from] SweepError),
    /// The grid is invalid for the scene, or has no case.
    #[error("{name}: no case to run; give n and steps")]
    NoCase { name: String },
    /// Stopped by [`Sweep::progress`].
    #[error("{name}: stopped before all cases were run")]
    Stopped { name: String },
}

/// A scene on its grids, measured and judged.
///
/// ```no_run
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let swept = gronwall_run::Sweep::read("manufactured/viscoelastic.toml")?.jobs(2).run()?;
/// assert!(swept.as_expected());
/// # Ok(())
/// # }
/// ```
pub struct Sweep {
    scene: Scene,
    overrides: Overrides,
    jobs: usize,
    solver: Option<Arc<dyn Scheme>>,
    pressures: bool,
    constants: bool,
    out: Option<PathBuf>,
    progress: Arc<dyn Progress + Send>,
}

/// What a sweep found.
#[derive(Debug)]
pub struct Swept {
    /// One record per case, sorted by scene, n and steps.
    pub records: Vec<CaseRecord>,
    /// One verdict per prediction.
    pub verdicts: Vec<Verdict>,
}

impl Swept {
    /// Whether every verdict is the expected one; false without verdicts.
    pub fn as_expected(&self) -> bool {
        !self.verdicts.is_empty() && self.verdicts.iter().all(Verdict::as_expected)
    }
}

impl Sweep {
    /// A scene that has been read.
    pub fn of(scene: Scene) -> Self {
        let overrides = Overrides::default();
        Self {
            scene,
            overrides,
            jobs: 1,
            solver: None,
            pressures: true,
            constants: true,
            out: None,
            progress: Arc::new(()),
        }
    }

    /// Reads the scene of a file.
    ///
    /// # Errors
    /// [`FrontError::Scene`], with line, value and the way out.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, FrontError> {
        Ok(Self::of(Scene::read(path.as_ref())?))
    }

    /// Parses a scene in TOML; `name` stands for the file in messages.
    pub fn parse(name: &str, text: &str) -> Result<Self, FrontError> {
        Ok(Self::of(Scene::from_source(Source::from_text(name, text))?))
    }

    /// Cells per unit length in place of the scene's `n`.
    pub fn n(mut self, n: &[u32]) -> Self {
        self.overrides.n = Some(n.to_vec());
        self
    }

    /// Numbers of time steps in place of the scene's `steps`.
    pub fn steps(mut self, steps: &[u32]) -> Self {
        self.overrides.steps = Some(steps.to_vec());
        self
    }

    /// Cases run in parallel; the records do not depend on it.
    pub fn jobs(mut self, jobs: usize) -> Self {
        self.jobs = jobs;
        self
    }

    /// Another solver of Problem 14 in place of the built-in one.
    pub fn solver(mut self, solver: impl Scheme + 'static) -> Self {
        self.solver = Some(Arc::new(solver));
        self
    }

    /// The solver gives displacements only: nothing that needs pressures is measured or judged.
    pub fn without_pressures(mut self) -> Self {
        self.pressures = false;
        self
    }

    /// Judges orders but not constants: for other elements or time rules.
    pub fn orders_only(mut self) -> Self {
        self.constants = false;
        self
    }

    /// Keeps `cases.csv` in this directory, a row as each case ends; otherwise records are only returned.
    pub fn out(mut self, directory: impl Into<PathBuf>) -> Self {
        self.out = Some(directory.into());
        self
    }

    /// An observer of the cases, which may stop them.
    pub fn progress(mut self, progress: impl Progress + Send + 'static) -> Self {
        self.progress = Arc::new(progress);
        self
    }

    /// Runs every case, then judges.
    ///
    /// # Errors
    /// [`FrontError`]. A failed case is a record with its reason, and its verdict does not pass.
    pub fn run(self) -> Result<Swept, FrontError> {
        let name = self.scene.name.clone();
        let (other, constants) = (self.solver.is_some(), self.constants);
        let plan = match self.solver {
            None => {
                self.overrides.check(&self.scene)?;
                ScenePlan::new(Subject::new(self.scene)?, &self.overrides)
            }
            Some(scheme) => plan_for(scheme, self.scene, &self.overrides, self.pressures)?,
        };
        if plan.cases.is_empty() {
            return Err(FrontError::NoCase { name });
        }
        let plan = [plan];
        let scratch = self.out.is_none().then(Scratch::new);
        let path = self.out.as_deref().or(scratch.as_ref().map(|scratch| &*scratch.0));
        let out = OutputDirectory::take(path.unwrap_or(Path::new(".")))?;
        let machine = Machine::with_jobs(self.jobs);
        let records = run_sweep(&plan, &out, &machine, false, &*self.progress)?;
        if self.progress.stopped() {
            return Err(FrontError::Stopped { name });
        }
        let [plan] = &plan;
        let mut verdicts = judge_plan(plan, &records, constants);
        if let (true, Subject::Contact(setup)) = (other, &plan.subject) {
            let found = look_for_cause(&verdicts, setup, plan.runs(), &*setup.scheme);
            solver_first(&mut verdicts, setup, found.as_ref());
        }
        Ok(Swept { records, verdicts })
    }
}

/// The plan of a scene for another solver, with the norms that displacements (and `pressures`, if given) determine.
///
/// # Errors
/// A scene without a body or an exact solution, or a grid that it cannot have.
pub fn plan_for(
    scheme: Arc<dyn Scheme>,
    mut scene: Scene,
    overrides: &Overrides,
    pressures: bool,
) -> Result<ScenePlan, FrontError> {
    overrides.check(&scene)?;
    let tells = |norm: Norm| pressures || !norm.wants_pressure();
    scene.predicts.retain(|prediction| tells(prediction.norm));
    let what = "an abstract scene, in R^m, has no mesh that could be given to a solver";
    let hint = "verify a scene of a body; the library's traits take solvers of both kinds";
    scene.refuse_if(scene.as_contact().is_none(), "scene.name", what, hint)?;
    let setup = Setup { scheme, ..Setup::new(scene)? };
    let what = "the scene has no exact solution: a solver would be judged by its own finer run";
    let hint = "verify a scene with [exact]; `sweep list` names them";
    setup.scene.refuse_if(setup.exact.is_none(), "scene.name", what, hint)?;
    let mut plan = ScenePlan::new(Subject::Contact(Box::new(setup)), overrides);
    plan.cases.iter_mut().for_each(|case| case.norms.retain(|&norm| tells(norm)));
    Ok(plan)
}

/// A temporary directory, removed on drop.
struct Scratch(PathBuf);

impl Scratch {
    fn new() -> Self {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        let name = format!("gronwall-sweep-{}-{count}", std::process::id());
        Self(std::env::temp_dir().join(name))
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        // It may never have been made.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}
