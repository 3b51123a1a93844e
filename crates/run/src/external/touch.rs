//! The forces that an answer needs on Γ3, against the law, the gap and the friction of the scene.

use std::collections::BTreeSet;
use std::sync::Arc;

use fem::contact::{BoundaryRule, TracePoint};
use vhi::law::{NoPotential, Potential, Scaled, graph_distance};

use super::left::Left;
use judge::verdict::{Cause, Explanation};

/// Directions and bounds that agree to this agree.
const SMALL: f64 = 1e-5;

/// One point of Γ3 at one level.
struct Touch {
    n: usize,
    i: usize,
    vertex: u32,
    x: [f64; 3],
    weight: f64,
    stiffness: f64,
    law: Scaled,
    /// g here, and at t = 0 and the level before.
    gap: f64,
    gaps: [f64; 2],
    shift: f64,
    /// u_ν, and the pressure that balances the stress.
    u: f64,
    p: f64,
    /// u_τ, and what balances the stress along it.
    slip: [f64; 2],
    s: [f64; 2],
    /// S at this slip, and at t = 0 and the level before.
    bounds: [f64; 3],
    /// The pressure that is handed over.
    given: f64,
}

impl Touch {
    /// Distance of (u_ν, p) from a law with a bound, as a force.
    fn off(&self, law: &dyn Potential, gap: f64, [u, p]: [f64; 2]) -> f64 {
        let from_law = graph_distance(law, [u - self.shift, p], self.weight, self.stiffness);
        let beyond = (u - gap) * self.stiffness;
        let pressing = p > law.subdifferential(u - self.shift).1;
        let normal = if pressing { from_law.min(beyond.abs()) } else { from_law };
        normal.max(beyond)
    }

    fn of_scene(&self) -> f64 {
        self.off(&self.law, self.gap, [self.u, self.p])
    }

    /// Distance of (u_τ, s) from friction with the bound S, as a force: s is the point of the ball that s + r u_τ is
    /// projected to.
    fn off_friction(&self, bound: f64, slip: [f64; 2]) -> f64 {
        let r = self.stiffness / self.weight;
        let z = [self.s[0] + r * slip[0], self.s[1] + r * slip[1]];
        let length = z[0].hypot(z[1]);
        let shrunk = if length > bound { bound / length } else { 1.0 };
        self.weight * (self.s[0] - shrunk * z[0]).hypot(self.s[1] - shrunk * z[1])
    }

    fn sliding(&self) -> f64 {
        self.slip[0].hypot(self.slip[1])
    }

    fn dragging(&self) -> f64 {
        self.s[0].hypot(self.s[1])
    }
}

/// Every point of Γ3 that carries the laws at every level. A node with two normals is left out.
fn touches(left: &Left<'_>) -> Vec<Touch> {
    let (space, model) = (&*left.data.space, &left.setup.model);
    let (points, d) = (&space.trace.points, space.mesh.dimension);
    let alone =
        |point: &TracePoint| points.iter().filter(|other| other.node == point.node).count() == 1;
    let stiffness = model.elasticity.eigenvalues(d).1;
    let mut touches = Vec::new();
    for (i, point) in points.iter().enumerate().filter(|(_, point)| point.carries() && alone(point))
    {
        let (x, at) = (space.mesh.point(&[point.vertex], &[1.0]), d * point.node as usize);
        let absent = || Scaled { potential: Arc::new(NoPotential), factor: 1.0 };
        let boundary = model.boundary_on(point.side);
        // With other rules the law is in the balance of forces already.
        let lawful = boundary.filter(|boundary| boundary.rule == BoundaryRule::Vertex);
        let shift = boundary.map_or(0.0, |boundary| (boundary.shift)(x));
        for (n, balance) in left.balance.iter().enumerate() {
            let u = space.trace.normal(i, &left.u[n]);
            let force: Vec<f64> = balance[at..at + d].iter().map(|r| -r / point.weight).collect();
            let mut s = [0.0; 2];
            for (s, tangent) in s.iter_mut().zip(point.tangents()) {
                *s = tangent.iter().zip(&force).map(|(t, f)| t * f).sum();
            }
            let slip = point.slip(&left.u[n]);
            let law = lawful.map_or_else(absent, |boundary| boundary.potential_at(x));
            let followed = boundary.map_or(0.0, |b| b.potential_at(x).subdifferential(u - shift).0);
            let bound = |n: usize| {
                let bound = |friction: &fem::contact::Friction| {
                    let law = friction.at(x, left.grid.time(n), followed);
                    law.subdifferential(slip[0].hypot(slip[1])).1
                };
                model.friction.as_ref().map_or(0.0, bound)
            };
            let gap = |n: usize| {
                boundary.map_or(f64::INFINITY, |boundary| (boundary.gap)(x, left.grid.time(n)))
            };
            let p = point.normal[..d].iter().zip(&force).map(|(n, f)| n * f).sum();
            let handed = left.pressures[n][i] - if lawful.is_some() { 0.0 } else { followed };
            touches.push(Touch {
                n,
                i,
                vertex: point.vertex,
                x,
                weight: point.weight,
                stiffness,
                law,
                gap: gap(n),
                gaps: [gap(0), gap(n.saturating_sub(1))],
                shift,
                u,
                p,
                slip,
                s,
                bounds: [bound(n), bound(0), bound(n.saturating_sub(1))],
                // Without pressures there is nothing to be wrong.
                given: if handed.is_nan() { p } else { handed },
            });
        }
    }
    touches
}

