//! Seeded defects as named values. Each is a wrong component, passed in at a seam of the library: the sound program has
//! no switch for any of them.

// Each test file compiles this module for itself and uses a part of it.
#![allow(dead_code, unused_imports)]

mod abstract_problem;
mod contact;
mod element;
mod friction;
mod handed;
mod judging;
mod levels;
mod load;
mod material;
mod measurement;
mod memory;
mod nested;
mod other_norms;
mod paths;
mod projection;
mod records;
mod singular;
mod solver;
mod time;
mod unseen;

pub use handed::handed;
pub use solver::sound_loop;

use std::sync::Arc;

use exact::{Exact, Truth};
use fem::contact::{
    CaseError, CaseInfo, Discretization, Load, LoadError, Model, Observer, StepView, march,
};
use fem::norms::Moments;
use judge::record::{CaseRecord, Key};
use judge::verdict::Verdict;
use nalgebra::DVector;
use run::external::Answer;
use run::sweep::CasePlan;
use scene::Data;
use scene::setup::{AbstractSetup, MeshData, Setup, TruthLoad};
use vhi::history::TimeGrid;
use vhi::{Newton, StepSolver};

use crate::wrong::scheme;

/// What a defect belongs to: a term of (5.1)-(5.5), or a part of the program.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Term {
    TimeRule,
    Memory,
    Zeta,
    Projection,
    Elasticity,
    Compliance,
    Gap,
    Friction,
    Element,
    Load,
    Dirichlet,
    Solver,
    Abstract,
    Measurement,
    Record,
    Judging,
    Answer,
    Report,
}

impl Term {
    /// Its name in the table.
    pub fn name(self) -> &'static str {
        match self {
            Self::TimeRule => "time rule",
            Self::Memory => "memory",
            Self::Zeta => "ζ",
            Self::Projection => "projection",
            Self::Elasticity => "elasticity",
            Self::Compliance => "compliance",
            Self::Gap => "gap",
            Self::Friction => "friction",
            Self::Element => "element",
            Self::Load => "load",
            Self::Dirichlet => "Dirichlet",
            Self::Solver => "solver",
            Self::Abstract => "abstract problem",
            Self::Measurement => "measurement",
            Self::Record => "record",
            Self::Judging => "judging",
            Self::Answer => "answer",
            Self::Report => "report",
        }
    }
}

/// Where a load or a truth is evaluated.
pub struct Site<'a> {
    /// The exact solution, where there is one.
    pub exact: Option<&'a Exact>,
    /// The true fields are its interpolants.
    pub interpolated: bool,
    /// V^h.
    pub space: &'a Discretization,
    /// The sound loads and moments.
    pub sound: &'a dyn Truth,
}

