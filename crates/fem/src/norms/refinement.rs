//! Where the simplices of a finer, nested mesh lie in a coarser one.

use rustc_hash::FxHashMap;

use super::moments::facet_samples;
use crate::contact::Discretization;
use crate::mesh::Mesh;
use crate::mesh::geometry::{minus, norm};
use crate::space::Element;

/// Why a reference cannot serve.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ReferenceError {
    #[error(
        "the reference mesh (n = {fine}) is not a refinement of n = {coarse}: choose a multiple"
    )]
    NotNested { coarse: u32, fine: u32 },
    /// The time is not one of the reference's.
    #[error("the reference run has no step at t = {t}: its steps must be a multiple of the case's")]
    NoSuchTime { t: f64 },
}

/// How far a vertex may lie outside the simplex that holds it, in barycentric coordinates and in lengths
/// of the first edge: rounding of vertex positions over a cell, far below any distance that is meant.
const INSIDE: f64 = 1e-6;

/// Parents of the cells and facets of a finer mesh.
pub struct Refinement {
    /// The fine cells in the coarse ones.
    pub(super) cells: Parents,
    /// The fine facets of Γ3 in the coarse ones.
    pub(super) facets: Parents,
    /// For each sample of each coarse facet, the points of the fine trace between which it lies.
    pub(super) sample_members: Vec<Vec<u32>>,
}

/// The coarse simplex that holds each fine one, and where.
pub(super) struct Parents {
    /// The parent of each fine simplex.
    pub(super) of: Vec<u32>,
    /// Of each fine simplex the values of the hat functions of its parent at its corners, those of one function one
    /// after the other.
    pub(super) hats: Vec<f64>,
    /// Of each fine simplex at each point of the rule for squares of the element the functions of the element on its parent.
    pub(super) shapes: Vec<f64>,
    /// Corners of a simplex.
    pub(super) corners: usize,
}

/// Room for the corners of a tetrahedron.
const MOST_CORNERS: usize = 4;

/// The barycentric coordinates in the parent of a place in a fine simplex, by the hats of the parent at its corners.
pub(super) fn in_parent(hats: &[f64], in_fine: &[f64]) -> [f64; MOST_CORNERS] {
    let mut place = [0.0; MOST_CORNERS];
    for (b, hat) in place.iter_mut().zip(hats.chunks_exact(in_fine.len())) {
        *b = hat.iter().zip(in_fine).map(|(hat, b)| hat * b).sum();
    }
    place
}

impl Parents {
    /// None where a fine simplex lies in no coarse one.
    fn new(coarse: &Simplices, element: Element, mesh: &Mesh, fine: &[Vec<u32>]) -> Option<Self> {
        let of = fine.iter().map(|simplex| coarse.holding(mesh, simplex));
        let of: Vec<u32> = of.collect::<Option<_>>()?;
        let corners = fine.first().map_or(0, Vec::len);
        let mut hats = Vec::with_capacity(corners * corners * of.len());
        for (simplex, &parent) in fine.iter().zip(&of) {
            let at = |v: &u32| coarse.barycentric(parent as usize, &mesh.point(&[*v], &[1.0]));
            let at: Vec<[f64; 4]> = simplex.iter().map(at).collect();
            hats.extend((0..corners).flat_map(|a| at.iter().map(move |b| b[a])));
        }
        let places = if of.is_empty() { Vec::new() } else { element.square_rule(corners).points };
        let of_simplex = |hats| {
            let at = move |b: &Vec<f64>| element.values(&in_parent(hats, b)[..corners]);
            places.iter().flat_map(at)
        };
        let shapes = hats.chunks_exact((corners * corners).max(1)).flat_map(of_simplex).collect();
        Some(Self { of, hats, shapes, corners })
    }

    /// The hats of the parent of fine simplex s at its corners.
    pub(super) fn hats_of(&self, s: usize) -> &[f64] {
        let count = self.corners * self.corners;
        &self.hats[count * s..count * (s + 1)]
    }
}

