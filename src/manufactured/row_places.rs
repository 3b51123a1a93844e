//! The points of a rule in the columns and rows of a mesh, those with the same abscissae together.

use super::rows::{CORNERS, width};
use crate::space::quadrature::Rule;

/// Abscissae of two points are one if they differ by rounding: by no more than this share of the column's width and of
/// themselves.
const SAME_ABSCISSA: f64 = 1e-14;

/// Points of a rule by their abscissae: in a triangle with a side along y several share one, in every column.
#[derive(Debug, Clone, PartialEq)]
pub struct Places {
    /// Of each point.
    pub of: Vec<usize>,
    /// The abscissae, of one place after the other in all columns.
    pub x: Vec<f64>,
    /// The weights of the points at each.
    pub weights: Vec<f64>,
}

impl Places {
    /// Those of the points of `rule` in columns where the corners have the given abscissae.
    pub fn new(corners: &[[f64; CORNERS]], rule: &Rule) -> Self {
        let columns = corners.len();
        let mut places = Self { of: Vec::new(), x: Vec::new(), weights: Vec::new() };
        let all = at_points(corners, rule);
        for (own, weight) in all.chunks_exact(columns).zip(&rule.weights) {
            let same = |known: &[f64]| {
                let mut pairs = known.iter().zip(own).zip(corners);
                pairs.all(|((a, b), corners)| {
                    (a - b).abs() <= SAME_ABSCISSA * (width(corners) + a.abs())
                })
            };
            let place = places.x.chunks_exact(columns).position(same).unwrap_or_else(|| {
                places.x.extend_from_slice(own);
                places.weights.push(0.0);
                places.weights.len() - 1
            });
            places.weights[place] += weight;
            places.of.push(place);
        }
        places
    }

    /// How many.
    pub fn count(&self) -> usize {
        self.weights.len()
    }
}

/// The points of a rule in all columns or rows, one point of the rule after the other.
pub fn at_points(corners: &[[f64; CORNERS]], rule: &Rule) -> Vec<f64> {
    let at = |b: &[f64], corner: &[f64; CORNERS]| b.iter().zip(corner).map(|(b, x)| b * x).sum();
    rule.points.iter().flat_map(|b| corners.iter().map(|corner| at(b, corner))).collect()
}

#[cfg(test)]
mod tests {
    use super::super::rows::Rows;
    use super::*;
    use crate::mesh::{Family, rectangle};
    use crate::space::quadrature::triangle_degree_6;

    /// In a triangle with a side along y the 12 points of degree 6 have 7 abscissae: two orbits of three points have two,
    /// that of six has three. With no such side all differ.
    #[test]
    fn points_above_each_other_share_a_place() {
        let rule = triangle_degree_6();
        let columns = |size: [f64; 2], n: u32| {
            Rows::of(&rectangle(size, n, Family::Structured)).expect("rows").x
        };
        let upright = columns([0.7, 1.0], 3);
        // Abscissae far larger than the widths of their columns.
        let many = columns([2.0, 0.1], 600);
        let slanted = vec![[0.0, 0.3, 1.0], [1.0, 1.3, 2.0]];
        for (corners, count) in
            [(&upright[0], 7), (&upright[1], 7), (&many[0], 7), (&many[1], 7), (&slanted, 12)]
        {
            let places = Places::new(corners, &rule);
            assert_eq!(places.count(), count);
            assert!((places.weights.iter().sum::<f64>() - 1.0).abs() < 1e-15);
            let (all, columns) = (at_points(corners, &rule), corners.len());
            for (q, place) in places.of.iter().enumerate() {
                for i in 0..columns {
                    let away = all[columns * q + i] - places.x[columns * place + i];
                    assert!(away.abs() <= 1e-15, "point {q}, column {i}: {away:e}");
                }
            }
        }
    }
}
