//! Quadrature over a domain of coarse simplices.

use fem::mesh::{CoarseMesh, Family, Mesh};
use fem::space::quadrature::{Rule, tetrahedron_product};

/// Least and most points per direction, least number of tetrahedra, and approximate total of points: 8 points along
/// half of the domain as in a box, fewer in each of many tetrahedra.
const IN_SPACE: [usize; 2] = [3, 8];
const TETRAHEDRA: usize = 48;
const WORK: f64 = 3e4;

/// Points of the simplices of a refined domain, with weights that sum to its measure. Rules are in barycentric
/// coordinates, so that they follow rotations of the domain.
pub(super) struct SimplexPoints {
    pub points: Vec<[f64; 3]>,
    pub weights: Vec<f64>,
}

impl SimplexPoints {
    /// Points in a polyhedron that resolve smooth fields to rounding; two more per direction in the finer rule. A field
    /// with kinks is integrated only to the square of the size of these simplices; `check` reports it.
    pub(crate) fn in_space(coarse: &CoarseMesh, finer: bool) -> Self {
        let mesh = parts(coarse, TETRAHEDRA);
        let count = points_a_direction(mesh.cell_count(), WORK) + if finer { 2 } else { 0 };
        Self::of(&mesh, &tetrahedron_product(count))
    }

    pub(crate) fn of(mesh: &Mesh, rule: &Rule) -> Self {
        let weights = |c| {
            let measure = measure(mesh, c);
            rule.weights.iter().map(move |weight| weight * measure)
        };
        Self {
            points: mesh.points_of(&mesh.cells(), &rule.points),
            weights: (0..mesh.cell_count()).flat_map(weights).collect(),
        }
    }
}

/// Gauss points per direction in each of so many tetrahedra, for about `work` points in all.
pub(super) fn points_a_direction(cells: usize, work: f64) -> usize {
    ((work / cells as f64).cbrt() as usize).clamp(IN_SPACE[0], IN_SPACE[1])
}

/// A refinement of the domain with at least so many simplices.
pub(super) fn parts(coarse: &CoarseMesh, simplices: usize) -> Mesh {
    let share = simplices as f64 / coarse.count() as f64;
    let root = if coarse.dimension == 2 { share.sqrt() } else { share.cbrt() };
    // The cube root of a cube may round up.
    coarse.refined((root - 1e-9).ceil().max(1.0) as u32, Family::Structured)
}

/// |K| of a simplex.
pub(super) fn measure(mesh: &Mesh, c: usize) -> f64 {
    let corners = mesh.cell(c);
    let edge = |a: usize| {
        let (p, q) = (mesh.vertex(corners[0]), mesh.vertex(corners[a]));
        [0, 1, 2].map(|i| if i < mesh.dimension { q[i] - p[i] } else { 0.0 })
    };
    let (p, q) = (edge(1), edge(2));
    if mesh.dimension == 2 {
        return 0.5 * (p[0] * q[1] - p[1] * q[0]);
    }
    let r = edge(3);
    let cross = |i: usize| q[(i + 1) % 3] * r[(i + 2) % 3] - q[(i + 2) % 3] * r[(i + 1) % 3];
    (0..3).map(|i| p[i] * cross(i)).sum::<f64>() / 6.0
}
