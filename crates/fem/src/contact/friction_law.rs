//! The law of friction on Γ3: -σ_τ = s ∈ S ∂|u_τ|, S = c(x, t) S_0(|u_τ|), or that times p(u_ν), p = ∂j_ν.

use std::sync::Arc;

use vhi::law::{Potential, Scaled};

/// A function on Γ3 × [0, T].
pub type OnContactInTime = Box<dyn Fn([f64; 3], f64) -> f64 + Send + Sync>;

/// The law of friction: at x and t the graph is c(x, t) times that of S_0, or c(x, t) p(u_ν) times it.
pub struct Friction {
    /// c(x, t) ≥ 0 at a point of Γ3.
    pub factor: OnContactInTime,
    /// r ↦ S_0(|r|) sign r, odd, with its jump at 0: a stress, or a number where S follows p.
    pub graph: Arc<dyn Potential>,
    /// True where S = c S_0 p(u_ν): p ≥ 0 alone, without the multiplier λ, and without jumps, by the vertex rule.
    pub follows_pressure: bool,
}

impl Friction {
    /// The graph at a point of Γ3 where p(u_ν) = `pressure`.
    pub fn at(&self, x: [f64; 3], t: f64, pressure: f64) -> Scaled {
        self.scaled((self.factor)(x, t), pressure)
    }

    pub(super) fn scaled(&self, factor: f64, pressure: f64) -> Scaled {
        let followed = if self.follows_pressure { pressure } else { 1.0 };
        Scaled { potential: self.graph.clone(), factor: factor * followed }
    }
}
