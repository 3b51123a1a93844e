//! What a defect can sit in: the terms of a scene that a variant can do without, and what is always there.

use scene::ContactScene;
use serde::{Serialize, Serializer};

/// How many suspects are terms: the first of [`Suspect::ALL`].
const TERMS: usize = 5;

/// The terms of (5.1)-(5.5) that a variant of a scene has: whether it has each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct SceneTerms([bool; TERMS]);

impl SceneTerms {
    /// No term: linear elasticity.
    pub const NONE: SceneTerms = SceneTerms([false; TERMS]);

    pub(crate) fn of(body: &ContactScene) -> Self {
        let projection = body.material.projection.as_ref().filter(|p| p.mu > 0.0);
        let contact = body.contact.as_ref();
        Self([
            projection.is_some(),
            projection.is_some_and(|projection| projection.lipschitz > 0.0),
            !body.material.memory.is_empty(),
            contact.is_some_and(|contact| contact.law.is_some()),
            contact.is_some_and(|contact| contact.gap.is_some()),
        ])
    }

    /// Whether the term is there; what is no term is everywhere.
    pub(crate) fn has(self, term: Suspect) -> bool {
        self.0.get(term as usize).is_none_or(|present| *present)
    }

    /// These terms and another one.
    pub(crate) fn with(mut self, term: Suspect) -> Self {
        self.0[term as usize] = true;
        self
    }

    /// These terms but for one; ζ goes with the projection that it acts on.
    pub(crate) fn without(mut self, term: Suspect) -> Self {
        self.0[term as usize] = false;
        match term {
            Suspect::Projection => self.without(Suspect::Accumulation),
            _ => self,
        }
    }

    fn present(self) -> impl Iterator<Item = Suspect> {
        Suspect::ALL.into_iter().take(TERMS).filter(move |&term| self.has(term))
    }

    /// Each term with the terms that remain without it.
    pub(crate) fn removals(self) -> impl Iterator<Item = (Suspect, SceneTerms)> {
        self.present().map(move |term| (term, self.without(term)))
    }

    /// Whether an integral over the past remains.
    pub(crate) fn has_history(self) -> bool {
        self.has(Suspect::Memory) || self.has(Suspect::Accumulation)
    }

    /// What takes part in a run with these terms.
    pub(crate) fn suspects(self) -> Vec<Suspect> {
        let nonlinear =
            [Suspect::Projection, Suspect::Compliance, Suspect::Gap].iter().any(|&t| self.has(t));
        let shared = [(self.has_history(), Suspect::TimeRule), (nonlinear, Suspect::Solver)];
        let shared = shared.into_iter().filter_map(|(used, suspect)| used.then_some(suspect));
        self.present().chain(shared).chain([Suspect::Elasticity, Suspect::Loads]).collect()
    }

    /// In a few words: `elasticity, mu, zeta, memory, law, gap`.
    pub(crate) fn words(self) -> String {
        let word = |term: Suspect| if term == Suspect::Projection { "mu" } else { term.name() };
        let words: Vec<&str> = ["elasticity"].into_iter().chain(self.present().map(word)).collect();
        words.join(", ")
    }
}

/// What may be at fault.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Suspect {
    /// The projection term of (5.1).
    Projection,
    /// ζ and the dependence of κ on it.
    Accumulation,
    /// The memory term of (5.1).
    Memory,
    /// The law on Γ3.
    Compliance,
    /// The constraint on Γ3.
    Gap,
    /// The quadrature of all integrals over the past.
    TimeRule,
    /// The iteration that solves a level, with its tolerance.
    Solver,
    /// 𝒜.
    Elasticity,
    /// The loads as the solver takes them, and what else every run has: clamped sides, the linear solver, the error.
    Loads,
    /// What only runs have whose exact solution is not in V^h: quadrature of the loads and of the error.
    Space,
}

impl Serialize for Suspect {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

impl Suspect {
    /// Every suspect, terms of the scene first.
    pub const ALL: [Suspect; 10] = [
        Suspect::Projection,
        Suspect::Accumulation,
        Suspect::Memory,
        Suspect::Compliance,
        Suspect::Gap,
        Suspect::TimeRule,
        Suspect::Solver,
        Suspect::Elasticity,
        Suspect::Loads,
        Suspect::Space,
    ];

    /// Its name in JSON.
    pub fn name(self) -> &'static str {
        self.described().0
    }

    pub(crate) fn words(self) -> &'static str {
        self.described().1
    }

    fn described(self) -> (&'static str, &'static str) {
        match self {
            Suspect::Projection => ("projection", "the projection term mu (eps - P eps)"),
            Suspect::Accumulation => ("zeta", "zeta, the yield limit's dependence on the past"),
            Suspect::Memory => ("memory", "the memory term B"),
            Suspect::Compliance => ("law", "the compliance law"),
            Suspect::Gap => ("gap", "the constraint u_nu <= g"),
            Suspect::TimeRule => ("time-rule", "the time rule that memory and zeta share"),
            Suspect::Solver => {
                ("solver", "the iteration that solves a nonlinear level, or its tolerance")
            }
            Suspect::Elasticity => ("elasticity", "elasticity A"),
            Suspect::Loads => (
                "loads",
                "the loads as the solver takes them, or what else every run has (clamped sides, the linear solver, the measured error)",
            ),
            Suspect::Space => (
                "space",
                "what only a solution outside V^h has: quadrature of its loads or of its error, interpolation",
            ),
        }
    }

    /// Whether a variant of a scene can do without it.
    pub(crate) fn is_term(self) -> bool {
        (self as usize) < TERMS
    }
}
