//! Wrong projections, wrong yield limits, and another ζ.

use std::sync::{Arc, Mutex};

use algebra::tensor::{Symmetric, deviator, dimension, norm, trace};
use fem::contact::{CaseError, CaseInfo, Model, Observer, march};
use scene::setup::{MeshData, Setup, TruthLoad, YieldFormula};
use vhi::Newton;
use vhi::history::{TimeGrid, TimeRule, Trapezoid};
use vhi::law::{AnyProjection, Projection, Response, VonMises, YieldLimit};

use super::{Defect, Term, marched};

/// The part of a strain that is projected, and its size.
trait Split: Send + Sync {
    fn split<const S: usize>(&self, strain: &Symmetric<S>) -> (Symmetric<S>, f64);
}

/// The whole tensor.
struct Whole;

impl Split for Whole {
    fn split<const S: usize>(&self, strain: &Symmetric<S>) -> (Symmetric<S>, f64) {
        (*strain, norm(strain))
    }
}

/// ε - (tr ε/3) I, in the plane too.
struct InSpace;

impl Split for InSpace {
    fn split<const S: usize>(&self, strain: &Symmetric<S>) -> (Symmetric<S>, f64) {
        let mean = trace(strain) / 3.0;
        let mut part = *strain;
        part[..dimension::<S>()].iter_mut().for_each(|e| *e -= mean);
        (part, norm(&part))
    }
}

/// ε^D with each shear counted once in its norm.
struct ShearOnce;

impl Split for ShearOnce {
    fn split<const S: usize>(&self, strain: &Symmetric<S>) -> (Symmetric<S>, f64) {
        let (part, d) = (deviator(strain), dimension::<S>());
        let normal: f64 = part[..d].iter().map(|e| e * e).sum();
        let shear: f64 = part[d..].iter().map(|e| 0.5 * e * e).sum();
        (part, (normal + shear).sqrt())
    }
}

/// ε^D with von Mises's equivalent √(3/2) ‖ε^D‖ as its norm.
struct Equivalent;

impl Split for Equivalent {
    fn split<const S: usize>(&self, strain: &Symmetric<S>) -> (Symmetric<S>, f64) {
        let part = deviator(strain);
        (part, 1.5f64.sqrt() * norm(&part))
    }
}

/// μ (1 - κ/size)_+ part, with tangents by differences.
struct Ball<Q> {
    mu: f64,
    limit: YieldFormula,
    split: Q,
}

/// Differences of 1e-6 leave 1e-10 of a tangent: Newton's method converges all the same.
const STEP: f64 = 1e-6;

impl<Q: Split> Projection for Ball<Q> {
    fn stress<const S: usize>(&self, strain: &Symmetric<S>, kappa: f64) -> Option<Symmetric<S>> {
        let (part, size) = self.split.split(strain);
        (size > kappa).then(|| part.map(|e| self.mu * (1.0 - kappa / size) * e))
    }

