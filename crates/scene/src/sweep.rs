//! `[sweep]`: the grid of cases, and the finer reference run.

use super::domain::{Domain, Shape};
use super::keys::SceneKind;
use super::reading::{Reading, join};
use super::source::{Result, SceneError};
use super::time::{SMALLER_EXPONENT, Time};
use super::validated::{Scene, name_in};
use fem::mesh::Family as MeshFamily;
use fem::norms::ContactState;
use files::counted;
/// The direction of refinement; joint is C_h h^order + C_k k^order_k over the grid of cases, path h → 0 along the pairs of
/// the sweep.
pub use judge::verdict::Variable as Direction;

/// The reference run of a scene without exact solution.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Reference {
    pub n: u32,
    pub steps: u32,
}

/// Every n with every number of steps; or the pairs of a path.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Sweep {
    /// Mesh cells per unit length, h = 1/n; each divides the sides of a rectangle into whole cells. Empty for abstract
    /// scenes.
    pub n: Vec<u32>,
    /// Numbers N of time steps.
    pub steps: Vec<u32>,
    /// Its n is a multiple of every n, its steps of every number of steps.
    pub reference: Option<Reference>,
    /// The cases [n, N] of a path in place of the grid; `n` and `steps` then list the occurring values.
    pub pairs: Option<Vec<[u32; 2]>>,
    /// Norms to measure; None leaves the choice to the sweep.
    pub norms: Option<Vec<Norm>>,
    /// Also measures errors split by contact state.
    pub by_state: bool,
}

impl Sweep {
    /// `known` says whether there is contact, and whether its states are known.
    pub(super) fn validate(reading: &Reading, domain: &Domain, known: [bool; 2]) -> Result<Sweep> {
        let pairs = if reading.has("sweep.pairs") { Some(path(reading, domain)?) } else { None };
        let (n, steps) = match &pairs {
            Some(pairs) => {
                let mut both = [0, 1].map(|i| pairs.iter().map(|pair| pair[i]).collect::<Vec<_>>());
                both.iter_mut().for_each(Vec::dedup);
                both.into()
            }
            None => (counts(reading, "sweep.n")?, counts(reading, "sweep.steps")?),
        };
        for (index, &n) in n.iter().enumerate().filter(|_| pairs.is_none()) {
            whole_cells(reading, &format!("sweep.n.{index}"), n, domain)?;
        }
        let reference = match reading.has("sweep.reference") {
            true => Some(Reference::validate(reading, domain, &n, &steps)?),
            false => None,
        };
        let norm = |index| Norm::validate(reading, &format!("sweep.norms.{index}"), known);
        let norms: Vec<Norm> =
            reading.entries("sweep.norms")?.map(norm).collect::<Result<_, _>>()?;
        let norms = reading.has("sweep.norms").then_some(norms);
        let by_state = reading.optional("sweep.by_state")?.unwrap_or(false);
        let [message, hint] = NO_STATES;
        reading.refuse_if(by_state && !known[1], "sweep.by_state", message, hint)?;
        Ok(Sweep { n, steps, pairs, reference, norms, by_state })
    }

    /// The sweep of an abstract scene: numbers of steps only.
    pub(super) fn in_time(reading: &Reading) -> Result<Sweep> {
        Ok(Sweep { steps: counts(reading, "sweep.steps")?, ..Sweep::default() })
    }
}

impl Reference {
    /// Refuses what does not serve these cases, and says why: they are compared with it at common vertices and times.
    fn serves(self, n: &[u32], steps: &[u32]) -> Result<(), (&'static str, String)> {
        for (name, own, cases) in [("n", self.n, n), ("steps", self.steps, steps)] {
            if let Some(case) = cases.iter().find(|&&case| !own.is_multiple_of(case)) {
                let message =
                    format!("the reference {name} = {own} is not a multiple of {name} = {case}");
                return Err((name, message));
            }
        }
        Ok(())
    }

    fn validate(reading: &Reading, domain: &Domain, n: &[u32], steps: &[u32]) -> Result<Reference> {
        let nested = domain.mesh == MeshFamily::Structured;
        let message =
            "a reference run on meshes that do not nest: the mesh n is no part of the reference's";
        let hint = "use the structured mesh, or an exact solution";
        reading.refuse_if(!nested, "sweep.reference", message, hint)?;
        let reference = Reference {
            n: reading.count("sweep.reference.n")?,
            steps: step_count(reading, "sweep.reference.steps")?,
        };
        whole_cells(reading, "sweep.reference.n", reference.n, domain)?;
        let hint = "errors are compared at common vertices and times: choose a common multiple";
        reference.serves(n, steps).map_err(|(name, message)| {
            reading.error(&format!("sweep.reference.{name}"), message, hint)
        })?;
        let message = format!(
            "the reference is the case n = {}, steps = {} itself: its error would be 0",
            reference.n, reference.steps
        );
        let hint = "refine the reference in n or in steps";
        let itself = n.contains(&reference.n) && steps.contains(&reference.steps);
        reading.refuse_if(itself, "sweep.reference", message, hint).map(|()| reference)
    }
}

