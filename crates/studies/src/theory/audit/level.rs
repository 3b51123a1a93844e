//! Every quantity of the proofs at one level t_n.

use std::sync::Arc;

use super::contact::{ContactIntegrals, Traces, over_contact, scheme_terms};
use super::discrete::{DiscreteLevel, Past, kernel_weights, primed_weights, strains};
use super::fields::{CellValues, Fields};
use super::integrals::{Cells, NodalField, Sum, over_cells, tractions};
use super::law::ClarkeLaw;
use super::pointwise::{PlainMaterial, Plane, dot};
use fem::contact::{Boundary, Discretization, LoadError, StepView};
use fem::space::Element;
use scene::setup::Setup;
use vhi::history::TimeGrid;

/// The numbers of one level, in the notation of section 4 of the paper; w1 = v^h - u, w2 = u^{kh} - u.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct LevelIntegrals {
    /// k, the largest step.
    pub k: f64,
    /// Integrals over Ω.
    pub cells: Cells,
    /// Integrals over Γ3.
    pub contact: ContactIntegrals,
    /// F(w1), F(w2).
    pub load: [Sum; 2],
    /// Measured quadrature error of (σ, ε(w)) - F(w), both w.
    pub quadrature: [f64; 2],
    /// F(v^h - u^{kh}) by the scheme's load vector.
    pub scheme_load: Sum,
    /// ⟨Au^{kh}, v^h - u^{kh}⟩ + φ(S^{kh}u^{kh}, u^{kh}, v^h - u^{kh}) by the rule of the scheme.
    pub scheme_stress: Sum,
    /// j_ν⁰, Σ w λ(g - v^h) and the selection's slack, by the scheme's rule.
    pub scheme_contact: [Sum; 3],
    /// ∫ λ(v^h_ν - g)₊ and ∫ λ(u^{kh}_ν - g)₊ of elements whose constraint at the nodes lets them pass the gap elsewhere.
    pub outside: Option<[f64; 2]>,
    /// ‖S_n u - S_n^{kh} u^{kh}‖_Y.
    pub history: f64,
    /// ‖S_n u - S_n^k u‖_Y.
    pub truncation: f64,
    /// Σ_{j ≤ n} ‖u_j - u_j^{kh}‖_V.
    pub errors: f64,
}

/// A run on its way: what a level is computed from, and the levels so far.
pub(crate) struct Levels<'a> {
    /// V^h.
    space: Arc<Discretization>,
    /// t_0, …, t_N.
    grid: TimeGrid,
    /// A, φ, S.
    material: PlainMaterial,
    /// ∂j_ν.
    law: ClarkeLaw,
    /// g, s and the rule of the scheme; none without contact.
    boundary: Option<&'a Boundary>,
    past: Past,
    /// ‖u_j - u_j^{kh}‖_V.
    errors: Vec<f64>,
    /// ‖ε(u_j)‖.
    norms: Vec<f64>,
    remembered: Vec<Vec<Plane>>,
}

impl<'a> Levels<'a> {
    /// Before the first level; none unless the material is plain.
    pub(crate) fn new(setup: &'a Setup, space: &Arc<Discretization>, steps: u32) -> Option<Self> {
        Some(Self {
            space: space.clone(),
            grid: setup.grid(steps),
            material: PlainMaterial::new(setup)?,
            law: ClarkeLaw::of(setup),
            boundary: setup.model.boundary.as_ref(),
            past: Past::default(),
            errors: Vec::new(),
            norms: Vec::new(),
            remembered: Vec::new(),
        })
    }