    fn response<const S: usize>(&self, strain: &Symmetric<S>, kappa: f64) -> Option<Response<S>> {
        let stress = self.stress(strain, kappa)?;
        let (part, size) = self.split.split(strain);
        let mut tangent = [[0.0; S]; S];
        for j in 0..S {
            let moved = |sign: f64| {
                let mut strain = *strain;
                strain[j] += sign * STEP;
                let (part, size) = self.split.split(&strain);
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
    setup: &Setup,
    data: &MeshData,
    steps: u32,
    observe: &mut Observer<'_>,
    replace: impl Fn(VonMises<YieldFormula>) -> P,
) -> Result<CaseInfo, CaseError> {
    let Some(sound) = setup.scene_projection() else {
        return data.march(setup, steps, &Newton::default(), observe);
    };
    let projection = Some(AnyProjection::new(replace(sound)));
    let model = Model { projection, ..setup.scene_model() };
    let mut load = TruthLoad(&*data.truth);
    march(&data.space, &model, &setup.grid(steps), &mut load, &Newton::default(), observe)
}

/// A limit through functions of ζ.
struct Limit<V, W> {
    value: V,
    slope: W,
}

impl<V, W> YieldLimit for Limit<V, W>
where
    V: Fn(f64) -> f64 + Send + Sync,
    W: Fn(f64) -> f64 + Send + Sync,
{
    fn value(&self, zeta: f64) -> f64 {
        (self.value)(zeta)
    }
    fn slope(&self, zeta: f64) -> f64 {
        (self.slope)(zeta)
    }
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

/// The march with κ at a quantity made of ‖ε‖ by `other`: the sound ζ_n gives ‖ε(u_n)‖ back, since its past is known.
fn with_past(
    setup: &Setup,
    data: &MeshData,
    steps: u32,
    observe: &mut Observer<'_>,
    value: fn(&Past, f64) -> f64,
    slope: fn(&Past, f64) -> f64,
    advance: fn(f64, f64) -> f64,
) -> Result<CaseInfo, CaseError> {
    let past = Arc::new(Mutex::new(Past::default()));
    let grid: TimeGrid = setup.grid(steps);
    let watched = past.clone();
    let mut see = |view: &fem::contact::StepView<'_>| {
        let mut past = watched.lock().expect("a past");
        let next = (view.n < grid.steps()).then(|| Trapezoid.weight(&grid, view.n + 1, view.n + 1));
        *past = Past {
            zeta: view.zeta,
            other: past.other + past.half * advance(past.norm, view.strain_norm),
            norm: view.strain_norm,
            half: next.unwrap_or(0.0),
        };
        drop(past);
        observe(view)
    };
    replaced(setup, data, steps, &mut see, |VonMises { mu, limit }| {
        let (limit, twin) = (Arc::new(limit), past.clone());
        let (also, past) = (limit.clone(), past.clone());
        let value = move |zeta: f64| limit.value(value(&past.lock().expect("a past"), zeta));
        let slope = move |zeta: f64| {
            let past = twin.lock().expect("a past");
            also.slope(zeta) * slope(&past, zeta)
        };
        VonMises { mu, limit: Limit { value, slope } }
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

macro_rules! by {
    ($term:expr, $name:literal, $replace:expr) => {
        Defect::of($term, $name, |setup| {
            marched(setup, |setup, data, steps, observe| {
                replaced(setup, data, steps, observe, $replace)
            })
        })
    };
}

fn factor(mut setup: Setup, factor: f64) -> Setup {
    let scaled = |sound: VonMises<_>| VonMises { mu: factor * sound.mu, ..sound };
    let stated = setup.scene_projection().filter(|_| setup.model.projection.is_some());
    setup.model.projection = stated.map(|sound| AnyProjection::new(scaled(sound)));
    setup
}

pub fn defects() -> Vec<Defect> {
    let of = |name, program| Defect::of(Term::Projection, name, program);
    vec![
        of("projection term twice as strong", |setup| factor(setup, 2.0)),
        of("projection term 1 % too weak", |setup| factor(setup, 0.99)),
        of("no projection", |mut setup| {
            setup.model.projection = None;
            setup
        }),
        by!(Term::Projection, "projection of ε, not of its deviator", |sound| Ball {
            mu: sound.mu,
            limit: sound.limit,
            split: Whole,
        }),
        by!(Term::Projection, "deviator with tr/3 in the plane", |sound| Ball {
            mu: sound.mu,
            limit: sound.limit,
            split: InSpace,
        }),
        by!(Term::Projection, "norm of the deviator with shear once", |sound| Ball {
            mu: sound.mu,
            limit: sound.limit,
            split: ShearOnce,
        }),
        by!(Term::Projection, "ball in von Mises's equivalent strain", |sound| Ball {
            mu: sound.mu,
            limit: sound.limit,
            split: Equivalent,
        }),
        by!(Term::Projection, "no derivative in κ in the tangent", |sound| Tangent { sound }),
        by!(Term::Zeta, "κ constant, κ(0)", |VonMises { mu, limit }| VonMises {
            mu,
            limit: Limit { value: move |_| limit.value(0.0), slope: |_| 0.0 },
        }),
        by!(Term::Zeta, "κ(-ζ)", |VonMises { mu, limit }| {
            let limit = Arc::new(limit);
            let also = limit.clone();
            let value = move |zeta: f64| limit.value(-zeta);
            VonMises { mu, limit: Limit { value, slope: move |zeta: f64| -also.slope(-zeta) } }
        }),
        by!(Term::Zeta, "κ(0.99 ζ)", |VonMises { mu, limit }| {
            let limit = Arc::new(limit);
            let also = limit.clone();
            let value = move |zeta: f64| limit.value(0.99 * zeta);
            let slope = move |zeta: f64| 0.99 * also.slope(0.99 * zeta);
            VonMises { mu, limit: Limit { value, slope } }
        }),
        Defect::of(Term::Zeta, "κ(ζ_{n-1}) in place of κ(ζ_n)", |setup| {
            marched(setup, |setup, data, steps, observe| {
                let sum = |before: f64, now: f64| before + now;
                with_past(setup, data, steps, observe, |past, _| past.zeta, |_, _| 0.0, sum)
            })
        }),
        Defect::of(Term::Zeta, "ζ without its square root", |setup| {
            marched(setup, |setup, data, steps, observe| {
                let value = |past: &Past, zeta: f64| {
                    let norm = norm_of(past, zeta);
                    past.other + past.half * (past.norm * past.norm + norm * norm)
                };
                let slope = |past: &Past, zeta: f64| 2.0 * norm_of(past, zeta);
                let sum = |before: f64, now: f64| before * before + now * now;
                with_past(setup, data, steps, observe, value, slope, sum)
            })
        }),
    ]
}
