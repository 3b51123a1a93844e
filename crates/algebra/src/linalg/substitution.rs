//! Forward and backward substitution over the supernodes of a factor, whole or up to a cut: with the unknowns of Γ3
//! numbered last, a pass that stops before them condenses onto Γ3.
//!
//! A pass is bound by the memory traffic of L, which is read once; columns are taken four at a time, to spare that of
//! the right side.

use faer::sparse::linalg::cholesky::SymbolicCholeskyRaw;
use faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky;

use super::cholesky::{Analysis, Factor, Real};
use super::sides::Sides;
use super::supernode::{COLUMNS, Supernode, supernode};

/// Scratch of a pass.
#[derive(Debug, Clone, Default)]
pub struct Front<T> {
    /// Rows of one supernode: those of its columns, then those below.
    pub(super) rows: Vec<T>,
    /// The right side of a whole solve in the order of the factor.
    ordered: Vec<T>,
}

impl Analysis {
    pub(super) fn supernodes(&self) -> Option<&SymbolicSupernodalCholesky<u32>> {
        match self.symbolic.raw() {
            SymbolicCholeskyRaw::Supernodal(raw) => Some(raw),
            // Chosen only for order 0, where there is nothing to solve.
            SymbolicCholeskyRaw::Simplicial(_) => None,
        }
    }

    /// Position → dof.
    pub fn order(&self) -> &[u32] {
        self.symbolic.perm().map_or(&[], |perm| perm.arrays().0)
    }

    /// Solves L Lᵀ x = b in place; x and b are in the order of the unknowns.
    pub fn solve<T: Real>(&self, factor: &Factor<T>, x: &mut [T], front: &mut Front<T>) {
        self.solve_in(factor, x, front, |value| value, |value| value);
    }

    /// K⁻¹b in the number type of the factor; `into` and `back` convert b and x.
    pub(super) fn solve_in<T: Real, X: Copy>(
        &self,
        factor: &Factor<T>,
        x: &mut [X],
        front: &mut Front<T>,
        into: impl Fn(X) -> T,
        back: impl Fn(T) -> X,
    ) {
        let (order, mut ordered) = (self.order(), std::mem::take(&mut front.ordered));
        ordered.clear();
        ordered.extend(order.iter().map(|&dof| into(x[dof as usize])));
        self.forward(factor, order.len(), &mut ordered, front);
        self.backward(factor, order.len(), &mut ordered, front);
        for (&value, &dof) in ordered.iter().zip(order) {
            x[dof as usize] = back(value);
        }
        front.ordered = ordered;
    }

    /// Solves L y = x in place for the columns before `cut`; the reduced right side is left behind it. `x` is in the
    /// order of the factor.
    pub fn forward<T: Real, X: Sides<T>>(
        &self,
        factor: &Factor<T>,
        cut: usize,
        x: &mut [X],
        front: &mut Front<X>,
    ) {
        self.pass(factor, cut, x, front, true);
    }

    /// Solves Lᵀ z = y in place for the columns before `cut`, given the solution behind it.
    pub fn backward<T: Real, X: Sides<T>>(
        &self,
        factor: &Factor<T>,
        cut: usize,
        x: &mut [X],
        front: &mut Front<X>,
    ) {
        self.pass(factor, cut, x, front, false);
    }

    fn pass<T: Real, X: Sides<T>>(
        &self,
        factor: &Factor<T>,
        cut: usize,
        x: &mut [X],
        front: &mut Front<X>,
        forward: bool,
    ) {
        if let Some(symbolic) = self.supernodes() {
            let rows = &mut front.rows;
            pulp::Arch::new().dispatch(Pass { symbolic, factor, cut, x, rows, forward });
        }
    }

