//! ∫_{Γ3} ∂j_ν(u_ν - s) v_ν for a piecewise linear u_ν, by the rule of the scheme: an exact solution in V^h is balanced
//! by the scheme's integral, not by a better one.

use super::curve::CurveNumbers;
use super::exact::LawNumbers;
use super::sign_changes::sign_changes;
use fem::space::quadrature::{Rule, edge, triangle_degree_4};

/// The scheme's quadrature of ∂j_ν(u_ν - s) v_ν on Γ3.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ComplianceRule {
    /// At the vertices, with lumped weights.
    Vertex,
    /// At three Gauss points per edge, six per triangle.
    Gauss,
    /// On the pieces between kinks: exact, in the plane.
    Exact,
}

/// Intervals of an edge in which crossings of kinks are sought.
const WATCHES: usize = 64;

impl LawNumbers {
    /// p(r), at a jump its lower end.
    pub fn pressure(&self, r: f64) -> f64 {
        self.graph(r) + self.curve.map_or(0.0, |curve| curve.value(r))
    }

    /// p'(r), from the left at a kink.
    pub fn slope(&self, r: f64) -> f64 {
        let end = self.points.partition_point(|point| point[0] < r);
        let linear = match end {
            0 => self.slope_before,
            end if end == self.points.len() => self.slope_after,
            end => {
                let [a, b] = [self.points[end - 1], self.points[end]];
                (b[1] - a[1]) / (b[0] - a[0])
            }
        };
        linear + self.curve.map_or(0.0, |curve| curve.slope(r))
    }

    /// Where p is not smooth, increasing.
    pub fn kinks(&self) -> Vec<f64> {
        let mut kinks: Vec<f64> = self.points.iter().map(|point| point[0]).collect();
        kinks.extend(self.curve.iter().flat_map(CurveNumbers::kinks));
        kinks.sort_by(f64::total_cmp);
        kinks.dedup();
        kinks
    }

    fn graph(&self, r: f64) -> f64 {
        let first = self.points[0];
        if r <= first[0] {
            return first[1] + self.slope_before * (r - first[0]);
        }
        for pair in self.points.windows(2) {
            if r <= pair[1][0] {
                let part = (r - pair[0][0]) / (pair[1][0] - pair[0][0]);
                return (1.0 - part) * pair[0][1] + part * pair[1][1];
            }
        }
        let last = self.points[self.points.len() - 1];
        last[1] + self.slope_after * (r - last[0])
    }
}

/// Means over an edge or a triangle of c p(u_ν - s) times its hat functions; `normal` are the values of u_ν at its corners,
/// `shift` is s and `scale` is c by barycentric coordinates. The vertex rule is no integral over facets, and the exact one is
/// for edges: scenes in space that ask for it are refused.
pub(crate) fn facet_moments(
    law: &LawNumbers,
    rule: ComplianceRule,
    normal: &[f64],
    shift: impl Fn(&[f64]) -> f64,
    scale: impl Fn(&[f64]) -> f64,
) -> Vec<f64> {
    let argument = |b: &[f64]| b.iter().zip(normal).map(|(b, u)| b * u).sum::<f64>() - shift(b);
    let rule = match (normal.len(), rule) {
        (2, ComplianceRule::Exact) => between_kinks(law, |x| argument(&[1.0 - x, x])),
        (2, _) => edge(3),
        _ => triangle_degree_4(),
    };
    let mut moments = vec![0.0; normal.len()];
    for (b, weight) in rule.points.iter().zip(&rule.weights) {
        let value = weight * scale(b) * law.pressure(argument(b));
        moments.iter_mut().zip(b).for_each(|(moment, b)| *moment += value * b);
    }
    moments
}

