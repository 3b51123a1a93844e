//! Lines across a picture at values of its axes, with letters that the legend explains.

use super::canvas::INK;
use super::canvas::{Anchor, Canvas};
use super::chart::{Chart, Mark, Part};
use super::frame::Frame;
use super::legend::spread;
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

fn pattern(index: usize) -> (f64, f64) {
    PATTERNS[index % PATTERNS.len()]
}

fn letter(index: usize) -> char {
    char::from(b'a' + (index % 26) as u8)
}

pub(super) fn draw_marks(canvas: &mut Canvas, frame: &Frame, chart: &Chart) {
    let ([left, top, right, bottom], [verticals, horizontals]) = (frame.room, both(chart));
    for (index, at, tag) in spaced(&verticals, |at| frame.across(at)) {
        canvas.dashed(&[(at, top), (at, bottom)], INK, pattern(index));
        canvas.line(&[(at, top), (tag, top - STUB)], INK, 2);
        canvas.text(&letter(index).to_string(), (tag, top - STUB - 18.0), Anchor::Centre);
    }
    for (index, at, tag) in spaced(&horizontals, |at| frame.up(at)) {
        canvas.dashed(&[(left, at), (right, at)], INK, pattern(index));
        canvas.line(&[(right, at), (right + STUB, tag)], INK, 2);
        canvas.text(&letter(index).to_string(), (right + STUB + 3.0, tag), Anchor::Left);
    }
}

/// Each mark with its place and that of its letter; letters keep their order and distance.
fn spaced(marks: &[(usize, &Mark)], place: impl Fn(f64) -> f64) -> Vec<(usize, f64, f64)> {
    let mut all: Vec<_> = marks.iter().map(|(index, mark)| (*index, place(mark.at))).collect();
    all.sort_by(|a, b| a.1.total_cmp(&b.1));
    let places: Vec<f64> = all.iter().map(|(_, place)| *place).collect();
    let tags = spread(&places, LETTERS, [f64::NEG_INFINITY, f64::INFINITY]);
    all.into_iter().zip(tags).map(|((index, at), tag)| (index, at, tag)).collect()
}

/// Legend entries; marks without a place come last, without a letter.
pub(super) fn mark_entries(chart: &Chart) -> Vec<(Option<Part>, String)> {
    let drawn = both(chart).into_iter().flatten().map(|(index, mark)| {
        let sample = Part::Broken(pattern(index), Vec::new());
        (Some(sample), format!("{}: {}", letter(index), mark.label))
    });
    let lost = |marks: &[Mark], scale: Scale| -> Vec<(Option<Part>, String)> {
        let nowhere = marks.iter().filter(|mark| !scale.holds(mark.at));
        nowhere.map(|mark| (None, mark.label.clone())).collect()
    };
    let verticals = lost(&chart.verticals, chart.x.scale);
    drawn.chain(verticals).chain(lost(&chart.horizontals, chart.y.scale)).collect()
}
