//! The bound (3.4) of every scene, in numbers that follow from its data.

use super::{Report, id};
use crate::document::{
    Chapter, Equation, Run, Section, StudyDocument, Table, Tone, digits, number,
};
use crate::{SceneSummary, StepLimits};

/// Hypotheses necessary for a bound: (2.9) and κ Lipschitz, by their names in scene files.
const NEEDED: [&str; 2] = ["2.9", "5.1"];

pub(super) fn section(report: &Report<'_>) -> Section {
    let mut section = Section::new(2, "chapter-step-sizes", "Bounds of all scenes");
    let rows = report.scenes.iter().map(|scene| row(scene, report)).collect();
    section.table(Table::new(
        "Step sizes: bounds on k, and the largest k of the records.",
        &[
            "scene",
            ">m0",
            ">(3.4), paper's norm",
            ">(3.4)",
            ">sharpened",
            ">Λ measured",
            ">solvable",
            ">largest k",
            "which is",
        ],
        rows,
    ));
    section
}

pub(super) fn formulas() -> Vec<Equation> {
    vec![
        Equation::new(
            "m0 = m_A − α_φ − α_j c_j² > 0",
            "m_0 = m_A - alpha_phi - alpha_j c_j^2 > 0",
            "(2.9)",
        ),
        Equation::new("k β_φ ‖R‖ ‖q‖ < m0", "k beta_phi norm(R) thin norm(q) < m_0", "(3.4)"),
        Equation::new(
            "‖Λη − Λη′‖ ≤ (k β_φ ‖R‖ ‖q‖ / m0) ‖η − η′‖",
            "norm(Lambda eta - Lambda eta') <= (k beta_phi norm(R) thin norm(q))/m_0 norm(eta - eta')",
            "(3.15)",
        ),
    ]
}

fn row(scene: &SceneSummary, report: &Report<'_>) -> Vec<Run> {
    let of_scene = report.records.iter().filter(|record| record.scene == scene.name);
    let largest = of_scene.map(|record| record.k).reduce(f64::max);
    let study = |study: &&StudyDocument| {
        study.chapter == Chapter::Bound && study.scene.as_ref() == Some(&scene.name)
    };
    let measured = report.studies.iter().find(study).and_then(|study| {
        Some(Run::plain(study.threshold.as_ref()?).to(format!("#{}", id(study))))
    });
    let measured = measured.unwrap_or_else(|| Run::plain("–"));
    let link = |text: &str| Run::plain(text).to(format!("#{}", report.stem(scene)));
    let Some(limits) = scene.step else {
        let mut cells = vec![link(&scene.name)];
        cells.extend((0..4).map(|_| Run::plain("–")));
        cells.extend([measured, Run::plain("–"), number(largest), Run::plain("not computed")]);
        return cells;
    };
    let broken = scene.violates.iter().find(|name| NEEDED.contains(&name.as_str()));
    let limit = |k: f64| match broken {
        Some(_) => Run::plain("–"),
        None => Run::plain(if k.is_infinite() { "every k".into() } else { digits(k, 5) }),
    };
    let standing = match broken {
        Some(name) => Run::plain(format!("without a bound: ({name}) is broken")),
        None => standing(&limits, largest),
    };
    vec![
        link(&scene.name),
        number(limits.m0),
        limit(limits.paper),
        limit(limits.theorem),
        limit(limits.sharpened),
        measured,
        limit(limits.solvable),
        number(largest),
        standing,
    ]
}

/// Position of the largest step of the records.
fn standing(limits: &StepLimits, largest: Option<f64>) -> Run {
    match largest {
        None => Run::plain("–"),
        Some(k) if k < limits.theorem => Run::plain("within (3.4)"),
        Some(k) if k < limits.solvable => Run::plain("beyond (3.4), one solution"),
        // Includes NaN limits.
        Some(_) => Run::of("not guaranteed", Tone::Strong),
    }
}
