//! The linear part of the history, Σ' b(t_n - t_j) u_j, on coefficient vectors.
//!
//! ℬ₀ε(·) is linear, so the history tensor of a cell is ℬ₀ of the strain of one history vector: one vector of unknowns
//! is kept per step (direct sum) or exponential (recursion), not a tensor per cell.

use super::{FastConvolution, TimeGrid, TimeRule};
use crate::law::{Convolution, MemoryKernel};
use algebra::linalg::axpy;

/// History of coefficient vectors under a scalar kernel.
pub enum Memory {
    /// All u_j are kept; the sum costs O(n) vectors at step n.
    Direct {
        /// u_0, …, u_{n-1}.
        past: Vec<Vec<f64>>,
    },
    /// One state per term a·exp(-c t): I_n = ∫_0^{t_n} exp(-c(t_n - s)) u(s) ds by the trapezoidal rule, advanced
    /// exactly: I_n = e^{-c k_n}(I_{n-1} + k_n/2 u_{n-1}) + k_n/2 u_n.
    Recursive {
        /// (a_i, c_i).
        terms: Vec<(f64, f64)>,
        /// I_{n-1} of each term.
        states: Vec<Vec<f64>>,
        /// u_{n-1}.
        last: Vec<f64>,
        committed: usize,
    },
    Fast(Box<FastConvolution>),
    /// A history of a history: v_j is the inner sum at t_j, and the outer one is of the v_j.
    Nested {
        outer: Box<Memory>,
        inner: Box<Memory>,
        /// v_n without u_n, and the weight of u_n in it.
        known: Vec<f64>,
        slot: f64,
    },
}

/// The weight of u_n in the sum up to t_n.
pub fn last_weight(
    kernel: &dyn MemoryKernel,
    rule: &dyn TimeRule,
    grid: &TimeGrid,
    n: usize,
) -> f64 {
    kernel.product(|kernel| rule.kernel_weight(&Convolution(kernel), grid, n, n))
}

impl Memory {
    /// For the trapezoidal rule: recursion for sums of exponentials, interpolation for other kernels on long grids if
    /// it meets their tolerance. Otherwise the direct sum.
    pub fn new(
        kernel: &dyn MemoryKernel,
        rule: &dyn TimeRule,
        grid: &TimeGrid,
        dofs: usize,
    ) -> Self {
        if let Some(kernels) = kernel.nested() {
            let [outer, inner] =
                kernels.map(|kernel| Box::new(Self::new(kernel, rule, grid, dofs)));
            return Self::Nested { outer, inner, known: vec![0.0; dofs], slot: 0.0 };
        }
        match kernel.exponentials() {
            Some(terms) if rule.is_trapezoidal() => Self::Recursive {
                terms: terms.to_vec(),
                states: vec![vec![0.0; dofs]; terms.len()],
                last: vec![0.0; dofs],
                committed: 0,
            },
            None if rule.is_trapezoidal() => {
                let fast = kernel.interpolated_to().and_then(|error| {
                    // Even the fewest nodes pay only from here on.
                    let long = grid.steps() >= FastConvolution::least_steps(error);
                    let fast = long.then(|| FastConvolution::new(kernel, grid, dofs, error));
                    fast.flatten().filter(FastConvolution::pays)
                });
                fast.map_or_else(Self::direct, |fast| Self::Fast(Box::new(fast)))
            }
            _ => Self::direct(),
        }
    }

    /// The direct sum, for any kernel and rule.
    pub fn direct() -> Self {
        Self::Direct { past: Vec::new() }
    }

    /// The index n of the next step.
    pub(crate) fn committed(&self) -> usize {
        match self {
            Self::Direct { past } => past.len(),
            Self::Recursive { committed, .. } => *committed,
            Self::Fast(fast) => fast.committed(),
            Self::Nested { outer, .. } => outer.committed(),
        }
    }

    /// `out` ← Σ_{j < n} w_{nj} b(t_n - t_j) u_j for the next step n.
    pub fn past(
        &mut self,
        kernel: &dyn MemoryKernel,
        rule: &dyn TimeRule,
        grid: &TimeGrid,
        out: &mut [f64],
    ) {
        out.fill(0.0);
        let n = self.committed();
        if n == 0 {
            return;
        }
        match self {
            Self::Direct { past } => {
                for (j, u) in past.iter().enumerate() {
                    axpy(rule.kernel_weight(&Convolution(kernel), grid, n, j), u, out);
                }
            }
            Self::Recursive { terms, states, last, .. } => {
                let k = grid.step(n);
                for ((a, c), state) in terms.iter().zip(states) {
                    let factor = a * (-c * k).exp();
                    axpy(factor, state, out);
                    axpy(factor * 0.5 * k, last, out);
                }
            }
            Self::Fast(fast) => fast.past(kernel, grid, out),
            Self::Nested { outer, inner, known, slot } => {
                let Some([of_outer, of_inner]) = kernel.nested() else { return };
                inner.past(of_inner, rule, grid, known);
                *slot = last_weight(of_inner, rule, grid, n);
                outer.past(of_outer, rule, grid, out);
                axpy(last_weight(of_outer, rule, grid, n), known, out);
            }
        }
    }

