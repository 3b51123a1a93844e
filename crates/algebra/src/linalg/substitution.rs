//! Forward and backward substitution with one right side over the supernodes of a factor, whole or up to a cut: with
//! the unknowns of Γ3 numbered last, a pass that stops before them condenses onto Γ3.
//!
//! A pass is bound by the memory traffic of L, which is read once; columns are taken four at a time, to spare that of
//! the right side. Sums have a fixed number of lanes, so that results do not depend on the vector unit.

use faer::sparse::linalg::cholesky::SymbolicCholeskyRaw;
use faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky;

use super::cholesky::{Analysis, Factor, Real};
use super::supernode::{COLUMNS, Supernode, supernode};

/// Partial sums of a scalar product: two registers of four doubles, per column.
const LANES: usize = 8;
const HALF: usize = LANES / 2;

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
    pub fn forward<T: Real>(&self, factor: &Factor<T>, cut: usize, x: &mut [T], f: &mut Front<T>) {
        if let Some(symbolic) = self.supernodes() {
            let rows = &mut f.rows;
            pulp::Arch::new().dispatch(Pass { symbolic, factor, cut, x, rows, forward: true });
        }
    }

    /// Solves Lᵀ z = y in place for the columns before `cut`, given the solution behind it.
    pub fn backward<T: Real>(&self, factor: &Factor<T>, cut: usize, x: &mut [T], f: &mut Front<T>) {
        if let Some(symbolic) = self.supernodes() {
            let rows = &mut f.rows;
            pulp::Arch::new().dispatch(Pass { symbolic, factor, cut, x, rows, forward: false });
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

struct Pass<'a, T> {
    symbolic: &'a SymbolicSupernodalCholesky<u32>,
    factor: &'a Factor<T>,
    cut: usize,
    x: &'a mut [T],
    rows: &'a mut Vec<T>,
    forward: bool,
}

impl<T: Real> pulp::WithSimd for Pass<'_, T> {
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
fn eliminate<T: Real>(node: &Supernode<'_, T>, cut: usize, x: &mut [T], rows: &mut Vec<T>) {
    let (start, width) = (node.start, node.width);
    rows.clear();
    rows.extend_from_slice(&x[start..start + width]);
    rows.resize(node.height(), T::ZERO);
    let columns = width.min(cut - start);
    let mut j = 0;
    while j + COLUMNS <= columns {
        node.reads_forward(j, COLUMNS);
        let (head, rest) = rows[j..].split_at_mut(COLUMNS);
        for a in 0..COLUMNS {
            let column = node.column(j + a, j + a);
            head[a] /= column[0];
            for b in a + 1..COLUMNS {
                head[b] -= column[b - a] * head[a];
            }
        }
        let w: [T; COLUMNS] = std::array::from_fn(|a| head[a]);
        subtract(std::array::from_fn(|a| node.column(j + a, j + COLUMNS)), w, rest);
        j += COLUMNS;
    }
    while j < columns {
        node.reads_forward(j, 1);
        let column = node.column(j, j);
        let (head, rest) = rows[j..].split_at_mut(1);
        head[0] /= column[0];
        for (value, entry) in rest.iter_mut().zip(&column[1..]) {
            *value -= *entry * head[0];
        }
        j += 1;
    }
    x[start..start + width].copy_from_slice(&rows[..width]);
    for (&row, value) in node.below.iter().zip(&rows[width..]) {
        x[row as usize] += *value;
    }
}

#[inline(always)]
fn substitute<T: Real>(node: &Supernode<'_, T>, cut: usize, x: &mut [T], rows: &mut Vec<T>) {
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
        head[0] = (head[0] - product(&column[1..], rest)) / column[0];
    }
    while j > 0 {
        j -= COLUMNS;
        node.reads_backward(j, COLUMNS);
        let (head, rest) = rows[j..].split_at_mut(COLUMNS);
        let sums = products(std::array::from_fn(|a| node.column(j + a, j + COLUMNS)), rest);
        for a in (0..COLUMNS).rev() {
            let column = node.column(j + a, j + a);
            let mut value = head[a] - sums[a];
            for b in a + 1..COLUMNS {
                value -= column[b - a] * head[b];
            }
            head[a] = value / column[0];
        }
    }
    x[start..start + columns].copy_from_slice(&rows[..columns]);
}

