//! The coarse triangulation of a plane domain, which all its meshes refine.

use std::collections::BTreeMap;

/// An edge of the boundary, with the domain on its left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoundaryEdge {
    /// Its vertices.
    pub ends: [u32; 2],
    /// Its side: index into `sides`.
    pub side: u32,
}

/// Triangles, regions and named sides of a plane domain.
#[derive(Debug, Clone, PartialEq)]
pub struct Coarse {
    /// Coordinates.
    pub vertices: Vec<[f64; 2]>,
    /// Vertex numbers, counter-clockwise.
    pub triangles: Vec<[u32; 3]>,
    /// The region of each triangle: index into `regions`.
    pub region: Vec<u32>,
    /// Names of the regions.
    pub regions: Vec<String>,
    /// The whole boundary.
    pub edges: Vec<BoundaryEdge>,
    /// Names of the sides; a side may have several edges.
    pub sides: Vec<String>,
}

/// Why triangles and edges make no domain; numbers count from 0.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CoarseError {
    /// A triangle of no area, to rounding.
    #[error("triangle {triangle} has no area: its corners {corners:?} lie on a line")]
    Flat { triangle: usize, corners: [[f64; 2]; 3] },
    #[error("triangle {triangle} names vertex {vertex}, and there are {count}")]
    NoVertex { triangle: usize, vertex: u32, count: usize },
    /// An edge with triangles on one side twice, or three of them.
    #[error("the edge from {:?} to {:?} bounds two triangles on the same side, or is named twice", ends[0], ends[1])]
    Overlap { ends: [[f64; 2]; 2] },
    /// An edge of one triangle that no side names.
    #[error("the edge from {:?} to {:?} bounds the triangles and belongs to no side", ends[0], ends[1])]
    Unnamed { ends: [[f64; 2]; 2] },
    /// A named edge that is no edge of one triangle.
    #[error("the side `{side}` has the edge from {:?} to {:?}, which does not bound the triangles", ends[0], ends[1])]
    NotOnBoundary { side: String, ends: [[f64; 2]; 2] },
    /// A vertex number beyond the list, in an edge.
    #[error("the side `{side}` names vertex {vertex}, and there are {count}")]
    NoEnd { side: String, vertex: u32, count: usize },
    #[error("the triangles fall apart: no chain of common edges leads from {from:?} to {to:?}")]
    Apart { from: [f64; 2], to: [f64; 2] },
}

/// A triangle whose smallest altitude is below this part of its longest edge has no area.
const FLAT: f64 = 1e-10;