/// What is wrong on Γ3, where all else balances.
pub(super) fn of_contact(left: &Left<'_>, balanced: &str) -> Explanation {
    let touches = touches(left);
    let sound = left.sound;
    let by = |of: &dyn Fn(&Touch) -> f64| {
        touches
            .iter()
            .max_by(|a, b| of(a).total_cmp(&of(b)))
            .filter(|touch| !of(touch).is_finite() || of(touch) > sound)
    };
    let numbers = |touch: &Touch, what: String| {
        let x: Vec<String> =
            touch.x[..left.data.space.mesh.dimension].iter().map(|x| format!("{x:.4}")).collect();
        format!(
            "{balanced}; at level {}, vertex {} ({}), {what}",
            touch.n,
            touch.vertex,
            x.join(", ")
        )
    };
    if let Some(worst) = by(&|touch| touch.of_scene()) {
        let (says, fits) = normal(&touches, sound);
        let what = format!(
            "u_nu = {:.4e}, g = {}, and the pressure that balances the stress is {:.4e}, by the law {:.4e}",
            worst.u,
            worst.gap,
            worst.p,
            worst.law.subdifferential(worst.u - worst.shift).0
        );
        return Explanation { cause: Cause::Contact, says, numbers: numbers(worst, what), fits };
    }
    if let Some(worst) = by(&|touch| touch.off_friction(touch.bounds[0], touch.slip)) {
        let (says, fits) = tangential(&touches, sound, left.setup.model.friction.is_some());
        let what = format!(
            "the slip is {:.4e}, the bound {:.4e}, and the tangential stress that balances {:.4e}",
            worst.sliding(),
            worst.bounds[0],
            worst.dragging()
        );
        return Explanation { cause: Cause::Friction, says, numbers: numbers(worst, what), fits };
    }
    if let Some(worst) = by(&|touch| touch.weight * (touch.given - touch.p).abs()) {
        let what =
            format!("{:.4e} is handed over, and {:.4e} balances the stress", worst.given, worst.p);
        let (says, fits) = handed(&touches, sound);
        return Explanation { cause: Cause::Pressures, says, numbers: numbers(worst, what), fits };
    }
    let says = "the displacements solve the discrete equations of the scene".to_owned();
    Explanation { cause: Cause::Nothing, says, numbers: balanced.to_owned(), fits: true }
}

/// The first mistake of those offered that all points of Γ3 fit.
struct First<'t> {
    touches: &'t [Touch],
    sound: f64,
    says: Option<String>,
}

impl First<'_> {
    /// Takes a mistake by the forces that it leaves.
    fn offer(&mut self, off: &dyn Fn(&Touch) -> f64, says: &str) {
        if self.says.is_none() && self.touches.iter().all(|touch| off(touch) <= self.sound) {
            self.says = Some(says.to_owned());
        }
    }

    /// Takes a mistake by what is so at every point.
    fn offer_if(&mut self, is: &dyn Fn(&Touch) -> bool, says: &str) {
        self.offer(&|touch| if is(touch) { 0.0 } else { f64::INFINITY }, says);
    }

    /// Its words, or these where there is none, and whether there is one.
    fn or(self, otherwise: &str) -> (String, bool) {
        let fits = self.says.is_some();
        (self.says.unwrap_or_else(|| otherwise.to_owned()), fits)
    }
}

