//! The constants of (3.21)-(3.24) for a contact scene: m0 from proved bounds only, β_φ, and the parts
//! of the history with their norms.

use std::collections::BTreeMap;

use serde::Serialize;

use super::GronwallError;
use super::estimate::Estimate;
use super::recurrence::{HistoryPart, KernelNorms};
use super::rule::Weights;
use scene::setup::{Setup, constants};
use vhi::history::TimeGrid;
use vhi::law::{Convolution, HistoryKernel, TensorField};
use vhi::monotonicity;

/// Constants of one scene. Where they bound a measured difference, each is the value itself or a proved
/// upper bound.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GronwallConstants {
    /// m0 = m_𝒜 - α_ν C, C a proved upper bound of c_j² (a stress).
    pub m0: f64,
    /// C, where α_ν > 0 needs it (a length).
    pub trace_bound: Option<f64>,
    /// β_φ = max(μ L_κ √|Ω|, 1).
    pub beta: f64,
    /// μ L_κ √|Ω|, with which ζ enters; zero if κ does not depend on ζ or there is no projection.
    pub yielding: f64,
    /// sup ‖ℬ‖ over [0, T], operator norms on S^d; zero without memory. Of kernels t^{-a} C(t), a the largest power, sup ‖C‖.
    pub memory: f64,
    /// Of ζ: 1, or T^a.
    pub accumulated: f64,
    /// w_nj.
    pub weights: Weights,
}

/// The constants of (3.24) of any scene.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct InequalityConstants {
    /// m0.
    pub m0: f64,
    /// β_φ.
    #[serde(rename = "beta_phi")]
    pub beta: f64,
    /// ‖R‖‖q‖, or the Lipschitz constant of S.
    pub lipschitz: f64,
    /// β_φ/m0.
    #[serde(rename = "C1")]
    pub c1: f64,
    /// C1 ‖S‖.
    #[serde(rename = "C2")]
    pub c2: f64,
    /// What they are made of, by name.
    #[serde(flatten)]
    pub details: BTreeMap<&'static str, f64>,
}

impl InequalityConstants {
    pub(super) fn new(
        m0: f64,
        beta: f64,
        lipschitz: f64,
        details: BTreeMap<&'static str, f64>,
    ) -> Self {
        let c1 = beta / m0;
        Self { m0, beta, lipschitz, c1, c2: c1 * lipschitz, details }
    }
}

impl GronwallConstants {
    /// The constants of `setup`.
    ///
    /// # Errors
    /// A rule with weights for each kernel, no history, no proved bound of c_j², m0 ≤ 0, κ not Lipschitz.
    pub fn new(setup: &Setup) -> Result<Self, GronwallError> {
        let found = constants(setup)?;
        let scene = &setup.scene;
        let name = || scene.name.clone();
        let Some(weights) = Weights::of(scene.time.rule, found.singular.0) else {
            return Err(GronwallError::OwnWeights { scene: name() });
        };
        let friction = setup.body.contact.as_ref().and_then(|contact| contact.friction.as_ref());
        if friction.is_some_and(|law| law.alpha() > 0.0 || law.bound.coefficient() > 0.0) {
            return Err(GronwallError::NoTangentialBound { scene: name() });
        }
        let asked = found.alpha_nu > 0.0;
        let trace_bound = asked.then_some(found.c_j_squared_bound).flatten();
        if found.alpha_nu > 0.0 && trace_bound.is_none() {
            return Err(GronwallError::NoTraceBound { scene: name() });
        }
        let m0 = monotonicity(found.m_elastic, found.alpha_nu * trace_bound.unwrap_or(0.0));
        if m0.is_nan() || m0 <= 0.0 {
            return Err(GronwallError::Smallness { scene: name(), m0 });
        }
        let yielding = found.yielding;
        if !yielding.is_finite() {
            return Err(GronwallError::NotLipschitz { scene: name() });
        }
        let accumulated = weights.beside_plain(scene.time.horizon);
        let memory = accumulated * found.memory.operator + found.singular.1.operator;
        if yielding == 0.0 && memory == 0.0 {
            return Err(GronwallError::NoHistory { scene: name() });
        }
        let beta = found.beta_phi;
        Ok(Self { m0, trace_bound, beta, yielding, memory, accumulated, weights })
    }

    /// As every scene states them. ‖S‖ is that of the parts the scene has: 1 for ζ, plus sup ‖ℬ‖.
    pub(crate) fn summary(&self) -> InequalityConstants {
        let mut details =
            BTreeMap::from([("yielding", self.yielding), ("memory_norm", self.memory)]);
        details.extend(self.trace_bound.map(|bound| ("c_j_squared_bound", bound)));
        let lipschitz = self.memory + if self.has_zeta() { self.accumulated } else { 0.0 };
        InequalityConstants::new(self.m0, self.beta, lipschitz, details)
    }

    /// True if ζ is a part of the history.
    pub(crate) fn has_zeta(&self) -> bool {
        self.yielding > 0.0
    }

    /// An estimate with these constants on a grid, before anything is measured.
    pub(crate) fn blank(&self, setup: &Setup, grid: &TimeGrid) -> Estimate {
        let parts = self.parts(setup, grid);
        Estimate::blank(grid, self.weights, self.m0, self.beta, parts)
    }

    /// The parts of the history on a grid: ζ with κ = 1, the memory stress with κ(n, j) =
    /// ‖ℬ(t_n - t_j)‖. An absent part is left out.
    pub(crate) fn parts(&self, setup: &Setup, grid: &TimeGrid) -> Vec<HistoryPart> {
        let mut parts = Vec::new();
        if self.has_zeta() {
            let norms = KernelNorms::Constant(1.0);
            let supremum = self.accumulated;
            parts.push(HistoryPart { coefficient: self.yielding, norms, supremum });
        }
        if self.memory > 0.0 {
            let (terms, d) = (&setup.model.memory, setup.scene.dimension);
            let kernels: Vec<Convolution<'_>> =
                terms.iter().map(|term| Convolution(&*term.kernel)).collect();
            let kernels: Vec<&dyn HistoryKernel> =
                kernels.iter().map(|kernel| kernel as _).collect();
            let norm = |factors: &[f64]| {
                let mut each = terms.iter().map(|term| &term.tensor).zip(factors);
                let first = each.next().map(|(tensor, factor)| tensor.scaled(*factor));
                let sum =
                    |sum: TensorField, (tensor, factor): (&_, &f64)| sum.plus(*factor, tensor, d);
                first.map_or(0.0, |first| each.fold(first, sum).norm(d))
            };
            let uniform = setup.scene.time.grid == scene::TimeGrid::Uniform;
            let norms =
                KernelNorms::of(&kernels, norm, (self.weights.integrating(), grid), uniform);
            parts.push(norms.part(1.0, self.memory, grid));
        }
        parts
    }
}
