//! The factor c(x) of a law that varies in space: c ∂j_ν, c > 0 on Γ3.

use formula::{EvaluationPoint, Node};

use super::data::AXES;
use super::diagnostic::SceneError;
use super::domain::{Domain, place};
use super::gap::{finite_on_contact, points};
use super::reading::Reading;

/// Intervals of a segment, and along each axis of a face of a box, on which the factor is examined; fewer per piece for
/// a side of many pieces.
const INTERVALS: u32 = 2048;
const INTERVALS_OF_A_FACE: u32 = 64;
/// Minimum on each of many triangles in space.
const FEWEST_ON_A_FACE: u32 = 16;

/// c(x), and an upper bound.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    /// A formula in x, y (and z).
    pub formula: Node,
    /// A bound of max c over Γ3: the largest sample plus δ²/8 times the largest sampled second derivatives, δ the
    /// sample distance. It holds if c'' is not larger between samples; a kink of c between samples adds an error of at
    /// most its slope times δ.
    pub largest: f64,
}

impl Scale {
    pub(super) fn validate(
        reading: &mut Reading,
        key: &str,
        domain: &Domain,
    ) -> Result<Self, SceneError> {
        let node = finite_on_contact(reading, key, domain)?;
        let dimension = domain.dimension();
        let second: Vec<Node> = (0..dimension)
            .flat_map(|a| (0..dimension).map(move |b| (a, b)))
            .map(|(a, b)| {
                let slope = reading.formulas.derivative(node, AXES[a]);
                reading.formulas.derivative(slope, AXES[b])
            })
            .collect();
        let intervals = if dimension == 2 { INTERVALS } else { INTERVALS_OF_A_FACE };
        let (mut largest, mut bend, mut spacing) = (0.0f64, 0.0f64, 0.0f64);
        for side in &domain.contact {
            let faces = domain.faces(*side);
            let fewest = if dimension == 2 { INTERVALS_OF_A_FACE } else { FEWEST_ON_A_FACE };
            let each = (intervals / faces.len().max(1) as u32).max(fewest);
            for face in &faces {
                spacing = spacing.max(face.longest() / f64::from(each));
                for point in points(face, each) {
                    let at = |node: Node| reading.formulas.evaluate(node, &point);
                    let value = at(node);
                    if value.is_nan() || value <= 0.0 {
                        return Err(refusal(
                            reading,
                            key,
                            value,
                            &point,
                            domain.name(*side),
                            dimension,
                        ));
                    }
                    largest = largest.max(value);
                    bend = second.iter().map(|&node| at(node).abs()).sum::<f64>().max(bend);
                }
            }
        }
        Ok(Self { formula: node, largest: largest + 0.125 * spacing * spacing * bend })
    }
}

fn refusal(
    reading: &Reading,
    key: &str,
    value: f64,
    point: &EvaluationPoint,
    side: &str,
    dimension: usize,
) -> SceneError {
    let message = format!("`scale` is {value} at {} on the side {side}", place(point, dimension));
    let hint = "the factor of a law must be positive on every contact side";
    reading.error(key, message, hint)
}
