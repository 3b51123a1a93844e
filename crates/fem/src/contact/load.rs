//! Load vectors F_n(v) over time.

/// Why a load could not be computed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LoadError {
    #[error(
        "{what} is {value} at {}, t = {t}: the formula must be finite on the domain and its time interval",
        in_parentheses(place)
    )]
    NotFinite {
        what: String,
        value: f64,
        /// The place, one coordinate a dimension.
        place: Vec<f64>,
        t: f64,
    },
    #[error(
        "the load at t = {t} is not that of its formulas: its {what} is {assembled:.9e}, by a separate integral {integrated:.9e} (allowed {allowed:.1e}); a cell or facet is missing from it, has another formula or side, or a node of Γ1 is free"
    )]
    Resultant {
        what: String,
        t: f64,
        /// Σ F_i m(x_i).
        assembled: f64,
        integrated: f64,
        allowed: f64,
    },
    /// Errors were asked for where nothing is known to be true.
    #[error("no exact solution and no reference run to measure against at t = {t}")]
    NoTruth { t: f64 },
    /// The reference run does not cover the mesh or the time.
    #[error("{reason}")]
    Reference { reason: String },
}

fn in_parentheses(place: &[f64]) -> String {
    let words: Vec<String> = place.iter().map(f64::to_string).collect();
    format!("({})", words.join(", "))
}

/// The load of a scene on one mesh.
pub trait Load: Send {
    /// `out` ← F(t), over the unknowns.
    ///
    /// # Errors
    /// [`LoadError`] if a formula is not finite.
    fn assemble(&mut self, t: f64, out: &mut [f64]) -> Result<(), LoadError>;
}
