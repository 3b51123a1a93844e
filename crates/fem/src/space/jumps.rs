//! Jumps of functions that are not continuous: where they are, and of which nodes they are made.
//!
//! A function of Crouzeix and Raviart is linear on each cell and continuous at the midpoints of edges, so its jump across
//! an edge is linear along it and zero in the middle: the one at an end says all, and the integral of [v]² over the edge,
//! divided by its length, is a third of its square.

use super::{Element, Nodes};
use crate::mesh::Mesh;

/// Where v jumps: an edge between two cells, or one on Γ1, beyond which v is zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jump {
    /// The nodes that it is made of; on Γ1 the last two count nothing.
    pub nodes: [u32; 4],
    /// What their values count.
    pub signs: [f64; 4],
    /// The cells on both sides; on Γ1 one twice.
    pub cells: [u32; 2],
}

/// The mean of [v]² over an edge, by its square at an end.
pub(crate) const MEAN_SQUARE: f64 = 1.0 / 3.0;

impl Jump {
    /// ⟦v⟧ at an end of the edge.
    #[inline]
    pub fn of<const D: usize>(&self, v: &[f64]) -> [f64; D] {
        let mut jump = [0.0; D];
        for (&node, sign) in self.nodes.iter().zip(self.signs) {
            let own = &v[D * node as usize..][..D];
            jump.iter_mut().zip(own).for_each(|(jump, v)| *jump += sign * v);
        }
        jump
    }
}

/// All jumps of an element on `mesh`; none where its functions are continuous.
pub(crate) fn jumps(mesh: &Mesh, element: Element, nodes: &Nodes) -> Vec<Jump> {
    if element.is_conforming() {
        return Vec::new();
    }
    let mut sides: Vec<Vec<Side>> = vec![Vec::new(); nodes.vertex.len()];
    for c in 0..mesh.cell_count() {
        for (a, &node) in nodes.of_cell(c).iter().enumerate() {
            sides[node as usize].push(side(mesh, element, nodes, c, a));
        }
    }
    let jump = |(node, sides): (usize, Vec<Side>)| match sides[..] {
        [one, other] => Some(between(&one, &other)),
        [one] if node >= nodes.free => {
            let nothing = Side { signs: [0.0; 2], ..one };
            Some(between(&one, &nothing))
        }
        _ => None,
    };
    sides.into_iter().enumerate().filter_map(jump).collect()
}

/// What the value of v at an end of an edge is made of in a cell, but for the node of the edge.
#[derive(Clone, Copy)]
struct Side {
    cell: u32,
    nodes: [u32; 2],
    signs: [f64; 2],
}

fn between(one: &Side, other: &Side) -> Jump {
    let [a, b] = [one, other].map(|side| side.nodes);
    let [s, t] = [one, other].map(|side| side.signs);
    Jump {
        nodes: [a[0], a[1], b[0], b[1]],
        signs: [s[0], s[1], -t[0], -t[1]],
        cells: [one.cell, other.cell],
    }
}

/// That of node a of cell c, at the end of its edge with the smaller number: both cells take the same.
fn side(mesh: &Mesh, element: Element, nodes: &Nodes, c: usize, a: usize) -> Side {
    let corners = mesh.cell(c);
    let at = |corner: usize| {
        let b: Vec<f64> = (0..corners.len()).map(|i| f64::from(u8::from(i == corner))).collect();
        element.values(&b)
    };
    // At the ends of its edge the shape function is one.
    let ends = (0..corners.len()).filter(|&corner| at(corner)[a] == 1.0);
    let end = ends.min_by_key(|&corner| corners[corner]).expect("an end of the edge");
    let (values, own) = (at(end), nodes.of_cell(c));
    let others = [(a + 1) % own.len(), (a + 2) % own.len()];
    Side { cell: c as u32, nodes: others.map(|i| own[i]), signs: others.map(|i| values[i]) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Family, rectangle};
    use crate::space::quadrature::edge;

    /// Σ ∫ [v]²/h over the edges from values on both sides, found by the ends of edges alone.
    #[test]
    fn squares_of_jumps_are_those_of_values_on_both_sides() {
        let family = Family::Perturbed { amplitude: 0.2, seed: 2, axes: [true; 3] };
        let mut mesh = rectangle([1.0, 1.0], 3, family);
        let top = mesh.side("top").expect("a side");
        let nodes = Nodes::new(&mut mesh, Element::CR, &[top]);
        let mut v: Vec<f64> = (0..nodes.len()).map(|i| (1.7 * i as f64).sin()).collect();
        v[nodes.dofs()..].fill(0.0);
        let found: f64 = jumps(&mesh, Element::CR, &nodes)
            .iter()
            .map(|jump| MEAN_SQUARE * jump.of::<2>(&v).iter().map(|j| j * j).sum::<f64>())
            .sum();
        let rule = edge(3);
        let (mut sum, mut counted) = (0.0, 0);
        let value = |c: usize, x: [f64; 3], i: usize| -> f64 {
            let [p, q, r] = [0, 1, 2].map(|a| mesh.vertex(mesh.cell(c)[a]));
            let area = |p: &[f64], q: &[f64], r: &[f64]| {
                (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
            };
            let x = &x[..2];
            let b = [area(x, q, r), area(p, x, r), area(p, q, x)].map(|own| own / area(p, q, r));
            let shape = Element::CR.values(&b);
            let own = nodes.of_cell(c).iter().zip(shape);
            own.map(|(&node, s)| s * v[2 * node as usize + i]).sum()
        };
        for c in 0..mesh.cell_count() {
            for d in 0..=c {
                let shared: Vec<u32> =
                    mesh.cell(c).iter().copied().filter(|v| mesh.cell(d).contains(v)).collect();
                let clamped = (0..mesh.facet_side.len()).filter(|&f| {
                    c == d
                        && mesh.facet_side[f] == top
                        && mesh.facet(f).iter().all(|v| shared.contains(v))
                });
                let edges: Vec<Vec<u32>> = match shared.len() {
                    2 => vec![shared.clone()],
                    _ => clamped.map(|f| mesh.facet(f).to_vec()).collect(),
                };
                for ends in edges {
                    counted += 1;
                    for (b, weight) in rule.points.iter().zip(&rule.weights) {
                        let x = mesh.point(&ends, b);
                        for i in 0..2 {
                            let beyond = if c == d { 0.0 } else { value(d, x, i) };
                            sum += weight * (value(c, x, i) - beyond).powi(2);
                        }
                    }
                }
            }
        }
        // Euler: edges of a disc less those of its boundary, with the three on top.
        assert_eq!(counted, 16 + 18 - 1 - 12 + 3);
        assert!((found - sum).abs() < 1e-12 * sum, "{found} {sum}");
    }
}