/// The pairs [n, N] of a path: at least three, with increasing n and nondecreasing N.
fn path(reading: &Reading, domain: &Domain) -> Result<Vec<[u32; 2]>> {
    let both = reading.has("sweep.n") || reading.has("sweep.steps");
    let hint = "keep pairs, or the lists n and steps of a grid";
    reading.refuse_if(both, "sweep.pairs", "both pairs and a grid of n and steps", hint)?;
    let mut path: Vec<[u32; 2]> = Vec::new();
    for index in reading.entries("sweep.pairs")? {
        let key = format!("sweep.pairs.{index}");
        let first = format!("{key}.0");
        reading.entries_of(&key, 2)?;
        let n = reading.count(&first)?;
        let steps = step_count(reading, &format!("{key}.1"))?;
        whole_cells(reading, &first, n, domain)?;
        let odd = path.last().is_some_and(|&[last, before]| n <= last || steps < before);
        let message = format!("[{n}, {steps}] does not refine the pair before it");
        let hint = "order the pairs from coarse to fine: n grows, N does not fall";
        reading.refuse_if(odd, &key, message, hint)?;
        path.push([n, steps]);
    }
    let message = format!("{} on the path, an order needs three", counted(path.len(), "pair"));
    let hint = "pairs = [[8, 4], [16, 6], [32, 8]]";
    reading.refuse_if(path.len() < 3, "sweep.pairs", message, hint).map(|()| path)
}

fn step_count(reading: &Reading, key: &str) -> Result<u32> {
    let fault = "is not a whole number from 1 to 10000000, the most time steps";
    reading.whole(key, 1..=MOST_STEPS, fault)
}

impl Time {
    /// Refuses numbers of steps of a sweep, each with its key, that make no grid.
    pub(super) fn serves(&self, reading: &Reading, sweep: &Sweep) -> Result<()> {
        let of_grid = sweep.steps.iter().enumerate().map(|(i, &steps)| match &sweep.pairs {
            None => (format!("sweep.steps.{i}"), steps),
            Some(_) => ("sweep.pairs".into(), steps),
        });
        let reference = sweep.reference.map(|run| ("sweep.reference.steps".into(), run.steps));
        of_grid.chain(reference).try_for_each(|(key, steps): (String, u32)| {
            let grid = self.grid(steps).map(drop);
            grid.map_err(|error| reading.error(&key, error, SMALLER_EXPONENT))
        })
    }
}

fn counts(reading: &Reading, key: &str) -> Result<Vec<u32>> {
    let mut counts = Vec::new();
    for index in reading.some_entries(key)? {
        let item = format!("{key}.{index}");
        let count = match key {
            "sweep.steps" => step_count(reading, &item)?,
            _ => reading.count(&item)?,
        };
        let message = format!("{count} is listed twice");
        reading.refuse_if(counts.contains(&count), &item, message, "remove one of the two")?;
        counts.push(count);
    }
    Ok(counts)
}

/// Numbers of cells and vertices have to fit 32 bits.
const MOST_CELLS: f64 = 1e9;
/// More steps are taken for a slip; `--steps` has the same limit.
const MOST_STEPS: i64 = 10_000_000;

/// Refuses a mesh n that cannot be, with the message and the way out: n cells per unit length must cut every side of a
/// rectangle or box into a whole number of cells, and not too many.
fn fit(n: u32, domain: &Domain) -> Result<(), (String, &'static str)> {
    let cells = domain.cells(n);
    if cells.is_nan() || cells > MOST_CELLS {
        let hint = "choose a smaller n, the number of cells per unit length, or a larger unit";
        let message =
            format!("n = {n} makes {cells:.1e} cells, and a mesh has {MOST_CELLS:e} at most");
        return Err((message, hint));
    }
    for length in domain.size.iter().filter(|_| domain.shape == Shape::Box) {
        let cells = f64::from(n) * length;
        if cells < 0.5 || (cells - cells.round()).abs() > 1e-9 * cells {
            let message = format!(
                "n = {n} does not divide side {length} into whole cells: {n} cells per unit length make {cells}"
            );
            return Err((message, "choose n so that n times each side is a whole number"));
        }
    }
    Ok(())
}

