//! Which n and N have the error that is wanted, from one run and its companions alone.
//!
//! The law of [`Estimate::at`] carries the error of the run to other steps,
//! E(h, k)² = (e_h (h/h₀)^p)² + (e_k (k/k₀)^q)², with an interval from the hull over all readings of the differences;
//! towards finer steps no reading falls faster than elements, rule or theorem allow. [`Candidates::cheapest`] takes the pair of
//! least cost with E ≤ target, and once more with the upper end of the interval in place of E.

use super::{Companions, CostSource, Estimate, costs, norm_estimate};
use crate::trade::{Answer, AtSteps, Candidates, MOST, NoAnswer};
use judge::fit::Interval;
use run::sweep::{MemoryLimit, TooLarge, admit_run, run_cost};
use scene::Norm;
use scene::setup::{Setup, SetupError};

/// Companions go down to a fourth of n and N.
const SPAN: u32 = 4;
/// No pair is proposed with more than so many times the n or N of the run: twice the span of the companions, on
/// logarithms. Farther off half an order of doubt is more than a factor 4.
const REACH: u32 = 16;
/// An order that exceeds what elements and rule can have by more than this shows that companions are too coarse: the half
/// that is admitted around an order, and another one as in [`super::Part::of`].
const ABOVE: f64 = 1.0;
/// What is wanted of which run.
pub struct Goal<'a> {
    /// The scene.
    pub setup: &'a Setup,
    /// n and N of the run.
    pub run: [u32; 2],
    /// The norm of the error.
    pub norm: Norm,
    /// The error.
    pub target: f64,
    /// Memory that may be taken.
    pub limit: MemoryLimit,
}

/// A pair that is proposed.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Advised {
    /// Cells per unit length.
    pub n: u32,
    /// Number of steps.
    pub steps: u32,
    /// Mesh size.
    pub h: f64,
    /// Largest time step.
    pub k: f64,
    /// Predicted error.
    pub error: f64,
    /// Its interval.
    pub interval: Interval,
    /// Predicted CPU seconds.
    #[serde(rename = "cpu_seconds")]
    pub seconds: f64,
    /// Predicted peak memory of a process that does this run alone.
    pub bytes: f64,
    /// h₀/h and k₀/k, the steps of the run over these.
    pub finer: [f64; 2],
    /// What reaches farther than the companions, in words.
    pub extrapolates: Option<String>,
}

/// What reaches farther than the companions, in words.
fn extrapolates([h, k]: [f64; 2]) -> Option<String> {
    let span = f64::from(SPAN);
    let far = |&(name, finer): &(&str, f64)| {
        (finer > span).then(|| {
            format!("{name} is 1/{finer:.1} of the run's, and its companions span a factor {span}: nothing shows that the order holds so far")
        })
    };
    let all: Vec<String> = [("h", h), ("k", k)].iter().filter_map(far).collect();
    (!all.is_empty()).then(|| all.join("; "))
}

/// The recommendation.
#[derive(Debug, Clone, PartialEq)]
pub struct Advice {
    /// What was wanted.
    pub target: f64,
    /// The cheapest pair whose predicted error is the target or less.
    pub choice: Advised,
    /// The cheapest pair at which the upper end of the interval is the target or less, or why there is none.
    pub cautious: Result<Advised, NoAnswer>,
    /// Where the seconds come from.
    pub source: CostSource,
    /// The next n and N after the choice that have companions, so that the error can be estimated there again.
    pub check: [u32; 2],
}

/// The recommendation for a goal, from what the companions of its run show.
///
/// # Errors
/// [`NoAnswer`].
pub fn advise(goal: &Goal<'_>, found: &Companions) -> Result<Advice, NoAnswer> {
    let none = || NoAnswer::Refused("the costs of the runs have no model".into());
    let (composition, source) = costs(goal.setup, found)?.ok_or_else(none)?;
    let seconds = |h: f64, k: f64| composition.seconds(h, k);
    let candidates = Candidates::new(goal.setup, false)?;
    let search = Search::new(goal, found, &candidates, &seconds)?;
    let choice = search.advised(&|error, _| error)?;
    let cautious = search.advised(&|_, interval| interval.hi);
    let check = search.check(&choice);
    Ok(Advice { target: goal.target, choice, cautious, source, check })
}

