//! Ladders: one parameter from the ordinary to the extreme, and what each rung must show.

pub(super) use judge::claim::Relation;

use ::run::sweep::{MemoryLimit, Refused, Runs, without_panic};
use algebra::linalg::{larger, largest};
use fem::contact::{Discretization, KKT_ALLOWED, LevelFields};
use fem::norms::step_errors;
use judge::claim::{Claim, Place, Standing, Statement};
use report::{Cell, Chapter, Findings, Map, Shade};
use scene::setup::{MeshData, Setup};
use scene::{Scene, Source};
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

/// Runs a rung with the parts under test.
pub type Climb = dyn Fn(&UnderTest<'_>) -> Result<Measured> + Send + Sync;

/// One value of the parameter.
pub struct Rung {
    /// The value in words.
    pub at: String,
    /// What it must show of its number, or the words in the first line of a typed error.
    pub expected: Relation,
    /// The run.
    pub run: Box<Climb>,
    /// The largest run of a body in it, if that has more than a few thousand unknowns and levels together.
    pub largest: Option<Largest>,
}

/// A run of a body: its scene, n and N.
pub struct Largest {
    /// The scene file.
    pub text: String,
    /// Cells per unit length.
    pub n: u32,
    /// Steps.
    pub steps: u32,
}

impl Rung {
    pub(crate) fn new(
        at: impl Into<String>,
        expected: Relation,
        run: impl Fn(&UnderTest<'_>) -> Result<Measured> + Send + Sync + 'static,
    ) -> Self {
        Self { at: at.into(), expected, run: Box::new(run), largest: None }
    }

    /// A rung that is one run of a body, its text with n and N, and a number about the answer.
    pub(super) fn body(
        at: impl Into<String>,
        expected: Relation,
        (text, n, steps): (String, u32, u32),
        value: impl Fn(&SceneAnswer) -> f64 + Send + Sync + 'static,
    ) -> Self {
        Self::new(at, expected, move |under_test| {
            let answer = solve(text.clone(), n, steps, under_test.prepare)?;
            Ok(Measured::of(value(&answer), &answer))
        })
    }

    /// Names the largest run of a body in the rung, for the limit of memory.
    pub(super) fn with_largest(self, text: String, n: u32, steps: u32) -> Self {
        Self { largest: Some(Largest { text, n, steps }), ..self }
    }
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

/// 10^e, the nearest double; the powers of ten that `powi` forms by multiplication are not.
pub(super) fn power_of_ten(e: i32) -> f64 {
    format!("1e{e}").parse().unwrap_or(f64::NAN)
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

// Rungs climbed: each is a claim of its ladder, and one of the solver's residual.

/// What the ladder claims of one rung, then the residual where there is one; a panic is a claim that fails and not the end
/// of the others.
pub fn climb(ladder: &Ladder, rung: &Rung, under_test: &UnderTest<'_>) -> Vec<Claim> {
    claims(ladder, &rung.at, rung.expected, &caught(|| (rung.run)(under_test)))
}

/// What a rung claims of its outcome. NaN holds nowhere, and no refusal covers a panic.
pub fn claims(
    ladder: &Ladder,
    at: &str,
    expected: Relation,
    outcome: &Result<Measured>,
) -> Vec<Claim> {
    let statement = Statement { source: ladder.name, says: ladder.quantity };
    let place = Place { at: at.to_owned(), ..Place::default() };
    let none = Claim { statement, place, relation: expected, ..Claim::default() };
    match outcome {
        Err(Unanswered::Panicked(text)) => {
            let relation = Relation::AtMost(f64::NAN);
            vec![Claim { relation, note: text.clone(), ..none }]
        }
        Err(Unanswered::Refused(said)) => vec![Claim { note: said.clone(), ..none }],
        Ok(measured) => {
            let claim = Claim { left: measured.value, note: measured.note.clone(), ..none };
            // A solver may stop without a look at its residual.
            let residual = measured.kkt.map(|kkt| {
                let says = "largest relative residual, by separate evaluation";
                let statement = Statement { source: "KKT", says };
                let at = format!("{} at {at}", ladder.name);
                Claim::at_most(statement, Place { at, ..Place::default() }, [kkt, KKT_ALLOWED], 0.0)
            });
            [Some(claim), residual].into_iter().flatten().collect()
        }
    }
}

/// All that was climbed, the claims of each rung. Files of ladders that were named carry their names, so that one run does
/// not replace another.
pub fn found(ladders: &[Ladder], named: &[String], climbed: &[Vec<Claim>]) -> Findings {
    let title = (Chapter::Extremes, "Ladders and rungs".to_owned());
    let mut findings = Findings::new(title, None, climbed.concat());
    findings.document.scene = (!named.is_empty()).then(|| named.join("-"));
    findings.table(
        "ladders",
        ladders,
        "Ladders: the parameter, and the reason for what is expected.",
        "ladder = name; parameter = parameter; expected because = why",
    );
    let shows = "every rung of the ladders against its expectation (sweep extremes).";
    findings.document.figure("extremes", shows, Some(map(ladders, climbed)));
    findings
}

/// The map of all rungs: one line a ladder, one cell a rung, shaded by how far the measured number is within what is allowed:
/// the lightest at six decades or more, the darkest at the bound.
fn map(ladders: &[Ladder], climbed: &[Vec<Claim>]) -> String {
    let of_ladder = |ladder: &Ladder| -> Vec<Cell> {
        let own = |claims: &&Vec<Claim>| claims[0].statement.source == ladder.name;
        let rungs = climbed.iter().filter(own);
        rungs.map(|claims| (claims[0].place.at.clone(), shade(claims))).collect()
    };
    let shades = || climbed.iter().map(|claims| shade(claims));
    let wrong = shades().filter(|shade| *shade == Shade::Wrong).count();
    let refused = shades().filter(|shade| *shade == Shade::Outside).count();
    Map {
        title: format!("{} rungs of {} ladders", climbed.len(), ladders.len()),
        subtitle: format!("{refused} refused as expected, {wrong} not as expected"),
        rows: ladders.iter().map(|ladder| (ladder.name.to_owned(), of_ladder(ladder))).collect(),
        legend: [
            (Shade::Within(0.3), "as expected, darker nearer the bound"),
            (Shade::Outside, "refused as expected"),
            (Shade::Wrong, "not as expected"),
        ],
        heads: Vec::new(),
        notes: Vec::new(),
    }
    .svg()
}

/// Decades over which the shade goes from the darkest to the lightest.
const DECADES: f64 = 6.0;

fn shade(claims: &[Claim]) -> Shade {
    let holds = claims.iter().all(|claim| claim.standing() == Standing::Passes);
    match claims.first().filter(|_| holds) {
        None => Shade::Wrong,
        Some(Claim { relation: Relation::Refused(_), .. }) => Shade::Outside,
        Some(Claim { relation: Relation::AtMost(most), left, .. }) => {
            let decades = (most.max(f64::MIN_POSITIVE) / left.max(f64::MIN_POSITIVE)).log10();
            Shade::Within(1.0 - decades / DECADES)
        }
        Some(_) => Shade::Within(0.5),
    }
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

// What a rung takes of the memory.

/// Refuses a rung that would take more memory than there may be. One without a mesh, or on a small one, takes next to
/// none.
///
/// # Errors
/// [`Refused`].
pub fn admit(
    ladder: &Ladder,
    rung: &Rung,
    under_test: &UnderTest<'_>,
    limit: &MemoryLimit,
) -> Result<(), Refused> {
    let Some(largest) = &rung.largest else { return Ok(()) };
    // A scene that is refused is so when it is climbed.
    let Ok(setup) = set_up(largest.text.clone(), under_test.prepare) else { return Ok(()) };
    // An answer is all levels: u and σ, in lists that double as they grow, and the moments that they are measured against.
    let answer = |space: &Discretization, steps: u32| {
        let d = space.mesh.dimension;
        let (tensor, cells) = (d * (d + 1) / 2, space.mesh.cell_count());
        let moments = 2 * tensor + d * (d + 1);
        let numbers = 2 * (space.nodes.len() + tensor * cells) + moments * cells;
        8.0 * (f64::from(steps) + 1.0) * numbers as f64
    };
    let grid = vec![(largest.n, largest.steps)];
    let runs = Runs { setup: &setup, grid, beside: Box::new(answer) };
    runs.admit(limit).map_err(|refused| Refused {
        what: format!(
            "{} at {} (other ladders, or none of --long, take less)",
            ladder.name, rung.at
        ),
        source: refused.source,
    })
}
