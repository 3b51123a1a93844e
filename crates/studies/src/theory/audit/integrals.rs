//! Integrals over Ω and its boundary at one level: sums over points, each with the sum of its absolute
//! values, against which rounding is measured.

use super::discrete::DiscreteLevel;
use super::edges::EdgeSample;
use super::fields::CellValues;
use super::place::CellPoint;
use super::pointwise::{PlainMaterial, Plane, dot, minus};
use fem::contact::Discretization;

/// A sum and the sum of its absolute terms.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Sum {
    /// The value.
    pub value: f64,
    /// The sum of absolute values.
    pub size: f64,
}

impl Sum {
    pub(crate) fn add(&mut self, term: f64) {
        self.value += term;
        self.size += term.abs();
    }

    pub(crate) fn plus(self, other: Self) -> Self {
        Self { value: self.value + other.value, size: self.size + other.size }
    }

    pub(crate) fn minus(self, other: Self) -> Self {
        Self { value: self.value - other.value, size: self.size + other.size }
    }
}

/// What the lines of the proof need from Ω. w1 = v^h - u, w2 = u^{kh} - u.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Cells {
    /// ‖u - u^{kh}‖_V².
    pub e: f64,
    /// ‖u - v^h‖_V².
    pub d: f64,
    /// ‖θ - θ_h‖².
    pub theta: f64,
    /// ⟨Au - Au^{kh}, u - u^{kh}⟩.
    pub monotone: Sum,
    /// E_φ1 of (4.10).
    pub phi1: Sum,
    /// E_φ2 of (4.11).
    pub phi2: Sum,
    /// E_φ3 of (4.27), term by term.
    pub phi3: Sum,
    /// E_A of (4.13).
    pub operator: Sum,
    /// (σ, ε(w1)), (σ, ε(w2)) with σ = Aε + ψ.
    pub stress: [Sum; 2],
    /// ∫ f0·w1, ∫ f0·w2.
    pub force: [Sum; 2],
    /// ⟨Au^{kh}, v^h - u^{kh}⟩ + φ(S^{kh}u^{kh}, u^{kh}, v^h - u^{kh}), where the rule of the scheme need not have it.
    pub at_h: Sum,
    /// ‖σ‖‖ε‖, the unit of rounding where w1 or w2 is rounding itself.
    pub natural: f64,
    /// ‖ε(u)‖².
    pub strain: f64,
}

/// A nodal field of V^h with its strains.
pub(crate) struct NodalField<'a> {
    /// Values at the nodes.
    pub nodal: &'a [f64],
    /// Strains at the strain points.
    pub strain: &'a [Plane],
}

/// The tensors at a point: ε(u), ε(v^h), their differences to_h = ε(u^{kh} - u) and to_v = ε(v^h - u), θ and ψ of u and of
/// u^{kh}.
struct Tensors {
    strain: Plane,
    strain_v: Plane,
    to_h: Plane,
    to_v: Plane,
    theta: Plane,
    theta_h: Plane,
    psi: Plane,
    psi_h: Plane,
}

