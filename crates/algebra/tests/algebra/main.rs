//! Factors, eigenvalues and tensors, from the public side.

mod cholesky;
mod dense;
mod dissection;
mod eigen;
mod pattern;
mod tangent;
mod tensor;
mod vectors;
