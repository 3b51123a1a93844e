//! `[time]`: the horizon, the family of grids, and all that is said of a rule beside its weights.

use super::reading::Reading;
use super::source::Result;
use vhi::history::{
    self, CorrectedEnd, Gregory, GregoryOrder, GridError, Left, ProductIntegration, Right,
    Trapezoid,
};

pub use vhi::history::GridFamily as TimeGrid;

/// `[time]` as validated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Time {
    /// T > 0.
    pub horizon: f64,
    pub grid: TimeGrid,
    pub rule: TimeRule,
}

/// How ∫ q(t, s) v(s) ds is approximated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TimeRule {
    Trapezoid,
    /// The value at the left end of each step.
    Left,
    /// The value at the right end: the sum of backward Euler.
    Right,
    /// The trapezoidal rule with difference corrections at both ends, on equal steps: order 3 or 4.
    Gregory {
        order: u32,
    },
    /// The trapezoidal rule with a corrected weight at s = t for kernels like (t - s)^exponent.
    CorrectedEnd {
        exponent: f64,
    },
    /// v interpolated linearly, the kernel integrated exactly.
    ProductIntegration,
}

impl TimeRule {
    /// The rule with its weights.
    pub fn weights(self) -> Box<dyn history::TimeRule> {
        match self {
            Self::Trapezoid => Box::new(Trapezoid),
            Self::Left => Box::new(Left),
            Self::Right => Box::new(Right),
            Self::Gregory { order: 3 } => Box::new(Gregory { order: GregoryOrder::Three }),
            Self::Gregory { .. } => Box::new(Gregory { order: GregoryOrder::Four }),
            Self::CorrectedEnd { exponent } => Box::new(CorrectedEnd { exponent }),
            Self::ProductIntegration => Box::new(ProductIntegration),
        }
    }

    /// Whether a history of a history has bounds by it: weights that are not larger in a longer sum.
    pub fn repeats(self) -> bool {
        matches!(self, Self::Trapezoid | Self::Left | Self::Right)
    }

    /// The order of its sums for a smooth integrand.
    pub fn order(self) -> f64 {
        match self {
            Self::Left | Self::Right => 1.0,
            Self::Trapezoid | Self::CorrectedEnd { .. } | Self::ProductIntegration => 2.0,
            Self::Gregory { order } => f64::from(order),
        }
    }

    /// Its name, and its weights in units of the step.
    pub fn in_words(self) -> String {
        match self {
            Self::Trapezoid => "trapezoidal, weights 1/2, 1, ..., 1, 1/2",
            Self::Left => "left endpoint, weights 1, ..., 1, 0: no step is too large for (3.4)",
            Self::Right => "right endpoint, weights 0, 1, ..., 1: the sum of backward Euler",
            Self::Gregory { order: 3 } => {
                "Gregory of order 3, weights 5/12, 13/12, 1, ..., 1, 13/12, 5/12"
            }
            Self::Gregory { .. } => {
                "Gregory of order 4, weights 3/8, 7/6, 23/24, 1, ..., 1, 23/24, 7/6, 3/8; trapezoidal at t_1"
            }
            Self::CorrectedEnd { exponent } => {
                return format!("trapezoidal with an end weight corrected for (t - s)^{exponent}");
            }
            Self::ProductIntegration => "product integration, the kernel integrated exactly",
        }
        .into()
    }

    /// `rule = "left"`, or `rule = { kind = "gregory", order = 4 }`.
    fn validate(reading: &Reading) -> Result<TimeRule> {
        let kind = match reading.has_parts("time.rule") {
            true => reading.kind("time.rule", &RULES)?,
            false => reading.choice("time.rule", &RULES.map(|(kind, _)| (kind, kind)))?,
        };
        Ok(match kind {
            "trapezoid" => Self::Trapezoid,
            "left" => Self::Left,
            "right" => Self::Right,
            "gregory" if !reading.has("time.rule.order") => Self::Gregory { order: 3 },
            "gregory" => {
                let fault = "is no order of Gregory's rule here, which has order 3 or 4";
                Self::Gregory { order: reading.whole("time.rule.order", 3..=4, fault)? }
            }
            "corrected-end" => {
                let hint = "the correction is for kernels (t - s)^a with 0 < a < 1";
                Self::CorrectedEnd { exponent: reading.share("time.rule.exponent", hint)? }
            }
            _ => Self::ProductIntegration,
        })
    }
}

/// The kinds of rule with their keys.
const RULES: [(&str, &str); 6] = [
    ("trapezoid", ""),
    ("left", ""),
    ("right", ""),
    ("gregory", "order"),
    ("corrected-end", "exponent"),
    ("product-integration", ""),
];

impl Time {
    pub(super) fn validate(reading: &mut Reading) -> Result<Time> {
        let horizon = reading.positive("time.horizon")?;
        let grid = reading.if_given("time.grid", |reading, _| grid(reading))?;
        let rule = reading.if_given("time.rule", |reading, _| TimeRule::validate(reading))?;
        let (grid, rule) = (grid.unwrap_or(TimeGrid::Uniform), rule.unwrap_or(TimeRule::Trapezoid));
        let odd = matches!(rule, TimeRule::Gregory { .. }) && grid != TimeGrid::Uniform;
        let message = "the rule of Gregory is for equal steps: its corrections are differences";
        let hint = "leave the grid out, or take the rule \"trapezoid\"";
        reading.refuse_if(odd, "time.rule", message, hint)?;
        let time = Time { horizon, grid, rule };
        let hint = "state the scene in a smaller unit of time";
        time.grid(1).map_err(|error| reading.error("time.horizon", error, hint))?;
        time.grid(2).map_err(|error| reading.error("time.grid", error, SMALLER_EXPONENT))?;
        Ok(time)
    }

    /// The grid of N steps.
    ///
    /// # Errors
    /// A step that is not above rounding of T.
    pub fn grid(&self, steps: u32) -> Result<history::TimeGrid, GridError> {
        self.grid.grid(self.horizon, steps)
    }
}

/// The way out of steps that are too short.
pub(super) const SMALLER_EXPONENT: &str = "choose fewer steps or a smaller exponent";

/// The kinds of grid with their keys.
const GRIDS: [(&str, &str); 3] = [("uniform", ""), ("graded", "exponent"), ("random", "seed")];

fn grid(reading: &Reading) -> Result<TimeGrid> {
    match reading.kind("time.grid", &GRIDS)? {
        "uniform" => Ok(TimeGrid::Uniform),
        "graded" => {
            let fits = |exponent: f64| exponent >= 1.0 && exponent.is_finite();
            let fault = "is not 1 or more: below 1 the largest steps would lie at t = 0";
            let hint = "t_j = T (j/N)^exponent; for u ~ t^a take more than 2/(1+a)";
            let exponent = reading.number("time.grid.exponent", fits, [fault, hint])?;
            Ok(TimeGrid::Graded { exponent })
        }
        _ => Ok(TimeGrid::Random { seed: reading.seed("time.grid.seed")? }),
    }
}
