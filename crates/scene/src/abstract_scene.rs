//! `kind = "abstract"`: Problem 1 in X = ℝ^m with a known solution, no mesh.
//!
//! ```text
//! A u = matrix u + g(u),                 g_i a formula in r = u_i
//! S u = R(Σ_l ∫_0^t q_l(t,s) Q_l u(s) ds + a_S), or v_l(s) = start + ∫_0^s r_l(s,τ) u(τ) dτ in place of u(s)
//! φ(y, u, v) = Σ_i N_i(y_i, u_i) v_i,    N_i a formula in y and r, by default y
//! j(γu) = Σ_i w_i j_i(a_i·u),            K = {l_i ≤ a_i·u ≤ g_i}, l_i = g_i fixing a_i·u
//! ```

use serde::de::IgnoredAny;

use formula::{EvaluationPoint, Node, Variable};

use super::definitions::definitions;
use super::law::Law;
use super::memory::{singular_exponent, singular_way_out};
use super::reading::{Reading, evenly, join};
use super::source::Result;

/// One kernel with its matrix: q_l(t, s) Q_l.
pub use exact::KernelFormulas as AbstractKernel;

pub(crate) type Rows = Vec<Vec<f64>>;

/// One functional a_i with the scene's data for a_i·u.
#[derive(Debug, Clone, PartialEq)]
pub struct AbstractTrace {
    /// a_i.
    pub functional: Vec<f64>,
    /// w_i > 0.
    pub weight: f64,
    /// ∂j_i; None is 0.
    pub law: Option<Law>,
    /// g_i, or ∞.
    pub upper: f64,
    /// l_i, or -∞.
    pub lower: f64,
}

/// The problem of an abstract scene as validated.
#[derive(Debug, Clone, PartialEq)]
pub struct AbstractScene {
    /// Gram matrix of the inner product of X, symmetric.
    pub inner_product: Rows,
    pub matrix: Rows,
    /// g_i in r (the first space coordinate); None for linear A.
    pub nonlinear: Option<Vec<Node>>,
    /// Empty without history.
    pub kernels: Vec<AbstractKernel>,
    pub r: Rows,
    pub a_s: Vec<f64>,
    /// Where inner histories begin.
    pub start: Vec<f64>,
    /// N_i in y (the second space coordinate) and r (the first); None is N_i = y_i.
    pub force: Option<Vec<Node>>,
    pub traces: Vec<AbstractTrace>,
    /// u(t).
    pub u: Vec<Node>,
    /// λ_i(t) per functional; None is 0.
    pub multiplier: Option<Vec<Node>>,
    /// ξ_i(t) ∈ ∂j_i(a_i·u) per functional; None if all laws are functions.
    pub selection: Option<Vec<Node>>,
}

/// Limit of unknowns, since matrices are dense.
pub(super) const MOST: i64 = 256;

/// Parts with the key that each needs if it is there.
const NEEDED: [(&str, &str); 3] =
    [("space", "inner_product"), ("phi", "force"), ("history", "kernels")];

impl AbstractScene {
    pub(super) fn validate(reading: &mut Reading, horizon: f64, m: usize) -> Result<Self> {
        for (part, key) in NEEDED.iter().filter(|(part, _)| reading.has(part)) {
            reading.required::<IgnoredAny>(&join(part, key))?;
        }
        let inner_product = square_or_identity(reading, "space.inner_product", m)?;
        reading.symmetric("space.inner_product", &inner_product)?;
        let matrix = reading.matrix("operator.matrix", m)?;
        let in_r = |reading: &mut Reading, key: &str, variables: &[Variable]| {
            let mut scope = reading.scope(variables);
            scope.define("r", reading.formulas.variable(Variable::X));
            reading.if_given(key, |reading, key| reading.vector(key, m, &scope))
        };
        let nonlinear = in_r(reading, "operator.nonlinear", &[])?;
        let force = in_r(reading, "phi.force", &[Variable::Y])?;
        let kernels = kernels(reading, horizon, m)?;
        let r = square_or_identity(reading, "history.R", m)?;
        let mut or_zero = |key| {
            let given = reading.if_given(key, |reading, key| reading.numbers(key, m))?;
            Ok(given.unwrap_or_else(|| vec![0.0; m]))
        };
        let (a_s, start) = (or_zero("history.a_S")?, or_zero("history.start")?);
        let idle =
            reading.has("history.start") && kernels.iter().all(|kernel| kernel.inner.is_none());
        let message = "`start` is where inner histories begin, and no kernel has one";
        let hint = "add inner to a kernel, or write a constant of S into a_S";
        reading.refuse_if(idle, "history.start", message, hint)?;
        let traces = reading.entries("trace")?;
        let traces = traces.map(|i| AbstractTrace::validate(reading, i, m));
        let traces = traces.collect::<Result<Vec<_>, _>>()?;
        let scope = definitions(reading, reading.scope(&[Variable::T]))?;
        let u = reading.vector("exact.u", m, &scope)?;
        let mut of_traces =
            |key| reading.if_given(key, |reading, key| reading.vector(key, traces.len(), &scope));
        Ok(Self {
            inner_product,
            matrix,
            nonlinear,
            kernels,
            r,
            a_s,
            start,
            force,
            u,
            multiplier: of_traces("exact.multiplier")?,
            selection: of_traces("exact.selection")?,
            traces,
        })
    }