/// Adds the cells' integrals over `values`; returns per cell (σ, ε(w)) - ∫ f0·w for both w.
pub(crate) fn over_cells(
    sums: &mut Cells,
    space: &Discretization,
    material: &PlainMaterial,
    kappa: f64,
    values: &CellValues,
    discrete: &DiscreteLevel,
    [v, u_h]: [&NodalField<'_>; 2],
) -> Vec<[f64; 2]> {
    let mut residuals = vec![[0.0; 2]; space.mesh.cell_count()];
    let (mut stresses, mut strains) = (0.0, 0.0);
    let points = values.at.points.iter().zip(values.at.cells.iter().zip(&values.at.weights));
    let mut place = CellPoint::new(space);
    for (p, (x, (&c, &weight))) in points.enumerate() {
        let c = c as usize;
        let strain = values.strain[p];
        let [theta, psi, sigma] = material.tensors(&strain, &values.history[p], kappa);
        place.at(c, x);
        let strain_h = place.tensor(&discrete.strain);
        let strain_v = place.tensor(v.strain);
        let theta_h = place.tensor(&discrete.theta);
        let psi_h = material.coupled(&strain_h, &theta_h, discrete.kappa);
        let to_h = minus(&strain_h, &strain);
        let to_v = minus(&strain_v, &strain);
        let tensors = Tensors { strain, strain_v, to_h, to_v, theta, theta_h, psi, psi_h };
        sums.add_tensors(weight, material, &tensors);
        if !place.is_constant() {
            let (applied, test) = (material.operator(&strain_h), minus(&strain_v, &strain_h));
            sums.at_h.add(weight * (dot(&applied, &test) + dot(&psi_h, &test)));
        }
        stresses += weight * dot(&sigma, &sigma);
        strains += weight * dot(&strain, &strain);
        for (i, (field, to)) in [(v, to_v), (u_h, to_h)].into_iter().enumerate() {
            let nodes = space.cell_nodes(c);
            let mut work = 0.0;
            for (component, u) in values.u[p].iter().enumerate() {
                let at = |(shape, node): (&f64, &u32)| {
                    shape * field.nodal[2 * *node as usize + component]
                };
                let w = place.shape.iter().zip(nodes).map(at).sum::<f64>() - u;
                work += values.force[p][component] * w;
            }
            let power = dot(&sigma, &to);
            sums.stress[i].add(weight * power);
            sums.force[i].add(weight * work);
            residuals[c][i] += weight * (power - work);
        }
    }
    sums.natural = sums.natural.hypot((stresses * strains).sqrt());
    sums.strain += strains;
    residuals
}

impl Cells {
    /// Adds the products of the tensors at a point of this weight.
    fn add_tensors(&mut self, weight: f64, material: &PlainMaterial, at: &Tensors) {
        let psi_difference = minus(&at.psi, &at.psi_h);
        let moved = material.operator(&at.to_h);
        let theta_difference = minus(&at.theta, &at.theta_h);
        self.e += weight * dot(&at.to_h, &at.to_h);
        self.d += weight * dot(&at.to_v, &at.to_v);
        self.theta += weight * dot(&theta_difference, &theta_difference);
        self.monotone.add(weight * dot(&moved, &at.to_h));
        self.phi1.add(weight * dot(&psi_difference, &at.to_h));
        self.phi2.add(-weight * dot(&psi_difference, &at.to_v));
        let reflected = minus(&at.strain, &at.to_v);
        for (tensor, factor) in [(reflected, 1.0), (at.strain_v, 1.0), (at.strain, -2.0)] {
            self.phi3.add(factor * weight * dot(&at.psi, &tensor));
        }
        self.operator.add(weight * dot(&moved, &at.to_v));
    }
}

/// (∫ (σν)·w1, ∫ (σν)·w2) over Γ2 and Γ3.
pub(crate) fn tractions(
    space: &Discretization,
    material: &PlainMaterial,
    kappa: f64,
    edges: &[EdgeSample],
    fields: [&[f64]; 2],
) -> [Sum; 2] {
    let mut sums = [Sum::default(); 2];
    for sample in edges {
        let [_, _, s] = material.tensors(&sample.strain, &sample.history, kappa);
        let shear = s[2] * std::f64::consts::FRAC_1_SQRT_2;
        let [x, y] = sample.normal;
        let traction = [s[0] * x + shear * y, shear * x + s[1] * y];
        for (sum, nodal) in sums.iter_mut().zip(fields) {
            for (i, traction) in traction.iter().enumerate() {
                let at = |a: usize| {
                    let node = space.nodes.of_vertex[sample.vertices[a] as usize] as usize;
                    sample.shape[a] * nodal[2 * node + i]
                };
                sum.add(sample.weight * traction * (at(0) + at(1) + at(2) - sample.u[i]));
            }
        }
    }
    sums
}
