//! A solver in another program as a [`Scheme`]: each case is a directory of plain files, and the solver writes
//! displacements of all levels.

mod advice;
mod answer;
mod case_files;
mod cause;
mod in_process;
mod left;
mod process;
mod touch;

use std::path::PathBuf;
use std::time::{Duration, Instant};

pub use self::advice::{by_density, look_for_cause, on_pressures, solver_first};
use self::answer::read_array;
pub use self::answer::{AnswerError, Array, NpyError, decode, encode, read_displacements};
pub(crate) use self::answer::{DISPLACEMENT, DISPLACEMENT_TABLE, PRESSURE};
pub use self::case_files::{ContactRow, Given, case_dir, write_case};
pub use self::cause::cause_of;
pub use self::in_process::{Answer, InProcess, Solve};
pub use self::process::{LOG, ProcessError, end_solvers, last_lines};
use fem::contact::{
    CaseError, CaseInfo, Discretization, Histories, Model, Observer, StepView, strain_norm,
};
use files::{remove_if_there, shortened};
pub use judge::verdict::{Cause, Explanation};
use scene::setup::{MeshData, Scheme, Setup};
use vhi::history::TimeGrid;
use vhi::law::Projection;

/// How a case gets its answer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Way {
    /// Runs a command with the directory of the case as its last argument.
    Command {
        words: Vec<String>,
        /// Time limit for the command and for reading its answer.
        limit: Duration,
    },
    /// The answer exists already.
    Results,
}

/// A solver outside this program.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ExternalSolver {
    pub way: Way,
    /// Cases are below it, see [`case_dir`].
    pub folder: PathBuf,
    /// Whether it gives pressures as well.
    pub pressures: bool,
}

impl Scheme for ExternalSolver {
    fn march(
        &self,
        setup: &Setup,
        data: &MeshData,
        steps: u32,
        observe: &mut Observer<'_>,
    ) -> Result<CaseInfo, CaseError> {
        let (space, grid) = (&*data.space, setup.grid(steps));
        let dir = case_dir(&self.folder, &setup.scene.name, space.mesh.n, steps);
        let mut until = None;
        if let Way::Command { words, limit } = &self.way {
            // The answer of an earlier run.
            let earlier = [DISPLACEMENT, DISPLACEMENT_TABLE, PRESSURE];
            earlier.iter().try_for_each(|name| remove_if_there(&dir.join(name))).map_err(said)?;
            write_case(&dir, setup, data, steps)?;
            until = Instant::now().checked_add(*limit);
            data.comparing_beside(setup, || process::run(words, &dir, *limit)).map_err(said)?;
        }
        let (levels, d) = (grid.steps() + 1, space.mesh.dimension);
        let u =
            read_displacements(&dir, [levels, space.mesh.vertices(), d], until).map_err(said)?;
        let points = space.trace.points.len();
        let mut given = None;
        if self.pressures && points > 0 {
            let path = dir.join(PRESSURE);
            if !path.exists() {
                let reason = "no such file: write it, or leave out --pressure";
                return Err(said(AnswerError::at(&path)(reason)));
            }
            let axes = "levels N + 1, rows of contact.csv";
            given = Some(read_array(path, &[levels, points], axes, until).map_err(said)?);
        }
        show(space, &setup.model, &grid, (&u, given), observe)
    }
}

/// Limit of a reason in characters, since output of the solver may be quoted in it.
const LONGEST_REASON: usize = 4000;

fn said(error: impl std::fmt::Display) -> CaseError {
    CaseError::Outside(shortened(&error.to_string(), LONGEST_REASON).into_owned())
}

/// Refuses NaN and infinity in an answer: numbers of levels, and in each those of `place`, by index.
fn finite(values: &[f64], levels: usize, place: impl Fn(usize) -> String) -> Result<(), CaseError> {
    let row = values.len() / levels;
    values.iter().position(|value| !value.is_finite()).map_or(Ok(()), |at| {
        Err(said(format!("{} at level {}, {}", values[at], at / row, place(at % row))))
    })
}

