//! Constants of the contact problem (section 5 of the paper) for its step size.

use super::kernel_bounds::NESTED;
use super::trace_constant::{TraceConstant, weight_by_side, weighted_trace_constant};
use super::{AbstractSetup, Result, Setup, SetupError, elasticity};
use crate::memory::in_the_largest;
use crate::{RelaxationTerm, Side};
use fem::contact::{Discretization, TraceMass, TracePart, weighted_trace_constants};
use formula::{EvaluationPoint, Interval, Node, Variable};
use vhi::history::TimeRule;
use vhi::law::TensorField;
use vhi::{SingularSlot, StepBounds, monotonicity};

/// Constants of the step-size bound and the smallness condition.
#[derive(Debug, Clone, PartialEq)]
pub struct Constants {
    /// m_𝒜, smallest eigenvalue of 𝒜 on S^d (a stress).
    pub m_elastic: f64,
    /// m_A = m_𝒜 + μ.
    pub m_a: f64,
    /// L_A = largest eigenvalue of 𝒜, plus μ.
    pub l_a: f64,
    /// α_φ = μ, from the projection only; [`Self::alpha_phi_as_printed`] includes all of φ.
    pub alpha_phi: f64,
    /// α_ν of (2.8c) (a stiffness), the largest of all contact sides.
    pub alpha_nu: f64,
    /// c_ν² (a length) of Σ α_i ‖v_ν‖² ≤ α_ν c_ν² ‖ε(v)‖² over the contact sides: c_j² where there is one law.
    pub c_nu_squared: f64,
    /// Between these.
    pub c_nu_range: [f64; 2],
    /// A proved upper bound of c_ν².
    pub c_nu_squared_bound: Option<f64>,
    /// c_j² (a length): a limit of meshes, not a bound.
    pub c_j_squared: f64,
    /// Between these.
    pub c_j_range: [f64; 2],
    /// A proved upper bound of c_j²: the distance of Γ3 from a clamped parallel side.
    pub c_j_squared_bound: Option<f64>,
    /// α_τ of friction whose bound falls with the slip (a stiffness).
    pub alpha_tau: f64,
    /// Friction whose bound follows the normal law.
    pub coulomb: Option<Coulomb>,
    /// c_τ² (a length), likewise for u_τ; 0 if not computed.
    pub c_tau_squared: f64,
    /// Between these.
    pub c_tau_range: [f64; 2],
    /// m0 = m_𝒜 - [`Self::concave`].
    pub m0: f64,
    /// Between these, with the ranges of c_j² and c_τ².
    pub m0_range: [f64; 2],
    /// L_κ, see [`super::YieldSlope`].
    pub lipschitz_kappa: f64,
    /// √|Ω|.
    pub root_area: f64,
    /// μ L_κ √|Ω|.
    pub yielding: f64,
    /// β_φ = max(μ L_κ √|Ω|, 1).
    pub beta_phi: f64,
    /// ℬ(t) on [0, T], without its terms that are infinite at t = 0.
    pub memory: MemoryNorms,
    /// a, and C(t) of the terms t^{-a} C(t).
    pub singular: (f64, MemoryNorms),
    /// The last slot on each region, the rest of the body first.
    pub regions: Vec<RegionSlot>,
}

/// What is known of 0 < m0, (2.9).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Smallness {
    Holds,
    Fails,
    /// Zero lies in the range of m0.
    Unknown,
}

/// S = μ_f p(u_ν).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coulomb {
    /// μ_f.
    pub coefficient: f64,
    /// The steepest rise of p (a stiffness).
    pub rise: f64,
}

impl Coulomb {
    /// A and B such that normal law and friction together take at most A‖v_ν‖² + B‖v_τ‖².
    ///
    /// For two states with differences a of u_ν and b of u_τ, p differs by q a with -α_ν ≤ q ≤ L, and the two terms by
    /// at least q a² - μ_f |q||a||b|. For q > 0 that is at least -μ_f² q b²/4, else at least -(α_ν + θ/2) a² - μ_f²
    /// α_ν² b²/(2θ) for any θ > 0: this θ minimises the sum.
    pub fn coefficients(&self, alpha_nu: f64, c_j_squared: f64, c_tau_squared: f64) -> [f64; 2] {
        let square = self.coefficient.powi(2);
        let rising = 0.25 * square * self.rise;
        if alpha_nu == 0.0 {
            return [0.0, rising];
        }
        let best = self.coefficient * alpha_nu * (c_tau_squared / c_j_squared).sqrt();
        // Beyond this θ the part with q > 0 is the larger one.
        let most = if self.rise > 0.0 { 2.0 * alpha_nu.powi(2) / self.rise } else { best };
        let theta = best.min(most);
        [alpha_nu + 0.5 * theta, rising.max(0.5 * square * alpha_nu.powi(2) / theta)]
    }
}

