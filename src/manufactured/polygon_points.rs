//! Quadrature over a plane domain of coarse triangles.

use crate::mesh::{Coarse, Mesh};
use crate::space::quadrature::{Rule, triangle_product};

/// Gauss points a direction, and parts of an edge that leave at least so many triangles in all: some
/// 14 points along a third of the domain, as on the rectangle.
const POINTS: usize = 14;
const TRIANGLES: usize = 16;

/// Points of the triangles of a refined polygon, with weights that sum to its area.
///
/// Rules in barycentric coordinates: a turned polygon has the turned points.
pub(super) struct PolygonPoints {
    pub points: Vec<[f64; 3]>,
    pub weights: Vec<f64>,
}

impl PolygonPoints {
    /// Points that resolve smooth fields to rounding. A field with kinks is integrated to the square
    /// of the size of these triangles only; `check` says so.
    pub fn fine(coarse: &Coarse) -> Self {
        Self::of(&parts(coarse, TRIANGLES), &triangle_product(POINTS))
    }

    /// The same on triangles of half the size.
    pub fn finer(coarse: &Coarse) -> Self {
        Self::of(&parts(coarse, 4 * TRIANGLES), &triangle_product(POINTS))
    }

    /// The points of a rule on the cells of a mesh.
    pub fn of(mesh: &Mesh, rule: &Rule) -> Self {
        let mut own = Self { points: Vec::new(), weights: Vec::new() };
        for c in 0..mesh.cell_count() {
            let cell = mesh.cell(c);
            let area = area(mesh, c);
            own.points.extend(rule.points.iter().map(|b| mesh.point(cell, b)));
            own.weights.extend(rule.weights.iter().map(|weight| weight * area));
        }
        own
    }

    /// ∫ f² of values at the points.
    pub fn sum_of_squares(&self, values: &[f64]) -> f64 {
        values.iter().zip(&self.weights).map(|(v, w)| w * v * v).sum()
    }
}

/// A refinement of the domain with at least so many triangles.
pub(super) fn parts(coarse: &Coarse, triangles: usize) -> Mesh {
    let share = triangles as f64 / coarse.triangles.len() as f64;
    let n = share.sqrt().ceil().max(1.0) as u32;
    crate::mesh::refined(&std::sync::Arc::new(coarse.clone()), n, crate::mesh::Family::Structured)
}

/// |K| of a triangle.
pub(super) fn area(mesh: &Mesh, c: usize) -> f64 {
    let [p, q, r] = [0, 1, 2].map(|a| mesh.vertex(mesh.cell(c)[a]));
    0.5 * ((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]))
}
