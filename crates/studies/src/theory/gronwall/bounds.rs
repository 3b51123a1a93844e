//! One thing for each bound of e_n.

use serde::Serialize;

/// In the order weighted ≤ primed ≤ closed ≤ …; primed ≤ printed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Bounds<T> {
    /// m0 E_n = s_n + Σ_p ω_p Σ' w κ_p E_j: the parts of the history apart.
    pub weighted: T,
    /// E_n = C1 g_n + C2 Σ' w_nj E_j.
    pub primed: T,
    /// C1 max g/(1 - c/2) ((1 + c/2)/(1 - c/2))^{n-1}, c = C2 k, or what [`super::Weights::closed`] says of another rule.
    pub closed: T,
    /// C1 max g e^{C2 t_n}, or what [`super::Weights::limit`] says of product integration.
    pub limit: T,
    /// E_n = C1 g_n + C2 k Σ_{j ≤ n} E_j, as printed in (3.24); absent where C2 k ≥ 1.
    pub printed: Option<T>,
    /// C1 max g/(1 - c) exp(C2 t_n/(1 - c)).
    pub printed_closed: Option<T>,
}

impl<T> Bounds<T> {
    pub(crate) fn map<U>(&self, of: impl Fn(&T) -> U) -> Bounds<U> {
        Bounds {
            weighted: of(&self.weighted),
            primed: of(&self.primed),
            closed: of(&self.closed),
            limit: of(&self.limit),
            printed: self.printed.as_ref().map(&of),
            printed_closed: self.printed_closed.as_ref().map(&of),
        }
    }

    /// Those in pictures: the parts of the history apart, together, and in closed form.
    pub(crate) fn shown(&self) -> [&T; 3] {
        [&self.weighted, &self.primed, &self.closed]
    }
}