/// What one region has in the last slot of the history, for weight 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RegionSlot {
    /// The smallest eigenvalue of 𝒜 there.
    pub m_elastic: f64,
    /// Of ℬ(0), and of C(0) in the terms t^{-a} C(t).
    pub memory: MemoryNorms,
    pub singular: MemoryNorms,
}

impl Constants {
    /// α_ν c_ν² + α_τ c_τ².
    pub(super) fn falls(&self) -> f64 {
        self.alpha_nu * self.c_nu_squared + self.alpha_tau * self.c_tau_squared
    }

    /// Whether the memory has histories of histories: their norms are then in place of those of singular terms.
    pub fn is_nested(&self) -> bool {
        self.singular.0 == NESTED
    }

    /// α_ν and α_τ; with friction that follows the normal law A and B of [`Coulomb::coefficients`].
    pub(super) fn coefficients(&self) -> [f64; 2] {
        self.coefficients_with([self.c_nu_squared, self.c_tau_squared])
    }

    fn coefficients_with(&self, [c_j_squared, c_tau_squared]: [f64; 2]) -> [f64; 2] {
        match &self.coulomb {
            None => [self.alpha_nu, self.alpha_tau],
            Some(coulomb) => coulomb.coefficients(self.alpha_nu, c_j_squared, c_tau_squared),
        }
    }

    /// α_ν c_ν² + α_τ c_τ², the part of the monotonicity taken by falling laws, or A c_j² + B c_τ², which bounds λ_max(A
    /// M_ν + B M_τ).
    pub fn concave(&self) -> f64 {
        self.concave_with([self.c_nu_squared, self.c_tau_squared])
    }

    /// The same of other c_j² and c_τ², with which it grows.
    fn concave_with(&self, squares: [f64; 2]) -> f64 {
        if self.coulomb.is_some() && squares.contains(&f64::INFINITY) {
            return f64::INFINITY;
        }
        // What takes nothing may be known as badly as it likes.
        let taken = self.coefficients_with(squares).into_iter().zip(squares);
        taken.map(|(a, c)| if a == 0.0 { 0.0 } else { a * c }).sum()
    }

    /// What is known of 0 < m0.
    pub fn smallness(&self) -> Smallness {
        match self.m0_range {
            [low, _] if low > 0.0 => Smallness::Holds,
            [_, high] if high <= 0.0 => Smallness::Fails,
            _ => Smallness::Unknown,
        }
    }

    /// α_φ of (2.7b) for all of φ: μ, and μ_f L_p c_j c_τ of friction that follows the normal law, with the
    /// extrapolated c_j and c_τ.
    pub fn alpha_phi_as_printed(&self) -> f64 {
        let product = (self.c_j_squared * self.c_tau_squared).sqrt();
        let taken = |law: Coulomb| law.coefficient * law.rise.max(self.alpha_nu) * product;
        self.alpha_phi + self.coulomb.map_or(0.0, taken)
    }

    /// The largest over all regions of what `of` makes of the region and its share m0/d, m0 the least one and d the region's
    /// own part of the monotonicity: m_𝒜 there less what the laws on Γ3 take.
    ///
    /// If δ is the difference of two solutions and η that of their frozen slots, Σ d ‖δ‖² ≤ w Σ β ‖η‖ ‖δ‖ over the
    /// regions. So ‖δ‖ ≤ w max(β/√d) ‖η‖/√m0, and a step is monotone as long as w β < d on each region, β = -λ_min ℬ(0). Both
    /// are sharper than the largest β over the smallest d, m0.
    fn by_region(&self, of: impl Fn(&RegionSlot, f64) -> f64) -> f64 {
        let share = |region: &RegionSlot| {
            let least = self.m0_range[0];
            let share = least / (region.m_elastic - self.m_elastic + least);
            // 1 on the softest region, and where (2.9) fails.
            if share > 0.0 && share < 1.0 { share } else { 1.0 }
        };
        self.regions.iter().map(|region| of(region, share(region))).fold(0.0, f64::max)
    }

