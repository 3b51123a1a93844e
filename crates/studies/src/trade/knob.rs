//! What a run may do otherwise than its scene says, one thing at a time, and which of it a scene offers.

use algebra::linalg::Precision;
use fem::contact::{BoundaryRule, CaseError, CaseInfo, Observer};
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
    /// Factors that serve several Jacobians in this precision.
    Factors(Precision),
    /// Loads in the cells by a rule of this degree: 6 is usual in the weak form, else 4 in the plane and 5 in space.
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
}

/// Residuals at which Newton's method may end. The loosest ones may fail the separate check of the KKT
/// system, which is a row of the table as well.
const TOLERANCES: [f64; 3] = [1e-12, 1e-10, 1e-8];

/// Residuals at which linear solves may end, beside 1e-4.
const LINEAR_TOLERANCES: [f64; 2] = [1e-2, 1e-8];

/// Errors to which kernels may be interpolated, beside 1e-13.
const HISTORY_TOLERANCES: [f64; 3] = [1e-9, 1e-6, 1e-3];

impl Knob {
    /// Its name in tables.
    pub(crate) fn name(self) -> String {
        match self {
            Self::AsWritten => "as written".into(),
            Self::Tolerance(value) => format!("tolerance {value:.0e}"),
            Self::LinearTolerance(value) => format!("linear tolerance {value:.0e}"),
            Self::Factors(Precision::Single) => "factors in single".into(),
            Self::Factors(Precision::Double) => "factors in double".into(),
            Self::LoadDegree(degree) => format!("loads of degree {degree}"),
            Self::Form(LoadForm::Weak) => "weak loads".into(),
            Self::Form(LoadForm::Strong) => "strong loads".into(),
            Self::Contact(BoundaryRule::Vertex) => "contact by vertices".into(),
            Self::Contact(BoundaryRule::Gauss) => "contact by Gauss points".into(),
            Self::Contact(BoundaryRule::Exact) => "contact exact".into(),
            Self::DirectHistory => "history direct".into(),
            Self::HistoryTolerance(error) => format!("history to {error:.0e}"),
            Self::Extrapolated => "Richardson in k".into(),
        }
    }
}

/// The knobs of a scene beside h and k. What it lacks it does not offer.
pub fn knobs(setup: &Setup) -> Vec<Knob> {
    let (body, d) = (&setup.body, setup.scene.dimension);
    let projected = setup.projection_mu() > 0.0;
    let contact = body.contact.as_ref().filter(|c| c.gap.is_some() || c.law.is_some());
    let mut found = Vec::new();
    if projected || contact.is_some() {
        found.extend(TOLERANCES.map(Knob::Tolerance));
    }
    // Other scenes in the plane have one matrix and one factor of it, in double precision.
    if projected {
        found.extend(LINEAR_TOLERANCES.map(Knob::LinearTolerance));
        found.extend([Precision::Single, Precision::Double].map(Knob::Factors));
    }
    if let Data::Exact { interpolated: false, form, .. } = &body.data {
        // That of the scene as written is no departure from it.
        let other = if *form == LoadForm::Weak { 4 } else { 6 };
        found.extend([1, 2, other].map(Knob::LoadDegree));
        found.push(Knob::Form(match form {
            LoadForm::Weak => LoadForm::Strong,
            LoadForm::Strong => LoadForm::Weak,
        }));
    }
    // A jump has no value at a point that is held there; edges are cut in the plane alone.
    let law = contact.and_then(|contact| contact.law.as_ref());
    if law.is_some_and(|law| !law.is_set_valued()) {
        let rules = [BoundaryRule::Vertex, BoundaryRule::Gauss, BoundaryRule::Exact].into_iter();
        let other = rules.filter(|&rule| rule != setup.rule());
        found
            .extend(other.filter(|rule| d == 2 || *rule != BoundaryRule::Exact).map(Knob::Contact));
    }
    if !body.material.memory.is_empty() && setup.scene.time.rule == TimeRule::Trapezoid {
        found.push(Knob::DirectHistory);
        if body.material.memory.iter().any(|memory| memory.exponentials.is_none()) {
            found.extend(HISTORY_TOLERANCES.map(Knob::HistoryTolerance));
        }
    }
    found
}

