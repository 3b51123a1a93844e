//! A validated scene made computable: the model with its laws, spaces and exact solution.

mod abstract_setup;
mod admissible;
mod constants;
mod formulas;
mod kernel_bounds;
mod laws;
mod load_check;
mod material;
mod mesh_data;
mod regularity;
mod subject;
mod trace_constant;
mod yield_slope;

use std::sync::Arc;

pub use abstract_setup::{AbstractConstants, AbstractLoad, AbstractRun, AbstractSetup};
pub use admissible::admissible;
pub use constants::{
    Constants, Coulomb, MemoryNorms, RegionSlot, Smallness, abstract_decomposition_bound,
    constants, decomposition_bound, falling_sides, growth, step_bounds, with_trace_constants,
};
pub(crate) use formulas::KernelFormula;
pub use formulas::YieldFormula;
use formulas::{on_contact, on_contact_in_time};
use laws::potential;
pub use material::{cell_regions, elasticity, memory_tensor};
pub use mesh_data::{MeshData, RuleCheck, TruthLoad, reference_run, side_numbers};
pub use regularity::{abstract_regularity, sides};
pub use subject::{NewtonMarch, Scheme, StepRemark, Subject, check_step_sizes, subject_bounds};
pub use trace_constant::{TraceConstant, trace_cells, weight_by_side, weighted_trace_constant};
pub use yield_slope::{YieldSlope, ZetaFrom};

use crate::{Body, Contact, ContactScene, Data, Domain, Scene, SceneError, Shape, Side};
use algebra::linalg::EigenError;
use exact::{ComplianceRule, ContactFormulas, Exact, ExactData, FrictionFormulas};
use fem::contact::{Boundary, BoundaryRule, CaseError, Discretization, MemoryTerm, Model};
use fem::mesh::Mesh;
use fem::space::Element;
use formula::Node;
use vhi::finite::FiniteError;
use vhi::history::{FastConvolution, TimeGrid};
use vhi::law::{AnyProjection, Summed, VonMises};

/// What is made of a scene.
pub type Result<T, E = SetupError> = std::result::Result<T, E>;