impl Refinement {
    /// Finds all parents.
    ///
    /// # Errors
    /// A fine cell or facet that lies in no coarse one.
    pub(crate) fn new(
        fine: &Discretization,
        coarse: &Discretization,
    ) -> Result<Self, ReferenceError> {
        let refused = ReferenceError::NotNested { coarse: coarse.mesh.n, fine: fine.mesh.n };
        let all_cells = |mesh: &Mesh| -> Vec<Vec<u32>> {
            (0..mesh.cell_count()).map(|c| mesh.cell(c).to_vec()).collect()
        };
        let all_facets = |space: &Discretization| -> Vec<Vec<u32>> {
            let facets = space.trace.mesh_facet.iter();
            facets.map(|&f| space.mesh.facet(f as usize).to_vec()).collect()
        };
        let fine_facets = all_facets(fine);
        let parents = |simplices: &[Vec<u32>], fine_simplices: &[Vec<u32>]| {
            let (element, coarse) = (coarse.element, Simplices::new(&coarse.mesh, simplices));
            Parents::new(&coarse, element, &fine.mesh, fine_simplices).ok_or(refused.clone())
        };
        let cells = parents(&all_cells(&coarse.mesh), &all_cells(&fine.mesh))?;
        let facets = parents(&all_facets(coarse), &fine_facets)?;
        let on_boundary = Simplices::new(&fine.mesh, &fine_facets);
        let mut children: Vec<Vec<u32>> = vec![Vec::new(); coarse.trace.mesh_facet.len()];
        for (f, &parent) in facets.of.iter().enumerate() {
            children[parent as usize].push(f as u32);
        }
        let mut sample_members = Vec::new();
        for (f, children) in children.iter().enumerate() {
            let corners = coarse.mesh.facet(coarse.trace.mesh_facet[f] as usize);
            for b in facet_samples(coarse.mesh.dimension) {
                let x = coarse.mesh.point(corners, &b);
                let Some((child, at)) = on_boundary.nearest(&x, children.iter().copied()) else {
                    return Err(refused);
                };
                let members = fine.trace.facet(child as usize).iter().zip(at);
                let near = members.filter(|(_, b)| *b > INSIDE).map(|(&member, _)| member);
                sample_members.push(near.collect());
            }
        }
        Ok(Self { cells, facets, sample_members })
    }
}

/// Simplices of a mesh that can be searched for a point.
struct Simplices {
    corners: Vec<Vec<[f64; 3]>>,
    /// For each simplex the vectors g_a with λ_a(x) = g_a · (x - x_0), a ≥ 1.
    dual: Vec<Vec<[f64; 3]>>,
    /// Simplices by the boxes of a grid of this width that they meet.
    boxes: FxHashMap<[i64; 3], Vec<u32>>,
    width: f64,
}

impl Simplices {
    fn new(mesh: &Mesh, simplices: &[Vec<u32>]) -> Self {
        let corners: Vec<Vec<[f64; 3]>> = simplices
            .iter()
            .map(|simplex| simplex.iter().map(|&v| mesh.point(&[v], &[1.0])).collect())
            .collect();
        let dual = corners.iter().map(|corners| dual(corners)).collect();
        let longest = |corners: &Vec<[f64; 3]>| {
            corners[1..].iter().map(|x| norm(minus(*x, corners[0]))).fold(0.0, f64::max)
        };
        let width = corners.iter().map(longest).fold(f64::MIN_POSITIVE, f64::max);
        let mut boxes: FxHashMap<[i64; 3], Vec<u32>> = FxHashMap::default();
        for (s, corners) in corners.iter().enumerate() {
            let end = |i: usize, pick: fn(f64, f64) -> f64, away: f64| {
                let values = corners.iter().map(|x| x[i]);
                values.reduce(pick).map_or(0, |x| ((x + away) / width).floor() as i64)
            };
            let range =
                |i: usize| end(i, f64::min, -INSIDE * width)..=end(i, f64::max, INSIDE * width);
            for x in range(0) {
                for y in range(1) {
                    for z in range(2) {
                        boxes.entry([x, y, z]).or_default().push(s as u32);
                    }
                }
            }
        }
        Self { corners, dual, boxes, width }
    }

