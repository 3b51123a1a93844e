//! The judged errors of a scene, small enough for a card: points, the line through them, the order at its end.

use super::chart::{Axis, Chart, Part, Series};
use super::curve::{Curve, curves};
use super::ruler::Scale;
use super::{Direction, SceneSummary};
use judge::record::CaseRecord;
use judge::verdict::{Variable, Verdict};

/// Further curves are left to the large picture.
const MOST: usize = 3;

/// The scene's verdicts in the variable of the first; None without points.
pub(super) fn thumbnail_svg(
    scene: &SceneSummary,
    records: &[CaseRecord],
    verdicts: &[Verdict],
) -> Option<String> {
    let of_scene: Vec<&Verdict> = verdicts.iter().filter(|v| v.scene == scene.name).collect();
    let in_time = of_scene.first().is_some_and(|verdict| verdict.variable == Variable::K);
    let (direction, name) = match in_time {
        true => (Direction::Time, "error against k"),
        false => (Direction::Space, "error against h"),
    };
    let drawn = curves(scene, records, verdicts, direction)
        .filter(|curve| curve.verdict.is_some() || of_scene.is_empty())
        .filter(|curve| curve.used.len() > 1)
        .take(if of_scene.is_empty() { 1 } else { MOST });
    let axes = Chart::new("", "", Axis::new(name, Scale::Steps), Axis::new("", Scale::Log));
    Chart { series: drawn.map(series).collect(), direct: true, small: true, ..axes }.svg()
}

fn series(curve: Curve<'_>) -> Series {
    let order = curve.verdict.and_then(|verdict| verdict.observed);
    let name = order.map_or(String::new(), |order| format!("{} {order:.2}", symbol(curve.norm)));
    let Curve { used, left_out, .. } = curve;
    Series::new(name, vec![Part::Line(used.clone()), Part::Points(used), Part::Hollow(left_out)])
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
