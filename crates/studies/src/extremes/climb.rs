//! Rungs climbed: their claims, the map of all, and the memory that they take.

use super::rung::{Ladder, Measured, Result, Rung, Unanswered, UnderTest, caught, set_up};
use ::run::sweep::{MemoryLimit, Refused, Runs};
use fem::contact::{Discretization, KKT_ALLOWED};
use judge::claim::{Claim, Place, Relation, Standing, Statement};
use report::{Cell, Chapter, Findings, Map, Shade};

/// What the ladder claims of one rung, then the residual where there is one; a panic is a claim that fails and not the end
/// of the others.
pub fn climb(ladder: &Ladder, rung: &Rung, under_test: &UnderTest<'_>) -> Vec<Claim> {
    claims(ladder, &rung.at, rung.expected, &caught(|| rung.measured(under_test)))
}

/// What a rung claims of its outcome. NaN holds nowhere, and no refusal covers a panic.
pub fn claims(
    ladder: &Ladder,
    at: &str,
    expected: Relation,
    outcome: &Result<Measured>,
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

/// All that was climbed, the claims of each rung. Files of ladders that were named carry their names, so that one run does
/// not replace another.
pub fn found(ladders: &[Ladder], named: &[String], climbed: &[Vec<Claim>]) -> Findings {
    let title = (Chapter::Extremes, "Ladders and rungs".to_owned());
    let mut findings = Findings::new(title, None, climbed.concat());
    findings.document.scene = (!named.is_empty()).then(|| named.join("-"));
    findings.table(
        "ladders",
        ladders,
        "Ladders: the parameter, and the reason for what is expected.",
        "ladder = name; parameter = parameter; expected because = why",
    );
    // One line a ladder, one cell a rung, shaded by how far the measured number is within what is allowed: the lightest at six
    // decades or more, the darkest at the bound.
    let of_ladder = |ladder: &Ladder| -> Vec<Cell> {
        let own = |claims: &&Vec<Claim>| claims[0].statement.source == ladder.name;
        let rungs = climbed.iter().filter(own);
        rungs.map(|claims| (claims[0].place.at.clone(), shade(claims))).collect()
    };
    let shades = || climbed.iter().map(|claims| shade(claims));
    let wrong = shades().filter(|shade| *shade == Shade::Wrong).count();
    let refused = shades().filter(|shade| *shade == Shade::Outside).count();
    let map = Map {
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
    };
    let shows = "every rung of the ladders against its expectation (sweep extremes).";
    findings.document.figure("extremes", shows, Some(map.svg()));
    findings
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

// What a rung takes of the memory.

/// n² N below which a run takes next to nothing.
const SMALL: u64 = 4096;

/// Refuses a rung that would take more memory than there may be. One without a mesh has no n.
///
/// # Errors
/// [`Refused`].
pub fn admit(
    ladder: &Ladder,
    rung: &Rung,
    under_test: &UnderTest<'_>,
    limit: &MemoryLimit,
) -> Result<(), Refused> {
    let Rung { n, steps, .. } = *rung;
    if u64::from(n).pow(2) * u64::from(steps) < SMALL {
        return Ok(());
    }
    // A scene that is refused is so when it is climbed.
    let Ok(setup) = set_up(rung.text.clone(), under_test.prepare) else { return Ok(()) };
    // An answer is all levels: u and σ, in lists that double as they grow, and the moments that they are measured against.
    let answer = |space: &Discretization, steps: u32| {
        let d = space.mesh.dimension;
        let (tensor, cells) = (d * (d + 1) / 2, space.mesh.cell_count());
        let moments = 2 * tensor + d * (d + 1);
        let numbers = 2 * (space.nodes.len() + tensor * cells) + moments * cells;
        8.0 * (f64::from(steps) + 1.0) * numbers as f64
    };
    let grid = vec![(n, steps)];
    let runs = Runs { setup: &setup, grid, beside: Box::new(answer) };
    runs.admit(limit).map_err(|refused| Refused {
        what: format!(
            "{} at {} (other ladders, or none of --long, take less)",
            ladder.name, rung.at
        ),
        source: refused.source,
    })
}
