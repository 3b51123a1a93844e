//! The trace on Γ3: vertices with their normal and tangents, the unknowns that carry u_ν and u_τ, lumped weights, and facets.

use std::collections::BTreeMap;

use super::{Discretization, Frames};
use crate::mesh::Mesh;
use crate::mesh::geometry::{minus, norm};
use crate::space::{Element, Nodes};
use algebra::linalg::complement;

/// A vertex of Γ3, or a midpoint with a node, with one normal direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TracePoint {
    /// The vertex of the mesh.
    pub vertex: u32,
    /// Its node.
    pub node: u32,
    /// The side of the mesh that it is on, the first one in the order of facets where several lie in one plane.
    pub side: u32,
    /// ν, padded with zeros to three numbers.
    pub normal: [f64; 3],
    /// The unknown that carries u_ν = sign · unknown ([`Frames`] where ν is no axis).
    pub unknown: u32,
    /// The sign in u_ν.
    pub sign: f64,
    /// ∫_{Γ3} φ (a length or an area), the weight of the vertex rule.
    pub weight: f64,
    /// True on the closure of Γ1, where u_ν = 0 is given.
    pub clamped: bool,
    /// The tangents, d - 1 of them.
    pub(super) tangents: [[f64; 3]; 2],
    pub(super) dimension: u8,
}

impl TracePoint {
    /// Whether it carries the laws: it is free, and the rule has a weight there. Vertices of quadratic elements in space
    /// have none, as the mean of their shape functions over a facet is zero.
    pub fn carries(&self) -> bool {
        !self.clamped && self.weight > 0.0
    }
}

/// Where a point of the trace carries u_τ along one tangent = sign · unknown.
pub(super) struct Tangential {
    pub(super) unknown: u32,
    pub(super) sign: f64,
}

/// The normal trace on Γ3.
#[derive(Debug, Clone, Default)]
pub struct ContactTrace {
    /// Its vertices; a vertex between two contact sides with different normals appears once per normal.
    pub points: Vec<TracePoint>,
    /// Facets by indices into `points`, corners first.
    pub facets: Vec<u32>,
    /// The mesh facet of each.
    pub mesh_facet: Vec<u32>,
    /// Length (area) of each facet.
    pub measure: Vec<f64>,
    /// Points a facet.
    pub stride: usize,
    dimension: usize,
}

/// Normals that differ by less are one direction: rounding of vertex positions over a facet.
const SAME_NORMAL: f64 = 1e-12;
/// A component of a unit vector that is zero but for rounding.
const ALONG_AXIS: f64 = 1e-12;
/// Normals of supports that are kept as independent differ by more.
const SAME_SUPPORT: f64 = 1e-8;

/// A condition u·ν = 0 at a free vertex, or midpoint with a node, of a plane of symmetry or of bilateral contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Support {
    /// The vertex of the mesh.
    pub vertex: u32,
    /// ν, padded with zeros to three numbers.
    pub normal: [f64; 3],
}

/// The conditions on `sides`: at each vertex off Γ1 along as many of their normals as are independent, by vertices.
pub(super) fn supports(mesh: &Mesh, nodes: &Nodes, sides: &[u32]) -> Vec<Support> {
    let d = mesh.dimension;
    let mut known: BTreeMap<u32, Vec<Vec<f64>>> = BTreeMap::new();
    for f in mesh.facets_on(sides) {
        let normal = mesh.normal(f)[..d].to_vec();
        for &vertex in nodes.on_facet(f) {
            let here = known.entry(vertex).or_default();
            here.push(normal.clone());
            // Normals of one plane, and of planes through one line, differ by rounding: 1e-8 is far above it.
            if here.len() > d || complement(here, d).is_none() {
                here.pop();
            }
        }
    }
    let free =
        known.into_iter().filter(|(v, _)| (nodes.of_vertex[*v as usize] as usize) < nodes.free);
    free.flat_map(|(vertex, normals)| {
        normals.into_iter().map(move |normal| {
            let mut padded = [0.0; 3];
            padded[..d].copy_from_slice(&normal);
            Support { vertex, normal: padded }
        })
    })
    .collect()
}

