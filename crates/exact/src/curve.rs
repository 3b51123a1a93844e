//! Curved laws of the manufactured side: as formulas, and as numbers for edge integrals.

use formula::{Graph, Node};

/// p(r) for r > 0, zero for r ≤ 0; all numbers are positive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CurveNumbers {
    /// c r r0²/(r0² + r²).
    Rational { c: f64, r0: f64 },
    /// c r/exp(r/r0).
    Exponential { c: f64, r0: f64 },
    /// c r^m for r ≤ r1, c r1^m (1 + m (r/r1 - 1)) beyond.
    Power { c: f64, m: f64, r1: f64 },
}

impl CurveNumbers {
    pub(super) fn formula(&self, graph: &mut Graph, r: Node) -> Node {
        let (text, numbers) = match *self {
            Self::Rational { c, r0 } => {
                ("top*r/(square + r^2)", vec![("top", c * r0 * r0), ("square", r0 * r0)])
            }
            Self::Exponential { c, r0 } => ("c*r/exp(r/r0)", vec![("c", c), ("r0", r0)]),
            Self::Power { c, m, r1 } => (
                // Powers of negative numbers are undefined, although another branch is taken there.
                "if(r < r1, c*max(r, 0)^m, end*(1 + m*(r/r1 - 1)))",
                vec![("c", c), ("m", m), ("r1", r1), ("end", c * r1.powf(m))],
            ),
        };
        graph.written(&format!("if(r > 0, {text}, 0)"), &[("r", r)], &numbers)
    }

    /// p(r).
    pub fn value(&self, r: f64) -> f64 {
        match *self {
            _ if r <= 0.0 => 0.0,
            Self::Rational { c, r0 } => c * r * r0 * r0 / (r0 * r0 + r * r),
            Self::Exponential { c, r0 } => c * r / (r / r0).exp(),
            Self::Power { c, m, r1 } if r > r1 => c * r1.powf(m) * (1.0 + m * (r / r1 - 1.0)),
            Self::Power { c, m, .. } => c * r.powf(m),
        }
    }

    /// p'(r), from the left at a kink.
    pub fn slope(&self, r: f64) -> f64 {
        match *self {
            _ if r <= 0.0 => 0.0,
            Self::Rational { c, r0 } => {
                let sum = r0 * r0 + r * r;
                c * r0 * r0 * (r0 - r) * (r0 + r) / (sum * sum)
            }
            Self::Exponential { c, r0 } => c * (r0 - r) / (r0 * (r / r0).exp()),
            Self::Power { c, m, r1 } => c * m * r.min(r1).powf(m) / r.min(r1),
        }
    }

    /// Where p is not smooth.
    pub(crate) fn kinks(&self) -> Vec<f64> {
        match *self {
            Self::Rational { .. } | Self::Exponential { .. } => vec![0.0],
            Self::Power { r1, .. } => vec![0.0, r1],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use formula::{EvaluationPoint, Variable};

    /// By hand: 1/(1 + ¼) · 3 · 0.1, 3 · 0.1/√e, 2 · 0.1², and 2 · 0.2² + 0.8 · 0.1.
    #[test]
    fn values_are_those_of_the_definitions() {
        let (c, r0) = (3.0, 0.2);
        assert!((CurveNumbers::Rational { c, r0 }.value(0.1) - 0.24).abs() < 1e-15);
        let e = std::f64::consts::E;
        let exponential = CurveNumbers::Exponential { c, r0 }.value(0.1);
        assert!((exponential - 0.3 / e.sqrt()).abs() < 1e-15);
        let power = CurveNumbers::Power { c: 2.0, m: 2.0, r1: 0.2 };
        assert!((power.value(0.1) - 0.02).abs() < 1e-15 && (power.value(0.3) - 0.16).abs() < 1e-15);
    }

    #[test]
    fn formula_and_numbers_agree() {
        for curve in [
            CurveNumbers::Rational { c: 3.0, r0: 0.2 },
            CurveNumbers::Exponential { c: 3.0, r0: 0.2 },
            CurveNumbers::Power { c: 2.0, m: 2.5, r1: 0.3 },
            CurveNumbers::Power { c: 2.0, m: 2.0, r1: 0.3 },
        ] {
            let mut graph = Graph::new();
            let r = graph.variable(Variable::X);
            let p = curve.formula(&mut graph, r);
            let slope = graph.derivative(p, Variable::X);
            for x in [-0.3, 0.01, 0.12, 0.29, 0.31, 1.4] {
                let at = |node: Node| {
                    graph.evaluate(node, &EvaluationPoint { x, ..EvaluationPoint::default() })
                };
                assert!((at(p) - curve.value(x)).abs() < 1e-14, "{curve:?} {x}");
                assert!((at(slope) - curve.slope(x)).abs() < 1e-13, "{curve:?} {x}");
            }
        }
    }
}