    /// The bounds on the step size that follow, with the least m0.
    pub fn step_bounds(&self, rule: &dyn TimeRule) -> StepBounds {
        StepBounds {
            m0: self.m0_range[0],
            beta_phi: self.beta_phi,
            lipschitz: 1.0 + self.memory.operator,
            paper_lipschitz: 1.0 + self.memory.entries,
            last_slot: self.yielding
                + self.by_region(|region, share| share.sqrt() * region.memory.at_zero),
            destabilizing: self.by_region(|region, share| {
                share * (self.yielding + (-region.memory.spectrum_at_zero.0).max(0.0))
            }),
            last_share: rule.last_share(),
            singular: SingularSlot {
                power: self.singular.0,
                // A history of a history has the last weight w_nn².
                share: match self.is_nested() {
                    true => rule.last_share().powi(2),
                    false => rule.last_weight(self.singular.0, 1.0),
                },
                lipschitz: self.singular.1.operator,
                paper_lipschitz: self.singular.1.entries,
                last_slot: self.by_region(|region, share| share.sqrt() * region.singular.at_zero),
                destabilizing: self.by_region(|region, share| {
                    share * (-region.singular.spectrum_at_zero.0).max(0.0)
                }),
            },
        }
    }
}

/// The constants of a scene, c_τ² if there is friction.
///
/// # Errors
/// A stiffness matrix that cannot be factorized.
pub fn constants(setup: &Setup) -> Result<Constants> {
    constants_by(setup, true, |part, weights| of_domain(setup, part, weights))
}

/// The constants for the step size: c_j² is computed only if the law falls somewhere.
///
/// # Errors
/// As [`constants`].
pub fn step_bounds(setup: &Setup) -> Result<StepBounds> {
    Ok(needed(setup)?.step_bounds(setup.model.time_rule.as_ref()))
}

/// The constants for (2.9) and the step size.
///
/// # Errors
/// As [`constants`].
pub(super) fn needed(setup: &Setup) -> Result<Constants> {
    constants_by(setup, false, |part, weights| of_domain(setup, part, weights))
}

/// c_j², c_ν² or c_τ², without contact 0.
fn of_domain(setup: &Setup, part: TracePart, weights: &[(Side, f64)]) -> Result<TraceConstant> {
    let domain = &setup.body.domain;
    if domain.contact.is_empty() {
        return Ok(TraceConstant::ZERO);
    }
    // ‖ε(v)‖² is the energy of the tensor with 2μ = 1 and λ = 0.
    weighted_trace_constant(domain, &TensorField::identity(), part, weights)
}

/// The constants with every c_ν² and c_τ², or with each only if a law on Γ3 takes from the monotonicity by it; then c_j² where
/// it is c_ν².
fn constants_by(
    setup: &Setup,
    every: bool,
    constant: impl Fn(TracePart, &[(Side, f64)]) -> Result<TraceConstant>,
) -> Result<Constants> {
    let of = |part, weights: &[(Side, f64)], is_needed| match every || is_needed {
        true => constant(part, weights),
        false => Ok(TraceConstant::ZERO),
    };
    let (follows, sides) = (coulomb(setup).is_some(), falling_sides(setup));
    let falling = of(TracePart::Normal, &sides, alpha_nu(setup) > 0.0 || follows)?;
    let normal = match sides[..] {
        [] => falling.clone(),
        _ => of(TracePart::Normal, &[], false)?,
    };
    let tangential = match setup.body.friction() {
        None => TraceConstant::ZERO,
        Some(friction) => of(TracePart::Tangential, &[], follows || friction.alpha() > 0.0)?,
    };
    Ok(with_trace_constants(setup, [&normal, &falling, &tangential]))
}