/// Gauss points on the pieces of an edge between the kinks of p, by r along it.
fn between_kinks(law: &LawNumbers, r: impl Fn(f64) -> f64) -> Rule {
    let mut cuts = vec![0.0, 1.0];
    cuts.extend(sign_changes(0.0, 1.0, WATCHES, |places| {
        let offsets = |kink: f64| places.iter().map(|&x| r(x) - kink).collect();
        law.kinks().into_iter().map(offsets).collect()
    }));
    cuts.sort_by(f64::total_cmp);
    // 8 per piece, as s may be curved, and 32 if p is: for rational p they leave 1e-14 while u_ν - s ranges over 4 r0 on a
    // piece.
    let of_piece = edge(if law.curve.is_some() { 32 } else { 8 });
    let (mut points, mut weights) = (Vec::new(), Vec::new());
    for pair in cuts.windows(2) {
        for (b, weight) in of_piece.points.iter().zip(&of_piece.weights) {
            let place = b[0] * pair[0] + b[1] * pair[1];
            points.push(vec![1.0 - place, place]);
            weights.push((pair[1] - pair[0]) * weight);
        }
    }
    Rule { points, weights }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn law() -> LawNumbers {
        let points = vec![[0.0, 0.0], [0.04, 0.08], [0.10, 0.05]];
        LawNumbers { points, slope_before: 0.0, slope_after: 0.0, curve: None }
    }

    /// u_ν from 0 to 0.08 on an edge of length 1: p is 0.16 x up to x = ½, then 0.1 - 0.04 x.
    #[test]
    fn a_kink_inside_the_edge_is_integrated_by_the_exact_rule_alone() {
        let moments = |rule| facet_moments(&law(), rule, &[0.0, 0.08], |_| 0.0, |_| 1.0);
        let exact = moments(ComplianceRule::Exact);
        let (rising, falling) = (0.16 / 24.0, 0.1 * 3.0 / 8.0 - 0.04 * 7.0 / 24.0);
        assert!((exact[1] - rising - falling).abs() < 1e-15);
        assert!((exact[0] + exact[1] - 0.02 - 0.035).abs() < 1e-15);
        let gauss = moments(ComplianceRule::Gauss);
        assert!((gauss[1] - exact[1]).abs() > 1e-4);
    }

    /// ∫ c r/(1 + (r/r0)²) dr = ½ c r0² log(1 + (r/r0)²), over r from 0.01 to 0.17 on the edge.
    #[test]
    fn a_curved_law_and_a_factor_are_integrated_to_rounding() {
        let curve = Some(CurveNumbers::Rational { c: 2.0, r0: 0.04 });
        let law =
            LawNumbers { points: vec![[0.0, 0.0]], slope_before: 0.0, slope_after: 0.0, curve };
        let primitive = |r: f64| 0.0016 * (1.0 + (r / 0.04).powi(2)).ln();
        let expected = (primitive(0.17) - primitive(0.01)) / 0.16;
        let moments = |scale: fn(&[f64]) -> f64| {
            facet_moments(&law, ComplianceRule::Exact, &[0.01, 0.17], |_| 0.0, scale)
        };
        let [a, b] = moments(|_| 1.0)[..] else { panic!("two") };
        assert!((a + b - expected).abs() < 1e-15, "{:e}", a + b - expected);
        // A factor x turns the sum into the second moment.
        let [c, d] = moments(|b| b[1])[..] else { panic!("two") };
        assert!((c + d - b).abs() < 1e-15);
    }

    /// p = 2 r with r linear: the mean of p λ_a is 2 (r_a + Σ r)/12.
    #[test]
    fn a_linear_branch_is_integrated_on_triangles() {
        let gauss = ComplianceRule::Gauss;
        let found = facet_moments(&law(), gauss, &[0.03, 0.01, 0.02], |_| 0.005, |_| 1.0);
        for (a, r) in [0.025, 0.005, 0.015].into_iter().enumerate() {
            assert!((found[a] - (r + 0.045) / 6.0).abs() < 1e-16, "{a}: {}", found[a]);
        }
    }

    #[test]
    fn a_curved_shift_is_resolved() {
        // u_ν - s = 0.08 x², which crosses 0.04 at 1/√2.
        let found = facet_moments(
            &law(),
            ComplianceRule::Exact,
            &[0.0, 0.0],
            |b| -0.08 * b[1] * b[1],
            |_| 1.0,
        );
        let c = 0.5f64.sqrt();
        let exact =
            0.16 * c.powi(4) / 4.0 + 0.1 * (1.0 - c * c) / 2.0 - 0.04 * (1.0 - c.powi(4)) / 4.0;
        assert!((found[1] - exact).abs() < 1e-15, "{:e}", found[1] - exact);
    }
}