impl ContactTrace {
    /// The trace on `sides` of `mesh`, and the unknowns of the vertices whose normals are no axes.
    pub(crate) fn new(
        mesh: &Mesh,
        element: Element,
        nodes: &Nodes,
        sides: &[u32],
        planes: &[Support],
    ) -> (Self, Frames) {
        let d = mesh.dimension;
        let (weights, sum) = element.facet_weights(d);
        let mut trace = Self { stride: weights.len(), dimension: d, ..Self::default() };
        let mut known: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
        for f in mesh.facets_on(sides) {
            let normal = mesh.normal(f);
            let (side, measure) = (mesh.facet_side[f], facet_measure(mesh, f));
            for (&vertex, weight) in nodes.on_facet(f).iter().zip(&weights) {
                let here = known.entry(vertex).or_default();
                let same = |&at: &usize| norm(minus(trace.points[at].normal, normal)) < SAME_NORMAL;
                let at = here.iter().copied().find(same).unwrap_or_else(|| {
                    trace.points.push(TracePoint::new((vertex, side), normal, nodes, d));
                    here.push(trace.points.len() - 1);
                    trace.points.len() - 1
                });
                trace.points[at].weight += measure * weight / sum;
                trace.facets.push(at as u32);
            }
            trace.mesh_facet.push(f as u32);
            trace.measure.push(measure);
        }
        let frames = trace.choose_unknowns(d, nodes, known, planes);
        (trace, frames)
    }

    /// The unknowns that carry u_ν at the points with laws, in the order of the points, each once.
    pub(crate) fn unknowns(&self) -> Vec<u32> {
        let mut unknowns: Vec<u32> = Vec::new();
        for point in self.points.iter().filter(|point| point.carries()) {
            if !unknowns.contains(&point.unknown) {
                unknowns.push(point.unknown);
            }
        }
        unknowns
    }

    /// A vertex whose normals are all axes keeps its Cartesian unknowns, another gets a frame; those along the normals of
    /// `planes` are held.
    fn choose_unknowns(
        &mut self,
        d: usize,
        nodes: &Nodes,
        mut known: BTreeMap<u32, Vec<usize>>,
        planes: &[Support],
    ) -> Frames {
        let mut frames = Frames::new(d);
        let mut across: BTreeMap<u32, Vec<[f64; 3]>> = BTreeMap::new();
        for plane in planes {
            across.entry(plane.vertex).or_default().push(plane.normal);
            known.entry(plane.vertex).or_default();
        }
        for (vertex, members) in &known {
            let node = nodes.of_vertex[*vertex as usize] as usize;
            let mut normals: Vec<[f64; 3]> =
                members.iter().map(|&at| self.points[at].normal).collect();
            // Contact with u_ν = 0 holds the unknown of its own normal; a plane of symmetry has one beside it.
            let (mut held, mut planes) = (Vec::new(), Vec::new());
            for support in across.get(vertex).into_iter().flatten() {
                let is_it = |normal: &[f64; 3]| norm(minus(*normal, *support)) < SAME_SUPPORT;
                match normals[..members.len()].iter().position(is_it) {
                    Some(at) => held.push(at),
                    None => planes.push(*support),
                }
            }
            normals.extend(&planes);
            held.extend(members.len()..normals.len());
            let axes: Vec<usize> = normals.iter().filter_map(axis_of).collect();
            let clamped = node >= nodes.free;
            if axes.len() == normals.len() {
                for (&at, &axis) in members.iter().zip(&axes) {
                    self.points[at].unknown = (d * node + axis) as u32;
                    self.points[at].sign = self.points[at].normal[axis];
                }
                if !clamped && !held.is_empty() {
                    let held = held.into_iter().map(|at| axes[at]).collect();
                    frames.hold(node, nodes.vertex.len(), held);
                }
                continue;
            }
            if !clamped {
                frames.insert(node, nodes.vertex.len(), &normals, held);
            }
            for (i, &at) in members.iter().enumerate() {
                self.points[at].unknown = (d * node + i.min(d - 1)) as u32;
                self.points[at].sign = 1.0;
                // The plane of symmetry is across the side where there is friction: its normal is a tangent then.
                if let (3, [plane]) = (d, &planes[..]) {
                    let rows = [self.points[at].normal.to_vec(), plane.to_vec()];
                    let third = complement(&rows, d).unwrap_or_default();
                    self.points[at].tangents[0] = *plane;
                    third.iter().for_each(|t| self.points[at].tangents[1].copy_from_slice(t));
                }
            }
        }
        frames
    }

