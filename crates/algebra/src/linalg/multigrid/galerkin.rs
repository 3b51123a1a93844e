//! Coarse matrices PᵀAP, block by block.

use super::transfer::{Transfer, Turns};
use crate::linalg::BlockPattern;

/// A row-major block with rows of three, also in the plane.
type Block = [f64; 9];

/// `coarse` ← PᵀAP of the matrix `fine` (pattern and lower-triangle values). A coarse unknown that no free fine one
/// depends on gets the diagonal entry 1.
pub(super) fn galerkin<const D: usize>(
    (fine, values): (&BlockPattern, &[f64]),
    transfer: &Transfer,
    turns: &Turns,
    (coarse, out): (&BlockPattern, &mut [f64]),
) {
    out.fill(0.0);
    for node in 0..fine.nodes() {
        let (parents, node_weight) = transfer.parents(node);
        let block = turned::<D>(&diagonal::<D>(fine, values, node), turns, node, node);
        for p in parents.clone() {
            for q in parents.clone().filter(|&q| q <= p) {
                add::<D>(coarse, out, [p, q], node_weight * node_weight, &block);
            }
        }
        for (slot, &other) in fine.larger_neighbours(node).iter().enumerate() {
            let block = below::<D>(fine, values, node, slot);
            let block = turned::<D>(&block, turns, other as usize, node);
            let (rows, weight) = transfer.parents(other as usize);
            for q in rows {
                for p in parents.clone() {
                    let weight = weight * node_weight;
                    if q > p {
                        add::<D>(coarse, out, [q, p], weight, &block);
                    } else {
                        add::<D>(coarse, out, [p, q], weight, &transposed(&block));
                        if q == p {
                            add::<D>(coarse, out, [q, p], weight, &block);
                        }
                    }
                }
            }
        }
    }
    for dof in 0..coarse.order() {
        let diagonal_entry = &mut out[coarse.diagonal(dof)];
        if *diagonal_entry == 0.0 {
            *diagonal_entry = 1.0;
        }
    }
}

#[inline]
pub(super) fn diagonal<const D: usize>(
    pattern: &BlockPattern,
    values: &[f64],
    node: usize,
) -> Block {
    let mut block = [0.0; 9];
    for j in 0..D {
        let start = pattern.in_column(node, j, None);
        for i in j..D {
            block[3 * i + j] = values[start + i - j];
            block[3 * j + i] = values[start + i - j];
        }
    }
    block
}

/// The block of a node's column and the row of its larger neighbour number `slot`.
#[inline]
pub(super) fn below<const D: usize>(
    pattern: &BlockPattern,
    values: &[f64],
    node: usize,
    slot: usize,
) -> Block {
    let mut block = [0.0; 9];
    for j in 0..D {
        let start = pattern.in_column(node, j, Some(slot));
        for i in 0..D {
            block[3 * i + j] = values[start + i];
        }
    }
    block
}

/// (M N)ᵀ A (M N) of the block of two nodes.
#[inline]
fn turned<const D: usize>(block: &Block, turns: &Turns, row: usize, column: usize) -> Block {
    let mut block = *block;
    if let Some(turn) = turns.of(column) {
        block = product::<D>(&block, turn);
    }
    if let Some(turn) = turns.of(row) {
        block = product::<D>(&transposed(turn), &block);
    }
    block
}

fn product<const D: usize>(a: &Block, b: &Block) -> Block {
    let mut out = [0.0; 9];
    for i in 0..D {
        for j in 0..D {
            out[3 * i + j] = (0..D).map(|m| a[3 * i + m] * b[3 * m + j]).sum();
        }
    }
    out
}

fn transposed(block: &Block) -> Block {
    std::array::from_fn(|at| block[3 * (at % 3) + at / 3])
}

/// Adds `weight`·`block` to the block of row node `row` and column node `column` ≤ `row`.
#[inline]
fn add<const D: usize>(
    pattern: &BlockPattern,
    values: &mut [f64],
    [row, column]: [u32; 2],
    weight: f64,
    block: &Block,
) {
    let node = column as usize;
    if row == column {
        for j in 0..D {
            let start = pattern.in_column(node, j, None);
            for i in j..D {
                values[start + i - j] += weight * block[3 * i + j];
            }
        }
        return;
    }
    let slot = pattern.larger_neighbours(node).partition_point(|&other| other < row);
    for j in 0..D {
        let start = pattern.in_column(node, j, Some(slot));
        for i in 0..D {
            values[start + i] += weight * block[3 * i + j];
        }
    }
}