impl Knob {
    /// Whether a run of so many steps is another one with this knob turned: short sums over the past are direct anyway.
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
    /// Turns a knob of a scene; none where the scene does not have it.
    ///
    /// # Errors
    /// The scene cannot be set up.
    pub fn new(scene: &Scene, knob: Knob) -> Result<Option<Self>, SetupError> {
        let mut setup = Setup::new(scene.clone())?;
        let (mut rules, mut newton) = (TruthRules::of(scene.dimension), None);
        match knob {
            Knob::AsWritten | Knob::Extrapolated => {}
            Knob::Tolerance(value) => {
                let rounding_units = value / f64::EPSILON;
                newton = Some(Newton { rounding_units, ..Newton::default() });
            }
            Knob::LinearTolerance(linear_tolerance) => {
                newton = Some(Newton { linear_tolerance, ..Newton::default() });
            }
            Knob::Factors(precision) => setup.precision = Some(precision),
            Knob::LoadDegree(degree) => {
                rules.load = load_rule(scene.dimension, degree);
                rules.stress = rules.load.clone();
            }
            Knob::Form(wanted) => match &mut setup.body.data {
                Data::Exact { form, .. } => *form = wanted,
                Data::Loads { .. } => return Ok(None),
            },
            Knob::Contact(rule) => match &mut setup.model.boundary {
                Some(boundary) => boundary.rule = rule,
                None => return Ok(None),
            },
            Knob::DirectHistory => setup = setup.with_history(None),
            Knob::HistoryTolerance(error) => setup = setup.with_history(Some(error)),
        }
        Ok(Some(Self { knob, setup, rules, newton }))
    }

    /// Mesh and loads, from nothing.
    ///
    /// # Errors
    /// [`SetupError::Mesh`].
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

/// The rule of a degree: 1 and 2 are the centroid and the rule of d + 1 points; the degrees of the usual rules (4, in
/// space 5) and of the next ones (6) are theirs.
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
mod tests {
    use super::*;

    fn scene(name: &str) -> Scene {
        let path = format!("{}/../../manufactured/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        Scene::read(path.as_ref()).unwrap_or_else(|error| panic!("{error}"))
    }

    fn offered(name: &str) -> Vec<String> {
        let setup = Setup::new(scene(name)).unwrap_or_else(|error| panic!("{error}"));
        knobs(&setup).into_iter().map(Knob::name).collect()
    }

    #[test]
    fn a_scene_offers_what_it_has() {
        assert_eq!(
            offered("pure-mild"),
            [
                "tolerance 1e-12",
                "tolerance 1e-10",
                "tolerance 1e-8",
                "linear tolerance 1e-2",
                "linear tolerance 1e-8",
                "factors in single",
                "factors in double",
                "loads of degree 1",
                "loads of degree 2",
                "loads of degree 4",
                "strong loads",
                "contact by Gauss points",
                "contact exact",
                "history direct",
            ]
        );
        // No law, no rule for it; loads given as formulas are what they are.
        assert!(!offered("signorini").iter().any(|knob| knob.starts_with("contact")));
        assert_eq!(offered("linear-punch"), ["history direct"]);
        let general = ["history direct", "history to 1e-9", "history to 1e-6", "history to 1e-3"];
        assert!(offered("power-law").ends_with(&general.map(String::from)));
        // Nothing is integrated where u lives in V^h, and the plane alone cuts edges.
        assert!(!offered("in-space").iter().any(|knob| knob.contains("loads")));
        assert!(!offered("pure-box").iter().any(|knob| knob == "contact exact"));
    }

    /// Sums over a short past are direct whatever is asked for; a recursion is another sum from the first step on.
    #[test]
    fn history_knobs_are_turned_where_they_change_the_sum() {
        let setup = |name| Setup::new(scene(name)).unwrap_or_else(|error| panic!("{error}"));
        let from = |knob: Knob, name| {
            let setup = setup(name);
            (1..2000).find(|&steps| knob.matters(&setup, steps))
        };
        assert_eq!(from(Knob::DirectHistory, "linear-punch"), Some(1));
        // 21 steps a node: 4 nodes for 1e-3, 8 for 1e-6, 12 for 1e-9, 16 for 1e-13.
        let errors = [1e-3, 1e-6, 1e-9].map(Knob::HistoryTolerance);
        let found = errors.map(|knob| from(knob, "power-law"));
        assert_eq!(found, [Some(84), Some(168), Some(252)]);
        assert_eq!(from(Knob::DirectHistory, "power-law"), Some(336));
    }

    /// A tolerance is one for general kernels: sums of exponentials keep their recursion, in what is predicted as well.
    #[test]
    fn a_history_tolerance_leaves_recursions_alone() {
        let vectors = |name, interpolated_to: Option<Option<f64>>| {
            let setup = Setup::new(scene(name)).unwrap_or_else(|error| panic!("{error}"));
            let setup = match interpolated_to {
                Some(error) => setup.with_history(error),
                None => setup,
            };
            setup.history_vectors(1000)
        };
        let [written, loose, direct] =
            [None, Some(Some(1e-3)), Some(None)].map(|to| vectors("linear-punch", to));
        // One state and the last level; all levels.
        assert_eq!([written, loose, direct], [2, 2, 1001]);
        let [written, loose, direct] =
            [None, Some(Some(1e-3)), Some(None)].map(|to| vectors("power-law", to));
        assert!(loose < written && written < direct && direct == 1001, "{loose} {written}");
    }

    /// Looser sums are other sums, by no more than what they are allowed, and hold less.
    #[test]
    fn looser_histories_move_the_solution_by_what_they_say() {
        let run = |knob: Knob| {
            let variant = Variant::new(&scene("power-law"), knob).unwrap().expect("a knob");
            let data = variant.on_mesh(4).unwrap();
            let mut all = Vec::new();
            let mut observe = |view: &fem::contact::StepView<'_>| {
                all.extend_from_slice(view.u);
                Ok(())
            };
            let info = variant.march(&data, 700, &mut observe).unwrap();
            (all, info.peak_history_bytes)
        };
        let (direct, all) = run(Knob::DirectHistory);
        let largest = direct.iter().fold(0.0f64, |most, u| most.max(u.abs()));
        let mut bytes = all;
        for (knob, error) in [
            (Knob::AsWritten, INTERPOLATED_TO),
            (Knob::HistoryTolerance(1e-9), 1e-9),
            (Knob::HistoryTolerance(1e-6), 1e-6),
            (Knob::HistoryTolerance(1e-3), 1e-3),
        ] {
            let (u, held) = run(knob);
            let off = u.iter().zip(&direct).fold(0.0f64, |most, (a, b)| most.max((a - b).abs()));
            // ∫b is below 1/2 and the resolvent of this kernel below 2; rounding of 700 terms.
            assert!(off <= (error + 1e-13) * largest, "{}: {off:e}", knob.name());
            // So smooth a kernel has rounding by the nodes of 1e-9.
            assert!(error < 1e-8 || off > 1e-13 * largest, "{}: {off:e}", knob.name());
            assert!(held < bytes, "{}: {held} and {bytes} bytes", knob.name());
            bytes = held;
        }
    }

