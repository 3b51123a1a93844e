//! Fields that are polynomials on the simplices of a finer mesh, projected onto what an element has on those of a
//! coarser one.

use nalgebra::DMatrix;

use super::moments::{AtPoints, Piecewise, linear_projection};
use super::refinement::Parents;
use crate::contact::Discretization;
use crate::space::{Element, Simplex, StrainPoint, StrainShapes};

/// L² projection onto the strains of the coarse cells of a tensor field that is one of the strains of the fine ones,
/// given at their strain points.
///
/// The rule of the strain points is exact for products of two strains: functions ψ_p that are one at a strain point of
/// the coarse cell and zero at the others are orthogonal, (ψ_p, ψ_p) = w_p, and Πf(x_p) = (f, ψ_p)/w_p, summed over the
/// strain points of the fine cells.
pub(super) fn onto_strains(
    fine: &Discretization,
    coarse: &Discretization,
    cells: &Parents,
    field: &[f64],
) -> AtPoints {
    let numbers = field.len() / fine.geometry.points();
    let shapes = StrainShapes::new(coarse.element, fine.mesh.dimension);
    let places = coarse.element.strain_rule(fine.mesh.dimension).points;
    let at_point = |point: &StrainPoint<'_>, out: &mut [f64]| {
        let place = &places[point.index % places.len()];
        shapes.at(&in_parent(cells.hats_of(point.cell), place)[..place.len()], out);
    };
    let shares = &coarse.geometry.shares;
    let mut at = vec![0.0; numbers * coarse.geometry.points()];
    let mut values = vec![0.0; shares.len()];
    let first = |c: usize| shares.len() * cells.of[c] as usize;
    for (point, value) in fine.points().zip(field.chunks_exact(numbers)) {
        at_point(&point, &mut values);
        let measure = coarse.geometry.measure[cells.of[point.cell] as usize];
        for (p, shape) in values.iter().enumerate() {
            let share = shape * point.weight / (measure * shares[p]);
            let sums = &mut at[numbers * (first(point.cell) + p)..];
            sums.iter_mut().zip(value).for_each(|(m, v)| *m += share * v);
        }
    }
    let mut rest = 0.0;
    for (point, value) in fine.points().zip(field.chunks_exact(numbers)) {
        at_point(&point, &mut values);
        let of_cell = &at[numbers * first(point.cell)..];
        let projected = |i: usize| {
            values.iter().enumerate().map(|(p, s)| s * of_cell[numbers * p + i]).sum::<f64>()
        };
        let differences = value.iter().enumerate().map(|(i, v)| v - projected(i));
        rest += point.weight * differences.map(|d| d * d).sum::<f64>();
    }
    AtPoints { at, rest }
}

/// Corners of a tetrahedron.
const MOST_CORNERS: usize = 4;

/// Barycentric coordinates in a coarse simplex of the point with those in a fine one.
fn in_parent(hats: &[f64], in_fine: &[f64]) -> [f64; MOST_CORNERS] {
    let mut place = [0.0; MOST_CORNERS];
    for (b, hat) in place.iter_mut().zip(hats.chunks_exact(in_fine.len())) {
        *b = hat.iter().zip(in_fine).map(|(hat, b)| hat * b).sum();
    }
    place
}

/// Fine simplices in coarse ones.
pub(super) struct Pieces<'a> {
    element: Element,
    parents: &'a Parents,
    measure: &'a [f64],
    /// Measures of the coarse simplices.
    coarse: &'a [f64],
}

