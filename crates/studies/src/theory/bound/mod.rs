//! The bound (3.4) on the step size, made measurable: constants, the contraction factor of Λ, and the
//! step size at which the discrete problem itself loses its unique solution. Every inequality is a claim: measured factors ≤
//! sharpened ≤ (3.15) at every k, thresholds the other way, samples ≤ declared constants.

mod ladder;
pub mod sampled;

pub use ladder::{
    Contraction, ContractionStudy, Crossing, FactorAtLevel, Loss, Starts, StepLadder, StepRung,
    Thresholds, contraction, finite_factor, run_to,
};
pub use sampled::{Constant, Obtained};

use self::sampled::{OnMesh, TraceConstants};
use crate::study::{Asked, Result, StudyError, no_mesh};
use ::run::sweep::{Runs, admit_constants};
use algebra::linalg::KRYLOV_VECTORS;
use fem::contact::{Discretization, Evolution};
use judge::claim::{Claim, Place, Statement};
use report::{Axis, Chapter, Chart, Findings, Mark, Part, Scale, Series, digits};
use scene::setup::{AbstractLoad, AbstractSetup, MeshData, Setup, Smallness, Subject, TruthLoad};
use scene::{Extension, Scene};
use serde_json::{Value, json};
use vhi::StepBounds;
use vhi::finite::FiniteEvolution;
use vhi::history::TimeRule;

/// Default mesh of the measured factors.
const MESH: u32 = 16;

/// `sweep bound`.
///
/// # Errors
/// [`StudyError`].
pub fn of_scene(scene: Scene, asked: &Asked) -> Result<Findings> {
    admit_constants(&scene, false, &asked.limit)?;
    let subject = Subject::new(scene)?;
    let scene = subject.scene();
    let singular = "it puts sup |q| beside k, not k^(1-a)";
    scene.without(&[Extension::SingularKernel], "sweep bound", singular)?;
    let fewest = scene.sweep.as_ref().and_then(|sweep| sweep.steps.iter().min().copied());
    let given = asked.steps.as_ref().and_then(|steps| steps.first().copied());
    let steps = given.or(fewest).unwrap_or(8);
    scene.check_steps(&[steps])?;
    let bound = match &subject {
        Subject::Contact(setup) => {
            let n = asked.mesh().unwrap_or(MESH);
            scene.check_cells(n)?;
            // The factors of the volume's tangent and of the inner product, the vectors of an eigenvalue and a ladder's solutions.
            let vectors = KRYLOV_VECTORS + ladder::SOLUTIONS;
            let beside = move |space: &Discretization, _| {
                8.0 * (2.0 * space.factor_size()[0] + (vectors * space.dofs()) as f64)
            };
            let runs = Runs { setup, grid: vec![(n, steps)], beside: Box::new(beside) };
            runs.admit(&asked.limit)?;
            BoundStudy::new(setup, n, steps)
        }
        // An abstract problem keeps a few numbers per level.
        Subject::Abstract(setup) => {
            no_mesh(scene, asked.mesh())?;
            BoundStudy::of_abstract(setup, steps)
        }
    };
    let named = |error| StudyError::Other(format!("{}: {error}", scene.name));
    Ok(bound.map_err(named)?.findings())
}

/// Everything that `sweep bound` says of a scene.
#[derive(Debug, Clone, serde::Serialize)]
pub struct BoundStudy {
    /// Name of the scene.
    pub scene: String,
    /// Fingerprint of the scene's text.
    pub fingerprint: String,
    /// Cells per unit length; none without a mesh.
    pub n: Option<u32>,
    /// N of the run.
    pub steps: u32,
    /// Every constant.
    pub constants: Vec<Constant>,
    /// The bounds, with the constants of the mesh n.
    #[serde(skip)]
    pub limits: StepBounds,
    /// Factors.
    #[serde(flatten)]
    pub study: ContractionStudy,
    /// Every inequality.
    pub claims: Vec<Claim>,
    /// Between what m0 lies, where its sign is unknown.
    #[serde(rename = "m0_unknown")]
    pub unknown: Option<[f64; 2]>,
}