    /// The last displacements of a short run with one knob turned, and its passes over factors.
    fn run(knob: Knob) -> (Vec<f64>, u32) {
        let variant = Variant::new(&scene("pure-strong"), knob).unwrap().expect("a knob");
        let data = variant.on_mesh(8).unwrap();
        let mut last = Vec::new();
        let mut observe = |view: &fem::contact::StepView<'_>| {
            last = view.u.to_vec();
            Ok(())
        };
        let info = variant.march(&data, 8, &mut observe).unwrap();
        (last, info.work.linear.solves)
    }

    #[test]
    fn linear_solves_of_any_kind_have_the_same_solution_and_are_really_others() {
        let (own, _) = run(Knob::AsWritten);
        let largest = own.iter().fold(0.0f64, |most, u| most.max(u.abs()));
        let solves = [
            Knob::LinearTolerance(1e-2),
            Knob::LinearTolerance(1e-8),
            Knob::Factors(Precision::Single),
            Knob::Factors(Precision::Double),
        ]
        .map(|knob| {
            let (u, solves) = run(knob);
            // 16 units of rounding of the forces, times a condition number below 1e4.
            let off = u.iter().zip(&own).fold(0.0f64, |most, (a, b)| most.max((a - b).abs()));
            assert!(off < 1e-10 * largest, "{}: {off:e}", knob.name());
            (u, solves)
        });
        let [(_, loose), (_, strict), (single, _), (double, _)] = solves;
        assert!(loose < strict, "{loose} and {strict} passes");
        // Iterations may be as many; the last bits are others.
        assert!(single != double);
        // So few unknowns have factors in double precision as they are.
        assert_eq!(double, own);
    }

    /// Mean of a polynomial over the simplex: ∏ α_i! d!/(d + Σα)!.
    #[test]
    fn rules_have_their_degree_and_no_more() {
        let mean = |rule: &Rule, powers: [i32; 2]| -> f64 {
            let value = |p: &Vec<f64>| p[0].powi(powers[0]) * p[1].powi(powers[1]);
            rule.points.iter().zip(&rule.weights).map(|(p, w)| w * value(p)).sum()
        };
        for d in [2usize, 3] {
            let exact = |powers: [i32; 2]| {
                let factorial = |n: i32| (1..=n).map(f64::from).product::<f64>();
                let d = d as i32;
                let top = factorial(powers[0]) * factorial(powers[1]) * factorial(d);
                top / factorial(d + powers[0] + powers[1])
            };
            let off = |degree: u32, powers: [i32; 2]| {
                (mean(&load_rule(d, degree), powers) - exact(powers)).abs()
            };
            // A few roundings of numbers below 1; a missed degree is 1e-3 and more.
            assert!(off(1, [1, 0]) < 1e-15 && off(1, [2, 0]) > 1e-3);
            assert!(off(2, [2, 0]) < 1e-15 && off(2, [1, 1]) < 1e-15 && off(2, [3, 0]) > 1e-4);
            assert!(off(6, [5, 1]) < 1e-14);
        }
    }
}
