//! The gap g and the shift s: finite, and g concave on each contact side.

use crate::formula::{Node, Point, Variable};

use super::diagnostic::SceneError;
use super::domain::{Domain, Side};
use super::heading::Hypothesis;
use super::reading::{Reading, evenly, last};
use super::written::Formula;

/// Intervals of a side at whose ends the gap is examined.
const SAMPLES: u32 = 256;
/// Second differences below this part of the gap's size are rounding.
const ROUNDING: f64 = 1e-12;

/// A formula in x and y that is finite on the contact sides.
pub(super) fn finite_on_contact(
    reading: &mut Reading,
    key: &str,
    formula: &Formula,
    domain: &Domain,
) -> Result<Node, SceneError> {
    let scope = reading.scope(&[Variable::X, Variable::Y]);
    let node = reading.formula(key, formula, &scope)?;
    for side in &domain.contact {
        if let Some((point, value)) = reading.first_not_finite(node, points(*side, domain)) {
            let message = format!(
                "`{}` is {value} at ({}, {}) on the side {}",
                last(key),
                point.x,
                point.y,
                side.name()
            );
            return Err(reading.error(key, message, "it must be finite on every contact side; for no constraint at all write gap = \"inf\""));
        }
    }
    Ok(node)
}

/// g, or none for `inf`; concave on each contact side, unless the scene violates that on purpose.
pub(super) fn gap(
    reading: &mut Reading,
    formula: &Formula,
    domain: &Domain,
) -> Result<Option<Node>, SceneError> {
    if matches!(formula.0.trim(), "inf" | "+inf" | "infinity") {
        return Ok(None);
    }
    let gap = finite_on_contact(reading, "contact.gap", formula, domain)?;
    if !reading.violates.contains(&Hypothesis::ConcaveGap) {
        concave(reading, gap, domain)?;
    }
    Ok(Some(gap))
}

/// Refuses a gap that bends upward along a side: U^h ⊂ U, which (5.14) uses, needs a concave one.
fn concave(reading: &mut Reading, gap: Node, domain: &Domain) -> Result<(), SceneError> {
    for side in &domain.contact {
        let Some((point, bend)) = steepest_bend(reading, gap, *side, domain) else {
            continue;
        };
        let message = format!(
            "the gap is not concave on the side {}: second derivative {bend:.4} at ({}, {})",
            side.name(),
            point.x,
            point.y
        );
        let hint = "U^h ⊂ U needs a concave gap; to run it on purpose, write violates = [\"concave_gap\"] in [scene]";
        return Err(reading.error("contact.gap", message, hint));
    }
    Ok(())
}

/// The point of a side at which the gap bends upward most, with its second derivative there; none where it is concave.
/// Second differences of the samples stand beside the exact derivative, which does not see kinks.
fn steepest_bend(
    reading: &mut Reading,
    gap: Node,
    side: Side,
    domain: &Domain,
) -> Option<(Point, f64)> {
    let curvature = second_derivative(reading, gap, side);
    let points: Vec<Point> = points(side, domain).collect();
    let spacing = (points[1].x - points[0].x) + (points[1].y - points[0].y);
    let value = |node: Node, point: &Point| reading.formulas.evaluate(node, point);
    let values: Vec<f64> = points.iter().map(|point| value(gap, point)).collect();
    let size = values.iter().fold(f64::MIN_POSITIVE, |size, value| size.max(value.abs()));
    let exact = points.iter().map(|point| (*point, value(curvature, point)));
    let second_difference = |g: &[f64]| (g[0] - 2.0 * g[1] + g[2]) / (spacing * spacing);
    let differences =
        points[1..].iter().zip(values.windows(3)).map(|(point, g)| (*point, second_difference(g)));
    let upward =
        exact.chain(differences).filter(|(_, bend)| bend * spacing * spacing > ROUNDING * size);
    upward.reduce(|steepest, next| if next.1 > 1.001 * steepest.1 { next } else { steepest })
}

/// The second derivative along a side.
fn second_derivative(reading: &mut Reading, gap: Node, side: Side) -> Node {
    let along = match side {
        Side::Left | Side::Right => Variable::Y,
        Side::Bottom | Side::Top => Variable::X,
    };
    let slope = reading.formulas.derivative(gap, along);
    reading.formulas.derivative(slope, along)
}

fn points(side: Side, domain: &Domain) -> impl Iterator<Item = Point> {
    evenly(0.0, 1.0, SAMPLES).map(move |s| {
        let [x, y] = side.point(&domain.size, s);
        Point { x, y, ..Point::default() }
    })
}
