//! How well shaped the cells of a mesh are.

use super::Mesh;
use super::geometry::{cross, dot, longest_edge, minus, norm};

/// Extremes over the cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quality {
    /// Smallest angle of a triangle, smallest dihedral angle of a tetrahedron, in degrees.
    pub smallest_angle: f64,
    /// Largest ratio of a cell's longest edge to its smallest altitude: 2/√3 for an equilateral
    /// triangle, 2 for a right isosceles one.
    pub aspect: f64,
    /// The longest edge h_max.
    pub longest: f64,
    /// The shortest of the cells' longest edges, h_min.
    pub shortest: f64,
}

impl Mesh {
    /// The quality of the cells.
    pub fn quality(&self) -> Quality {
        let start =
            Quality { smallest_angle: 180.0, aspect: 0.0, longest: 0.0, shortest: f64::INFINITY };
        (0..self.cell_count()).fold(start, |worst, c| {
            let corners: Vec<_> = (0..=self.dimension).map(|a| self.corner(c, a)).collect();
            let (longest, angle) = (longest_edge(&corners), self.smallest_angle(c));
            Quality {
                smallest_angle: worst.smallest_angle.min(angle),
                aspect: worst.aspect.max(longest / self.smallest_altitude(c)),
                longest: worst.longest.max(longest),
                shortest: worst.shortest.min(longest),
            }
        })
    }

    fn corner(&self, c: usize, a: usize) -> [f64; 3] {
        self.point(&[self.cell(c)[a]], &[1.0])
    }

    /// Gradients of the barycentric coordinates times d! |K|: inward normals of the facets, as long as
    /// the facets are large; and d! |K|.
    pub(crate) fn inward(&self, c: usize) -> (Vec<[f64; 3]>, f64) {
        let at = |a: usize| self.corner(c, a);
        if self.dimension == 2 {
            let [p, q] = [minus(at(1), at(0)), minus(at(2), at(0))];
            let turned = |v: [f64; 3]| [-v[1], v[0], 0.0];
            let normals = [minus(at(2), at(1)), minus(at(0), at(2)), p].map(turned);
            return (normals.to_vec(), p[0] * q[1] - p[1] * q[0]);
        }
        let [p, q, r] = [1, 2, 3].map(|a| minus(at(a), at(0)));
        let others = [cross(q, r), cross(r, p), cross(p, q)];
        let first = [0, 1, 2].map(|i: usize| -others.iter().map(|v| v[i]).sum::<f64>());
        let volume = dot(p, others[0]);
        (vec![first, others[0], others[1], others[2]], volume)
    }

    pub(super) fn smallest_altitude(&self, c: usize) -> f64 {
        let (normals, measure) = self.inward(c);
        measure / normals.into_iter().map(norm).fold(0.0, f64::max)
    }

    fn smallest_angle(&self, c: usize) -> f64 {
        let (normals, _) = self.inward(c);
        let mut smallest = 180.0f64;
        for (a, p) in normals.iter().enumerate() {
            for q in &normals[..a] {
                let cosine = -dot(*p, *q) / (norm(*p) * norm(*q));
                smallest = smallest.min(cosine.clamp(-1.0, 1.0).acos().to_degrees());
            }
        }
        smallest
    }
}

#[cfg(test)]
mod tests {
    use crate::mesh::{Family, lattice};

    fn close(a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-12 * b
    }

    #[test]
    fn right_isosceles_triangles_and_kuhn_tetrahedra() {
        let plane = lattice([2.0, 1.0], 4, Family::Structured).quality();
        assert!(close(plane.smallest_angle, 45.0) && close(plane.aspect, 2.0), "{plane:?}");
        assert!(close(plane.longest, 2f64.sqrt() / 4.0) && close(plane.shortest, plane.longest));
        // Kuhn's tetrahedra: dihedral angles 45°, 60°, 90°; edges 1, √2, √3; altitude 1/√2.
        let space = lattice([1.0; 3], 2, Family::Structured).quality();
        assert!(close(space.smallest_angle, 45.0) && close(space.aspect, 6f64.sqrt()), "{space:?}");
    }

    #[test]
    fn grading_and_perturbation_show() {
        let graded = Family::Graded { corner: [0.0, 0.0], exponent: 2.0 };
        let graded = lattice([1.0, 1.0], 4, graded).quality();
        // From (1/4)² to 1 - (3/4)² and its diagonal.
        assert!(graded.longest / graded.shortest > 4.0, "{graded:?}");
        let moved = Family::Perturbed { amplitude: 0.2, seed: 1, axes: [true; 3] };
        let moved = lattice([1.0, 1.0], 4, moved).quality();
        assert!(moved.smallest_angle < 45.0 && moved.aspect > 2.0);
    }

    #[test]
    fn graded_rectangles_are_tiled_from_every_corner() {
        for size in [[1.0, 1.0], [2.0, 1.0], [1.0, 3.0]] {
            for corner in [[0.0, 0.0], [size[0], 0.0], [size[0], size[1]], [0.0, size[1]]] {
                for exponent in [1.5, 2.0, 4.0] {
                    let mesh = lattice(size, 6, Family::Graded { corner, exponent });
                    let measure = |c: usize| mesh.inward(c).1 / 2.0;
                    let areas: Vec<f64> = (0..mesh.cell_count()).map(measure).collect();
                    assert!(areas.iter().all(|a| *a > 0.0), "{corner:?} {exponent}");
                    assert!(close(areas.iter().sum(), size[0] * size[1]));
                }
            }
        }
    }
}
