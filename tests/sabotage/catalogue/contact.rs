//! Wrong boundary data on Γ3: law, gap, weights, rule.

use std::sync::Arc;

use fem::contact::{
    BoundaryRule, CaseError, CaseInfo, Discretization, Model, Observer, OnContactInTime, march,
};
use scene::setup::{MeshData, Setup, TruthLoad};
use vhi::Newton;
use vhi::law::{NoPotential, PiecewiseLinear};

use super::{Defect, Term, marched};

/// Points of a law with the slopes outside.
struct Written {
    points: Vec<(f64, f64)>,
    before: f64,
    after: f64,
}

/// The law changed; scenes without one are left alone.
fn law(mut setup: Setup, change: fn(&mut Written)) -> Setup {
    for (contact, boundary) in setup.body.contact.iter().zip(&mut setup.model.boundary) {
        let Some(law) = &contact.law else { continue };
        let points: Vec<(f64, f64)> = law.points.iter().map(|&[r, p]| (r, p)).collect();
        if points.len() < 2 {
            continue;
        }
        let mut written = Written { points, before: law.slope_before, after: law.slope_after };
        change(&mut written);
        let Written { points, before, after } = written;
        boundary.potential =
            Arc::new(PiecewiseLinear::new(points, before, after).expect("a law without a fall"));
    }
    setup
}

pub(super) fn gap(setup: Setup, change: fn([f64; 3], f64) -> f64) -> Setup {
    gap_in_time(setup, move |sound, x, t| change(x, sound(x, t)))
}

/// The setup with another g(x, t), made of the scene's, x and t.
pub(super) fn gap_in_time(
    mut setup: Setup,
    change: impl Fn(&OnContactInTime, [f64; 3], f64) -> f64 + Send + Sync + Clone + 'static,
) -> Setup {
    for boundary in &mut setup.model.boundary {
        let sound = std::mem::replace(&mut boundary.gap, Box::new(|_, _| f64::INFINITY));
        let change = change.clone();
        boundary.gap = Box::new(move |x, t| change(&sound, x, t));
    }
    setup
}

fn shift(mut setup: Setup, change: fn(f64) -> f64) -> Setup {
    for boundary in &mut setup.model.boundary {
        let sound = std::mem::replace(&mut boundary.shift, Box::new(|_| 0.0));
        boundary.shift = Box::new(move |x| change(sound(x)));
    }
    setup
}

fn rule(mut setup: Setup, rule: BoundaryRule) -> Setup {
    let element = setup.body.element;
    for boundary in setup.model.boundary.iter_mut().filter(|_| rule.serves(element)) {
        boundary.rule = rule;
    }
    setup
}

