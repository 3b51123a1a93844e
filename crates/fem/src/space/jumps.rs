//! Jumps of functions that are not continuous: where they are, and of which nodes they are made.
//!
//! A function of Crouzeix and Raviart is linear on each cell and continuous at the barycentres of facets. In a cell it is
//! v_F + Σ_i (1 - d δ_iq) v_i at corner q of its facet F, v_i the value at the facet opposite to corner i of F: with w_i,
//! the v_i of one cell less those of the other, its jump is linear on F, zero in the middle, and Σ w - d w_q at corner q.

use super::{Element, Nodes, Simplex};
use crate::mesh::Mesh;

/// Where v jumps: a facet F between two cells, or one on Γ1, beyond which v is zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jump {
    /// The nodes that it is made of, 2d: of each cell those opposite to the corners of F, in one order; on Γ1 the last d
    /// count nothing.
    pub nodes: [u32; 6],
    /// What their values count: 1 in one cell, -1 in the other.
    pub signs: [f64; 6],
    /// The cells on both sides; on Γ1 one twice.
    pub cells: [u32; 2],
    /// |F|/h_F with h_F = |F|^{1/(d-1)}: 1 in the plane, a length in space.
    pub weight: f64,
}

impl Jump {
    /// (1/h_F) ∫_F of a product of two jumps is this times the product of their values, summed over the corners of F: the mean
    /// of a square is Σ (value)²/(d(d+1)) of a linear function whose corners sum up to zero.
    #[inline]
    pub fn at_a_corner<const D: usize>(&self) -> f64 {
        self.weight / (D * (D + 1)) as f64
    }

    /// ⟦v⟧ at the corners of F.
    #[inline]
    pub fn of<const D: usize>(&self, v: &[f64]) -> [[f64; D]; D] {
        Self::at_corners(&self.apart(v))
    }

    /// Σ w - d w_q at all corners q: a symmetric matrix, so that it also takes what acts on jumps at corners to what acts on w.
    pub(crate) fn at_corners<const D: usize>(w: &[[f64; D]; D]) -> [[f64; D]; D] {
        let sum: [f64; D] = std::array::from_fn(|i| w.iter().map(|w_q| w_q[i]).sum());
        w.map(|w_q| std::array::from_fn(|i| sum[i] - D as f64 * w_q[i]))
    }

    /// w by the corners that its nodes are opposite to, from signs and values.
    #[inline]
    fn apart<const D: usize>(&self, v: &[f64]) -> [[f64; D]; D] {
        let mut apart = [[0.0; D]; D];
        for (a, (&node, count)) in self.nodes(D).iter().zip(self.signs).enumerate() {
            let at_node = &v[D * node as usize..][..D];
            apart[a % D].iter_mut().zip(at_node).for_each(|(w, v)| *w += count * v);
        }
        apart
    }

    /// Adds what acts on w to the nodes, times their signs.
    #[inline]
    pub(crate) fn add<const D: usize>(&self, on_w: &[[f64; D]; D], out: &mut [f64]) {
        for (a, (&node, count)) in self.nodes(D).iter().zip(self.signs).enumerate() {
            let target = out[D * node as usize..][..D].iter_mut();
            target.zip(on_w[a % D]).for_each(|(target, value)| *target += count * value);
        }
    }

    /// Those of [`Self::nodes`] that there are in dimension d.
    pub fn nodes(&self, d: usize) -> &[u32] {
        &self.nodes[..2 * d]
    }
}

/// All jumps of an element on `mesh`; none where its functions are continuous.
pub(crate) fn jumps(mesh: &Mesh, element: Element, nodes: &Nodes) -> Vec<Jump> {
    if element.is_conforming() {
        return Vec::new();
    }
    let on_facet = element.nodes(Simplex::cell(mesh.dimension));
    let opposite: Vec<usize> =
        on_facet.iter().filter_map(|b| b.iter().position(|b| *b == 0.0)).collect();
    let mut sides: Vec<Vec<Side>> = vec![Vec::new(); nodes.vertex.len()];
    for c in 0..mesh.cell_count() {
        for (a, &node) in nodes.of_cell(c).iter().enumerate() {
            sides[node as usize].push(side(mesh, &opposite, nodes, c, a));
        }
    }
    let jump = |(node, sides): (usize, Vec<Side>)| match &sides[..] {
        [one, other] => Some(between(mesh, one, other, -1.0)),
        [one] if node >= nodes.free => Some(between(mesh, one, one, 0.0)),
        _ => None,
    };
    sides.into_iter().enumerate().filter_map(jump).collect()
}

/// A facet of a cell.
#[derive(Clone)]
struct Side {
    cell: u32,
    /// Its corners in the order of their numbers: both cells take the same. Of the cell, the nodes opposite to them.
    corners: Vec<u32>,
    nodes: Vec<u32>,
}

fn between(mesh: &Mesh, one: &Side, other: &Side, sign: f64) -> Jump {
    let d = mesh.dimension;
    let (mut nodes, mut signs) = ([0; 6], [0.0; 6]);
    nodes[..d].copy_from_slice(&one.nodes);
    nodes[d..2 * d].copy_from_slice(&other.nodes);
    signs[..d].fill(1.0);
    signs[d..2 * d].fill(sign);
    let weight = mesh.measure_of(&one.corners).powf((d - 2) as f64 / (d - 1) as f64);
    Jump { nodes, signs, cells: [one.cell, other.cell], weight }
}

