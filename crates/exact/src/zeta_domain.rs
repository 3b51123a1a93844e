//! Domains for integrating ζ: a rectangle or box, strips of a polygon, points in a polyhedron.

use super::simplex_points::SimplexPoints;
use super::strips::Strips;
use fem::mesh::CoarseMesh;
use formula::{Graph, Node, Variable};

/// Where ε is integrated.
#[derive(Clone, Copy)]
pub(super) enum Domain<'a> {
    /// A rectangle or box from the origin, by its lengths.
    Box(&'a [f64]),
    Coarse(&'a CoarseMesh),
    /// A polygon or polyhedron by a finer rule: the difference shows the quadrature error.
    Finer(&'a CoarseMesh),
}

impl Domain<'_> {
    /// Ends along x and y; unused for a polyhedron.
    pub(crate) fn ends(self) -> [[f64; 2]; 2] {
        match self {
            Self::Box(size) => [[0.0, size[0]], [0.0, size[1]]],
            Self::Coarse(CoarseMesh::Plane(coarse)) | Self::Finer(CoarseMesh::Plane(coarse)) => {
                let [low, high] = coarse.bounds();
                [0, 1].map(|axis| [low[axis], high[axis]])
            }
            Self::Coarse(_) | Self::Finer(_) => [[0.0, 1.0]; 2],
        }
    }

    pub(crate) fn dimension(self) -> usize {
        match self {
            Self::Box(size) => size.len(),
            Self::Coarse(coarse) | Self::Finer(coarse) => coarse.dimension(),
        }
    }
}

pub(super) struct Region {
    pub shape: Shape,
    /// A finer rule; None if every guard is cut.
    pub finer: Option<Shape>,
    /// The corners where guards are watched.
    pub corners: Vec<[f64; 3]>,
}

impl Region {
    /// The region of a domain; None for a rectangle or box. `guards` are those of ε.
    pub(crate) fn of(graph: &Graph, guards: &[Node], domain: Domain<'_>) -> Option<Self> {
        let (coarse, finer) = match domain {
            Domain::Box(_) => return None,
            Domain::Coarse(coarse) => (coarse, false),
            Domain::Finer(coarse) => (coarse, true),
        };
        let uncut = |&guard: &Node| is_uncut(graph, guard, coarse.dimension());
        let compares = !finer && guards.iter().any(uncut);
        Some(Self {
            shape: Shape::of(coarse, finer),
            finer: compares.then(|| Shape::of(coarse, true)),
            corners: coarse.vertices(),
        })
    }
}

pub(super) enum Shape {
    Strips(Strips),
    Points(SimplexPoints),
}

impl Shape {
    fn of(coarse: &CoarseMesh, finer: bool) -> Self {
        match coarse {
            CoarseMesh::Plane(coarse) => Self::Strips(Strips::new(coarse, finer)),
            CoarseMesh::Space(_) if finer => Self::Points(SimplexPoints::finer(coarse)),
            CoarseMesh::Space(_) => Self::Points(SimplexPoints::fine(coarse)),
        }
    }
}

/// Whether a guard changes sign along lines that the cuts do not follow, which are parallel to y at each time, or fixed
/// and parallel to x; on a polyhedron there are none.
fn is_uncut(graph: &Graph, guard: Node, dimension: usize) -> bool {
    let [x, y, t] = [Variable::X, Variable::Y, Variable::T].map(|v| graph.depends_on(guard, v));
    if dimension == 2 { y && (x || t) } else { x || y || graph.depends_on(guard, Variable::Z) }
}
