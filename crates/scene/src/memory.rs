//! `[material.memory]`: the relaxation tensor ℬ(t).

use formula::{EvaluationPoint, Interval, Node, Scope, Variable};

use super::diagnostic::Result;
use super::kernel::formula_of;
use super::reading::Reading;
use super::singular;
use super::spans::join;

/// A term of ℬ(t)ε = Σ kernel(t) · (2 mu ε + lambda tr(ε) I).
#[derive(Debug, Clone, PartialEq)]
pub struct RelaxationTerm {
    /// A formula in t, finite on (0, T], and at 0 unless singular.
    pub kernel: Node,
    /// Set if kernel = t^{-a} c(t).
    pub singular: Option<SingularParts>,
    /// Pairs (a, c) with kernel = Σ a exp(-c t), if it has that form.
    pub exponentials: Option<Vec<(f64, f64)>>,
    /// Outside all named regions.
    pub lambda: f64,
    pub mu: f64,
    /// (lambda, mu) in each named region.
    pub regions: Vec<[f64; 2]>,
}

/// The parts of a kernel t^{-a} c(t).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SingularParts {
    /// a, between 0 and 1.
    pub power: f64,
    /// c, finite on [0, T].
    pub factor: Node,
    /// The named region with this memory; None for the material.
    pub region: Option<usize>,
}

pub(super) fn key(region: Option<usize>) -> String {
    region.map_or("material.memory".into(), |index| format!("material.region.{index}.memory"))
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Part {
    kernel: Node,
    singular: Option<SingularParts>,
    tensor: [f64; 2],
}

/// The parts of the `memory` table of a region or the material, if it has one: its kernel, or those of bulk and shear.
pub(super) fn parts(
    reading: &mut Reading,
    region: Option<usize>,
    horizon: f64,
    dimension: usize,
) -> Result<Option<Vec<Part>>> {
    let key = &*key(region);
    if !reading.has(key) {
        return Ok(None);
    }
    let power = (singular::exponent(reading, key)?, region);
    let has = |name: &str| reading.has(&join(key, name));
    let apart = has("bulk") || has("shear");
    match (has("kernel"), has("lambda") || has("mu")) {
        (true, _) if !apart => {
            let lambda = reading.finite(&join(key, "lambda"))?;
            let mu = reading.finite(&join(key, "mu"))?;
            let kernel = validated(reading, &join(key, "kernel"), horizon)?;
            Ok(Some(vec![Part::new(reading, kernel, power, [lambda, mu])]))
        }
        (false, false) if apart => {
            // bulk tr(ε) I, and 2 shear ε^D with ε^D = ε - tr(ε)/d I.
            let tensors =
                [("bulk", [1.0, 0.0]), ("shear", [-2.0 / dimension as f64, 1.0])].into_iter();
            let mut parts = Vec::new();
            for (name, tensor) in tensors {
                let kernel = reading
                    .if_given(&join(key, name), |reading, key| validated(reading, key, horizon))?;
                parts.extend(kernel.map(|kernel| Part::new(reading, kernel, power, tensor)));
            }
            Ok(Some(parts))
        }
        _ => {
            let message = format!(
                "[{key}] needs one kernel with its tensor, or the kernels of bulk and shear"
            );
            let hint = "give kernel, lambda and mu for kernel(t)(2 mu eps + lambda tr(eps) I), or bulk and shear for bulk(t) tr(eps) I + 2 shear(t) dev(eps)";
            Err(reading.error(key, message, hint))
        }
    }
}

impl Part {
    fn new(
        reading: &mut Reading,
        factor: Node,
        (power, region): (f64, Option<usize>),
        tensor: [f64; 2],
    ) -> Self {
        if power == 0.0 {
            return Self { kernel: factor, singular: None, tensor };
        }
        let graph = &mut reading.formulas;
        let (t, exponent) = (graph.variable(Variable::T), graph.constant(-power));
        let root = graph.pow(t, exponent);
        let kernel = graph.mul(root, factor);
        Self { kernel, singular: Some(SingularParts { power, factor, region }), tensor }
    }
}

/// A kernel, or the factor of one, with a proved bound on [0, T].
fn validated(reading: &mut Reading, key: &str, horizon: f64) -> Result<Node> {
    let formula = formula_of(reading, key)?;
    let kernel = reading.compiled(key, &formula, &Scope::new(&[Variable::T]))?;
    let start = [EvaluationPoint::default()];
    reading.everywhere((key, kernel), start, f64::is_finite, |_, value| {
        (format!("the memory kernel is {value} at t = 0"), singular::way_out("the kernel"))
    })?;
    let over = Interval::new(0.0, horizon);
    let found = reading.formulas.largest_modulus(kernel, Variable::T, over);
    let message = format!("the memory kernel has no bound near t = {:.6}", found.part[0].low);
    let hint = "ℬ must be continuous on (0, T]; -exp(-t) and sqrt(t) are examples";
    reading.refuse_if(!found.bound.is_finite(), key, message, hint).map(|()| kernel)
}

/// The terms of ℬ: equal kernels are merged, with a tensor per region.
pub(super) fn terms(
    reading: &Reading,
    base: &[Part],
    regions: &[Vec<Part>],
) -> Vec<RelaxationTerm> {
    let mut terms: Vec<RelaxationTerm> = Vec::new();
    for part in base.iter().chain(regions.iter().flatten()) {
        if terms.iter().any(|term| term.kernel == part.kernel) {
            continue;
        }
        let tensor = |parts: &[Part]| {
            let of_kernel = parts.iter().filter(|other| other.kernel == part.kernel);
            of_kernel
                .fold([0.0, 0.0], |[a, b], Part { tensor: [lambda, mu], .. }| [a + lambda, b + mu])
        };
        let [lambda, mu] = tensor(base);
        let exponentials = match part.singular {
            None => reading.formulas.exponential_sum(part.kernel),
            Some(_) => None,
        };
        terms.push(RelaxationTerm {
            kernel: part.kernel,
            singular: part.singular,
            exponentials,
            lambda,
            mu,
            regions: regions.iter().map(|parts| tensor(parts)).collect(),
        });
    }
    terms
}
