//! A claim: what a study says of one number at one place. An inequality that points the other way has its sides exchanged.

use std::fmt;

use serde::{Serialize, Serializer};

use fit::Decision;

/// What is claimed, wherever it is looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Statement {
    /// Its number in the paper, or its name.
    pub source: &'static str,
    /// What it says, in signs or words.
    pub says: &'static str,
}

/// Where a claim was looked at; what does not apply is absent.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Place {
    /// Cells per unit length.
    pub n: Option<u32>,
    /// N.
    pub steps: Option<u32>,
    pub level: Option<usize>,
    /// What else tells the place, such as `k = 0.5` or the part of a study; empty if nothing does.
    pub at: String,
}

/// What is said of the left side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Relation {
    /// left ≤ right. Infinite where a constant in it is not defined.
    AtMost(f64),
    /// low ≤ left ≤ high.
    Within([f64; 2]),
    /// Left is an observed order and this the predicted one; an inference has decided, and says why in the note.
    Order(f64, Decision),
    /// There is no left side: the run is refused with these words.
    Refused(&'static str),
}

/// A statement at a place, with its numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct Claim {
    pub statement: Statement,
    pub place: Place,
    /// NaN without an answer.
    pub left: f64,
    pub relation: Relation,
    /// By how much rounding may spoil it.
    pub accuracy: f64,
    /// Why there is no answer, or a remark; empty if there is nothing to say.
    pub note: String,
}

impl Default for Claim {
    fn default() -> Self {
        Self {
            statement: Statement::default(),
            place: Place::default(),
            left: f64::NAN,
            relation: Relation::AtMost(f64::NAN),
            accuracy: 0.0,
            note: String::new(),
        }
    }
}

/// What comes of a claim; of several the last of these.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Standing {
    #[serde(rename = "pass")]
    Passes,
    /// Its right side is infinite and says nothing.
    Unresolved,
    #[serde(rename = "fail")]
    Fails,
}

impl Claim {
    /// left ≤ right within `accuracy`.
    pub fn at_most(
        statement: Statement,
        place: Place,
        [left, right]: [f64; 2],
        accuracy: f64,
    ) -> Self {
        let (relation, note) = (Relation::AtMost(right), String::new());
        Self { statement, place, left, relation, accuracy, note }
    }

    /// Whether it holds to its accuracy; never with a NaN.
    pub fn standing(&self) -> Standing {
        let undefined = self.relation == Relation::AtMost(f64::INFINITY);
        if undefined && self.left < f64::INFINITY {
            return Standing::Unresolved;
        }
        let holds = match self.relation {
            Relation::Order(_, Decision::Unresolved) => return Standing::Unresolved,
            Relation::Order(_, decision) => decision == Decision::Pass,
            Relation::Refused(words) => self.left.is_nan() && self.note.contains(words),
            _ => self.excess() <= self.accuracy,
        };
        if holds { Standing::Passes } else { Standing::Fails }
    }

    /// left - right, or by how much left is outside; NaN of a refusal and of an order.
    pub fn excess(&self) -> f64 {
        match self.relation {
            Relation::AtMost(right) => self.left - right,
            // The order of operands keeps a NaN.
            Relation::Within([low, high]) => {
                let (below, above) = (low - self.left, self.left - high);
                if below > above { below } else { above }
            }
            Relation::Order(..) | Relation::Refused(_) => f64::NAN,
        }
    }

    /// The right side of an inequality.
    pub fn right(&self) -> Option<f64> {
        match self.relation {
            Relation::AtMost(right) => Some(right),
            _ => None,
        }
    }

