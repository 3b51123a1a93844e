//! What a defect can sit in: the terms of a scene that a variant can do without, and what is always there.

use scene::ContactScene;

/// The terms of (5.1)-(5.5) that a variant of a scene has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SceneTerms {
    /// ℬ.
    pub memory: bool,
    /// μ(ε - P ε).
    pub projection: bool,
    /// κ depends on ζ.
    pub accumulation: bool,
    /// The law p = ∂j_ν.
    pub compliance: bool,
    /// u_ν ≤ g.
    pub gap: bool,
}

impl SceneTerms {
    /// No term: linear elasticity.
    pub const NONE: SceneTerms = SceneTerms {
        memory: false,
        projection: false,
        accumulation: false,
        compliance: false,
        gap: false,
    };

    pub(crate) fn of(body: &ContactScene) -> Self {
        let projection = body.material.projection.as_ref().filter(|p| p.mu > 0.0);
        let contact = body.contact.as_ref();
        Self {
            memory: !body.material.memory.is_empty(),
            projection: projection.is_some(),
            accumulation: projection.is_some_and(|projection| projection.lipschitz > 0.0),
            compliance: contact.is_some_and(|contact| contact.law.is_some()),
            gap: contact.is_some_and(|contact| contact.gap.is_some()),
        }
    }

    /// Each term with the terms that remain without it; ζ goes with the projection that it acts on.
    pub(crate) fn removals(self) -> Vec<(Suspect, SceneTerms)> {
        let without_projection = SceneTerms { projection: false, accumulation: false, ..self };
        [
            (self.projection, Suspect::Projection, without_projection),
            (self.accumulation, Suspect::Accumulation, SceneTerms { accumulation: false, ..self }),
            (self.memory, Suspect::Memory, SceneTerms { memory: false, ..self }),
            (self.compliance, Suspect::Compliance, SceneTerms { compliance: false, ..self }),
            (self.gap, Suspect::Gap, SceneTerms { gap: false, ..self }),
        ]
        .into_iter()
        .filter(|(present, ..)| *present)
        .map(|(_, suspect, rest)| (suspect, rest))
        .collect()
    }

    /// Whether an integral over the past remains.
    pub(crate) fn has_history(self) -> bool {
        self.memory || self.accumulation
    }

    /// What takes part in a run with these terms.
    pub(crate) fn suspects(self) -> Vec<Suspect> {
        let nonlinear = self.projection || self.compliance || self.gap;
        [
            (self.projection, Suspect::Projection),
            (self.accumulation, Suspect::Accumulation),
            (self.memory, Suspect::Memory),
            (self.compliance, Suspect::Compliance),
            (self.gap, Suspect::Gap),
            (self.has_history(), Suspect::TimeRule),
            (nonlinear, Suspect::Solver),
            (true, Suspect::Elasticity),
            (true, Suspect::Loads),
        ]
        .into_iter()
        .filter_map(|(present, suspect)| present.then_some(suspect))
        .collect()
    }

    /// In a few words: `elasticity, mu, zeta, memory, law, gap`.
    pub(crate) fn words(self) -> String {
        let named = [
            (self.projection, "mu"),
            (self.accumulation, "zeta"),
            (self.memory, "memory"),
            (self.compliance, "law"),
            (self.gap, "gap"),
        ];
        let present = named.into_iter().filter_map(|(present, word)| present.then_some(word));
        let words: Vec<&str> = ["elasticity"].into_iter().chain(present).collect();
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
        match self {
            Suspect::Projection => "projection",
            Suspect::Accumulation => "zeta",
            Suspect::Memory => "memory",
            Suspect::Compliance => "law",
            Suspect::Gap => "gap",
            Suspect::TimeRule => "time-rule",
            Suspect::Solver => "solver",
            Suspect::Elasticity => "elasticity",
            Suspect::Loads => "loads",
            Suspect::Space => "space",
        }
    }

    pub(crate) fn words(self) -> &'static str {
        match self {
            Suspect::Projection => "the projection term mu (eps - P eps)",
            Suspect::Accumulation => "zeta, the yield limit's dependence on the past",
            Suspect::Memory => "the memory term B",
            Suspect::Compliance => "the compliance law",
            Suspect::Gap => "the constraint u_nu <= g",
            Suspect::TimeRule => "the time rule that memory and zeta share",
            Suspect::Solver => "the iteration that solves a nonlinear level, or its tolerance",
            Suspect::Elasticity => "elasticity A",
            Suspect::Loads => {
                "the loads as the solver takes them, or what else every run has (clamped sides, the linear solver, the measured error)"
            }
            Suspect::Space => {
                "what only a solution outside V^h has: quadrature of its loads or of its error, interpolation"
            }
        }
    }

    /// Whether a variant of a scene can do without it.
    pub(crate) fn is_term(self) -> bool {
        matches!(
            self,
            Suspect::Projection
                | Suspect::Accumulation
                | Suspect::Memory
                | Suspect::Compliance
                | Suspect::Gap
        )
    }
}
