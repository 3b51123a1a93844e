//! Symmetric tensors and sparse linear algebra: knows nothing of the problem.

pub mod linalg;
pub mod tensor;
