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
    let power = singular_exponent(reading, key)?;
    let has = |name: &str| reading.has(&join(key, name));
    let apart = has("bulk") || has("shear");
    let mut parts: Vec<Part> = match (has("terms"), has("kernel"), has("lambda") || has("mu")) {
        (true, ..) => {
            let others = ["kernel", "lambda", "mu", "bulk", "shear", "singular"];
            if let Some(other) = others.iter().find(|other| has(other)) {
                let message = format!("`{other}` beside `terms`: each term has its own");
                let hint = "write it into the tables of terms, or remove terms";
                return Err(reading.key_error(&join(key, other), message, hint));
            }
            let key = join(key, "terms");
            let terms = reading.some_entries(&key)?.map(|i| join(&key, &i.to_string()));
            terms.map(|term| Part::read(reading, &term, horizon)).collect::<Result<_>>()?
        }
        (_, true, _) if !apart => vec![Part::read(reading, key, horizon)?],
        (_, false, false) if apart => {
            // bulk tr(ε) I, and 2 shear ε^D with ε^D = ε - tr(ε)/d I.
            let tensors = [("bulk", [1.0, 0.0]), ("shear", [-2.0 / dimension as f64, 1.0])];
            let mut parts = Vec::new();
            for (name, tensor) in tensors {
                let kernel = reading
                    .if_given(&join(key, name), |reading, key| validated(reading, key, horizon))?;
                let part = |kernel| Part { kernel, singular: None, inner: None, tensor };
                parts.extend(kernel.map(part));
            }
            parts
        }
        _ => {
            let message = format!(
                "[{key}] needs one kernel with its tensor, or the kernels of bulk and shear"
            );
            let hint = "give kernel, lambda and mu for kernel(t)(2 mu eps + lambda tr(eps) I), or terms, a list of such tables, or bulk and shear for bulk(t) tr(eps) I + 2 shear(t) dev(eps)";
            return Err(reading.error(key, message, hint));
        }
    };
    for part in parts.iter_mut().filter(|_| power > 0.0) {
        let factor = part.kernel;
        let (factors, powers) = ([("factor", factor)], [("power", power)]);
        part.kernel = reading.formulas.written("t^(-power)*factor", &factors, &powers);
        part.singular = Some(SingularParts { power, factor, region });
    }
    Ok(Some(parts))
}

impl Part {
    /// A kernel with its tensor, perhaps before a history of its own.
    fn read(reading: &mut Reading, table: &str, horizon: f64) -> Result<Self> {
        let of = |name: &str| join(table, name);
        let tensor = [reading.finite(&of("lambda"))?, reading.finite(&of("mu"))?];
        let kernel = validated(reading, &of("kernel"), horizon)?;
        let inner =
            reading.if_given(&of("inner"), |reading, key| validated(reading, key, horizon))?;
        Ok(Self { kernel, singular: None, inner, tensor })
    }
}

/// Memory kernels by name, a table in place of a formula in t.
///
/// `{ kind = "exponential", amplitude = a, time = τ }`: a exp(-t/τ); `{ kind = "prony", terms = [[a_1, τ_1], …] }`: Σ
/// a_i exp(-t/τ_i); `{ kind = "power", amplitude = a, time = τ, exponent = p }`: a (1 + t/τ)^{-p}, which is smooth on
/// [0, T].
const KERNELS: [(&str, &str); 3] =
    [("exponential", "amplitude time"), ("prony", "terms"), ("power", "amplitude time exponent")];

/// A kernel, or the factor of one, by its formula or by a table, with a proved bound on [0, T].
fn validated(reading: &mut Reading, key: &str, horizon: f64) -> Result<Node> {
    let of = |name: &str| join(key, name);
    let number = |name: &str| reading.finite(&of(name));
    // The literal rate, so that the formula is recognised as this exponential.
    let decay = |amplitude: f64, time: f64| format!("({amplitude:?})*exp(-({:?})*t)", 1.0 / time);
    let kind = if reading.has_parts(key) { reading.kind(key, &KERNELS)? } else { "" };
    let formula = match kind {
        "" => reading.required(key)?,
        "exponential" => Formula(decay(number("amplitude")?, reading.positive(&of("time"))?)),
        "power" => {
            let (amplitude, time) = (number("amplitude")?, reading.positive(&of("time"))?);
            let exponent = number("exponent")?;
            Formula(format!("({amplitude:?})*(1 + t/({time:?}))^(-({exponent:?}))"))
        }
        _ => {
            let term = |index| {
                let at = join(&of("terms"), &usize::to_string(&index));
                reading.entries_of(&at, 2)?;
                let amplitude = reading.finite(&join(&at, "0"))?;
                Ok(decay(amplitude, reading.positive(&join(&at, "1"))?))
            };
            let terms: Result<Vec<String>> =
                reading.some_entries(&of("terms"))?.map(term).collect();
            Formula(terms?.join(" + "))
        }
    };
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
    if reading.has(&key) { reading.share(&key, hint) } else { Ok(0.0) }
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

/// Refuses rules that do not serve a memory; the keys are those of an exponent and of an inner kernel, if there are any.
///
/// # Errors
/// A rule that evaluates kernels at s = t, where one is infinite; one whose repeated sums have no bound.
pub(super) fn has_a_rule(
    reading: &Reading,
    time: &Time,
    [singular, nested]: [Option<String>; 2],
) -> Result<()> {
    let message =
        "a kernel with `singular` is infinite at s = t, where this time rule takes its value";
    let hint = "add to [time]: rule = \"product-integration\", which integrates the power";
    let odd = time.rule != TimeRule::ProductIntegration;
    singular.map_or(Ok(()), |key| reading.refuse_if(odd, &key, message, hint))?;
    let message = format!(
        "no bounds are known of a history of a history by this rule: {}",
        time.rule.in_words()
    );
    let hint = "take rule = \"trapezoid\", \"left\" or \"right\" under [time]";
    nested.map_or(Ok(()), |key| reading.refuse_if(!time.rule.repeats(), &key, message, hint))
}
