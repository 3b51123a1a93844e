//! The factor c(x) of a law that varies in space: c ∂j_ν, c > 0 on Γ3.

use formula::{EvaluationPoint, Node};

use super::data::AXES;
use super::diagnostic::SceneError;
use super::domain::{Domain, place};
use super::gap::finite_on_contact;
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
        let (intervals, fewest) = match dimension {
            2 => (INTERVALS, INTERVALS_OF_A_FACE),
            _ => (INTERVALS_OF_A_FACE, FEWEST_ON_A_FACE),
        };
        let (mut largest, mut bend, mut spacing) = (0.0f64, 0.0f64, 0.0f64);
        for &side in &domain.contact {
            let faces = domain.faces(side);
            let each = (intervals / faces.len().max(1) as u32).max(fewest);
            for face in &faces {
                spacing = spacing.max(face.longest() / f64::from(each));
                let points = || face.points(each).into_iter().map(EvaluationPoint::from);
                reading.everywhere(
                    (key, node),
                    points(),
                    |scale| scale > 0.0,
                    |at, value| {
                        let (here, side) = (place(at, dimension), domain.name(side));
                        let message = format!("`scale` is {value} at {here} on the side {side}");
                        (message, "the factor of a law must be positive on every contact side")
                    },
                )?;
                for point in points() {
                    let at = |node: Node| reading.formulas.evaluate(node, &point);
                    largest = largest.max(at(node));
                    bend = second.iter().map(|&node| at(node).abs()).sum::<f64>().max(bend);
                }
            }
        }
        Ok(Self { formula: node, largest: largest + 0.125 * spacing * spacing * bend })
    }
}