    /// The points of facet f.
    pub fn facet(&self, f: usize) -> &[u32] {
        &self.facets[self.stride * f..self.stride * (f + 1)]
    }

    /// u_ν at point i of the nodal vector u.
    pub fn normal(&self, i: usize, u: &[f64]) -> f64 {
        let point = &self.points[i];
        let at_node = &u[self.dimension * point.node as usize..];
        point.normal[..self.dimension].iter().zip(at_node).map(|(n, u)| n * u).sum()
    }

    /// Gives a pressure to the free points that carry no law: on each facet that of the linear function through its
    /// midpoints, and of several facets their mean.
    pub fn extend(&self, pressure: &mut [f64]) {
        let d = self.dimension;
        if d == 2 || self.stride <= d {
            return;
        }
        let mut found: BTreeMap<u32, (f64, f64)> = BTreeMap::new();
        for facet in self.facets.chunks_exact(self.stride) {
            let (corners, middles) = facet.split_at(d);
            let all: f64 = middles.iter().map(|&m| pressure[m as usize]).sum();
            for (a, &corner) in corners.iter().enumerate() {
                // Midpoints follow their edges (0, 1), (1, 2), (2, 0): that of the edge opposite to a is the next one.
                let (sum, count) = found.entry(corner).or_default();
                *sum += all - 2.0 * pressure[middles[(a + 1) % d] as usize];
                *count += 1.0;
            }
        }
        for (corner, (sum, count)) in found {
            if !self.points[corner as usize].clamped {
                pressure[corner as usize] = sum / count;
            }
        }
    }

    /// Adds the normal force `value` at point i to forces by nodes.
    pub fn add_normal(&self, i: usize, value: f64, force: &mut [f64]) {
        let point = &self.points[i];
        let at_node = &mut force[self.dimension * point.node as usize..];
        at_node.iter_mut().zip(&point.normal[..self.dimension]).for_each(|(f, n)| *f += value * n);
    }
}

impl TracePoint {
    fn new((vertex, side): (u32, u32), normal: [f64; 3], nodes: &Nodes, d: usize) -> Self {
        let node = nodes.of_vertex[vertex as usize];
        let clamped = node as usize >= nodes.free;
        let (tangents, dimension) = ([[0.0; 3]; 2], d as u8);
        let mut point = Self {
            vertex,
            node,
            side,
            normal,
            unknown: 0,
            sign: 1.0,
            weight: 0.0,
            clamped,
            tangents,
            dimension,
        };
        match d {
            2 => {
                let [x, y] = point.tangent();
                point.tangents[0] = [x, y, 0.0];
            }
            // The tangents of a frame, which are axes where ν is one.
            _ => complement(&[normal.to_vec()], d)
                .iter()
                .flatten()
                .zip(&mut point.tangents)
                .for_each(|(row, tangent)| tangent.copy_from_slice(row)),
        }
        point
    }

    /// The unit tangent in the plane, towards growing x, or growing y on a side along y.
    pub fn tangent(&self) -> [f64; 2] {
        let [x, y, _] = self.normal;
        if y < -ALONG_AXIS || (y <= ALONG_AXIS && x > 0.0) { [-y, x] } else { [y, -x] }
    }

