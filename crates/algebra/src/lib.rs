//! Symmetric tensors and sparse linear algebra, independent of the problem.

pub mod linalg;
pub mod tensor;

/// An expression in dimension 2 or 3, which is known when it runs: `D`, and the number `S` of components of a symmetric
/// tensor, are constants in it.
#[macro_export]
macro_rules! in_dimension {
    ($dimension:expr, $D:ident => $in:expr) => {
        match $dimension {
            2 => {
                const $D: usize = 2;
                $in
            }
            _ => {
                const $D: usize = 3;
                $in
            }
        }
    };
    ($dimension:expr, $D:ident, $S:ident => $in:expr) => {
        $crate::in_dimension!($dimension, $D => {
            const $S: usize = $D * ($D + 1) / 2;
            $in
        })
    };
}
