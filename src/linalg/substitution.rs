//! Forward and backward substitution with one right side over the supernodes of a factor, whole or up
//! to a cut: with the unknowns of Γ3 numbered last, what stops short of them condenses onto Γ3.
//!
//! A pass is bound by the traffic of L, which is read once: columns are taken four at a time, so that the
//! right side is not. Sums have a fixed number of lanes, so a result does not depend on the vector unit.

use faer::sparse::linalg::cholesky::SymbolicCholeskyRaw;
use faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky;

use super::cholesky::{Analysis, Factor, Real};

/// Columns that are taken together.
const COLUMNS: usize = 4;
/// Partial sums of a scalar product: two registers of four doubles, for each column.
const LANES: usize = 8;

/// Rows of one supernode: those of its own columns, then those below.
#[derive(Debug, Clone, Default)]
pub struct Front<T> {
    rows: Vec<T>,
}

/// A supernode: columns `start..start + width`, `below` the rows under its triangle, numbers by columns.
struct Supernode<'a, T> {
    start: usize,
    width: usize,
    below: &'a [u32],
    values: &'a [T],
}

impl<T: Real> Supernode<'_, T> {
    fn height(&self) -> usize {
        self.width + self.below.len()
    }

    /// Rows `from..` of column j.
    #[inline(always)]
    fn column(&self, j: usize, from: usize) -> &[T] {
        &self.values[self.height() * j + from..self.height() * (j + 1)]
    }
}

impl Analysis {
    fn supernodes(&self) -> Option<&SymbolicSupernodalCholesky<u32>> {
        match self.symbolic.raw() {
            SymbolicCholeskyRaw::Supernodal(raw) => Some(raw),
            // Never chosen but for order 0, where there is nothing to solve.
            SymbolicCholeskyRaw::Simplicial(_) => None,
        }
    }

    /// Position → dof.
    pub fn order(&self) -> &[u32] {
        self.symbolic.perm().map_or(&[], |perm| perm.arrays().0)
    }

    /// Solves L y = x in place in the columns before `cut`; what they leave of the right side stands
    /// behind it. `x` is in the order of the factor.
    pub fn forward<T: Real>(&self, factor: &Factor<T>, cut: usize, x: &mut [T], f: &mut Front<T>) {
        let Some(symbolic) = self.supernodes() else { return };
        pulp::Arch::new().dispatch(
            #[inline(always)]
            || {
                for s in 0..symbolic.n_supernodes() {
                    let node = supernode(symbolic, factor, s);
                    if node.start >= cut {
                        break;
                    }
                    eliminate(&node, cut, x, &mut f.rows);
                }
            },
        );
    }

    /// Solves Lᵀ z = y in place in the columns before `cut`; what stands behind it is taken as solved.
    pub fn backward<T: Real>(&self, factor: &Factor<T>, cut: usize, x: &mut [T], f: &mut Front<T>) {
        let Some(symbolic) = self.supernodes() else { return };
        pulp::Arch::new().dispatch(
            #[inline(always)]
            || {
                for s in (0..symbolic.n_supernodes()).rev() {
                    let node = supernode(symbolic, factor, s);
                    if node.start < cut {
                        substitute(&node, cut, x, &mut f.rows);
                    }
                }
            },
        );
    }

