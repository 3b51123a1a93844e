//! Loads given as formulas f0, f2, and the reference run that replaces their solution.

use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use crate::Side;
use algebra::linalg::dot;
use exact::{ByTime, Truth};
use fem::contact::{Discretization, LoadError, facet_measure};
use fem::norms::{Moments, ReferenceError, ReferenceRun, Refinement};
use fem::space::Simplex;
use fem::space::quadrature::{Rule, TruthRules};
use formula::{BoundProgram, Graph, Node, Program};

/// F(t)(v) = ∫ f0·v + ∫_{Γ2} f2·v on one mesh, a term for the body and one for each side.
pub(crate) struct GivenLoad(Vec<Term>);

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
        let mesh = &space.mesh;
        let cell = |c| (mesh.cell(c), space.geometry.measure[c], space.cell_nodes(c).to_vec());
        let node = |&vertex: &u32| space.nodes.of_vertex[vertex as usize];
        let facet = |f| {
            let nodes = space.nodes.on_facet(f).iter().map(node).collect();
            (mesh.facet(f), facet_measure(mesh, f), nodes)
        };
        let inside =
            Term::new((graph, horizon), body, space, &rules.load, (0..mesh.cell_count()).map(cell));
        let outside = traction.iter().map(|(side, formulas)| {
            let facets = mesh.facets_on(std::slice::from_ref(&side.0)).map(facet);
            Term::new((graph, horizon), formulas, space, &rules.traction, facets)
        });
        Self(std::iter::once(inside).chain(outside).flatten().collect())
    }

    fn at(&self, t: f64, space: &Discretization) -> Result<Vec<f64>, LoadError> {
        let mut force = vec![0.0; space.nodes.len()];
        self.0.iter().for_each(|term| term.add_to(t, &mut force));
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

/// ∫ f·v over a part of the body or its boundary, of the components of f that are not zero.
struct Term {
    dimension: usize,
    components: Vec<usize>,
    /// f at the points of the rule.
    bound: Mutex<BoundProgram>,
    /// Of each shape function its values at the points of the rule, times their weights.
    shapes: Vec<Vec<f64>>,
    /// Of each simplex in turn.
    measures: Vec<f64>,
    nodes: Vec<u32>,
}

impl Term {
    /// The term on simplices with their corners, measures and nodes; None if f is zero.
    fn new<'a>(
        (graph, horizon): (&Graph, f64),
        formulas: &[Node],
        space: &'a Discretization,
        rule: &Rule,
        simplices: impl Iterator<Item = (&'a [u32], f64, Vec<u32>)>,
    ) -> Option<Self> {
        let dimension = space.mesh.dimension;
        let is_zero = |i: &usize| graph.value_of_constant(formulas[*i]) == Some(0.0);
        let components: Vec<usize> = (0..formulas.len()).filter(|i| !is_zero(i)).collect();
        if components.is_empty() {
            return None;
        }
        let simplex = match rule.points[0].len() == dimension {
            true => Simplex::facet(dimension),
            false => Simplex::cell(dimension),
        };
        let values: Vec<_> =
            rule.points.iter().map(|b| space.element.values_on(simplex, b)).collect();
        let of_points =
            |a: usize| values.iter().zip(&rule.weights).map(|(v, w)| w * v[a]).collect();
        let shapes = (0..values[0].len()).map(of_points).collect();
        let (mut points, mut measures, mut nodes) = (Vec::new(), Vec::new(), Vec::new());
        for (corners, measure, of_simplex) in simplices {
            points.extend(rule.points.iter().map(|b| space.mesh.point(corners, b)));
            measures.push(measure);
            nodes.extend(of_simplex);
        }
        let nonzero: Vec<Node> = components.iter().map(|&i| formulas[i]).collect();
        let bound = Mutex::new(Program::compile(graph, &nonzero, horizon).bind(&points));
        Some(Self { dimension, components, bound, shapes, measures, nodes })
    }

    /// Adds the integral at time t to a nodal vector.
    fn add_to(&self, t: f64, force: &mut [f64]) {
        let values = self.bound.lock().unwrap_or_else(PoisonError::into_inner).values_at(t, 0.0);
        for (component, values) in self.components.iter().zip(&values) {
            let nodes = self.nodes.chunks_exact(self.shapes.len());
            let of_simplices = nodes.zip(values.chunks_exact(self.shapes[0].len()));
            for (measure, (nodes, values)) in self.measures.iter().zip(of_simplices) {
                for (shape, &node) in self.shapes.iter().zip(nodes) {
                    force[self.dimension * node as usize + component] +=
                        measure * dot(shape, values);
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