#[inline(always)]
fn product<T: Real>(a: &[T], b: &[T]) -> T {
    let mut lanes = [T::ZERO; LANES];
    let (a_blocks, b_blocks) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    let (a_rest, b_rest) = (a_blocks.remainder(), b_blocks.remainder());
    for (a, b) in a_blocks.zip(b_blocks) {
        for l in 0..LANES {
            lanes[l] += a[l] * b[l];
        }
    }
    let rest = a_rest.iter().zip(b_rest).fold(T::ZERO, |sum, (a, b)| sum + *a * *b);
    total(lanes) + rest
}

/// x ← x - Σ_a w_a c_a, in blocks of fixed size: fronts are short, and longer unrolling would spend its time on
/// remainders.
#[inline(always)]
fn subtract<T: Real>(c: [&[T]; COLUMNS], w: [T; COLUMNS], x: &mut [T]) {
    let [c0, c1, c2, c3] = c;
    let value = |x: T, [c0, c1, c2, c3]: [T; COLUMNS]| {
        x - ((c0 * w[0] + c1 * w[1]) + (c2 * w[2] + c3 * w[3]))
    };
    let (blocks, rest) = x.as_chunks_mut::<LANES>();
    let ((c0, rest0), (c1, rest1)) = (c0.as_chunks::<LANES>(), c1.as_chunks::<LANES>());
    let ((c2, rest2), (c3, rest3)) = (c2.as_chunks::<LANES>(), c3.as_chunks::<LANES>());
    for ((((x, c0), c1), c2), c3) in blocks.iter_mut().zip(c0).zip(c1).zip(c2).zip(c3) {
        for l in 0..LANES {
            x[l] = value(x[l], [c0[l], c1[l], c2[l], c3[l]]);
        }
    }
    let (blocks, rest) = rest.as_chunks_mut::<HALF>();
    let ((c0, rest0), (c1, rest1)) = (rest0.as_chunks::<HALF>(), rest1.as_chunks::<HALF>());
    let ((c2, rest2), (c3, rest3)) = (rest2.as_chunks::<HALF>(), rest3.as_chunks::<HALF>());
    for ((((x, c0), c1), c2), c3) in blocks.iter_mut().zip(c0).zip(c1).zip(c2).zip(c3) {
        for l in 0..HALF {
            x[l] = value(x[l], [c0[l], c1[l], c2[l], c3[l]]);
        }
    }
    for ((((x, c0), c1), c2), c3) in rest.iter_mut().zip(rest0).zip(rest1).zip(rest2).zip(rest3) {
        *x = value(*x, [*c0, *c1, *c2, *c3]);
    }
}

/// Σ_i c_i x_i for several columns c.
#[inline(always)]
fn products<T: Real>(c: [&[T]; COLUMNS], x: &[T]) -> [T; COLUMNS] {
    let ((x, x_rest), c) = (x.as_chunks::<LANES>(), c.map(|c| c.as_chunks::<LANES>()));
    let mut lanes = [[T::ZERO; LANES]; COLUMNS];
    let blocks = x.iter().zip(c[0].0).zip(c[1].0).zip(c[2].0).zip(c[3].0);
    for ((((x, c0), c1), c2), c3) in blocks {
        for (lanes, c) in lanes.iter_mut().zip([c0, c1, c2, c3]) {
            for l in 0..LANES {
                lanes[l] += c[l] * x[l];
            }
        }
    }
    let ((x, x_rest), c) = (x_rest.as_chunks::<HALF>(), c.map(|c| c.1.as_chunks::<HALF>()));
    let mut halves: [[T; HALF]; COLUMNS] =
        lanes.map(|lanes| std::array::from_fn(|l| lanes[l] + lanes[l + HALF]));
    if let [x] = x {
        for (halves, (c, _)) in halves.iter_mut().zip(c) {
            for l in 0..HALF {
                halves[l] += c[0][l] * x[l];
            }
        }
    }
    // Separate sums: lanes addressed one by one would not stay in registers.
    let mut rest = [T::ZERO; COLUMNS];
    for (i, x) in x_rest.iter().enumerate() {
        for (rest, (_, c)) in rest.iter_mut().zip(c) {
            *rest += c[i] * *x;
        }
    }
    std::array::from_fn(|a| {
        let [p, q, r, s] = halves[a];
        ((p + r) + (q + s)) + rest[a]
    })
}

#[inline(always)]
fn total<T: Real>(lanes: [T; LANES]) -> T {
    let mut lanes = lanes;
    let mut half = LANES / 2;
    while half > 0 {
        for l in 0..half {
            lanes[l] += lanes[l + half];
        }
        half /= 2;
    }
    lanes[0]
}

#[cfg(test)]
mod tests {
    use super::super::{BlockPattern, nested_dissection};
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
}
