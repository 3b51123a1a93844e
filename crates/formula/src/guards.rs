//! Guards: where an expression may have kinks or jumps.

use std::collections::HashSet;

use super::graph::{Graph, Node};

impl Graph {
    /// The expressions whose sign decides a branch in `f`: a-b for `if a < b`, max and min; a for |a| and sign(a).
    /// Includes those inside hereditary integrals, excludes constants; in order of first evaluation.
    pub fn guards(&self, f: &[Node]) -> Vec<Node> {
        let mut seen = HashSet::new();
        self.reachable(f, |_| true)
            .iter()
            .filter_map(|node| self.deciders.get(node).copied())
            .filter(|guard| self.value_of_constant(*guard).is_none() && seen.insert(*guard))
            .collect()
    }
}
