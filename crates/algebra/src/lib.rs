//! Symmetric tensors and sparse linear algebra, independent of the problem.

pub mod linalg;
pub mod tensor;
