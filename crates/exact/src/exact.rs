//! An exact solution: formulas for u, λ, ξ, and what follows from them.

use std::sync::Arc;

use super::AccumulatedStrain;
use super::constitutive::{Tensor, full};
use super::curve::CurveNumbers;
use super::friction::FrictionFormulas;
use super::number::Number;
use super::symbolic;
use super::zeta_domain::Domain;
use fem::mesh::{CoarseMesh, Mesh, in_dimension};
use formula::{Graph, Node, Program, Variable};

/// Numbers of the material, as the scene states them.
#[derive(Debug, Clone, PartialEq)]
pub struct MaterialNumbers {
    /// λ.
    pub lambda: f64,
    /// μ_L.
    pub mu_l: f64,
    /// 𝒜 in Mandel notation (the leading block of order d(d+1)/2) in place of λ and μ_L.
    pub full: Option<[[f64; 6]; 6]>,
    /// (λ_ℬ, μ_ℬ) of each term of the memory.
    pub memory: Vec<(f64, f64)>,
    /// μ of the projection.
    pub projection: Option<f64>,
}

/// A part of the body with a different material; parts do not overlap.
#[derive(Debug, Clone, PartialEq)]
pub struct RegionNumbers {
    /// A formula in the coordinates, positive inside.
    pub condition: Node,
    pub material: MaterialNumbers,
}

/// A piecewise linear law by its points and outer slopes, plus a curve.
#[derive(Debug, Clone, PartialEq)]
pub struct LawNumbers {
    /// (r, p(r)); a repeated abscissa is a jump.
    pub points: Vec<[f64; 2]>,
    pub slope_before: f64,
    pub slope_after: f64,
    pub curve: Option<CurveNumbers>,
}

/// Contact data of a side as formulas.
#[derive(Debug, Clone, Default)]
pub struct ContactFormulas {
    /// Its number.
    pub side: u32,
    /// u_ν = 0, in place of a gap and a law.
    pub bilateral: bool,
    /// g(x), if there is a constraint.
    pub gap: Option<Node>,
    /// s(x): the law is evaluated at u_ν - s.
    pub shift: Option<Node>,
    /// ∂j_ν, without the factor.
    pub law: Option<LawNumbers>,
    /// c(x): the law is c ∂j_ν; None is 1.
    pub scale: Option<Node>,
    /// λ(x, t).
    pub multiplier: Option<Node>,
    /// ξ(x, t), where ∂j_ν(u_ν) is an interval.
    pub selection: Option<Node>,
    /// S and s.
    pub friction: Option<FrictionFormulas>,
}

impl ContactFormulas {
    /// c p(u_ν - s); None without a law.
    pub(super) fn compliance(&self, graph: &mut Graph, u_nu: Node) -> Option<Node> {
        let law = self.law.as_ref()?;
        let shift = self.shift.unwrap_or_else(|| graph.constant(0.0));
        let r = graph.sub(u_nu, shift);
        let p = law_formula(graph, law, r);
        Some(self.scale.map_or(p, |scale| graph.mul(scale, p)))
    }
}

/// The form of the loads.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LoadForm {
    /// F(v) = ∫ σ:ε(v) + ∫_{Γ3} c v_ν.
    Weak,
    /// F(v) = ∫ f0·v + ∫_{Γ2} f2·v + ∫_{Γ3} h3·v.
    Strong,
}

/// Defining data of an exact solution.
#[derive(Clone)]
pub struct ExactData {
    pub graph: Graph,
    /// u.
    pub u: Vec<Node>,
    /// Material numbers outside all regions.
    pub material: MaterialNumbers,
    /// Regions with other numbers.
    pub regions: Vec<RegionNumbers>,
    /// b_i(t), one per term of the memory.
    pub kernels: Vec<Node>,
    /// r_i(t) where b_i stands before ∫_0^s r_i(s-τ) ε(u(τ)) dτ in place of ε(u(s)), by number of the term.
    pub inner: Vec<(usize, Node)>,
    /// κ(ζ).
    pub kappa: Option<Node>,
    /// One a side of Γ3.
    pub contact: Vec<ContactFormulas>,
    /// T.
    pub horizon: f64,
    /// Lengths of the box from the origin that is, or (with `polytope`) contains, the domain.
    pub size: Vec<f64>,
    /// The coarse simplices of the domain, if it is not a rectangle or box.
    pub polytope: Option<Arc<CoarseMesh>>,
}

impl ExactData {
    /// |Ω|.
    pub(crate) fn measure(&self) -> f64 {
        match &self.polytope {
            None => self.size.iter().product(),
            Some(coarse) => coarse.measure(),
        }
    }
}

/// An exact solution with its compiled formulas.
pub struct Exact {
    /// The graph also contains the derived formulas.
    pub data: ExactData,
    /// ε, upper components.
    pub strain: Vec<Node>,
    /// H_i = ∫ b_i(t-s) ε ds, term by term; empty without memory.
    pub memory: Vec<Node>,
    /// σ as formulas.
    pub stress: Vec<Node>,
    /// f0 = -Div σ.
    pub body_force: Vec<Node>,
    /// [u, ε, H_1, H_2, …].
    pub interior: Program,
    /// [u, ε, σ].
    pub(crate) fields: Program,
    /// f0.
    pub forces: Program,
    /// ζ(t).
    pub zeta: AccumulatedStrain,
}

