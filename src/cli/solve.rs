//! `sweep solve`: one case, named quantities at t = T, VTU files, pictures.

mod pictures;
pub(super) mod words;

use std::path::PathBuf;
use std::time::Instant;

use clap::{Args, ValueEnum};

use super::machine::{Common, status_of_process};
use super::scenes::admit;
use super::{CliError, Scenes, abstract_problem, print_json, print_text, subject, width};
use fem::contact::{Discretization, Model, StepView};
use files::{digits, make_directory, replace_file};
use pictures::Pictures;
use report::StudyDocument;
use scene::setup::{
    MeshData, Setup, StepRemark, Subject, abstract_decomposition_bound, decomposition_bound,
};
use scene::{Extension, Law};
use serde_json::{Value, json};
use studies::solution::{FinalState, VtuSeries};
use studies::trade::Wanted;
use studies::trade::estimate::{companion_runs, estimate};
use vhi::{Decomposition, FixedPoint, Newton, StepSolver};

/// `sweep solve`.
#[derive(Args)]
#[command(
    after_help = "Keys of --json: docs/JSON.md. docs/TRADE.md explains the estimates. Exit code 2 with --target: the error of this run has no order to go on with, or no n and N in reach have the error."
)]
pub(crate) struct Solve {
    /// Name of a scene, or path of a TOML file
    scene: String,
    /// Cells per unit length, h = 1/n; abstract scenes have none
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=4096))]
    n: Option<u32>,
    /// Number N of time steps, k = T/N
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=10_000_000))]
    steps: u32,
    /// Method for a time level: Newton's; the fixed-point iteration Λ of Theorem 6, which converges
    /// only for small k; or the decomposition of Remark 3, convex problems with the concave quadratic
    /// part of j explicit, which converges where (2.9) holds
    #[arg(long, value_enum, default_value_t = Solver::Newton)]
    solver: Solver,
    /// Estimate the error of this run in h and k from coarser companions (2h, 4h and 2k, 4k), for
    /// scenes without an exact solution; n and N must be multiples of 4, but any N will do where levels do not
    /// depend on each other (no memory, no zeta): they have no error in k. Convex problems in the plane have a
    /// guaranteed bound of the error in space beside it
    #[arg(long, conflicts_with = "solver")]
    estimate: bool,
    /// Say which n and N reach this error at least predicted cost, from the estimate alone: `1%` is a
    /// hundredth of the largest strain norm of this run (V_max alone), a plain number is an error in the
    /// norm. A second pair is cautious: there the upper end of the error's interval is this error
    #[arg(long, value_name = "E", requires = "estimate")]
    target: Option<String>,
    /// Norm of --target: V_max, L2_max, trace_L2_max, pressure_L2_max or stress_L2_max
    #[arg(long, requires = "target", default_value = "V_max")]
    norm: String,
    /// Write one VTU file per step and a .pvd index into this directory
    #[arg(long, value_name = "DIR")]
    vtu: Option<PathBuf>,
    /// Write pictures of a plane body into this directory: SCENE-contact.svg, the contact state on Γ3
    /// over time, and SCENE-body.svg, the deformed body with its stress at t = T
    #[arg(long, value_name = "DIR", conflicts_with = "estimate")]
    pictures: Option<PathBuf>,
    #[command(flatten)]
    common: Common,
}

/// The solver of a time level.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum Solver {
    Newton,
    FixedPoint,
    Decomposition,
}

impl Solver {
    fn of_levels(self) -> Box<dyn StepSolver> {
        match self {
            Self::Newton => Box::new(Newton::default()),
            Self::FixedPoint => Box::new(FixedPoint::default()),
            Self::Decomposition => Box::new(Decomposition::default()),
        }
    }
}

