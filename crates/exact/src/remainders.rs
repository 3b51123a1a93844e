//! The exact solution with the estimated quadrature error of its hereditary integrals; the effect is part of the floor.

use super::exact::{ContactFormulas, Exact};
use formula::{Node, Program};

impl Exact {
    /// Adds the estimates to the solution; None if that changes no field at these points and times.
    pub fn with_remainders(&self, points: &[[f64; 3]], times: &[f64]) -> Option<Self> {
        let mut data = self.data.clone();
        let of_contact = |c: &ContactFormulas| -> Vec<Node> {
            let friction = c.friction.iter().filter_map(|friction| friction.multiplier.clone());
            let friction = friction.flatten();
            [c.multiplier, c.selection].into_iter().flatten().chain(friction).collect()
        };
        let contact = data.contact.iter().flat_map(of_contact);
        let fields = [&data.u, &self.strain, &self.memory, &self.body_force];
        let all: Vec<Node> = fields.into_iter().flatten().copied().chain(contact).collect();
        if !all.iter().any(|&node| data.graph.remembers(node)) {
            return None;
        }
        let mut values = [false, true].map(|with_remainders| {
            if with_remainders {
                data.graph.add_remainders();
            }
            let bound = Program::compile(&data.graph, &all, data.horizon).bind(points);
            (bound, vec![Vec::new(); all.len()])
        });
        let moved = times.iter().any(|&t| {
            values.iter_mut().for_each(|(bound, out)| bound.evaluate(t, 0.0, out));
            let [(_, plain), (_, with)] = &values;
            // Equal non-finite numbers count as equal, too.
            let same = |(a, b): (&f64, &f64)| a.to_bits() == b.to_bits();
            !plain.iter().flatten().zip(with.iter().flatten()).all(same)
        });
        moved.then(|| Self::new(data))
    }
}
