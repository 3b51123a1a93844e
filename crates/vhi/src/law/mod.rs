//! Pointwise laws: elasticity, von Mises projection, memory kernel, contact potential. Each is a small trait, so that
//! tests can pass a wrong component.

mod curve;
mod elasticity;
mod gauss;
mod kernel;
mod potential;
mod projection;
mod scaled;
mod tensor_field;

pub use curve::{Curve, Curved};
pub use elasticity::Isotropic;
pub(crate) use gauss::GAUSS;
pub use kernel::{
    Convolution, ExponentialSum, HistoryKernel, INTERPOLATED_TO, MemoryKernel, Nested, Singular,
    Summed,
};
pub use potential::{NoPotential, PiecewiseLinear, Potential, PotentialError, graph_distance};
pub use projection::{AnyProjection, Projection, Response, VonMises, YieldLimit};
pub use scaled::Scaled;
pub use tensor_field::{FourthOrder, TensorField};
