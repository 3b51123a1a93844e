//! `sweep diagnose` over the defects of the solver: each on the first scene of the suite whose verdict it spoils, as an
//! author would meet it.

use fem::space::Element;
use scene::Data;
use studies::diagnose::{Finding, Suspect, examine};

use crate::catalogue::{Defect, Term};
use crate::matrix::Reference;

/// The suspects that name a term rightly.
fn right(term: Term) -> &'static [Suspect] {
    match term {
        Term::TimeRule => &[Suspect::TimeRule],
        Term::Memory => &[Suspect::Memory],
        Term::Zeta => &[Suspect::Accumulation],
        Term::Projection => &[Suspect::Projection],
        Term::Elasticity => &[Suspect::Elasticity],
        Term::Compliance => &[Suspect::Compliance],
        Term::Gap => &[Suspect::Gap],
        Term::Load => &[Suspect::Loads, Suspect::Space],
        Term::Dirichlet => &[Suspect::Space],
        Term::Solver => &[Suspect::Solver],
        // `sweep diagnose` refuses friction and quadratic elements.
        Term::Friction
        | Term::Element
        | Term::Abstract
        | Term::Measurement
        | Term::Record
        | Term::Judging
        | Term::Answer
        | Term::Report => &[],
    }
}

/// What a diagnosis made of a defect.
pub struct Diagnosed {
    pub scene: String,
    pub finding: Finding,
    /// The right suspect is named, alone.
    pub named: bool,
    /// It is among the suspects that are named.
    pub among: bool,
}

/// Diagnoses a defect; `None` where no verdict of the suite is spoilt, so that nobody asks.
pub fn diagnosed(reference: &Reference, defect: &Defect) -> Option<Diagnosed> {
    let spoilt = reference.trials.iter().zip(&reference.outcomes).find(|(trial, _)| {
        // Scenes of linear elements have all suspects between them.
        let asked = trial.scene.as_contact().is_some_and(|body| {
            matches!(body.data, Data::Exact { .. }) && body.element == Element::P1
        });
        asked && trial.run(defect).verdicts.iter().any(|verdict| !verdict.as_expected())
    });
    let (trial, _) = spoilt?;
    let (_, finding) = examine(&trial.scene, &|setup| defect.apply(setup), true);
    let right = right(defect.term);
    let suspects: Vec<Suspect> = match &finding {
        Finding::One(suspects) => suspects.clone(),
        Finding::Two(a, b) => vec![*a, *b],
        Finding::Unexplained | Finding::NothingFails | Finding::Prediction => Vec::new(),
    };
    let among = suspects.iter().any(|suspect| right.contains(suspect));
    let named = among && suspects.iter().all(|suspect| right.contains(suspect));
    Some(Diagnosed { scene: trial.scene.name.clone(), finding, named, among })
}
