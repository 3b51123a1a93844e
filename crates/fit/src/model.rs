//! Error models of two steps: sum and root-sum-square.

/// E = (A^m + B^m + F^m)^(1/m) with A = C_h h^p, B = C_k k^q and an optional floor F.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ErrorCombination {
    /// m = 1: the triangle inequality attained.
    Sum,
    /// m = 2: space and time error nearly orthogonal.
    RootSumSquare,
}

impl ErrorCombination {
    pub(super) const BOTH: [Self; 2] = [Self::Sum, Self::RootSumSquare];

    pub fn name(self) -> &'static str {
        match self {
            Self::Sum => "sum",
            Self::RootSumSquare => "root-sum-square",
        }
    }

    /// m.
    pub fn exponent(self) -> f64 {
        match self {
            Self::Sum => 1.0,
            Self::RootSumSquare => 2.0,
        }
    }

    /// log E and its weights ∂ log E / ∂ log A, … for terms given by logarithms; a local slope is the mean of the
    /// orders with these weights.
    pub(super) fn combine<const T: usize>(self, log_terms: [f64; T]) -> (f64, [f64; T]) {
        let m = self.exponent();
        let largest = log_terms.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let parts = log_terms.map(|term| (m * (term - largest)).exp());
        let total: f64 = parts.iter().sum();
        (largest + total.ln() / m, parts.map(|part| part / total))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn terms_combine_with_their_weights() {
        let (log_error, weights) = ErrorCombination::Sum.combine([3f64.ln(), 0.0]);
        assert!((log_error - 4f64.ln()).abs() < 1e-15 && (weights[0] - 0.75).abs() < 1e-15);
        let (log_error, weights) = ErrorCombination::RootSumSquare.combine([3f64.ln(), 4f64.ln()]);
        assert!((log_error - 5f64.ln()).abs() < 1e-15 && (weights[1] - 0.64).abs() < 1e-15);
        assert!(ErrorCombination::Sum.combine([900.0, -900.0]).0.is_finite());
    }
}
