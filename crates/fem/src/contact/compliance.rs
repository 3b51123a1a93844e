//! ∫_{Γ3} ∂j_ν(u_ν - s) v_ν by points on the facets: Gauss points, or Gauss points on the pieces of
//! each edge between the kinks of ∂j_ν (the integral itself).

use std::cell::Cell;

use super::pieces::{Room, points, watched};
use super::{Boundary, BoundaryRule, Discretization, Model, TracePoint};
use crate::space::quadrature::{Rule, edge, triangle_degree_4};

/// The compliance term of a law over the facets of its sides.
pub(crate) struct FacetCompliance<'a> {
    boundary: &'a Boundary,
    facets: Vec<Facet>,
    rule: PointRule,
    /// For one edge after the other.
    room: Cell<Room>,
}

/// Where the points of a facet lie.
enum PointRule {
    /// At fixed places: 3 points per edge, exact where ∂j_ν(u_ν) v_ν is a polynomial of degree 5.
    Gauss(Rule),
    /// On the pieces of each edge between kinks, with s at the watched places of each.
    Exact(Vec<Vec<f64>>),
}

/// A facet with the coordinates of its corners.
struct Facet {
    measure: f64,
    corners: Vec<[f64; 3]>,
    /// (place, sign, is free) of the trace points.
    members: Vec<(usize, f64, bool)>,
}

/// A point of a facet for the present u.
struct FacetPoint {
    shape: [f64; 3],
    weight: f64,
    argument: f64,
    /// |u_ν| + |s|, of which it is the difference.
    size: f64,
    /// c(x) of the law.
    scale: f64,
}

impl<'a> FacetCompliance<'a> {
    /// Those of `model`, where u_ν stands in a vector as `place` says; none for the vertex rule or without law.
    pub(crate) fn all(
        space: &Discretization,
        model: &'a Model,
        place: impl Fn(&TracePoint) -> usize,
    ) -> Vec<Self> {
        model.boundary.iter().filter_map(|boundary| Self::new(space, boundary, &place)).collect()
    }

    /// The rule of `boundary` on its facets; `None` for the vertex rule or without law.
    fn new(
        space: &Discretization,
        boundary: &'a Boundary,
        place: impl Fn(&TracePoint) -> usize,
    ) -> Option<Self> {
        if boundary.potential.is_absent() {
            return None;
        }
        let on_sides = |f: &usize| boundary.is_on(space.side(*f));
        let facets = (0..space.trace.measure.len()).filter(on_sides);
        let facets = facets.map(|f| facet(space, f, &place));
        let facets: Vec<Facet> = facets.collect();
        let rule = match boundary.rule {
            BoundaryRule::Vertex => return None,
            rule if !rule.serves(space.element) => {
                panic!("rules on facets are those of linear u_ν")
            }
            BoundaryRule::Gauss => PointRule::Gauss(facet_rule(space.mesh.dimension)),
            BoundaryRule::Exact => {
                assert_eq!(space.mesh.dimension, 2, "the exact rule cuts edges");
                let shift = |facet: &Facet| -> Vec<f64> {
                    watched().map(|x| (boundary.shift)(facet.on_edge(x))).collect()
                };
                PointRule::Exact(facets.iter().map(shift).collect())
            }
        };
        Some(Self { boundary, facets, rule, room: Cell::default() })
    }

    /// α of (2.8c) for the law on every facet, with the largest factor at the points of the rule (for the
    /// exact rule, at the corners and middles of edges and those of their halves).
    pub(crate) fn descent(&self) -> f64 {
        let alpha = self.boundary.potential.alpha();
        let Some(factor) = &self.boundary.scale else { return alpha };
        let places = match &self.rule {
            PointRule::Gauss(rule) => rule.points.clone(),
            PointRule::Exact(_) => [0.0, 0.25, 0.5, 0.75, 1.0].map(|x| vec![1.0 - x, x]).to_vec(),
        };
        let factors = self.facets.iter().flat_map(|facet| places.iter().map(|b| facet.at(b)));
        alpha * factors.map(factor).fold(0.0, f64::max)
    }

    /// Adds the force of the compliance term at the vector `u`, which has a zero in the place of what is clamped.
    pub(crate) fn add_force(&self, u: &[f64], out: &mut [f64]) {
        self.each_point(u, |facet, point| {
            let pressure = point.scale * self.boundary.potential.value_and_slope(point.argument).0;
            for ((component, sign, unknown), shape) in facet.members.iter().zip(&point.shape) {
                if *unknown {
                    out[*component] += point.weight * pressure * sign * shape;
                }
            }
        });
    }

