//! Introductions of the chapters: what is measured, with the inequality of the paper.

use super::step_size;
use crate::document::{Block, Chapter, Equation, Section};

pub(super) fn of(chapter: Chapter) -> Option<Section> {
    match chapter {
        Chapter::Bound => Some(bound()),
        Chapter::Gronwall => Some(gronwall()),
        Chapter::Audit => Some(audit()),
        Chapter::Trade => Some(trade()),
        // A diagnosis leaves no file.
        Chapter::Diagnose => None,
        Chapter::Extremes => Some(extremes()),
    }
}

fn bound() -> Section {
    let mut section = Section::opening(
        "chapter-step-size",
        "Step size: the bound (3.4)",
        "A step of the scheme has one solution, and the map Λ, which freezes the last slot of the history and solves, contracts, \
         if k is below the bound (3.4). The bound is sufficient only. Four numbers say how far:",
    );
    section.blocks.push(Block::Formulas(step_size::formulas()));
    section.words(
        "1, the bound (3.4), with the norm that the paper takes of ℬ and with the operator norm; 2, sharpened: the last slot has the weight k/2, \
         and each part of the history its own factor; 3, the k at which Λ stops contracting, as measured; 4, the k below which each \
         step is a strongly monotone problem (solvable), and the k at which its solution ends, as followed. 1, 2 and 4 follow from the data of a scene.",
    );
    section
}

fn gronwall() -> Section {
    let mut section = Section::opening(
        "chapter-gronwall",
        "Gronwall's inequality (3.24)",
        "The last step of the proof of Theorem 7: e_n is the error in time at t_n, g_n the truncation error of the history, and each envelope \
         bounds e_n. Effectivity is bound over measured error: 1 is attained, 10 says that the bound is ten times too large.",
    );
    section.blocks.push(Block::Formulas(vec![
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
    ]));
    section.words(
        "Weighted: each part of the history with its own factor at its own age. Primed: the sum above solved with equality; closed: its closed form. \
         Printed: the sum with full weights, as printed, and (3.24), its closed form; both need C₂k < 1.",
    );
    section
}

fn audit() -> Section {
    let mut section = Section::opening(
        "chapter-audit",
        "The inequalities of Theorems 10 and 11",
        "Both sides of the inequalities of the proof of the error estimate, computed at every level of real runs. One holds if it does at all levels \
         of all runs, up to the accuracy of its two sides.",
    );
    section.blocks.push(Block::Formulas(vec![Equation::new(
        "max_n ‖u_n − u_n^{kh}‖ ≤ C k² + C max_n inf_{v∈K^h} (‖u_n − v‖ + ‖γ_j(u_n − v)‖^{1/2} + |E_n(v, u_n)|^{1/2})",
        "max_n norm(u_n - u_n^(k h)) <= C k^2 + C max_n inf_(v in K^h) (norm(u_n - v) + norm(gamma_j (u_n - v))^(1\\/2) + abs(E_n (v, u_n))^(1\\/2))",
        "(4.4)",
    )]));
    section
}

fn trade() -> Section {
    Section::opening(
        "chapter-trade",
        "Speed against accuracy",
        "What the mesh, the step and every other setting of a scene cost and buy. Times are CPU seconds of one thread on the machine of the study, \
         from nothing, in single runs; errors are the same everywhere.",
    )
}

fn extremes() -> Section {
    Section::opening(
        "chapter-extremes",
        "Extremes",
        "Each ladder takes one parameter from the ordinary to where floating point or the theory ends, in steps called rungs. Every rung states \
         beforehand what it must show: a bound of its error, derived from rounding and condition, or that it is refused.",
    )
}