    /// The triangle of L behind `cut`, dense by columns: the factor of the Schur complement on the last unknowns.
    pub fn last_triangle(&self, factor: &Factor, cut: usize) -> Vec<f64> {
        let size = self.order().len() - cut;
        let mut triangle = vec![0.0; size * size];
        let Some(symbolic) = self.supernodes() else { return triangle };
        for s in 0..symbolic.n_supernodes() {
            let node = supernode(symbolic, factor, s);
            for j in cut.max(node.start)..node.start + node.width {
                let column_values = node.column(j - node.start, j - node.start);
                let (inside, below) = column_values.split_at(node.start + node.width - j);
                let column = &mut triangle[size * (j - cut)..size * (j - cut + 1)];
                column[j - cut..][..inside.len()].copy_from_slice(inside);
                for (&row, value) in node.below.iter().zip(below) {
                    column[row as usize - cut] = *value;
                }
            }
        }
        triangle
    }
}

struct Pass<'a, T, X> {
    symbolic: &'a SymbolicSupernodalCholesky<u32>,
    factor: &'a Factor<T>,
    cut: usize,
    x: &'a mut [X],
    rows: &'a mut Vec<X>,
    forward: bool,
}

impl<T: Real, X: Sides<T>> pulp::WithSimd for Pass<'_, T, X> {
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
        } else {
            for s in (0..count).rev() {
                let node = supernode(self.symbolic, self.factor, s);
                if node.start < self.cut {
                    substitute(&node, self.cut, self.x, self.rows);
                }
            }
        }
    }
}

#[inline(always)]
fn eliminate<T: Real, X: Sides<T>>(
    node: &Supernode<'_, T>,
    cut: usize,
    x: &mut [X],
    rows: &mut Vec<X>,
) {
    let (start, width) = (node.start, node.width);
    rows.clear();
    rows.extend_from_slice(&x[start..start + width]);
    rows.resize(node.height(), X::NONE);
    let columns = width.min(cut - start);
    let mut j = 0;
    while j + COLUMNS <= columns {
        let (head, rest) = rows[j..].split_at_mut(COLUMNS);
        for a in 0..COLUMNS {
            let column = node.column(j + a, j + a);
            head[a] = head[a].over(column[0]);
            for b in a + 1..COLUMNS {
                head[b] = head[b].less(column[b - a], head[a]);
            }
        }
        let w: [X; COLUMNS] = std::array::from_fn(|a| head[a]);
        X::subtract(std::array::from_fn(|a| node.column(j + a, j + COLUMNS)), w, rest);
        j += COLUMNS;
    }
    while j < columns {
        let column = node.column(j, j);
        let (head, rest) = rows[j..].split_at_mut(1);
        head[0] = head[0].over(column[0]);
        for (value, entry) in rest.iter_mut().zip(&column[1..]) {
            *value = value.less(*entry, head[0]);
        }
        j += 1;
    }
    x[start..start + width].copy_from_slice(&rows[..width]);
    for (&row, value) in node.below.iter().zip(&rows[width..]) {
        x[row as usize] = x[row as usize].plus(*value);
    }
}

#[inline(always)]
fn substitute<T: Real, X: Sides<T>>(
    node: &Supernode<'_, T>,
    cut: usize,
    x: &mut [X],
    rows: &mut Vec<X>,
) {
    let (start, width) = (node.start, node.width);
    rows.clear();
    rows.extend_from_slice(&x[start..start + width]);
    rows.extend(node.below.iter().map(|&row| x[row as usize]));
    let columns = width.min(cut - start);
    let mut j = columns;
    while !j.is_multiple_of(COLUMNS) {
        j -= 1;
        let column = node.column(j, j);
        let (head, rest) = rows[j..].split_at_mut(1);
        head[0] = head[0].minus(X::product(&column[1..], rest)).over(column[0]);
    }
    while j > 0 {
        j -= COLUMNS;
        let (head, rest) = rows[j..].split_at_mut(COLUMNS);
        let sums = X::products(std::array::from_fn(|a| node.column(j + a, j + COLUMNS)), rest);
        for a in (0..COLUMNS).rev() {
            let column = node.column(j + a, j + a);
            let mut value = head[a].minus(sums[a]);
            for b in a + 1..COLUMNS {
                value = value.less(column[b - a], head[b]);
            }
            head[a] = value.over(column[0]);
        }
    }
    x[start..start + columns].copy_from_slice(&rows[..columns]);
}

#[cfg(test)]
mod tests {
    use super::super::{BlockPattern, RightSides, SIDES, nested_dissection};
    use super::*;

