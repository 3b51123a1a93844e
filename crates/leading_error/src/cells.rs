//! Strains and nodal forces at the strain points of cells (one per cell for P1), in Mandel notation: S = 3 numbers in
//! the plane (xx, yy, √2 xy), 6 in space (xx, yy, zz, √2 yz, √2 xz, √2 xy).

use algebra::in_dimension;
use exact::constitutive::{Tensor, from_mandel, mandel, stress};
use exact::number::Number;
use exact::{FrictionBound, LawNumbers, MaterialNumbers, Sliding};
use fem::contact::Discretization;
use fem::space::StrainPoint;
use num_dual::Dual64;
use std::f64::consts::FRAC_1_SQRT_2;

pub(super) type Mandel<const S: usize> = [f64; S];

/// Most unknowns of a cell: ten nodes in space.
const MOST: usize = 30;

pub(super) const fn dimension(numbers: usize) -> usize {
    if numbers == 3 { 2 } else { 3 }
}

/// The rows of ε at a point, ε(v) = Σ_a B_a v_a: in the plane B_a is [[g_x, 0], [0, g_y], [g_y, g_x]/√2].
fn rows<const S: usize>(at: &StrainPoint<'_>) -> [[f64; MOST]; S] {
    let mut rows = [[0.0; MOST]; S];
    let d = dimension(S);
    for (a, g) in at.gradients.chunks_exact(d).enumerate() {
        for i in 0..d {
            rows[i][d * a + i] = g[i];
        }
        // The shears: xy in the plane; yz, xz, xy in space, each given by the axis that it leaves out.
        for row in d..S {
            let (i, j) = if d == 2 { (0, 1) } else { ((row + 1) % 3, (row + 2) % 3) };
            rows[row][d * a + i] = FRAC_1_SQRT_2 * g[j];
            rows[row][d * a + j] = FRAC_1_SQRT_2 * g[i];
        }
    }
    rows
}

pub(super) fn product<const S: usize>(a: &Mandel<S>, b: &Mandel<S>) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

pub(super) fn strains<const S: usize>(space: &Discretization, nodal: &[f64]) -> Vec<Mandel<S>> {
    let d = dimension(S);
    let strain = |at: StrainPoint<'_>| {
        rows::<S>(&at).map(|row| {
            let term = |i: usize| row[i] * nodal[d * at.nodes[i / d] as usize + i % d];
            (0..d * at.nodes.len()).map(term).sum()
        })
    };
    space.points().map(strain).collect()
}

/// (a, b)_ℋ of tensors at the points.
pub(super) fn inner<const S: usize>(
    space: &Discretization,
    a: &[Mandel<S>],
    b: &[Mandel<S>],
) -> f64 {
    space.points().zip(a.iter().zip(b)).map(|(at, (a, b))| at.weight * product(a, b)).sum()
}

/// Adds the contribution of a point to v ↦ ∫ τ:ε(v).
pub(super) fn add_force<const S: usize>(
    at: &StrainPoint<'_>,
    tensor: &Mandel<S>,
    force: &mut [f64],
) {
    let (rows, d) = (rows::<S>(at), dimension(S));
    for i in 0..d * at.nodes.len() {
        let sum: f64 = (0..S).map(|m| rows[m][i] * tensor[m]).sum();
        force[d * at.nodes[i / d] as usize + i % d] += at.weight * sum;
    }
}

/// Adds the contribution of a point to the symmetric matrix of (w, v) ↦ ∫ D ε(w):ε(v).
pub(super) fn add_stiffness<const S: usize>(
    space: &Discretization,
    at: &StrainPoint<'_>,
    tangent: &[Mandel<S>; S],
    values: &mut [f64],
) {
    let rows = rows::<S>(at);
    let order = dimension(S) * at.nodes.len();
    let mut local = [0.0; MOST * MOST];
    for j in 0..order {
        let column: Mandel<S> = std::array::from_fn(|m| rows[m][j]);
        let stress: Mandel<S> = std::array::from_fn(|m| product(&tangent[m], &column));
        for i in 0..order {
            let sum: f64 = (0..S).map(|m| rows[m][i] * stress[m]).sum();
            local[order * i + j] = at.weight * sum;
        }
    }
    let local = &local[..order * order];
    in_dimension!(dimension(S), D => space.pattern.scatter::<D>(at.cell, at.nodes, local, values))
}

// The manufactured side's stress (5.1) and its derivatives.