impl Solve {
    pub(super) fn execute(&self, scenes: &Scenes) -> Result<u8, CliError> {
        let scene = scenes.scene(&self.scene)?;
        let subject = subject(scene, &self.common.allowance.limit())?;
        if let Some(remark) = scene::setup::check_step_sizes(&subject, &[self.steps])? {
            super::output::remark(&subject.scene().name, &remark);
        }
        match (subject, self.n) {
            (Subject::Contact(setup), Some(n)) => {
                setup.scene.check_cells(n)?;
                admit(&setup, None, (n, self.steps), &self.common.allowance.limit())?;
                match self.estimate {
                    true => self.estimated(&setup, n),
                    false => self.contact(&setup, n),
                }
            }
            (Subject::Abstract(setup), _) if self.estimate => {
                let hint = "sweep run measures its error against the exact solution";
                let message = "--estimate needs a mesh";
                Err(setup.scene.error("scene.kind", message, hint).into())
            }
            (Subject::Abstract(setup), n) => {
                studies::study::no_mesh(&setup.scene, n)?;
                let (steps, solver) = (self.steps, self.solver.of_levels());
                let bound = self.decomposes().then(|| abstract_decomposition_bound(&setup, steps));
                self.remark_on(&setup.scene.name, bound);
                abstract_problem::solve(&setup, steps, &*solver, bound, self.common.json)
            }
            (Subject::Contact(setup), None) => {
                let hint = "give --n, the number of mesh cells per unit length";
                Err(setup.scene.error("sweep.n", "a body needs a mesh", hint).into())
            }
        }
    }

    /// Estimates the error and recommends n and N; invalid arguments are refused before any run.
    fn estimated(&self, setup: &Setup, n: u32) -> Result<u8, CliError> {
        let limit = self.common.allowance.limit();
        let wanted = Wanted::read(setup, &self.norm, self.target.as_deref())?;
        let singular = "its extrapolation assumes the order of the time rule";
        setup.scene.without(&[Extension::SingularKernel], "sweep solve --estimate", singular)?;
        companion_runs(setup, n, self.steps).admit(&limit)?;
        let mut files = Files::new(self.vtu.as_ref(), &setup.scene.name)?;
        let mut pull = Pull::default();
        let mut watch = |space: &Discretization, view: &StepView<'_>| {
            files.write(space, &setup.model, view);
            pull.see(space, view);
        };
        let found = estimate(setup, [n, self.steps], wanted, &limit, &mut watch)?;
        files.finish()?;
        pull.remark(setup);
        match self.common.json {
            true => print_json(&found.json)?,
            false => print_text(&found.document.text(width(StudyDocument::WIDTH))),
        }
        // The estimate is printed before a target is refused.
        let refused = |none| Err(CliError::other(format!("no recommendation: {none}")));
        found.refused.map_or(Ok(0), refused)
    }

    fn decomposes(&self) -> bool {
        matches!(self.solver, Solver::Decomposition)
    }

    /// Warns that the decomposition may not converge.
    fn remark_on(&self, name: &str, bound: Option<f64>) {
        let Some(bound) = bound.filter(|bound| bound.is_nan() || *bound >= 1.0) else { return };
        let text = format!(
            "(alpha_nu c_j^2 + alpha_tau c_tau^2)/m = {bound:.4} is not below one: the decomposition need not contract; --solver newton does not depend on that"
        );
        super::output::remark(name, &StepRemark { warning: true, text });
    }

    fn contact(&self, setup: &Setup, n: u32) -> Result<u8, CliError> {
        let start = Instant::now();
        let data = MeshData::new(setup, n, None)?;
        let limit = self.common.allowance.limit();
        admit(setup, Some(&data.space), (n, self.steps), &limit)?;
        let bound = || decomposition_bound(setup, &data.space, n, self.steps);
        let bound = self.decomposes().then(bound).transpose()?;
        self.remark_on(&setup.scene.name, bound);
        let (name, plane) = (&setup.scene.name, data.space.mesh.dimension == 2);
        let mut files = Files::new(self.vtu.as_ref(), name)?;
        let mut pull = Pull::default();
        if self.pictures.is_some() && !plane {
            let way_out = "--pictures draws plane bodies only; use --vtu for any body";
            return Err(CliError::about(name, way_out));
        }
        let drawn = self.pictures.as_ref();
        let mut pictures = drawn.map(|dir| (dir, Pictures::new(&data.space, name, n, self.steps)));
        let mut last = None;
        let mut observe = |view: &StepView<'_>| {
            files.write(&data.space, &setup.model, view);
            pull.see(&data.space, view);
            let end = view.n == self.steps as usize;
            if let Some((_, pictures)) = &mut pictures {
                pictures.add(&data.space, &setup.model, data.truth.as_ref(), view, end)?;
            }
            if end {
                last = Some(FinalState::new(&data.space, &setup.model, view));
            }
            Ok(())
        };
        let steps = self.steps;
        let info = data
            .march(setup, steps, &*self.solver.of_levels(), &mut observe)
            .map_err(|error| CliError::about(format!("{name} n = {n} steps = {steps}"), error))?;
        let seconds = start.elapsed().as_secs_f64();
        files.finish()?;
        pull.remark(setup);
        if let Some((dir, pictures)) = pictures {
            make_directory(dir)?;
            for (file, svg) in pictures.finish() {
                replace_file(&dir.join(file), svg.as_bytes())?;
            }
        }
        let state = last.ok_or_else(|| CliError::other("the run stopped before its last step"))?;
        let linear = &info.work.linear;
        let mut document = serde_json::to_value(state)?;
        let of_run = json!({
            "newton_iterations": info.newton_iterations,
            "fixed_point_iterations": info.fixed_point_iterations,
            "convex_problems": info.convex_problems,
            "contraction": bound.map(|_| info.contraction),
            "contraction_bound": bound,
            "factorizations": linear.factorizations,
            "linear_solves": linear.solves,
            "kkt_residual": info.kkt_residual,
            "seconds": seconds,
            "dofs": data.space.dofs(),
            "peak_resident_bytes": peak_resident_bytes(),
        });
        if let (Some(all), Value::Object(of_run)) = (document.as_object_mut(), of_run) {
            all.extend(of_run);
        }
        if self.common.json {
            print_json(&document)?;
            return Ok(0);
        }
        let case = format!(
            "{name}, n = {n} (h = {}), N = {steps} (k = {})",
            digits(setup.body.domain.h(n), 4),
            digits(setup.grid(steps).largest_step(), 4)
        );
        print_text(&words::in_words(&case, &document, data.space.mesh.dimension));
        Ok(0)
    }
}