    /// Barycentric coordinates of a point in simplex s, one a corner.
    fn barycentric(&self, s: usize, x: &[f64; 3]) -> [f64; 4] {
        let origin = &self.corners[s][0];
        let mut out = [0.0; 4];
        for (b, g) in out[1..].iter_mut().zip(&self.dual[s]) {
            *b = (0..3).map(|i| g[i] * (x[i] - origin[i])).sum();
        }
        out[0] = 1.0 - out[1..].iter().sum::<f64>();
        out
    }

    /// Of some simplices the one that holds a point best, if one holds it, with the coordinates in it.
    fn nearest(&self, x: &[f64; 3], among: impl Iterator<Item = u32>) -> Option<(u32, [f64; 4])> {
        let inside = |s: u32| {
            let b = self.barycentric(s as usize, x);
            let mut off = *x;
            for (corner, b) in self.corners[s as usize].iter().zip(&b) {
                off.iter_mut().zip(corner).for_each(|(off, c)| *off -= b * c);
            }
            let away = norm(off) / self.width;
            let corners = self.corners[s as usize].len();
            let depth = b[..corners].iter().copied().fold(f64::INFINITY, f64::min) - away;
            (depth, s, b)
        };
        let best = among.map(inside).max_by(|a, b| a.0.total_cmp(&b.0))?;
        (best.0 >= -INSIDE).then_some((best.1, best.2))
    }

    /// The simplex that holds all corners of a simplex of another mesh.
    fn holding(&self, mesh: &Mesh, simplex: &[u32]) -> Option<u32> {
        let share = 1.0 / simplex.len() as f64;
        let centre = mesh.point(simplex, &vec![share; simplex.len()]);
        let key = centre.map(|x| (x / self.width).floor() as i64);
        let (parent, _) = self.nearest(&centre, self.boxes.get(&key)?.iter().copied())?;
        let corners = simplex.iter().map(|&v| mesh.point(&[v], &[1.0]));
        let all = corners.map(|x| self.nearest(&x, std::iter::once(parent)));
        all.into_iter().all(|found| found.is_some()).then_some(parent)
    }
}

