//! The factor c(x) of a law that varies in space: c ∂j_ν, c > 0 on Γ3.

use formula::Node;

use super::diagnostic::Result;
use super::domain::{Domain, place};
use super::gap::finite_on_contact;
use super::reading::Reading;

/// c(x), and an upper bound.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    /// A formula in x, y (and z).
    pub formula: Node,
    /// A proved bound of max c over Γ3, attained but for a relative 1e-7.
    pub largest: f64,
}

impl Scale {
    pub(super) fn validate(reading: &mut Reading, key: &str, domain: &Domain) -> Result<Self> {
        let formula = finite_on_contact(reading, key, domain)?;
        let mut largest = 0.0f64;
        for &side in &domain.contact {
            for face in domain.faces(side) {
                let (least, at) = face.largest(&reading.formulas, formula, -1.0);
                let here = place(&at.into(), domain.dimension());
                let (value, side) = (-least.attained, domain.name(side));
                let message = format!("`scale` is {value} at {here} on the side {side}");
                let hint = "the factor of a law must be positive on every contact side";
                reading.refuse_if(least.bound >= 0.0, key, message, hint)?;
                let (most, _) = face.largest(&reading.formulas, formula, 1.0);
                let message = format!("`scale` has no bound on the side {side}");
                reading.refuse_if(!most.bound.is_finite(), key, message, hint)?;
                largest = largest.max(most.bound);
            }
        }
        Ok(Self { formula, largest })
    }
}
