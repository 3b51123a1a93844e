//! From scenes to a plan: predictions of all cases, jobs, and the files that an engine reads.

use std::path::{Path, PathBuf};

use super::bundle::{Job, SceneDemands, bundle};
use super::plan::{CaseRow, JobRow, PLAN, Plan, PlanError, PlannedScene, id};
use super::request::request;
use super::slurm;
use crate::sweep::{Overrides, ScenePlan, demands};
use files::{make_directory, replace_file};
use judge::record::Key;
use scene::setup::SetupError;

/// What runs the jobs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Engine {
    /// Snakemake, by a `Snakefile`.
    Snakemake,
    /// Slurm, by job arrays.
    Slurm,
    /// Something else that reads the tables.
    Tables,
}

/// Why no plan was written.
#[derive(Debug, thiserror::Error)]
pub enum PlanningError {
    /// A file cannot be written.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// A plan is there, and it is not this one.
    #[error(
        "{}: another plan stands here, and what was run by it would be lost; choose another directory with --out, or remove this one", path.display()
    )]
    Other { path: PathBuf },
}

/// A scene of a plan, and what its cases take.
pub struct PlannedCases {
    scene: PlannedScene,
    demands: SceneDemands,
}

impl PlannedCases {
    /// Predicts the cases of a scene; its meshes are made and analysed.
    ///
    /// # Errors
    /// [`SetupError::Mesh`].
    pub fn new(plan: &ScenePlan) -> Result<Self, SetupError> {
        let demands = SceneDemands {
            meshes: plan.cases.iter().map(|case| case.n).collect(),
            steps: plan.cases.iter().map(|case| case.steps).collect(),
            time: plan.scene().time,
            demands: demands(plan)?,
        };
        Ok(Self { scene: PlannedScene::new(plan.scene()), demands })
    }
}

/// The jobs of a plan, and the plan itself.
pub struct Planning {
    /// What goes into plan.json.
    pub plan: Plan,
    /// One row a job, the longest first.
    pub jobs: Vec<JobRow>,
    demands: Vec<SceneDemands>,
    bundles: Vec<Job>,
}

impl Planning {
    /// Puts the cases of `scenes` together to jobs of about `seconds`.
    pub fn new(scenes: Vec<PlannedCases>, overrides: Overrides, seconds: f64) -> Self {
        let (scenes, demands): (Vec<PlannedScene>, Vec<SceneDemands>) =
            scenes.into_iter().map(|own| (own.scene, own.demands)).unzip();
        let bundles = bundle(&demands, seconds);
        let jobs: Vec<JobRow> =
            bundles.iter().enumerate().map(|(number, job)| request(number, job)).collect();
        let plan = Plan {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            n: overrides.n,
            steps: overrides.steps,
            bundle_seconds: seconds,
            cases: demands.iter().map(|own| own.meshes.len()).sum(),
            jobs: jobs.len(),
            scenes,
        };
        Self { plan, jobs, demands, bundles }
    }

    /// Writes the plan for an engine into `dir`. The same plan once more changes nothing but the engine's files.
    ///
    /// # Errors
    /// [`PlanningError`].
    pub fn write(&self, dir: &Path, engine: Engine) -> Result<(), PlanningError> {
        let io = |path: &Path, source| PlanError::Io { path: path.to_owned(), source };
        make_directory(dir).map_err(|source| io(dir, source))?;
        if dir.join(PLAN).exists() && Plan::read(dir)? != self.plan {
            return Err(PlanningError::Other { path: dir.join(PLAN) });
        }
        let put = |name: &str, text: &str| -> Result<(), PlanError> {
            let path = dir.join(name);
            replace_file(&path, text.as_bytes()).map_err(|source| io(&path, source))
        };
        match engine {
            Engine::Snakemake => put("Snakefile", include_str!("workflow/Snakefile"))?,
            Engine::Slurm => {
                let arrays = slurm::arrays(&self.jobs);
                let folder = dir.join("arrays");
                make_directory(&folder).map_err(|source| io(&folder, source))?;
                for array in &arrays {
                    let lines: String = array.jobs.iter().map(|job| format!("{job}\n")).collect();
                    put(&array.file, &lines)?;
                }
                put("array.sh", slurm::ARRAY)?;
                put("submit.sh", &slurm::submit(&arrays))?;
            }
            Engine::Tables => {}
        }
        if !dir.join(PLAN).exists() {
            self.plan.write(dir, self.rows(), self.jobs.iter().cloned())?;
        }
        Ok(())
    }

    /// The rows of plan.csv: the longest job first, and in it the longest case.
    fn rows(&self) -> impl Iterator<Item = CaseRow> {
        self.bundles.iter().enumerate().flat_map(move |(job, bundle)| {
            bundle.cases.iter().map(move |&(s, c)| {
                let own = &self.demands[s];
                let need = own.demands.cases[c].need;
                let scene = self.plan.scenes[s].name.clone();
                let key = Key { scene, n: own.meshes[c], steps: own.steps[c] };
                let id = id(&key);
                let Key { scene, n, steps } = key;
                CaseRow { id, scene, n, steps, seconds: need.seconds, bytes: need.bytes, job }
            })
        })
    }
}
