//! Corner singularities: the powers s with which displacements r^s leave a corner of an elastic body in plane
//! strain, hence the order in h that loads without a manufactured solution leave there.
//!
//! In a wedge of angle ω the displacement is a sum of terms r^s (log r)^m φ(θ) with Re s > 0, where s is a root of
//! a transcendental equation set by what happens on the two sides (M. L. Williams, J. Appl. Mech. 19 (1952)
//! 526-528). With s the root of smallest real part u ∈ H^{1+t} for t < Re s, and P1 elements on uniform meshes
//! have the order min(Re s, 1) in h there. A load may not excite that term: then the order is better.

mod of_scene;
mod roots;
mod wedge;

pub use of_scene::{Corner, corners};
pub use wedge::{Wedge, WedgeSide};
