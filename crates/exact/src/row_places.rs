//! The points of a rule in the columns and rows of a mesh, those with the same abscissae together.

use super::rows::{CORNERS, HALVES, Rows, width};
use fem::space::quadrature::{Rule, triangle_product};

/// Abscissae of two points are one if they differ by rounding: by no more than this share of the column's width and of
/// themselves.
pub const SAME_ABSCISSA: f64 = 1e-14;

/// Rules for the two halves of all squares, of the degree of `rule`, with as few abscissae as they can have.
///
/// Where a half has a side along y these are Gauss points of its column, and Gauss points on the chord above each, so
/// that the other half has the same: 4 in a column for degree 6, where a rule that is symmetric in the corners has 14.
/// Fields of (x, t) are evaluated at abscissae alone.
pub(crate) fn rules_of_halves(rows: &Rows, rule: &Rule) -> [Rule; HALVES] {
    let degree = rule.degree();
    rows.x.each_ref().map(|corners| {
        // One point more than for functions of x alone: chords are linear in x.
        let count = degree / 2 + 1;
        let fewer = count < Places::new(corners, rule).count();
        match alone(corners).filter(|_| fewer) {
            Some(corner) => collapsed_at(corner, count),
            None => rule.clone(),
        }
    })
}

/// The corner opposite to a side along y, if it is the same in all columns.
fn alone(corners: &[[f64; CORNERS]]) -> Option<usize> {
    let is_alone = |a: &usize| {
        let [b, c] = [(a + 1) % CORNERS, (a + 2) % CORNERS];
        corners.iter().all(|x| x[b].to_bits() == x[c].to_bits())
    };
    (0..CORNERS).find(is_alone)
}

/// The product rule whose chords end in a corner.
fn collapsed_at(corner: usize, count: usize) -> Rule {
    let mut rule = triangle_product(count);
    for point in &mut rule.points {
        // It is made with chords that shrink towards its second corner.
        point.rotate_right((corner + CORNERS - 1) % CORNERS);
    }
    rule
}

/// Points of a rule by their abscissae: in a triangle with a side along y several share one, in every column.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Places {
    /// The place of each point.
    pub of: Vec<usize>,
    /// The abscissae, of one place after the other in all columns.
    pub x: Vec<f64>,
    /// The weights of the points at each.
    pub weights: Vec<f64>,
}

impl Places {
    /// The places of the points of `rule`, in columns where the corners have the given abscissae.
    pub(crate) fn new(corners: &[[f64; CORNERS]], rule: &Rule) -> Self {
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

    /// The number of places.
    pub(crate) fn count(&self) -> usize {
        self.weights.len()
    }
}

/// The points of a rule in all columns or rows, one point of the rule after the other.
pub(crate) fn at_points(corners: &[[f64; CORNERS]], rule: &Rule) -> Vec<f64> {
    let at = |b: &[f64], corner: &[f64; CORNERS]| b.iter().zip(corner).map(|(b, x)| b * x).sum();
    rule.points.iter().flat_map(|b| corners.iter().map(|corner| at(b, corner))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use fem::mesh::{Family, rectangle};
    use fem::space::quadrature::{triangle_degree_4, triangle_degree_6, triangle_degree_8};

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

    /// The distinct ones of some numbers of order one, up to rounding.
    fn distinct(all: impl Iterator<Item = f64>) -> Vec<f64> {
        let mut all: Vec<f64> = all.collect();
        all.sort_by(f64::total_cmp);
        all.dedup_by(|next, own| *next - *own < 1e-14);
        all
    }

    /// Gauss points of the columns, the same in both halves, in place of 7 or more in each; degrees and means of
    /// polynomials are as they were.
    #[test]
    fn halves_with_a_side_along_y_share_gauss_points() {
        let rows = Rows::of(&rectangle([0.7, 1.0], 3, Family::Structured)).expect("rows");
        for (rule, degree, count) in
            [(triangle_degree_4(), 4, 3), (triangle_degree_6(), 6, 4), (triangle_degree_8(), 8, 5)]
        {
            let rules = rules_of_halves(&rows, &rule);
            let places = [0, 1].map(|half| Places::new(&rows.x[half], &rules[half]));
            let all = places.iter().flat_map(|own| own.x.iter().copied());
            assert_eq!(distinct(all).len(), count * rows.columns, "degree {degree}");
            for half in 0..HALVES {
                assert_eq!(rules[half].degree(), degree);
                let own = Places::new(&rows.x[half], &rule);
                assert!(own.count() > count && places[half].count() == count);
                // The mean of x^(degree - 2) y^2 over a cell, which a rule of another half has not.
                let mean = |rule: &Rule| -> f64 {
                    let at = |all: &[[f64; CORNERS]]| at_points(&all[..1], rule);
                    let points = at(&rows.x[half]).into_iter().zip(at(&rows.y[half]));
                    let values = points.zip(&rule.weights);
                    values.map(|((x, y), w)| w * x.powi(degree as i32 - 2) * y * y).sum()
                };
                let off = mean(&rules[half]) / mean(&rule) - 1.0;
                assert!(off.abs() < 1e-13, "degree {degree}, half {half}: {off:e}");
            }
        }
    }

    /// A rule of few points has as few abscissae; a half with no side along y has no chords.
    #[test]
    fn other_halves_keep_their_rule() {
        let centroid = Rule { points: vec![vec![1.0 / 3.0; 3]], weights: vec![1.0] };
        let mut rows = Rows::of(&rectangle([1.0, 1.0], 2, Family::Structured)).expect("rows");
        assert_eq!(rules_of_halves(&rows, &centroid), [centroid.clone(), centroid]);
        rows.x[1] = vec![[0.0, 0.2, 0.5], [0.5, 0.7, 1.0]];
        let rule = triangle_degree_6();
        let [upright, slanted] = rules_of_halves(&rows, &rule);
        assert!(upright != rule && slanted == rule);
    }
}
