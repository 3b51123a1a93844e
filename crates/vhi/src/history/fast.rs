//! Σ_{j<n} w_j b(t_n - t_j) u_j for a kernel that is smooth away from lag zero, in O(1) vector operations per step and
//! O(log N) vectors of memory.
//!
//! Levels form clusters, two of which form a larger one. Between separated clusters of one size, b(t - s) is
//! interpolated at r Chebyshev nodes in t and in s,
//!
//!   b(t - s) ≈ Σ_pq L_p(t) b(τ_p - σ_q) L_q(s),
//!
//! so that the past acts through moments Σ_j L_q(t_j) w_j u_j. Moments of a cluster follow from those of its halves,
//! and what acts on a cluster acts on its halves. Neighbours are summed directly. This is the fast multipole method of
//! L. Greengard and V. Rokhlin, J. Comput. Phys. 73 (1987), in one dimension and causal. The interpolation error is
//! measured on every pair of clusters before the first step.

use std::ops::Range;

use super::{TimeGrid, TimeRule, Trapezoid};
use crate::law::MemoryKernel;
use algebra::linalg::{axpy, dot, larger};

/// Candidate numbers of nodes. A singularity at lag zero is three half widths from the middle of the nearest cluster:
/// the error falls by 3 + √8 per node, and 24 nodes reach rounding.
const NODES: [usize; 7] = [4, 6, 8, 12, 16, 20, MOST];
const MOST: usize = 24;
/// Share of the nodes by rate that suffices for smooth kernels: 16 for 1e-13.
const SMOOTH: f64 = 0.92;
/// Share for entire kernels, whose error falls faster: 12 for 1e-13.
const ENTIRE: f64 = 0.65;
/// Direct sums of N steps take N/2 vectors per step on average, interpolation by r nodes about 10 r.
const PAYS_FROM: usize = 21;
/// Levels of a smallest cluster per node: direct sums over neighbours then cost as much as the rest.
const LEAF: usize = 2;
/// Clusters of one size that are held: the open one and three before it.
const HELD: usize = 4;
/// Check points per variable for a pair of clusters: between the nodes and at the ends.
const CHECKS: usize = 5;

/// History of coefficient vectors by interpolated kernels.
pub struct FastConvolution {
    dofs: usize,
    /// N.
    steps: usize,
    nodes: usize,
    leaf: usize,
    /// Moments (r vectors each) by size and number modulo [`HELD`], and what acts on the open cluster.
    sizes: Vec<Size>,
    /// u_j of the open smallest cluster and the one before it, by j modulo twice its length.
    near: Vec<Vec<f64>>,
    committed: usize,
    prepared: usize,
    shapes: Shapes,
    /// b(τ_p - σ_q) of a pair, row by row.
    between: Vec<f64>,
    /// Largest interpolation error relative to the largest kernel value.
    pub error: f64,
}

#[derive(Clone)]
struct Size {
    moments: [Vec<f64>; HELD],
    acting: Vec<f64>,
}

impl FastConvolution {
    /// Prepares N steps of `grid` with a relative kernel error of at most `tolerance`; None if no number of nodes
    /// reaches it.
    pub(crate) fn new(
        kernel: &dyn MemoryKernel,
        grid: &TimeGrid,
        dofs: usize,
        tolerance: f64,
    ) -> Option<Self> {
        candidates(tolerance).find_map(|nodes| {
            // Vectors are allocated after the check.
            let mut plan = Self::with_nodes(nodes, grid, 0);
            plan.error = plan.largest_error(kernel, grid);
            // NaN is refused.
            (plan.error <= tolerance)
                .then(|| Self { error: plan.error, ..Self::with_nodes(nodes, grid, dofs) })
        })
    }

