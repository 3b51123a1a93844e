//! Meshes that gather at a corner: the vertices at the fraction s of the way from the corner to the
//! opposite edge of a coarse triangle go to the fraction s^γ.
//!
//! For u ~ r^s near the corner, γ > 1/s restores the order h of a smooth field (I. Babuška, R. B. Kellogg,
//! J. Pitkäranta, Numer. Math. 33 (1979)). Vertices of nested meshes coincide; cells do not, since the
//! lines between vertices at different distances are moved too: no reference run on a graded mesh.

use super::CoarseMesh;

/// Two points closer than this part of the domain are one.
const SAME: f64 = 1e-9;

/// Moves the vertices of all coarse triangles that have `corner`, which must be one of their vertices.
/// `number` gives the vertex of a triangle at i and j with i + j ≤ n.
pub(super) fn towards(
    coarse: &CoarseMesh,
    n: u32,
    corner: [f64; 2],
    exponent: f64,
    number: impl Fn(usize, u32, u32) -> usize,
    coordinates: &mut [f64],
) {
    let Some(tip) = vertex_at(coarse, corner) else { return };
    for (t, triangle) in coarse.cells.iter().enumerate() {
        let Some(at_tip) = triangle.iter().position(|&v| v == tip) else { continue };
        let corners = coarse.corners(t);
        for j in 0..=n {
            for i in 0..=n - j {
                let weights = [n - i - j, i, j].map(|w| f64::from(w) / f64::from(n));
                let away = f64::from(n - [n - i - j, i, j][at_tip]) / f64::from(n);
                if away == 0.0 {
                    continue;
                }
                let factor = away.powf(exponent - 1.0);
                let v = number(t, i, j);
                for axis in 0..2 {
                    let x: f64 = (0..3).map(|a| weights[a] * corners[a][axis]).sum();
                    coordinates[2 * v + axis] =
                        corners[at_tip][axis] + factor * (x - corners[at_tip][axis]);
                }
            }
        }
    }
}

/// The vertex of a coarse triangulation at a place.
pub fn vertex_at(coarse: &CoarseMesh, place: [f64; 2]) -> Option<u32> {
    let [low, high] = coarse.bounds();
    let close = SAME * (high[0] - low[0]).max(high[1] - low[1]);
    let near = |v: &[f64; 3]| (v[0] - place[0]).abs().max((v[1] - place[1]).abs()) <= close;
    coarse.vertices.iter().position(near).map(|v| v as u32)
}

/// Grades the squares of a rectangle (0, size₀)×(0, size₁), with distances from the corner in the
/// larger coordinate and up to the shorter side: beyond it nothing moves.
pub(super) fn in_rectangle(
    size: [f64; 2],
    corner: [f64; 2],
    exponent: f64,
    coordinates: &mut [f64],
) {
    let reach = size[0].min(size[1]);
    for place in coordinates.chunks_exact_mut(2) {
        let away = [place[0] - corner[0], place[1] - corner[1]];
        let part = away[0].abs().max(away[1].abs()) / reach;
        if part > 0.0 && part < 1.0 {
            let factor = part.powf(exponent - 1.0);
            place[0] = corner[0] + factor * away[0];
            place[1] = corner[1] + factor * away[1];
        }
    }
}