/// The mesh at whose vertices a law with a factor is sampled.
const SAMPLE_MESH: u32 = 4;
/// Rounding of a norm: eigenvalues settle to 1e-13, and the norm is their root.
const NORM: f64 = 1e-9;
/// Rounding of finite perturbations: 1e-13 over 1e-6, with room for the condition.
const FINITE: f64 = 1e-5;
/// Derivative against differences. A kink of Λ that a perturbation of 1e-6 crosses concerns few cells.
const DERIVATIVE: f64 = 0.02;
/// Thresholds are bracketed to 1e-7 relative, a singular tangent is approached to 1e-6.
const THRESHOLD: f64 = 5e-6;
/// Below this bound of the factor Λ reaches 1e-13 within the iterations it is given.
const SURE: f64 = 0.9;
/// Rounding of an eigenvalue that settles to 1e-13.
const EIGENVALUE: f64 = 1e-10;

impl BoundStudy {
    /// Studies a scene on the mesh `n`, along a run with `steps` steps.
    ///
    /// # Errors
    /// [`StudyError`].
    pub fn new(setup: &Setup, n: u32, steps: u32) -> Result<Self> {
        has_last_slot(&*setup.model.time_rule)?;
        let traces = TraceConstants::new(setup, &*setup.space(n)?)?;
        let whole = scene::setup::constants(setup)?;
        let constants = traces.as_ref().map_or_else(|| whole.clone(), |of| of.on_mesh(setup));
        let limits = constants.step_bounds(setup.model.time_rule.as_ref());
        let fits = setup.scene.check_cells(SAMPLE_MESH).is_ok();
        let small = setup.space(if fits { SAMPLE_MESH } else { n })?;
        let samples = sampled::declared(setup, &constants, &small);
        let study = study(setup, &limits, n, steps)?;
        let table = sampled::table(setup, &whole, constants.m0, traces.as_ref());
        let (known, m0) = (whole.smallness(), whole.m0);
        let grid = (Some(n), steps);
        let mut study = Self::of(&setup.scene, grid, table, samples, limits, study, (known, m0));
        // The proved bounds of c_j² and c_ν² against the eigenvalues of meshes, in both masses: of this one, and for c_j² of
        // those for the limit.
        if let Some(TraceConstants { strain, falling, .. }) = &traces {
            let here = |of: &OnMesh| of.values.map(|value| (format!("n = {n}"), value)).to_vec();
            let limit = strain.limit.iter().flat_map(|limit| &limit.values);
            let limit = limit.map(|(cells, value)| (format!("{cells} cells"), *value));
            let strain = here(strain).into_iter().chain(limit).collect();
            let falling = falling.as_ref().map_or(Vec::new(), here);
            for (symbol, bound, values) in [
                ("c_j^2", whole.c_j_squared_bound, strain),
                ("c_nu^2", whole.c_nu_squared_bound, falling),
            ] {
                study.claims.extend(values.into_iter().filter_map(|(at, value)| {
                    let says = (symbol, "on a mesh <= its proved bound");
                    Some(claim(at, says, [value, bound?], EIGENVALUE * bound?))
                }));
            }
        }
        study.unknown = (known == Smallness::Unknown).then_some(whole.m0_range);
        Ok(study)
    }

    /// Studies an abstract scene along a run with `steps` steps.
    ///
    /// # Errors
    /// [`StudyError`].
    pub fn of_abstract(setup: &AbstractSetup, steps: u32) -> Result<Self> {
        let (model, c) = (&setup.model, &setup.constants);
        has_last_slot(&*model.time_rule)?;
        let limits = c.step_bounds(model.time_rule.as_ref());
        let (grid, mut loads) = (&setup.grid(steps), [AbstractLoad(setup), AbstractLoad(setup)]);
        let study = ContractionStudy::new(
            loads.each_mut(),
            |load| FiniteEvolution::new(model, grid, load),
            &limits,
        )?;
        let known = if c.m0 > 0.0 { Smallness::Holds } else { Smallness::Fails };
        let (table, m0) = (sampled::table_of_finite(c, model), (known, c.m0));
        Ok(Self::of(&setup.scene, (None, steps), table, Vec::new(), limits, study, m0))
    }

    /// What follows from all that was found.
    fn of(
        scene: &Scene,
        (n, steps): (Option<u32>, u32),
        constants: Vec<Constant>,
        samples: Vec<Claim>,
        limits: StepBounds,
        study: ContractionStudy,
        (known, m0): (Smallness, f64),
    ) -> Self {
        let mut claims = claims(&limits, &study.rungs, &study.thresholds);
        // 0 < m0: everything that the bound says rests on it.
        if known == Smallness::Fails {
            claims.push(claim("", ("(2.9)", "0 < m0"), [0.0, m0], -f64::MIN_POSITIVE));
        }
        claims.extend(samples);
        if study.worst.k < limits.solvable_limit() {
            let others = f64::from(study.starts.distinct);
            let says = ("uniqueness in the run", "other solutions from random starts <= 0");
            claims.push(claim(at(study.worst.k), says, [others, 0.0], 0.0));
        }
        Self {
            scene: scene.name.clone(),
            fingerprint: scene.source.hash.clone(),
            n,
            steps,
            constants,
            limits,
            study,
            claims,
            unknown: None,
        }
    }