fn whole_cells(reading: &Reading, key: &str, n: u32, domain: &Domain) -> Result<()> {
    fit(n, domain).map_err(|(message, hint)| reading.error(key, message, hint))
}

impl Scene {
    /// Checks that n cells per unit length divide the sides into whole cells.
    ///
    /// # Errors
    /// An n that does not.
    pub fn check_cells(&self, n: u32) -> Result<()> {
        let fits = self.as_contact().map_or(Ok(()), |body| fit(n, &body.domain));
        fits.map_err(|(message, hint)| self.error("domain.size", message, hint))
    }

    /// Checks that numbers of steps make grids, each step above rounding of the horizon.
    ///
    /// # Errors
    /// A number that does not.
    pub fn check_steps(&self, steps: &[u32]) -> Result<()> {
        let grids = steps.iter().map(|&steps| self.time.grid(steps).map(drop));
        let grids: Result<(), _> = grids.collect();
        grids.map_err(|error| self.error("time.grid", error, SMALLER_EXPONENT))
    }

    /// [`Self::check_steps`] of the sweep and its reference run, which studies change after a file was read.
    pub(crate) fn check_sweep(&self) -> Result<()> {
        let Some(sweep) = &self.sweep else { return Ok(()) };
        let steps = sweep.steps.iter().copied();
        let all: Vec<u32> = steps.chain(sweep.reference.map(|run| run.steps)).collect();
        self.check_steps(&all)
    }

    /// Checks grids of the command line as if they were in the file.
    ///
    /// # Errors
    /// As [`Self::check_cases`]; any grid for a scene that runs along a path.
    pub fn check_grid(&self, n: &[u32], steps: &[u32]) -> Result<()> {
        let path = self.sweep.as_ref().is_some_and(|sweep| sweep.pairs.is_some());
        let grid = !(n.is_empty() && steps.is_empty());
        let message = "the scene runs along a path of pairs, not on a grid";
        let hint = "leave --n and --steps away, or change the pairs";
        self.refuse_if(path && grid, "sweep.pairs", message, hint)?;
        self.check_cases(n, steps)
    }

    /// The error for a scene without cases; `purpose` is e.g. `run` or `verify`.
    pub fn no_case(&self, purpose: &str) -> SceneError {
        let hint = "add [sweep] with n and steps, or give --n and --steps";
        self.error("scene.name", format!("the scene has no case to {purpose}"), hint)
    }

    /// Checks numbers of cells and steps that the file does not list.
    ///
    /// # Errors
    /// As [`Self::check_cells`] and [`Self::check_steps`]; an n or a number of steps that the reference run does not refine.
    pub fn check_cases(&self, n: &[u32], steps: &[u32]) -> Result<()> {
        n.iter().try_for_each(|&n| self.check_cells(n))?;
        self.check_steps(steps)?;
        let reference = self.sweep.as_ref().and_then(|sweep| sweep.reference);
        let hint = "choose divisors of the reference's, or change the reference";
        let serves = reference.map_or(Ok(()), |reference| reference.serves(n, steps));
        serves.map_err(|(_, message)| self.error("sweep.reference", message, hint))
    }
}

/// A path serves predictions along it, and a grid all others.
pub(super) fn serves(
    reading: &Reading,
    sweep: Option<&Sweep>,
    predicts: &[Prediction],
) -> Result<()> {
    let path = sweep.is_some_and(|sweep| sweep.pairs.is_some());
    let odd = predicts.iter().position(|p| (p.variable == Direction::Path) != path);
    let (Some(index), Some(_)) = (odd, sweep) else { return Ok(()) };
    let (message, hint) = match path {
        true => ("the pairs of a sweep hold h and k together", "write variable = \"path\""),
        false => ("a path needs pairs", "write pairs = [[8, 4], [16, 6], [32, 8]] under [sweep]"),
    };
    Err(reading.error(&format!("predicts.{index}.variable"), message, hint))
}

/// Errors by contact state need an exact solution in the plane with contact.
const NO_STATES: [&str; 2] = [
    "errors by contact state need the state of the truth at every point",
    "they are known for an exact solution in the plane with contact; measure trace_L2_max and pressure_L2_max here",
];

// `[[predicts]]`: the orders that the theory promises, with their theorems.

