//! Defects of the kinds that orders are blind to: what measures and meshes are made of, truths that are runs, multipliers,
//! answers of other solvers, and what a report shows. Some were once seen by a recorded number or by nothing.

use std::sync::Arc;

use algebra::linalg::larger;
use fem::contact::StepView;
use fem::norms::Moments;
use fem::space::Element;
use judge::record::{CaseRecord, V_MAX};
use judge::verdict::{Decision, Verdict};
use nalgebra::{DMatrix, DVector};
use run::external::Answer;
use run::sweep::CasePlan;
use scene::setup::{AbstractSetup, MeshData, Setup};
use scene::{Norm, Shape, TimeGrid};

use super::Term::{self, Abstract, Measurement};
use super::contact::gap;
use super::levels::march_by_two_points;
use super::records::finest;
use super::time::sound;
use super::{CaseSeed, Defect, Shown, Site};
use crate::wrong::Rule;

fn rests(moments: &mut Moments) -> [&mut f64; 5] {
    let Moments { strain, stress, displacement, normal, pressure, .. } = moments;
    [
        &mut strain.rest,
        &mut stress.rest,
        &mut displacement.rest,
        &mut normal.rest,
        &mut pressure.rest,
    ]
}

/// A truth read off at another time.
fn late(name: &'static str, time: fn(&Site<'_>, f64) -> f64) -> Defect {
    let seed = move |site: &Site<'_>, t| Ok((*site.sound.moments(time(site, t))?).clone());
    Defect { moments: Some(Arc::new(seed)), ..Defect::none(Measurement, name) }
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

/// Every h of a scene whose domain is a rectangle or box, or of the others, times a factor.
fn sized(setup: &Setup, record: &mut CaseRecord, [of_box, of_others]: [f64; 2]) {
    let is_box = setup.body.domain.shape == Shape::Box;
    let factor = if is_box { of_box } else { of_others };
    record.h = record.h.map(|h| factor * h);
}

pub fn defects() -> Vec<Defect> {
    let measured = |name, case: CaseSeed| Defect { case, ..Defect::none(Measurement, name) };
    let finite_load = |name, load: super::FiniteSeed| Defect {
        finite_load: Some(load),
        ..Defect::none(Abstract, name)
    };
    let answered = |name, answer: fn(&MeshData, &mut Answer)| Defect {
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
        late("reference run read one step late", |site, t| {
            if site.exact.is_none() && t > LATE { t - LATE } else { t }
        }),
        Measurement.moments("reference run with half of its remainders", |site, _, moments| {
            if site.exact.is_none() {
                rests(moments).into_iter().for_each(|rest| *rest *= 0.5);
            }
        }),
        // A run knows its own times alone.
        late("truth late by a thousandth of the horizon", |site, t| {
            if t > 1e-3 && site.exact.is_some() { t - 1e-3 } else { t }
        }),
        Measurement.moments("true strain 1e-4 too large", |_, _, moments| {
            moments.strain.at.iter_mut().for_each(|e| *e *= 1.0001);
        }),
        Measurement.moments("true displacement 1e-4 too large", |_, _, moments| {
            moments.displacement.node.iter_mut().for_each(|u| *u *= 1.0001);
        }),
        Measurement.moments("true stress 1e-4 too large", |_, _, moments| {
            moments.stress.at.iter_mut().for_each(|s| *s *= 1.0001);
        }),
        Measurement.moments("u_ν of the truth on Γ3 with the other sign", |_, _, moments| {
            moments.normal.node.iter_mut().for_each(|u| *u = -*u);
        }),
        Measurement.moments("true pressure 1e-4 too large", |_, _, moments| {
            moments.pressure.node.iter_mut().for_each(|p| *p *= 1.0001);
        }),
        // The memory from t = 0.
        Term::Zeta.of("ζ without its first step", |setup| {
            setup.model.time_rule = Box::new(Rule::zeta(|grid, n, j| {
                sound(grid, n, j) - if j < 2 && n > 0 { 0.5 * grid.step(1) } else { 0.0 }
            }));
        }),
        Term::Memory.of("kernel to four digits", |setup| {
            setup.model.time_rule = Box::new(Rule::memory(|q, grid, n, j| {
                (1e4 * q.at(grid.time(n), grid.time(j))).round() / 1e4 * sound(grid, n, j)
            }));
        }),
        gap("gap 1e-4 too wide", |sound, x, t| 1.0001 * sound(x, t)),
        Term::Compliance.run("two Gauss points on the edges of Γ3 for three", march_by_two_points),
        Term::Compliance.rebuilt("weight of one vertex of Γ3 doubled", |space, _| {
            let middle = space.trace.points.len() / 2;
            if let Some(point) = space.trace.points.get_mut(middle) {
                point.weight *= 2.0;
            }
        }),
        Term::Elasticity.rebuilt("first cell 1 % too large", |space, _| {
            space.geometry.measure[0] *= 1.01;
        }),
        Term::Elasticity.rebuilt("strains of the first cell 1 % too large", |space, _| {
            let cell =
                space.geometry.shares.len().max(1) * space.mesh.dimension * space.nodes.a_cell;
            space.geometry.gradient[..cell].iter_mut().for_each(|g| *g *= 1.01);
        }),
        Term::Record.each("errors to two digits", |record| {
            record.errors.iter_mut().for_each(|entry| entry.error = entry.error.map(rounded));
        }),
        Term::Record.each("V_time_max written for V_max", |record| {
            let time = record.norm("V_time_max").and_then(|entry| entry.error);
            let first = record.errors.iter_mut().find(|entry| entry.norm == V_MAX);
            if let (Some(first), Some(time)) = (first, time) {
                first.error = Some(time);
            }
        }),
        finest("finest case carries the steps of the one before", |last, before| {
            (last.h, last.k) = (before.h, before.k);
        }),
        finite_load("multiplier of the load 1e-4 too large", |setup, t| {
            load_with(setup, t, [1.0, 1.0001])
        }),
        finite_load("selection of the load 1e-4 too large", |setup, t| {
            load_with(setup, t, [1.0001, 1.0])
        }),
        Abstract.finite("weights of the functionals left out", |setup| {
            setup.model.functionals.iter_mut().for_each(|functional| functional.weight = 1.0);
        }),
        Abstract.finite("upper bounds 1e-4 too high", |setup| {
            setup.model.functionals.iter_mut().for_each(|functional| functional.upper *= 1.0001);
        }),
        Abstract.finite("norm of X without its inner product", |setup| {
            let m = setup.model.inner_product.nrows();
            setup.model.inner_product = DMatrix::identity(m, m);
        }),
        answered("answer on Γ1 taken for zero", |data, answer| {
            let nodes = &data.space.nodes;
            let (d, row) = (nodes.dimension, nodes.of_vertex.len() * nodes.dimension);
            for level in answer.displacement.chunks_exact_mut(row) {
                for &vertex in &nodes.vertex[nodes.free..] {
                    level[d * vertex as usize..d * (vertex as usize + 1)].fill(0.0);
                }
            }
        }),
        answered("last level of an answer read twice", |data, answer| {
            let row = data.space.nodes.of_vertex.len() * data.space.nodes.dimension;
            let last = answer.displacement.len() - row;
            answer.displacement.copy_within(last - row..last, last);
        }),
        answered("components of an answer exchanged", |data, answer| {
            let d = data.space.nodes.dimension;
            answer.displacement.chunks_exact_mut(d).for_each(|u| u.swap(0, 1));
        }),
        answered("pressures of an answer taken from the level before", |data, answer| {
            let row = data.space.trace.points.len();
            if let Some(pressure) = answer.pressure.as_mut().filter(|_| row > 0) {
                pressure.rotate_right(row);
            }
        }),
        answered("midpoints of an answer between their corners", |data, answer| {
            let (space, vertex) = (&data.space, &data.space.nodes.vertex);
            if space.element != Element::P2 {
                return;
            }
            let (d, row) = (space.nodes.dimension, space.nodes.of_vertex.len());
            let at = |v: u32| d * v as usize..d * (v as usize + 1);
            for level in answer.displacement.chunks_exact_mut(row * d) {
                let by_node: Vec<f64> =
                    vertex.iter().flat_map(|&v| level[at(v)].to_vec()).collect();
                let linear = crate::shipped::midpoints_between_corners(space, &by_node);
                for (&v, u) in vertex.iter().zip(linear.chunks_exact(d)) {
                    level[at(v)].copy_from_slice(u);
                }
            }
        }),
    ]
}

fn shown_as(
    name: &'static str,
    shown: impl Fn(&mut Vec<CaseRecord>, &mut Vec<Verdict>) + Send + Sync + 'static,
) -> Defect {
    let shown = move |(records, verdicts): &mut Shown| shown(records, verdicts);
    Defect { shown: Some(Arc::new(shown)), ..Defect::none(Term::Report, name) }
}

/// h, k, error and floor of the points of verdicts and of the cases of records, changed alike.
fn with(name: &'static str, change: fn(&mut [f64; 4])) -> Defect {
    shown_as(name, move |records, verdicts| {
        for record in records {
            for entry in &mut record.errors {
                let [h, error, floor] =
                    [record.h, entry.error, entry.floor].map(|number| number.unwrap_or(f64::NAN));
                let mut numbers = [h, record.k, error, floor];
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
    })
}

fn verdicts(name: &'static str, change: fn(&mut Verdict)) -> Defect {
    shown_as(name, move |_, verdicts| verdicts.iter_mut().for_each(change))
}

/// A report that is given these in place of what was found.
pub fn shown() -> Vec<Defect> {
    vec![
        verdicts("the predicted order shown as the observed one", |verdict| {
            verdict.observed = Some(verdict.predicted);
        }),
        with("h and k exchanged in a report", |numbers| numbers.swap(0, 1)),
        verdicts("the forest against the order 1", |verdict| verdict.predicted = 1.0),
        with("floors shown as errors", |numbers| numbers[2] = numbers[3]),
        with("errors shown as floors", |numbers| numbers[3] = numbers[2]),
        with("k of a report for the horizon 1", |numbers| numbers[1] /= 3.0),
        verdicts("intervals of a report half as wide", |verdict| {
            if let (Some(order), Some(ends)) = (verdict.observed, &mut verdict.interval) {
                ends.iter_mut().for_each(|end| *end = 0.5 * (*end + order));
            }
        }),
        verdicts("a failed verdict shown as a pass", |verdict| verdict.decision = Decision::Pass),
        shown_as("the finest case left out of a report", |records, verdicts| {
            records.retain(|record| record.n != Some(64) || record.scene == "in-time");
            verdicts.iter_mut().for_each(|verdict| drop(verdict.points_used.pop()));
        }),
        verdicts("norms exchanged in a report", |verdict| {
            verdict.norm = if verdict.norm == V_MAX { "L2_max" } else { V_MAX }.into();
        }),
    ]
}
