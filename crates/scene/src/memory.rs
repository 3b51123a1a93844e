//! `[material.memory]`: the relaxation tensor ℬ(t).

use super::reading::{Formula, Reading, join};
use super::source::Result;
use super::time::{Time, TimeRule};
use formula::{EvaluationPoint, Interval, Node, Scope, Variable};

/// A term of ℬ(t)ε = Σ kernel(t) · (2 mu ε + lambda tr(ε) I).
#[derive(Debug, Clone, PartialEq)]
pub struct RelaxationTerm {
    /// A formula in t, finite on (0, T], and at 0 unless singular.
    pub kernel: Node,
    /// Set if kernel = t^{-a} c(t).
    pub singular: Option<SingularParts>,
    /// Pairs (a, c) with kernel = Σ a exp(-c t), if it has that form.
    pub exponentials: Option<Vec<(f64, f64)>>,
    /// r of a history ∫_0^s r(s - τ) ε(u(τ)) dτ, to which the kernel is then applied in place of ε(u(s)): a formula in t,
    /// finite on [0, T].
    pub inner: Option<Node>,
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
    inner: Option<Node>,
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
    let power = (singular_exponent(reading, key)?, region);
    if reading.has(&join(key, "terms")) {
        return listed(reading, key, horizon).map(Some);
    }
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
            let hint = "give kernel, lambda and mu for kernel(t)(2 mu eps + lambda tr(eps) I), or terms, a list of such tables, or bulk and shear for bulk(t) tr(eps) I + 2 shear(t) dev(eps)";
            Err(reading.error(key, message, hint))
        }
    }
}

/// The parts of `terms`: kernels with their tensors, some before a history of their own.
fn listed(reading: &mut Reading, key: &str, horizon: f64) -> Result<Vec<Part>> {
    let of_list = join(key, "terms");
    let others = ["kernel", "lambda", "mu", "bulk", "shear", "singular"];
    if let Some(other) = others.iter().find(|other| reading.has(&join(key, other))) {
        let message = format!("`{other}` beside `terms`: each term has its own");
        let hint = "write it into the tables of terms, or remove terms";
        return Err(reading.key_error(&join(key, other), message, hint));
    }
    let entries = reading.entries(&of_list)?;
    let hint = "for instance: terms = [{ kernel = \"1\", lambda = 0.5, mu = 0.5 }]";
    reading.refuse_if(entries.is_empty(), &of_list, "a memory without terms", hint)?;
    let mut parts = Vec::new();
    for index in entries {
        let of = |name: &str| format!("{of_list}.{index}.{name}");
        let lambda = reading.finite(&of("lambda"))?;
        let mu = reading.finite(&of("mu"))?;
        let kernel = validated(reading, &of("kernel"), horizon)?;
        let inner =
            reading.if_given(&of("inner"), |reading, key| validated(reading, key, horizon))?;
        parts.push(Part { kernel, singular: None, inner, tensor: [lambda, mu] });
    }
    Ok(parts)
}

impl Part {
    fn new(
        reading: &mut Reading,
        factor: Node,
        (power, region): (f64, Option<usize>),
        tensor: [f64; 2],
    ) -> Self {
        if power == 0.0 {
            return Self { kernel: factor, singular: None, inner: None, tensor };
        }
        let graph = &mut reading.formulas;
        let kernel = graph.written("t^(-power)*factor", &[("factor", factor)], &[("power", power)]);
        let singular = Some(SingularParts { power, factor, region });
        Self { kernel, singular, inner: None, tensor }
    }
}

/// A kernel, or the factor of one, with a proved bound on [0, T].
fn validated(reading: &mut Reading, key: &str, horizon: f64) -> Result<Node> {
    let formula = formula_of(reading, key)?;
    let kernel = reading.compiled(key, &formula, &Scope::new(&[Variable::T]))?;
    let start = [EvaluationPoint::default()];
    reading.everywhere((key, kernel), start, f64::is_finite, |_, value| {
        (format!("the memory kernel is {value} at t = 0"), singular_way_out("the kernel"))
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
        let same = |other: &Part| (other.kernel, other.inner) == (part.kernel, part.inner);
        if terms.iter().any(|term| (term.kernel, term.inner) == (part.kernel, part.inner)) {
            continue;
        }
        let tensor = |parts: &[Part]| {
            let of_kernel = parts.iter().filter(|other| same(other));
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
            inner: part.inner,
            lambda,
            mu,
            regions: regions.iter().map(|parts| tensor(parts)).collect(),
        });
    }
    terms
}

// Memory kernels by name: a table in place of a formula in t.

/// `{ kind = "exponential", amplitude = a, time = τ }`: a exp(-t/τ); `{ kind = "prony", terms = [[a_1, τ_1], …] }`: Σ
/// a_i exp(-t/τ_i); `{ kind = "power", amplitude = a, time = τ, exponent = p }`: a (1 + t/τ)^{-p}, which is smooth on
/// [0, T].
const KERNELS: [(&str, &str); 3] =
    [("exponential", "amplitude time"), ("prony", "terms"), ("power", "amplitude time exponent")];