/// The constants of a scene for a given c_j², c_ν² and c_τ².
pub fn with_trace_constants(
    setup: &Setup,
    [normal, falling, tangential]: [&TraceConstant; 3],
) -> Constants {
    let scene = &setup.scene;
    let material = &setup.body.material;
    let tensor = elasticity(material);
    let (m_elastic, largest) = tensor.eigenvalues(scene.dimension);
    let mu = setup.projection_mu();
    let alpha_nu = alpha_nu(setup);
    let lipschitz_kappa = setup.kappa.lipschitz;
    let root_area = setup.body.domain.measure().sqrt();
    let yielding = mu * lipschitz_kappa * root_area;
    let plain = norms_of_power(setup, 0.0);
    let (power, singular) = singular_norms(setup);
    let slots = plain.iter().zip(&singular).enumerate();
    let regions = slots
        .map(|(region, (&memory, &singular))| RegionSlot {
            m_elastic: tensor.on(region).eigenvalues(scene.dimension).0,
            memory,
            singular,
        })
        .collect();
    // Of contact sides those alone whose laws fall, where they do by one α; all where all or none fall; none where they differ.
    let (mut falling_domain, sides) = (setup.body.domain.clone(), falling_sides(setup));
    if !sides.is_empty() {
        let alike = sides.iter().all(|(_, weight)| *weight == 1.0);
        falling_domain.contact = sides.iter().filter(|_| alike).map(|(side, _)| *side).collect();
    }
    let mut constants = Constants {
        m_elastic,
        m_a: m_elastic + mu,
        l_a: largest + mu,
        alpha_phi: mu,
        alpha_nu,
        alpha_tau: setup.body.friction().map_or(0.0, crate::Friction::alpha),
        coulomb: coulomb(setup),
        c_tau_squared: tangential.value,
        c_tau_range: tangential.range(),
        c_j_squared: normal.value,
        c_j_range: normal.range(),
        // If the lines from Γ3, one plane piece, into the body end on a clamped side after at most H, then for v = 0 there
        // |v_ν(x, 0)|² ≤ H ∫_0^H |∂_y v_y|² dy, so c_j² ≤ H.
        //
        // On the structured mesh of a rectangle this holds for the vertex rule too: ∂_y v_y is constant on vertical edges,
        // each triangle (or tetrahedron) has one of them, and h times the sum over edges with the vertex weights is the
        // integral over Ω.
        c_j_squared_bound: setup.body.domain.depth_under_contact(),
        c_nu_squared: falling.value,
        c_nu_range: falling.range(),
        c_nu_squared_bound: falling_domain.depth_under_contact(),
        m0: f64::NAN,
        m0_range: [f64::NAN; 2],
        lipschitz_kappa,
        root_area,
        yielding,
        beta_phi: yielding.max(1.0),
        memory: MemoryNorms::of_all(&plain),
        singular: (power, MemoryNorms::of_all(&singular)),
        regions,
    };
    let [[c_nu, most_c_nu], [c_tau, most_c_tau]] = [constants.c_nu_range, constants.c_tau_range];
    let m0 = |squares| match constants.concave_with(squares) {
        f64::INFINITY => f64::NEG_INFINITY,
        concave => monotonicity(m_elastic, concave),
    };
    let range = [m0([most_c_nu, most_c_tau]), m0([c_nu, c_tau])];
    (constants.m0, constants.m0_range) = (m0([falling.value, tangential.value]), range);
    constants
}

fn alpha_nu(setup: &Setup) -> f64 {
    setup.body.contact.iter().map(crate::Contact::alpha).fold(0.0, f64::max)
}

/// α_i/α_ν on the contact sides whose laws fall; none where these are all contact sides with one α, or there are none.
///
/// ∂j_ν on Γ_i satisfies (2.8c) with α_i, so two states lose at most Σ α_i ‖v_ν‖² over the Γ_i = α_ν Σ (α_i/α_ν) ‖v_ν‖² ≤ α_ν
/// c_ν² ‖ε(v)‖²: (2.9) for all sides together, and never more than α_ν c_j², or than Σ α_i c_i² with the constants c_i² of
/// single sides.
pub fn falling_sides(setup: &Setup) -> Vec<(Side, f64)> {
    let most = alpha_nu(setup);
    let all = setup.body.contact.iter();
    let all: Vec<(Side, f64)> =
        all.flat_map(|c| c.sides.iter().map(move |&side| (side, c.alpha() / most))).collect();
    match most > 0.0 && all.iter().any(|(_, weight)| *weight != 1.0) {
        true => all.into_iter().filter(|(_, weight)| *weight > 0.0).collect(),
        false => Vec::new(),
    }
}

