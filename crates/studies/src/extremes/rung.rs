//! Ladders: one parameter from the ordinary to the extreme, and what each rung must show.

use ::run::sweep::without_panic;
use algebra::linalg::{larger, largest};
use fem::contact::LevelFields;
use fem::norms::step_errors;
use judge::claim::Relation;
use scene::setup::{MeshData, Setup};
use scene::{Scene, Source};
use serde::Deserialize;
use vhi::Newton;

/// What a run measured.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// The number that the ladder is about.
    pub value: f64,
    /// Largest relative KKT residual by separate evaluation, where there is one.
    pub kkt: Option<f64>,
    /// What else was seen; empty mostly.
    pub note: String,
}

impl Measured {
    /// A number without a solve behind it.
    pub fn number(value: f64) -> Self {
        Self { value, kkt: None, note: String::new() }
    }

    /// A number about an answer.
    pub(crate) fn of(value: f64, answer: &SceneAnswer) -> Self {
        Self { kkt: Some(answer.kkt), ..Self::number(value) }
    }

    /// What was measured, with a remark.
    pub(crate) fn noted(self, note: impl Into<String>) -> Self {
        Self { note: note.into(), ..self }
    }
}

/// One value of the parameter.
pub struct Rung {
    /// The value in words.
    pub at: String,
    /// What it must show of its number, or the words in the first line of a typed error.
    pub expected: Relation,
    /// The value, NaN of words.
    pub(super) value: f64,
    pub(super) measure: Measure,
    /// The scene with its n and N, and that of the rung which it is compared with, by name and value.
    pub(super) text: String,
    pub(super) n: u32,
    pub(super) steps: u32,
    pub(super) other: (String, f64, String),
    /// Of length, stiffness, time and displacement.
    pub(super) units: [f64; 4],
}

/// A number about the run of a rung.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Measure {
    /// The largest error of the strains relative to the displacements, and of the stresses relative to them.
    Strain,
    Stress,
    /// The order in k of the former, from N = 8 to 64.
    Order,
    /// The size of the displacements, and iterations: nothing of either.
    Nothing,
    /// Difference of the displacements to those of the other rung, as they are or each over its load; of all fields.
    Displacement,
    Scaled,
    Distance,
    /// The error over Céa's bound, with a remark on the error or on the angles of cells.
    Cea,
    CeaAndError,
    CeaAndAngle,
    /// The same of a large λ on n and n/2, with what is left of the order.
    Locking,
    /// Of one vertex in contact, against the closed form.
    Vertex,
    /// The relative error of a scene in ℝ by Newton's method, or by Λ.
    Newton,
    Lambda,
    /// Change of the nondimensional answer in other units, of scenes in the plane and of all.
    Plane,
    All,
}

/// All values of one parameter.
#[derive(serde::Serialize)]
pub struct Ladder {
    /// Its name on the command line.
    pub name: &'static str,
    /// The parameter.
    pub parameter: &'static str,
    /// What is measured.
    pub quantity: &'static str,
    /// Why the expectation is what it is.
    pub why: &'static str,
    /// From the first value to the last.
    #[serde(skip)]
    pub rungs: Vec<Rung>,
}

// What one run of a scene answers, as far as extremes are judged by it.

/// Puts the solver under test into a setup.
pub type Prepare<'a> = dyn Fn(Setup) -> Setup + Sync + 'a;

/// The discrete solution at all levels, and its errors where the exact one is known.
#[derive(Debug, Clone, Default)]
pub struct SceneAnswer {
    /// Nodal displacements, level after level.
    pub displacement: Vec<f64>,
    /// Stresses of the cells (Mandel).
    pub stress: Vec<f64>,
    /// ξ + λ at the points of Γ3.
    pub pressure: Vec<f64>,
    /// ζ_n.
    pub zeta: Vec<f64>,
    /// The largest errors over time in V, L², of the stress, of the trace and of the pressure.
    pub errors: Option<[f64; 5]>,
    /// Newton iterations over all levels.
    pub iterations: u32,
    /// The largest relative KKT residual, by separate evaluation.
    pub kkt: f64,
}

/// What a rung shows.
pub type Result<T, E = Unanswered> = std::result::Result<T, E>;

/// Why there is no answer.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Unanswered {
    /// A typed error of scene, setup or solver: its first line.
    #[error("{0}")]
    Refused(String),
    /// A panic: an internal error, never expected.
    #[error("{0}")]
    Panicked(String),
}