/// The formula of a kernel, given directly or by a table.
pub(super) fn formula_of(reading: &Reading, key: &str) -> Result<Formula> {
    if !reading.has_parts(key) {
        return reading.required(key);
    }
    let kind = reading.kind(key, &KERNELS)?;
    if kind == "prony" {
        return prony(reading, &join(key, "terms"));
    }
    let amplitude = reading.finite(&join(key, "amplitude"))?;
    let time = reading.positive(&join(key, "time"))?;
    if kind == "exponential" {
        return Ok(Formula(decay(amplitude, time)));
    }
    let exponent = reading.finite(&join(key, "exponent"))?;
    Ok(Formula(format!("({amplitude:?})*(1 + t/({time:?}))^(-({exponent:?}))")))
}

fn decay(amplitude: f64, time: f64) -> String {
    // The literal rate, so that the formula is recognised as this exponential.
    format!("({amplitude:?})*exp(-({:?})*t)", 1.0 / time)
}

fn prony(reading: &Reading, key: &str) -> Result<Formula> {
    let terms = reading.entries(key)?;
    let hint = "for instance: terms = [[-0.5, 0.2], [-0.3, 2.0]]";
    reading.refuse_if(terms.is_empty(), key, "a Prony series without terms", hint)?;
    let term = |index| {
        let at = format!("{key}.{index}");
        reading.entries_of(&at, 2, "a term is a pair [amplitude, time], as in [-0.5, 0.2]")?;
        let amplitude = reading.finite(&format!("{at}.0"))?;
        Ok(decay(amplitude, reading.positive(&format!("{at}.1"))?))
    };
    Ok(Formula(terms.map(term).collect::<Result<Vec<_>, _>>()?.join(" + ")))
}

// `singular`: the exponent of kernels that are infinite at s = t.

/// The way out for a kernel that is infinite at lag zero, by the key of its formula.
pub(super) fn singular_way_out(formula: &str) -> String {
    format!(
        "a kernel (t - s)^(-a) b, 0 < a < 1, is integrable: give b as {formula} and singular = a beside it, with rule = \"product-integration\" under [time]"
    )
}

/// The a of a kernel (t - s)^{-a} b at a table, or 0.
///
/// # Errors
/// An exponent that is not between 0 and 1.
pub(super) fn singular_exponent(reading: &Reading, table: &str) -> Result<f64> {
    let key = join(table, "singular");
    let hint = "the kernel is t^(-singular) times its formula; from 1 on it has no integral, and without the key it is the formula";
    let given = reading.has(&key).then(|| reading.share(&key, hint)).transpose()?;
    Ok(given.unwrap_or(0.0))
}

/// The distinct exponents p of kernels t^{-p} b, with the factor T^{a-p} that bounds each by one with the largest, a,
/// which comes last; also for their last weights k^{1-p}/((1-p)(2-p)). Plain kernels, p = 0, are left out.
pub(crate) fn in_the_largest(
    exponents: impl Iterator<Item = f64>,
    horizon: f64,
) -> Vec<(f64, f64)> {
    let mut powers: Vec<f64> = exponents.filter(|&power| power > 0.0).collect();
    powers.sort_by(f64::total_cmp);
    powers.dedup();
    let most = powers.last().copied().unwrap_or(0.0);
    powers.into_iter().map(|power| (power, horizon.powf(most - power))).collect()
}

/// Refuses rules that evaluate a kernel at s = t where it is infinite; `key` is that of the exponent.
///
/// # Errors
/// Any rule but product integration.
pub(super) fn needs_product_integration(
    reading: &Reading,
    time: &Time,
    singular: Option<String>,
) -> Result<()> {
    let Some(key) = singular else { return Ok(()) };
    let message =
        "a kernel with `singular` is infinite at s = t, where this time rule takes its value";
    let hint = "add to [time]: rule = \"product-integration\", which integrates the power";
    reading.refuse_if(time.rule != TimeRule::ProductIntegration, &key, message, hint)
}

/// Refuses rules whose repeated sums have no bound; `key` is that of an inner kernel.
///
/// # Errors
/// Any rule but the trapezoidal one and those of endpoints.
pub(super) fn needs_repeated_rule(
    reading: &Reading,
    time: &Time,
    nested: Option<String>,
) -> Result<()> {
    let Some(key) = nested else { return Ok(()) };
    let message =
        format!("no bounds are known of a history of a history by this rule: {}", time.rule.name());
    let hint = "take rule = \"trapezoid\", \"left\" or \"right\" under [time]";
    reading.refuse_if(!time.rule.repeats(), &key, message, hint)
}