impl Coarse {
    /// Turns every triangle counter-clockwise and every edge so that the domain is on its left, drops vertices
    /// that no triangle uses, and checks that the edges are the boundary of the triangles.
    ///
    /// # Errors
    /// [`CoarseError`].
    pub fn checked(mut self) -> Result<Self, CoarseError> {
        let count = self.vertices.len();
        let mut around: BTreeMap<[u32; 2], usize> = BTreeMap::new();
        for t in 0..self.triangles.len() {
            let triangle = self.triangles[t];
            if let Some(&vertex) = triangle.iter().find(|&&v| v as usize >= count) {
                return Err(CoarseError::NoVertex { triangle: t, vertex, count });
            }
            let area = self.double_area(t);
            let longest = self.edge_lengths(t).into_iter().fold(0.0, f64::max);
            if area.is_nan() || area.abs() <= FLAT * longest * longest {
                return Err(CoarseError::Flat { triangle: t, corners: self.corners(t) });
            }
            if area < 0.0 {
                self.triangles[t].swap(1, 2);
            }
            let [a, b, c] = self.triangles[t];
            for ends in [[a, b], [b, c], [c, a]] {
                if around.insert(ends, t).is_some() {
                    return Err(CoarseError::Overlap { ends: self.places(ends) });
                }
            }
        }
        let outer = |ends: [u32; 2]| {
            around.contains_key(&ends) && !around.contains_key(&[ends[1], ends[0]])
        };
        for e in 0..self.edges.len() {
            let BoundaryEdge { ends, side } = self.edges[e];
            let side = || self.sides[side as usize].clone();
            if let Some(&vertex) = ends.iter().find(|&&v| v as usize >= count) {
                return Err(CoarseError::NoEnd { side: side(), vertex, count });
            }
            let turned = [ends[1], ends[0]];
            self.edges[e].ends = match (outer(ends), outer(turned)) {
                (true, _) => ends,
                (_, true) => turned,
                _ => {
                    let ends = self.places(ends);
                    return Err(CoarseError::NotOnBoundary { side: side(), ends });
                }
            };
        }
        let mut named: Vec<[u32; 2]> = self.edges.iter().map(|edge| edge.ends).collect();
        named.sort_unstable();
        if let Some(pair) = named.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(CoarseError::Overlap { ends: self.places(pair[0]) });
        }
        let unnamed =
            around.keys().find(|ends| outer(**ends) && named.binary_search(ends).is_err());
        if let Some(&ends) = unnamed {
            return Err(CoarseError::Unnamed { ends: self.places(ends) });
        }
        self.connected(&around)?;
        self.drop_unused();
        Ok(self)
    }

    fn places(&self, ends: [u32; 2]) -> [[f64; 2]; 2] {
        ends.map(|v| self.vertices[v as usize])
    }

    /// Refuses triangles that cannot be reached over common edges: a detached part of the body.
    fn connected(&self, around: &BTreeMap<[u32; 2], usize>) -> Result<(), CoarseError> {
        let mut reached = vec![false; self.triangles.len()];
        let mut next: Vec<usize> = (0..reached.len().min(1)).collect();
        while let Some(t) = next.pop() {
            if !std::mem::replace(&mut reached[t], true) {
                let [a, b, c] = self.triangles[t];
                next.extend([[b, a], [c, b], [a, c]].iter().filter_map(|ends| around.get(ends)));
            }
        }
        match reached.iter().position(|reached| !reached) {
            None => Ok(()),
            Some(t) => Err(CoarseError::Apart { from: self.corners(0)[0], to: self.corners(t)[0] }),
        }
    }

    fn drop_unused(&mut self) {
        let mut number = vec![u32::MAX; self.vertices.len()];
        let mut kept = Vec::new();
        let mut used: Vec<u32> = self.triangles.iter().flatten().copied().collect();
        used.sort_unstable();
        used.dedup();
        for v in used {
            number[v as usize] = kept.len() as u32;
            kept.push(self.vertices[v as usize]);
        }
        self.vertices = kept;
        self.triangles.iter_mut().flatten().for_each(|v| *v = number[*v as usize]);
        self.edges.iter_mut().flat_map(|e| &mut e.ends).for_each(|v| *v = number[*v as usize]);
    }

    pub(crate) fn corners(&self, t: usize) -> [[f64; 2]; 3] {
        self.triangles[t].map(|v| self.vertices[v as usize])
    }

    fn double_area(&self, t: usize) -> f64 {
        let [a, b, c] = self.corners(t);
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    }

    pub(crate) fn area(&self, t: usize) -> f64 {
        0.5 * self.double_area(t)
    }

    fn edge_lengths(&self, t: usize) -> [f64; 3] {
        let [a, b, c] = self.corners(t);
        [[a, b], [b, c], [c, a]].map(|[p, q]| (q[0] - p[0]).hypot(q[1] - p[1]))
    }

    /// The longest edge: h of the mesh n is this over n.
    pub fn longest_edge(&self) -> f64 {
        (0..self.triangles.len()).flat_map(|t| self.edge_lengths(t)).fold(0.0, f64::max)
    }

    /// Ends and outward unit normal of a boundary edge.
    pub fn segment(&self, edge: &BoundaryEdge) -> ([[f64; 2]; 2], [f64; 2]) {
        let [p, q] = edge.ends.map(|v| self.vertices[v as usize]);
        let (dx, dy) = (q[0] - p[0], q[1] - p[1]);
        let length = (dx * dx + dy * dy).sqrt();
        // Adding zero turns -0 into 0.
        ([p, q], [dy / length + 0.0, -dx / length + 0.0])
    }

    /// Smallest and largest coordinates.
    pub fn bounds(&self) -> [[f64; 2]; 2] {
        let start = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
        self.vertices.iter().fold(start, |[low, high], v| {
            [[0, 1].map(|i| low[i].min(v[i])), [0, 1].map(|i| high[i].max(v[i]))]
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Coarse {
        let edge = |a, b, side| BoundaryEdge { ends: [a, b], side };
        Coarse {
            vertices: vec![[0.0, 0.0], [1.0, 0.0], [9.0, 9.0], [1.0, 1.0], [0.0, 1.0]],
            triangles: vec![[0, 3, 1], [0, 3, 4]],
            region: vec![0, 0],
            regions: vec!["body".into()],
            edges: vec![edge(1, 0, 0), edge(1, 3, 1), edge(3, 4, 2), edge(4, 0, 1)],
            sides: vec!["bottom".into(), "free".into(), "top".into()],
        }
    }

    #[test]
    fn orientation_is_mended_and_unused_vertices_go() {
        let coarse = square().checked().unwrap();
        assert_eq!(coarse.vertices.len(), 4);
        assert!((0..2).all(|t| coarse.area(t) == 0.5));
        assert_eq!(coarse.segment(&coarse.edges[0]), ([[0.0, 0.0], [1.0, 0.0]], [0.0, -1.0]));
        assert_eq!(coarse.longest_edge(), 2f64.sqrt());
        assert_eq!(coarse.bounds(), [[0.0, 0.0], [1.0, 1.0]]);
    }

    #[test]
    fn what_is_no_domain_is_refused() {
        type Defect = fn(&mut Coarse);
        let cases: [(Defect, &str); 8] = [
            (|c| c.vertices[3] = [0.5, 0.0], "has no area"),
            (|c| c.vertices[3] = [f64::NAN, 0.0], "has no area"),
            (|c| c.triangles[1][2] = 7, "names vertex 7, and there are 5"),
            (|c| c.triangles.push([0, 1, 3]), "two triangles on the same side"),
            (|c| c.edges.truncate(3), "belongs to no side"),
            (|c| c.edges[2].ends = [0, 3], "which does not bound the triangles"),
            (|c| c.edges[2].ends = [0, 9], "names vertex 9, and there are 5"),
            (
                |c| {
                    c.vertices.extend([[5.0, 5.0], [6.0, 5.0], [5.0, 6.0]]);
                    c.triangles.push([5, 6, 7]);
                    let edge = |a, b| BoundaryEdge { ends: [a, b], side: 1 };
                    c.edges.extend([edge(5, 6), edge(6, 7), edge(7, 5)]);
                },
                "no chain of common edges",
            ),
        ];
        for (defect, message) in cases {
            let mut coarse = square();
            defect(&mut coarse);
            let error = coarse.checked().unwrap_err().to_string();
            assert!(error.contains(message), "{error}");
        }
    }
}