impl<'a> Pieces<'a> {
    /// With the measures of the fine and of the coarse simplices.
    pub(super) fn new(
        element: Element,
        parents: &'a Parents,
        [measure, coarse]: [&'a [f64]; 2],
    ) -> Self {
        Self { element, parents, measure, coarse }
    }

    /// L² projection onto the functions of the element on the coarse simplices of a field with `components` numbers per
    /// point that is one of them on the fine ones; `value` gives the one at a node of a fine simplex.
    pub(super) fn project(
        &self,
        components: usize,
        value: impl Fn(usize, usize, usize) -> f64,
    ) -> Piecewise {
        if self.parents.corners == 0 {
            Piecewise::default()
        } else if self.element == Element::P1 {
            self.linear(components, value)
        } else {
            self.by_points(components, value)
        }
    }

    /// Both f and λ_a are linear on a fine simplex of N corners, where the mean of a product f g is
    /// (Σ f_i g_i + Σ f_i Σ g_i)/(N(N+1)): by points a run with a reference takes a quarter longer.
    fn linear(&self, components: usize, value: impl Fn(usize, usize, usize) -> f64) -> Piecewise {
        let corners = self.parents.corners;
        let scale = 1.0 / (corners * (corners + 1)) as f64;
        let product = |f: &[f64], g: &[f64]| {
            let sums = f.iter().sum::<f64>() * g.iter().sum::<f64>();
            scale * (f.iter().zip(g).map(|(f, g)| f * g).sum::<f64>() + sums)
        };
        let mut moment = vec![0.0; components * corners * self.coarse.len()];
        let (mut square, mut at, mut out) = (0.0, [0.0; MOST_CORNERS], [0.0; MOST_CORNERS]);
        let (at, out) = (&mut at[..corners], &mut out[..corners]);
        let hats = self.parents.hats.chunks_exact(corners * corners);
        for (s, (&parent, hats)) in self.parents.of.iter().zip(hats).enumerate() {
            let share = self.measure[s] / self.coarse[parent as usize];
            let first = components * corners * parent as usize;
            for i in 0..components {
                at.iter_mut().enumerate().for_each(|(corner, at)| *at = value(s, corner, i));
                square += self.measure[s] * product(at, at);
                for (a, hat) in hats.chunks_exact(corners).enumerate() {
                    moment[first + components * a + i] += share * product(at, hat);
                }
            }
        }
        let mut corner = vec![0.0; moment.len()];
        for (p, measure) in self.coarse.iter().enumerate() {
            for i in 0..components {
                let place = |a: usize| components * (corners * p + a) + i;
                at.iter_mut().enumerate().for_each(|(a, at)| *at = moment[place(a)]);
                linear_projection(at, out);
                for a in 0..corners {
                    corner[place(a)] = out[a];
                    square -= measure * at[a] * out[a];
                }
            }
        }
        Piecewise { node: corner, rest: square.max(0.0) }
    }

    /// By the rule that is exact for the product of two functions of the element: what is left is integrated as a
    /// square, without cancellation.
    fn by_points(
        &self,
        components: usize,
        value: impl Fn(usize, usize, usize) -> f64,
    ) -> Piecewise {
        let (corners, element) = (self.parents.corners, self.element);
        let rule = element.square_rule(corners);
        let shapes: Vec<Vec<f64>> = rule.points.iter().map(|b| element.values(b)).collect();
        let nodes = shapes[0].len();
        let mass = DMatrix::from_row_slice(nodes, nodes, &element.mass(Simplex::cell(corners - 1)));
        let inverse = mass.try_inverse().expect("functions that are linearly independent");
        let at = |s: usize, shape: &[f64], i: usize| {
            shape.iter().enumerate().map(|(a, shape)| shape * value(s, a, i)).sum::<f64>()
        };
        let in_coarse =
            |s: usize, b: &[f64]| element.values(&in_parent(self.parents.hats_of(s), b)[..corners]);
        let size = components * nodes;
        let mut moment = vec![0.0; size * self.coarse.len()];
        for (s, &parent) in self.parents.of.iter().enumerate() {
            let share = self.measure[s] / self.coarse[parent as usize];
            for ((b, shape), weight) in rule.points.iter().zip(&shapes).zip(&rule.weights) {
                let coarse = in_coarse(s, b);
                for i in 0..components {
                    let weighted = share * weight * at(s, shape, i);
                    for (a, coarse) in coarse.iter().enumerate() {
                        moment[size * parent as usize + components * a + i] += weighted * coarse;
                    }
                }
            }
        }
        let mut node = vec![0.0; moment.len()];
        for (node, moment) in node.chunks_exact_mut(size).zip(moment.chunks_exact(size)) {
            for (ai, node) in node.iter_mut().enumerate() {
                let (a, i) = (ai / components, ai % components);
                *node = (0..nodes).map(|b| inverse[(a, b)] * moment[components * b + i]).sum();
            }
        }
        let mut rest = 0.0;
        for (s, &parent) in self.parents.of.iter().enumerate() {
            let of_parent = &node[size * parent as usize..];
            for ((b, shape), weight) in rule.points.iter().zip(&shapes).zip(&rule.weights) {
                let coarse = in_coarse(s, b);
                for i in 0..components {
                    let projected =
                        coarse.iter().enumerate().map(|(a, s)| s * of_parent[components * a + i]);
                    let left = at(s, shape, i) - projected.sum::<f64>();
                    rest += self.measure[s] * weight * left * left;
                }
            }
        }
        Piecewise { node, rest }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Family, lattice};
    use crate::norms::Refinement;
    use crate::space::quadrature::triangle_degree_8;

    fn space(element: Element, n: u32) -> Discretization {
        Discretization::of(element, lattice([1.0, 1.0], n, Family::Structured), &[], &[])
    }

    /// Barycentric coordinates of x in cell c, by areas.
    fn barycentric(space: &Discretization, c: usize, x: &[f64]) -> [f64; 3] {
        let [p, q, r] = [0, 1, 2].map(|a| space.mesh.vertex(space.mesh.cell(c)[a]));
        let area = |p: &[f64], q: &[f64], r: &[f64]| {
            (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
        };
        [area(x, q, r), area(p, x, r), area(p, q, x)].map(|part| part / area(p, q, r))
    }

    /// What a projection leaves is orthogonal to the functions of the coarse cells, and `rest` is its square: both by a
    /// stronger rule, with places found from the coordinates of the meshes.
    #[test]
    fn what_a_projection_leaves_is_orthogonal_and_measured() {
        for element in [Element::P1, Element::P2] {
            let (fine, coarse) = (space(element, 4), space(element, 2));
            let found = Refinement::new(&fine, &coarse).expect("nested meshes");
            let nodal: Vec<f64> =
                (0..fine.nodes.len() / 2).map(|i| (1.3 * (i * i) as f64).cos()).collect();
            let value = |c: usize, node: usize, _| nodal[fine.cell_nodes(c)[node] as usize];
            let measures = [&fine.geometry.measure[..], &coarse.geometry.measure];
            let projected = Pieces::new(element, &found.cells, measures).project(1, value);
            let (rule, count) = (triangle_degree_8(), element.nodes_on(Simplex::cell(2)));
            let mut products = vec![0.0; count * coarse.mesh.cell_count()];
            let mut rest = 0.0;
            for c in 0..fine.mesh.cell_count() {
                let parent = found.cells.of[c] as usize;
                for (b, weight) in rule.points.iter().zip(&rule.weights) {
                    let x = fine.mesh.point(fine.mesh.cell(c), b);
                    let shapes = element.values(&barycentric(&coarse, parent, &x[..2]));
                    let f: f64 =
                        element.values(b).iter().enumerate().map(|(a, s)| s * value(c, a, 0)).sum();
                    let on_parent = &projected.node[count * parent..];
                    let left = f - shapes.iter().zip(on_parent).map(|(s, v)| s * v).sum::<f64>();
                    let weight = weight * fine.geometry.measure[c];
                    rest += weight * left * left;
                    for (a, shape) in shapes.iter().enumerate() {
                        products[count * parent + a] += weight * left * shape;
                    }
                }
            }
            // Sums of some hundred products of numbers below one.
            assert!(products.iter().all(|product| product.abs() < 1e-14), "{element:?}");
            assert!(rest > 0.01 && (projected.rest - rest).abs() < 1e-13, "{element:?} {rest}");
        }
    }
}
