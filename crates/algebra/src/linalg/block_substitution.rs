//! Forward and backward substitution with several right sides: the factor is read once for all, where a single pass is
//! bound by its memory traffic.

use faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky;

use super::cholesky::{Analysis, Factor};
use super::substitution::Front;
use super::supernode::{COLUMNS, Supernode, supernode};

/// Right sides per pass: two registers of four doubles.
pub const SIDES: usize = 8;

pub type RightSides = [f64; SIDES];

impl Analysis {
    /// Solves L y = x in place, as [`Self::forward`], for [`SIDES`] right sides.
    pub fn forward_block(
        &self,
        factor: &Factor,
        cut: usize,
        x: &mut [RightSides],
        front: &mut Front<RightSides>,
    ) {
        self.pass(factor, cut, x, front, true);
    }

    /// Solves Lᵀ z = y in place, as [`Self::backward`], for [`SIDES`] right sides; each result is independent of the
    /// other sides.
    pub fn backward_block(
        &self,
        factor: &Factor,
        cut: usize,
        x: &mut [RightSides],
        front: &mut Front<RightSides>,
    ) {
        self.pass(factor, cut, x, front, false);
    }

    fn pass(
        &self,
        factor: &Factor,
        cut: usize,
        x: &mut [RightSides],
        front: &mut Front<RightSides>,
        forward: bool,
    ) {
        if let Some(symbolic) = self.supernodes() {
            let rows = &mut front.rows;
            pulp::Arch::new().dispatch(Pass { symbolic, factor, cut, x, rows, forward });
        }
    }
}

struct Pass<'a> {
    symbolic: &'a SymbolicSupernodalCholesky<u32>,
    factor: &'a Factor,
    cut: usize,
    x: &'a mut [RightSides],
    rows: &'a mut Vec<RightSides>,
    forward: bool,
}

impl pulp::WithSimd for Pass<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let count = self.symbolic.n_supernodes();
        if self.forward {
            for s in 0..count {
                let node = supernode(self.symbolic, self.factor, s);
                if node.start >= self.cut {
                    break;
                }
                eliminate(&node, self.cut, self.x, self.rows);
            }
            return;
        }
        for s in (0..count).rev() {
            let node = supernode(self.symbolic, self.factor, s);
            if node.start < self.cut {
                substitute(&node, self.cut, self.x, self.rows);
            }
        }
    }
}

#[inline(always)]
fn eliminate(
    node: &Supernode<'_, f64>,
    cut: usize,
    x: &mut [RightSides],
    rows: &mut Vec<RightSides>,
) {
    let (start, width) = (node.start, node.width);
    rows.clear();
    rows.extend_from_slice(&x[start..start + width]);
    rows.resize(node.height(), [0.0; SIDES]);
    let columns = width.min(cut - start);
    let mut j = 0;
    while j + COLUMNS <= columns {
        node.reads_forward(j, COLUMNS);
        let (head, rest) = rows[j..].split_at_mut(COLUMNS);
        let mut w = [[0.0; SIDES]; COLUMNS];
        for a in 0..COLUMNS {
            let column = node.column(j + a, j + a);
            w[a] = head[a].map(|value| value / column[0]);
            head[a] = w[a];
            for b in a + 1..COLUMNS {
                for l in 0..SIDES {
                    head[b][l] -= column[b - a] * w[a][l];
                }
            }
        }
        subtract(std::array::from_fn(|a| node.column(j + a, j + COLUMNS)), w, rest);
        j += COLUMNS;
    }
    while j < columns {
        node.reads_forward(j, 1);
        let column = node.column(j, j);
        let (head, rest) = rows[j..].split_at_mut(1);
        head[0] = head[0].map(|value| value / column[0]);
        subtract([&column[1..]], [head[0]], rest);
        j += 1;
    }
    x[start..start + width].copy_from_slice(&rows[..width]);
    for (&row, values) in node.below.iter().zip(&rows[width..]) {
        for (x, value) in x[row as usize].iter_mut().zip(values) {
            *x += value;
        }
    }
}

/// x ← x - Σ_a w_a c_a.
#[inline(always)]
fn subtract<const C: usize>(c: [&[f64]; C], w: [RightSides; C], x: &mut [RightSides]) {
    let c: [&[f64]; C] = std::array::from_fn(|a| &c[a][..x.len()]);
    for (i, row) in x.iter_mut().enumerate() {
        for a in 0..C {
            let entry = c[a][i];
            for l in 0..SIDES {
                row[l] -= entry * w[a][l];
            }
        }
    }
}