/// The g_a of a simplex in its plane: dual to its edges from the first corner. By products of edges in units of the longest;
/// by Gram's matrix flat simplices would lose all digits.
fn dual(corners: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let edges = corners[1..].iter().map(|&x| nalgebra::Vector3::from(minus(x, corners[0])));
    let unit = edges.clone().map(|edge| edge.amax()).fold(f64::MIN_POSITIVE, f64::max);
    let edges: Vec<_> = edges.map(|edge| edge / unit).collect();
    let dual = match edges[..] {
        [a] => vec![a / a.norm_squared()],
        [a, b] => {
            let normal = a.cross(&b);
            [b.cross(&normal), normal.cross(&a)].map(|g| g / normal.norm_squared()).to_vec()
        }
        [a, b, c] => {
            let content = a.dot(&b.cross(&c));
            [b.cross(&c), c.cross(&a), a.cross(&b)].map(|g| g / content).to_vec()
        }
        _ => Vec::new(),
    };
    dual.into_iter().map(|g| (g / unit).into()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{CoarseMesh, Family, lattice, triangulate};

    fn space(mesh: Mesh) -> Discretization {
        let sides = ["top", "bottom"].map(|name| mesh.side(name).expect("a side"));
        Discretization::new(mesh, &sides[..1], &sides[1..])
    }

    fn structured(dimension: usize, n: u32) -> Discretization {
        space(match dimension {
            2 => lattice([1.0, 0.5], n, Family::Structured),
            _ => lattice([1.0, 0.5, 1.0], n, Family::Structured),
        })
    }

    #[test]
    fn parents_share_their_measure_among_their_children() {
        for d in [2, 3] {
            let (fine, coarse) = (structured(d, 6), structured(d, 2));
            let found = Refinement::new(&fine, &coarse).expect("a refinement");
            let mut left = coarse.geometry.measure.clone();
            for (c, &parent) in found.cells.of.iter().enumerate() {
                left[parent as usize] -= fine.geometry.measure[c];
            }
            // 27 roundings of numbers below 1.
            assert!(left.iter().all(|rest| rest.abs() < 1e-14), "{d}");
            let mut left = coarse.trace.measure.clone();
            for (f, &parent) in found.facets.of.iter().enumerate() {
                left[parent as usize] -= fine.trace.measure[f];
            }
            assert!(left.iter().all(|rest| rest.abs() < 1e-14), "{d}");
        }
    }

    #[test]
    fn meshes_that_are_not_nested_are_refused() {
        for d in [2, 3] {
            assert!(Refinement::new(&structured(d, 6), &structured(d, 4)).is_err());
        }
        let family = Family::Perturbed { amplitude: 0.1, seed: 3, axes: [true; 3] };
        let moved = space(lattice([1.0, 0.5, 1.0], 8, family));
        assert!(Refinement::new(&moved, &structured(3, 4)).is_err());
    }

    /// Flat cells have children as others do, and measures that are products of their edges.
    #[test]
    fn flat_domains_nest() {
        let flat = |n: u32| {
            let vertices = [[0.0, 0.0], [1.0, 0.0], [1.0, 1e-9], [0.0, 1e-9]];
            let names = (0..4).map(|i| format!("s{i}")).collect();
            let triangles = [[0, 1, 2], [0, 2, 3]];
            let coarse = CoarseMesh::polygon(&vertices, &triangles, &[0, 1, 2, 3], names);
            Discretization::new(
                coarse.expect("a domain").refined(n, Family::Structured),
                &[2],
                &[0],
            )
        };
        let (fine, coarse) = (flat(8), flat(2));
        let found = Refinement::new(&fine, &coarse).expect("a refinement");
        let mut left = coarse.geometry.measure.clone();
        for (c, &parent) in found.cells.of.iter().enumerate() {
            left[parent as usize] -= fine.geometry.measure[c];
        }
        // 16 children of 2^-8 1e-9 each, to rounding of vertices of size 1e-9.
        assert!(left.iter().all(|rest| rest.abs() < 1e-22), "{left:?}");
    }

    /// An L with contact on the two sides that meet in its reentrant corner.
    fn l_shape(n: u32, family: Family) -> Discretization {
        let vertices = vec![[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
        let triangles = triangulate(&vertices).expect("a polygon");
        let names = (0..6).map(|i| format!("s{i}")).collect();
        let sides = [0, 1, 2, 3, 4, 5];
        let coarse = CoarseMesh::polygon(&vertices, &triangles, &sides, names).expect("a domain");
        let mesh = coarse.refined(n, family);
        Discretization::new(mesh, &[0], &[2, 3])
    }

    #[test]
    fn refined_polygons_nest_and_moved_ones_do_not() {
        let of = |n: u32| l_shape(n, Family::Structured);
        let (fine, coarse) = (of(6), of(2));
        let found = Refinement::new(&fine, &coarse).expect("a refinement");
        for (f, &parent) in found.facets.of.iter().enumerate() {
            // On the side of its parent: the corner has a point on each.
            let side = |space: &Discretization, f: usize| {
                space.mesh.facet_side[space.trace.mesh_facet[f] as usize]
            };
            assert_eq!(side(&fine, f), side(&coarse, parent as usize));
        }
        assert!(Refinement::new(&of(5), &coarse).is_err());
        let perturbed = Family::Perturbed { amplitude: 0.1, seed: 3, axes: [true; 3] };
        let graded = Family::Graded { corner: [1.0, 1.0], exponent: 2.5 };
        for family in [perturbed, graded] {
            assert!(Refinement::new(&l_shape(6, family), &coarse).is_err(), "{family:?}");
        }
    }
}
