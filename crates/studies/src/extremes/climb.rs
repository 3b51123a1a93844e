//! Rungs climbed: each is a claim of its ladder, and one of the solver's residual.

use std::time::Instant;

use super::UnderTest;
use super::answer::{Unanswered, caught};
use super::rung::{Ladder, Measured, Relation, Rung};
use fem::contact::KKT_ALLOWED;
use judge::claim::{Claim, Place, Standing, Statement};
use report::{Cell, Chapter, Findings, Map, Row, Run, Shade};

/// A rung that was climbed.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Climbed {
    pub ladder: &'static str,
    pub at: String,
    /// What the ladder claims, then the residual where there is one.
    #[serde(skip)]
    pub claims: Vec<Claim>,
    /// Newton iterations per level.
    pub iterations: Option<f64>,
    /// Seconds it took.
    pub seconds: f64,
}

/// Runs one rung; a panic is a claim that fails and not the end of the others.
pub fn climb(ladder: &Ladder, rung: &Rung, under_test: &UnderTest<'_>) -> Climbed {
    let start = Instant::now();
    let outcome = caught(|| (rung.run)(under_test));
    Climbed {
        ladder: ladder.name,
        at: rung.at.clone(),
        claims: claims(ladder, &rung.at, rung.expected, &outcome),
        iterations: outcome.ok().and_then(|measured| measured.iterations),
        seconds: start.elapsed().as_secs_f64(),
    }
}

/// What a rung claims of its outcome. NaN holds nowhere, and no refusal covers a panic.
pub fn claims(
    ladder: &Ladder,
    at: &str,
    expected: Relation,
    outcome: &Result<Measured, Unanswered>,
) -> Vec<Claim> {
    let statement = Statement { source: ladder.name, says: ladder.quantity };
    let place = Place { at: at.to_owned(), ..Place::default() };
    let none = Claim { statement, place, relation: expected, ..Claim::default() };
    match outcome {
        Err(Unanswered::Panicked(text)) => {
            let relation = Relation::AtMost(f64::NAN);
            vec![Claim { relation, note: text.clone(), ..none }]
        }
        Err(Unanswered::Refused(said)) => vec![Claim { note: said.clone(), ..none }],
        Ok(measured) => {
            let claim = Claim { left: measured.value, note: measured.note.clone(), ..none };
            // A solver may stop without a look at its residual.
            let residual = measured.kkt.map(|kkt| {
                let says = "largest relative residual, by separate evaluation";
                let statement = Statement { source: "KKT", says };
                let at = format!("{} at {at}", ladder.name);
                Claim::at_most(statement, Place { at, ..Place::default() }, [kkt, KKT_ALLOWED], 0.0)
            });
            [Some(claim), residual].into_iter().flatten().collect()
        }
    }
}

/// All that was climbed.
pub fn found(ladders: &[Ladder], climbed: &[Climbed]) -> Findings {
    let claims: Vec<Claim> = climbed.iter().flat_map(|rung| rung.claims.clone()).collect();
    let title = (Chapter::Extremes, "Ladders and rungs".to_owned());
    let mut findings = Findings::new(title, None, claims);
    let row = |ladder: &Ladder| -> Row<'static, 4> {
        let rungs = climbed.iter().filter(|rung| rung.ladder == ladder.name).count();
        [
            ("ladder", Run::plain(ladder.name)),
            ("parameter", Run::plain(ladder.parameter)),
            (">rungs", Run::plain(rungs.to_string())),
            ("expected because", Run::plain(ladder.why)),
        ]
    };
    let caption =
        "Ladders: the parameter, the number of rungs, and the reason for what is expected.";
    findings.document.table(caption, ladders.iter().map(row));
    let shows = "every rung of the ladders against its expectation (sweep extremes).";
    findings.document.figure("extremes", shows, Some(map(ladders, climbed)));
    findings.number("ladders", ladders);
    findings.number("rungs", climbed);
    findings
}

/// The map of all rungs: one line a ladder, one cell a rung, shaded by how far the measured number is within what is allowed:
/// the lightest at six decades or more, the darkest at the bound.
fn map(ladders: &[Ladder], climbed: &[Climbed]) -> String {
    let of_ladder = |ladder: &Ladder| -> Vec<Cell> {
        let rungs = climbed.iter().filter(|rung| rung.ladder == ladder.name);
        rungs.map(|rung| (rung.at.clone(), shade(&rung.claims))).collect()
    };
    let shades = || climbed.iter().map(|rung| shade(&rung.claims));
    let wrong = shades().filter(|shade| *shade == Shade::Wrong).count();
    let refused = shades().filter(|shade| *shade == Shade::Outside).count();
    Map {
        title: format!("{} rungs of {} ladders", climbed.len(), ladders.len()),
        subtitle: format!("{refused} refused as expected, {wrong} not as expected"),
        rows: ladders.iter().map(|ladder| (ladder.name.to_owned(), of_ladder(ladder))).collect(),
        legend: [
            (Shade::Within(0.3), "as expected, darker nearer the bound"),
            (Shade::Outside, "refused as expected"),
            (Shade::Wrong, "not as expected"),
        ],
        heads: Vec::new(),
        notes: Vec::new(),
    }
    .svg()
}

/// Decades over which the shade goes from the darkest to the lightest.
const DECADES: f64 = 6.0;

fn shade(claims: &[Claim]) -> Shade {
    let holds = claims.iter().all(|claim| claim.standing() == Standing::Passes);
    match claims.first().filter(|_| holds) {
        None => Shade::Wrong,
        Some(Claim { relation: Relation::Refused(_), .. }) => Shade::Outside,
        Some(Claim { relation: Relation::AtMost(most), left, .. }) => {
            let decades = (most.max(f64::MIN_POSITIVE) / left.max(f64::MIN_POSITIVE)).log10();
            Shade::Within(1.0 - decades / DECADES)
        }
        Some(_) => Shade::Within(0.5),
    }
}
