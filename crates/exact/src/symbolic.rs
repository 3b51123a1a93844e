//! Fields as formulas: strain, memory integral, stress and body force of an exact displacement.

use super::exact::{MaterialNumbers, RegionNumbers};
use formula::{Function, Graph, Node, Variable};

/// The space variables in order.
pub const AXES: [Variable; 3] = [Variable::X, Variable::Y, Variable::Z];

/// Components (i, j), i ≤ j, of a symmetric tensor in the order of all lists here.
pub(crate) fn components(d: usize) -> Vec<(usize, usize)> {
    (0..d).flat_map(|i| (i..d).map(move |j| (i, j))).collect()
}

/// ε(u) by exact derivatives, as the list of its upper components.
pub(crate) fn strain(graph: &mut Graph, u: &[Node]) -> Vec<Node> {
    let half = graph.constant(0.5);
    components(u.len())
        .into_iter()
        .map(|(i, j)| {
            let a = graph.derivative(u[i], AXES[j]);
            let b = graph.derivative(u[j], AXES[i]);
            let sum = graph.add(a, b);
            graph.mul(half, sum)
        })
        .collect()
}

/// H = ∫_0^t b(t - s) ε ds for every component, of one term of the memory.
pub(crate) fn memory(graph: &mut Graph, kernel: Node, strain: &[Node]) -> Vec<Node> {
    strain.iter().map(|&e| graph.convolve(kernel, e)).collect()
}

pub(crate) fn stress_in_regions(
    graph: &mut Graph,
    (material, regions): (&MaterialNumbers, &[RegionNumbers]),
    kappa: Option<Node>,
    strain: &[Node],
    memory: &[Node],
) -> Vec<Node> {
    let mut all = stress(graph, material, kappa, strain, memory);
    let zero = graph.constant(0.0);
    for region in regions {
        let inside = stress(graph, &region.material, kappa, strain, memory);
        for (outside, inside) in all.iter_mut().zip(inside) {
            *outside = graph.select_less(zero, region.condition, inside, *outside);
        }
    }
    all
}

/// σ of (5.1) as formulas in x, t and ζ: the symbolic counterpart of [`super::constitutive::stress`], needed for
/// derivatives of σ.
fn stress(
    graph: &mut Graph,
    material: &MaterialNumbers,
    kappa: Option<Node>,
    strain: &[Node],
    memory: &[Node],
) -> Vec<Node> {
    let d = if strain.len() == 3 { 2 } else { 3 };
    let list = components(d);
    let mut stress = match &material.full {
        Some(mandel) => anisotropic(graph, d, mandel, strain),
        None => isotropic(graph, d, material.lambda, material.mu_l, strain),
    };
    for (&(lambda, mu), history) in material.memory.iter().zip(memory.chunks(strain.len())) {
        // A term that only another region has.
        if (lambda, mu) == (0.0, 0.0) {
            continue;
        }
        for (target, part) in stress.iter_mut().zip(isotropic(graph, d, lambda, mu, history)) {
            *target = graph.add(*target, part);
        }
    }
    let (Some(mu), Some(kappa)) = (material.projection, kappa) else { return stress };
    let mean = trace(graph, d, strain);
    let inverse = graph.constant(1.0 / d as f64);
    let mean = graph.mul(mean, inverse);
    let deviator: Vec<Node> = list
        .iter()
        .zip(strain)
        .map(|(&(i, j), &e)| if i == j { graph.sub(e, mean) } else { e })
        .collect();
    let mut squares = graph.constant(0.0);
    for (&(i, j), &e) in list.iter().zip(&deviator) {
        let square = graph.mul(e, e);
        let count = graph.constant(if i == j { 1.0 } else { 2.0 });
        let term = graph.mul(count, square);
        squares = graph.add(squares, term);
    }
    let length = graph.apply(Function::Sqrt, squares);
    let (zero, one, mu) = (graph.constant(0.0), graph.constant(1.0), graph.constant(mu));
    let ratio = graph.div(kappa, length);
    let excess = graph.sub(one, ratio);
    let scaled = graph.mul(mu, excess);
    let factor = graph.select_less(kappa, length, scaled, zero);
    for (target, &e) in stress.iter_mut().zip(&deviator) {
        let part = graph.mul(factor, e);
        *target = graph.add(*target, part);
    }
    stress
}

fn trace(graph: &mut Graph, d: usize, tensor: &[Node]) -> Node {
    let mut sum = graph.constant(0.0);
    for (&(i, j), &e) in components(d).iter().zip(tensor) {
        if i == j {
            sum = graph.add(sum, e);
        }
    }
    sum
}

fn isotropic(graph: &mut Graph, d: usize, lambda: f64, mu: f64, tensor: &[Node]) -> Vec<Node> {
    let volumetric = trace(graph, d, tensor);
    let (lambda, twice) = (graph.constant(lambda), graph.constant(2.0 * mu));
    let volumetric = graph.mul(lambda, volumetric);
    components(d)
        .iter()
        .zip(tensor)
        .map(|(&(i, j), &e)| {
            let sheared = graph.mul(twice, e);
            if i == j { graph.add(sheared, volumetric) } else { sheared }
        })
        .collect()
}

/// σ_ij = Σ_{k ≤ l} (2 - δ_kl) 𝒜_ijkl ε_kl.
fn anisotropic(graph: &mut Graph, d: usize, mandel: &[[f64; 6]; 6], strain: &[Node]) -> Vec<Node> {
    let list = components(d);
    let row = |&(i, j): &(usize, usize)| {
        let mut sum = graph.constant(0.0);
        for (&(k, l), &e) in list.iter().zip(strain) {
            let count = if k == l { 1.0 } else { 2.0 };
            let entry = count * super::constitutive::component(mandel, d, [i, j, k, l]);
            let entry = graph.constant(entry);
            let term = graph.mul(entry, e);
            sum = graph.add(sum, term);
        }
        sum
    };
    list.iter().map(row).collect()
}

/// f0 = -Div σ.
pub(crate) fn body_force(graph: &mut Graph, stress: &[Node]) -> Vec<Node> {
    let d = if stress.len() == 3 { 2 } else { 3 };
    let list = components(d);
    let find = |i: usize, j: usize| {
        let (i, j) = (i.min(j), i.max(j));
        list.iter().position(|&pair| pair == (i, j)).unwrap_or(0)
    };
    (0..d)
        .map(|i| {
            let mut sum = graph.constant(0.0);
            for (j, &axis) in AXES.iter().enumerate().take(d) {
                let part = graph.derivative(stress[find(i, j)], axis);
                sum = graph.add(sum, part);
            }
            graph.neg(sum)
        })
        .collect()
}
