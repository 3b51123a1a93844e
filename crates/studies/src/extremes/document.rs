//! All ladders climbed, in words and tables.

use super::judge::{RungRow, Standing};
use super::rung::Ladder;
use super::table::map;
use files::counted;
use report::{Chapter, Row, Run, StudyDocument, Tone};
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
            self.ladders.iter().map(|ladder| self.ladder(ladder)),
        );
        document.table(
            "Rungs: what was expected and measured, the decimal digits that rounding took, Newton iterations per level, the largest KKT residual.",
            self.rungs.iter().map(rung),
        );
        let shows = "every rung of the ladders against its expectation (sweep extremes).";
        document.figure("extremes", shows, Some(map(&self.ladders, &self.rungs)));
        document
    }

    fn ladder(&self, ladder: &Ladder) -> Row<'static, 7> {
        let of_ladder = || self.rungs.iter().filter(|rung| rung.ladder == ladder.name);
        let count =
            |standing: Standing| of_ladder().filter(|rung| rung.standing == standing).count();
        let [good, refused] = [Standing::AsExpected, Standing::RefusedAsExpected].map(count);
        let wrong = of_ladder().count() - good - refused;
        [
            ("ladder", Run::plain(ladder.name)),
            ("parameter", Run::plain(ladder.parameter)),
            ("measured", Run::plain(ladder.quantity)),
            ("because", Run::plain(ladder.why)),
            (">as expected", Run::plain(good.to_string())),
            (">refused", Run::plain(refused.to_string())),
            (">not", Run::of(wrong.to_string(), tone(wrong == 0))),
        ]
    }
}

fn rung(rung: &RungRow) -> Row<'static, 9> {
    let dash = || "–".into();
    let short = |value: Option<f64>| Run::plain(value.map_or_else(dash, |v| format!("{v:.1e}")));
    let digit = |value: Option<f64>| Run::plain(value.map_or_else(dash, |v| format!("{v:.1}")));
    [
        ("ladder", Run::plain(rung.ladder)),
        ("at", Run::plain(&*rung.at)),
        ("expected", Run::plain(&*rung.expected)),
        (">measured", short(rung.measured)),
        (">digits lost", digit(rung.digits_lost)),
        (">iterations", digit(rung.iterations)),
        (">KKT", short(rung.kkt)),
        ("is", Run::of(rung.standing.words(), tone(rung.standing.as_expected()))),
        ("note", Run::plain(&*rung.note)),
    ]
}

fn tone(as_expected: bool) -> Tone {
    if as_expected { Tone::Plain } else { Tone::Miss }
}