/// σ of strain and memory integrals, one per term, by [`stress`].
pub(super) fn stress_of<const S: usize, T: Number>(
    material: &MaterialNumbers,
    strain: &[T; S],
    memory: &[[T; S]],
    kappa: T,
) -> [T; S] {
    in_dimension!(dimension(S), D => {
        let memory: Vec<Tensor<D, T>> = memory.iter().map(|tensor| from_mandel(tensor)).collect();
        mandel(&stress(material, &from_mandel(strain), &memory, kappa))
    })
}

/// The derivative of σ in a direction: each argument is given with its part of the direction.
pub(super) fn stress_along<const S: usize>(
    material: &MaterialNumbers,
    strain: [Mandel<S>; 2],
    memory: impl Iterator<Item = [Mandel<S>; 2]>,
    kappa: [f64; 2],
) -> Mandel<S> {
    let dual = |[at, along]: [Mandel<S>; 2]| -> [Dual64; S] {
        std::array::from_fn(|i| Dual64::new(at[i], along[i]))
    };
    let memory: Vec<_> = memory.map(dual).collect();
    stress_of(material, &dual(strain), &memory, Dual64::new(kappa[0], kappa[1])).map(|s| s.eps)
}

// Response of ξ ∈ ∂j_ν(r) to small changes of r.

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Answer {
    /// ξ changes by this slope times the change of r.
    Slope(f64),
    /// r does not change: the constraint is active, or ξ is inside a jump.
    Held,
}

pub(super) fn answer(law: Option<&LawNumbers>, r: f64, xi: f64, lambda: f64) -> Answer {
    if lambda.abs() > 0.0 {
        return Answer::Held;
    }
    let Some(law) = law else { return Answer::Slope(0.0) };
    let mut pairs = law.points.windows(2).map(|pair| (pair[0], pair[1]));
    // Strictly inside a jump ξ keeps r fixed.
    let jump = pairs.any(|([from, low], [to, high])| {
        from == to && (r - from).abs() <= ROUNDING * from.abs().max(1.0) && xi > low && xi < high
    });
    if jump {
        return Answer::Held;
    }
    Answer::Slope(law.slope(r))
}

/// w ∂s/∂u_τ by components at a vertex of weight w, s ∈ S ∂|u_τ|; `held` is the stiffness while it sticks, below the
/// bound. The response to u_ν of a bound that follows the normal law is nonsymmetric, and not in it.
pub(super) fn sliding_block(
    bound: &FrictionBound,
    sliding: &Sliding,
    [weight, held]: [f64; 2],
) -> [[f64; 3]; 3] {
    let along = match sliding.sticks() {
        true => [[held, 0.0], [0.0, held]],
        false => {
            turning(sliding, bound.slope(sliding.slipped())).map(|row| row.map(|k| weight * k))
        }
    };
    let mut block = [[0.0; 3]; 3];
    for (p, row) in sliding.tangents.iter().zip(&along) {
        for (q, answer) in sliding.tangents.iter().zip(row) {
            for (line, p) in block.iter_mut().zip(p) {
                line.iter_mut().zip(q).for_each(|(sum, q)| *sum += answer * p * q);
            }
        }
    }
    block
}

/// ∂s/∂u_τ along the tangents of a slipping vertex: the slope of S along the slip, S/|u_τ| across it. At the bound
/// without slip the derivative across does not exist, and the slope is used on all sides.
fn turning(sliding: &Sliding, slope: f64) -> [[f64; 2]; 2] {
    let (slip, [a, b]) = (sliding.slipped(), sliding.slip);
    if slip == 0.0 || b == 0.0 && sliding.tangents[1] == [0.0; 3] {
        return [[slope, 0.0], [0.0, slope]];
    }
    let ([a, b], across) = ([a / slip, b / slip], sliding.bound / slip);
    let mixed = (slope - across) * a * b;
    [[slope * a * a + across * b * b, mixed], [mixed, slope * b * b + across * a * a]]
}

/// Rounding of a formula that is meant to stay at a jump.
const ROUNDING: f64 = 1e-12;

/// |σ - τ|².
pub(super) fn square_apart<const D: usize>(a: &Tensor<D>, b: &Tensor<D>) -> f64 {
    a.as_flattened().iter().zip(b.as_flattened()).map(|(a, b)| (a - b).powi(2)).sum()
}

#[cfg(test)]
mod tests {
    mod tangent {
        use super::super::*;

