//! Loads given as formulas f0, f2, and the reference run that replaces their solution.

use std::borrow::Cow;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use crate::Side;
use exact::{ByTime, Truth};
use fem::contact::{Discretization, LoadError, facet_measure};
use fem::norms::{Moments, ReferenceError, ReferenceRun, Refinement};
use fem::space::Simplex;
use fem::space::quadrature::{Rule, TruthRules};
use formula::{BoundProgram, EvaluationPoint, Graph, Node, Program};

/// F(t)(v) = ∫ f0·v + ∫_{Γ2} f2·v on one mesh, as Σ_i a_i(t) F_i.
///
/// Separable formulas give few vectors F_i, assembled once; others are assembled at each time.
pub(crate) struct GivenLoad {
    graph: Graph,
    horizon: f64,
    /// The a_i and F_i.
    factors: Vec<Node>,
    basis: Vec<Vec<f64>>,
    /// Terms that do not separate.
    rest: Vec<Term>,
    rules: TruthRules,
}

#[derive(Clone, Copy)]
enum Part {
    Body,
    Side(u32),
}

impl Part {
    /// The rule on this part, and its simplices.
    fn simplices<'a>(
        self,
        space: &'a Discretization,
        rules: &'a TruthRules,
    ) -> (&'a Rule, Vec<Loaded<'a>>) {
        let mesh = &space.mesh;
        let node = |&vertex: &u32| space.nodes.of_vertex[vertex as usize];
        match self {
            Self::Body => {
                let of = |c: usize| {
                    let nodes = Cow::Borrowed(space.cell_nodes(c));
                    let (corners, measure) = (mesh.cell(c), space.geometry.measure[c]);
                    Loaded { corners, measure, nodes }
                };
                (&rules.load, (0..mesh.cell_count()).map(of).collect())
            }
            Self::Side(side) => {
                let of = |f: usize| {
                    let nodes = Cow::Owned(space.nodes.on_facet(f).iter().map(node).collect());
                    let (corners, measure) = (mesh.facet(f), facet_measure(mesh, f));
                    Loaded { corners, measure, nodes }
                };
                (&rules.traction, mesh.facets_on(&[side]).map(of).collect())
            }
        }
    }
}

impl GivenLoad {
    /// The load of `body` and `traction` formulas on `space`.
    pub(crate) fn new(
        graph: &Graph,
        horizon: f64,
        body: &[Node],
        traction: &[(Side, Vec<Node>)],
        space: &Discretization,
        rules: &TruthRules,
    ) -> Self {
        let mut load = Self {
            graph: graph.clone(),
            horizon,
            factors: Vec::new(),
            basis: Vec::new(),
            rest: Vec::new(),
            rules: rules.clone(),
        };
        let sides =
            traction.iter().map(|(side, formulas)| (Part::Side(side.0), formulas.as_slice()));
        for (part, formulas) in std::iter::once((Part::Body, body)).chain(sides) {
            for (component, &formula) in formulas.iter().enumerate() {
                load.add(part, component, formula, space);
            }
        }
        load.basis.iter_mut().for_each(|vector| vector.truncate(space.dofs()));
        load
    }

    fn add(&mut self, part: Part, component: usize, formula: Node, space: &Discretization) {
        if self.graph.value_of_constant(formula) == Some(0.0) {
            return;
        }
        let term = |graph: &mut Graph, formula, horizon| {
            let program = Program::compile(graph, &[formula], horizon);
            Term { part, component, program, bound: OnceLock::new() }
        };
        let Some(terms) = self.graph.separate(formula) else {
            self.rest.push(term(&mut self.graph, formula, self.horizon));
            return;
        };
        for (factor, shape) in terms {
            let index = self.factors.iter().position(|&known| known == factor);
            let index = index.unwrap_or_else(|| {
                self.factors.push(factor);
                self.basis.push(vec![0.0; space.nodes.len()]);
                self.factors.len() - 1
            });
            let shape = term(&mut self.graph, shape, self.horizon);
            shape.add_to(0.0, space, &self.rules, &mut self.basis[index]);
        }
    }

    fn factors_at(&self, t: f64, out: &mut [f64]) {
        let at = EvaluationPoint { t, ..EvaluationPoint::default() };
        for (value, &factor) in out.iter_mut().zip(&self.factors) {
            *value = self.graph.evaluate(factor, &at);
        }
    }