    /// Appends u_n.
    pub fn commit(&mut self, grid: &TimeGrid, u: &[f64]) {
        match self {
            Self::Direct { past } => past.push(u.to_vec()),
            Self::Recursive { terms, states, last, committed } => {
                if *committed > 0 {
                    let k = grid.step(*committed);
                    for ((_, c), state) in terms.iter().zip(states) {
                        let decay = (-c * k).exp();
                        for ((value, &before), &now) in state.iter_mut().zip(&*last).zip(u) {
                            *value = decay * (*value + 0.5 * k * before) + 0.5 * k * now;
                        }
                    }
                }
                last.copy_from_slice(u);
                *committed += 1;
            }
            Self::Fast(fast) => fast.commit(grid, u),
            Self::Nested { outer, inner, known, slot } => {
                inner.commit(grid, u);
                axpy(*slot, u, known);
                outer.commit(grid, known);
            }
        }
    }

    /// Bytes held for the history.
    pub fn bytes(&self) -> usize {
        let vectors = match self {
            Self::Direct { past } => past.iter().map(Vec::len).sum(),
            Self::Recursive { states, last, .. } => {
                states.iter().map(Vec::len).sum::<usize>() + last.len()
            }
            Self::Fast(fast) => fast.numbers(),
            Self::Nested { outer, inner, known, .. } => {
                return outer.bytes() + inner.bytes() + known.len() * size_of::<f64>();
            }
        };
        vectors * size_of::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use super::super::Trapezoid;
    use super::*;
    use crate::law::ExponentialSum;

    /// Largest relative difference of direct sum and recursion over all steps of a grid.
    fn difference(grid: &TimeGrid, kernel: &ExponentialSum) -> f64 {
        let mut direct = Memory::direct();
        let mut recursive = Memory::new(kernel, &Trapezoid, grid, 2);
        assert!(matches!(recursive, Memory::Recursive { .. }));
        let (mut a, mut b, mut worst) = ([0.0; 2], [0.0; 2], 0f64);
        let mut size = 0f64;
        for n in 0..=grid.steps() {
            direct.past(kernel, &Trapezoid, grid, &mut a);
            recursive.past(kernel, &Trapezoid, grid, &mut b);
            for i in 0..2 {
                worst = worst.max((a[i] - b[i]).abs());
                size = size.max(a[i].abs());
            }
            let t = grid.time(n);
            let u = [(3.0 * t).sin() + 0.2, t * t - 0.3];
            direct.commit(grid, &u);
            recursive.commit(grid, &u);
        }
        worst / size
    }

    #[test]
    fn recursion_equals_the_direct_sum_on_uniform_and_graded_grids() {
        let kernel = ExponentialSum { terms: vec![(-1.0, 1.0), (0.4, 0.0), (2.0, 25.0)] };
        // Both sums round once a term: 1e-13 leaves a factor 10 above 1,000 steps' rounding.
        assert!(difference(&TimeGrid::uniform(1.0, 500), &kernel) < 1e-13);
        assert!(difference(&TimeGrid::graded(3.0, 300, 2.0), &kernel) < 1e-13);
    }

    /// The comparison above detects a recursion that forgets half of the first weight.
    #[test]
    fn a_wrong_first_weight_is_seen() {
        struct NoFirstTerm;
        impl TimeRule for NoFirstTerm {
            fn weight(&self, grid: &TimeGrid, n: usize, j: usize) -> f64 {
                if j == 0 { 0.0 } else { Trapezoid.weight(grid, n, j) }
            }
        }
        let kernel = ExponentialSum { terms: vec![(-1.0, 1.0)] };
        let grid = TimeGrid::uniform(1.0, 10);
        let (mut right, mut wrong) =
            (Memory::direct(), Memory::new(&kernel, &NoFirstTerm, &grid, 1));
        assert!(matches!(wrong, Memory::Direct { .. }));
        right.commit(&grid, &[1.0]);
        wrong.commit(&grid, &[1.0]);
        let (mut a, mut b) = ([0.0], [0.0]);
        right.past(&kernel, &Trapezoid, &grid, &mut a);
        wrong.past(&kernel, &NoFirstTerm, &grid, &mut b);
        assert!((a[0] - b[0]).abs() > 1e-2);
    }

    #[test]
    fn bytes_and_steps_are_counted() {
        let grid = TimeGrid::uniform(1.0, 4);
        let kernel = ExponentialSum { terms: vec![(-1.0, 1.0), (0.5, 0.0), (2.0, 3.0)] };
        let (mut direct, mut recursive) =
            (Memory::direct(), Memory::new(&kernel, &Trapezoid, &grid, 2));
        for n in 0..4 {
            assert_eq!((direct.committed(), recursive.committed()), (n, n));
            // u_0, …, u_{n-1}; three states and u_{n-1}.
            assert_eq!((direct.bytes(), recursive.bytes()), (16 * n, 64));
            direct.commit(&grid, &[1.0, 2.0]);
            recursive.commit(&grid, &[1.0, 2.0]);
        }
    }

    /// Previous contents of the output are overwritten, even at n = 0.
    #[test]
    fn the_past_overwrites_what_was_there() {
        let grid = TimeGrid::uniform(1.0, 4);
        let kernel = ExponentialSum { terms: vec![(1.0, 0.0)] };
        let mut memory = Memory::new(&kernel, &Trapezoid, &grid, 1);
        let mut out = [7.0];
        memory.past(&kernel, &Trapezoid, &grid, &mut out);
        assert_eq!(out, [0.0]);
        memory.commit(&grid, &[2.0]);
        memory.past(&kernel, &Trapezoid, &grid, &mut out);
        assert_eq!(out, [0.25]);
    }
}