/// c̄0 and c1 of (2.8b), |ξ| ≤ c̄0 + c1 |r|, that hold for every law on Γ3, with the largest factors.
pub fn growth(setup: &Setup) -> [f64; 2] {
    let mut largest = [0.0f64; 2];
    for (contact, boundary) in setup.body.contact.iter().zip(&setup.model.boundary) {
        let factor = contact.law.as_ref().map_or(1.0, crate::Law::largest_scale);
        let (c0, c1) = boundary.potential.growth();
        largest = [largest[0].max(factor * c0), largest[1].max(factor * c1)];
    }
    largest
}

fn coulomb(setup: &Setup) -> Option<Coulomb> {
    let contact = setup.body.contact.iter().find(|contact| contact.friction.is_some())?;
    let coefficient = contact.friction.as_ref()?.bound.coefficient();
    let rise = contact.law.as_ref()?.steepest_rise();
    (coefficient > 0.0).then_some(Coulomb { coefficient, rise })
}

// Bound of the contraction factor of the decomposition of Remark 3, from the scene's constants.

/// (α_ν c_j² + α_τ c_τ²)/m on this mesh and grid, with m = m_𝒜 - w(μ L_κ √|Ω| + max(0, -λ_min ℬ(0))), less what
/// friction that follows the normal law adds to α_ν c_j² in (2.9), (A - α_ν) c_j² + B c_τ²; c_j² and c_τ² by the lumped
/// trace mass. Below one if and only if the step satisfies (2.9) with these constants. Infinite for m ≤ 0, 0 for convex
/// potentials. w is the largest weight of the last slot, k/2 for the trapezoidal rule.
///
/// # Errors
/// [`SetupError::Constant`].
pub fn decomposition_bound(
    setup: &Setup,
    space: &Discretization,
    n: u32,
    steps: u32,
) -> Result<f64> {
    let constants = constants_by(setup, false, |part, weights| {
        let square = [(part, TraceMass::Lumped)];
        let weight = weight_by_side(weights);
        weighted_trace_constants(space, &TensorField::identity(), square, &weight)
            .map(|[found]| TraceConstant::exactly(found.value))
            .map_err(|source| SetupError::Constant { n, source })
    })?;
    let bounds = constants.step_bounds(setup.model.time_rule.as_ref());
    let last = bounds.taken(setup.grid(steps).largest_step());
    let falls = constants.falls();
    let m = constants.m_elastic - last - (constants.concave() - falls);
    Ok(quotient(falls, m))
}

/// The contraction factor of the decomposition for an abstract problem: α_j c_j²/(m_A - α_φ - w β_φ‖R‖‖q(t,t)‖).
pub fn abstract_decomposition_bound(setup: &AbstractSetup, steps: u32) -> f64 {
    let c = &setup.constants;
    let bounds = c.step_bounds(setup.model.time_rule.as_ref());
    let last = bounds.taken(setup.grid(steps).largest_step());
    quotient(c.alpha_j * c.c_j_squared, c.m_a - c.alpha_phi - last)
}

fn quotient(above: f64, m: f64) -> f64 {
    match (above == 0.0, m > 0.0) {
        (true, _) => 0.0,
        (false, true) => above / m,
        (false, false) => f64::INFINITY,
    }
}

// Proved norms of the relaxation tensor ℬ(t) = Σ b_i(t) ℬ_i over [0, T], region by region.

/// Norms of the relaxation tensor.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct MemoryNorms {
    /// max over [0, T] of the operator norm of ℬ(t) on S^d: proved, and attained but for a relative 1e-7.
    pub operator: f64,
    /// max over [0, T] of the sum of the moduli of all entries, the paper's norm of Q_∞, likewise.
    pub entries: f64,
    /// Operator norm of ℬ(0).
    pub at_zero: f64,
    /// Smallest and largest eigenvalue of ℬ(0) on S^d.
    pub spectrum_at_zero: (f64, f64),
}

impl MemoryNorms {
    /// The larger of each, for two regions.
    fn or(self, other: Self) -> Self {
        let ((a, b), (c, d)) = (self.spectrum_at_zero, other.spectrum_at_zero);
        Self {
            operator: self.operator.max(other.operator),
            entries: self.entries.max(other.entries),
            at_zero: self.at_zero.max(other.at_zero),
            spectrum_at_zero: (a.min(c), b.max(d)),
        }
    }

    /// The largest of all regions.
    fn of_all(regions: &[Self]) -> Self {
        regions.iter().copied().reduce(Self::or).unwrap_or_default()
    }
}

