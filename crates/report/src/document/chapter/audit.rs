//! The proofs of Theorems 10 and 11 as a checklist, as `sweep audit` found it, and the theorem ledger.

use super::{Pen, held, id, number, outcome};
use crate::document::{Equation, Run, Tone};
use crate::studies::theory::{Audit, Claim, Line};
use crate::studies::{Number, Studies};

pub(super) fn write(pen: &mut Pen<'_>, studies: &mut Studies) {
    pen.chapter(
        "chapter-audit",
        "The proofs of Theorems 10 and 11, line by line",
        "Both sides of every line of the proof of the error estimate, computed at every level of real runs. A line holds if it does at all levels \
         of all runs, up to the accuracy of its two sides.",
    );
    pen.formulas(vec![Equation::new(
        "max_n ‖u_n − u_n^{kh}‖ ≤ C k² + C max_n inf_{v∈K^h} (‖u_n − v‖ + ‖γ_j(u_n − v)‖^{1/2} + |E_n(v, u_n)|^{1/2})",
        "max_n norm(u_n - u_n^(k h)) <= C k^2 + C max_n inf_(v in K^h) (norm(u_n - v) + norm(gamma_j (u_n - v))^(1\\/2) + abs(E_n (v, u_n))^(1\\/2))",
        "(4.4)",
    )]);
    if studies.audits.is_empty() {
        pen.absent("There is no audit", "audit SCENE");
    }
    for found in std::mem::take(&mut studies.audits) {
        checklist(pen, &found);
        pen.figures(studies.take(&found.scene, "-audit"));
    }
    let rest = studies.rest_of("-audit");
    ledger(pen, &std::mem::take(&mut studies.ledger));
    pen.figures(rest);
}

/// The audit says so, and its lines do.
pub(super) fn holds(audit: &Audit) -> bool {
    let lines = !audit.lines.is_empty() && audit.lines.iter().all(|line| line.holds);
    audit.holds && lines && audit.violations.is_empty()
}

fn checklist(pen: &mut Pen<'_>, audit: &Audit) {
    pen.section(&id("audit", &audit.scene), &format!("Checklist: {}", audit.scene));
    pen.of_this_text(&audit.scene, &audit.fingerprint);
    let range = |of: fn(&crate::studies::theory::Case) -> u32| {
        let mut all: Vec<u32> = audit.cases.iter().map(of).collect();
        all.sort_unstable();
        all.dedup();
        all.iter().map(u32::to_string).collect::<Vec<_>>().join(", ")
    };
    pen.words(&format!(
        "{}; boundary rule {}; runs with n = {} and N = {}.",
        audit.theorem,
        audit.rule,
        range(|case| case.n),
        range(|case| case.steps)
    ));
    let held_lines = audit.lines.iter().filter(|line| line.holds).count();
    let all = format!("{held_lines} of {} lines hold in all runs.", audit.lines.len());
    let mut failures = audit.violations.clone();
    failures.extend(audit.undefined.iter().cloned());
    if failures.is_empty() {
        failures.push(all.clone());
    }
    outcome(pen, holds(audit), &all, failures);
    pen.table(
        format!(
            "{}: the lines of the proof; left and right side of the finest run, the largest left/right of all runs, and the powers of h and k with which the sides fall.",
            audit.scene
        ),
        &["line", "says", ">left", "", ">right", ">ratio", "powers of h", "powers of k", "so it"],
        audit.lines.iter().map(line).collect(),
    );
}

fn line(line: &Line) -> Vec<Run> {
    let sign = if line.relation == "=" { "=" } else { "≤" };
    let powers = |[left, right]: [Number; 2]| {
        let text = |power: Number| power.map_or_else(|| "–".to_owned(), |p| format!("{p:.2}"));
        Run::plain(format!("{}, {}", text(left), text(right)))
    };
    vec![
        Run::plain(&*line.line),
        Run::plain(&*line.says),
        number(line.left),
        Run::plain(sign),
        number(line.right),
        number(line.ratio),
        powers(line.power_h),
        powers(line.power_k),
        held(line.holds),
    ]
}

fn ledger(pen: &mut Pen<'_>, claims: &[Claim]) {
    if claims.is_empty() {
        return pen.absent("There is no ledger of claims, sharp or slack,", "audit --ledger");
    }
    pen.section("chapter-ledger", "What runs say of the claims");
    pen.words("Proved is the power, or the constant, that the proof gives; observed is what the smallest scene that shows it has.");
    let row = |claim: &Claim| {
        let found = match claim.confirmed {
            true => Run::of(&*claim.claimed, Tone::Pass),
            false => Run::of(format!("{}: not confirmed", claim.claimed), Tone::Miss),
        };
        vec![
            Run::plain(&*claim.claim),
            Run::plain(&*claim.hypotheses),
            Run::plain(&*claim.quantity),
            number(claim.proved),
            number(claim.observed),
            found,
        ]
    };
    pen.table(
        "Claims on the proofs, each with what a run observes.",
        &["claim", "hypotheses", "quantity", ">proved", ">observed", "is"],
        claims.iter().map(row).collect(),
    );
    pen.words("Each is shown by one command:");
    let commands: Vec<&str> = claims.iter().map(|claim| claim.command.as_str()).collect();
    pen.block(crate::document::Block::Code(commands.join("\n")));
}
