//! Sides by number, and their plane pieces.

use super::{Domain, Shape, place};
use crate::reading::Reading;
use crate::source::Result;
use fem::mesh::{CoarseMesh, Face, Piece};
use formula::{Effort, Extreme, Graph, Interval, Node, Place, Variable, largest};
use nalgebra::DMatrix;

/// A side by its position in [`super::Domain::sides`] and in `Mesh::sides`; those of a rectangle or box in the order x =
/// 0, x = size\[0\], y = 0, and so on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Side(pub u32);

impl Side {
    pub(crate) fn index(self) -> usize {
        self.0 as usize
    }
}

/// Names of the sides of a box; a rectangle has the first four.
pub(super) const OF_A_BOX: [&str; 6] = ["left", "right", "bottom", "top", "front", "back"];

/// Directions that differ by less are one.
pub(crate) const SAME_NORMAL: f64 = 1e-9;

/// The places with these shares of the edges of a piece, rounded outward; all of it for [0, 1] and [0, 1].
fn part(face: &Face, [a, b]: [Interval; 2]) -> [Interval; 3] {
    [0, 1, 2].map(|i| {
        let edge = |e: usize| face.edges.get(e).map_or(0.0, |edge| edge[i]);
        let along = a * Interval::point(edge(0));
        // A triangle is spanned by its first edge and the way from its end to that of the second.
        let across = match face.triangle {
            true => a * b * Interval::point(edge(1) - edge(0)),
            false => b * Interval::point(edge(1)),
        };
        Interval::point(face.corner[i]) + along + across
    })
}

/// A proved bound of `sign`·f on a piece, for f independent of time, and the place of the largest value met.
pub(crate) fn largest_on(face: &Face, graph: &Graph, f: Node, sign: f64) -> (Extreme<2>, [f64; 3]) {
    let mut f = graph.enclosing(f);
    let unit = Interval::new(0.0, 1.0);
    let second = if face.edges.len() == 2 { unit } else { Interval::point(0.0) };
    let sign = Interval::point(sign);
    let found = largest([unit, second], Effort::FORMULA, |&shares| {
        let axes = [Variable::X, Variable::Y, Variable::Z].into_iter().zip(part(face, shares));
        let place = axes.fold(Place::origin(), |place, (axis, range)| place.with(axis, range));
        let found = f.over(&place);
        if found.undefined { Interval::ALL } else { sign * found.range }
    });
    (found, part(face, found.at.map(Interval::point)).map(Interval::middle))
}

// Limit of contact conditions at a vertex.

/// |det| of unit normals below which they count as dependent, as in the frames of the unknowns.
const DEPENDENT: f64 = 1e-6;

/// Each condition u_ν ≤ g takes an unknown of its vertex, and so does u_ν = 0 on a plane of symmetry: at most d, along
/// independent normals. In the plane two contact edges meet, which is always possible; a bent contact side of tetrahedra has
/// a normal per face.
///
/// # Errors
/// The first vertex of Γ3 off Γ1 with too many normals.
pub(super) fn few_at_a_vertex(reading: &Reading, domain: &Domain) -> Result<()> {
    let Shape::Refined(coarse) = &domain.shape else { return Ok(()) };
    let mut around = vec![Vec::new(); coarse.vertices.len()];
    for facet in &coarse.facets {
        facet.corners.iter().for_each(|&v| around[v as usize].push(facet));
    }
    for (vertex, facets) in coarse.vertices.iter().zip(&around) {
        let on = |sides: &[Side]| -> Vec<[f64; 3]> {
            let listed = facets.iter().filter(|facet| sides.contains(&Side(facet.side)));
            listed.map(|facet| facet.normal).collect()
        };
        let (mut normals, mut across): (Vec<[f64; 3]>, Vec<[f64; 3]>) = Default::default();
        for normal in on(&domain.contact) {
            normals.extend((!normals.contains(&normal)).then_some(normal));
        }
        for normal in on(&domain.symmetry) {
            across.push(normal);
            if !independent(&across) {
                across.pop();
            }
        }
        let possible = coarse.dimension == 2 && across.is_empty();
        let clamped = !on(&domain.clamped).is_empty();
        if clamped
            || possible
            || normals.is_empty()
            || independent(&[&normals[..], &across].concat())
        {
            continue;
        }
        let at = place(&(*vertex).into(), coarse.dimension);
        let (key, message, hint) = match across.is_empty() {
            true => (
                "domain.contact",
                format!(
                    "{} faces of the contact sides with different normals meet at {at}: the conditions u_nu <= g there are not independent",
                    normals.len()
                ),
                "contact sides of tetrahedra must be plane: a bent side of many faces may be a traction side",
            ),
            false => (
                "domain.symmetry",
                format!(
                    "a contact side and a plane of symmetry meet at {at} along one line: u_nu = 0 and u_nu <= g there are not independent"
                ),
                "put a traction or clamped side between them, or let them meet at an angle",
            ),
        };
        return Err(reading.error(key, message, hint));
    }
    Ok(())
}

