//! Lines across a picture at values of its axes, with letters that the legend explains.

use super::ReportError;
use super::canvas::{Anchor, Canvas};
use super::chart::{Chart, Mark};
use super::frame::{BOTTOM, Frame, LEFT, RIGHT, TOP};
use super::legend::{Sample, Stroke};
use super::palette::INK;
use super::ruler::Scale;

/// Strokes and gaps of the first, second, … line, distinct without colours.
const PATTERNS: [(f64, f64); 4] = [(22.0, 10.0), (6.0, 8.0), (40.0, 10.0), (12.0, 22.0)];

/// Least distance of two letters.
const LETTERS: f64 = 32.0;

/// Length of the stroke from a line to its letter.
const STUB: f64 = 12.0;

/// The marks that can be placed, with the numbers of their letters; verticals come first.
fn placed(marks: &[Mark], scale: Scale, before: usize) -> Vec<(usize, &Mark)> {
    let has_place = |mark: &&Mark| scale.holds(mark.at);
    marks.iter().filter(has_place).enumerate().map(|(i, mark)| (before + i, mark)).collect()
}

fn both(chart: &Chart) -> [Vec<(usize, &Mark)>; 2] {
    let verticals = placed(&chart.verticals, chart.x.scale, 0);
    let horizontals = placed(&chart.horizontals, chart.y.scale, verticals.len());
    [verticals, horizontals]
}

fn letter(index: usize) -> char {
    char::from(b'a' + (index % 26) as u8)
}

pub(super) fn draw_marks(
    canvas: &Canvas<'_>,
    frame: &Frame,
    chart: &Chart,
) -> Result<(), ReportError> {
    let [verticals, horizontals] = both(chart);
    for ((index, _), at, tag) in spread(&verticals, |at| frame.across(at)) {
        canvas.dashed(&[(at, TOP), (at, BOTTOM)], INK, PATTERNS[index % PATTERNS.len()])?;
        canvas.line(&[(at, TOP), (tag, TOP - STUB)], INK, 2)?;
        let words = letter(index).to_string();
        canvas.text(&words, (tag, TOP - STUB - 18.0), Anchor::Centre)?;
    }
    for ((index, _), at, tag) in spread(&horizontals, |at| frame.up(at)) {
        canvas.dashed(&[(LEFT, at), (RIGHT, at)], INK, PATTERNS[index % PATTERNS.len()])?;
        canvas.line(&[(RIGHT, at), (RIGHT + STUB, tag)], INK, 2)?;
        let words = letter(index).to_string();
        canvas.text(&words, (RIGHT + STUB + 3.0, tag), Anchor::Left)?;
    }
    Ok(())
}

/// Each mark with its place and that of its letter; letters keep their order and distance.
fn spread<'a>(
    marks: &[(usize, &'a Mark)],
    place: impl Fn(f64) -> f64,
) -> Vec<((usize, &'a Mark), f64, f64)> {
    let mut all: Vec<_> =
        marks.iter().map(|mark| (*mark, place(mark.1.at), place(mark.1.at))).collect();
    all.sort_by(|a, b| a.1.total_cmp(&b.1));
    for i in 1..all.len() {
        all[i].2 = all[i].2.max(all[i - 1].2 + LETTERS);
    }
    all
}

/// Legend entries; marks without a place come last, without a letter.
pub(super) fn mark_entries(chart: &Chart) -> Vec<(Sample, String)> {
    let drawn = both(chart).into_iter().flatten().map(|(index, mark)| {
        let stroke = Some(Stroke::Broken(PATTERNS[index % PATTERNS.len()]));
        (Sample::Series { stroke, shape: None }, format!("{}: {}", letter(index), mark.label))
    });
    let lost = |marks: &[Mark], scale: Scale| -> Vec<(Sample, String)> {
        let nowhere = marks.iter().filter(|mark| !scale.holds(mark.at));
        nowhere.map(|mark| (Sample::Text, mark.label.clone())).collect()
    };
    let verticals = lost(&chart.verticals, chart.x.scale);
    drawn.chain(verticals).chain(lost(&chart.horizontals, chart.y.scale)).collect()
}
