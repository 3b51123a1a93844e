//! Wrong projections, wrong yield limits, and another ζ.

use std::sync::{Arc, Mutex};

use algebra::tensor::{Symmetric, deviator, dimension, norm, trace};
use fem::contact::Model;
use scene::setup::YieldFormula;
use vhi::history::{TimeRule, Trapezoid};
use vhi::law::{AnyProjection, Projection, Response, VonMises, YieldLimit};

use super::Term::{self, Zeta};
use super::{Defect, Marched, Run};
use crate::wrong::Limit;

/// The part of a strain that is projected.
#[derive(Clone, Copy)]
enum Part {
    /// The whole tensor.
    Whole,
    /// ε - (tr ε/3) I, in the plane too.
    InSpace,
    /// ε^D with each shear counted once in its norm.
    ShearOnce,
    /// ε^D with von Mises's equivalent √(3/2) ‖ε^D‖ as its norm.
    Equivalent,
}

impl Part {
    fn split<const S: usize>(self, strain: &Symmetric<S>) -> (Symmetric<S>, f64) {
        let (mut part, d) = (*strain, dimension::<S>());
        match self {
            Self::Whole => {}
            Self::InSpace => part[..d].iter_mut().for_each(|e| *e -= trace(strain) / 3.0),
            Self::ShearOnce | Self::Equivalent => part = deviator(strain),
        }
        let size = match self {
            Self::Whole | Self::InSpace => norm(&part),
            Self::ShearOnce => {
                let shear: f64 = part[d..].iter().map(|e| 0.5 * e * e).sum();
                (part[..d].iter().map(|e| e * e).sum::<f64>() + shear).sqrt()
            }
            Self::Equivalent => 1.5f64.sqrt() * norm(&part),
        };
        (part, size)
    }
}

/// μ (1 - κ/size)_+ part, with tangents by differences.
struct Ball {
    mu: f64,
    limit: YieldFormula,
    part: Part,
}

/// Differences of 1e-6 leave 1e-10 of a tangent: Newton's method converges all the same.
const STEP: f64 = 1e-6;

impl Projection for Ball {
    fn stress<const S: usize>(&self, strain: &Symmetric<S>, kappa: f64) -> Option<Symmetric<S>> {
        let (part, size) = self.part.split(strain);
        (size > kappa).then(|| part.map(|e| self.mu * (1.0 - kappa / size) * e))
    }

    fn response<const S: usize>(&self, strain: &Symmetric<S>, kappa: f64) -> Option<Response<S>> {
        let stress = self.stress(strain, kappa)?;
        let (part, size) = self.part.split(strain);
        let mut tangent = [[0.0; S]; S];
        for j in 0..S {
            let moved = |sign: f64| {
                let mut strain = *strain;
                strain[j] += sign * STEP;
                let (part, size) = self.part.split(&strain);
                part.map(|e| self.mu * (1.0 - kappa / size) * e)
            };
            let (plus, minus) = (moved(1.0), moved(-1.0));
            for i in 0..S {
                tangent[i][j] = (plus[i] - minus[i]) / (2.0 * STEP);
            }
        }
        let by_limit = part.map(|e| -self.mu * e / size);
        Some(Response { stress, tangent, by_limit })
    }

    fn limit(&self) -> Option<&dyn YieldLimit> {
        Some(&self.limit)
    }
}

/// Marches the scene with its projection replaced.
fn replaced<P: Projection + 'static>(
    run: Run<'_>,
    replace: impl Fn(VonMises<YieldFormula>) -> P,
) -> Marched {
    let (setup, data) = (run.setup, run.data);
    let Some(sound) = setup.scene_projection() else { return run.sound() };
    let projection = Some(AnyProjection::new(replace(sound)));
    run.on(&data.space, &Model { projection, ..setup.scene_model() })
}

/// What a limit with a wrong history remembers.
#[derive(Default)]
struct Past {
    /// ζ of the sound rule and of the defective one, and the norms, up to the last level.
    zeta: f64,
    other: f64,
    norm: f64,
    /// Half of the step that is open, 0 at n = 0.
    half: f64,
}