    /// As [`vhi::BoundaryGraph::add_rounding`] of graphs, for the forces of [`Self::add_force`].
    pub(crate) fn add_rounding(&self, u: &[f64], sizes: &mut [f64]) {
        self.each_point(u, |facet, point| {
            let law = |r: f64| point.scale * self.boundary.potential.value_and_slope(r).0;
            let size = point.weight * vhi::rounding_of(law, point.argument, point.size);
            for ((component, _, unknown), shape) in facet.members.iter().zip(&point.shape) {
                if *unknown {
                    sizes[*component] += size * shape;
                }
            }
        });
    }

    /// Hands the parts of its derivative to `add`, by two places of which the order does not matter.
    pub(crate) fn each_tangent(&self, u: &[f64], mut add: impl FnMut([usize; 2], f64)) {
        self.each_point(u, |facet, point| {
            let slope = point.scale * self.boundary.potential.value_and_slope(point.argument).1;
            for (a, &(i, sign_i, unknown_i)) in facet.members.iter().enumerate() {
                for (b, &(j, sign_j, unknown_j)) in facet.members.iter().enumerate().take(a + 1) {
                    if unknown_i && unknown_j {
                        let [s, t] = [sign_i * point.shape[a], sign_j * point.shape[b]];
                        add([i, j], point.weight * slope * s * t);
                    }
                }
            }
        });
    }

    fn each_point(&self, u: &[f64], mut visit: impl FnMut(&Facet, &FacetPoint)) {
        let mut room = self.room.take();
        for (f, facet) in self.facets.iter().enumerate() {
            // What lies beyond the unknowns is clamped.
            let normal = |&(component, sign, _): &(usize, f64, bool)| {
                sign * u.get(component).copied().unwrap_or(0.0)
            };
            let mut at = |shape: [f64; 3], weight: f64, value: f64, argument: f64| {
                let size = value.abs() + (value - argument).abs();
                let scale = self.boundary.scale_at(facet.at(&shape));
                let weight = weight * facet.measure;
                visit(facet, &FacetPoint { shape, weight, argument, size, scale });
            };
            match &self.rule {
                PointRule::Gauss(rule) => {
                    for (b, weight) in rule.points.iter().zip(&rule.weights) {
                        let value: f64 =
                            facet.members.iter().map(normal).zip(b).map(|(u, s)| s * u).sum();
                        let mut shape = [0.0; 3];
                        shape[..b.len()].copy_from_slice(b);
                        at(shape, *weight, value, value - (self.boundary.shift)(facet.at(b)));
                    }
                }
                PointRule::Exact(shifts) => {
                    let ends = [normal(&facet.members[0]), normal(&facet.members[1])];
                    let formula = |x: f64| (self.boundary.shift)(facet.on_edge(x));
                    points(ends, &shifts[f], formula, &*self.boundary.potential, &mut room);
                    for point in &room.points {
                        let shape = [1.0 - point.place, point.place, 0.0];
                        let value = shape[0] * ends[0] + shape[1] * ends[1];
                        at(shape, point.weight, value, point.argument);
                    }
                }
            }
        }
        self.room.set(room);
    }
}

impl Facet {
    fn at(&self, barycentric: &[f64]) -> [f64; 3] {
        let mut x = [0.0; 3];
        for (corner, b) in self.corners.iter().zip(barycentric) {
            for (value, c) in x.iter_mut().zip(corner) {
                *value += b * c;
            }
        }
        x
    }

    fn on_edge(&self, x: f64) -> [f64; 3] {
        self.at(&[1.0 - x, x])
    }
}

fn facet(space: &Discretization, f: usize, place: impl Fn(&TracePoint) -> usize) -> Facet {
    let points = space.trace.facet(f).iter().map(|&i| &space.trace.points[i as usize]);
    Facet {
        measure: space.trace.measure[f],
        corners: points.clone().map(|p| space.mesh.point(&[p.vertex], &[1.0])).collect(),
        members: points.map(|p| (place(p), p.sign, !p.clamped)).collect(),
    }
}

pub(crate) fn facet_rule(dimension: usize) -> Rule {
    if dimension == 2 { edge(3) } else { triangle_degree_4() }
}

#[cfg(test)]
mod tests;
