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
use fem::contact::{CaseError, CaseInfo, Discretization, Load, LoadError, Observer, march};
use fem::norms::Moments;
use judge::record::{CaseRecord, Key};
use judge::verdict::Verdict;
use nalgebra::DVector;
use run::external::Answer;
use run::sweep::CasePlan;
use scene::Data;
use scene::setup::{AbstractSetup, MeshData, Scheme, Setup};
use vhi::Newton;

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
pub type LoadSeed = fn(&Site<'_>, f64) -> Result<Vec<f64>, LoadError>;
/// The moments of a defective truth.
pub type MomentSeed = fn(&Site<'_>, f64) -> Result<Moments, LoadError>;
/// f(t) of a defective load of an abstract problem.
pub type FiniteSeed = fn(&AbstractSetup, f64) -> DVector<f64>;
/// What a defective measurement writes into the record of a case.
pub type CaseSeed = fn(&Setup, &MeshData, &CasePlan, &mut CaseRecord);
/// What a report is given.
pub type Shown = (Vec<CaseRecord>, Vec<Verdict>);
/// What judging sees of a sweep.
pub type Table = (Vec<CaseRecord>, Vec<Key>);

/// A defect. Parts it does not touch are left as they are.
#[derive(Clone, Copy)]
pub struct Defect {
    /// What is wrong.
    pub name: &'static str,
    /// What it belongs to.
    pub term: Term,
    /// Another component of the model, another scheme, another exact side.
    pub program: fn(Setup) -> Setup,
    /// Another abstract problem.
    pub abstract_program: fn(AbstractSetup) -> AbstractSetup,
    /// Another load of it.
    pub finite_load: Option<FiniteSeed>,
    /// Another load.
    pub load: Option<LoadSeed>,
    /// Another measure of the truth.
    pub moments: Option<MomentSeed>,
    /// What the sweep sees of a run.
    pub measured: fn(Setup) -> Setup,
    /// What is measured of a case.
    pub case: CaseSeed,
    /// What is made of the answer of another solver.
    pub answer: fn(&MeshData, Answer) -> Answer,
    /// What is written down.
    pub records: fn(Vec<CaseRecord>) -> Vec<CaseRecord>,
    /// What is read for judging.
    pub before: fn(Table) -> Table,
    /// What is made of a verdict.
    pub after: fn(Verdict) -> Verdict,
    /// What is made of all verdicts of a run.
    pub all: fn(Vec<Verdict>) -> Vec<Verdict>,
    /// What a report shows.
    pub shown: fn(Shown) -> Shown,
}

fn same<T>(value: T) -> T {
    value
}

impl Defect {
    /// The sound program.
    pub const SOUND: Self = Self::none(Term::Solver, "none");

    /// Nothing is wrong yet.
    pub const fn none(term: Term, name: &'static str) -> Self {
        Self {
            name,
            term,
            program: same,
            abstract_program: same,
            finite_load: None,
            load: None,
            moments: None,
            measured: same,
            case: |_, _, _, _| (),
            answer: |_, answer| answer,
            records: same,
            before: same,
            after: same,
            all: same,
            shown: same,
        }
    }

    /// Another component of the model, or another scheme.
    pub const fn of(term: Term, name: &'static str, program: fn(Setup) -> Setup) -> Self {
        Self { program, ..Self::none(term, name) }
    }

    /// The setup with the defect in it; a defective load is driven by the scheme.
    pub fn apply(&self, setup: Setup) -> Setup {
        let mut setup = (self.program)(setup);
        if let Some(load) = self.load {
            setup.scheme = Arc::new(Loaded(load));
        }
        setup
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

/// A march by a function.
type March = fn(&Setup, &MeshData, u32, &mut Observer<'_>) -> Result<CaseInfo, CaseError>;

struct By(March);

impl Scheme for By {
    fn march(
        &self,
        setup: &Setup,
        data: &MeshData,
        steps: u32,
        observe: &mut Observer<'_>,
    ) -> Result<CaseInfo, CaseError> {
        (self.0)(setup, data, steps, observe)
    }
}

/// The setup under another march.
fn marched(mut setup: Setup, march: March) -> Setup {
    setup.scheme = Arc::new(By(march));
    setup
}

/// The site of a truth of `setup`.
pub fn site<'a>(setup: &'a Setup, space: &'a Discretization, sound: &'a dyn Truth) -> Site<'a> {
    let interpolated = matches!(setup.body.data, Data::Exact { interpolated: true, .. });
    Site { exact: setup.exact.as_deref(), interpolated, space, sound }
}

/// The march under a defective load.
struct Loaded(LoadSeed);

impl Scheme for Loaded {
    fn march(
        &self,
        setup: &Setup,
        data: &MeshData,
        steps: u32,
        observe: &mut Observer<'_>,
    ) -> Result<CaseInfo, CaseError> {
        let site = site(setup, &data.space, &*data.truth);
        let mut load = Driven { site, load: self.0 };
        let grid = setup.grid(steps);
        march(&data.space, &setup.model, &grid, &mut load, &Newton::default(), observe)
    }
}

struct Driven<'a> {
    site: Site<'a>,
    load: LoadSeed,
}

impl Load for Driven<'_> {
    fn assemble(&mut self, t: f64, out: &mut [f64]) -> Result<(), LoadError> {
        out.copy_from_slice(&(self.load)(&self.site, t)?);
        Ok(())
    }
}
