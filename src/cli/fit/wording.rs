//! A result in words.

use judge::verdict::Decision;

/// The result for one table in one direction.
pub(super) struct Part {
    pub(super) text: String,
    pub(super) json: serde_json::Value,
    /// Set if an order is predicted.
    pub(super) decision: Option<Decision>,
}