    /// The level that `view` shows; `load` is the scheme's F_n.
    ///
    /// # Errors
    /// The truth's.
    pub(crate) fn next(
        &mut self,
        fields: &mut dyn Fields,
        view: &StepView<'_>,
        load: &[f64],
    ) -> Result<LevelIntegrals, LoadError> {
        let (space, material) = (&*self.space, &self.material);
        let t = view.t;
        let discrete = self.past.level(space, material, &self.grid, view.u);
        let zeta = fields.zeta(t)?;
        let kappa = material.kappa(zeta.unwrap_or(f64::NAN));
        let v = fields.interpolant(t)?;
        let strain = strains(space, &v);
        let v_field = NodalField { nodal: &v, strain: &strain };
        let u_field = NodalField { nodal: view.u, strain: &discrete.strain };
        let volume = fields.volume(t, zeta.unwrap_or(f64::NAN))?;
        let of = |sums: &mut Cells, values| {
            over_cells(sums, space, material, kappa, values, &discrete, [&v_field, &u_field])
        };
        let mut cells = Cells::default();
        of(&mut cells, &volume.plain);
        let fine = of(&mut cells, &volume.crossed);
        let coarse = of(&mut Cells::default(), &volume.check);
        let quadrature =
            [0, 1].map(|i: usize| fine.iter().zip(&coarse).map(|(a, b)| (a[i] - b[i]).abs()).sum());
        let traces = Traces { v: traces(space, &v), u_h: traces(space, view.u) };
        let edges = fields.edges(t, zeta.unwrap_or(f64::NAN), &[&traces.v, &traces.u_h])?;
        let (mut contact, mut scheme_contact) = (ContactIntegrals::default(), [Sum::default(); 3]);
        let lambda = fields.nodal_multiplier(t)?;
        if let Some(boundary) = self.boundary {
            contact = over_contact(space, &self.law, &edges, &traces, boundary, lambda.as_deref());
            scheme_contact = scheme_terms(space, &self.law, boundary, view, &traces, contact.j_h_v);
        }
        let by_vector = |w: &mut dyn Iterator<Item = f64>| product(load, w);
        let load_of = match lambda {
            // In strong form: ∫ f0·w + ∫_{Γ2} f2·w + ∫_{Γ3} h3·w.
            None => {
                let edge = tractions(space, material, kappa, &edges, [&v, view.u]);
                [0, 1].map(|i: usize| cells.force[i].plus(edge[i]).plus(contact.work[i]))
            }
            // u = v^h: w1 = 0, and w2 is in V^h.
            Some(_) => {
                let w = &mut view.u.iter().zip(&v).map(|(u_h, u)| u_h - u);
                [Sum::default(), by_vector(w)]
            }
        };
        let scheme_load = by_vector(&mut v.iter().zip(view.u).map(|(v, u_h)| v - u_h));
        let theta = cells.theta.sqrt();
        let zeta_error = zeta.map_or(0.0, |zeta| (zeta - discrete.zeta).abs());
        self.errors.push(cells.e.sqrt());
        self.norms.push(cells.strain.sqrt());
        let remembered = fields.remembered(t)?;
        Ok(LevelIntegrals {
            k: self.grid.largest_step(),
            load: load_of,
            quadrature,
            scheme_load,
            scheme_stress: scheme_stress(space, material, &discrete, &strain),
            scheme_contact,
            outside: (space.element != Element::P1).then_some(contact.outside),
            history: zeta_error + theta,
            truncation: self.truncation(view.n, zeta, remembered),
            errors: self.errors.iter().sum(),
            cells,
            contact,
        })
    }

    /// ‖S_n u - S_n^k u‖_Y: what the trapezoidal rule makes of the truth.
    fn truncation(&mut self, n: usize, zeta: Option<f64>, now: CellValues) -> f64 {
        let weights = primed_weights(&self.grid, n);
        let sum: f64 = weights.iter().zip(&self.norms).map(|(w, norm)| w * norm).sum();
        let accumulated = zeta.map_or(0.0, |zeta| (zeta - sum).abs());
        if !self.material.remembers() {
            return accumulated;
        }
        self.remembered.push(now.strain);
        let factors = kernel_weights(&self.material, &self.grid, weights);
        let mut square = 0.0;
        for (p, weight) in now.at.weights.iter().enumerate() {
            let history: Plane = std::array::from_fn(|i| {
                let past = self.remembered.iter().zip(&factors);
                now.history[p][i] - past.map(|(strain, f)| f * strain[p][i]).sum::<f64>()
            });
            let theta = self.material.remembered(&history);
            square += weight * dot(&theta, &theta);
        }
        accumulated + square.sqrt()
    }
}

fn scheme_stress(
    space: &Discretization,
    material: &PlainMaterial,
    discrete: &DiscreteLevel,
    v: &[Plane],
) -> Sum {
    let mut sum = Sum::default();
    for at in space.points() {
        let (strain, psi) = (&discrete.strain[at.index], &discrete.coupled[at.index]);
        let applied = material.operator(strain);
        for i in 0..3 {
            sum.add(at.weight * (applied[i] + psi[i]) * (v[at.index][i] - strain[i]));
        }
    }
    sum
}

fn product(load: &[f64], w: &mut dyn Iterator<Item = f64>) -> Sum {
    let mut sum = Sum::default();
    load.iter().zip(w).for_each(|(f, w)| sum.add(f * w));
    sum
}

fn traces(space: &Discretization, nodal: &[f64]) -> Vec<f64> {
    (0..space.trace.points.len()).map(|i| space.trace.normal(i, nodal)).collect()
}