/// κ at a quantity made of ‖ε‖ by `other`: the sound ζ_n gives ‖ε(u_n)‖ back, since its past is known.
fn with_past(
    name: &'static str,
    value: fn(&Past, f64) -> f64,
    slope: fn(&Past, f64) -> f64,
    advance: fn(f64, f64) -> f64,
) -> Defect {
    Zeta.run(name, move |run| {
        let past = Arc::new(Mutex::new(Past::default()));
        let grid = run.setup.grid(run.steps);
        let watched = past.clone();
        let mut see = |view: &fem::contact::StepView<'_>| {
            let mut past = watched.lock().expect("a past");
            let n = view.n + 1;
            *past = Past {
                zeta: view.zeta,
                other: past.other + past.half * advance(past.norm, view.strain_norm),
                norm: view.strain_norm,
                half: if n <= grid.steps() { Trapezoid.weight(&grid, n, n) } else { 0.0 },
            };
            drop(past);
            (run.observe)(view)
        };
        replaced(Run { observe: &mut see, ..run }, |VonMises { mu, limit }| {
            let (limit, twin) = (Arc::new(limit), past.clone());
            let (also, past) = (limit.clone(), past.clone());
            let value = move |zeta: f64| limit.value(value(&past.lock().expect("a past"), zeta));
            let slope = move |zeta: f64| {
                let past = twin.lock().expect("a past");
                also.slope(zeta) * slope(&past, zeta)
            };
            VonMises { mu, limit: Limit { value, slope } }
        })
    })
}

/// ‖ε(u_n)‖ that belongs to a trial ζ_n.
fn norm_of(past: &Past, zeta: f64) -> f64 {
    match past.half > 0.0 {
        true => ((zeta - past.zeta) / past.half - past.norm).max(0.0),
        false => 0.0,
    }
}

/// A tangent that is wrong in one part: the solution is the same.
struct Tangent {
    sound: VonMises<YieldFormula>,
}

impl Projection for Tangent {
    fn stress<const S: usize>(&self, strain: &Symmetric<S>, kappa: f64) -> Option<Symmetric<S>> {
        self.sound.stress(strain, kappa)
    }

    fn response<const S: usize>(&self, strain: &Symmetric<S>, kappa: f64) -> Option<Response<S>> {
        let mut response = self.sound.response(strain, kappa)?;
        response.by_limit = [0.0; S];
        Some(response)
    }

    fn limit(&self) -> Option<&dyn YieldLimit> {
        self.sound.limit()
    }
}

fn ball(name: &'static str, part: Part) -> Defect {
    Term::Projection
        .run(name, move |run| replaced(run, |VonMises { mu, limit }| Ball { mu, limit, part }))
}

/// κ(c ζ).
fn scaled(name: &'static str, c: f64) -> Defect {
    Zeta.run(name, move |run| {
        replaced(run, |VonMises { mu, limit }| {
            let limit = Arc::new(limit);
            let also = limit.clone();
            let value = move |zeta: f64| limit.value(c * zeta);
            VonMises {
                mu,
                limit: Limit { value, slope: move |zeta: f64| c * also.slope(c * zeta) },
            }
        })
    })
}

fn factor(name: &'static str, factor: f64) -> Defect {
    Term::Projection.of(name, move |setup| {
        let scaled = |sound: VonMises<_>| VonMises { mu: factor * sound.mu, ..sound };
        let stated = setup.scene_projection().filter(|_| setup.model.projection.is_some());
        setup.model.projection = stated.map(|sound| AnyProjection::new(scaled(sound)));
    })
}

pub fn defects() -> Vec<Defect> {
    vec![
        factor("projection term twice as strong", 2.0),
        factor("projection term 1 % too weak", 0.99),
        Term::Projection.of("no projection", |setup| setup.model.projection = None),
        ball("projection of ε, not of its deviator", Part::Whole),
        ball("deviator with tr/3 in the plane", Part::InSpace),
        ball("norm of the deviator with shear once", Part::ShearOnce),
        ball("ball in von Mises's equivalent strain", Part::Equivalent),
        Term::Projection.run("no derivative in κ in the tangent", |run| {
            replaced(run, |sound| Tangent { sound })
        }),
        scaled("κ constant, κ(0)", 0.0),
        scaled("κ(-ζ)", -1.0),
        scaled("κ(0.99 ζ)", 0.99),
        with_past("κ(ζ_{n-1}) in place of κ(ζ_n)", |past, _| past.zeta, |_, _| 0.0, |a, b| a + b),
        with_past(
            "ζ without its square root",
            |past, zeta| {
                let norm = norm_of(past, zeta);
                past.other + past.half * (past.norm * past.norm + norm * norm)
            },
            |past, zeta| 2.0 * norm_of(past, zeta),
            |before, now| before * before + now * now,
        ),
    ]
}