/// Why a scene could not be set up or run.
#[derive(Debug, thiserror::Error)]
pub enum SetupError {
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A constant of the mesh could not be computed.
    #[error("mesh n = {n}: {source}")]
    Constant { n: u32, source: EigenError },
    #[error("reference run: {0}")]
    Reference(#[from] CaseError),
    /// A level of an abstract problem failed.
    #[error(transparent)]
    Finite(#[from] FiniteError),
    /// There is nothing to measure errors against.
    #[error("scene `{scene}` has neither an exact solution nor a reference run")]
    NoTruth { scene: String },
}

/// A scene with its model and exact solution.
pub struct Setup {
    pub scene: Scene,
    pub body: ContactScene,
    pub model: Model,
    /// If the scene has one.
    pub exact: Option<Arc<Exact>>,
    /// L_κ, and up to which ζ it holds.
    pub kappa: YieldSlope,
    /// The solver under test; by default [`NewtonMarch`].
    pub scheme: Arc<dyn Scheme>,
}

impl Setup {
    /// Builds model and exact solution, and checks what needs them: λ ≥ 0, u_ν ≤ g, (2.9), ….
    ///
    /// # Errors
    /// Those of [`admissible`]; κ without a Lipschitz constant.
    pub fn new(scene: Scene) -> Result<Self> {
        let Body::Contact(body) = &scene.body else {
            let message = "an abstract problem has no body, mesh or contact";
            let hint =
                "this command needs a scene of the contact problem, without kind = \"abstract\"";
            return Err(scene.error("scene.kind", message, hint).into());
        };
        scene.check_sweep()?;
        let body = ContactScene::clone(body);
        let model = model(&scene, &body);
        let exact = exact(&scene, &body).map(Arc::new);
        let scheme = Arc::new(NewtonMarch);
        let kappa = YieldSlope { lipschitz: 0.0, zeta: f64::INFINITY, from: ZetaFrom::Everywhere };
        let mut setup = Self { scene, body, model, exact, kappa, scheme };
        admissible(&setup)?;
        setup.kappa = yield_slope::yield_slope(&setup)?;
        Ok(setup)
    }

    /// V^h on the mesh with n cells per unit length, with the regions of its cells.
    ///
    /// # Errors
    /// A cell that the boundary of a region cuts.
    pub fn space(&self, n: u32) -> Result<Arc<Discretization>> {
        let ContactScene { domain, material, element, .. } = &self.body;
        let mut space = discretized(domain, *element, domain.mesh(n));
        space.regions = material::cell_regions(&self.scene, material, &space.mesh, n)?;
        Ok(Arc::new(space))
    }

    /// Whether the lines of this mesh follow the boundaries of all regions.
    ///
    /// # Errors
    /// A cell that is cut, or that two regions claim.
    pub fn check_regions(&self, n: u32) -> Result<(), SceneError> {
        let material = &self.body.material;
        if material.regions.is_empty() {
            return Ok(());
        }
        material::cell_regions(&self.scene, material, &self.body.domain.mesh(n), n).map(drop)
    }

    /// The model that the scene states; [`Self::model`] may hold other components.
    pub fn scene_model(&self) -> Model {
        model(&self.scene, &self.body)
    }

    /// The projection that the scene states.
    pub fn scene_projection(&self) -> Option<VonMises<YieldFormula>> {
        projection(&self.scene, &self.body)
    }

    /// The grid with the given number of steps.
    ///
    /// # Panics
    /// A number of steps that [`Scene::check_steps`] refuses.
    pub fn grid(&self, steps: u32) -> TimeGrid {
        self.scene.time.grid(steps).unwrap_or_else(|error| panic!("{error}"))
    }

    /// The scene with non-exponential kernels interpolated to an error; for None, with direct sums for all kernels.
    pub fn with_history(mut self, interpolated_to: Option<f64>) -> Self {
        let by_sums = |term: MemoryTerm| match (term.kernel.exponentials(), interpolated_to) {
            (Some(_), Some(_)) => term,
            _ if term.kernel.nested().is_some() => term,
            _ => {
                let kernel = Box::new(Summed { kernel: term.kernel, interpolated_to });
                MemoryTerm { kernel, ..term }
            }
        };
        let terms = std::mem::take(&mut self.model.memory);
        self.model.memory = terms.into_iter().map(by_sums).collect();
        self
    }

    /// Vectors of unknowns held for the history after N steps; interpolated kernels are assumed to be smooth.
    pub fn history_vectors(&self, steps: u32) -> usize {
        let steps = steps as usize;
        let of_term = |term: &MemoryTerm| {
            let trapezoidal = self.model.time_rule.is_trapezoidal();
            let interpolated = |error| FastConvolution::foreseen_vectors(steps, error);
            match term.kernel.exponentials() {
                _ if term.kernel.nested().is_some() => 2 * (steps + 1),
                Some(terms) if trapezoidal => terms.len() + 1,
                None if trapezoidal => {
                    term.kernel.interpolated_to().and_then(interpolated).unwrap_or(steps + 1)
                }
                _ => steps + 1,
            }
        };
        self.model.memory.iter().map(of_term).sum()
    }

    /// Quadrature of the compliance term; irrelevant without contact.
    pub fn rule(&self) -> BoundaryRule {
        self.model.boundary.first().map_or(BoundaryRule::Vertex, |boundary| boundary.rule)
    }

    /// The boundary rule for the manufactured side.
    pub fn compliance_rule(&self) -> ComplianceRule {
        match self.rule() {
            BoundaryRule::Vertex => ComplianceRule::Vertex,
            BoundaryRule::Gauss => ComplianceRule::Gauss,
            BoundaryRule::Exact => ComplianceRule::Exact,
        }
    }

    /// μ of the projection, or 0.
    pub fn projection_mu(&self) -> f64 {
        self.body.material.projection.as_ref().map_or(0.0, |projection| projection.mu)
    }
}

/// V^h on a mesh.
fn discretized(domain: &Domain, element: Element, mesh: Mesh) -> Discretization {
    let sides = [&domain.clamped, &domain.held(), &domain.contact].map(|sides| side_numbers(sides));
    let [clamped, symmetry, contact] = &sides;
    Discretization::with_symmetry(element, mesh, [clamped, symmetry, contact])
}

fn projection(scene: &Scene, body: &ContactScene) -> Option<VonMises<YieldFormula>> {
    let written = body.material.projection.as_ref().filter(|projection| projection.mu > 0.0)?;
    let limit = YieldFormula::new(&scene.formulas, written.kappa);
    Some(VonMises { mu: written.mu, limit })
}

fn model(scene: &Scene, body: &ContactScene) -> Model {
    let material = &body.material;
    let formulas = Arc::new(scene.formulas.clone());
    let boundary = |contact: &Contact| {
        let scale = contact.law.as_ref().and_then(|law| law.scale);
        Boundary {
            sides: side_numbers(&contact.sides),
            potential: potential(contact.law.as_ref()),
            scale: scale.map(|scale| on_contact(&formulas, Some(scale.formula), 1.0)),
            gap: on_contact_in_time(&formulas, contact.gap, f64::INFINITY),
            shift: on_contact(&formulas, contact.shift, 0.0),
            rule: contact.quadrature,
        }
    };
    let touches = body.has_gap() || body.laws().next().is_some();
    Model {
        friction: body.friction().map(|written| laws::friction(written, &formulas)),
        elasticity: elasticity(material),
        memory: material::memory_terms(material, &formulas),
        projection: projection(scene, body)
            .map(|VonMises { mu, limit }| AnyProjection::von_mises(mu, Box::new(limit))),
        boundary: body.contact.iter().filter(|_| touches).map(boundary).collect(),
        time_rule: scene.time.rule.weights(),
    }
}

fn exact(scene: &Scene, body: &ContactScene) -> Option<Exact> {
    let Data::Exact { u, multiplier, selection, friction, .. } = &body.data else { return None };
    let material = &body.material;
    let stated = |by_side: &[(Side, Node)], side: Side| {
        by_side.iter().find(|(known, _)| *known == side).map(|(_, node)| *node)
    };
    let on_side = |contact: &Contact, side: Side| ContactFormulas {
        side: side.0,
        bilateral: body.domain.bilateral,
        gap: contact.gap,
        shift: contact.shift,
        law: contact.law.as_ref().map(crate::Law::numbers),
        scale: contact.law.as_ref().and_then(|law| law.scale).map(|scale| scale.formula),
        multiplier: stated(multiplier, side),
        selection: stated(selection, side),
        friction: contact.friction.as_ref().map(|written| FrictionFormulas {
            bound: written.bound.clone(),
            multiplier: friction.clone(),
        }),
    };
    let sides = body.contact.iter().flat_map(|of| of.sides.iter().map(move |&side| (of, side)));
    let contact = sides.map(|(of, side)| on_side(of, side)).collect();
    let projection = material.projection.as_ref().filter(|projection| projection.mu > 0.0);
    let mut graph = scene.formulas.clone();
    let (numbers, regions) = material::numbers(material, &body.domain.shape, &mut graph);
    Some(Exact::new(ExactData {
        graph,
        u: u.clone(),
        material: numbers,
        regions,
        kernels: material.memory.iter().map(|memory| memory.kernel).collect(),
        inner: (0..).zip(&material.memory).filter_map(|(i, term)| Some((i, term.inner?))).collect(),
        kappa: projection.map(|projection| projection.kappa),
        contact,
        horizon: scene.time.horizon,
        size: body.domain.size.clone(),
        polytope: match &body.domain.shape {
            Shape::Box => None,
            Shape::Refined(coarse) => Some(coarse.clone()),
        },
    }))
}
