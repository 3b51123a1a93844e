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

/// Last slot or its factor K, slopes and prescribed coordinates: all of a tangent without projection and compliance on
/// facets.
#[derive(Debug, Default)]
pub(crate) struct TangentOf<K> {
    /// None before the first tangent, and where the last one failed.
    pub made: Option<K>,
    pub slopes: Vec<f64>,
    pub prescribed: Vec<bool>,
}

impl<K: Clone + PartialEq> TangentOf<K> {
    /// Stores these; true if they differ from those of the tangent before, or there was none.
    pub(crate) fn replace(&mut self, slot: &K, slopes: &[f64], prescribed: &[Option<f64>]) -> bool {
        let flags = prescribed.iter().map(Option::is_some);
        let same = self.made.as_ref() == Some(slot)
            && self.slopes == slopes
            && self.prescribed.iter().copied().eq(flags.clone());
        if !same {
            match &mut self.made {
                Some(known) => known.clone_from(slot),
                none => *none = Some(slot.clone()),
            }
            self.slopes.clear();
            self.slopes.extend_from_slice(slopes);
            self.prescribed.clear();
            self.prescribed.extend(flags);
        }
        !same
    }
}