/// Largest value on Γ1 as a share of the largest displacement: conditions by a penalty of 1e10 leave less.
const CLAMPED_WITHIN: f64 = 1e-8;
/// A larger share is no penalty that is too small.
const FREE: f64 = 0.01;

/// Shows every level to the measurement. Histories follow from the displacements by the scene's time rule, stresses by
/// this program's laws.
fn show(
    space: &Discretization,
    model: &Model,
    grid: &TimeGrid,
    (u, pressures): (&[f64], Option<Vec<f64>>),
    observe: &mut Observer<'_>,
) -> Result<CaseInfo, CaseError> {
    let (d, axes) = (space.mesh.dimension, ["ux", "uy", "uz"]);
    // Corners stand among the rows of an answer, also where the element has no nodes there.
    let row = space.mesh.vertices() * d;
    let (levels, points) = (grid.steps() + 1, space.trace.points.len());
    finite(u, levels, |at| format!("vertex {}: {} of the displacement", at / d, axes[at % d]))?;
    pressures.iter().try_for_each(|given| {
        finite(given, levels, |at| format!("row {at} of contact.csv: the pressure"))
    })?;
    // V has u = 0 on Γ1, u_ν = 0 on planes of symmetry, and ‖ε(·)‖ is a norm there alone: a body that has moved as a whole has no
    // strain.
    let largest = |most: f64, value: &f64| most.max(value.abs());
    let displaced = u.iter().fold(0.0, largest);
    let most = CLAMPED_WITHIN * displaced;
    let at = |n: usize, vertex: u32| &u[n * row + vertex as usize * d..][..d];
    let held = |n: usize| {
        let clamped = space.nodes.vertex[space.nodes.free..].iter();
        let of = "which is clamped (`clamped` of vertices.csv)";
        clamped.map(move |&vertex| (at(n, vertex).iter().fold(0.0, largest), n, vertex, of))
    };
    let across = |n: usize| {
        let of = "along the normal of a plane of symmetry (symmetry.csv)";
        space.supports.iter().map(move |support| {
            let along = support.normal.iter().zip(at(n, support.vertex)).map(|(n, u)| n * u);
            (along.sum::<f64>().abs(), n, support.vertex, of)
        })
    };
    let all = (0..=grid.steps()).flat_map(|n| held(n).chain(across(n)));
    let worst = all.max_by(|a, b| a.0.total_cmp(&b.0)).filter(|(value, ..)| *value > most);
    if let Some((value, n, vertex, of)) = worst {
        let why = match value > FREE * displaced {
            true => {
                "vertices are numbered otherwise than in vertices.csv, from 0, or are not held there"
            }
            false => "errors are measured in V, whose functions vanish on Gamma1",
        };
        return Err(said(format!(
            "the displacement is {value:e} at level {n}, vertex {vertex}, {of}: it is 0 there, here to {most:.1e}, \
         {CLAMPED_WITHIN:e} of the largest displacement; {why}"
        )));
    }
    let pressures = pressures.unwrap_or_else(|| vec![f64::NAN; levels * points]);
    let mut histories = Histories::new(&model.memory, &*model.time_rule, grid, space.nodes.len());
    let mut info = CaseInfo::default();
    let no_multiplier = vec![0.0; points];
    for n in 0..levels {
        let level = &u[n * row..(n + 1) * row];
        let vertices = space.nodes.vertex.iter().map(|&vertex| vertex as usize * d);
        let nodal: Vec<f64> = vertices.flat_map(|at| level[at..at + d].iter().copied()).collect();
        let strain_norm = strain_norm(space, &nodal);
        let (history, zeta) = histories.level((grid, n), &nodal, strain_norm);
        info.peak_history_bytes = info.peak_history_bytes.max(histories.bytes());
        observe(&StepView {
            n,
            t: grid.time(n),
            u: &nodal,
            history: &history,
            zeta,
            kappa: model.projection.limit().map_or(f64::INFINITY, |limit| limit.value(zeta)),
            strain_norm,
            compliance: &pressures[n * points..(n + 1) * points],
            multiplier: &no_multiplier,
            friction: &[],
        })?;
    }
    Ok(info)
}
