//! Defects of the kinds that orders are blind to: what measures and meshes are made of, truths that are runs, multipliers,
//! answers of other solvers, and what a report shows. Some were once seen by a recorded number or by nothing.

use algebra::linalg::larger;
use fem::contact::{LoadError, StepView};
use fem::norms::Moments;
use fem::space::Element;
use judge::record::{CaseRecord, V_MAX};
use judge::verdict::{Decision, Verdict};
use nalgebra::{DMatrix, DVector};
use run::external::Answer;
use run::sweep::CasePlan;
use scene::setup::{AbstractSetup, MeshData, Setup};
use scene::{Norm, Shape, TimeGrid};
use vhi::history::{TimeRule, Trapezoid};
use vhi::law::HistoryKernel;

use super::contact::{gap, rebuilt};
use super::levels::march_by_two_points;
use super::{CaseSeed, Defect, MomentSeed, Shown, Site, Term, marched};

fn changed(
    site: &Site<'_>,
    t: f64,
    change: impl FnOnce(&mut Moments),
) -> Result<Moments, LoadError> {
    let mut moments = (*site.sound.moments(t)?).clone();
    change(&mut moments);
    Ok(moments)
}

/// A truth that is a run on a finer mesh, read off later or with a share of what its projection leaves.
fn of_a_run(site: &Site<'_>, t: f64, late: f64, share: f64) -> Result<Moments, LoadError> {
    if site.exact.is_some() {
        return changed(site, t, |_| ());
    }
    changed(site, if t > late { t - late } else { t }, |moments| {
        for rest in [
            &mut moments.strain.rest,
            &mut moments.stress.rest,
            &mut moments.displacement.rest,
            &mut moments.normal.rest,
            &mut moments.pressure.rest,
        ] {
            *rest *= share;
        }
    })
}

/// A step of the run that is a truth in `tests/sabotage/norms.rs`.
const LATE: f64 = 0.25;

