//! Triangles of a predicted order, placed in free space.

use super::canvas::Colour;
use super::canvas::{Anchor, Canvas, CanvasPoint, corners, span};
use super::chart::{Chart, Datum, Part};
use super::frame::Frame;

/// A predicted order along points of a series.
#[derive(Debug, Clone, PartialEq)]
pub struct Slope {
    /// y grows like x to this power.
    pub order: f64,
    pub label: String,
    /// The points, along rising x: the triangle stands between two neighbours.
    pub along: Vec<Datum>,
}

/// A placed triangle: fine end, corner, coarse end.
pub(super) struct Placed {
    pub(super) series: usize,
    corners: [CanvasPoint; 3],
    label: String,
}

/// Distance to everything drawn: half a marker and a little more.
const CLEAR: f64 = 22.0;

/// Step by which a triangle is moved from its line.
const MOVE: f64 = 12.0;

/// Width of a character and half of the line height.
const CHARACTER: f64 = 19.0;
const HALF_LINE: f64 = 18.0;

type Segment = [CanvasPoint; 2];

/// The triangles that find a place, as close below their lines as possible, between the finest points that allow it.
/// None on linear axes.
pub(super) fn place(chart: &Chart, frame: &Frame) -> Vec<Placed> {
    let Some(decade) = frame.decade() else {
        return Vec::new();
    };
    let mut taken = drawn(chart, frame);
    let mut placed = Vec::new();
    for (series, slope) in
        chart.series.iter().enumerate().filter_map(|(i, series)| Some((i, series.slope.as_ref()?)))
    {
        if let Some(corners) = free_place(slope, frame, decade, &taken) {
            taken.extend(edges(&corners));
            taken.extend(edges(&label_box(corners[1], corners[2], &slope.label)));
            placed.push(Placed { series, corners, label: slope.label.clone() });
        }
    }
    placed
}

/// Everything that is drawn, as segments; a marker has length zero.
fn drawn(chart: &Chart, frame: &Frame) -> Vec<Segment> {
    let mut segments = Vec::new();
    for part in chart.series.iter().flat_map(|series| &series.parts) {
        for run in chart.runs(frame, part) {
            match part {
                Part::Points(_) | Part::Hollow(_) => segments.extend(run.iter().map(|p| [*p, *p])),
                _ => segments.extend(run.windows(2).map(|pair| [pair[0], pair[1]])),
            }
        }
    }
    segments
}

fn free_place(
    slope: &Slope,
    frame: &Frame,
    decade: f64,
    taken: &[Segment],
) -> Option<[CanvasPoint; 3]> {
    let [_, top, right_end, bottom] = frame.room;
    let steps = ((bottom - top) / MOVE) as usize;
    (0..steps).find_map(|step| {
        slope.along.windows(2).find_map(|pair| {
            let (fine, coarse) = (pair[0], pair[1]);
            let height = decade * slope.order * (coarse.0 / fine.0).log10();
            let top = frame.up(coarse.1) + CLEAR + MOVE * step as f64;
            let (left, right) = (frame.across(fine.0), frame.across(coarse.0));
            let corners = [(left, top + height), (right, top + height), (right, top)];
            let label = label_box(corners[1], corners[2], &slope.label);
            let inside = corners[0].1.max(top) < bottom - MOVE && label[1].0 < right_end;
            let free = |shape: &[CanvasPoint], clear: f64| {
                taken.iter().all(|segment| !meets(shape, segment, clear))
            };
            (inside && free(&corners, CLEAR) && free(&label, 0.5 * CLEAR)).then_some(corners)
        })
    })
}

/// The corners of the label, right of the upright side.
fn label_box(corner: CanvasPoint, end: CanvasPoint, label: &str) -> [CanvasPoint; 4] {
    let (left, middle) = (corner.0 + MOVE, 0.5 * (corner.1 + end.1));
    let right = left + CHARACTER * label.chars().count() as f64;
    let (top, bottom) = (middle - HALF_LINE, middle + HALF_LINE);
    corners([left, top, right, bottom])
}

fn edges(corners: &[CanvasPoint]) -> impl Iterator<Item = Segment> + '_ {
    (0..corners.len()).map(|i| [corners[i], corners[(i + 1) % corners.len()]])
}

/// Whether a segment enters a convex shape or comes nearer than `clear`.
fn meets(shape: &[CanvasPoint], segment: &Segment, clear: f64) -> bool {
    let within = |point: CanvasPoint| {
        let turns = edges(shape).map(|[a, b]| turn(a, b, point));
        let (least, most) = span(turns);
        least > 0.0 || most < 0.0
    };
    within(segment[0]) || edges(shape).any(|edge| distance(&edge, segment) < clear)
}

/// Twice the signed area of the triangle a, b, c.
fn turn(a: CanvasPoint, b: CanvasPoint, c: CanvasPoint) -> f64 {
    (b.0 - a.0) * (c.1 - a.1) - (b.1 - a.1) * (c.0 - a.0)
}

fn distance(one: &Segment, other: &Segment) -> f64 {
    let apart = |s: &Segment, t: &Segment| turn(s[0], s[1], t[0]) * turn(s[0], s[1], t[1]) >= 0.0;
    if !apart(one, other) && !apart(other, one) {
        return 0.0;
    }
    let ends = [(one, other[0]), (one, other[1]), (other, one[0]), (other, one[1])];
    ends.map(|(segment, point)| to_point(segment, point)).into_iter().fold(f64::INFINITY, f64::min)
}

fn to_point([a, b]: &Segment, point: CanvasPoint) -> f64 {
    let along = (b.0 - a.0, b.1 - a.1);
    let square = along.0 * along.0 + along.1 * along.1;
    let product = (point.0 - a.0) * along.0 + (point.1 - a.1) * along.1;
    let share = if square > 0.0 { (product / square).clamp(0.0, 1.0) } else { 0.0 };
    (point.0 - a.0 - share * along.0).hypot(point.1 - a.1 - share * along.1)
}

impl Placed {
    #[cfg(test)]
    pub(super) fn corners(&self) -> [CanvasPoint; 3] {
        self.corners
    }

    pub(super) fn draw(&self, canvas: &mut Canvas, ink: Colour) {
        let [fine, corner, coarse] = self.corners;
        canvas.line(&[fine, corner, coarse, fine], ink, 3);
        let middle = (corner.0 + MOVE, 0.5 * (corner.1 + coarse.1));
        canvas.text(&self.label, middle, Anchor::Left);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_those_of_the_plane() {
        let [a, b, c, d] = [(0.0, 0.0), (2.0, 0.0), (1.0, 1.0), (1.0, -1.0)];
        assert_eq!(distance(&[a, b], &[c, d]), 0.0);
        assert_eq!(distance(&[a, b], &[c, c]), 1.0);
        assert_eq!(distance(&[a, a], &[(3.0, 4.0), (3.0, 4.0)]), 5.0);
        let square = [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)];
        assert!(meets(&square, &[(5.0, 5.0), (5.0, 5.0)], 1.0));
        assert!(meets(&square, &[(-5.0, 5.0), (15.0, 5.0)], 1.0));
        assert!(meets(&square, &[(12.0, 5.0), (12.0, 5.0)], 3.0));
        assert!(!meets(&square, &[(12.0, 5.0), (12.0, 5.0)], 1.0));
    }
}