impl Exact {
    /// Derives strain, memory, stress and forces from `data` and compiles them.
    pub fn new(mut data: ExactData) -> Self {
        let graph = &mut data.graph;
        let strain = symbolic::strain(graph, &data.u);
        let mut memory = Vec::new();
        for (i, &kernel) in data.kernels.iter().enumerate() {
            let inner = data.inner.iter().find(|(term, _)| *term == i);
            let inner = inner.map(|&(_, r)| symbolic::memory(graph, r, &strain));
            memory.extend(symbolic::memory(graph, kernel, inner.as_ref().unwrap_or(&strain)));
        }
        let material = (&data.material, &data.regions[..]);
        let stress = symbolic::stress_in_regions(graph, material, data.kappa, &strain, &memory);
        let body_force = symbolic::body_force(graph, &stress);
        let present = [&data.u[..], &strain].concat();
        let outputs = [&present[..], &memory].concat();
        let interior = Program::compile(graph, &outputs, data.horizon);
        let fields = [&present[..], &stress].concat();
        let fields = Program::compile(graph, &fields, data.horizon);
        let forces = Program::compile(graph, &body_force, data.horizon);
        let needs_zeta = data.kappa.is_some_and(|kappa| graph.depends_on(kappa, Variable::Zeta));
        let domain = match &data.polytope {
            None => Domain::Box(&data.size),
            Some(coarse) => Domain::Coarse(coarse),
        };
        let zeta = AccumulatedStrain::new(graph, &strain, data.horizon, domain, needs_zeta);
        Self { strain, memory, stress, body_force, interior, fields, forces, zeta, data }
    }

    pub(crate) fn dimension(&self) -> usize {
        self.data.u.len()
    }

    /// The region of each point, 0 outside all [`ExactData::regions`].
    pub fn regions_at(&self, points: &[[f64; 3]]) -> Vec<usize> {
        let mut found = vec![0; points.len()];
        if self.data.regions.is_empty() {
            return found;
        }
        let conditions: Vec<Node> = self.data.regions.iter().map(|r| r.condition).collect();
        let program = Program::compile(&self.data.graph, &conditions, self.data.horizon);
        for (index, values) in program.values(points, 0.0, 0.0).iter().enumerate() {
            for (region, value) in found.iter_mut().zip(values) {
                if *value > 0.0 {
                    *region = index + 1;
                }
            }
        }
        found
    }

    /// The region of each cell of a mesh, by its centroid.
    pub fn cell_regions(&self, mesh: &Mesh) -> Vec<usize> {
        if self.data.regions.is_empty() {
            return vec![0; mesh.cell_count()];
        }
        let centroid = vec![1.0 / (mesh.dimension + 1) as f64; mesh.dimension + 1];
        self.regions_at(&mesh.points_of(&mesh.cells(), &[centroid]))
    }

    /// ε and, into `memory`, the histories H_i; `field` gives the outputs of [`Self::interior`] by number.
    #[inline(always)]
    pub fn tensors<const D: usize, T: Number>(
        &self,
        field: impl Fn(usize) -> T,
        memory: &mut Vec<Tensor<D, T>>,
    ) -> Tensor<D, T> {
        let count = self.strain.len();
        let from = |first: usize| full(|k| field(first + k));
        memory.clear();
        for term in 0..self.memory.len() / count {
            memory.push(from(D + count * (1 + term)));
        }
        from(D)
    }

    /// σ at points.
    pub(crate) fn stress_at<const D: usize>(&self, points: &[[f64; 3]], t: f64) -> Vec<Tensor<D>> {
        let out = self.fields.values(points, t, self.zeta.at(t));
        let first = D + self.strain.len();
        (0..points.len()).map(|p| full(|k| out[first + k][p])).collect()
    }

    /// The largest of `known`, and of |u| and |σ| by components at points.
    pub fn sizes(&self, points: &[[f64; 3]], t: f64, known: [f64; 2]) -> [f64; 2] {
        let out = self.fields.values(points, t, self.zeta.at(t));
        let parts = [&out[..self.dimension()], &out[self.dimension() + self.strain.len()..]];
        let most = |part: usize| {
            let values = parts[part].iter().flatten();
            values.fold(known[part], |most, value| most.max(value.abs()))
        };
        [most(0), most(1)]
    }

    /// u_ν and |σ_τ| at points with the unit normal ν.
    pub fn across(&self, normal: &[f64; 3], points: &[[f64; 3]], t: f64) -> Vec<[f64; 2]> {
        in_dimension!(self.dimension(), D => {
            let sigma = self.stress_at::<D>(points, t);
            let u = self.interior.values(points, t, 0.0);
            let along = |v: [f64; D]| v.iter().zip(normal).map(|(v, n)| v * n).sum::<f64>();
            let one = |(p, sigma): (usize, Tensor<D>)| {
                let traction = sigma.map(along);
                let pressed = along(traction);
                let sheared = (0..D).map(|i| (traction[i] - pressed * normal[i]).powi(2));
                [along(std::array::from_fn(|i| u[i][p])), sheared.sum::<f64>().sqrt()]
            };
            sigma.into_iter().enumerate().map(one).collect()
        })
    }

