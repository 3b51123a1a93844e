//! The part that the open level has in its history, and what a tangent is made of.

/// Weights of the last slot of the histories, through which F depends on u_n. Both are zero at n = 0
/// and where the last slot is frozen.
#[derive(Debug, Default, PartialEq)]
pub struct LastSlot {
    /// w_nn, of ‖ε(u_n)‖ in ζ_n (a time).
    pub zeta: f64,
    /// W_nn = w_nn b(0), of ℬ₀ε(u_n) in each term of the memory (dimensionless); empty means zero.
    pub memory: Vec<f64>,
}

impl Clone for LastSlot {
    fn clone(&self) -> Self {
        Self { zeta: self.zeta, memory: self.memory.clone() }
    }

    fn clone_from(&mut self, other: &Self) {
        self.zeta = other.zeta;
        self.memory.clone_from(&other.memory);
    }
}

/// Last slot, slopes and prescribed coordinates: all of a tangent without projection and compliance on facets.
#[derive(Debug, Default)]
pub(crate) struct TangentOf {
    made: bool,
    slot: LastSlot,
    slopes: Vec<f64>,
    prescribed: Vec<bool>,
}

impl TangentOf {
    /// Stores these; true if they differ from those of the tangent before, or there was none.
    pub(crate) fn replace(
        &mut self,
        slot: &LastSlot,
        slopes: &[f64],
        prescribed: &[Option<f64>],
    ) -> bool {
        let flags = prescribed.iter().map(Option::is_some);
        let same = self.made
            && self.slot == *slot
            && self.slopes == slopes
            && self.prescribed.iter().copied().eq(flags.clone());
        if !same {
            self.made = true;
            self.slot.clone_from(slot);
            self.slopes.clear();
            self.slopes.extend_from_slice(slopes);
            self.prescribed.clear();
            self.prescribed.extend(flags);
        }
        !same
    }
}