    fn with_nodes(nodes: usize, grid: &TimeGrid, dofs: usize) -> Self {
        let leaf = LEAF * nodes;
        let empty = || vec![0.0; nodes * dofs];
        let size = || Size { moments: std::array::from_fn(|_| empty()), acting: empty() };
        Self {
            dofs,
            steps: grid.steps(),
            nodes,
            leaf,
            sizes: (0..sizes(grid.steps(), nodes)).map(|_| size()).collect(),
            near: vec![vec![0.0; dofs]; 2 * leaf],
            committed: 0,
            prepared: 0,
            shapes: Shapes::new(nodes),
            between: vec![0.0; nodes * nodes],
            error: f64::NAN,
        }
    }

    pub(crate) fn committed(&self) -> usize {
        self.committed
    }

    /// Steps from which interpolation to `tolerance` may pay.
    pub(crate) fn least_steps(tolerance: f64) -> usize {
        PAYS_FROM * candidates(tolerance).next().unwrap_or(MOST)
    }

    pub(crate) fn pays(&self) -> bool {
        self.steps >= PAYS_FROM * self.nodes
    }

    /// Vectors held over N steps for a smooth kernel; none if direct sums are taken.
    pub fn foreseen_vectors(steps: usize, tolerance: f64) -> Option<usize> {
        let nodes = foreseen_nodes(tolerance);
        (steps >= PAYS_FROM * nodes).then(|| Self::vectors(steps, nodes))
    }

    /// Steps from which smooth kernels are interpolated to `tolerance`.
    pub fn foreseen_from(tolerance: f64) -> usize {
        PAYS_FROM * foreseen_nodes(tolerance)
    }

    /// Vectors held over N steps with so many nodes per cluster.
    pub(crate) fn vectors(steps: usize, nodes: usize) -> usize {
        sizes(steps, nodes) * (HELD + 1) * nodes + 2 * LEAF * nodes
    }

    pub(crate) fn numbers(&self) -> usize {
        (self.sizes.len() * (HELD + 1) * self.nodes + self.near.len()) * self.dofs
    }

    /// The times of cluster c of size l, up to the first one of the next.
    fn interval(&self, grid: &TimeGrid, l: usize, c: usize) -> (f64, f64) {
        let last = grid.steps();
        let (from, to) = ((c * self.leaf) << l, ((c + 1) * self.leaf) << l);
        if from >= last {
            return (grid.time(last), grid.time(last) + grid.step(last));
        }
        (grid.time(from), grid.time(to.min(last)))
    }

    /// Clusters before c that do not touch it, but whose parents touch its parent.
    fn partners(c: usize) -> Range<usize> {
        let parent = c / 2;
        if c < 2 { 0..0 } else { 2 * parent.max(1) - 2..c - 1 }
    }

    /// Largest interpolation error on all pairs of clusters, relative to the largest kernel value.
    fn largest_error(&mut self, kernel: &dyn MemoryKernel, grid: &TimeGrid) -> f64 {
        let leaves = grid.steps() / self.leaf;
        let at_zero = kernel.value(0.0).abs();
        let mut largest = if at_zero.is_finite() { at_zero } else { 0.0 };
        let mut worst = 0.0f64;
        let shapes: Vec<(f64, [f64; MOST])> = (0..CHECKS)
            .map(|i| {
                let x = (std::f64::consts::PI * i as f64 / (CHECKS - 1) as f64).cos();
                // Off the nodes, and off the symmetric places where errors cancel.
                let x = x * (1.0 - 0.03 * i as f64);
                (x, self.shapes.at(x))
            })
            .collect();
        for l in 0..self.sizes.len() {
            for c in 0..=leaves >> l {
                let interval = self.interval(grid, l, c);
                for partner in Self::partners(c) {
                    let other = self.interval(grid, l, partner);
                    interpolate(kernel, interval, other, &mut self.between, self.nodes);
                    for (x, shape_t) in &shapes {
                        for (y, shape_s) in &shapes {
                            let value = kernel.value(place(interval, *x) - place(other, *y));
                            let rows = self.between.chunks_exact(self.nodes).zip(shape_t);
                            let found: f64 = rows.map(|(row, s)| s * dot(row, shape_s)).sum();
                            worst = larger(worst, (found - value).abs());
                            largest = largest.max(value.abs());
                        }
                    }
                }
            }
        }
        if largest > 0.0 { worst / largest } else { worst }
    }