/// The norms on each region, the rest of the body first, of the terms of ℬ with t^{-power} in their kernels, without it; for
/// [`NESTED`] of the histories of histories, with the kernel ±max |r| q, of the sign of r(0).
fn norms_of_power(setup: &Setup, power: f64) -> Vec<MemoryNorms> {
    let mut graph = setup.scene.formulas.clone();
    let material = &setup.body.material;
    let over = Interval::new(0.0, setup.scene.time.horizon);
    let mut factor = |memory: &RelaxationTerm| match (memory.singular, memory.inner) {
        (None, Some(r)) => (power == NESTED).then(|| {
            let most = graph.largest_modulus(r, Variable::T, over).bound;
            let now = graph.evaluate(r, &EvaluationPoint::default());
            let most = graph.constant(most.copysign(now));
            graph.mul(most, memory.kernel)
        }),
        (None, None) => (power == 0.0).then_some(memory.kernel),
        (Some(singular), _) => (power == singular.power).then_some(singular.factor),
    };
    let factors: Vec<Option<Node>> = material.memory.iter().map(&mut factor).collect();
    let of_region = |region: usize| {
        let lame = |memory: &RelaxationTerm| match region {
            0 => [memory.lambda, memory.mu],
            named => memory.regions[named - 1],
        };
        let terms = material.memory.iter().zip(&factors);
        let terms: Vec<(Node, [f64; 2])> =
            terms.filter_map(|(memory, b)| Some(((*b)?, lame(memory)))).collect();
        let d = setup.scene.dimension as f64;
        let mut sum = |weight: &dyn Fn([f64; 2]) -> f64| {
            graph.weighted_sum(terms.iter().map(|&(kernel, lame)| (weight(lame), kernel)))
        };
        // ℬ is isotropic: its eigenvalues are those on deviators and spheres.
        let deviator = sum(&|[_, mu]| 2.0 * mu);
        let sphere = sum(&|[lambda, mu]| 2.0 * mu + d * lambda);
        let (lambda, normal) = (sum(&|[lambda, _]| lambda), sum(&|[lambda, mu]| lambda + 2.0 * mu));
        // Σ |ℬ_ijkl|, as Σ |λ δ_ij δ_kl + μ(δ_ik δ_jl + δ_il δ_jk)|.
        let nodes = [("normal", normal), ("lambda", lambda), ("deviator", deviator)];
        let text = "n*abs(normal) + n*(n - 1)*abs(lambda) + n*(n - 1)*abs(deviator)";
        let entries = graph.written(text, &nodes, &[("n", d)]);
        let bound = |node: Node| graph.largest_modulus(node, Variable::T, over).bound;
        let [a, b] =
            [deviator, sphere].map(|node| graph.evaluate(node, &EvaluationPoint::default()));
        MemoryNorms {
            operator: bound(deviator).max(bound(sphere)),
            entries: bound(entries),
            at_zero: a.abs().max(b.abs()),
            spectrum_at_zero: (a.min(b), a.max(b)),
        }
    };
    (0..=material.regions.len()).map(of_region).collect()
}

/// The largest power a, and the norms of all terms that are infinite at t = 0 as terms t^{-a} C(t), on each region.
fn singular_norms(setup: &Setup) -> (f64, Vec<MemoryNorms>) {
    let horizon = setup.scene.time.horizon;
    if setup.body.material.memory.iter().any(|term| term.inner.is_some()) {
        return (NESTED, norms_of_power(setup, NESTED));
    }
    let terms = setup.body.material.memory.iter().filter_map(|term| term.singular);
    let powers = in_the_largest(terms.map(|singular| singular.power), horizon);
    let none = vec![MemoryNorms::default(); setup.body.material.regions.len() + 1];
    powers.into_iter().fold((0.0, none), |(_, mut sums), (power, scale)| {
        for (sum, norms) in sums.iter_mut().zip(norms_of_power(setup, power)) {
            sum.operator += scale * norms.operator;
            sum.entries += scale * norms.entries;
            sum.at_zero += scale * norms.at_zero;
            sum.spectrum_at_zero.0 += scale * norms.spectrum_at_zero.0.min(0.0);
            sum.spectrum_at_zero.1 += scale * norms.spectrum_at_zero.1.max(0.0);
        }
        (power, sums)
    })
}
