//! Integrals of |v|² over simplices, from the values of v at the nodes.

/// The mean of |v|² over a simplex for v in its element.
pub struct MeanSquare {
    /// Of linear functions: (Σ v_a² + (Σ v_a)²)/(N (N + 1)), N the number of corners.
    scale: f64,
    /// Of others: means of products of shape functions.
    mass: Vec<f64>,
}

impl MeanSquare {
    /// From the mass matrix, empty for linear functions.
    pub(super) fn new(corners: usize, mass: Vec<f64>) -> Self {
        Self { scale: 1.0 / (corners * (corners + 1)) as f64, mass }
    }

    /// ∫ |v|² over a simplex of this measure, from the values of v at its nodes.
    #[inline]
    pub fn over<const D: usize>(&self, measure: f64, v: &[[f64; D]]) -> f64 {
        if !self.mass.is_empty() {
            let rows = v.iter().zip(self.mass.chunks_exact(v.len()));
            let product = |a: &[f64; D], b: &[f64; D]| (0..D).map(|i| a[i] * b[i]).sum::<f64>();
            let row =
                |a, row: &[f64]| v.iter().zip(row).map(|(b, m)| m * product(a, b)).sum::<f64>();
            return measure * rows.map(|(a, masses)| row(a, masses)).sum::<f64>();
        }
        // Corners of a triangle as a constant: loops are unrolled.
        match v.first_chunk::<3>().filter(|_| v.len() == 3) {
            Some(v) => self.linear(measure, v),
            None => self.linear(measure, v),
        }
    }

    #[inline(always)]
    fn linear<const D: usize>(&self, measure: f64, v: &[[f64; D]]) -> f64 {
        let (mut total, mut squares) = ([0.0; D], 0.0);
        for value in v {
            for i in 0..D {
                total[i] += value[i];
                squares += value[i] * value[i];
            }
        }
        measure * self.scale * (squares + total.iter().map(|t| t * t).sum::<f64>())
    }
}