impl Unanswered {
    pub(super) fn refused(error: impl std::fmt::Display) -> Self {
        let text = error.to_string();
        let first = text.lines().find(|line| !line.trim().is_empty()).unwrap_or_default();
        Self::Refused(first.trim_start_matches("error: ").to_owned())
    }
}

/// `run`, with a panic as a value: the other rungs go on.
pub(super) fn caught<T>(run: impl FnOnce() -> Result<T>) -> Result<T> {
    without_panic(|| Ok(run())).unwrap_or_else(|text| Err(Unanswered::Panicked(text)))
}

/// A scene set up from its text.
///
/// # Errors
/// What scene or setup refuse.
pub(crate) fn set_up(text: String, prepare: &Prepare<'_>) -> Result<Setup> {
    let source = Source::from_text("extreme.toml", text);
    let scene = Scene::from_source(source).map_err(Unanswered::refused)?;
    Ok(prepare(Setup::new(scene).map_err(Unanswered::refused)?))
}

/// Solves a scene, given by its text, on the mesh n with so many steps.
///
/// # Errors
/// What scene, setup or solver refuse.
pub fn solve(text: String, n: u32, steps: u32, prepare: &Prepare<'_>) -> Result<SceneAnswer> {
    let setup = set_up(text, prepare)?;
    let data = MeshData::new(&setup, n, None).map_err(Unanswered::refused)?;
    march(&setup, &data, steps)
}

/// Marches a setup and keeps every level.
///
/// # Errors
/// The solver's.
pub(crate) fn march(setup: &Setup, data: &MeshData, steps: u32) -> Result<SceneAnswer> {
    let mut answer = SceneAnswer::default();
    let exact = setup.exact.is_some();
    let info = setup.scheme.march(setup, data, steps, &mut |view| {
        let fields = LevelFields::of(&data.space, &setup.model, view);
        answer.displacement.extend(&fields.u);
        answer.stress.extend(&fields.stress);
        answer.pressure.extend(&fields.pressure);
        answer.zeta.push(view.zeta);
        if exact {
            let moments = data.truth.moments(view.t)?;
            let e = step_errors(&data.space, &setup.model, view, &moments);
            let now = [e.v, e.l2, e.stress, e.trace, e.pressure];
            let worst = answer.errors.unwrap_or_default();
            answer.errors = Some(std::array::from_fn(|i| larger(worst[i], now[i])));
        }
        Ok(())
    });
    let info = info.map_err(Unanswered::refused)?;
    answer.iterations = info.newton_iterations;
    answer.kkt = info.kkt_residual;
    Ok(answer)
}

impl SceneAnswer {
    /// The largest difference of two answers over all fields, each relative to the larger of its two
    /// sizes; errors relative to the size of what they are errors of. NaN where the fields do not match.
    pub fn distance(&self, other: &Self) -> f64 {
        let pairs = [
            (&self.displacement, &other.displacement),
            (&self.stress, &other.stress),
            (&self.pressure, &other.pressure),
            (&self.zeta, &other.zeta),
        ];
        let fields = pairs.map(|(a, b)| relative(a, b)).into_iter().fold(0.0, larger);
        let (Some(a), Some(b)) = (self.errors, other.errors) else {
            let both = self.errors.is_none() && other.errors.is_none();
            return if both { fields } else { f64::NAN };
        };
        let [u, sigma] = [largest(&other.displacement), largest(&other.stress)];
        let sizes = [sigma, u, sigma, u, sigma];
        let errors = (0..5).map(|i| (a[i] - b[i]).abs() / sizes[i].max(f64::MIN_POSITIVE));
        errors.fold(fields, larger)
    }
}

/// max |a_i - b_i| / max |b_i|; 0 of two zero fields.
pub(super) fn relative(a: &[f64], b: &[f64]) -> f64 {
    if a.len() != b.len() {
        return f64::NAN;
    }
    let difference = a.iter().zip(b).fold(0.0, |worst, (a, b)| larger(worst, (a - b).abs()));
    let size = larger(largest(a), largest(b));
    if difference == 0.0 { 0.0 } else { difference / size }
}

// The parts that the ladders test; a test passes in wrong ones.

/// The parts under test.
pub struct UnderTest<'a> {
    /// Puts the solver into a setup of a body.
    pub prepare: &'a Prepare<'a>,
    /// Solves the levels of abstract scenes, and of the iteration Λ.
    pub newton: Newton,
}

impl Default for UnderTest<'_> {
    fn default() -> Self {
        Self { prepare: &|setup| setup, newton: Newton::default() }
    }
}
