//! Gronwall's inequality (3.24): envelopes over measured errors, as `sweep gronwall` found them.

use super::{Pen, id, number, outcome, sides};
use crate::document::{Equation, Run};
use crate::studies::Studies;
use crate::studies::theory::{Effectivity, Grid, Gronwall};

pub(super) fn write(pen: &mut Pen<'_>, studies: &mut Studies) {
    pen.chapter(
        "chapter-gronwall",
        "Gronwall's inequality (3.24)",
        "The last step of the proof of Theorem 7: e_n is the error in time at t_n, g_n the truncation error of the history, and each envelope \
         bounds e_n. Effectivity is bound over measured error: 1 is attained, 10 says that the bound is ten times too large.",
    );
    pen.formulas(vec![
        Equation::new(
            "e_n ≤ C₁ g_n + C₂ Σ′_{j≤n} w_{nj} e_j,   C₁ = β_φ/m0,   C₂ = β_φ ‖R‖ ‖q‖/m0",
            "e_n <= C_1 g_n + C_2 limits(sum')_(j<=n) w_(n j) e_j, quad C_1 = beta_phi/m_0, quad C_2 = (beta_phi norm(R) thin norm(q))/m_0",
            "(3.21)",
        ),
        Equation::new(
            "e_n ≤ C₁ max g / (1 − C₂k) · exp(C₂ n k/(1 − C₂k))",
            "e_n <= (C_1 max g)/(1 - C_2 k) exp((C_2 n k)/(1 - C_2 k))",
            "(3.24)",
        ),
    ]);
    pen.words(
        "Weighted: each part of the history with its own factor at its own age. Primed: the sum above solved with equality; closed: its closed form. \
         Printed: the sum with full weights, as printed, and (3.24), its closed form; both need C₂k < 1.",
    );
    if studies.gronwall.is_empty() {
        pen.absent("There is no such study", "gronwall SCENE");
    }
    for found in std::mem::take(&mut studies.gronwall) {
        study(pen, &found);
        pen.figures(studies.take(&found.scene, "-gronwall"));
    }
    pen.figures(studies.rest_of("-gronwall"));
}

/// Nothing is violated, and there was something that could have been.
pub(super) fn holds(study: &Gronwall) -> bool {
    study.violations.is_empty() && !study.grids.is_empty()
}

fn study(pen: &mut Pen<'_>, study: &Gronwall) {
    pen.section(&id("gronwall", &study.scene), &format!("Envelopes: {}", study.scene));
    pen.of_this_text(&study.scene, &study.fingerprint);
    let mesh = study.n.map_or_else(String::new, |n| format!("n = {n}; "));
    pen.words(&format!("{mesh}the truth is: {}.", study.truth));
    let failures = study
        .violations
        .iter()
        .map(|v| format!("{}: {} at n = {}: {}", v.part, v.link, v.n, sides(v.left, v.right)));
    let all = "The chain error ≤ weighted ≤ primed ≤ closed, primed ≤ printed ≤ its closed form holds at every n of every run.";
    outcome(pen, holds(study), all, failures.collect());
    let constants =
        study.constants.iter().map(|(name, value)| vec![Run::plain(name), number(*value)]);
    pen.table(
        format!("{}: constants of the inequality.", study.scene),
        &["constant", ">value"],
        constants.collect(),
    );
    pen.table(
        format!("{}: bound over error at t = T for N steps; e and g at T.", study.scene),
        &[
            ">N",
            ">C₂k",
            ">e_N",
            ">g_N",
            ">weighted",
            ">primed",
            ">closed",
            ">k → 0",
            ">printed",
            ">(3.24)",
        ],
        study.grids.iter().map(grid).collect(),
    );
    if let Some(horizons) = &study.horizons {
        let row = |row: &crate::studies::theory::Horizon| {
            let cells = [row.error, row.weighted, row.primed, row.closed, row.growth, row.c2];
            [number(Some(row.horizon))].into_iter().chain(cells.map(number)).collect()
        };
        pen.table(
            format!(
                "{}: long times at k = {}; maxima over [0, T]. Growth is d(log error)/dT, to compare with C₂.",
                study.scene,
                super::digits(horizons.k)
            ),
            &[">T", ">error", ">weighted", ">primed", ">closed", ">growth", ">C₂"],
            horizons.rows.iter().map(row).collect(),
        );
    }
    let perturbed = |p: &crate::studies::theory::Perturbation| {
        let cells = [p.size, p.load, p.difference, p.growth, p.least_effectivity];
        [Run::plain(&*p.shape)].into_iter().chain(cells.map(number)).collect()
    };
    pen.table(
        format!(
            "{}: two loads f and f + δf at the largest N; growth is m0 max‖u − v‖/max‖δf‖, the last column the least bound over difference.",
            study.scene
        ),
        &["shape", ">size", ">max ‖δf‖", ">max ‖u − v‖", ">growth", ">least"],
        study.perturbations.iter().map(perturbed).collect(),
    );
}

fn grid(grid: &Grid) -> Vec<Run> {
    let e = &grid.effectivity;
    let at_end = |own: &Effectivity| number(own.at_end);
    let printed =
        |own: &Option<Effectivity>| own.as_ref().map_or_else(|| Run::plain("C₂k ≥ 1"), at_end);
    vec![
        Run::plain(grid.steps.to_string()),
        number(grid.c2_k),
        number(grid.error_end),
        number(grid.truncation_end),
        at_end(&e.weighted),
        at_end(&e.primed),
        at_end(&e.closed),
        at_end(&e.limit),
        printed(&e.printed),
        printed(&e.printed_closed),
    ]
}