#[inline(always)]
fn substitute(
    node: &Supernode<'_, f64>,
    cut: usize,
    x: &mut [RightSides],
    rows: &mut Vec<RightSides>,
) {
    let (start, width) = (node.start, node.width);
    rows.clear();
    rows.extend_from_slice(&x[start..start + width]);
    rows.extend(node.below.iter().map(|&row| x[row as usize]));
    let columns = width.min(cut - start);
    let mut j = columns;
    while !j.is_multiple_of(COLUMNS) {
        j -= 1;
        node.reads_backward(j, 1);
        let column = node.column(j, j);
        let (head, rest) = rows[j..].split_at_mut(1);
        let [sum] = products([&column[1..]], rest);
        for l in 0..SIDES {
            head[0][l] = (head[0][l] - sum[l]) / column[0];
        }
    }
    while j > 0 {
        j -= COLUMNS;
        node.reads_backward(j, COLUMNS);
        let (head, rest) = rows[j..].split_at_mut(COLUMNS);
        let sums: [RightSides; COLUMNS] =
            products(std::array::from_fn(|a| node.column(j + a, j + COLUMNS)), rest);
        for a in (0..COLUMNS).rev() {
            let column = node.column(j + a, j + a);
            let mut value = head[a];
            for l in 0..SIDES {
                value[l] -= sums[a][l];
            }
            for b in a + 1..COLUMNS {
                for l in 0..SIDES {
                    value[l] -= column[b - a] * head[b][l];
                }
            }
            head[a] = value.map(|value| value / column[0]);
        }
    }
    x[start..start + columns].copy_from_slice(&rows[..columns]);
}

/// Σ_i c_i x_i for several columns c.
#[inline(always)]
fn products<const C: usize>(c: [&[f64]; C], x: &[RightSides]) -> [RightSides; C] {
    let c: [&[f64]; C] = std::array::from_fn(|a| &c[a][..x.len()]);
    let mut sums = [[0.0; SIDES]; C];
    for (i, row) in x.iter().enumerate() {
        for a in 0..C {
            let entry = c[a][i];
            for l in 0..SIDES {
                sums[a][l] += entry * row[l];
            }
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::super::{BlockPattern, nested_dissection};
    use super::*;

    /// Eight sides together and one by one, on a grid of 12 × 12 nodes with a cut.
    #[test]
    fn sides_together_are_sides_apart() {
        let cells: Vec<u32> = (0..11)
            .flat_map(|i| (0..11).map(move |j| 12 * i + j))
            .flat_map(|v| [v, v + 1, v + 13, v, v + 13, v + 12])
            .collect();
        let pattern = BlockPattern::new(&cells, 3, 2, 144);
        let coordinates: Vec<f64> =
            (0..144).flat_map(|v| [f64::from(v % 12), f64::from(v / 12)]).collect();
        let mut values = vec![0.0; pattern.entries()];
        values.iter_mut().enumerate().for_each(|(i, value)| *value = 0.1 * (i as f64).sin());
        (0..288).for_each(|dof| values[pattern.diagonal(dof)] = 4.0);
        let last: Vec<u32> = (0..12).map(|v| 2 * v + 1).collect();
        let analysis =
            Analysis::new(&pattern, &nested_dissection(&pattern, &coordinates, &last)).unwrap();
        let (mut factor, mut workspace) = (analysis.factor(), analysis.workspace());
        analysis.factorize(&pattern, &values, &mut factor, &mut workspace).unwrap();
        let cut = 288 - last.len();
        let side = |l: usize| (0..288).map(move |i| ((3 * i + 7 * l) as f64).cos());
        let mut sides: Vec<RightSides> = vec![[0.0; SIDES]; 288];
        for l in 0..SIDES {
            sides.iter_mut().zip(side(l)).for_each(|(row, value)| row[l] = value);
        }
        let [mut forward, mut backward] = [sides.clone(), sides];
        analysis.forward_block(&factor, cut, &mut forward, &mut Front::default());
        analysis.backward_block(&factor, cut, &mut backward, &mut Front::default());
        let far = |factor: &Factor, l: usize| {
            let [mut x, mut y] = [(); 2].map(|()| side(l).collect::<Vec<f64>>());
            analysis.forward(factor, cut, &mut x, &mut Front::default());
            analysis.backward(factor, cut, &mut y, &mut Front::default());
            let off = |x: &[f64], block: &[RightSides]| {
                x.iter().zip(block).map(|(x, row)| (x - row[l]).abs()).fold(0.0, f64::max)
            };
            [off(&x, &forward), off(&y, &backward)]
        };
        // Different order of summation: rounding times a condition number of about 3.
        assert!((0..SIDES).all(|l| far(&factor, l).iter().all(|off| *off < 1e-14)));
        // A perturbed entry of the factor shows in every side.
        let middle = factor.values.len() / 2;
        let at = (middle..).find(|&i| factor.values[i].abs() > 1e-3).unwrap();
        factor.values[at] *= 1.0 + 1e-8;
        assert!((0..SIDES).all(|l| far(&factor, l).iter().all(|off| *off > 1e-14)));
    }
}