    /// left/right, 1 where it just holds; `None` where both sides are below the accuracy and it would be noise, and where
    /// the right side is not defined.
    pub fn tightness(&self) -> Option<f64> {
        let right = self.right()?;
        let size = self.left.abs().max(right.abs());
        let seen = size > self.accuracy || self.left.is_nan() || right.is_nan();
        (seen && self.standing() != Standing::Unresolved).then(|| self.left / right)
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
        let Self { statement, place, left, accuracy, note, .. } = self;
        let why = match (self.standing(), self.relation) {
            (Standing::Passes, _) => return None,
            (_, Relation::Order(order, _)) if !left.is_nan() => {
                format!("order {left:.3}, predicted {order}")
            }
            (Standing::Unresolved, Relation::AtMost(_)) => {
                "the right side is infinite, a constant in it is not defined".into()
            }
            (_, Relation::AtMost(right)) if !left.is_nan() => format!(
                "{left:.9e} <= {right:.9e} does not hold; it exceeds by {:.3e}, allowed {accuracy:.1e}",
                self.excess()
            ),
            (_, Relation::Within([low, high])) if !left.is_nan() => {
                format!("{left:.6e} is not in [{low:.6e}, {high:.6e}]")
            }
            (_, Relation::Refused(words)) if !left.is_nan() => {
                format!("not refused with `{words}`: it answered {left:.3e}")
            }
            (_, Relation::Refused(words)) => format!("not refused with `{words}`"),
            _ => "no number".into(),
        };
        let place = place.to_string();
        let at = if place.is_empty() { place } else { format!(" at {place}") };
        let note = if note.is_empty() { String::new() } else { format!(" ({note})") };
        Some(format!("{}{at}: {why}{note}", statement.source))
    }

    /// Of each statement, in the order of their first claims, the one that comes nearest to failing, and how many there are.
    pub fn worst(claims: &[Self]) -> Vec<(&Self, usize)> {
        let mut found: Vec<(&Self, usize)> = Vec::new();
        for claim in claims {
            match found.iter_mut().find(|(known, _)| known.statement == claim.statement) {
                Some((worst, count)) => {
                    *count += 1;
                    if claim.is_worse_than(worst) {
                        *worst = claim;
                    }
                }
                None => found.push((claim, 1)),
            }
        }
        found
    }

    /// Whether all hold, and there are some.
    pub fn all_hold(claims: &[Self]) -> bool {
        !claims.is_empty() && claims.iter().all(|claim| claim.standing() == Standing::Passes)
    }

    /// The rows of claims.csv, one a claim.
    ///
    /// # Errors
    /// The writer's.
    pub fn csv(claims: &[Self]) -> Result<Vec<u8>, csv::Error> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        claims.iter().try_for_each(|claim| writer.serialize(Row::of(claim)))?;
        writer.into_inner().map_err(|error| error.into_error().into())
    }
}

/// What files have of a claim; numbers that are none, or infinite, are null or empty there.
#[derive(Serialize)]
struct Row<'a> {
    line: &'static str,
    says: &'static str,
    n: Option<u32>,
    steps: Option<u32>,
    level: Option<usize>,
    at: &'a str,
    left: Option<f64>,
    relation: &'static str,
    right: Option<f64>,
    /// The lower end of what left is to be within.
    low: Option<f64>,
    difference: Option<f64>,
    accuracy: f64,
    tightness: Option<f64>,
    standing: Standing,
    holds: bool,
    note: String,
}

impl<'a> Row<'a> {
    fn of(claim: &'a Claim) -> Self {
        let Claim { statement, place, left, accuracy, .. } = claim;
        let standing = claim.standing();
        let finite = |value: f64| Some(value).filter(|value| value.is_finite());
        let (relation, low, right) = match claim.relation {
            Relation::AtMost(right) => ("<=", None, finite(right)),
            Relation::Within([low, high]) => ("within", finite(low), finite(high)),
            Relation::Order(order, _) => ("order", None, finite(order)),
            Relation::Refused(_) => ("refused", None, None),
        };
        let note = match claim.reason() {
            Some(reason) => reason,
            None => claim.note.clone(),
        };
        Self {
            line: statement.source,
            says: statement.says,
            n: place.n,
            steps: place.steps,
            level: place.level,
            at: &place.at,
            left: finite(*left),
            relation,
            right,
            low,
            difference: finite(claim.excess()),
            accuracy: *accuracy,
            tightness: claim.tightness().and_then(finite),
            standing,
            holds: standing == Standing::Passes,
            note,
        }
    }
}