fn normal(touches: &[Touch], sound: f64) -> (String, bool) {
    let most = |of: &dyn Fn(&Touch) -> f64| {
        touches.iter().max_by(|a, b| of(a).total_cmp(&of(b))).filter(|touch| of(touch) > 0.0)
    };
    let (none, free) = (NoPotential, f64::INFINITY);
    let lo = |touch: &Touch, u: f64| touch.law.subdifferential(u - touch.shift).0;
    let at = |touch: &Touch| [touch.u, touch.p];
    let mut first = First { touches, sound, says: None };
    first.offer(
        &|touch| touch.weight * touch.p.abs(),
        "contact: no force at all, neither law nor gap on this side",
    );
    let open = |touch: &Touch| {
        touch.law.kinks().first().is_some_and(|first| touch.u - touch.shift <= *first)
    };
    first.offer_if(
        &|touch| open(touch) && touch.weight * touch.p <= sound,
        "contact: open points are pulled, the law goes on below its first point or the normal points inward",
    );
    first.offer(
        &|touch| touch.off(&touch.law, touch.gap, [-touch.u, -touch.p]),
        "contact: the normal points inward, -u_nu has the gap and the law",
    );
    first.offer(&|touch| touch.off(&touch.law, free, at(touch)), "contact: the gap is missing");
    first.offer(&|touch| touch.off(&none, touch.gap, at(touch)), "contact: the law is missing");
    for (k, when) in ["of t = 0 at all times", "of the level before"].into_iter().enumerate() {
        let off = |touch: &Touch| touch.off(&touch.law, touch.gaps[k], at(touch));
        first.offer(&off, &format!("contact: the gap {when}"));
    }
    // The point that presses most says by which gap, or by which penalty.
    let excess = |touch: &Touch| {
        if touch.gap.is_finite() { touch.weight * (touch.p - lo(touch, touch.u)) } else { 0.0 }
    };
    if let Some(most) = most(&excess).filter(|touch| excess(touch) > sound) {
        let (factor, more) = (most.u / most.gap, most.u - most.gap);
        let stiffness = (most.p - lo(most, most.gap)) / more;
        first.offer(
            &|touch| touch.off(&touch.law, factor * touch.gap, at(touch)),
            &format!("contact: {factor:.4} times the gap"),
        );
        first.offer(
            &|touch| touch.off(&touch.law, touch.gap + more, at(touch)),
            &format!("contact: the gap and {more:.2e} more"),
        );
        let by_penalty = |touch: &Touch| {
            let law =
                lo(touch, touch.u.min(touch.gap)) + stiffness * (touch.u - touch.gap).max(0.0);
            touch.weight * (touch.p - law).abs()
        };
        first.offer_if(
            &|touch| stiffness > 0.0 && by_penalty(touch) <= sound,
            &format!("contact: a penalty, {stiffness:.4e} (u_nu - g), in place of the constraint"),
        );
    }
    let steepest = |touch: &Touch| touch.weight * lo(touch, touch.u).abs();
    if let Some(most) = most(&steepest) {
        let factor = most.p / lo(most, most.u);
        let of = |touch: &Touch| Scaled {
            potential: touch.law.potential.clone(),
            factor: factor * touch.law.factor,
        };
        first.offer(
            &|touch| touch.off(&of(touch), touch.gap, at(touch)),
            &format!("contact: {factor:.4} times the law"),
        );
    }
    let wrong = || touches.iter().filter(|touch| touch.of_scene() > sound);
    let count = |points: &mut dyn Iterator<Item = &Touch>| {
        points.map(|touch| touch.i).collect::<BTreeSet<usize>>().len()
    };
    let [held, all] = [count(&mut wrong()), count(&mut touches.iter())];
    first.offer(
        &|touch| touch.off(&touch.law, free, at(touch)).min(touch.of_scene()),
        &format!(
            "contact: no gap at {held} of {all} vertices of the contact side, or an active set that is not final"
        ),
    );
    // What is wrong may lie on one branch of the law alone.
    let from = wrong().map(|touch| touch.u - touch.shift).fold(f64::INFINITY, f64::min);
    let to = wrong().map(|touch| touch.u - touch.shift).fold(f64::NEG_INFINITY, f64::max);
    let kinks = touches.first().map_or(&[][..], |touch| touch.law.kinks());
    let says = match kinks.first() {
        Some(first) if to <= *first => {
            "contact: open points are pulled, the law goes on below its first point"
        }
        _ => "contact: points are pulled, an active set that is not final",
    };
    let pulled = wrong().all(|touch| touch.p < 0.0);
    first.offer_if(&|touch| pulled && touch.u - touch.gap <= sound / touch.stiffness, says);
    let below =
        kinks.iter().copied().filter(|kink| *kink <= from).fold(f64::NEG_INFINITY, f64::max);
    let above = kinks.iter().copied().find(|kink| *kink >= to).unwrap_or(f64::INFINITY);
    first.offer_if(
        &|_| below.is_finite() || above.is_finite(),
        &format!("contact: the law is wrong for u_nu - s from {below} to {above} alone"),
    );
    first.or("contact: normal forces do not fit the law and the gap")
}