    /// Collects what acts on the clusters that begin with level n, large ones first.
    fn prepare(&mut self, kernel: &dyn MemoryKernel, grid: &TimeGrid, n: usize) {
        let (dofs, nodes) = (self.dofs, self.nodes);
        let leaf = n / self.leaf;
        for l in (0..self.sizes.len()).rev().filter(|l| leaf.is_multiple_of(1 << l)) {
            let c = leaf >> l;
            let interval = self.interval(grid, l, c);
            let parent = self.interval(grid, l + 1, c / 2);
            let (small, large) = self.sizes.split_at_mut(l + 1);
            let size = &mut small[l];
            size.acting.fill(0.0);
            if let Some(large) = large.first() {
                for p in 0..nodes {
                    let weights = self.shapes.at(inverse(parent, place(interval, node(nodes, p))));
                    let out = &mut size.acting[dofs * p..dofs * (p + 1)];
                    for (weight, from) in weights.iter().zip(large.acting.chunks_exact(dofs)) {
                        axpy(*weight, from, out);
                    }
                }
            }
            for partner in Self::partners(c) {
                let other = self.interval(grid, l, partner);
                interpolate(kernel, interval, other, &mut self.between, nodes);
                let size = &mut self.sizes[l];
                let moments = &size.moments[partner % HELD];
                let rows = self.between.chunks_exact(nodes);
                for (row, out) in rows.zip(size.acting.chunks_exact_mut(dofs)) {
                    for (weight, moment) in row.iter().zip(moments.chunks_exact(dofs)) {
                        axpy(*weight, moment, out);
                    }
                }
            }
        }
    }

    /// `out` ← Σ_{j<n} w_j b(t_n - t_j) u_j for the next level n, by the trapezoidal rule.
    pub(crate) fn past(&mut self, kernel: &dyn MemoryKernel, grid: &TimeGrid, out: &mut [f64]) {
        out.fill(0.0);
        let n = self.committed;
        let leaf = n / self.leaf;
        if self.prepared <= leaf {
            self.prepare(kernel, grid, n);
            self.prepared = leaf + 1;
        }
        for j in leaf.saturating_sub(1) * self.leaf..n {
            let weight = Trapezoid.weight(grid, n, j) * kernel.value(grid.time(n) - grid.time(j));
            axpy(weight, &self.near[j % (2 * self.leaf)], out);
        }
        if let Some(size) = self.sizes.first().filter(|_| leaf >= 2) {
            let x = inverse(self.interval(grid, 0, leaf), grid.time(n));
            let weights = self.shapes.at(x);
            for (weight, acting) in weights.iter().zip(size.acting.chunks_exact(self.dofs)) {
                axpy(*weight, acting, out);
            }
        }
    }

    pub(crate) fn commit(&mut self, grid: &TimeGrid, u: &[f64]) {
        let (n, dofs) = (self.committed, self.dofs);
        self.near[n % (2 * self.leaf)].copy_from_slice(u);
        self.committed += 1;
        let leaf = n / self.leaf;
        if self.sizes.is_empty() || n == grid.steps() {
            return;
        }
        let x = inverse(self.interval(grid, 0, leaf), grid.time(n));
        // The weight of t_n in all later sums.
        let weight = Trapezoid.weight(grid, n + 1, n);
        let shapes = self.shapes.at(x);
        let moments = &mut self.sizes[0].moments[leaf % HELD];
        if n.is_multiple_of(self.leaf) {
            moments.fill(0.0);
        }
        for (shape, moment) in shapes.iter().zip(moments.chunks_exact_mut(dofs)) {
            axpy(weight * shape, u, moment);
        }
        if (n + 1).is_multiple_of(self.leaf) {
            self.gather(grid, leaf);
        }
    }