impl Serialize for Claim {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        Row::of(self).serialize(serializer)
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let grid =
            [self.n.map(|n| format!("n = {n}")), self.steps.map(|steps| format!("N = {steps}"))];
        let other = Some(self.at.clone()).filter(|at| !at.is_empty());
        let rest = grid.into_iter().flatten().chain(other).collect::<Vec<_>>().join(", ");
        match (self.level, rest.is_empty()) {
            (Some(level), true) => write!(f, "level {level}"),
            (Some(level), false) => write!(f, "level {level} of {rest}"),
            (None, _) => f.write_str(&rest),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(left: f64, right: f64, accuracy: f64) -> Claim {
        Claim::at_most(Statement::default(), Place::default(), [left, right], accuracy)
    }

    #[test]
    fn a_claim_holds_to_its_accuracy_and_never_without_numbers() {
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
        for (claim, tightness, standing) in &rising {
            assert_eq!((claim.tightness(), claim.standing()), (*tightness, *standing), "{claim:?}");
            assert_eq!(claim.reason().is_none(), *standing == Passes);
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
        let place = Place { n: Some(4), steps: Some(2), level: Some(1), at: "k = 3".into() };
        let said = Claim { place, ..of(2.0, 1.0, 1e-12) }.reason().expect("a reason");
        for part in ["level 1 of n = 4, N = 2, k = 3:", "2.0", "1.0", "exceeds by 1.0"] {
            assert!(said.contains(part), "{part}: {said}");
        }
    }

    /// A number inside, at an end, outside, and none; a refusal with its words, with others, and none.
    #[test]
    fn intervals_and_refusals_are_claims() {
        let within =
            |left| Claim { left, relation: Relation::Within([1.0, 2.0]), ..of(0.0, 0.0, 0.0) };
        let outcomes = [1.0, 1.5, 2.0, 0.9, 2.1, f64::NAN].map(|left| within(left).standing());
        let [passes, fails] = [Standing::Passes, Standing::Fails];
        assert_eq!(outcomes, [passes, passes, passes, fails, fails, fails]);
        let refused = |left, note: &str| {
            let relation = Relation::Refused("other units");
            Claim { left, relation, note: note.into(), ..of(0.0, 0.0, 0.0) }
        };
        assert_eq!(refused(f64::NAN, "state it in other units").standing(), passes);
        assert_eq!(refused(f64::NAN, "no convergence").standing(), fails);
        let answered = refused(1.0, "state it in other units");
        assert_eq!(answered.standing(), fails);
        assert!(answered.reason().is_some_and(|reason| reason.contains("it answered 1.0")));
    }

    /// Of an order the inference decides, not its number.
    #[test]
    fn an_order_is_as_the_inference_has_decided() {
        let order = |left, decision| {
            let relation = Relation::Order(2.0, decision);
            Claim { left, relation, note: "a drift".into(), ..of(0.0, 0.0, 0.0) }
        };
        let outcomes = [Decision::Pass, Decision::Unresolved, Decision::Fail]
            .map(|decision| order(1.9, decision).standing());
        assert_eq!(outcomes, [Standing::Passes, Standing::Unresolved, Standing::Fails]);
        assert!(order(1.9, Decision::Fail).is_worse_than(&order(1.9, Decision::Pass)));
        let said = order(1.2, Decision::Fail).reason().expect("a reason");
        assert!(said.ends_with("order 1.200, predicted 2 (a drift)"), "{said}");
        let silent = order(f64::NAN, Decision::Unresolved).reason().expect("a reason");
        assert!(silent.ends_with("no number (a drift)"), "{silent}");
    }

    /// Of each statement the worst claim stands for all; none is no success; files have a row for each.
    #[test]
    fn claims_are_summed_up_by_statement() {
        let [a, b] = ["(1)", "(2)"].map(|source| Statement { source, says: "" });
        let claims = [
            Claim { statement: a, ..of(0.5, 1.0, 0.0) },
            Claim { statement: b, ..of(0.1, 1.0, 0.0) },
            Claim { statement: a, ..of(0.9, 1.0, 0.0) },
        ];
        let worst = Claim::worst(&claims);
        let numbers: Vec<_> = worst.iter().map(|(c, n)| (c.statement.source, c.left, *n)).collect();
        assert_eq!(numbers, [("(1)", 0.9, 2), ("(2)", 0.1, 1)]);
        assert!(Claim::all_hold(&claims) && !Claim::all_hold(&[]));
        assert!(
            !Claim::all_hold(&[of(2.0, 1.0, 0.0)])
                && !Claim::all_hold(&[of(1.0, f64::INFINITY, 0.0)])
        );
        let text = String::from_utf8(Claim::csv(&claims).expect("csv")).expect("text");
        assert_eq!(text.lines().count(), 4, "{text}");
    }
}