    fn at(&self, t: f64, space: &Discretization) -> Result<Vec<f64>, LoadError> {
        let mut factors = vec![0.0; self.factors.len()];
        self.factors_at(t, &mut factors);
        let mut force = vec![0.0; space.nodes.len()];
        for (vector, factor) in self.basis.iter().zip(&factors) {
            algebra::linalg::axpy(*factor, vector, &mut force[..vector.len()]);
        }
        for term in &self.rest {
            term.add_to(t, space, &self.rules, &mut force);
        }
        force.truncate(space.dofs());
        if let Some(dof) = force.iter().position(|f| !f.is_finite()) {
            let vertex = space.nodes.vertex[dof / space.nodes.dimension];
            let place = space.mesh.vertex(vertex).to_vec();
            let what = "the load near a vertex".to_string();
            return Err(LoadError::NotFinite { what, value: force[dof], place, t });
        }
        Ok(force)
    }
}

/// A cell or facet under a load.
struct Loaded<'a> {
    corners: &'a [u32],
    measure: f64,
    nodes: Cow<'a, [u32]>,
}

/// ∫ f v_component over a part of the body or its boundary, with f compiled.
struct Term {
    part: Part,
    component: usize,
    program: Program,
    /// The formula bound to the points of the rule.
    bound: OnceLock<Mutex<BoundProgram>>,
}

impl Term {
    /// Adds the integral at time t to a nodal vector.
    fn add_to(&self, t: f64, space: &Discretization, rules: &TruthRules, force: &mut [f64]) {
        let (rule, simplices) = self.part.simplices(space, rules);
        let d = space.mesh.dimension;
        let simplex = match rule.points[0].len() == d {
            true => Simplex::facet(d),
            false => Simplex::cell(d),
        };
        let shapes: Vec<Vec<f64>> =
            rule.points.iter().map(|b| space.element.values_on(simplex, b)).collect();
        let bind = || {
            let points: Vec<[f64; 3]> = simplices
                .iter()
                .flat_map(|simplex| {
                    rule.points.iter().map(|b| space.mesh.point(simplex.corners, b))
                })
                .collect();
            Mutex::new(self.program.bind(&points))
        };
        let mut out = vec![Vec::new()];
        let bound = self.bound.get_or_init(bind);
        bound.lock().unwrap_or_else(PoisonError::into_inner).evaluate(t, 0.0, &mut out);
        let values = out[0].chunks_exact(rule.weights.len());
        for (Loaded { measure, nodes, .. }, values) in simplices.iter().zip(values) {
            for ((value, weight), shapes) in values.iter().zip(&rule.weights).zip(&shapes) {
                let value = weight * measure * value;
                for (&node, shape) in nodes.iter().zip(shapes) {
                    force[space.nodes.dimension * node as usize + self.component] += shape * value;
                }
            }
        }
    }
}

/// Given loads on one mesh, with a reference run in place of the exact solution.
pub(crate) struct ReferenceTruth {
    space: Arc<Discretization>,
    load: GivenLoad,
    reference: Option<Arc<ReferenceRun>>,
    /// Position of the reference mesh within this one.
    refinement: OnceLock<Result<Refinement, ReferenceError>>,
    moments: ByTime<Moments>,
}

impl ReferenceTruth {
    /// Loads of `load`, errors against `reference` (None: the run cannot be measured).
    pub(crate) fn new(
        space: Arc<Discretization>,
        load: GivenLoad,
        reference: Option<Arc<ReferenceRun>>,
    ) -> Self {
        let (refinement, moments) = (OnceLock::new(), ByTime::default());
        Self { space, load, reference, refinement, moments }
    }
}

impl Truth for ReferenceTruth {
    fn load(&self, t: f64) -> Result<Arc<Vec<f64>>, LoadError> {
        self.load.at(t, &self.space).map(Arc::new)
    }

    fn moments(&self, t: f64) -> Result<Arc<Moments>, LoadError> {
        let reference = self.reference.as_ref().ok_or(LoadError::NoTruth { t })?;
        let refused = |error: &ReferenceError| LoadError::Reference { reason: error.to_string() };
        let refinement = self.refinement.get_or_init(|| reference.refinement(&self.space));
        let refinement = refinement.as_ref().map_err(refused)?;
        self.moments.get_or(t, || {
            reference.moments(refinement, &self.space, t).map_err(|error| refused(&error))
        })
    }
}