/// F(t) of a defective load.
pub type LoadSeed = Arc<dyn Fn(&Site<'_>, f64) -> Result<Vec<f64>, LoadError> + Send + Sync>;
/// The moments of a defective truth.
pub type MomentSeed = Arc<dyn Fn(&Site<'_>, f64) -> Result<Moments, LoadError> + Send + Sync>;
/// f(t) of a defective load of an abstract problem.
pub type FiniteSeed = fn(&AbstractSetup, f64) -> DVector<f64>;
/// What a defective measurement writes into the record of a case.
pub type CaseSeed = fn(&Setup, &MeshData, &CasePlan, &mut CaseRecord);
/// What a report is given.
pub type Shown = (Vec<CaseRecord>, Vec<Verdict>);
/// What judging sees of a sweep.
pub type Table = (Vec<CaseRecord>, Vec<Key>);
/// What a defect makes of something sound, if it touches it.
pub type Change<T> = Option<Arc<dyn Fn(&mut T) + Send + Sync>>;

/// The value after a change.
pub fn through<T>(change: &Change<T>, mut value: T) -> T {
    if let Some(change) = change {
        change(&mut value);
    }
    value
}

/// A defect. Parts it does not touch are left as they are.
#[derive(Clone)]
pub struct Defect {
    /// What is wrong.
    pub name: &'static str,
    /// What it belongs to.
    pub term: Term,
    /// Another component of the model, another scheme, another exact side.
    pub program: Change<Setup>,
    /// Another abstract problem.
    pub abstract_program: Change<AbstractSetup>,
    /// Another load of it.
    pub finite_load: Option<FiniteSeed>,
    /// Another load.
    pub load: Option<LoadSeed>,
    /// Another measure of the truth.
    pub moments: Option<MomentSeed>,
    /// What the sweep sees of a run.
    pub measured: Change<Setup>,
    /// What is measured of a case.
    pub case: CaseSeed,
    /// What is made of the answer of another solver.
    pub answer: fn(&MeshData, &mut Answer),
    /// What is written down.
    pub records: Change<Vec<CaseRecord>>,
    /// What is read for judging.
    pub before: Change<Table>,
    /// What is made of a verdict.
    pub after: Change<Verdict>,
    /// What is made of all verdicts of a run.
    pub all: Change<Vec<Verdict>>,
    /// What a report shows.
    pub shown: Change<Shown>,
}

impl Defect {
    /// The sound program.
    pub const SOUND: Self = Self::none(Term::Solver, "none");

    /// Nothing is wrong yet.
    pub const fn none(term: Term, name: &'static str) -> Self {
        Self {
            name,
            term,
            program: None,
            abstract_program: None,
            finite_load: None,
            load: None,
            moments: None,
            measured: None,
            case: |_, _, _, _| (),
            answer: |_, _| (),
            records: None,
            before: None,
            after: None,
            all: None,
            shown: None,
        }
    }

    /// The setup with the defect in it; a defective load is driven by the scheme.
    pub fn apply(&self, setup: Setup) -> Setup {
        let mut setup = through(&self.program, setup);
        if let Some(load) = self.load.clone() {
            marched(move |run| {
                let site = site(run.setup, &run.data.space, &*run.data.truth);
                let mut load = Driven { site, load: &*load };
                let (space, grid) = (&run.data.space, run.setup.grid(run.steps));
                march(space, &run.setup.model, &grid, &mut load, &Newton::default(), run.observe)
            })(&mut setup);
        }
        setup
    }

    /// Whether a run of a body, or of an abstract problem, can be another one than that of the sound program.
    pub fn is_in(&self, body: bool) -> bool {
        let of_bodies = self.program.is_some()
            || self.measured.is_some()
            || self.load.is_some()
            || self.moments.is_some()
            || self.term != Term::Abstract;
        let of_others = self.abstract_program.is_some() || self.finite_load.is_some();
        if body { of_bodies } else { of_others }
    }

    /// Whether a solver, its model or its load is defective, and not what is made of its results.
    pub fn is_of_solver(&self) -> bool {
        !matches!(
            self.term,
            Term::Abstract
                | Term::Measurement
                | Term::Record
                | Term::Judging
                | Term::Answer
                | Term::Report
        )
    }
}

impl Term {
    /// Another component of the model, or another scheme.
    pub fn of(
        self,
        name: &'static str,
        program: impl Fn(&mut Setup) + Send + Sync + 'static,
    ) -> Defect {
        Defect { program: Some(Arc::new(program)), ..Defect::none(self, name) }
    }

    /// Another march.
    fn run(
        self,
        name: &'static str,
        march: impl Fn(Run<'_>) -> Marched + Send + Sync + 'static,
    ) -> Defect {
        self.of(name, marched(march))
    }

    /// Another march on a space made for it.
    fn rebuilt(
        self,
        name: &'static str,
        change: impl Fn(&mut Discretization, &mut Model) + Send + Sync + 'static,
    ) -> Defect {
        self.run(name, move |run| run.rebuilt(&change))
    }
}

impl Term {
    /// Another abstract problem.
    fn finite(
        self,
        name: &'static str,
        program: impl Fn(&mut AbstractSetup) + Send + Sync + 'static,
    ) -> Defect {
        Defect { abstract_program: Some(Arc::new(program)), ..Defect::none(self, name) }
    }

    /// Another load.
    fn load(
        self,
        name: &'static str,
        load: impl Fn(&Site<'_>, f64) -> Result<Vec<f64>, LoadError> + Send + Sync + 'static,
    ) -> Defect {
        Defect { load: Some(Arc::new(load)), ..Defect::none(self, name) }
    }

    /// Another truth: its moments changed.
    fn moments(
        self,
        name: &'static str,
        change: impl Fn(&Site<'_>, f64, &mut Moments) + Send + Sync + 'static,
    ) -> Defect {
        let seed = move |site: &Site<'_>, t: f64| {
            let mut moments = (*site.sound.moments(t)?).clone();
            change(site, t, &mut moments);
            Ok(moments)
        };
        Defect { moments: Some(Arc::new(seed)), ..Defect::none(self, name) }
    }

    /// The levels of a scheme, seen through `show`.
    fn seen(
        self,
        name: &'static str,
        show: impl Fn(&TimeGrid, &StepView<'_>, &mut Observer<'_>) -> Result<(), CaseError>
        + Send
        + Sync
        + 'static,
    ) -> Defect {
        let show = Arc::new(show);
        let measured = move |setup: &mut Setup| {
            let (sound, show) = (setup.scheme.clone(), show.clone());
            marched(move |run| {
                let grid = run.setup.grid(run.steps);
                let mut seen = |view: &StepView<'_>| show(&grid, view, run.observe);
                sound.march(run.setup, run.data, run.steps, &mut seen)
            })(setup);
        };
        Defect { measured: Some(Arc::new(measured)), ..Defect::none(self, name) }
    }

    /// Other records.
    fn records(
        self,
        name: &'static str,
        change: impl Fn(&mut Vec<CaseRecord>) + Send + Sync + 'static,
    ) -> Defect {
        Defect { records: Some(Arc::new(change)), ..Defect::none(self, name) }
    }

    /// Each record changed.
    fn each(
        self,
        name: &'static str,
        change: impl Fn(&mut CaseRecord) + Send + Sync + 'static,
    ) -> Defect {
        self.records(name, move |records| records.iter_mut().for_each(&change))
    }
}

/// All defects.
pub fn all() -> Vec<Defect> {
    let mut list = time::defects();
    list.extend(memory::defects());
    list.extend(projection::defects());
    list.extend(material::defects());
    list.extend(contact::defects());
    list.extend(friction::defects());
    list.extend(friction::others());
    list.extend(element::defects());
    list.extend(load::defects());
    list.extend(solver::defects());
    list.extend(paths::defects());
    list.extend(singular::defects());
    list.extend(abstract_problem::defects());
    list.extend(nested::defects());
    list.extend(measurement::defects());
    list.extend(other_norms::defects());
    list.extend(records::defects());
    list.extend(judging::defects());
    list.extend(unseen::defects());
    list.extend(unseen::shown());
    list
}

/// A case that is to be marched.
struct Run<'r> {
    setup: &'r Setup,
    data: &'r MeshData,
    steps: u32,
    observe: &'r mut Observer<'r>,
}

type Marched = Result<CaseInfo, CaseError>;

impl Run<'_> {
    fn by(self, solver: &dyn StepSolver) -> Marched {
        self.data.march(self.setup, self.steps, solver, self.observe)
    }

    fn sound(self) -> Marched {
        self.by(&Newton::default())
    }

    /// The step of a uniform grid.
    fn k(&self) -> f64 {
        self.setup.scene.time.horizon / f64::from(self.steps)
    }

    /// On a space with a model.
    fn on(self, space: &Discretization, model: &Model) -> Marched {
        let (grid, mut load) = (self.setup.grid(self.steps), TruthLoad(&*self.data.truth));
        march(space, model, &grid, &mut load, &Newton::default(), self.observe)
    }

    /// On a space made for it, with a model that may know it.
    fn rebuilt(self, change: &impl Fn(&mut Discretization, &mut Model)) -> Marched {
        let space = self.setup.space(self.data.space.mesh.n).expect("the same mesh");
        let mut space = Arc::into_inner(space).expect("nobody else has it");
        let mut model = self.setup.scene_model();
        change(&mut space, &mut model);
        self.on(&space, &model)
    }
}

/// Puts another march into a setup.
fn marched(
    march: impl Fn(Run<'_>) -> Marched + Send + Sync + 'static,
) -> impl Fn(&mut Setup) + Send + Sync {
    let scheme =
        scheme(move |setup, data, steps, observe| march(Run { setup, data, steps, observe }));
    move |setup| setup.scheme = scheme.clone()
}

/// The site of a truth of `setup`.
pub fn site<'a>(setup: &'a Setup, space: &'a Discretization, sound: &'a dyn Truth) -> Site<'a> {
    let interpolated = matches!(setup.body.data, Data::Exact { interpolated: true, .. });
    Site { exact: setup.exact.as_deref(), interpolated, space, sound }
}

type LoadAt = dyn Fn(&Site<'_>, f64) -> Result<Vec<f64>, LoadError> + Send + Sync;

struct Driven<'a> {
    site: Site<'a>,
    load: &'a LoadAt,
}

impl Load for Driven<'_> {
    fn assemble(&mut self, t: f64, out: &mut [f64]) -> Result<(), LoadError> {
        out.copy_from_slice(&(self.load)(&self.site, t)?);
        Ok(())
    }
}