/// The largest of a value over the levels of a case in place of a norm of the record.
fn written(
    norm: Norm,
    (setup, data, case): (&Setup, &MeshData, &CasePlan),
    record: &mut CaseRecord,
    mut value: impl FnMut(&StepView<'_>) -> f64,
) {
    let Some(entry) = record.errors.iter_mut().find(|entry| entry.norm == norm.name()) else {
        return;
    };
    let mut most = 0.0;
    let run = setup.scheme.march(setup, data, case.steps, &mut |view| {
        most = larger(most, value(view));
        Ok(())
    });
    if run.is_ok() {
        entry.error = Some(most);
    }
}

/// Σ |ε(u - v)|² over cells without its shear.
fn without_shear(data: &MeshData, u: &[f64], v: &[f64]) -> f64 {
    let difference: Vec<f64> = u.iter().zip(v).map(|(u, v)| u - v).collect();
    let plane = data.space.mesh.dimension == 2;
    let square = |strain: &[f64]| strain.iter().map(|e| e * e).sum::<f64>();
    let cells = data.space.points().map(|at| match plane {
        true => at.weight * square(&at.strain::<3>(&difference)[..2]),
        false => at.weight * square(&at.strain::<6>(&difference)[..3]),
    });
    cells.sum::<f64>().sqrt()
}

/// V_time_max from normal strains alone.
fn time_without_shear(setup: &Setup, data: &MeshData, case: &CasePlan, record: &mut CaseRecord) {
    let Ok(finer) = data.trajectory(setup, 8 * case.steps, case.steps) else { return };
    written(Norm::VTimeMax, (setup, data, case), record, |view| {
        finer.at(view.t).map_or(f64::NAN, |other| without_shear(data, view.u, other))
    });
}

/// V_time_max against 4 N steps.
fn time_against_half(setup: &Setup, data: &MeshData, case: &CasePlan, record: &mut CaseRecord) {
    let Ok(finer) = data.trajectory(setup, 4 * case.steps, case.steps) else { return };
    written(Norm::VTimeMax, (setup, data, case), record, |view| {
        let finer = finer.at(view.t);
        finer.map_or(f64::NAN, |other| fem::contact::strain_distance(&data.space, view.u, other))
    });
}

/// Stress with each shear counted once.
fn stress_with_shear_once(
    setup: &Setup,
    data: &MeshData,
    case: &CasePlan,
    record: &mut CaseRecord,
) {
    if data.space.mesh.dimension != 2 {
        return;
    }
    written(Norm::StressL2Max, (setup, data, case), record, |view| {
        let Ok(moments) = data.truth.moments(view.t) else { return f64::NAN };
        let exact = moments.stress.at.as_chunks::<3>().0;
        let cells = data.space.points().map(|at| {
            let found = view.stress_of(&data.space, &setup.model, &at, &at.strain::<3>(view.u));
            let part = |i: usize| (found[i] - exact[at.index][i]).powi(2);
            at.weight * (part(0) + part(1) + 0.5 * part(2))
        });
        (cells.sum::<f64>() + moments.stress.rest).sqrt()
    });
}

/// The distance of contact sets where both have points, 0 where one has none.
fn distance_of_sets(setup: &Setup, data: &MeshData, case: &CasePlan, record: &mut CaseRecord) {
    let model = &setup.model;
    written(Norm::ContactSetMax, (setup, data, case), record, |view| {
        let Ok(moments) = data.truth.moments(view.t) else { return f64::NAN };
        let trace = &data.space.trace;
        let held = (0..trace.points.len()).any(|i| {
            let point = &trace.points[i];
            let gap = model.gap(point.side, data.space.mesh.point(&[point.vertex], &[1.0]), view.t);
            fem::norms::is_locked(trace.normal(i, view.u), gap)
        });
        if held != moments.locked.contains(&true) {
            return 0.0;
        }
        fem::norms::step_errors(&data.space, &setup.model, view, &moments).contact_set
    });
}

/// Weights of the memory from the kernel to four digits.
struct FourDigits;

impl TimeRule for FourDigits {
    fn weight(&self, grid: &vhi::history::TimeGrid, n: usize, j: usize) -> f64 {
        Trapezoid.weight(grid, n, j)
    }

    fn kernel_weight(
        &self,
        q: &dyn HistoryKernel,
        grid: &vhi::history::TimeGrid,
        n: usize,
        j: usize,
    ) -> f64 {
        (1e4 * q.at(grid.time(n), grid.time(j))).round() / 1e4 * self.weight(grid, n, j)
    }
}

/// ζ from t_1 on, the memory from t = 0.
struct WithoutFirstStep;

impl TimeRule for WithoutFirstStep {
    fn weight(&self, grid: &vhi::history::TimeGrid, n: usize, j: usize) -> f64 {
        let first = if j < 2 && n > 0 { 0.5 * grid.step(1) } else { 0.0 };
        Trapezoid.weight(grid, n, j) - first
    }

    fn kernel_weight(
        &self,
        q: &dyn HistoryKernel,
        grid: &vhi::history::TimeGrid,
        n: usize,
        j: usize,
    ) -> f64 {
        Trapezoid.kernel_weight(q, grid, n, j)
    }
}

/// The multipliers or the selections of the load of an abstract problem, times a factor.
fn load_with(setup: &AbstractSetup, t: f64, [selection, multiplier]: [f64; 2]) -> DVector<f64> {
    let state = setup.state(t);
    let mut load = DVector::from_column_slice(&state.load);
    for (i, functional) in setup.model.functionals.iter().enumerate() {
        let more =
            (selection - 1.0) * state.selection[i] + (multiplier - 1.0) * state.multiplier[i];
        load += functional.weight * more * &functional.a;
    }
    load
}

/// To two digits.
fn rounded(value: f64) -> f64 {
    format!("{value:.1e}").parse().unwrap_or(value)
}

fn each(mut records: Vec<CaseRecord>, change: impl Fn(&mut CaseRecord)) -> Vec<CaseRecord> {
    records.iter_mut().for_each(change);
    records
}

macro_rules! on_mesh {
    ($term:expr, $name:literal, $change:expr) => {
        Defect::of($term, $name, |setup| {
            marched(setup, |setup, data, steps, observe| {
                rebuilt(setup, data, steps, observe, $change)
            })
        })
    };
}

/// Every h of a scene whose domain is a rectangle or box, or of the others, times a factor.
fn sized(setup: &Setup, record: &mut CaseRecord, [of_box, of_others]: [f64; 2]) {
    let is_box = setup.body.domain.shape == Shape::Box;
    let factor = if is_box { of_box } else { of_others };
    record.h = record.h.map(|h| factor * h);
}

pub fn defects() -> Vec<Defect> {
    let measured = |name, case: CaseSeed| Defect { case, ..Defect::none(Term::Measurement, name) };
    let truth = |name, moments: MomentSeed| Defect {
        moments: Some(moments),
        ..Defect::none(Term::Measurement, name)
    };
    let recorded = |name, records: fn(Vec<CaseRecord>) -> Vec<CaseRecord>| Defect {
        records,
        ..Defect::none(Term::Record, name)
    };
    let finite = |name, abstract_program: fn(AbstractSetup) -> AbstractSetup| Defect {
        abstract_program,
        ..Defect::none(Term::Abstract, name)
    };
    let finite_load = |name, load: super::FiniteSeed| Defect {
        finite_load: Some(load),
        ..Defect::none(Term::Abstract, name)
    };
    let answered = |name, answer: fn(&MeshData, Answer) -> Answer| Defect {
        answer,
        ..Defect::none(Term::Answer, name)
    };
    vec![
        measured("V_time_max without shear", time_without_shear),
        measured("V_time_max against 4 N steps", time_against_half),
        measured("stress norm with shear once", stress_with_shear_once),
        measured("distance of contact sets 0 where one is empty", distance_of_sets),
        measured("measure of unlike contact sets halved", |_, _, _, record| {
            for entry in record.errors.iter_mut().filter(|e| e.norm == "contact_measure_max") {
                entry.error = entry.error.map(|error| 0.5 * error);
            }
        }),
        measured("h of rectangles and boxes doubled", |setup, _, _, record| {
            sized(setup, record, [2.0, 1.0]);
        }),
        measured("h of polygons the shortest edge", |setup, _, _, record| {
            sized(setup, record, [1.0, 0.5f64.sqrt()]);
        }),
        measured("k of other grids the mean step", |setup, _, case, record| {
            if setup.scene.time.grid != TimeGrid::Uniform {
                record.k = setup.scene.time.horizon / f64::from(case.steps);
            }
        }),
        truth("reference run read one step late", |site, t| of_a_run(site, t, LATE, 1.0)),
        truth("reference run with half of its remainders", |site, t| of_a_run(site, t, 0.0, 0.5)),
        truth("truth late by a thousandth of the horizon", |site, t| {
            // A run knows its own times alone.
            let late = if t > 1e-3 && site.exact.is_some() { t - 1e-3 } else { t };
            changed(site, late, |_| ())
        }),
        truth("true strain 1e-4 too large", |site, t| {
            changed(site, t, |moments| moments.strain.at.iter_mut().for_each(|e| *e *= 1.0001))
        }),
        truth("true displacement 1e-4 too large", |site, t| {
            changed(site, t, |moments| {
                moments.displacement.node.iter_mut().for_each(|u| *u *= 1.0001);
            })
        }),
        truth("true stress 1e-4 too large", |site, t| {
            changed(site, t, |moments| moments.stress.at.iter_mut().for_each(|s| *s *= 1.0001))
        }),
        truth("u_ν of the truth on Γ3 with the other sign", |site, t| {
            changed(site, t, |moments| moments.normal.node.iter_mut().for_each(|u| *u = -*u))
        }),
        truth("true pressure 1e-4 too large", |site, t| {
            changed(site, t, |moments| moments.pressure.node.iter_mut().for_each(|p| *p *= 1.0001))
        }),
        Defect::of(Term::Zeta, "ζ without its first step", |mut setup| {
            setup.model.time_rule = Box::new(WithoutFirstStep);
            setup
        }),
        Defect::of(Term::Memory, "kernel to four digits", |mut setup| {
            setup.model.time_rule = Box::new(FourDigits);
            setup
        }),
        Defect::of(Term::Gap, "gap 1e-4 too wide", |setup| gap(setup, |_, g| 1.0001 * g)),
        Defect::of(Term::Compliance, "two Gauss points on the edges of Γ3 for three", |setup| {
            marched(setup, |setup, data, steps, observe| {
                march_by_two_points(setup, data, steps, observe)
            })
        }),
        on_mesh!(Term::Compliance, "weight of one vertex of Γ3 doubled", |space, _| {
            let middle = space.trace.points.len() / 2;
            if let Some(point) = space.trace.points.get_mut(middle) {
                point.weight *= 2.0;
            }
        }),
        on_mesh!(Term::Elasticity, "first cell 1 % too large", |space, _| {
            space.geometry.measure[0] *= 1.01;
        }),
        on_mesh!(Term::Elasticity, "strains of the first cell 1 % too large", |space, _| {
            let cell =
                space.geometry.shares.len().max(1) * space.mesh.dimension * space.nodes.a_cell;
            space.geometry.gradient[..cell].iter_mut().for_each(|g| *g *= 1.01);
        }),
        recorded("errors to two digits", |records| {
            each(records, |record| {
                record.errors.iter_mut().for_each(|entry| entry.error = entry.error.map(rounded));
            })
        }),
        recorded("V_time_max written for V_max", |records| {
            each(records, |record| {
                let time = record.norm("V_time_max").and_then(|entry| entry.error);
                let first = record.errors.iter_mut().find(|entry| entry.norm == V_MAX);
                if let (Some(first), Some(time)) = (first, time) {
                    first.error = Some(time);
                }
            })
        }),
        recorded("finest case carries the steps of the one before", |mut records| {
            records.sort_by_key(CaseRecord::key);
            if let [.., before, last] = records.as_mut_slice() {
                (last.h, last.k) = (before.h, before.k);
            }
            records
        }),
        finite_load("multiplier of the load 1e-4 too large", |setup, t| {
            load_with(setup, t, [1.0, 1.0001])
        }),
        finite_load("selection of the load 1e-4 too large", |setup, t| {
            load_with(setup, t, [1.0001, 1.0])
        }),
        finite("weights of the functionals left out", |mut setup| {
            setup.model.functionals.iter_mut().for_each(|functional| functional.weight = 1.0);
            setup
        }),
        finite("upper bounds 1e-4 too high", |mut setup| {
            setup.model.functionals.iter_mut().for_each(|functional| functional.upper *= 1.0001);
            setup
        }),
        finite("norm of X without its inner product", |mut setup| {
            let m = setup.model.inner_product.nrows();
            setup.model.inner_product = DMatrix::identity(m, m);
            setup
        }),
        answered("answer on Γ1 taken for zero", |data, mut answer| {
            let nodes = &data.space.nodes;
            let (d, row) = (nodes.dimension, nodes.of_vertex.len() * nodes.dimension);
            for level in answer.displacement.chunks_exact_mut(row) {
                for &vertex in &nodes.vertex[nodes.free..] {
                    level[d * vertex as usize..d * (vertex as usize + 1)].fill(0.0);
                }
            }
            answer
        }),
        answered("last level of an answer read twice", |data, mut answer| {
            let row = data.space.nodes.of_vertex.len() * data.space.nodes.dimension;
            let last = answer.displacement.len() - row;
            answer.displacement.copy_within(last - row..last, last);
            answer
        }),
        answered("components of an answer exchanged", |data, mut answer| {
            let d = data.space.nodes.dimension;
            answer.displacement.chunks_exact_mut(d).for_each(|u| u.swap(0, 1));
            answer
        }),
        answered("pressures of an answer taken from the level before", |data, mut answer| {
            let row = data.space.trace.points.len();
            if let Some(pressure) = answer.pressure.as_mut().filter(|_| row > 0) {
                pressure.rotate_right(row);
            }
            answer
        }),
        answered("midpoints of an answer between their corners", |data, mut answer| {
            let space = &data.space;
            if space.element == Element::P2 {
                let (d, row) = (space.nodes.dimension, space.nodes.of_vertex.len());
                for level in answer.displacement.chunks_exact_mut(row * d) {
                    let by_node: Vec<f64> = space
                        .nodes
                        .vertex
                        .iter()
                        .flat_map(|&v| {
                            let at = d * v as usize;
                            level[at..at + d].to_vec()
                        })
                        .collect();
                    let linear = crate::shipped::midpoints_between_corners(space, &by_node);
                    for (node, &v) in space.nodes.vertex.iter().enumerate() {
                        let at = d * v as usize;
                        level[at..at + d].copy_from_slice(&linear[d * node..d * (node + 1)]);
                    }
                }
            }
            answer
        }),
    ]
}

/// The points of verdicts and the cases of records, changed alike.
fn with((mut records, mut verdicts): Shown, change: impl Fn(&mut [f64; 4])) -> Shown {
    for record in &mut records {
        for entry in &mut record.errors {
            let nan = f64::NAN;
            let mut numbers = [
                record.h.unwrap_or(nan),
                record.k,
                entry.error.unwrap_or(nan),
                entry.floor.unwrap_or(nan),
            ];
            change(&mut numbers);
            (record.h, record.k) = (Some(numbers[0]), numbers[1]);
            (entry.error, entry.floor) = (Some(numbers[2]), Some(numbers[3]));
        }
    }
    for used in verdicts.iter_mut().flat_map(|verdict| &mut verdict.points_used) {
        let point = &mut used.point;
        let mut numbers = [point.h, point.k, point.error, point.floor];
        change(&mut numbers);
        [point.h, point.k, point.error, point.floor] = numbers;
    }
    (records, verdicts)
}

fn verdicts((records, mut verdicts): Shown, change: impl Fn(&mut Verdict)) -> Shown {
    verdicts.iter_mut().for_each(change);
    (records, verdicts)
}

/// A report that is given these in place of what was found.
pub fn shown() -> Vec<Defect> {
    let of = |name, shown: fn(Shown) -> Shown| Defect { shown, ..Defect::none(Term::Report, name) };
    vec![
        of("the predicted order shown as the observed one", |shown| {
            verdicts(shown, |verdict| verdict.observed = Some(verdict.predicted))
        }),
        of("h and k exchanged in a report", |shown| with(shown, |numbers| numbers.swap(0, 1))),
        of("the forest against the order 1", |shown| {
            verdicts(shown, |verdict| verdict.predicted = 1.0)
        }),
        of("floors shown as errors", |shown| with(shown, |numbers| numbers[2] = numbers[3])),
        of("errors shown as floors", |shown| with(shown, |numbers| numbers[3] = numbers[2])),
        of("k of a report for the horizon 1", |shown| with(shown, |numbers| numbers[1] /= 3.0)),
        of("intervals of a report half as wide", |shown| {
            verdicts(shown, |verdict| {
                if let (Some(order), Some(ends)) = (verdict.observed, &mut verdict.interval) {
                    ends.iter_mut().for_each(|end| *end = 0.5 * (*end + order));
                }
            })
        }),
        of("a failed verdict shown as a pass", |shown| {
            verdicts(shown, |verdict| verdict.decision = Decision::Pass)
        }),
        of("the finest case left out of a report", |(mut records, mut verdicts)| {
            records.retain(|record| record.n != Some(64) || record.scene == "in-time");
            verdicts.iter_mut().for_each(|verdict| drop(verdict.points_used.pop()));
            (records, verdicts)
        }),
        of("norms exchanged in a report", |shown| {
            verdicts(shown, |verdict| {
                verdict.norm = if verdict.norm == V_MAX { "L2_max" } else { V_MAX }.into();
            })
        }),
    ]
}