/// The law of the errors and the numbers to choose from.
struct Search<'a> {
    goal: &'a Goal<'a>,
    estimate: Estimate,
    candidates: &'a Candidates<'a>,
    seconds: &'a AtSteps<'a>,
    /// h₀ and k₀.
    steps: [f64; 2],
    least: [u32; 2],
    most: [u32; 2],
}

impl<'a> Search<'a> {
    fn new(
        goal: &'a Goal<'a>,
        found: &Companions,
        candidates: &'a Candidates<'a>,
        seconds: &'a AtSteps<'a>,
    ) -> Result<Self, NoAnswer> {
        let norm = goal.norm.name();
        let differences = found.norms.iter().find(|of_norm| of_norm.norm == goal.norm);
        let differences = differences.ok_or_else(|| unknown(norm, "the scene has no contact"))?;
        let estimate = norm_estimate(goal.setup, found, differences);
        asymptotic(goal, differences.floor, &estimate)?;
        let [n, steps] = goal.run;
        // Where the data depend on the mesh, another mesh is another problem.
        let reach = |of_run: u32, most: u32| of_run.saturating_mul(REACH).min(most);
        let [least, most] = match found.on_mesh {
            true => [n, n],
            false => [n / SPAN, reach(n, MOST[0])],
        };
        Ok(Self {
            goal,
            estimate,
            candidates,
            seconds,
            steps: [(candidates.h)(n), (candidates.k)(steps)],
            least: [least, steps / SPAN],
            most: [most, reach(steps, MOST[1])],
        })
    }

    /// The error and its interval at (h, k).
    fn at(&self, h: f64, k: f64) -> (f64, Interval) {
        let [h0, k0] = self.steps;
        let nowhere = (f64::INFINITY, Interval { lo: 0.0, hi: f64::INFINITY });
        self.estimate.at([h / h0, k / k0]).unwrap_or(nowhere)
    }

    /// The cheapest pair that fits into memory and at which `read`, of the error and its interval, is the target or less.
    fn advised(&self, read: &dyn Fn(f64, Interval) -> f64) -> Result<Advised, NoAnswer> {
        let (target, mut most) = (self.goal.target, self.most[0]);
        let error = |h: f64, k: f64| {
            let (value, interval) = self.at(h, k);
            read(value, interval)
        };
        let mut refused: Option<NoAnswer> = None;
        while most >= self.least[0] {
            let range = [self.least, [most, self.most[1]]];
            let cheapest = self.candidates.cheapest(&error, self.seconds, target, range);
            let answer = cheapest.map_err(|none| refused.clone().unwrap_or(none))?;
            let source = match self.bytes(answer)? {
                Ok(bytes) => return Ok(self.in_full(answer, bytes)),
                Err(source) => source,
            };
            let Answer { n, steps, .. } = answer;
            most = self.smaller(n, &source);
            refused.get_or_insert(NoAnswer::Memory { target, n, steps, source });
        }
        Err(refused.unwrap_or_else(|| NoAnswer::Refused("no n is admitted".into())))
    }

    /// The memory of an answer, or that it is too much. A mesh within the span of the companions is made for that, unless a
    /// coarse one shows that it does not fit; a finer one may be more than any machine holds, and has the bytes of the
    /// finest in the span, with the exponent of n that they have on the way there.
    fn bytes(&self, answer: Answer) -> Result<Result<f64, TooLarge>, SetupError> {
        let (setup, limit, [n, _]) = (self.goal.setup, &self.goal.limit, self.goal.run);
        let made = answer.n.min(SPAN * n);
        if let Err(source) = admit_run(setup, None, (made, answer.steps), limit) {
            return Ok(Err(source));
        }
        let bytes = if answer.n <= SPAN * n {
            let space = setup.space(answer.n)?;
            run_cost(setup, &space, answer.steps).memory_bytes
        } else {
            self.far_bytes(answer)?
        };
        Ok(limit.admit(bytes, false).map(|()| bytes))
    }