        /// Central differences of the stress itself, inside the ball and beyond it.
        fn against_differences<const S: usize>(strain: Mandel<S>) {
            let material = MaterialNumbers {
                lambda: 0.7,
                mu_l: 1.3,
                full: None,
                memory: vec![(0.25, 0.4)],
                projection: Some(0.9),
            };
            let memory = strain.map(|e| 0.3 - e);
            // A direction in each of strain, memory and κ.
            let unit = |j: usize| std::array::from_fn(|i| f64::from(u8::from(i == j)));
            for direction in (0..=2 * S).map(|j| (unit(j), unit(j.wrapping_sub(S)), j / (2 * S))) {
                for kappa in [0.05, 0.1, 0.5] {
                    let (by_strain, by_memory, by_kappa) = direction;
                    let by_kappa = by_kappa as f64;
                    let at = |d: f64| -> Mandel<S> {
                        let moved = |tensor: Mandel<S>, by: Mandel<S>| -> Mandel<S> {
                            std::array::from_fn(|i| tensor[i] + d * by[i])
                        };
                        let memory = [moved(memory, by_memory)];
                        stress_of(
                            &material,
                            &moved(strain, by_strain),
                            &memory,
                            kappa + d * by_kappa,
                        )
                    };
                    let (up, down) = (at(1e-6), at(-1e-6));
                    let memory = [[memory, by_memory]];
                    let kappa = [kappa, by_kappa];
                    let slope =
                        stress_along(&material, [strain, by_strain], memory.into_iter(), kappa);
                    for i in 0..S {
                        // Truncation (1e-6/0.1)², rounding 1e-16/1e-6.
                        assert!(
                            ((up[i] - down[i]) / 2e-6 - slope[i]).abs() < 1e-8,
                            "{direction:?}"
                        );
                    }
                }
            }
        }

        #[test]
        fn derivatives_agree_with_differences_of_the_stress() {
            against_differences([0.11, -0.06, 0.08]);
            against_differences([0.11, -0.06, 0.03, 0.08, -0.05, 0.04]);
        }
    }

    mod law_slope {
        use super::super::*;

        #[test]
        fn friction_holds_below_its_bound_and_follows_it_beyond() {
            let held = 7.0;
            let response = |bound: &FrictionBound, values: [f64; 3]| {
                let plane = [[1.0, 0.0, 0.0], [0.0; 3]];
                sliding_block(bound, &Sliding::new(plane, 2, |i| values[i]), [1.0, held])[0][0]
            };
            let given = FrictionBound::Given(formula::Graph::new().constant(0.3));
            assert_eq!(response(&given, [0.2, 0.0, 0.3]), held);
            assert_eq!(response(&given, [-0.3, -0.1, 0.3]), 0.0);
            let falling = FrictionBound::Slip(vec![[0.0, 0.3], [0.5, 0.2]]);
            for (u_tau, slope) in [(0.1, -0.2), (-0.1, -0.2), (0.6, 0.0)] {
                let found = response(&falling, [0.28, u_tau, 0.28]);
                assert!((found - slope).abs() < 1e-12, "{u_tau}: {found}");
            }
        }

        #[test]
        fn every_branch_answers_with_its_slope() {
            let points = vec![[0.0, 0.0], [0.04, 0.08], [0.10, 0.05], [0.10, 0.09]];
            let law = LawNumbers { points, slope_before: 0.5, slope_after: 3.0, curve: None };
            let at = |r, xi, lambda| answer(Some(&law), r, xi, lambda);
            let slope = |answer| match answer {
                Answer::Slope(slope) => slope,
                Answer::Held => f64::NAN,
            };
            assert_eq!(at(-0.1, 0.0, 0.0), Answer::Slope(0.5));
            assert_eq!(at(0.02, 0.04, 0.0), Answer::Slope(2.0));
            assert!((slope(at(0.07, 0.065, 0.0)) + 0.5).abs() < 1e-14);
            assert_eq!(at(0.2, 0.4, 0.0), Answer::Slope(3.0));
            assert_eq!(at(0.10, 0.07, 0.0), Answer::Held);
            assert_eq!(at(0.02, 0.04, 0.1), Answer::Held);
            assert_eq!(answer(None, 0.02, 0.0, 0.0), Answer::Slope(0.0));
            let line = LawNumbers {
                points: vec![[0.0, 0.0]],
                slope_before: 1.0,
                slope_after: 2.0,
                curve: None,
            };
            assert_eq!(answer(Some(&line), 0.1, 0.2, 0.0), Answer::Slope(2.0));
            assert_eq!(answer(Some(&line), -0.1, 0.2, 0.0), Answer::Slope(1.0));
        }
    }
}