/// A quantity in which errors are measured; names as in `cases.csv`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Norm {
    /// max over n of ‖ε(u_n - u_n^{kh})‖, the paper's.
    VMax,
    L2Max,
    TraceL2Max,
    PressureL2Max,
    StressL2Max,
    ContactSetMax,
    VTimeMax,
    /// Of an abstract scene: start + ∫ u by the scene's rule, in X; the displacement if u is a velocity.
    DisplacementMax,
    VProjectionMax,
    /// u_ν on the part of Γ3 where the exact solution is in a state.
    TraceMax(ContactState),
    /// ξ + λ on that part.
    PressureMax(ContactState),
    /// Measure of the symmetric difference of the locked sets.
    ContactMeasureMax,
}

impl serde::Serialize for Norm {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

impl Norm {
    /// Whether it needs pressures.
    pub fn wants_pressure(self) -> bool {
        matches!(self, Norm::PressureL2Max | Norm::PressureMax(_))
    }

    /// Every norm with its name.
    const NAMES: [(&str, Norm); 20] = [
        ("V_max", Norm::VMax),
        ("L2_max", Norm::L2Max),
        ("trace_L2_max", Norm::TraceL2Max),
        ("pressure_L2_max", Norm::PressureL2Max),
        ("stress_L2_max", Norm::StressL2Max),
        ("contact_set_max", Norm::ContactSetMax),
        ("V_time_max", Norm::VTimeMax),
        ("displacement_max", Norm::DisplacementMax),
        ("V_projection_max", Norm::VProjectionMax),
        ("trace_open_max", Norm::TraceMax(ContactState::Open)),
        ("trace_rising_max", Norm::TraceMax(ContactState::Rising)),
        ("trace_falling_max", Norm::TraceMax(ContactState::Falling)),
        ("trace_jump_max", Norm::TraceMax(ContactState::AtJump)),
        ("trace_locked_max", Norm::TraceMax(ContactState::Locked)),
        ("pressure_open_max", Norm::PressureMax(ContactState::Open)),
        ("pressure_rising_max", Norm::PressureMax(ContactState::Rising)),
        ("pressure_falling_max", Norm::PressureMax(ContactState::Falling)),
        ("pressure_jump_max", Norm::PressureMax(ContactState::AtJump)),
        ("pressure_locked_max", Norm::PressureMax(ContactState::Locked)),
        ("contact_measure_max", Norm::ContactMeasureMax),
    ];

    /// Every norm.
    pub fn all() -> impl Iterator<Item = Norm> {
        Self::NAMES.into_iter().map(|(_, norm)| norm)
    }

    /// Its name in scene files and in `cases.csv`.
    pub fn name(self) -> &'static str {
        name_in(&Self::NAMES, self)
    }

    /// Whether the norm is on Γ3 and needs contact.
    pub fn needs_contact(self) -> bool {
        matches!(self, Norm::TraceL2Max | Norm::PressureL2Max | Norm::ContactSetMax)
            || self.by_state()
    }

    /// Whether the norm needs the contact state of the exact solution.
    pub fn by_state(self) -> bool {
        matches!(self, Norm::TraceMax(_) | Norm::PressureMax(_) | Norm::ContactMeasureMax)
    }

    fn validate(reading: &Reading, key: &str, [contact, states]: [bool; 2]) -> Result<Norm> {
        let norm = reading.choice(key, &Norm::NAMES)?;
        let message = format!("`{}` is measured on Γ3, and the scene has no contact", norm.name());
        let hint = "choose V_max, L2_max or stress_L2_max, or add contact";
        reading.refuse_if(norm.needs_contact() && !contact, key, message, hint)?;
        let [message, hint] = NO_STATES;
        reading.refuse_if(norm.by_state() && !states, key, message, hint)?;
        let odd =
            norm == Norm::DisplacementMax && SceneKind::validate(reading)? != SceneKind::Abstract;
        let message = "`displacement_max` is the integral of u in an abstract scene";
        let hint = "a body has it in its stress: choose stress_L2_max";
        reading.refuse_if(odd, key, message, hint).map(|()| norm)
    }
}

/// One promised order.
#[derive(Debug, Clone, PartialEq)]
pub struct Prediction {
    pub norm: Norm,
    pub variable: Direction,
    /// In h if `variable` is joint. Positive, or 0 as a lower bound where the error is to tend to zero.
    pub order: f64,
    /// Order in k, present exactly if `variable` is joint. Positive.
    pub order_k: Option<f64>,
    pub at_least: bool,
    /// A higher order is a failure too.
    pub exact: bool,
    /// Compares the constant with its prediction, if there is one.
    pub constant: bool,
    /// Allowed relative difference of the constant from its prediction, if not the default.
    pub constant_within: Option<f64>,
    /// The theorem or equation that promises it.
    pub why: String,
    pub window_n: Option<[u32; 2]>,
    pub window_steps: Option<[u32; 2]>,
}