/// The march on a space made for it, with a model that may know it.
pub(super) fn rebuilt(
    setup: &Setup,
    data: &MeshData,
    steps: u32,
    observe: &mut Observer<'_>,
    change: impl Fn(&mut Discretization, &mut Model),
) -> Result<CaseInfo, CaseError> {
    let space = setup.space(data.space.mesh.n).expect("the same mesh");
    let mut space = Arc::into_inner(space).expect("nobody else has it");
    let mut model = setup.scene_model();
    change(&mut space, &mut model);
    let mut load = TruthLoad(&*data.truth);
    march(&space, &model, &setup.grid(steps), &mut load, &Newton::default(), observe)
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

/// Every other vertex of Γ3 without a bound.
fn every_other(space: &mut Discretization, model: &mut Model) {
    let Some(boundary) = model.boundary.first_mut() else { return };
    let n = f64::from(space.mesh.n);
    let sound = std::mem::replace(&mut boundary.gap, Box::new(|_, _| f64::INFINITY));
    boundary.gap = Box::new(move |x, t| {
        let odd = (x[0] * n).round() as i64 % 2 != 0;
        if odd { f64::INFINITY } else { sound(x, t) }
    });
}

/// Places of the two ends of Γ3 in the trace: the least weights, where others have two edges.
fn ends(space: &Discretization) -> Vec<usize> {
    let points = &space.trace.points;
    let least = points.iter().map(|point| point.weight).fold(f64::INFINITY, f64::min);
    (0..points.len()).filter(|&i| points[i].weight < 1.5 * least).collect()
}

/// A stiffness beyond g in place of the constraint.
pub(super) fn penalty(mut setup: Setup, stiffness: f64) -> Setup {
    let constant = setup
        .model
        .boundary
        .first()
        .map(|b| [[0.0; 2], [0.5, 0.0], [0.0, 0.5]].map(|[x, t]| (b.gap)([x, 0.0, 0.0], t)));
    let Some([g, ..]) = constant.filter(|[g, x, t]| g.is_finite() && g == x && g == t) else {
        return setup;
    };
    let written = setup.body.contact.first().and_then(|contact| contact.law.as_ref());
    let points = written.map_or(Vec::new(), |law| law.points.clone());
    let mut points: Vec<(f64, f64)> =
        points.iter().map(|&[r, p]| (r, p)).filter(|&(r, _)| r < g).collect();
    let Some(boundary) = setup.model.boundary.first_mut() else { return setup };
    points.push((g, boundary.potential.subdifferential(g).0));
    let before = written.map_or(0.0, |law| law.slope_before);
    boundary.potential = Arc::new(PiecewiseLinear::new(points, before, stiffness).expect("a law"));
    boundary.gap = Box::new(|_, _| f64::INFINITY);
    setup
}

pub fn defects() -> Vec<Defect> {
    let compliance = |name, program| Defect::of(Term::Compliance, name, program);
    let constraint = |name, program| Defect::of(Term::Gap, name, program);
    vec![
        compliance("falling branch rises", |setup| {
            law(setup, |law| {
                if let [.., (_, top), (_, last)] = law.points.as_mut_slice() {
                    *last = 2.0 * *top - *last;
                }
            })
        }),
        compliance("kink of the law at 1.25 times its place", |setup| {
            law(setup, |law| {
                if law.points.len() > 2 {
                    law.points[1].0 *= 1.25;
                }
            })
        }),
        compliance("rising branch 5 % too steep", |setup| {
            law(setup, |law| law.points[1].1 *= 1.05)
        }),
        compliance("law extended to open contact", |setup| {
            law(setup, |law| {
                let ((r0, p0), (r1, p1)) = (law.points[0], law.points[1]);
                law.before = (p1 - p0) / (r1 - r0);
            })
        }),
        compliance("no compliance", |mut setup| {
            for boundary in &mut setup.model.boundary {
                boundary.potential = Arc::new(NoPotential);
            }
            setup
        }),
        compliance("law constant beyond its last point continues", |setup| {
            law(setup, |law| {
                let count = law.points.len();
                let ((r0, p0), (r1, p1)) = (law.points[count - 2], law.points[count - 1]);
                law.after = (p1 - p0) / (r1 - r0);
            })
        }),
        compliance("shift of the law ignored", |setup| shift(setup, |_| 0.0)),
        compliance("shift of the law with the other sign", |setup| shift(setup, |s| -s)),
        compliance("Gauss points in place of the rule of the scene", |setup| {
            rule(setup, BoundaryRule::Gauss)
        }),
        on_mesh!(Term::Compliance, "whole weight at the ends of Γ3", |space, _| {
            for i in ends(space) {
                space.trace.points[i].weight *= 2.0;
            }
        }),
        on_mesh!(Term::Compliance, "no weight at the ends of Γ3", |space, _| {
            for i in ends(space) {
                space.trace.points[i].weight *= 1e-9;
            }
        }),
        on_mesh!(Term::Gap, "inward normal on Γ3", |space, _| {
            space.trace.points.iter_mut().for_each(|point| point.sign = -point.sign);
        }),
        constraint("gap ignored", |setup| gap(setup, |_, _| f64::INFINITY)),
        on_mesh!(Term::Gap, "constraint at every other vertex", every_other),
        constraint("constraint on half of Γ3", |setup| {
            gap(setup, |x, g| if x[0] > 0.5 { f64::INFINITY } else { g })
        }),
        constraint("gap 1 % too wide", |setup| gap(setup, |_, g| 1.01 * g)),
        constraint("gap taken at x = 0 everywhere", |setup| {
            gap_in_time(setup, |sound, _, t| sound([0.0; 3], t))
        }),
        constraint("penalty 1e3 in place of the constraint", |setup| penalty(setup, 1e3)),
    ]
}