fn tangential(touches: &[Touch], sound: f64, rubs: bool) -> (String, bool) {
    let mut first = First { touches, sound, says: None };
    if !rubs {
        return first.or("contact: tangential forces, where the scene has no friction");
    }
    let along = |touch: &Touch| touch.s[0] * touch.slip[0] + touch.s[1] * touch.slip[1];
    let most = touches.iter().max_by(|a, b| a.sliding().total_cmp(&b.sliding()));
    let [ratio, drag, stress] = most.map_or([0.0; 3], |touch| {
        let drag = along(touch) / touch.sliding().powi(2);
        [touch.dragging() / touch.bounds[0], drag, touch.dragging()]
    });
    let by = |bound: f64, touch: &Touch| touch.off_friction(bound, touch.slip);
    let sticks = |touch: &Touch| touch.sliding() * touch.stiffness <= sound;
    let forward = touches.iter().any(|touch| !sticks(touch) && along(touch) < 0.0);
    let back = |touch: &Touch| touch.off_friction(touch.bounds[0], touch.slip.map(|slip| -slip));
    let by_drag = |touch: &Touch| {
        let [p, q] = [0, 1].map(|k| touch.s[k] - drag * touch.slip[k]);
        touch.weight * p.hypot(q)
    };
    // As a regularised law has it: below the bound along the slip, and no stress without slip.
    let yielding = |touch: &Touch| {
        let moves = touch.weight * touch.dragging() <= sound || touch.sliding() > 0.0;
        let straight = along(touch) >= (1.0 - SMALL) * touch.dragging() * touch.sliding();
        moves && straight && touch.dragging() <= (1.0 + SMALL) * touch.bounds[0]
    };
    first.offer(&|touch| touch.weight * touch.dragging(), "friction: none at all");
    first.offer(
        &|touch| if forward { 0.0 } else { back(touch) },
        "friction: it pushes along with the slip",
    );
    first.offer(&by_drag, &format!("friction: {drag:.4} times the slip, so that nothing sticks"));
    first.offer(
        &|touch| by(ratio * touch.bounds[0], touch),
        &format!("friction: {ratio:.4} times the bound"),
    );
    first.offer(&|touch| by(touch.bounds[1], touch), "friction: the bound of t = 0 at all times");
    first.offer(&|touch| by(touch.bounds[2], touch), "friction: the bound of the level before");
    first.offer_if(
        &yielding,
        "friction: it grows with the slip up to its bound, so that nothing sticks",
    );
    first.offer(
        &|touch| if sticks(touch) { 0.0 } else { by(touch.bounds[0], touch) },
        "friction: points stick beyond the bound",
    );
    first.offer(&|touch| by(stress, touch), &format!("friction: a constant bound, {stress:.4e}"));
    first.or("friction: slips and tangential stresses do not fit the law")
}

/// How pressures differ that are handed over.
fn handed(touches: &[Touch], sound: f64) -> (String, bool) {
    let mut first = First { touches, sound, says: None };
    let count = touches.len() as f64;
    let mean = |of: &dyn Fn(&Touch) -> f64| touches.iter().map(of).sum::<f64>() / count;
    let (p, q) = (mean(&|touch| touch.p), mean(&|touch| touch.given));
    let slope =
        mean(&|touch| (touch.p - p) * (touch.given - q)) / mean(&|touch| (touch.p - p).powi(2));
    let start = q - slope * p;
    let off = |touch: &Touch, given: f64| touch.weight * (touch.given - given).abs();
    first.offer(&|touch| off(touch, -touch.p), "pressures: they have the other sign");
    first.offer(
        &|touch| off(touch, touch.weight * touch.p),
        "pressures: forces of the vertices, not over their weights",
    );
    first.offer(
        &|touch| off(touch, slope * touch.p),
        &format!("pressures: {slope:.4} times those that balance the stress"),
    );
    first.offer(
        &|touch| off(touch, start + slope * touch.p),
        &format!("pressures: {start:.4} + {slope:.4} p for p"),
    );
    first.or("pressures: they do not balance the stress")
}
