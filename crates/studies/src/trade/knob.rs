//! What a run may do otherwise than its scene says, one thing at a time, and which of it a scene offers.

use fem::contact::{BoundaryRule, CaseError, CaseInfo, Observer};
use fem::space::Element;
use fem::space::quadrature::{Rule, TruthRules};
use scene::setup::{MeshData, Setup, SetupError};
use scene::{Data, LoadForm, Scene, TimeRule};
use vhi::Newton;
use vhi::history::FastConvolution;
use vhi::law::INTERPOLATED_TO;

/// One departure from the scene as written.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Knob {
    /// No knob is turned.
    AsWritten,
    /// Newton's method ends at this residual, relative to the forces.
    Tolerance(f64),
    /// Its linear solves end at this residual, relative to their right sides.
    LinearTolerance(f64),
    /// Loads in the cells by a rule of this degree: 6 is usual in the weak form, else 4 in the plane and 5 in space; two more
    /// for quadratic elements.
    LoadDegree(u32),
    /// Loads from σ (weak) or from -div σ and σν (strong).
    Form(LoadForm),
    /// Where the compliance is integrated.
    Contact(BoundaryRule),
    /// The history summed directly in place of the recursion or of interpolated kernels.
    DirectHistory,
    /// Kernels that are no sums of exponentials interpolated to this error, relative to their largest value.
    HistoryTolerance(f64),
    /// (4 u_k - u_2k)/3 at the times of 2k, of the two runs: Richardson's extrapolation in k for order 2.
    Extrapolated,
    /// Another element, on other meshes as well.
    Element(Element),
}

/// Residuals at which Newton's method may end. The loosest ones may fail the separate check of the KKT
/// system, which is a row of the table as well.
const TOLERANCES: [f64; 3] = [1e-12, 1e-10, 1e-8];

/// Residuals at which linear solves may end, beside 1e-4.
const LINEAR_TOLERANCES: [f64; 2] = [1e-2, 1e-8];

/// Errors to which kernels may be interpolated, beside 1e-13.
const HISTORY_TOLERANCES: [f64; 3] = [1e-9, 1e-6, 1e-3];

impl serde::Serialize for Knob {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.name())
    }
}

impl Knob {
    /// Its name in tables.
    pub fn name(self) -> String {
        match self {
            Self::AsWritten => "as written".into(),
            Self::Tolerance(value) => format!("tolerance {value:.0e}"),
            Self::LinearTolerance(value) => format!("linear tolerance {value:.0e}"),
            Self::LoadDegree(degree) => format!("loads of degree {degree}"),
            Self::Form(LoadForm::Weak) => "weak loads".into(),
            Self::Form(LoadForm::Strong) => "strong loads".into(),
            Self::Contact(BoundaryRule::Vertex) => "contact by vertices".into(),
            Self::Contact(BoundaryRule::Gauss) => "contact by Gauss points".into(),
            Self::Contact(BoundaryRule::Exact) => "contact exact".into(),
            Self::DirectHistory => "history direct".into(),
            Self::HistoryTolerance(error) => format!("history to {error:.0e}"),
            Self::Extrapolated => "Richardson in k".into(),
            Self::Element(element) => format!("element {}", element.name()),
        }
    }
}

/// The knobs of a scene beside h and k, without those of parts that it lacks.
pub fn knobs(setup: &Setup) -> Vec<Knob> {
    let (body, d, element) = (&setup.body, setup.scene.dimension, setup.body.element);
    let projected = setup.projection_mu() > 0.0;
    let contact = body.contact.as_ref().filter(|c| c.gap.is_some() || c.law.is_some());
    let mut found = Vec::new();
    if projected || contact.is_some() {
        found.extend(TOLERANCES.map(Knob::Tolerance));
    }
    // Other scenes in the plane have one matrix and one factor of it.
    if projected {
        found.extend(LINEAR_TOLERANCES.map(Knob::LinearTolerance));
    }
    if let Data::Exact { interpolated: false, form, .. } = &body.data {
        // The rule and the form of the scene as written are no departure from it.
        let rules = TruthRules::for_element(element, d);
        let as_written = if *form == LoadForm::Weak { rules.stress } else { rules.load };
        // σ is projected onto the strains of the element: fewer points do not tell these apart.
        let least = element.strain_rule(d).points.len();
        let other = |rule: &Rule| *rule != as_written && rule.points.len() >= least;
        let others = [1, 2, 4, 6].into_iter().filter(|&degree| other(&load_rule(d, degree)));
        found.extend(others.map(Knob::LoadDegree));
        found.push(Knob::Form(match form {
            LoadForm::Weak => LoadForm::Strong,
            LoadForm::Strong => LoadForm::Weak,
        }));
    }
    // A jump has no value at a point that is held there; edges are cut in the plane alone.
    let law = contact.and_then(|contact| contact.law.as_ref());
    if law.is_some_and(|law| !law.is_set_valued()) {
        let rules = [BoundaryRule::Vertex, BoundaryRule::Gauss, BoundaryRule::Exact].into_iter();
        let other = rules.filter(|&rule| rule != setup.rule() && rule.serves(element));
        found
            .extend(other.filter(|rule| d == 2 || *rule != BoundaryRule::Exact).map(Knob::Contact));
    }
    if !body.material.memory.is_empty() && setup.scene.time.rule == TimeRule::Trapezoid {
        found.push(Knob::DirectHistory);
        if body.material.memory.iter().any(|memory| memory.exponentials.is_none()) {
            found.extend(HISTORY_TOLERANCES.map(Knob::HistoryTolerance));
        }
    }
    let others = Element::ALL.into_iter().filter(|&other| other != element);
    let admitted = others.filter(|&other| setup.scene.with_element(other).is_ok());
    found.extend(admitted.map(Knob::Element));
    found
}

