//! A validated scene made computable: the model with its laws, the spaces, the truth.

mod abstract_constants;
mod abstract_setup;
mod admissible;
mod constants;
mod formulas;
mod given_load;
mod mesh_data;
mod regularity;
mod rule_check;
mod scheme;
mod step_size;
mod subject;
mod trace_family;

use std::sync::Arc;

pub use abstract_constants::AbstractConstants;
pub use abstract_setup::{AbstractLoad, AbstractRun, AbstractSetup};
pub use admissible::admissible;
pub use constants::{
    Constants, MemoryNorms, constants, step_bounds, trace_levels, with_trace_constant,
};
pub use formulas::{GapFormula, KernelFormula, YieldFormula};
pub use given_load::{GivenLoad, ReferenceTruth};
pub use mesh_data::{MeshData, TruthLoad, reference_run, side_numbers};
pub use regularity::{abstract_regularity, sides};
pub use rule_check::RuleCheck;
pub use scheme::{NewtonMarch, Scheme};
pub use step_size::{StepRemark, check_step_sizes};
pub use subject::Subject;
pub use trace_family::{TraceFamily, trace_family};

use crate::contact::{Boundary, BoundaryRule, CaseError, Discretization, MemoryTerm, Model};
use crate::history::{CorrectedEnd, ProductIntegration, TimeGrid, TimeRule, Trapezoid};
use crate::law::{
    ExponentialSum, Isotropic, MemoryKernel, NoPotential, PiecewiseLinear, Potential, VonMises,
};
use crate::linalg::{EigenError, FactorError};
use crate::manufactured::{
    ComplianceRule, ContactFormulas, Exact, ExactData, LawNumbers, LoadForm, MaterialNumbers,
};
use crate::mesh::{Family, cuboid, rectangle};
use crate::scene::{
    self, Body, ContactQuadrature, ContactScene, Data, MeshFamily, Scene, SceneError, Side,
};

/// The model of a scene.
pub type SceneModel = Model<Option<VonMises<YieldFormula>>>;

/// Why a scene could not be set up or run.
#[derive(Debug, thiserror::Error)]
pub enum SetupError {
    /// The scene file is at fault.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A matrix of the mesh could not be factorized.
    #[error("mesh n = {n}: {source}")]
    Mesh { n: u32, source: FactorError },
    /// A constant of the mesh could not be computed.
    #[error("mesh n = {n}: {source}")]
    Constant { n: u32, source: EigenError },
    /// A solve failed.
    #[error("reference run: {0}")]
    Reference(#[from] CaseError),
    /// The scene has no truth to measure errors against.
    #[error("scene `{scene}` has neither an exact solution nor a reference run")]
    NoTruth { scene: String },
}

/// A scene with its model and exact solution.
pub struct Setup {
    /// The scene as validated.
    pub scene: Scene,
    /// Its body, domain and material.
    pub body: ContactScene,
    /// Its model.
    pub model: SceneModel,
    /// Its exact solution, if it has one.
    pub exact: Option<Arc<Exact>>,
    /// The solver that is measured; [`NewtonMarch`] unless another takes its place.
    pub scheme: Arc<dyn Scheme>,
}

impl Setup {
    /// Builds model and exact solution, and checks what needs them: λ ≥ 0, u_ν ≤ g, (2.9), ….
    ///
    /// # Errors
    /// What [`admissible`] refuses.
    pub fn new(scene: Scene) -> Result<Self, SetupError> {
        let Body::Contact(body) = &scene.body else {
            let message = "an abstract problem has no body, mesh or contact";
            let hint =
                "this command needs a scene of the contact problem, without kind = \"abstract\"";
            return Err(scene.error("scene.kind", message, hint).into());
        };
        let body = body.clone();
        let model = model(&scene, &body);
        let exact = exact(&scene, &body).map(Arc::new);
        let setup = Self { scene, body, model, exact, scheme: Arc::new(NewtonMarch) };
        admissible(&setup)?;
        Ok(setup)
    }

    /// V^h on the mesh with n cells a unit length.
    ///
    /// # Errors
    /// [`SetupError::Mesh`].
    pub fn space(&self, n: u32) -> Result<Arc<Discretization>, SetupError> {
        let domain = &self.body.domain;
        let family = match domain.mesh {
            MeshFamily::Structured => Family::Structured,
            MeshFamily::Perturbed { amplitude, seed } => Family::Perturbed { amplitude, seed },
        };
        let mesh = match domain.size[..] {
            [a, b, c] => cuboid([a, b, c], n, family),
            _ => rectangle([domain.size[0], domain.size[1]], n, family),
        };
        let numbers = |sides: &[Side]| -> Vec<u32> {
            sides.iter().filter_map(|side| mesh.side(side.name())).collect()
        };
        let (clamped, contact) = (numbers(&domain.clamped), numbers(&domain.contact));
        Discretization::new(mesh, &clamped, &contact)
            .map(Arc::new)
            .map_err(|source| SetupError::Mesh { n, source })
    }

    /// The model that the scene states, built anew: [`Self::model`] may hold other components.
    pub fn scene_model(&self) -> SceneModel {
        model(&self.scene, &self.body)
    }

    /// The grid with the given number of steps.
    pub fn grid(&self, steps: u32) -> TimeGrid {
        time_grid(&self.scene.time, steps)
    }

