//! The judged errors of a scene, small enough for a card: points, fitted line, the order at its end.

use super::ReportError;
use super::canvas::{Anchor, Canvas, CanvasPoint, span};
use super::chart::Datum;
use super::curve::{Curve, curve};
use super::palette::{GRID, INK, colour};
use super::sheet::with_sheet;
use super::ticks::{power, step_label};
use super::{Direction, SceneSummary};
use judge::record::CaseRecord;
use judge::verdict::{Variable, Verdict};

/// Size of the sketches beside it.
const SIZE: (u32, u32) = (480, 404);
const TEXT: f64 = 22.0;
/// Left, top, right, bottom of the axes.
const ROOM: (f64, f64, f64, f64) = (66.0, 20.0, 352.0, 340.0);
/// Least distance of two labels at the ends of lines.
const LABELS: f64 = 26.0;
/// Further curves are left to the large picture.
const MOST: usize = 3;

/// The scene's verdicts in the variable of the first; None without points.
pub(super) fn thumbnail_svg(
    scene: &SceneSummary,
    records: &[CaseRecord],
    verdicts: &[Verdict],
) -> Result<Option<String>, ReportError> {
    let of_scene: Vec<&Verdict> = verdicts.iter().filter(|v| v.scene == scene.name).collect();
    let in_time = of_scene.first().is_some_and(|verdict| verdict.variable == Variable::K);
    let (direction, step) = match in_time {
        true => (Direction::Time, "k"),
        false => (Direction::Space, "h"),
    };
    let records: Vec<CaseRecord> =
        records.iter().filter(|record| record.scene == scene.name).cloned().collect();
    let mut curves: Vec<Curve<'_>> = Vec::new();
    for norm in super::curve::norms(&records) {
        let drawn = curve(scene, &records, verdicts, norm, direction);
        let judged = drawn.filter(|curve| curve.verdict.is_some() || of_scene.is_empty());
        curves.extend(judged.filter(|curve| curve.used.len() > 1));
    }
    curves.truncate(if of_scene.is_empty() { 1 } else { MOST });
    let Some(axes) = Axes::of(&curves) else { return Ok(None) };
    let mut svg = String::new();
    let canvas = Canvas::of_size(&mut svg, SIZE, TEXT)?;
    axes.draw(&canvas, step)?;
    let mut taken: Vec<f64> = Vec::new();
    for (i, curve) in curves.iter().enumerate() {
        draw(&canvas, &axes, curve, i, &mut taken)?;
    }
    canvas.finish()?;
    Ok(Some(with_sheet(&svg)))
}

fn draw(
    canvas: &Canvas<'_>,
    axes: &Axes,
    curve: &Curve<'_>,
    index: usize,
    taken: &mut Vec<f64>,
) -> Result<(), ReportError> {
    let ink = colour(index);
    let places: Vec<CanvasPoint> = curve.used.iter().map(|point| axes.place(*point)).collect();
    canvas.line(&places, ink, 3)?;
    for (points, hollow) in [(&curve.used, false), (&curve.left_out, true)] {
        points.iter().try_for_each(|p| canvas.marker(axes.place(*p), index, ink, hollow))?;
    }
    // At the coarse end, below the existing labels.
    let Some((order, end)) = curve.verdict.and_then(|v| v.observed).zip(places.last()) else {
        return Ok(());
    };
    let mut y = end.1;
    while let Some(other) = taken.iter().find(|other| (*other - y).abs() < LABELS) {
        y = other + LABELS;
    }
    taken.push(y);
    canvas.text(&format!("{} {order:.2}", symbol(curve.norm)), (end.0 + 16.0, y), Anchor::Left)
}

/// A short symbol of a norm.
fn symbol(norm: &str) -> &str {
    match norm.split('_').next() {
        Some("V") => "V",
        Some("L2") => "L²",
        Some("stress") => "σ",
        Some("trace") => "u_ν",
        Some("pressure") => "ξ+λ",
        _ => norm,
    }
}

struct Axes {
    x: (f64, f64),
    y: (f64, f64),
}

impl Axes {
    fn of(curves: &[Curve<'_>]) -> Option<Self> {
        let points: Vec<Datum> = curves.iter().flat_map(Curve::points).collect();
        let x = span(points.iter().map(|point| point.0.ln()));
        let y = span(points.iter().map(|point| point.1.ln()));
        (x.1 > x.0 && y.1 >= y.0).then(|| Self { x, y: (y.0, y.1.max(y.0 + 1e-3)) })
    }

    fn place(&self, (x, y): Datum) -> CanvasPoint {
        let share = |value: f64, (lo, hi): (f64, f64)| (value.ln() - lo) / (hi - lo);
        let (left, top, right, bottom) = ROOM;
        (left + share(x, self.x) * (right - left), bottom - share(y, self.y) * (bottom - top))
    }

    /// The frame, the decades of the error, the coarsest and the finest step.
    fn draw(&self, canvas: &Canvas<'_>, step: &str) -> Result<(), ReportError> {
        let (left, top, right, bottom) = ROOM;
        let (low, high) = (self.y.0 / 10f64.ln(), self.y.1 / 10f64.ln());
        let decades = (low.ceil() as i64)..=(high.floor() as i64);
        let apart = 1 + (high - low) as i64 / 4;
        for decade in decades.filter(|decade| decade % apart == 0) {
            let (_, y) = self.place((1.0, 10f64.powi(decade as i32)));
            canvas.line(&[(left, y), (right, y)], GRID, 2)?;
            canvas.text(&power(decade), (left - 12.0, y), Anchor::Right)?;
        }
        canvas.line(&[(left, top), (left, bottom), (right, bottom)], INK, 2)?;
        let (fine, coarse) = (self.x.0.exp(), self.x.1.exp());
        canvas.text(&step_label(fine), (left, bottom + 32.0), Anchor::Centre)?;
        canvas.text(&step_label(coarse), (right, bottom + 32.0), Anchor::Centre)?;
        canvas.text(
            &format!("error against {step}"),
            (0.5 * (left + right), bottom + 32.0),
            Anchor::Centre,
        )
    }
}