    /// The key of the first exponent of a kernel that is infinite at s = t.
    pub(super) fn singular_key(&self) -> Option<String> {
        let at = self.kernels.iter().position(|kernel| kernel.power > 0.0);
        at.map(|l| format!("history.kernels.{l}.singular"))
    }

    /// The key of the first inner kernel.
    pub(super) fn nested_key(&self) -> Option<String> {
        let at = self.kernels.iter().position(|kernel| kernel.inner.is_some());
        at.map(|l| format!("history.kernels.{l}.inner"))
    }
}

fn square_or_identity(reading: &Reading, key: &str, m: usize) -> Result<Rows> {
    let row = |i| (0..m).map(|j| f64::from(u8::from(i == j))).collect();
    if reading.has(key) { reading.matrix(key, m) } else { Ok((0..m).map(row).collect()) }
}

fn kernels(reading: &mut Reading, horizon: f64, m: usize) -> Result<Vec<AbstractKernel>> {
    let mut scope = reading.scope(&[Variable::T]);
    scope.define("s", reading.formulas.variable(Variable::X));
    // r(s, tau) is kept as q is, with t for s and the first coordinate for tau.
    let mut within = reading.scope(&[]);
    within.define("s", reading.formulas.variable(Variable::T));
    within.define("tau", reading.formulas.variable(Variable::X));
    let mut kernels = Vec::new();
    for l in reading.entries("history.kernels")? {
        let key = format!("history.kernels.{l}");
        let of_q = join(&key, "q");
        let q = reading.formula(&of_q, &scope)?;
        let matrix = square_or_identity(reading, &join(&key, "matrix"), m)?;
        let ends = || {
            let ends = evenly(0.0, horizon, ENDS).skip(1);
            ends.map(|t| EvaluationPoint { x: t, t, ..EvaluationPoint::default() })
        };
        reading.everywhere((&of_q, q), ends(), f64::is_finite, |at, value| {
            (format!("q(t, s) is {value} at s = t = {}", at.t), singular_way_out("q"))
        })?;
        let power = singular_exponent(reading, &key)?;
        let of_inner = join(&key, "inner");
        let inner = reading.if_given(&of_inner, |reading, key| reading.formula(key, &within))?;
        if let Some(r) = inner {
            reading.everywhere((&of_inner, r), ends(), f64::is_finite, |at, value| {
                let hint = "an inner kernel must be continuous for 0 <= tau <= s <= T";
                (format!("r(s, tau) is {value} at tau = s = {}", at.t), hint.to_string())
            })?;
        }
        let both = inner.is_some() && power > 0.0;
        let message = "a kernel with an inner one has no `singular` exponent";
        let hint = "remove `singular`: histories of histories are for continuous kernels";
        reading.refuse_if(both, &of_inner, message, hint)?;
        kernels.push(AbstractKernel { q, power, inner, matrix });
    }
    Ok(kernels)
}

impl AbstractTrace {
    fn validate(reading: &mut Reading, index: usize, m: usize) -> Result<Self> {
        let table = format!("trace.{index}");
        let key = |name: &str| join(&table, name);
        let functional = reading.numbers(&key("functional"), m)?;
        let zero = functional.iter().all(|a| *a == 0.0);
        let message = "the functional is zero: it says nothing of u";
        reading.refuse_if(zero, &key("functional"), message, "give one nonzero number")?;
        if reading.has(&key("law.scale")) {
            let message = "a functional has no place that `scale` could depend on";
            let hint = "remove `scale` and write the factor into the numbers of the law";
            return Err(reading.key_error(&key("law.scale"), message, hint));
        }
        let law = Law::validate(reading, &key("law"))?;
        let bound = |name: &str| reading.optional::<f64>(&key(name));
        let lower = bound("lower")?.unwrap_or(f64::NEG_INFINITY);
        let upper = bound("upper")?.unwrap_or(f64::INFINITY);
        let empty = lower.is_nan() || upper.is_nan() || lower > upper;
        let message = format!("no number lies between lower = {lower} and upper = {upper}");
        reading.refuse_if(
            empty,
            &key("lower"),
            message,
            "K needs lower <= upper, where lower = upper fixes a·u",
        )?;
        let weight = reading.if_given(&key("weight"), |reading, key| reading.positive(key))?;
        Ok(Self { functional, weight: weight.unwrap_or(1.0), law, upper, lower })
    }

    /// Whether a_i·u is bounded.
    pub fn is_bounded(&self) -> bool {
        self.upper.is_finite() || self.lower.is_finite()
    }
}

/// Times t > 0 at which q(t, t) must be finite.
const ENDS: u32 = 16;
