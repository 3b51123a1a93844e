//! Why a defect survives, or which gate is missing.

/// The reason for a survivor of the first score.
pub fn reason(defect: &str) -> Option<&'static str> {
    REASONS.iter().find(|(name, _)| *name == defect).map(|(_, why)| *why)
}

const REASONS: [(&str, &str); 6] = [
    (
        "no derivative in κ in the tangent",
        "the solution is the same to rounding; only the work grows, and only a recorded number knows how much is usual.",
    ),
    (
        "start value zero at every level",
        "the solution is the same to rounding; only the work grows, as above.",
    ),
    (
        "slopes of friction in u_ν with the other sign in the Jacobian",
        "the solution is the same to rounding; only the work grows, as above. Differences see it (tests/numbers/friction_bounds.rs).",
    ),
    (
        "load quadrature of degree 0",
        "2 % of the V error at order h: within what a predicted constant may be off. The audit measures the term, E_q of (4.9), and bounds it by nothing: a bound of E_q by the interpolation error would be the missing gate.",
    ),
    (
        "errors 5 % too small",
        "a factor of 5 % moves no slope, and is about what a predicted constant may be off.",
    ),
    (
        "floors a million times too high",
        "the floors are a billionth of the errors: a million times more leaves every point above 20 of them, and no verdict changes. A floor that hides a point makes the verdict unresolved.",
    ),
];
