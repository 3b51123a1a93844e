//! Gauss–Seidel sweeps over nodes: forward from zero before the coarse correction, backward after it.
//!
//! With A = L + D + Lᵀ by blocks of nodes, the forward sweep is x = (L + D)⁻¹b, the backward one x ← x + (D + Lᵀ)⁻¹(b -
//! Ax): transposes of each other. Only blocks below the diagonal are stored.

use super::galerkin::{below, diagonal};
use crate::linalg::BlockPattern;

/// Blocks of one matrix over its largest diagonal entry, and inverse diagonal blocks.
pub(crate) struct Sweeps {
    below: Vec<f32>,
    inverse: Vec<f32>,
}

impl Sweeps {
    pub(super) fn new(pattern: &BlockPattern) -> Self {
        let (d, nodes) = (pattern.dimension(), pattern.nodes());
        let pairs: usize = (0..nodes).map(|node| pattern.larger_neighbours(node).len()).sum();
        Self { below: vec![0.0; d * d * pairs], inverse: vec![0.0; d * d * nodes] }
    }

    /// Takes the matrix; fails with the unknown whose diagonal block is not positive definite.
    pub(super) fn set<const D: usize>(
        &mut self,
        pattern: &BlockPattern,
        values: &[f64],
        scale: f64,
    ) -> Result<(), usize> {
        let mut blocks = self.below.chunks_exact_mut(D * D);
        for (node, inverse) in self.inverse.chunks_exact_mut(D * D).enumerate() {
            let inverted_block = inverted::<D>(&diagonal::<D>(pattern, values, node));
            let inverted_block = inverted_block.map_err(|component| D * node + component)?;
            for (at, target) in inverse.iter_mut().enumerate() {
                *target = (inverted_block[at / D][at % D] * scale) as f32;
            }
            for slot in 0..pattern.larger_neighbours(node).len() {
                let neighbour_block = below::<D>(pattern, values, node, slot);
                let Some(block) = blocks.next() else { continue };
                for (at, target) in block.iter_mut().enumerate() {
                    *target = (neighbour_block[3 * (at / D) + at % D] / scale) as f32;
                }
            }
        }
        Ok(())
    }

    /// `x` ← (L + D)⁻¹ `right`, `rest` ← `right` - A `x`.
    pub(super) fn forward<const D: usize>(
        &self,
        pattern: &BlockPattern,
        right: &[f32],
        x: &mut [f32],
        rest: &mut [f32],
    ) {
        let (x, rest) = (x.as_chunks_mut::<D>().0, rest.as_chunks_mut::<D>().0);
        rest.as_flattened_mut().copy_from_slice(right);
        let mut blocks = self.below.chunks_exact(D * D);
        for (node, inverse) in self.inverse.chunks_exact(D * D).enumerate() {
            let at_node = times(inverse, &rest[node]);
            x[node] = at_node;
            for (&other, block) in pattern.larger_neighbours(node).iter().zip(&mut blocks) {
                subtract(&mut rest[other as usize], times(block, &at_node));
            }
        }
        // right - Lx - Dx = 0, so -Lᵀx is left.
        let mut blocks = self.below.chunks_exact(D * D);
        for (node, rest) in rest.iter_mut().enumerate() {
            *rest = [0.0; D];
            for (&other, block) in pattern.larger_neighbours(node).iter().zip(&mut blocks) {
                subtract(rest, transposed_times(block, &x[other as usize]));
            }
        }
    }

    /// `x` ← `x` + (D + Lᵀ)⁻¹(`right` - A `x`).
    pub(super) fn backward<const D: usize>(
        &self,
        pattern: &BlockPattern,
        right: &[f32],
        x: &mut [f32],
        rest: &mut [f32],
    ) {
        let (x, rest) = (x.as_chunks_mut::<D>().0, rest.as_chunks_mut::<D>().0);
        rest.as_flattened_mut().copy_from_slice(right);
        let mut blocks = self.below.chunks_exact(D * D);
        for (node, at_node) in x.iter().enumerate() {
            for (&other, block) in pattern.larger_neighbours(node).iter().zip(&mut blocks) {
                subtract(&mut rest[other as usize], times(block, at_node));
            }
        }
        let mut blocks = self.below.chunks_exact(D * D).rev();
        for (node, inverse) in self.inverse.chunks_exact(D * D).enumerate().rev() {
            let mut remaining = rest[node];
            for (&other, block) in pattern.larger_neighbours(node).iter().rev().zip(&mut blocks) {
                subtract(&mut remaining, transposed_times(block, &x[other as usize]));
            }
            x[node] = times(inverse, &remaining);
        }
    }
}

#[inline]
fn times<const D: usize>(block: &[f32], x: &[f32; D]) -> [f32; D] {
    std::array::from_fn(|i| (0..D).map(|j| block[D * i + j] * x[j]).sum())
}

#[inline]
fn transposed_times<const D: usize>(block: &[f32], x: &[f32; D]) -> [f32; D] {
    std::array::from_fn(|j| (0..D).map(|i| block[D * i + j] * x[i]).sum())
}

#[inline]
fn subtract<const D: usize>(target: &mut [f32; D], value: [f32; D]) {
    target.iter_mut().zip(value).for_each(|(target, value)| *target -= value);
}

/// The inverse of a symmetric block (rows of three) by Cholesky, or the component whose pivot is not positive.
fn inverted<const D: usize>(block: &[f64; 9]) -> Result<[[f64; D]; D], usize> {
    let mut factor = [[0.0; D]; D];
    for i in 0..D {
        for j in 0..=i {
            let known: f64 = (0..j).map(|m| factor[i][m] * factor[j][m]).sum();
            let rest = block[3 * i + j] - known;
            factor[i][j] = match i == j {
                false => rest / factor[j][j],
                true if rest > 0.0 => rest.sqrt(),
                true => return Err(i),
            };
        }
    }
    let mut inverse = [[0.0; D]; D];
    for (column, solution) in inverse.iter_mut().enumerate() {
        for i in 0..D {
            let known: f64 = (0..i).map(|m| factor[i][m] * solution[m]).sum();
            solution[i] = (f64::from(u8::from(i == column)) - known) / factor[i][i];
        }
        for i in (0..D).rev() {
            let known: f64 = (i + 1..D).map(|m| factor[m][i] * solution[m]).sum();
            solution[i] = (solution[i] - known) / factor[i][i];
        }
    }
    Ok(inverse)
}
