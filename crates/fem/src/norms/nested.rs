//! Fields that are polynomials on the simplices of a finer mesh, projected onto what an element has on those of a
//! coarser one.

use nalgebra::DMatrix;

use super::moments::{AtPoints, Piecewise};
use super::refinement::{Parents, in_parent};
use crate::contact::Discretization;
use crate::space::{Element, StrainShapes};

/// Gets parent, weight, functions of the parent and values of the field at a point of a fine simplex.
type SeePoint<'a> = dyn FnMut(usize, f64, &[f64], &[f64]) + 'a;

/// The projection onto functions with this inverse of their mass on parents of these measures, those of a parent one after
/// another, and the square of what it leaves. `each_point` shows all points of a rule that is exact for the products.
fn project(
    inverse: &DMatrix<f64>,
    measures: &[f64],
    components: usize,
    each_point: impl Fn(&mut SeePoint<'_>),
) -> (Vec<f64>, f64) {
    let functions = inverse.nrows();
    let size = components * functions;
    let mut moments = vec![0.0; size * measures.len()];
    each_point(&mut |parent, weight, shapes, values| {
        let share = weight / measures[parent];
        let of_parent = moments[size * parent..].chunks_exact_mut(components);
        for (sums, shape) in of_parent.zip(shapes) {
            sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += share * shape * value);
        }
    });
    let mut found = vec![0.0; moments.len()];
    for (found, moments) in found.chunks_exact_mut(size).zip(moments.chunks_exact(size)) {
        for (ai, found) in found.iter_mut().enumerate() {
            let (a, i) = (ai / components, ai % components);
            *found = (0..functions).map(|b| inverse[(a, b)] * moments[components * b + i]).sum();
        }
    }
    let mut rest = 0.0;
    each_point(&mut |parent, weight, shapes, values| {
        let of_parent = &found[size * parent..];
        for (i, value) in values.iter().enumerate() {
            let each = shapes.iter().enumerate().map(|(a, s)| s * of_parent[components * a + i]);
            rest += weight * (value - each.sum::<f64>()).powi(2);
        }
    });
    (found, rest)
}

/// A field at the strain points of the fine mesh, onto the strains of the coarse one, which its points determine.
pub(super) fn onto_strains(
    fine: &Discretization,
    coarse: &Discretization,
    cells: &Parents,
    field: &[f64],
) -> AtPoints {
    let numbers = field.len() / fine.geometry.points();
    let shapes = StrainShapes::new(coarse.element, fine.mesh.dimension);
    let places = coarse.element.strain_rule(fine.mesh.dimension).points;
    // The functions of the points are orthogonal, as the rule is exact for their products.
    let shares = coarse.geometry.shares.iter().map(|share| 1.0 / share);
    let inverse = DMatrix::from_diagonal(&shares.collect::<Vec<_>>().into());
    let each_point = |see: &mut SeePoint<'_>| {
        let mut values = vec![0.0; places.len()];
        for (point, value) in fine.points().zip(field.chunks_exact(numbers)) {
            let place = &places[point.index % places.len()];
            shapes.at(&in_parent(cells.hats_of(point.cell), place)[..place.len()], &mut values);
            see(cells.of[point.cell] as usize, point.weight, &values, value);
        }
    };
    let (at, rest) = project(&inverse, &coarse.geometry.measure, numbers, each_point);
    AtPoints { at, rest }
}

/// A field of an element on fine simplices by its nodal values `value`(simplex, node, component), onto the element on their
/// parents; measures of both.
pub(super) fn onto_element(
    element: Element,
    parents: &Parents,
    [fine, coarse]: [&[f64]; 2],
    components: usize,
    value: impl Fn(usize, usize, usize) -> f64,
) -> Piecewise {
    if parents.corners == 0 {
        return Piecewise::default();
    }
    let rule = element.square_rule(parents.corners);
    let shapes: Vec<Vec<f64>> = rule.points.iter().map(|b| element.values(b)).collect();
    let nodes = shapes[0].len();
    let mass = element.mass(parents.corners);
    let mass = DMatrix::from_row_slice(nodes, nodes, &mass);
    let inverse = mass.try_inverse().expect("functions that are linearly independent");
    let each_point = |see: &mut SeePoint<'_>| {
        let mut at_point = vec![0.0; components];
        for (point, in_coarse) in parents.shapes.chunks_exact(nodes).enumerate() {
            let (s, q) = (point / shapes.len(), point % shapes.len());
            for (i, at) in at_point.iter_mut().enumerate() {
                *at = shapes[q].iter().enumerate().map(|(a, shape)| shape * value(s, a, i)).sum();
            }
            see(parents.of[s] as usize, fine[s] * rule.weights[q], in_coarse, &at_point);
        }
    };
    let (node, rest) = project(&inverse, coarse, components, each_point);
    Piecewise { node, rest }
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
            let projected = onto_element(element, &found.cells, measures, 1, value);
            let (rule, count) = (triangle_degree_8(), element.nodes(3).len());
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