    /// Adds the moments of clusters that end with smallest cluster `leaf` to those of their parents.
    fn gather(&mut self, grid: &TimeGrid, leaf: usize) {
        let (dofs, nodes) = (self.dofs, self.nodes);
        for l in 0..self.sizes.len().saturating_sub(1) {
            if !(leaf + 1).is_multiple_of(1 << l) {
                break;
            }
            let c = leaf >> l;
            let (interval, parent) = (self.interval(grid, l, c), self.interval(grid, l + 1, c / 2));
            let (small, large) = self.sizes.split_at_mut(l + 1);
            let target = &mut large[0].moments[(c / 2) % HELD];
            if c.is_multiple_of(2) {
                target.fill(0.0);
            }
            for (p, from) in small[l].moments[c % HELD].chunks_exact(dofs).enumerate() {
                let weights = self.shapes.at(inverse(parent, place(interval, node(nodes, p))));
                for (weight, out) in weights.iter().zip(target.chunks_exact_mut(dofs)) {
                    axpy(*weight, from, out);
                }
            }
        }
    }
}

/// Sizes of clusters over N steps. A size with at most three clusters has no separated pair but (0, 2).
fn sizes(steps: usize, nodes: usize) -> usize {
    (0..).take_while(|&l| (steps / (LEAF * nodes)) >> l >= 2).count()
}

/// Candidate numbers of nodes for a tolerance.
fn candidates(tolerance: f64) -> impl Iterator<Item = usize> {
    let least = ENTIRE * nodes_by_rate(tolerance);
    NODES.into_iter().filter(move |&nodes| nodes as f64 >= least || nodes == MOST)
}

/// r with (3 + √8)^-r = tolerance.
fn nodes_by_rate(tolerance: f64) -> f64 {
    -tolerance.ln() / (3.0 + 8f64.sqrt()).ln()
}

fn foreseen_nodes(tolerance: f64) -> usize {
    let least = SMOOTH * nodes_by_rate(tolerance);
    NODES.into_iter().find(|&nodes| nodes as f64 >= least).unwrap_or(MOST)
}

fn node(nodes: usize, i: usize) -> f64 {
    (std::f64::consts::PI * (2 * i + 1) as f64 / (2 * nodes) as f64).cos()
}

/// The time at x ∈ [-1, 1] of an interval.
fn place((from, to): (f64, f64), x: f64) -> f64 {
    0.5 * (from + to) + 0.5 * (to - from) * x
}

fn inverse((from, to): (f64, f64), t: f64) -> f64 {
    (2.0 * t - from - to) / (to - from)
}

/// b(τ_p - σ_q) between the nodes of two intervals, row by row.
fn interpolate(
    kernel: &dyn MemoryKernel,
    interval: (f64, f64),
    other: (f64, f64),
    out: &mut [f64],
    nodes: usize,
) {
    let at = |interval, i| place(interval, node(nodes, i));
    for (pq, value) in out.iter_mut().enumerate() {
        *value = kernel.value(at(interval, pq / nodes) - at(other, pq % nodes));
    }
}

/// Lagrange polynomials of the nodes, L_i(x) = (2/r) Σ' T_m(x_i) T_m(x), the term m = 0 halved.
struct Shapes {
    nodes: usize,
    /// T_m(x_i).
    table: Vec<[f64; MOST]>,
}

impl Shapes {
    fn new(nodes: usize) -> Self {
        Self { nodes, table: (0..nodes).map(|i| chebyshev(node(nodes, i))).collect() }
    }

    /// L_0(x), …, L_{r-1}(x), then zeros.
    fn at(&self, x: f64) -> [f64; MOST] {
        let at = chebyshev(x);
        let mut values = [0.0; MOST];
        for (value, at_node) in values.iter_mut().zip(&self.table) {
            let sum = dot(&at_node[1..self.nodes], &at[1..self.nodes]);
            *value = (1.0 + 2.0 * sum) / self.nodes as f64;
        }
        values
    }
}

/// T_0(x), T_1(x), ….
fn chebyshev(x: f64) -> [f64; MOST] {
    let mut values = [1.0; MOST];
    values[1] = x;
    for m in 2..MOST {
        values[m] = 2.0 * x * values[m - 1] - values[m - 2];
    }
    values
}

#[cfg(test)]
mod tests;
