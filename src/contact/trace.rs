//! The normal trace on Γ3: vertices with their normal, lumped weights, and facets.

use crate::mesh::Mesh;
use crate::space::Nodes;

/// A vertex of Γ3 with one normal direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TracePoint {
    /// The vertex of the mesh.
    pub vertex: u32,
    /// Position of the normal component in a nodal vector.
    pub component: u32,
    /// u_ν = sign · component (normals along an axis).
    pub sign: f64,
    /// Lumped weight ∫_{Γ3} φ (a length or an area).
    pub weight: f64,
    /// True on the closure of Γ1, where u_ν = 0 is given.
    pub clamped: bool,
}

/// The normal trace on Γ3.
#[derive(Debug, Clone, Default)]
pub struct ContactTrace {
    /// Its vertices; a vertex between two contact sides with different normals appears once a normal.
    pub points: Vec<TracePoint>,
    /// Facets by indices into `points`, d each.
    pub facets: Vec<u32>,
    /// The mesh facet of each.
    pub mesh_facet: Vec<u32>,
    /// Length (area) of each facet.
    pub measure: Vec<f64>,
    /// Vertices a facet.
    pub stride: usize,
}

impl ContactTrace {
    /// The trace on `sides` of `mesh`.
    pub fn new(mesh: &Mesh, nodes: &Nodes, sides: &[u32]) -> Self {
        let d = mesh.dimension;
        let mut trace = Self { stride: d, ..Self::default() };
        let mut index = std::collections::BTreeMap::new();
        for f in mesh.facets_on(sides) {
            let side = mesh.facet_side[f] as usize;
            let normal = &mesh.side_normal[d * side..d * (side + 1)];
            let axis = (0..d).max_by(|&a, &b| normal[a].abs().total_cmp(&normal[b].abs()));
            let axis = axis.unwrap_or(0);
            let measure = facet_measure(mesh, f);
            for &vertex in mesh.facet(f) {
                let at = *index.entry((vertex, axis)).or_insert_with(|| {
                    let node = nodes.of_vertex[vertex as usize];
                    trace.points.push(TracePoint {
                        vertex,
                        component: d as u32 * node + axis as u32,
                        sign: normal[axis].signum(),
                        weight: 0.0,
                        clamped: node as usize >= nodes.free,
                    });
                    trace.points.len() - 1
                });
                trace.points[at].weight += measure / d as f64;
                trace.facets.push(at as u32);
            }
            trace.mesh_facet.push(f as u32);
            trace.measure.push(measure);
        }
        trace
    }

    /// The points of facet f.
    pub fn facet(&self, f: usize) -> &[u32] {
        &self.facets[self.stride * f..self.stride * (f + 1)]
    }

    /// u_ν at point i of the nodal vector u.
    pub fn normal(&self, i: usize, u: &[f64]) -> f64 {
        self.points[i].sign * u[self.points[i].component as usize]
    }
}

/// Length of an edge or area of a triangle.
pub fn facet_measure(mesh: &Mesh, f: usize) -> f64 {
    let corner: Vec<[f64; 3]> = mesh.facet(f).iter().map(|&v| mesh.point(&[v], &[1.0])).collect();
    let edge =
        |a: usize, b: usize| -> [f64; 3] { std::array::from_fn(|i| corner[b][i] - corner[a][i]) };
    let length = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    if corner.len() == 2 {
        return length(edge(0, 1));
    }
    let (p, q) = (edge(0, 1), edge(0, 2));
    let cross = [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];
    0.5 * length(cross)
}