    /// The numbers of a region.
    pub fn material_in(&self, region: usize) -> &MaterialNumbers {
        match region {
            0 => &self.data.material,
            named => &self.data.regions[named - 1].material,
        }
    }

    /// κ(ζ(t)), infinite without projection.
    pub fn kappa(&self, t: f64) -> f64 {
        let Some(kappa) = self.data.kappa else { return f64::INFINITY };
        let at = formula::EvaluationPoint { zeta: self.zeta.at(t), ..Default::default() };
        self.data.graph.evaluate(kappa, &at)
    }

    /// What a side of Γ3 has.
    pub fn contact_on(&self, side: u32) -> Option<&ContactFormulas> {
        self.data.contact.iter().find(|contact| contact.side == side)
    }

    /// Programs on a part of a side with outward normal ν: [u_ν, c = ξ + λ, g]. ξ is the scene's selection, or else the
    /// law at u_ν - s.
    pub fn boundary(&self, side: u32, normal: &[f64]) -> BoundaryFormulas {
        self.boundary_at(side, normal, None)
    }

    /// The fields of a side on a coordinate plane: terms that vanish there are left out.
    pub(super) fn boundary_at(
        &self,
        side: u32,
        normal: &[f64],
        plane: Option<(Variable, f64)>,
    ) -> BoundaryFormulas {
        let mut graph = self.data.graph.clone();
        let u_nu = normal_component(&mut graph, &self.data.u, normal);
        let zero = graph.constant(0.0);
        let contact = self.contact_on(side);
        let law = contact.and_then(|contact| contact.compliance(&mut graph, u_nu));
        let xi = match (contact.and_then(|contact| contact.selection), law) {
            (Some(selection), _) => selection,
            (None, law) => law.unwrap_or(zero),
        };
        let lambda = contact.and_then(|contact| contact.multiplier).unwrap_or(zero);
        let pressure = graph.add(xi, lambda);
        let gap = contact.and_then(|contact| contact.gap);
        let gap = gap.unwrap_or_else(|| graph.constant(f64::INFINITY));
        let mut outputs = [u_nu, pressure, gap, xi, lambda];
        on_plane(&mut graph, &mut outputs, plane);
        let [u_nu, _, gap, xi, lambda] = outputs;
        let program = Program::compile(&graph, &outputs, self.data.horizon);
        BoundaryFormulas { graph, program, normal: u_nu, xi, lambda, gap }
    }
}

/// Formulas on a part of Γ3.
pub struct BoundaryFormulas {
    pub graph: Graph,
    /// [u_ν, ξ + λ, g, ξ, λ].
    pub program: Program,
    /// u_ν.
    pub normal: Node,
    /// ξ.
    pub xi: Node,
    /// λ.
    pub lambda: Node,
    /// g.
    pub gap: Node,
}

/// a·u.
pub(super) fn normal_component(graph: &mut Graph, u: &[Node], normal: &[f64]) -> Node {
    graph.weighted_sum(normal.iter().copied().zip(u.iter().copied()))
}

/// Formulas where a coordinate has a value.
pub(super) fn on_plane(graph: &mut Graph, formulas: &mut [Node], plane: Option<(Variable, f64)>) {
    if let Some((axis, value)) = plane {
        let value = graph.constant(value);
        formulas.iter_mut().for_each(|formula| *formula = graph.substitute(*formula, axis, value));
    }
}

/// p(r) as nested choices between its linear pieces, plus the curve.
pub(super) fn law_formula(graph: &mut Graph, law: &LawNumbers, r: Node) -> Node {
    let inner = law.points.windows(2).filter(|pair| pair[1][0] > pair[0][0]).map(|pair| {
        let slope = (pair[1][1] - pair[0][1]) / (pair[1][0] - pair[0][0]);
        (pair[1][0], pair[0], slope)
    });
    let [first, last] = [law.points[0], law.points[law.points.len() - 1]];
    let before = std::iter::once((first[0], first, law.slope_before));
    let line = "value + slope*(r - place)";
    let numbers = [("place", last[0]), ("value", last[1]), ("slope", law.slope_after)];
    let mut formula = graph.written(line, &[("r", r)], &numbers);
    for (end, [place, value], slope) in before.chain(inner).rev() {
        let numbers = [("end", end), ("place", place), ("value", value), ("slope", slope)];
        let (nodes, text) =
            ([("r", r), ("beyond", formula)], format!("if(r < end, {line}, beyond)"));
        formula = graph.written(&text, &nodes, &numbers);
    }
    match law.curve {
        None => formula,
        Some(curve) => {
            let curve = curve.formula(graph, r);
            graph.add(formula, curve)
        }
    }
}