    /// b(n) = b(4n₀) (n/4n₀)^e, e = log₂ b(4n₀)/b(2n₀), of mesh and march; the program itself does not grow.
    fn far_bytes(&self, answer: Answer) -> Result<f64, SetupError> {
        let (setup, [n, _]) = (self.goal.setup, self.goal.run);
        let (half, whole) = (setup.space(SPAN * n / 2)?, setup.space(SPAN * n)?);
        let half = run_cost(setup, &half, answer.steps);
        let whole = run_cost(setup, &whole, answer.steps);
        let [at_half, at_whole] = [half, whole].map(|cost| cost.march_bytes + cost.load_bytes);
        let finer = f64::from(answer.n) / f64::from(SPAN * n);
        Ok(whole.memory_bytes + at_whole * (finer.powf((at_whole / at_half).log2()) - 1.0))
    }

    /// The next pair whose companions exist.
    fn check(&self, choice: &Advised) -> [u32; 2] {
        let cells = |n: u32| (self.candidates.cells)(n);
        let serves = |n: &u32| n.is_multiple_of(SPAN) && cells(*n) && cells(n / SPAN);
        let n = match self.least[0] == self.most[0] {
            true => choice.n,
            // The n of the run serves, and so do its multiples.
            false => (choice.n..=MOST[0]).find(serves).unwrap_or(choice.n),
        };
        [n, choice.steps.next_multiple_of(SPAN)]
    }

    /// The next n to try: bytes grow at least like cells. What was refused by a coarse mesh was the finest in the span.
    fn smaller(&self, n: u32, source: &TooLarge) -> u32 {
        let refused = if source.at_least { n.min(SPAN * self.goal.run[0]) } else { n };
        let part = (source.limit / source.bytes).powf(1.0 / self.goal.setup.scene.dimension as f64);
        ((f64::from(refused) * part) as u32).min(refused - 1)
    }

    fn in_full(&self, answer: Answer, bytes: f64) -> Advised {
        let Answer { n, steps, seconds, .. } = answer;
        let [h0, k0] = self.steps;
        let (h, k) = ((self.candidates.h)(n), (self.candidates.k)(steps));
        let (error, interval) = self.at(h, k);
        let finer = [h0 / h, k0 / k];
        let extrapolates = extrapolates(finer);
        Advised { n, steps, h, k, error, interval, seconds, bytes, finer, extrapolates }
    }
}

fn unknown(norm: &str, reasons: &str) -> NoAnswer {
    NoAnswer::Refused(format!(
        "the error of this run in {norm} is unknown: {reasons}; start from a run with other n or N"
    ))
}

/// Refuses an unknown error, an order that is too high to be believed, and a target at the floor of the solver.
fn asymptotic(goal: &Goal<'_>, floor: f64, estimate: &Estimate) -> Result<(), NoAnswer> {
    let norm = goal.norm.name();
    let reasons = estimate.reasons();
    if !reasons.is_empty() {
        return Err(unknown(norm, &reasons.join("; ")));
    }
    for (step, part) in [("h", &estimate.space), ("k", &estimate.time)] {
        let observed = part.order().zip(part.counted_on().map(|[_, most]| most));
        if let Some((order, most)) = observed.filter(|(order, most)| *order > most + ABOVE) {
            return Err(NoAnswer::Refused(format!(
                "pre-asymptotic in {step}: order {order:.2} observed in {norm}, and no more than {most} is possible; start from a run with a finer {step}"
            )));
        }
    }
    NoAnswer::admit(goal.target, floor)
}