impl Prediction {
    /// Whether the error is to tend to zero, at no rate that anybody predicts.
    pub fn tends_to_zero(&self) -> bool {
        self.at_least && self.order == 0.0
    }

    /// Validates the prediction at position `index` of the file.
    pub(super) fn validate(reading: &Reading, index: usize, known: [bool; 2]) -> Result<Self> {
        let table = format!("predicts.{index}");
        let key = |name: &str| join(&table, name);
        let flag = |name: &str| reading.optional::<bool>(&key(name));
        let variables = [Direction::H, Direction::K, Direction::Joint, Direction::Path];
        let variables = variables.map(|variable| (variable.name(), variable));
        let variable = reading.choice(&key("variable"), &variables)?;
        let to_zero = flag("tends_to_zero")?.unwrap_or(false);
        if to_zero {
            for other in ["order", "order_k", "at_least", "exact", "constant_within"] {
                let message = format!("both tends_to_zero and {other}: one is without an order");
                let given = reading.has(&key(other));
                reading.refuse_if(given, &key(other), message, "keep one of the two")?;
            }
            let message = "`tends_to_zero` is of the errors on a line, h or k";
            let joint = variable == Direction::Joint;
            reading.refuse_if(joint, &key("variable"), message, "write variable = \"h\"")?;
        }
        let at_least = to_zero || flag("at_least")?.unwrap_or(false);
        let exact = flag("exact")?.unwrap_or(false);
        if at_least && exact {
            let message = "both at_least and exact: an order is a lower bound or it is sharp";
            return Err(reading.key_error(&key("exact"), message, "keep one of the two"));
        }
        let why = reading.text(&key("why"))?;
        let order_k = match (variable == Direction::Joint, reading.has(&key("order_k"))) {
            (true, _) => Some(reading.positive(&key("order_k"))?),
            (false, false) => None,
            (false, true) => {
                let message = "`order_k` belongs to joint predictions";
                let hint = "write variable = \"joint\", or remove order_k";
                return Err(reading.key_error(&key("order_k"), message, hint));
            }
        };
        let constant = !to_zero && flag("constant")?.unwrap_or(true);
        Ok(Prediction {
            norm: Norm::validate(reading, &key("norm"), known)?,
            variable,
            order: if to_zero { 0.0 } else { reading.positive(&key("order"))? },
            order_k,
            at_least,
            exact,
            constant,
            constant_within: constant_within(reading, &key, constant)?,
            why,
            window_n: reading.window(&key("window_n"))?,
            window_steps: reading.window(&key("window_steps"))?,
        })
    }
}

impl Prediction {
    /// An abstract scene has no mesh: its errors are ‖u_n - u_n^k‖_X and that of the pressures, in k only.
    pub(super) fn only_in_time(&self, reading: &Reading, index: usize) -> Result<()> {
        let key = |name: &str| format!("predicts.{index}.{name}");
        let message = format!("`{}` needs a body", self.norm.name());
        let hint = "the errors of an abstract scene are V_max, the largest norm in X, displacement_max of the integral of u, and with functionals pressure_L2_max";
        let known = matches!(self.norm, Norm::VMax | Norm::PressureL2Max | Norm::DisplacementMax);
        reading.refuse_if(!known, &key("norm"), message, hint)?;
        let (message, hint) =
            ("an abstract scene has no mesh, so no order in h", "write variable = \"k\"");
        reading.refuse_if(self.variable != Direction::K, &key("variable"), message, hint)
    }
}

/// Allowed relative difference of a constant from its prediction: in (0, 1), and only with a reason.
fn constant_within(
    reading: &Reading,
    key: &dyn Fn(&str) -> String,
    constant: bool,
) -> Result<Option<f64>> {
    let (within, why) = (key("constant_within"), key("constant_why"));
    if !reading.has(&within) {
        let message = "`constant_why` has no `constant_within` to explain";
        let hint = "add it: constant_within = 0.03, or remove constant_why";
        let alone = reading.has(&why);
        return if alone { Err(reading.key_error(&why, message, hint)) } else { Ok(None) };
    }
    if !constant {
        let message = "`constant_within` beside constant = false: nothing is compared";
        return Err(reading.key_error(&within, message, "keep one of the two"));
    }
    reading.text(&why)?;
    let hint = "give the relative distance that is allowed, such as 0.03";
    reading.share(&within, hint).map(Some)
}
