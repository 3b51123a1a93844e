//! Wrong boundary data on Γ3: law, gap, weights, rule.

use std::sync::Arc;

use fem::contact::{BoundaryRule, Discretization, Model, OnContactInTime};
use vhi::law::{NoPotential, PiecewiseLinear};

use super::Defect;
use super::Term::{Compliance, Gap};

/// Points of a law with the slopes outside.
struct Written {
    points: Vec<(f64, f64)>,
    before: f64,
    after: f64,
}

/// The law changed; scenes without one are left alone.
fn law(name: &'static str, change: fn(&mut Written)) -> Defect {
    Compliance.of(name, move |setup| {
        for (contact, boundary) in setup.body.contact.iter().zip(&mut setup.model.boundary) {
            let Some(law) = &contact.law else { continue };
            let points: Vec<(f64, f64)> = law.points.iter().map(|&[r, p]| (r, p)).collect();
            if points.len() < 2 {
                continue;
            }
            let mut written = Written { points, before: law.slope_before, after: law.slope_after };
            change(&mut written);
            let Written { points, before, after } = written;
            let law = PiecewiseLinear::new(points, before, after).expect("a law without a fall");
            boundary.potential = Arc::new(law);
        }
    })
}

/// Another g(x, t), made of the scene's, x and t.
pub(super) fn gap(
    name: &'static str,
    change: fn(&OnContactInTime, [f64; 3], f64) -> f64,
) -> Defect {
    Gap.of(name, move |setup| {
        for boundary in &mut setup.model.boundary {
            let sound = std::mem::replace(&mut boundary.gap, Box::new(|_, _| f64::INFINITY));
            boundary.gap = Box::new(move |x, t| change(&sound, x, t));
        }
    })
}

fn shift(name: &'static str, change: fn(f64) -> f64) -> Defect {
    Compliance.of(name, move |setup| {
        for boundary in &mut setup.model.boundary {
            let sound = std::mem::replace(&mut boundary.shift, Box::new(|_| 0.0));
            boundary.shift = Box::new(move |x| change(sound(x)));
        }
    })
}

/// The weights at the ends of Γ3 times a factor.
fn ends(name: &'static str, factor: f64) -> Defect {
    Compliance.rebuilt(name, move |space, _| {
        // The least weights, where others have two edges.
        let points = &mut space.trace.points;
        let least = points.iter().map(|point| point.weight).fold(f64::INFINITY, f64::min);
        let ends = points.iter_mut().filter(|point| point.weight < 1.5 * least);
        ends.for_each(|point| point.weight *= factor);
    })
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

/// A stiffness beyond g in place of the constraint.
pub(super) fn penalty(name: &'static str, stiffness: f64) -> Defect {
    Gap.of(name, move |setup| {
        let Some(boundary) = setup.model.boundary.first_mut() else { return };
        let places = [[0.0; 2], [0.5, 0.0], [0.0, 0.5]];
        let [g, x, t] = places.map(|[x, t]| (boundary.gap)([x, 0.0, 0.0], t));
        if !(g.is_finite() && g == x && g == t) {
            return;
        }
        let written = setup.body.contact.first().and_then(|contact| contact.law.as_ref());
        let points = written.map_or(&[][..], |law| &law.points);
        let mut points: Vec<(f64, f64)> =
            points.iter().map(|&[r, p]| (r, p)).filter(|&(r, _)| r < g).collect();
        points.push((g, boundary.potential.subdifferential(g).0));
        let before = written.map_or(0.0, |law| law.slope_before);
        let law = PiecewiseLinear::new(points, before, stiffness).expect("a law");
        boundary.potential = Arc::new(law);
        boundary.gap = Box::new(|_, _| f64::INFINITY);
    })
}

pub fn defects() -> Vec<Defect> {
    vec![
        law("falling branch rises", |law| {
            if let [.., (_, top), (_, last)] = law.points.as_mut_slice() {
                *last = 2.0 * *top - *last;
            }
        }),
        law("kink of the law at 1.25 times its place", |law| {
            if law.points.len() > 2 {
                law.points[1].0 *= 1.25;
            }
        }),
        law("rising branch 5 % too steep", |law| law.points[1].1 *= 1.05),
        law("law extended to open contact", |law| {
            let ((r0, p0), (r1, p1)) = (law.points[0], law.points[1]);
            law.before = (p1 - p0) / (r1 - r0);
        }),
        Compliance.of("no compliance", |setup| {
            for boundary in &mut setup.model.boundary {
                boundary.potential = Arc::new(NoPotential);
            }
        }),
        law("law constant beyond its last point continues", |law| {
            let count = law.points.len();
            let ((r0, p0), (r1, p1)) = (law.points[count - 2], law.points[count - 1]);
            law.after = (p1 - p0) / (r1 - r0);
        }),
        shift("shift of the law ignored", |_| 0.0),
        shift("shift of the law with the other sign", |s| -s),
        Compliance.of("Gauss points in place of the rule of the scene", |setup| {
            if BoundaryRule::Gauss.serves(setup.body.element) {
                setup.model.boundary.iter_mut().for_each(|b| b.rule = BoundaryRule::Gauss);
            }
        }),
        ends("whole weight at the ends of Γ3", 2.0),
        ends("no weight at the ends of Γ3", 1e-9),
        Gap.rebuilt("inward normal on Γ3", |space, _| {
            space.trace.points.iter_mut().for_each(|point| point.sign = -point.sign);
        }),
        gap("gap ignored", |_, _, _| f64::INFINITY),
        Gap.rebuilt("constraint at every other vertex", every_other),
        gap(
            "constraint on half of Γ3",
            |sound, x, t| {
                if x[0] > 0.5 { f64::INFINITY } else { sound(x, t) }
            },
        ),
        gap("gap 1 % too wide", |sound, x, t| 1.01 * sound(x, t)),
        gap("gap taken at x = 0 everywhere", |sound, _, t| sound([0.0; 3], t)),
        penalty("penalty 1e3 in place of the constraint", 1e3),
    ]
}