    /// Vectors of unknowns held for the history after N steps.
    pub fn history_vectors(&self, steps: u32) -> usize {
        match &self.body.material.memory {
            None => 0,
            Some(memory) => {
                memory.exponentials.as_ref().map_or(steps as usize + 1, |terms| terms.len() + 1)
            }
        }
    }

    /// Where the compliance term is integrated; without contact the rule does not matter.
    pub fn rule(&self) -> BoundaryRule {
        self.model.boundary.as_ref().map_or(BoundaryRule::Vertex, |boundary| boundary.rule)
    }

    /// The same as the manufactured side names it.
    pub fn compliance_rule(&self) -> ComplianceRule {
        match self.rule() {
            BoundaryRule::Vertex => ComplianceRule::Vertex,
            BoundaryRule::Gauss => ComplianceRule::Gauss,
            BoundaryRule::Exact => ComplianceRule::Exact,
        }
    }

    /// μ of the projection, 0 without.
    pub fn projection_mu(&self) -> f64 {
        self.body.material.projection.as_ref().map_or(0.0, |projection| projection.mu)
    }
}

/// The grid of a scene with the given number of steps.
fn time_grid(time: &scene::Time, steps: u32) -> TimeGrid {
    match time.grid {
        scene::TimeGrid::Uniform => TimeGrid::uniform(time.horizon, steps),
        scene::TimeGrid::Graded { exponent } => TimeGrid::graded(time.horizon, steps, exponent),
        scene::TimeGrid::Random { seed } => TimeGrid::random(time.horizon, steps, seed),
    }
}

/// The rule of a scene.
fn time_rule(time: &scene::Time) -> Box<dyn TimeRule> {
    match time.rule {
        scene::TimeRule::Trapezoid => Box::new(Trapezoid),
        scene::TimeRule::CorrectedEnd { exponent } => Box::new(CorrectedEnd { exponent }),
        scene::TimeRule::ProductIntegration => Box::new(ProductIntegration),
    }
}

fn model(scene: &Scene, body: &ContactScene) -> SceneModel {
    let material = &body.material;
    let formulas = Arc::new(scene.formulas.clone());
    let memory = material.memory.as_ref().map(|memory| MemoryTerm {
        kernel: match &memory.exponentials {
            Some(terms) => Box::new(ExponentialSum { terms: terms.clone() }),
            None => Box::new(KernelFormula::new(formulas.clone(), memory.kernel))
                as Box<dyn MemoryKernel>,
        },
        tensor: Isotropic { lambda: memory.lambda, mu: memory.mu },
    });
    let projection =
        material.projection.as_ref().filter(|projection| projection.mu > 0.0).map(|projection| {
            VonMises {
                mu: projection.mu,
                limit: YieldFormula::new(&scene.formulas, projection.kappa),
            }
        });
    let boundary =
        body.contact.as_ref().filter(|contact| contact.gap.is_some() || contact.law.is_some()).map(
            |contact| Boundary {
                potential: potential(contact.law.as_ref()),
                gap: GapFormula::new(formulas.clone(), contact.gap, f64::INFINITY).boxed(),
                shift: GapFormula::new(formulas.clone(), contact.shift, 0.0).boxed(),
                rule: match contact.quadrature {
                    ContactQuadrature::Vertex => BoundaryRule::Vertex,
                    ContactQuadrature::Gauss => BoundaryRule::Gauss,
                    ContactQuadrature::Exact => BoundaryRule::Exact,
                },
            },
        );
    Model {
        elasticity: Isotropic { lambda: material.lambda, mu: material.mu },
        memory,
        projection,
        boundary,
        time_rule: time_rule(&scene.time),
    }
}

/// The law of a scene; its points were validated, so a refusal here cannot happen and would mean
/// no law.
fn potential(law: Option<&scene::Law>) -> Arc<dyn Potential> {
    let graph = law.and_then(|law| {
        let points = law.points.iter().map(|&[r, p]| (r, p)).collect();
        PiecewiseLinear::new(points, law.slope_before, law.slope_after).ok()
    });
    match graph {
        Some(graph) => Arc::new(graph),
        None => Arc::new(NoPotential),
    }
}

fn exact(scene: &Scene, body: &ContactScene) -> Option<Exact> {
    let Data::Exact { u, multiplier, selection, .. } = &body.data else { return None };
    let material = &body.material;
    let contact = body.contact.as_ref().map(|contact| ContactFormulas {
        gap: contact.gap,
        shift: contact.shift,
        law: contact.law.as_ref().map(|law| LawNumbers {
            points: law.points.clone(),
            slope_before: law.slope_before,
            slope_after: law.slope_after,
        }),
        multiplier: *multiplier,
        selection: *selection,
    });
    let projection = material.projection.as_ref().filter(|projection| projection.mu > 0.0);
    Some(Exact::new(ExactData {
        graph: scene.formulas.clone(),
        u: u.clone(),
        material: MaterialNumbers {
            lambda: material.lambda,
            mu_l: material.mu,
            memory: material.memory.as_ref().map(|memory| (memory.lambda, memory.mu)),
            projection: projection.map(|projection| projection.mu),
        },
        kernel: material.memory.as_ref().map(|memory| memory.kernel),
        kappa: projection.map(|projection| projection.kappa),
        contact,
        horizon: scene.time.horizon,
        size: body.domain.size.clone(),
    }))
}

/// The form of the loads as the manufactured side names it.
pub fn load_form(form: scene::LoadForm) -> LoadForm {
    match form {
        scene::LoadForm::Weak => LoadForm::Weak,
        scene::LoadForm::Strong => LoadForm::Strong,
    }
}
