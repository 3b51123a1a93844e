//! All ladders climbed, in words and tables.

use super::judge::{RungRow, Standing};
use super::rung::Ladder;
use super::table::map;
use files::counted;
use report::{Chapter, Run, StudyDocument, Tone};
use serde::Serialize;

/// Ladders with their rungs, judged.
#[derive(Serialize)]
pub struct Climbed {
    /// What was turned, and why something was expected.
    pub ladders: Vec<Ladder>,
    /// One row per rung.
    pub rungs: Vec<RungRow>,
}

impl Climbed {
    /// Every rung is as expected, and there are some.
    pub fn holds(&self) -> bool {
        !self.rungs.is_empty() && self.rungs.iter().all(|rung| rung.standing.as_expected())
    }

    /// The rungs as a document.
    pub fn document(&self) -> StudyDocument {
        let mut document = StudyDocument::new(Chapter::Extremes, "Ladders and rungs");
        let wrong = self.rungs.iter().filter(|rung| !rung.standing.as_expected());
        let failures = wrong.map(|rung| {
            format!("{} at {}: {} ({})", rung.ladder, rung.at, rung.standing.words(), rung.note)
        });
        let all = format!("{}, every one as expected.", counted(self.rungs.len(), "rung"));
        document.verdict(self.holds(), &all, failures.collect());
        document.table(
            "Ladders: what is turned, what is measured, why it is expected, and how many rungs were as expected, refused as expected, or not as expected.",
            &["ladder", "parameter", "measured", "because", ">as expected", ">refused", ">not"],
            self.ladders.iter().map(|ladder| self.ladder(ladder)).collect(),
        );
        document.table(
            "Rungs: what was expected and measured, the decimal digits that rounding took, Newton iterations per level, the largest KKT residual.",
            &[
                "ladder", "at", "expected", ">measured", ">digits lost", ">iterations", ">KKT", "is",
                "note",
            ],
            self.rungs.iter().map(rung).collect(),
        );
        let shows = "every rung of the ladders against its expectation (sweep extremes).";
        document.figure("extremes", shows, Some(map(&self.ladders, &self.rungs)));
        document
    }

    fn ladder(&self, ladder: &Ladder) -> Vec<Run> {
        let of_ladder = || self.rungs.iter().filter(|rung| rung.ladder == ladder.name);
        let count =
            |standing: Standing| of_ladder().filter(|rung| rung.standing == standing).count();
        let [good, refused] = [Standing::AsExpected, Standing::RefusedAsExpected].map(count);
        let wrong = of_ladder().count() - good - refused;
        let tone = if wrong == 0 { Tone::Plain } else { Tone::Miss };
        let words = [ladder.name, ladder.parameter, ladder.quantity, ladder.why].map(Run::plain);
        let counts = [good, refused].map(|count| Run::plain(count.to_string()));
        words.into_iter().chain(counts).chain([Run::of(wrong.to_string(), tone)]).collect()
    }
}

fn rung(rung: &RungRow) -> Vec<Run> {
    let tone = if rung.standing.as_expected() { Tone::Plain } else { Tone::Miss };
    let short = |value: Option<f64>| value.map_or_else(|| "–".into(), |v| format!("{v:.1e}"));
    let digit = |value: Option<f64>| value.map_or_else(|| "–".into(), |v| format!("{v:.1}"));
    let words = [rung.ladder, &rung.at, &rung.expected].map(Run::plain);
    let [measured, kkt] = [rung.measured, rung.kkt].map(|value| Run::plain(short(value)));
    let [lost, iterations] = [rung.digits_lost, rung.iterations].map(|v| Run::plain(digit(v)));
    let standing = Run::of(rung.standing.words(), tone);
    let rest = [measured, lost, iterations, kkt, standing, Run::plain(&*rung.note)];
    words.into_iter().chain(rest).collect()
}