    /// The triangle of L behind `cut`, full and by columns: it is the factor of the Schur complement on
    /// the last unknowns.
    pub fn last_triangle(&self, factor: &Factor, cut: usize) -> Vec<f64> {
        let size = self.order().len() - cut;
        let mut triangle = vec![0.0; size * size];
        let Some(symbolic) = self.supernodes() else { return triangle };
        for s in 0..symbolic.n_supernodes() {
            let node = supernode(symbolic, factor, s);
            for j in cut.max(node.start)..node.start + node.width {
                let own = node.column(j - node.start, j - node.start);
                let (inside, below) = own.split_at(node.start + node.width - j);
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

#[inline(always)]
fn supernode<'a, T>(
    symbolic: &'a SymbolicSupernodalCholesky<u32>,
    factor: &'a Factor<T>,
    s: usize,
) -> Supernode<'a, T> {
    let (start, end) =
        (symbolic.supernode_begin()[s] as usize, symbolic.supernode_end()[s] as usize);
    let rows = symbolic.col_ptr_for_row_idx()[s] as usize;
    let below = &symbolic.row_idx()[rows..rows + symbolic.nnz_per_super()[s] as usize];
    let values = symbolic.col_ptr_for_val();
    let values = &factor.values[values[s] as usize..values[s + 1] as usize];
    Supernode { start, width: end - start, below, values }
}

/// The forward step of one supernode.
#[inline(always)]
fn eliminate<T: Real>(node: &Supernode<'_, T>, cut: usize, x: &mut [T], rows: &mut Vec<T>) {
    let (start, width) = (node.start, node.width);
    rows.clear();
    rows.extend_from_slice(&x[start..start + width]);
    rows.resize(node.height(), T::ZERO);
    let columns = width.min(cut - start);
    let mut j = 0;
    while j + COLUMNS <= columns {
        let (own, rest) = rows[j..].split_at_mut(COLUMNS);
        for a in 0..COLUMNS {
            let column = node.column(j + a, j + a);
            own[a] = own[a] / column[0];
            for b in a + 1..COLUMNS {
                own[b] = own[b] - column[b - a] * own[a];
            }
        }
        let c: [&[T]; COLUMNS] = std::array::from_fn(|a| node.column(j + a, j + COLUMNS));
        let w: [T; COLUMNS] = std::array::from_fn(|a| own[a]);
        for ((((value, c0), c1), c2), c3) in rest.iter_mut().zip(c[0]).zip(c[1]).zip(c[2]).zip(c[3])
        {
            *value = *value - ((*c0 * w[0] + *c1 * w[1]) + (*c2 * w[2] + *c3 * w[3]));
        }
        j += COLUMNS;
    }
    while j < columns {
        let column = node.column(j, j);
        let (own, rest) = rows[j..].split_at_mut(1);
        own[0] = own[0] / column[0];
        for (value, entry) in rest.iter_mut().zip(&column[1..]) {
            *value = *value - *entry * own[0];
        }
        j += 1;
    }
    x[start..start + width].copy_from_slice(&rows[..width]);
    for (&row, value) in node.below.iter().zip(&rows[width..]) {
        x[row as usize] = x[row as usize] + *value;
    }
}

/// The backward step of one supernode.
#[inline(always)]
fn substitute<T: Real>(node: &Supernode<'_, T>, cut: usize, x: &mut [T], rows: &mut Vec<T>) {
    let (start, width) = (node.start, node.width);
    rows.clear();
    rows.extend_from_slice(&x[start..start + width]);
    rows.extend(node.below.iter().map(|&row| x[row as usize]));
    let columns = width.min(cut - start);
    let mut j = columns;
    while j % COLUMNS != 0 {
        j -= 1;
        let column = node.column(j, j);
        let (own, rest) = rows[j..].split_at_mut(1);
        own[0] = (own[0] - product(&column[1..], rest)) / column[0];
    }
    while j > 0 {
        j -= COLUMNS;
        let (own, rest) = rows[j..].split_at_mut(COLUMNS);
        let sums = products(std::array::from_fn(|a| node.column(j + a, j + COLUMNS)), rest);
        for a in (0..COLUMNS).rev() {
            let column = node.column(j + a, j + a);
            let mut value = own[a] - sums[a];
            for b in a + 1..COLUMNS {
                value = value - column[b - a] * own[b];
            }
            own[a] = value / column[0];
        }
    }
    x[start..start + columns].copy_from_slice(&rows[..columns]);
}

/// Σ a_i b_i.
#[inline(always)]
fn product<T: Real>(a: &[T], b: &[T]) -> T {
    let mut lanes = [T::ZERO; LANES];
    let (a_blocks, b_blocks) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    let (a_rest, b_rest) = (a_blocks.remainder(), b_blocks.remainder());
    for (a, b) in a_blocks.zip(b_blocks) {
        for l in 0..LANES {
            lanes[l] = lanes[l] + a[l] * b[l];
        }
    }
    let rest = a_rest.iter().zip(b_rest).fold(T::ZERO, |sum, (a, b)| sum + *a * *b);
    total(lanes) + rest
}

/// Σ_i c_i x_i for several columns c.
#[inline(always)]
fn products<T: Real>(c: [&[T]; COLUMNS], x: &[T]) -> [T; COLUMNS] {
    let whole = x.len() / LANES * LANES;
    let c: [&[T]; COLUMNS] = std::array::from_fn(|a| &c[a][..x.len()]);
    let mut lanes = [[T::ZERO; LANES]; COLUMNS];
    let mut at = 0;
    while at < whole {
        for a in 0..COLUMNS {
            let (c, x) = (&c[a][at..at + LANES], &x[at..at + LANES]);
            for l in 0..LANES {
                lanes[a][l] = lanes[a][l] + c[l] * x[l];
            }
        }
        at += LANES;
    }
    // A sum of its own: lanes that are addressed one by one would not stay in registers.
    let mut rest = [T::ZERO; COLUMNS];
    while at < x.len() {
        for a in 0..COLUMNS {
            rest[a] = rest[a] + c[a][at] * x[at];
        }
        at += 1;
    }
    std::array::from_fn(|a| total(lanes[a]) + rest[a])
}

/// The sum of all lanes, by halves.
#[inline(always)]
fn total<T: Real>(lanes: [T; LANES]) -> T {
    let mut lanes = lanes;
    let mut half = LANES / 2;
    while half > 0 {
        for l in 0..half {
            lanes[l] = lanes[l] + lanes[l + half];
        }
        half /= 2;
    }
    lanes[0]
}
