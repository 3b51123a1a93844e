//! Quadrature on triangles cut by vertical lines: fields of contact scenes have their kinks on lines
//! x = const that move with the zones, and a Gauss rule is exact to rounding on either side.

use fem::space::quadrature::gauss_legendre;

/// Gauss points across a strip and along it: on cells of width [`NARROW`] and less they resolve
/// sin(2πx), sin(πy) and curved contact laws (r0 = 0.04 with u_ν′ = 0.2) to rounding, on wider ones the
/// larger numbers do.
const ACROSS: [usize; 2] = [6, 12];
const ALONG: [usize; 2] = [5, 8];
/// A length, where the domain's is 1.
const NARROW: f64 = 0.07;

/// Points with their weights (areas) and cells.
#[derive(Default, Clone)]
pub(crate) struct CellPoints {
    /// Coordinates.
    pub points: Vec<[f64; 3]>,
    /// Areas.
    pub weights: Vec<f64>,
    /// Cells.
    pub cells: Vec<u32>,
}

impl CellPoints {
    /// Adds the points of a triangle of cell c, cut at `cuts`.
    pub(crate) fn add(&mut self, c: u32, triangle: &[[f64; 2]; 3], cuts: &[f64]) {
        let mut corners = *triangle;
        corners.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let [low, middle, high] = corners;
        let width = high[0] - low[0];
        let wide = usize::from(width > NARROW);
        let (across, along) = (gauss_legendre(ACROSS[wide]), gauss_legendre(ALONG[wide]));
        let mut places = vec![low[0], middle[0], high[0]];
        places.extend(cuts.iter().filter(|x| **x > low[0] && **x < high[0]));
        places.sort_by(f64::total_cmp);
        for pair in places.windows(2) {
            // Thinner strips hold less than rounding of the sum over all cells.
            if pair[1] - pair[0] <= 1e-13 * width {
                continue;
            }
            let (centre, half) = (0.5 * (pair[0] + pair[1]), 0.5 * (pair[1] - pair[0]));
            let between = |a: [f64; 2], b: [f64; 2], x: f64| {
                a[1] + (b[1] - a[1]) * ((x - a[0]) / (b[0] - a[0]))
            };
            for (s, across) in across {
                let x = centre + half * s;
                let long = between(low, high, x);
                let short =
                    if x < middle[0] { between(low, middle, x) } else { between(middle, high, x) };
                let (mean, reach) = (0.5 * (long + short), 0.5 * (long - short).abs());
                for (r, along) in along {
                    self.points.push([x, mean + reach * r, 0.0]);
                    self.weights.push(across * half * along * reach);
                    self.cells.push(c);
                }
            }
        }
    }

    /// Adds the points of all 4^`times` similar parts of a triangle.
    pub(crate) fn add_refined(
        &mut self,
        c: u32,
        triangle: &[[f64; 2]; 3],
        cuts: &[f64],
        times: u32,
    ) {
        if times == 0 {
            return self.add(c, triangle, cuts);
        }
        let [p, q, r] = *triangle;
        let middle = |a: [f64; 2], b: [f64; 2]| [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
        let (pq, qr, rp) = (middle(p, q), middle(q, r), middle(r, p));
        for part in [[p, pq, rp], [pq, q, qr], [rp, qr, r], [pq, qr, rp]] {
            self.add_refined(c, &part, cuts, times - 1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_jump_across_a_vertical_line_is_integrated_exactly() {
        let triangle = [[0.2, 0.1], [0.9, 0.3], [0.4, 0.8]];
        let field = |x: f64, y: f64| if x < 0.55 { 1.0 + x * y } else { x - 3.0 * y * y };
        let sum = |cuts: &[f64], times: u32| {
            let mut rule = CellPoints::default();
            rule.add_refined(0, &triangle, cuts, times);
            let values = rule.points.iter().zip(&rule.weights);
            values.map(|(p, w)| w * field(p[0], p[1])).sum::<f64>()
        };
        let (once, refined) = (sum(&[0.55], 0), sum(&[0.55], 3));
        assert!((once - refined).abs() < 1e-15, "{:e}", once - refined);
        // Without the cut the rule is off.
        assert!((sum(&[], 0) - once).abs() > 1e-4);
        let area: f64 = {
            let mut rule = CellPoints::default();
            rule.add(0, &triangle, &[]);
            rule.weights.iter().sum()
        };
        assert!((area - 0.5 * (0.7 * 0.7 - 0.2 * 0.2)).abs() < 1e-15);
    }
}
