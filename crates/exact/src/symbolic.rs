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
    let one = |(i, j): (usize, usize)| {
        let parts = [graph.derivative(u[i], AXES[j]), graph.derivative(u[j], AXES[i])];
        graph.written("0.5*(a + b)", &[("a", parts[0]), ("b", parts[1])], &[])
    };
    components(u.len()).into_iter().map(one).collect()
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
    let trace = trace(graph, d, strain);
    let mean = graph.weighted_sum([(1.0 / d as f64, trace)]);
    let deviator = list.iter().zip(strain);
    let deviator = deviator.map(|(&(i, j), &e)| if i == j { graph.sub(e, mean) } else { e });
    let deviator: Vec<Node> = deviator.collect();
    let squares = list
        .iter()
        .zip(&deviator)
        .map(|(&(i, j), &e)| (if i == j { 1.0 } else { 2.0 }, graph.powi(e, 2)));
    let squares: Vec<(f64, Node)> = squares.collect();
    let squares = graph.weighted_sum(squares);
    let length = graph.apply(Function::Sqrt, squares);
    let nodes = [("kappa", kappa), ("length", length)];
    let text = "if(kappa < length, mu*(1 - kappa/length), 0)";
    let factor = graph.written(text, &nodes, &[("mu", mu)]);
    for (target, &e) in stress.iter_mut().zip(&deviator) {
        let part = graph.mul(factor, e);
        *target = graph.add(*target, part);
    }
    stress
}

fn trace(graph: &mut Graph, d: usize, tensor: &[Node]) -> Node {
    let diagonal = components(d).into_iter().zip(tensor).filter(|((i, j), _)| i == j);
    graph.weighted_sum(diagonal.map(|(_, &e)| (1.0, e)))
}

fn isotropic(graph: &mut Graph, d: usize, lambda: f64, mu: f64, tensor: &[Node]) -> Vec<Node> {
    let volumetric = trace(graph, d, tensor);
    let entry = |((i, j), &e): ((usize, usize), &Node)| {
        graph.weighted_sum([(2.0 * mu, e), (if i == j { lambda } else { 0.0 }, volumetric)])
    };
    components(d).into_iter().zip(tensor).map(entry).collect()
}

/// σ_ij = Σ_{k ≤ l} (2 - δ_kl) 𝒜_ijkl ε_kl.
fn anisotropic(graph: &mut Graph, d: usize, mandel: &[[f64; 6]; 6], strain: &[Node]) -> Vec<Node> {
    let list = components(d);
    let row = |&(i, j): &(usize, usize)| {
        let entries = list.iter().zip(strain).map(|(&(k, l), &e)| {
            let count = if k == l { 1.0 } else { 2.0 };
            (count * super::constitutive::component(mandel, d, [i, j, k, l]), e)
        });
        graph.weighted_sum(entries)
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
    let component = |i: usize| {
        let parts = (0..d).map(|j| (1.0, graph.derivative(stress[find(i, j)], AXES[j])));
        let parts: Vec<(f64, Node)> = parts.collect();
        let divergence = graph.weighted_sum(parts);
        graph.neg(divergence)
    };
    (0..d).map(component).collect()
}