/// The VTU files of a run, and the first reason why one could not be written.
struct Files(Option<VtuSeries>, Option<CliError>);

impl Files {
    fn new(dir: Option<&PathBuf>, name: &str) -> Result<Self, CliError> {
        let series = dir.map(|dir| VtuSeries::new(dir, name)).transpose();
        Ok(Self(series?, None))
    }

    fn write(&mut self, space: &Discretization, model: &Model, view: &StepView<'_>) {
        if let Some(Err(error)) = self.0.as_mut().map(|series| series.write(space, model, view)) {
            self.1.get_or_insert(CliError::other(error));
        }
    }

    fn finish(self) -> Result<(), CliError> {
        match self {
            Self(_, Some(error)) => Err(error),
            Self(Some(series), None) => series.finish().map(drop).map_err(CliError::other),
            Self(None, None) => Ok(()),
        }
    }
}

/// The strongest pull of a law on the body, ∫ min(ξ, 0), and when.
#[derive(Default)]
struct Pull {
    force: f64,
    t: f64,
}

impl Pull {
    fn see(&mut self, space: &Discretization, view: &StepView<'_>) {
        let points = space.trace.points.iter().zip(view.compliance);
        let force: f64 = points.map(|(point, xi)| point.weight * xi.min(0.0)).sum();
        if force < self.force {
            *self = Self { force, t: view.t };
        }
    }

    /// Warns where a law pulls at open contact, which a layer that is pressed cannot do.
    fn remark(&self, setup: &Setup) {
        let mut laws = setup.body.laws().filter(|_| self.force < 0.0);
        if let Some(instead) = laws.find_map(Law::one_sided) {
            let text = format!(
                "the contact law pulls the body with {} at t = {}: it is two-sided, p < 0 where contact is open; {instead} presses alone",
                digits(self.force, 4),
                digits(self.t, 4),
            );
            super::output::remark(&setup.scene.name, &StepRemark { warning: true, text });
        }
    }
}

/// Peak resident memory of this process (Linux only).
fn peak_resident_bytes() -> Option<u64> {
    let kibibytes = status_of_process("VmHWM")?.strip_suffix("kB")?.trim().parse::<u64>().ok()?;
    Some(1024 * kibibytes)
}