    /// Whether every inequality and every declared constant holds.
    pub fn holds(&self) -> bool {
        Claim::all_hold(&self.claims)
    }
}

/// Without one Λ is constant.
fn has_last_slot(rule: &dyn TimeRule) -> Result<()> {
    let none = || "the time rule gives the last slot no weight: every k is within (3.4)";
    if rule.last_share() == 0.0 { Err(StudyError::other(none())) } else { Ok(()) }
}

fn at(k: f64) -> String {
    format!("k = {}", digits(k, 7))
}

fn claim(
    at: impl Into<String>,
    (source, says): (&'static str, &'static str),
    sides: [f64; 2],
    accuracy: f64,
) -> Claim {
    let place = Place { at: at.into(), ..Place::default() };
    Claim::at_most(Statement { source, says }, place, sides, accuracy)
}

/// The inequalities of a ladder and its thresholds.
pub fn claims(bounds: &StepBounds, rungs: &[StepRung], found: &Thresholds) -> Vec<Claim> {
    let mut claims = Vec::new();
    let one = |solved: bool| f64::from(u8::from(solved));
    for rung in rungs {
        let StepRung { norm, sharpened, theorem, .. } = *rung;
        let rounded = FINITE * if sharpened == 0.0 { 1.0 } else { sharpened };
        let (off, allowed) = ((rung.finite_worst - norm).abs(), DERIVATIVE * norm);
        let mut say = |source, says, left, right, accuracy| {
            claims.push(claim(at(rung.k), (source, says), [left, right], accuracy));
        };
        say("sharpened", "|DLambda| <= sharpened factor", norm, sharpened, NORM * sharpened);
        say("radius", "spectral radius <= |DLambda|", rung.radius, norm, FINITE * norm);
        let finite = "finite factor, worst direction <= sharpened";
        say("finite", finite, rung.finite_worst, sharpened, rounded);
        say("derivative", "|finite - derivative| <= 2 % of it", off, allowed, 0.0);
        say("(3.15)", "sharpened factor <= (3.15)", sharpened, theorem, NORM * theorem);
        say("(3.15)", "(3.15) <= (3.15) in the paper's norm", theorem, rung.paper, 0.0);
        if rung.k < bounds.solvable_limit() {
            let newton = one(rung.newton.is_ok());
            say("solvable", "1 <= Newton finds the guaranteed solution", 1.0, newton, 0.0);
            let others = f64::from(rung.distinct);
            say("uniqueness", "solutions beside the one guaranteed <= 0", others, 0.0, 0.0);
        }
        if sharpened < SURE {
            let solved = one(rung.fixed_point.is_ok());
            say("contraction", "1 <= Lambda converges where it must", 1.0, solved, 0.0);
        }
    }
    let (norm, radius) = (found.norm, found.radius);
    let lost = found.loss.as_ref().map(|loss| loss.bracket[1]);
    let [paper, proved] = [bounds.paper_limit(), bounds.limit()].map(Some);
    let [sharpened, solvable] = [bounds.sharpened_limit(), bounds.solvable_limit()].map(Some);
    let [lower, upper] = [0, 1].map(|end: usize| move |crossing: Crossing| crossing[end]);
    let ordered = [
        ("k of (3.4), the paper's norm <= k of (3.4)", paper, proved),
        ("k of (3.4) <= sharpened k", proved, sharpened),
        ("sharpened k <= solvable k", sharpened, solvable),
        ("sharpened k <= k with |DLambda| = 1", sharpened, norm.map(upper)),
        ("k with |DLambda| = 1 <= k with spectral radius 1", norm.map(lower), radius.map(upper)),
        ("solvable k <= k that loses solvability", solvable, lost),
        ("k with spectral radius 1 <= k that loses solvability", radius.map(lower), lost),
    ];
    for (says, left, right) in ordered {
        // What was not found, or holds for every k, is in no order.
        if let (Some(left), Some(right)) = (left, right.filter(|k| *k != f64::INFINITY)) {
            claims.push(claim("", ("threshold", says), [left, right], THRESHOLD * right));
        }
    }
    claims
}

