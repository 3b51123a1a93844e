//! The terms of (5.1)-(5.5) that a scene has. An absent term is `None` and costs nothing.

use std::sync::Arc;

use crate::history::TimeRule;
use crate::law::{Isotropic, MemoryKernel, Potential, Projection, Scaled};

/// Memory ∫_0^t b(t - s) ℬ₀ ε(u(s)) ds.
pub struct MemoryTerm {
    /// b.
    pub kernel: Box<dyn MemoryKernel>,
    /// ℬ₀.
    pub tensor: Isotropic,
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

/// A function on Γ3.
pub type OnContact = Box<dyn Fn([f64; 3]) -> f64 + Send + Sync>;

/// Contact data on Γ3.
pub struct Boundary {
    /// ∂j_ν, but for the factor.
    pub potential: Arc<dyn Potential>,
    /// c > 0 at a point of Γ3: the law there is c ∂j_ν; none is one.
    pub scale: Option<OnContact>,
    /// g at a point of Γ3, infinite where there is no constraint.
    pub gap: OnContact,
    /// s at a point of Γ3: the potential is evaluated at u_ν - s.
    pub shift: OnContact,
    /// Quadrature of the compliance term.
    pub rule: BoundaryRule,
}

impl Boundary {
    /// c at a point of Γ3.
    pub fn scale_at(&self, x: [f64; 3]) -> f64 {
        self.scale.as_ref().map_or(1.0, |scale| scale(x))
    }

    /// c ∂j_ν at a point of Γ3.
    pub fn potential_at(&self, x: [f64; 3]) -> Arc<dyn Potential> {
        match &self.scale {
            None => self.potential.clone(),
            Some(scale) => Arc::new(Scaled { potential: self.potential.clone(), factor: scale(x) }),
        }
    }
}

/// The model of a scene; `P` is the projection term or [`crate::law::NoProjection`].
pub struct Model<P> {
    /// 𝒜.
    pub elasticity: Isotropic,
    /// ℬ.
    pub memory: Option<MemoryTerm>,
    /// μ and κ(ζ).
    pub projection: P,
    /// Contact; `None` if Γ3 is empty or carries neither law nor gap.
    pub boundary: Option<Boundary>,
    /// Quadrature in time.
    pub time_rule: Box<dyn TimeRule>,
}

impl<P: Projection> Model<P> {
    /// True if the discrete problem is linear: neither projection nor contact.
    pub fn is_linear(&self) -> bool {
        self.projection.limit().is_none() && self.boundary.is_none()
    }

    /// β with ℬ₀ = β𝒜, where that is so.
    pub fn memory_multiple(&self) -> Option<f64> {
        self.memory.as_ref().and_then(|memory| memory.tensor.multiple_of(&self.elasticity))
    }
}