    /// The d - 1 unit tangents along which u_τ and s are given, orthogonal to each other and to ν.
    pub fn tangents(&self) -> impl Iterator<Item = &[f64]> {
        let d = usize::from(self.dimension);
        self.tangents[..d - 1].iter().map(move |tangent| &tangent[..d])
    }

    /// u_τ of a nodal vector along the tangents; its second number is 0 in the plane.
    pub fn slip(&self, u: &[f64]) -> [f64; 2] {
        let at_node = &u[usize::from(self.dimension) * self.node as usize..];
        let along = |tangent: &[f64]| tangent.iter().zip(at_node).map(|(t, u)| t * u).sum();
        let mut slip = [0.0; 2];
        slip.iter_mut().zip(self.tangents()).for_each(|(slip, tangent)| *slip = along(tangent));
        slip
    }

    pub(super) fn add_tangential(&self, components: &[f64], force: &mut [f64]) {
        let at_node = &mut force[usize::from(self.dimension) * self.node as usize..];
        for (value, tangent) in components.iter().zip(self.tangents()) {
            at_node.iter_mut().zip(tangent).for_each(|(force, along)| *force += value * along);
        }
    }

    /// The unknowns of u_τ: the other Cartesian ones, or those of a frame behind the first.
    pub(super) fn tangential_unknowns(&self, space: &Discretization) -> Vec<Tangential> {
        let d = usize::from(self.dimension);
        let frame = space.frames.rows().find(|(node, _)| *node == self.node as usize);
        let unknown = |(k, tangent): (usize, &[f64])| {
            let (component, sign) = match &frame {
                Some((_, rows)) => {
                    let row = &rows[d * (k + 1)..];
                    let along: f64 = row.iter().zip(tangent).map(|(row, t)| row * t).sum();
                    (k + 1, along.signum())
                }
                None => {
                    let axis = tangent.iter().position(|component| *component != 0.0).unwrap_or(0);
                    (axis, tangent[axis])
                }
            };
            Tangential { unknown: (d * self.node as usize + component) as u32, sign }
        };
        self.tangents().enumerate().map(unknown).collect()
    }
}

/// The axis that a normal lies on exactly.
fn axis_of(normal: &[f64; 3]) -> Option<usize> {
    let axis = (0..3).find(|&i| normal[i].abs() == 1.0)?;
    (0..3).all(|i| i == axis || normal[i] == 0.0).then_some(axis)
}

/// Length of an edge or area of a triangle.
pub fn facet_measure(mesh: &Mesh, f: usize) -> f64 {
    mesh.measure_of(mesh.facet(f))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Family, lattice};

    /// A pressure that is linear on Γ3 is known by its midpoints, on facets of any shape and where their sizes differ.
    #[test]
    fn vertices_are_shown_the_linear_pressure_of_the_midpoints() {
        let family = Family::Perturbed { amplitude: 0.2, seed: 3, axes: [true, false, true] };
        let mesh = lattice([1.0, 0.5, 1.0], 4, family);
        let sides = ["top", "bottom"].map(|name| mesh.side(name).expect("a side"));
        let space = Discretization::of(Element::P2, mesh, &sides[..1], &sides[1..]);
        let at = |point: &TracePoint| {
            let [x, _, z] = space.mesh.point(&[point.vertex], &[1.0]);
            1.0 + 2.0 * x - 3.0 * z
        };
        let points = &space.trace.points;
        let mut shown: Vec<f64> =
            points.iter().map(|point| if point.carries() { at(point) } else { 0.0 }).collect();
        assert!(shown.iter().filter(|value| **value == 0.0).count() >= 25, "no vertices");
        space.trace.extend(&mut shown);
        for (point, value) in points.iter().zip(shown) {
            // Rounding of sums of three numbers below four, and of as many facets as meet at a vertex.
            assert!((value - at(point)).abs() < 1e-13, "{value} {}", at(point));
        }
    }
}