/// Runs the scene on the mesh `n` with `steps` steps and studies its worst level.
///
/// # Errors
/// [`StudyError`].
pub fn study(setup: &Setup, bounds: &StepBounds, n: u32, steps: u32) -> Result<ContractionStudy> {
    let data = MeshData::new(setup, n, None)?;
    let (grid, truth) = (&setup.grid(steps), &*data.truth);
    let mut loads = [TruthLoad(truth), TruthLoad(truth)];
    let (space, model) = (&*data.space, &setup.model);
    ContractionStudy::new(loads.each_mut(), |load| Evolution::new(space, model, grid, load), bounds)
}

// A step-size study in words, tables and a picture.

impl BoundStudy {
    /// What was found: claims, numbers, words.
    pub fn findings(&self) -> Findings {
        let (study, limits) = (&self.study, &self.limits);
        let title = (Chapter::Bound, format!("The bound measured: {}", self.scene));
        let scene = Some([&*self.scene, &*self.fingerprint]);
        let mut findings = Findings::new(title, scene, self.claims.clone());
        let found = &study.thresholds;
        let document = &mut findings.document;
        document.threshold = Some(match study.not_followed {
            Some(_) => "–".into(),
            None => crossing(study.thresholds.radius),
        });
        if let Some([low, high]) = self.unknown {
            document.words(format!(
                "Whether (2.9) holds is unknown, neither verified nor refused: m0 lies between {} and {}.",
                digits(low, 6),
                digits(high, 6)
            ));
        }
        if let Some(reason) = &study.not_followed {
            document.words(format!("Nothing is measured: {reason}."));
        }
        let columns = "number = number; >k = k";
        document.rows("The bound in four numbers, k below each.", &self.numbers(), columns);
        document.words(format!(
            "Measured in a run with {}; at its level {} (t = {}), where the factor is largest, the last step is taken again with other k. Of {} random starts at k = {} {} end at the same solution, {} elsewhere, {} nowhere.",
            self.grids(),
            study.worst.level,
            digits(study.worst.t, 5),
            study.starts.same + study.starts.distinct + study.starts.failed,
            digits(study.worst.k, 6),
            study.starts.same,
            study.starts.distinct,
            study.starts.failed
        ));
        let mut rungs = json!(study.rungs);
        for row in rungs.as_array_mut().into_iter().flatten() {
            for solver in ["newton", "fixed_point"] {
                if row[solver].is_string() {
                    row[solver] = json!("fails");
                }
            }
        }
        document.rows(
            "Contraction factor of Λ for a last step of size k after the same past, bounds, the iterations that solve the step, and other solutions from random starts.",
            &rungs,
            ">k = k; >spectral radius = radius; >‖DΛ‖ = norm; >sharpened = sharpened; >(3.15) = theorem; \
             >paper's norm = paper_norm; Newton = newton; Λ = fixed_point; >others = distinct",
        );
        document.rows(
            "Constants, how each was obtained, and whether the true one is certainly on the safe side.",
            &json!(self.constants),
            "constant = name; >value = value 11; >± = uncertainty 1; how = how; safe = safe; note = note",
        );
        document.figure(
            "bound",
            "contraction factor of Λ against k, with the bounds of (3.4) (sweep bound).",
            self.svg(),
        );
        // Step sizes up to which something holds: null where it does for every k.
        let loss = found.loss.as_ref();
        let thresholds = json!({
            "paper_norm": limits.paper_limit(),
            "theorem": limits.limit(),
            "sharpened": limits.sharpened_limit(),
            "solvable": limits.solvable_limit(),
            "norm_one": found.norm,
            "radius_one": found.radius,
            "loss": loss.map(|loss| loss.bracket),
            "loss_reason": loss.map(|loss| &loss.reason),
            "loss_eigenvalue": loss.map(|loss| loss.rightmost),
            "not_followed": study.not_followed,
        });
        findings.numbers(json!(self));
        findings.number("thresholds", thresholds);
        findings.number("ratio", self.ratio());
        findings
    }

    /// The measured threshold of Λ over (3.4) with the paper's norms: how many times too strict that is; none if Λ has no
    /// threshold.
    pub fn ratio(&self) -> Option<f64> {
        self.study.thresholds.radius.map(|[low, _]| low / self.limits.paper_limit())
    }

