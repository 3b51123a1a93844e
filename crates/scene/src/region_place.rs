//! Location of a region: a condition on coordinates, or a physical group of the mesh file.

use fem::mesh::CoarseMesh;
use formula::{Graph, Node, Scope};

use super::data::AXES;
use super::diagnostic::Result;
use super::domain::{Domain, Shape};
use super::reading::Reading;
use super::spans::join;

/// The cells of a region.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Place {
    /// Cells whose centroid has a positive value of the formula.
    Where(Node),
    /// Cells of a region of the mesh, an index into `Mesh::regions`.
    Physical(u32),
}

/// The place of the region `name` at a key.
pub(super) fn place(
    reading: &mut Reading,
    key: &str,
    name: &str,
    domain: &Domain,
) -> Result<Place> {
    let (condition, physical) = (join(key, "where"), join(key, "physical"));
    match (reading.has(&condition), reading.has(&physical)) {
        (true, false) => {
            let scope = Scope::new(&AXES[..domain.dimension()]);
            reading.formula(&condition, &scope).map(Place::Where)
        }
        (false, true) => {
            let Shape::Refined(coarse) = &domain.shape else {
                let message = "physical groups are in mesh files, and the domain is none";
                let hint = "write where = \"y - 0.5\", or shape = \"mesh\" with a file";
                return Err(reading.error(&physical, message, hint));
            };
            let known: Vec<(&str, u32)> =
                coarse.regions.iter().map(String::as_str).zip(0..).collect();
            reading.choice(&physical, &known).map(Place::Physical)
        }
        (both, _) => {
            let count = if both { "two places" } else { "no place" };
            let message = format!("the region `{name}` has {count}");
            let hint = "give either where = \"y - 0.5\", positive inside, or physical = \"name\", a group of the mesh file";
            Err(reading.error(key, message, hint))
        }
    }
}

/// Barycentric coordinates down to this count as inside: boundary points of the body belong to it.
const INSIDE: f64 = 1e-9;

impl Place {
    /// A formula that is positive in the region: for a physical group the largest over its coarse simplices of the
    /// smallest barycentric coordinate, raised so that their faces are inside. On an interface either region may have
    /// the points.
    pub(crate) fn condition(self, graph: &mut Graph, shape: &Shape) -> Node {
        let (group, coarse) = match (self, shape) {
            (Place::Where(node), _) => return node,
            (Place::Physical(_), Shape::Box) => return graph.constant(-1.0),
            (Place::Physical(group), Shape::Refined(coarse)) => (group, coarse),
        };
        let simplices = (0..coarse.count()).filter(|&simplex| coarse.region[simplex] == group);
        let mut deepest = graph.constant(f64::NEG_INFINITY);
        for simplex in simplices {
            let least = smallest_coordinate(graph, coarse, simplex);
            deepest = graph.max(deepest, least);
        }
        let raised = graph.constant(INSIDE);
        graph.add(deepest, raised)
    }
}

/// min_a λ_a(x) of a coarse simplex.
fn smallest_coordinate(graph: &mut Graph, coarse: &CoarseMesh, simplex: usize) -> Node {
    let (corners, d) = (coarse.corners(simplex), coarse.dimension);
    // Rows of the inverse are the gradients of λ_1, …, λ_d; λ_0 = 1 minus their sum.
    let edges = nalgebra::DMatrix::from_fn(d, d, |i, a| corners[a + 1][i] - corners[0][i]);
    let inverse = edges.try_inverse().unwrap_or_else(|| nalgebra::DMatrix::zeros(d, d));
    let mut first = graph.constant(1.0);
    let mut least = None;
    for a in 0..d {
        let at_corner: f64 = (0..d).map(|i| inverse[(a, i)] * corners[0][i]).sum();
        let mut coordinate = graph.constant(-at_corner);
        for (i, &axis) in AXES.iter().enumerate().take(d) {
            let (slope, axis) = (graph.constant(inverse[(a, i)]), graph.variable(axis));
            let term = graph.mul(slope, axis);
            coordinate = graph.add(coordinate, term);
        }
        first = graph.sub(first, coordinate);
        least = Some(least.map_or(coordinate, |least| graph.min(least, coordinate)));
    }
    least.map_or(first, |least| graph.min(least, first))
}
