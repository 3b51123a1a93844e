//! Stability at the extremes, as `sweep extremes` found it.

use super::{Pen, outcome};
use crate::document::{Run, Tone};
use crate::studies::Studies;
use crate::studies::practice::{ExtremeRung, Extremes, Ladder};
use files::counted;

/// How a rung ends as it should, and the words for all endings.
const STANDINGS: [(&str, &str); 4] = [
    ("as-expected", "as expected"),
    ("refused-as-expected", "refused as expected"),
    ("not-as-expected", "not as expected"),
    ("failed", "failed"),
];

pub(super) fn write(pen: &mut Pen<'_>, studies: &mut Studies) {
    pen.chapter(
        "chapter-extremes",
        "Extremes",
        "Ladders of one parameter each, from the ordinary to where floating point or the theory ends. Every rung states beforehand what it must \
         show: a bound of its error, derived from rounding and condition, or the refusal that it must meet.",
    );
    match &studies.extremes.take() {
        Some(study) => climbed(pen, study),
        None => pen.absent("There is no such study", "extremes"),
    }
    pen.figures(studies.rest_of("extremes"));
}

fn is_expected(rung: &ExtremeRung) -> bool {
    STANDINGS[..2].iter().any(|(word, _)| *word == rung.standing)
}

/// Every rung is as expected, and there are some.
pub(super) fn holds(study: &Extremes) -> bool {
    !study.rungs.is_empty() && study.rungs.iter().all(is_expected)
}

fn climbed(pen: &mut Pen<'_>, study: &Extremes) {
    let wrong = study.rungs.iter().filter(|rung| !is_expected(rung));
    let failures = wrong.map(|rung| {
        format!("{} at {}: {} ({})", rung.ladder, rung.at, in_words(&rung.standing), rung.note)
    });
    let all = format!("{}, every one as expected.", counted(study.rungs.len(), "rung"));
    outcome(pen, holds(study), &all, failures.collect());
    let row = |ladder: &Ladder| {
        let own = || study.rungs.iter().filter(|rung| rung.ladder == ladder.name);
        let count = |standing: &str| own().filter(|rung| rung.standing == standing).count();
        let [good, refused] = [count(STANDINGS[0].0), count(STANDINGS[1].0)];
        let wrong = own().count() - good - refused;
        let wrong = match wrong {
            0 => Run::plain("0"),
            _ => Run::of(wrong.to_string(), Tone::Miss),
        };
        vec![
            Run::plain(&*ladder.name),
            Run::plain(&*ladder.parameter),
            Run::plain(&*ladder.quantity),
            Run::plain(&*ladder.why),
            Run::plain(good.to_string()),
            Run::plain(refused.to_string()),
            wrong,
        ]
    };
    pen.table(
        "Ladders: what is turned, what is measured, why it is expected, and how many rungs were as expected, refused as expected, or not as expected.",
        &["ladder", "parameter", "measured", "because", ">as exp.", ">refused", ">not"],
        study.ladders.iter().map(row).collect(),
    );
    pen.section("chapter-rungs", "All rungs");
    let row = |rung: &ExtremeRung| {
        let tone = if is_expected(rung) { Tone::Plain } else { Tone::Miss };
        let lost = rung.digits_lost.map_or_else(|| "–".into(), |digits| format!("{digits:.1}"));
        let measured = rung.measured.map_or_else(|| "–".into(), |value| format!("{value:.1e}"));
        vec![
            Run::plain(&*rung.ladder),
            Run::plain(&*rung.at),
            Run::plain(&*rung.expected),
            Run::plain(measured),
            Run::plain(lost),
            Run::of(in_words(&rung.standing), tone),
        ]
    };
    pen.table(
        "Rungs: what was expected and measured, and the decimal digits that rounding took.",
        &["ladder", "at", "expected", ">measured", ">digits lost", "is"],
        study.rungs.iter().map(row).collect(),
    );
}

fn in_words(standing: &str) -> &str {
    STANDINGS.iter().find(|(word, _)| *word == standing).map_or("of no known standing", |(_, w)| w)
}
