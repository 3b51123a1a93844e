//! Response of ξ ∈ ∂j_ν(r) to small changes of r.

use exact::{FrictionBound, LawNumbers, Sliding};

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

#[cfg(test)]
mod tests {
    use super::*;

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