/// That of node a of cell c; `opposite` are the corners that the nodes are opposite to.
fn side(mesh: &Mesh, opposite: &[usize], nodes: &Nodes, c: usize, a: usize) -> Side {
    let (cell, of_cell) = (mesh.cell(c), nodes.of_cell(c));
    let opposite = |a: usize| cell[opposite[a]];
    let mut others: Vec<(u32, u32)> =
        (0..of_cell.len()).filter(|&b| b != a).map(|b| (opposite(b), of_cell[b])).collect();
    others.sort_unstable();
    let (corners, nodes) = others.into_iter().unzip();
    Side { cell: c as u32, corners, nodes }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Family, lattice};
    use crate::space::quadrature::{Rule, edge, triangle_degree_4};

    /// v_i of cell c at a point, by barycentric coordinates: those of x in the linear system of its corners.
    fn value(mesh: &Mesh, nodes: &Nodes, v: &[f64], (c, x, i): (usize, [f64; 3], usize)) -> f64 {
        let (d, cell) = (mesh.dimension, mesh.cell(c));
        let entry = |row: usize, a: usize| if row == d { 1.0 } else { mesh.vertex(cell[a])[row] };
        let matrix = nalgebra::DMatrix::from_fn(d + 1, d + 1, entry);
        let right = nalgebra::DVector::from_fn(d + 1, |row, _| if row == d { 1.0 } else { x[row] });
        let b = matrix.lu().solve(&right).expect("a cell");
        let shapes = nodes.of_cell(c).iter().zip(Element::CR.values(b.as_slice()));
        shapes.map(|(&node, s)| s * v[d * node as usize + i]).sum()
    }

    /// The facets between cells and on a side, each once, with its cells.
    fn facets(mesh: &Mesh, side: u32) -> Vec<(Vec<u32>, Vec<usize>)> {
        let mut found: std::collections::BTreeMap<Vec<u32>, Vec<usize>> = Default::default();
        for c in 0..mesh.cell_count() {
            for left_out in 0..=mesh.dimension {
                let mut facet = mesh.cell(c).to_vec();
                facet.remove(left_out);
                facet.sort_unstable();
                found.entry(facet).or_default().push(c);
            }
        }
        let on_side = |facet: &[u32]| {
            let sides = [side];
            let mut on_sides = mesh.facets_on(&sides);
            on_sides.any(|f| mesh.facet(f).iter().all(|v| facet.contains(v)))
        };
        found.into_iter().filter(|(facet, cells)| cells.len() == 2 || on_side(facet)).collect()
    }

    /// Σ (1/h_F) ∫_F [v]² from values on both sides, in the plane and in space.
    #[test]
    fn squares_of_jumps_are_those_of_values_on_both_sides() {
        fn compare<const D: usize>(mut mesh: Mesh, rule: &Rule) {
            let top = mesh.side("top").expect("a side");
            let all = facets(&mesh, top);
            let nodes = Nodes::new(&mut mesh, Element::CR, &[top]);
            let mut v: Vec<f64> = (0..nodes.len()).map(|i| (1.7 * i as f64).sin()).collect();
            v[nodes.dofs()..].fill(0.0);
            let jumps = jumps(&mesh, Element::CR, &nodes);
            assert_eq!(jumps.len(), all.len());
            let square = |jump: &Jump| {
                let squares = jump.of::<D>(&v).as_flattened().iter().map(|j| j * j).sum::<f64>();
                squares * jump.at_a_corner::<D>()
            };
            let (found, mut sum) = (jumps.iter().map(square).sum::<f64>(), 0.0);
            for (corners, cells) in all {
                // |F|/h_F of a length is 1, of an area its root.
                let measure = mesh.measure_of(&corners);
                let size = if D == 2 { 1.0 } else { measure.sqrt() };
                for (b, weight) in rule.points.iter().zip(&rule.weights) {
                    let x = mesh.point(&corners, b);
                    for i in 0..D {
                        let at = |c: usize| value(&mesh, &nodes, &v, (c, x, i));
                        let beyond = cells.get(1).map_or(0.0, |&c| at(c));
                        sum += size * weight * (at(cells[0]) - beyond).powi(2);
                    }
                }
            }
            assert!((found - sum).abs() < 1e-11 * sum, "{D}: {found} {sum}");
        }
        let family = Family::Perturbed { amplitude: 0.15, seed: 2, axes: [true; 3] };
        compare::<2>(lattice([1.0, 1.0], 3, family), &edge(3));
        compare::<3>(lattice([1.0, 0.5, 1.0], 2, family), &triangle_degree_4());
    }

    /// Across the barycentre v is continuous: values at the corners sum up to zero.
    #[test]
    fn values_at_corners_sum_up_to_zero() {
        let mut mesh = lattice([1.0; 3], 2, Family::Structured);
        let nodes = Nodes::new(&mut mesh, Element::CR, &[]);
        let v: Vec<f64> = (0..nodes.len()).map(|i| (0.9 * i as f64).cos()).collect();
        for jump in jumps(&mesh, Element::CR, &nodes) {
            let at = jump.of::<3>(&v);
            assert!((0..3).all(|i| (at[0][i] + at[1][i] + at[2][i]).abs() < 1e-13));
        }
    }
}