/// Number of rigid motions with u_ν = 0 on the planes of symmetry: what the rank of ν·r at the corners of each plane piece,
/// r the translations and rotations, leaves of d(d + 1)/2.
pub(super) fn rigid_motions_left(domain: &Domain) -> usize {
    let d = domain.dimension();
    let size = domain.size.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let faces: Vec<Face> = domain.held().into_iter().flat_map(|side| domain.faces(side)).collect();
    let mut rows: Vec<Vec<f64>> = Vec::new();
    for face in &faces {
        for p in face.points(1) {
            let (n, x) = (face.normal, [0, 1, 2].map(|i| (p[i] - faces[0].corner[i]) / size));
            let turn = |i: usize, j: usize| n[j] * x[i] - n[i] * x[j];
            let all = [n[0], n[1], turn(0, 1), n[2], turn(1, 2), turn(2, 0)];
            rows.push(all[..d * (d + 1) / 2].to_vec());
        }
    }
    let motions = d * (d + 1) / 2;
    let matrix = DMatrix::from_fn(rows.len(), motions, |i, j| rows[i][j]);
    // Rotations are in units of the body: a plane that is a 1e-6th of it fixes none.
    motions - matrix.rank(DEPENDENT)
}

/// Linear independence of unit vectors, by Gram's determinant.
fn independent(normals: &[[f64; 3]]) -> bool {
    let dot = |p: [f64; 3], q: [f64; 3]| p.iter().zip(q).map(|(p, q)| p * q).sum::<f64>();
    let gram = DMatrix::from_fn(normals.len(), normals.len(), |i, j| dot(normals[i], normals[j]));
    gram.determinant() > DEPENDENT.powi(2)
}

// Extent of the body along the normal of a plane side.

/// Shorter lengths, relative to the side, are rounding.
const ROUNDING: f64 = 1e-9;

/// The longest normal line from the side within the body, if the side is one straight line and all these lines end on
/// sides accepted by `clamped`.
///
/// Between the feet of the other vertices the first edge met is constant, and the length affine: one line in the middle
/// gives the edge, those at both ends the lengths.
pub(super) fn depth_under(
    coarse: &CoarseMesh,
    side: u32,
    clamped: impl Fn(u32) -> bool,
) -> Option<f64> {
    let all = coarse.pieces();
    let edges: Vec<&Piece> = all.iter().filter(|edge| edge.side == side).collect();
    let Piece { corners: first, normal: [x, y, _], .. } = edges.first()?;
    let (normal, along) = ([*x, *y], [-y, *x]);
    let dot = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
    // Position along the side and height into the body.
    let local = |p: [f64; 3]| {
        let away = [p[0] - first[0][0], p[1] - first[0][1]];
        [dot(away, along), -dot(away, normal)]
    };
    let ends = |edge: &Piece| [0, 1].map(|end| local(edge.corners[end]));
    let length = coarse.longest_edge();
    let mut deepest = 0.0f64;
    for edge in edges {
        let [p, q] = ends(edge);
        if [p, q].iter().any(|end| end[1].abs() > ROUNDING * length) {
            return None;
        }
        let (from, to) = (p[0].min(q[0]), p[0].max(q[0]));
        let mut cuts: Vec<f64> = coarse.vertices.iter().map(|v| local(*v)[0]).collect();
        cuts.retain(|cut| *cut > from && *cut < to);
        cuts.extend([from, to]);
        cuts.sort_by(f64::total_cmp);
        for pair in cuts.windows(2).filter(|pair| pair[1] - pair[0] > ROUNDING * length) {
            let height = |edge: &Piece, s: f64| {
                let [p, q] = ends(edge);
                p[1] + (s - p[0]) / (q[0] - p[0]) * (q[1] - p[1])
            };
            let middle = 0.5 * (pair[0] + pair[1]);
            let crosses = |edge: &&Piece| {
                let [p, q] = ends(edge);
                (p[0] < middle) != (q[0] < middle) && height(edge, middle) > ROUNDING * length
            };
            let nearest = all
                .iter()
                .filter(crosses)
                .min_by(|a, b| height(a, middle).total_cmp(&height(b, middle)))?;
            if !clamped(nearest.side) {
                return None;
            }
            deepest = deepest.max(height(nearest, pair[0])).max(height(nearest, pair[1]));
        }
    }
    Some(deepest)
}