impl Knob {
    /// Whether the knob changes a run of so many steps: short sums over the past are direct anyway.
    pub(crate) fn matters(self, setup: &Setup, steps: u32) -> bool {
        let kernels = || setup.model.memory.iter().map(|term| &term.kernel);
        let long = |error| steps as usize >= FastConvolution::foreseen_from(error);
        match self {
            Self::DirectHistory => {
                kernels().any(|kernel| kernel.exponentials().is_some()) || long(INTERPOLATED_TO)
            }
            Self::HistoryTolerance(error) => long(error),
            _ => true,
        }
    }
}

/// A scene with one knob turned.
pub struct Variant {
    /// The knob that is turned.
    pub knob: Knob,
    /// The scene that way.
    pub setup: Setup,
    rules: TruthRules,
    newton: Option<Newton>,
}

impl Variant {
    /// Turns a knob that a scene has.
    ///
    /// # Errors
    /// The scene cannot be set up.
    pub fn new(scene: &Scene, knob: Knob) -> Result<Self, SetupError> {
        let scene = match knob {
            Knob::Element(element) => scene.with_element(element)?,
            _ => scene.clone(),
        };
        let d = scene.dimension;
        let mut setup = Setup::new(scene)?;
        let (mut rules, mut newton) = (TruthRules::for_element(setup.body.element, d), None);
        match knob {
            Knob::AsWritten | Knob::Extrapolated | Knob::Element(_) => {}
            Knob::Tolerance(value) => {
                let rounding_units = value / f64::EPSILON;
                newton = Some(Newton { rounding_units, ..Newton::default() });
            }
            Knob::LinearTolerance(linear_tolerance) => {
                newton = Some(Newton { linear_tolerance, ..Newton::default() });
            }
            Knob::LoadDegree(degree) => {
                rules.load = load_rule(d, degree);
                rules.stress = rules.load.clone();
            }
            Knob::Form(wanted) => {
                if let Data::Exact { form, .. } = &mut setup.body.data {
                    *form = wanted;
                }
            }
            Knob::Contact(rule) => {
                setup.model.boundary.iter_mut().for_each(|boundary| boundary.rule = rule);
            }
            Knob::DirectHistory => setup = setup.with_history(None),
            Knob::HistoryTolerance(error) => setup = setup.with_history(Some(error)),
        }
        Ok(Self { knob, setup, rules, newton })
    }

    /// The element that it has.
    pub(crate) fn element(&self) -> Element {
        self.setup.body.element
    }

    /// Whether it is the scene as written with another element.
    pub(crate) fn is_element(&self) -> bool {
        matches!(self.knob, Knob::Element(_))
    }

    /// Mesh and loads, from nothing.
    ///
    /// # Errors
    /// A cell that the boundary of a region cuts.
    pub(crate) fn on_mesh(&self, n: u32) -> Result<MeshData, SetupError> {
        MeshData::with_rules(&self.setup, n, None, &self.rules)
    }

    /// One run.
    ///
    /// # Errors
    /// The solver's.
    pub(crate) fn march(
        &self,
        data: &MeshData,
        steps: u32,
        observe: &mut Observer<'_>,
    ) -> Result<CaseInfo, CaseError> {
        match &self.newton {
            Some(newton) => data.march(&self.setup, steps, newton, observe),
            None => self.setup.scheme.march(&self.setup, data, steps, observe),
        }
    }
}

/// The rule of a degree: the centroid for 1, d + 1 points for 2, else the usual rule (of degree 4, in space 5) or the next
/// stronger one (6).
fn load_rule(dimension: usize, degree: u32) -> Rule {
    let corners = dimension + 1;
    match degree {
        0 | 1 => Rule { points: vec![vec![1.0 / corners as f64; corners]], weights: vec![1.0] },
        2 => {
            // Barycentric (a, …, a, 1 - d a): a² summed over the corners has its mean 2/((d+1)(d+2)) for
            // a = (1 - 1/√(d+2))/(d+1).
            let a = (1.0 - 1.0 / ((dimension + 2) as f64).sqrt()) / corners as f64;
            let point = |corner: usize| {
                let mut point = vec![a; corners];
                point[corner] = 1.0 - dimension as f64 * a;
                point
            };
            let weights = vec![1.0 / corners as f64; corners];
            Rule { points: (0..corners).map(point).collect(), weights }
        }
        3..=5 => TruthRules::of(dimension).load,
        _ => TruthRules::stronger(dimension).load,
    }
}

#[cfg(test)]
mod tests;
