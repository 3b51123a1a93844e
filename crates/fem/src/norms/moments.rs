//! A field reduced to what the distance to discrete ones needs.
//!
//! On a cell the discrete strain and stress are polynomials, of degree zero for P1, given by their values at the strain
//! points, and the discrete displacement is one of the element.
//! For any field f and its L² projection Πf onto that space, ‖f - f_h‖² = ‖f - Πf‖² + ‖Πf - f_h‖²
//! with the same quadrature in every term. So the quadrature of the truth is done once a mesh and
//! time, and each case pays a few operations per cell, without cancellation.

/// L² projection of a tensor field onto the strains of an element, cell means for P1, and the squared distance to it.
#[derive(Debug, Clone, Default)]
pub struct AtPoints {
    /// Its values at the strain points, S numbers each (Mandel).
    pub at: Vec<f64>,
    /// Σ_K ∫_K |f - Πf|².
    pub rest: f64,
}

/// L² projection of a field onto the functions of the element on cells or facets, by its values at their nodes.
#[derive(Debug, Clone, Default)]
pub struct Piecewise {
    /// Values at the nodes of each simplex, all components of a node together.
    pub node: Vec<f64>,
    /// Σ ∫ |f - Πf|².
    pub rest: f64,
}

/// The truth at one time on one mesh.
#[derive(Debug, Clone, Default)]
pub struct Moments {
    /// ε(u).
    pub strain: AtPoints,
    /// σ.
    pub stress: AtPoints,
    /// u.
    pub displacement: Piecewise,
    /// u_ν on the facets of Γ3.
    pub normal: Piecewise,
    /// ξ + λ on the facets of Γ3.
    pub pressure: Piecewise,
    /// Whether u_ν = g, at the [`facet_samples`] of each facet of Γ3.
    pub locked: Vec<bool>,
}

/// Intervals into which an edge, and the edges of a triangle, are divided when contact sets are compared.
const SAMPLES: [usize; 2] = [8, 4];

/// Barycentric coordinates of the points of a facet with `corners` vertices at which contact sets are
/// compared: equidistant along its edges, the corners among them.
pub fn facet_samples(corners: usize) -> Vec<Vec<f64>> {
    let [along, across] = SAMPLES;
    if corners == 2 {
        let at = |s: usize| s as f64 / along as f64;
        return (0..=along).map(|s| vec![1.0 - at(s), at(s)]).collect();
    }
    let at = |s: usize| s as f64 / across as f64;
    let row = |j: usize| (0..=across - j).map(move |i| vec![at(across - i - j), at(i), at(j)]);
    (0..=across).flat_map(row).collect()
}

/// Hausdorff distance of two sets of samples, given by flags on the same points. Both empty: 0;
/// one of them: `diameter`.
pub fn hausdorff(points: &[[f64; 3]], a: &[bool], b: &[bool], diameter: f64) -> f64 {
    let select = |flags: &[bool]| -> Vec<[f64; 3]> {
        points.iter().zip(flags).filter(|(_, flag)| **flag).map(|(p, _)| *p).collect()
    };
    let (set_a, set_b) = (select(a), select(b));
    match (set_a.is_empty(), set_b.is_empty()) {
        (true, true) => return 0.0,
        (true, false) | (false, true) => return diameter,
        _ => {}
    }
    let one_sided = |inside: &[bool], other: &[bool], set: &[[f64; 3]]| {
        let outside = points.iter().zip(inside.iter().zip(other)).filter(|(_, (o, t))| **o && !**t);
        outside.map(|(p, _)| nearest(p, set)).fold(0.0, f64::max)
    };
    one_sided(a, b, &set_b).max(one_sided(b, a, &set_a))
}

fn nearest(p: &[f64; 3], set: &[[f64; 3]]) -> f64 {
    let squared = |q: &[f64; 3]| (0..3).map(|i| (p[i] - q[i]).powi(2)).sum::<f64>();
    set.iter().map(squared).fold(f64::INFINITY, f64::min).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_of_a_facet_are_its_grid() {
        for (corners, count) in [(2, 9), (3, 15)] {
            let samples = facet_samples(corners);
            assert_eq!(samples.len(), count);
            assert!(samples.iter().all(|b| b.len() == corners && b.iter().sum::<f64>() == 1.0));
            let at_corner = samples.iter().filter(|b| b.contains(&1.0)).count();
            assert_eq!(at_corner, corners);
        }
    }

    #[test]
    fn hausdorff_of_intervals_is_the_distance_of_their_ends() {
        let points: Vec<[f64; 3]> = (0..11).map(|i| [f64::from(i) * 0.1, 0.0, 0.0]).collect();
        let set = |from: usize, to: usize| (0..11).map(|i| i >= from && i <= to).collect();
        let (a, b): (Vec<bool>, Vec<bool>) = (set(2, 8), set(3, 10));
        assert!((hausdorff(&points, &a, &b, 1.0) - 0.2).abs() < 1e-12);
        let empty = vec![false; 11];
        assert_eq!(hausdorff(&points, &a, &empty, 1.0), 1.0);
        assert_eq!(hausdorff(&points, &empty, &empty, 1.0), 0.0);
    }
}