    fn chain(last: &[u32]) -> (BlockPattern, Vec<f64>, Analysis) {
        let cells: Vec<u32> = (0..68).flat_map(|i| [i, i + 1, i + 2]).collect();
        let pattern = BlockPattern::new(&cells, 3, 2, 70);
        let mut values = vec![0.0; pattern.entries()];
        for dof in 0..140 {
            values[pattern.diagonal(dof)] = 5.0 + (dof as f64).sin();
            for other in dof.saturating_sub(3)..dof {
                values[pattern.position(dof, other).expect("neighbours")] = -0.6;
            }
        }
        let coordinates: Vec<f64> = (0..140).map(|i| f64::from(i / 2)).collect();
        let analysis = Analysis::new(&pattern, &nested_dissection(&pattern, &coordinates, last));
        (pattern, values, analysis.expect("a small pattern"))
    }

    /// Whole passes solve, in both precisions; a cut forward pass leaves the condensed right side, and the last
    /// triangle is the factor of the Schur complement: together they give the solution on the last unknowns.
    #[test]
    fn passes_solve_and_condense() {
        let last = [21, 3, 77, 139, 60];
        let (pattern, values, analysis) = chain(&last);
        let (mut factor, mut workspace) = (analysis.factor(), analysis.workspace());
        analysis.factorize(&pattern, &values, &mut factor, &mut workspace).unwrap();
        let exact: Vec<f64> = (0..140).map(|i| (f64::from(i) * 0.7).sin()).collect();
        let mut b = vec![0.0; 140];
        pattern.multiply(&values, &exact, &mut b);
        let in_order = |x: &[f64]| -> Vec<f64> {
            analysis.order().iter().map(|&dof| x[dof as usize]).collect()
        };
        let (wanted, mut front) = (in_order(&exact), Front::default());
        let close = |x: &[f64], tolerance: f64| {
            x.iter().zip(&wanted).all(|(a, b)| (a - b).abs() < tolerance)
        };
        let mut x = in_order(&b);
        analysis.forward(&factor, 140, &mut x, &mut front);
        analysis.backward(&factor, 140, &mut x, &mut front);
        assert!(close(&x, 1e-13));
        let mut x = b.clone();
        analysis.solve(&factor, &mut x, &mut front);
        assert!(close(&in_order(&x), 1e-13) && !close(&x, 1e-1));
        let cut = 140 - last.len();
        let mut x = in_order(&b);
        analysis.forward(&factor, cut, &mut x, &mut front);
        let triangle = analysis.last_triangle(&factor, cut);
        let size = last.len();
        // L₂₂L₂₂ᵀ times the exact values is the condensed right side.
        for i in 0..size {
            let mut row = 0.0;
            for j in 0..size {
                let entry: f64 =
                    (0..=i.min(j)).map(|k| triangle[size * k + i] * triangle[size * k + j]).sum();
                row += entry * wanted[cut + j];
            }
            assert!((row - x[cut + i]).abs() < 1e-12, "{i}");
        }
        x[cut..].copy_from_slice(&wanted[cut..]);
        analysis.backward(&factor, cut, &mut x, &mut front);
        assert!(close(&x, 1e-13));
        // A wrong value behind the cut shows.
        x[cut] += 1e-6;
        analysis.backward(&factor, cut, &mut x, &mut front);
        assert!(!close(&x, 1e-8));
        let single: Vec<f32> = values.iter().map(|value| *value as f32).collect();
        let mut factor = analysis.factor::<f32>();
        analysis.factorize(&pattern, &single, &mut factor, &mut workspace).unwrap();
        let mut y: Vec<f32> = in_order(&b).iter().map(|value| *value as f32).collect();
        let mut front = Front::default();
        analysis.forward(&factor, 140, &mut y, &mut front);
        analysis.backward(&factor, 140, &mut y, &mut front);
        let y: Vec<f64> = y.into_iter().map(f64::from).collect();
        // Single precision times a condition number of about 10.
        assert!(close(&y, 1e-5) && !close(&y, 1e-12));
    }

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
        analysis.forward(&factor, cut, &mut forward, &mut Front::default());
        analysis.backward(&factor, cut, &mut backward, &mut Front::default());
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
