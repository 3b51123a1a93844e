//! An inequality at one place: what every study says that compares two numbers. One that points the other way has its sides
//! exchanged.

use std::fmt;

use serde::{Serialize, Serializer};

/// An inequality of the theory.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Statement {
    /// Its number in the paper.
    pub source: &'static str,
    /// What it says, in signs.
    pub says: &'static str,
}

/// A level of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Place {
    /// Cells per unit length.
    pub n: u32,
    /// N.
    pub steps: u32,
    pub level: usize,
}

/// left ≤ right within an accuracy.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Claim {
    pub statement: Statement,
    pub place: Place,
    pub left: f64,
    /// Infinite where a constant in it is not defined.
    pub right: f64,
    /// By how much rounding may spoil it.
    pub accuracy: f64,
}

/// What comes of a claim; of several the last of these.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Standing {
    Passes,
    /// Its right side is infinite and says nothing.
    Unresolved,
    Fails,
}

impl Claim {
    /// Whether it holds to its accuracy; never with a NaN.
    pub fn standing(&self) -> Standing {
        if self.right == f64::INFINITY && self.left < f64::INFINITY {
            return Standing::Unresolved;
        }
        if self.excess() <= self.accuracy { Standing::Passes } else { Standing::Fails }
    }

    /// left - right.
    pub fn excess(&self) -> f64 {
        self.left - self.right
    }

    /// left/right, 1 where it just holds; `None` where both sides are below the accuracy and it would be noise, and where
    /// the right side is not defined.
    pub fn tightness(&self) -> Option<f64> {
        let size = self.left.abs().max(self.right.abs());
        let seen = size > self.accuracy || self.left.is_nan() || self.right.is_nan();
        (seen && self.standing() != Standing::Unresolved).then(|| self.left / self.right)
    }

    /// Whether it comes nearer to failing, or fails by more; a NaN by most.
    pub fn is_worse_than(&self, other: &Self) -> bool {
        let rank = |claim: &Self| {
            let number = match claim.standing() {
                Standing::Fails => claim.excess() - claim.accuracy,
                _ => claim.tightness().unwrap_or(f64::NEG_INFINITY),
            };
            (claim.standing(), if number.is_nan() { f64::INFINITY } else { number })
        };
        let ((here, number), (there, known)) = (rank(self), rank(other));
        here > there || here == there && number > known
    }

    /// Why it does not hold, with its numbers; none where it does.
    pub fn reason(&self) -> Option<String> {
        let Self { statement, place, left, right, accuracy } = self;
        let excess = self.excess();
        match self.standing() {
            Standing::Passes => None,
            Standing::Unresolved => Some(format!(
                "{} at {place}: the right side is infinite, a constant in it is not defined",
                statement.source
            )),
            Standing::Fails => Some(format!(
                "{} at {place}: {left:.9e} <= {right:.9e} does not hold; it exceeds by {excess:.3e}, allowed {accuracy:.1e}",
                statement.source
            )),
        }
    }
}

/// What files have of a claim; numbers that are none, or infinite, are null there.
impl Serialize for Claim {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct Row {
            line: &'static str,
            says: &'static str,
            relation: &'static str,
            n: u32,
            steps: u32,
            level: usize,
            left: f64,
            right: f64,
            difference: f64,
            accuracy: f64,
            ratio: Option<f64>,
            tightness: Option<f64>,
            holds: bool,
            defined: bool,
        }
        let Self { statement, place, left, right, accuracy } = *self;
        let (standing, ratio) = (self.standing(), self.tightness());
        let row = Row {
            line: statement.source,
            says: statement.says,
            relation: "<=",
            n: place.n,
            steps: place.steps,
            level: place.level,
            left,
            right,
            difference: self.excess(),
            accuracy,
            ratio,
            tightness: ratio,
            holds: standing == Standing::Passes,
            defined: standing != Standing::Unresolved,
        };
        row.serialize(serializer)
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "level {} of n = {}, N = {}", self.level, self.n, self.steps)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_claim_holds_to_its_accuracy_and_never_without_numbers() {
        let of =
            |left: f64, right: f64, accuracy| Claim { left, right, accuracy, ..Claim::default() };
        use Standing::{Fails, Passes, Unresolved};
        let rising = [
            (of(1e-20, 1e-21, 1e-12), None, Passes),
            (of(2.0, 4.0, 0.0), Some(0.5), Passes),
            (of(1.0, 1.0, 0.0), Some(1.0), Passes),
            (of(1.5, 1.0, 0.5), Some(1.5), Passes),
            (of(2.0, f64::INFINITY, 0.0), None, Unresolved),
            (of(1.6, 1.0, 0.5), Some(1.6), Fails),
            (of(4.0, 2.0, 0.0), Some(2.0), Fails),
        ];
        for (claim, tightness, standing) in rising {
            assert_eq!((claim.tightness(), claim.standing()), (tightness, standing), "{claim:?}");
            assert_eq!(claim.reason().is_none(), standing == Passes);
        }
        for pair in rising.windows(2) {
            assert!(pair[1].0.is_worse_than(&pair[0].0) && !pair[0].0.is_worse_than(&pair[1].0));
        }
        for (left, right) in [(f64::NAN, 1.0), (1.0, f64::NAN), (f64::NAN, f64::INFINITY)] {
            let claim = of(left, right, 1.0);
            assert_eq!(claim.standing(), Fails);
            assert!(
                claim.is_worse_than(&rising[6].0) && claim.tightness().is_some_and(f64::is_nan)
            );
        }
        let place = Place { n: 4, steps: 2, level: 1 };
        let said = Claim { place, ..of(2.0, 1.0, 1e-12) }.reason().expect("a reason");
        for part in ["level 1", "n = 4", "N = 2", "2.0", "1.0", "exceeds by 1.0"] {
            assert!(said.contains(part), "{part}: {said}");
        }
    }
}