    fn grids(&self) -> String {
        let mesh = self.n.map_or(String::new(), |n| format!("n = {n}, "));
        format!("{mesh}N = {}", self.steps)
    }

    fn numbers(&self) -> Value {
        let (limits, study, found) = (&self.limits, &self.study, &self.study.thresholds);
        let limit = |k: f64| match k {
            k if k.is_infinite() => "every k".into(),
            k if k > 0.0 => digits(k, 9),
            _ => format!("no k: m0 = {}", digits(limits.m0, 7)),
        };
        let mut rows = Vec::new();
        let mut say = |what: &str, value: String| rows.push(json!({ "number": what, "k": value }));
        say("1: (3.4), the paper's norm of ℬ", limit(limits.paper_limit()));
        say("1: (3.4), operator norm", limit(limits.limit()));
        say("2: sharpened, half weight, terms apart", limit(limits.sharpened_limit()));
        if study.not_followed.is_none() {
            say("3: ‖DΛ‖ = 1, measured", crossing(found.norm));
            say("3: spectral radius of DΛ = 1, measured", crossing(found.radius));
        }
        say("4: one solution guaranteed, by monotonicity", limit(limits.solvable_limit()));
        if let Some(loss) = &found.loss {
            let lost = format!("4: the step loses its solution: {}", loss.reason);
            say(&lost, crossing(Some(loss.bracket)));
            say("largest real eigenvalue of DΛ there", digits(loss.rightmost, 6));
        } else if let Some(last) = study.rungs.last() {
            say("4: the step has its solution", format!("> {}", digits(last.k, 5)));
        }
        if let Some(ratio) = self.ratio() {
            say("3 over 1, the paper's norm", digits(ratio, 6));
        }
        rows.into()
    }

    /// Factors of Λ against k with their bounds; none if no number can be drawn.
    fn svg(&self) -> Option<String> {
        let question = format!(
            "Contraction factor of Λ for a last step of size k after the past of level {} ({})",
            self.study.worst.level,
            self.grids()
        );
        let x = Axis::new("step size k (time)", Scale::Log);
        let y = Axis::new("contraction factor", Scale::Log);
        let mut chart = Chart::new(&self.scene, &question, x, y);
        let rungs = &self.study.rungs;
        let of = |of: fn(&StepRung) -> f64| rungs.iter().map(|rung| (rung.k, of(rung))).collect();
        // Some coincide: points are seen on a line, and a broken line is seen on a whole one.
        chart.series = vec![
            Series::new("measured: ‖DΛ‖, worst direction", vec![Part::Points(of(|at| at.norm))]),
            Series::new("measured: spectral radius of DΛ", vec![Part::Line(of(|at| at.radius))]),
            Series::new("sharpened bound", vec![Part::Dashed(of(|rung| rung.sharpened))]),
            Series::new("(3.15), operator norm", vec![Part::Dotted(of(|rung| rung.theorem))]),
            Series::new("(3.15), the paper's norm", vec![Part::Line(of(|rung| rung.paper))]),
        ];
        chart.horizontals = vec![Mark { at: 1.0, label: "Λ contracts below 1".into() }];
        let found = &self.study.thresholds;
        let stops = found.radius.filter(|[low, high]| *low > 0.0 && high.is_finite());
        let marks = [
            (Some(self.limits.paper_limit()), "(3.4), the paper's norm"),
            (Some(self.limits.sharpened_limit()), "sharpened"),
            (stops.map(|[low, _]| low), "Λ stops converging"),
            (found.loss.as_ref().map(|loss| loss.bracket[1]), "the solution ends"),
        ];
        chart.verticals.extend(marks.into_iter().filter_map(|(at, label)| {
            let at = at?;
            let value = if at.is_finite() { digits(at, 4) } else { "every k".into() };
            Some(Mark { at, label: format!("{label}: {value}") })
        }));
        chart.svg()
    }
}

/// Where a factor reaches one.
fn crossing(found: Option<Crossing>) -> String {
    match found {
        None => "every k".into(),
        Some([0.0, k]) => format!("< {}", digits(k, 5)),
        Some([k, f64::INFINITY]) => format!("> {}", digits(k, 5)),
        Some([low, high]) => {
            let off = 0.5 * (high - low).max(1e-15 * high);
            format!("{} ± {off:.0e}", digits(0.5 * (low + high), 9))
        }
    }
}
