//! Domains for integrating ζ: strips of a polygon or box, points in a polyhedron.

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

pub(super) struct Region {
    pub shape: Shape,
    /// A finer rule; None if every guard is cut.
    pub finer: Option<Shape>,
    /// The corners where guards are watched.
    pub corners: Vec<[f64; 3]>,
}

impl Region {
    /// The region of a domain; `guards` are those of ε, which varies `along_z` or not.
    pub(crate) fn of(graph: &Graph, guards: &[Node], domain: Domain<'_>, along_z: bool) -> Self {
        match domain {
            Domain::Box(size) => {
                let strips = Strips::of_box(size, along_z);
                Self { corners: strips.corners(), shape: Shape::Strips(strips), finer: None }
            }
            Domain::Coarse(coarse) => {
                let uncut = |&guard: &Node| is_uncut(graph, guard, coarse.dimension);
                let finer = guards.iter().any(uncut).then(|| Shape::of(coarse, true));
                Self { shape: Shape::of(coarse, false), finer, corners: coarse.vertices.clone() }
            }
            Domain::Finer(coarse) => Self {
                shape: Shape::of(coarse, true),
                finer: None,
                corners: coarse.vertices.clone(),
            },
        }
    }
}

pub(super) enum Shape {
    Strips(Strips),
    Points(SimplexPoints),
}

impl Shape {
    fn of(coarse: &CoarseMesh, finer: bool) -> Self {
        match coarse.dimension {
            2 => Self::Strips(Strips::new(coarse, finer)),
            _ => Self::Points(SimplexPoints::in_space(coarse, finer)),
        }
    }
}

/// Whether a guard changes sign along lines that the cuts do not follow, which are parallel to y at each time, or fixed
/// and parallel to x; on a polyhedron there are none.
fn is_uncut(graph: &Graph, guard: Node, dimension: usize) -> bool {
    let [x, y, t] = [Variable::X, Variable::Y, Variable::T].map(|v| graph.depends_on(guard, v));
    if dimension == 2 { y && (x || t) } else { x || y || graph.depends_on(guard, Variable::Z) }
}
