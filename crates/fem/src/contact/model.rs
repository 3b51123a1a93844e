//! The terms of (5.1)-(5.5) that a scene has. An absent term is `None` and costs nothing.

use std::sync::Arc;

use super::friction::{Friction, OnContactInTime};
use crate::space::Element;
use vhi::history::{TimeGrid, TimeRule, last_weight};
use vhi::law::{AnyProjection, MemoryKernel, Potential, Scaled, TensorField};

/// A term ∫_0^t b(t - s) ℬ₀ ε(u(s)) ds of the memory.
pub struct MemoryTerm {
    /// b.
    pub kernel: Box<dyn MemoryKernel>,
    /// ℬ₀.
    pub tensor: TensorField,
}

/// ℬ(lag) = Σ b_i(lag) ℬ_i on S^d; none without memory.
pub fn relaxation(terms: &[MemoryTerm], lag: f64, d: usize) -> Option<TensorField> {
    weighted_memory(terms, |kernel| kernel.value(lag), d)
}

/// Σ_i w_i ℬ_i likewise, w_i by the kernels.
pub fn weighted_memory(
    terms: &[MemoryTerm],
    weight: impl Fn(&dyn MemoryKernel) -> f64,
    d: usize,
) -> Option<TensorField> {
    let (first, others) = terms.split_first()?;
    let start = first.tensor.scaled(weight(&*first.kernel));
    let add =
        |sum: TensorField, term: &MemoryTerm| sum.plus(weight(&*term.kernel), &term.tensor, d);
    Some(others.iter().fold(start, add))
}

/// Where ∫_{Γ3} ∂j_ν(u_ν) v_ν is evaluated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BoundaryRule {
    /// At the vertices, with lumped weights.
    Vertex,
    /// At Gauss points of the facets; the constraint stays at the vertices.
    Gauss,
    /// The integral itself, as in (5.14): edges cut where u_ν - s crosses a kink of ∂j_ν (plane
    /// meshes); the constraint stays at the vertices.
    Exact,
}

impl BoundaryRule {
    /// Whether it is known for an element: rules on facets are those of linear u_ν.
    pub fn serves(self, element: Element) -> bool {
        self == Self::Vertex || element == Element::P1
    }
}

/// A function on Γ3.
pub type OnContact = Box<dyn Fn([f64; 3]) -> f64 + Send + Sync>;

/// Contact data on some sides of Γ3.
pub struct Boundary {
    /// These sides, by their numbers in the mesh; empty means all of Γ3.
    pub sides: Vec<u32>,
    /// ∂j_ν, but for the factor.
    pub potential: Arc<dyn Potential>,
    /// c > 0 at a point of Γ3: the law there is c ∂j_ν; none is one.
    pub scale: Option<OnContact>,
    /// g at a point of Γ3 and a time, infinite where there is no constraint.
    pub gap: OnContactInTime,
    /// s at a point of Γ3: the potential is evaluated at u_ν - s.
    pub shift: OnContact,
    /// Quadrature of the compliance term.
    pub rule: BoundaryRule,
}

impl Boundary {
    /// Whether it is that of a side.
    pub fn is_on(&self, side: u32) -> bool {
        self.sides.is_empty() || self.sides.contains(&side)
    }

    /// c at a point of Γ3.
    pub fn scale_at(&self, x: [f64; 3]) -> f64 {
        self.scale.as_ref().map_or(1.0, |scale| scale(x))
    }

    /// c ∂j_ν at a point of Γ3.
    pub fn potential_at(&self, x: [f64; 3]) -> Scaled {
        Scaled { potential: self.potential.clone(), factor: self.scale_at(x) }
    }
}

/// The model of a scene.
pub struct Model {
    /// 𝒜.
    pub elasticity: TensorField,
    /// ℬ(t) = Σ b_i(t) ℬ_i: one term where it is a scalar kernel times a tensor, none without memory.
    pub memory: Vec<MemoryTerm>,
    /// μ and κ(ζ).
    pub projection: Option<AnyProjection>,
    /// Contact, each side of Γ3 in one of them; empty if Γ3 is, or carries neither law nor gap.
    pub boundary: Vec<Boundary>,
    /// Friction on Γ3.
    pub friction: Option<Friction>,
    /// Quadrature in time.
    pub time_rule: Box<dyn TimeRule>,
}

impl Model {
    /// What a side of Γ3 has.
    pub fn boundary_on(&self, side: u32) -> Option<&Boundary> {
        self.boundary.iter().find(|boundary| boundary.is_on(side))
    }

    /// g at a point of Γ3 and a time, infinite without a constraint.
    pub fn gap(&self, side: u32, x: [f64; 3], t: f64) -> f64 {
        self.boundary_on(side).map_or(f64::INFINITY, |boundary| (boundary.gap)(x, t))
    }

    /// Weights of the last slot of level n, one per term of the memory.
    pub(crate) fn last_weights(&self, grid: &TimeGrid, n: usize) -> impl Iterator<Item = f64> {
        let weight =
            move |term: &MemoryTerm| last_weight(&*term.kernel, self.time_rule.as_ref(), grid, n);
        self.memory.iter().map(weight)
    }

    /// β with ℬ₀ = β𝒜, where there is one term and that is so; 0 without memory.
    pub(crate) fn memory_multiple(&self) -> Option<f64> {
        match &self.memory[..] {
            [] => Some(0.0),
            [term] => term.tensor.multiple_of(&self.elasticity),
            _ => None,
        }
    }
}
