//! Linearised response of Γ3 to changes of u: slopes of the laws at vertices, held vertices, and friction that follows
//! the normal law.

use super::cells::{Answer, answer, sliding_block};
use super::in_space::{InSpace, RankOne, State};
use exact::FrictionFormulas;
use formula::Node;

/// Stiffness of a held vertex in units of the largest entry; reduces its motion to 1e-10.
const HELD: f64 = 1e10;

impl<const S: usize> InSpace<S> {
    /// Response of the pressure at each point of the trace; None where u = 0 is given or there is no law.
    pub(super) fn answers(&self, state: &State<S>) -> Vec<Option<Answer>> {
        let mut answers = Vec::with_capacity(state.contact.len());
        for (point, &[normal, _, _, xi, lambda]) in
            self.space.trace.points.iter().zip(&state.contact)
        {
            let contact = self.exact.contact_on(point.side);
            let law = contact.and_then(|contact| contact.law.as_ref());
            // The law is c p: its slope is c times that of p at ξ/c.
            let shift = self.at_vertex(contact.and_then(|known| known.shift), 0.0, point.vertex);
            let scale = self.at_vertex(contact.and_then(|known| known.scale), 1.0, point.vertex);
            let response = match answer(law, normal - shift, xi / scale, lambda) {
                Answer::Slope(slope) => Answer::Slope(scale * slope),
                Answer::Held => Answer::Held,
            };
            answers.push(point.carries().then_some(response));
        }
        answers
    }

    /// Adds the slopes of the law at the vertices; holds u_ν where it does not move, and on planes of symmetry.
    pub(super) fn add_contact(&self, answers: &[Option<Answer>], values: &mut [f64]) {
        let stiffness = values.iter().fold(0.0, |size: f64, value| size.max(value.abs()));
        for (point, answer) in self.space.trace.points.iter().zip(answers) {
            let answer = match answer {
                None => continue,
                Some(Answer::Slope(slope)) => point.weight * slope,
                Some(Answer::Held) => HELD * stiffness,
            };
            let along = |i: usize, j: usize| answer * point.normal[i] * point.normal[j];
            self.add_at(point.node, along, values);
        }
        for support in &self.space.supports {
            let node = self.space.nodes.of_vertex[support.vertex as usize];
            let along =
                |i: usize, j: usize| HELD * stiffness * support.normal[i] * support.normal[j];
            self.add_at(node, along, values);
        }
    }

    /// Adds a symmetric block at a node, by components.
    fn add_at(&self, node: u32, block: impl Fn(usize, usize) -> f64, values: &mut [f64]) {
        let d = self.space.mesh.dimension;
        let first = d * node as usize;
        for i in 0..d {
            for j in 0..=i {
                self.space.pattern.add([first + i, first + j], block(i, j), values);
            }
        }
    }

    fn friction_formulas(&self) -> Option<&FrictionFormulas> {
        self.exact.data.contact.iter().find_map(|contact| contact.friction.as_ref())
    }

    /// Adds the slopes of friction at slipping vertices; holds u_τ of sticking ones.
    pub(super) fn add_friction(&self, state: &State<S>, values: &mut [f64]) {
        let both = self.friction_formulas().zip(state.friction.as_ref());
        let Some((friction, state)) = both else { return };
        let stiffness = values.iter().fold(0.0, |size: f64, value| size.max(value.abs()));
        let points = self.space.trace.points.iter().zip(state);
        for (point, sliding) in points.filter(|(point, _)| point.carries()) {
            let block = sliding_block(&friction.bound, sliding, [point.weight, HELD * stiffness]);
            self.add_at(point.node, |i, j| block[i][j], values);
        }
    }

    /// Response of friction to u_ν if its bound follows the normal law: μ_f p'(u_ν) along s at slipping vertices.
    pub(super) fn following(&self, answers: &[Option<Answer>], state: &State<S>) -> Vec<RankOne> {
        let coefficient = self.friction_formulas().map_or(0.0, |known| known.bound.coefficient());
        let Some(state) = state.friction.as_ref().filter(|_| coefficient > 0.0) else {
            return Vec::new();
        };
        let d = self.space.mesh.dimension;
        let mut terms = Vec::new();
        for ((point, answer), sliding) in self.space.trace.points.iter().zip(answers).zip(state) {
            let Some(Answer::Slope(slope)) = answer else { continue };
            let answer = point.weight * coefficient * slope;
            if answer == 0.0 || sliding.size() == 0.0 || sliding.sticks() {
                continue;
            }
            let mut column = vec![0.0; self.space.nodes.len()];
            let mut row = column.clone();
            let stress = sliding.stress();
            for i in 0..d {
                column[d * point.node as usize + i] = answer * stress[i] / sliding.size();
                row[d * point.node as usize + i] = point.normal[i];
            }
            terms.push(RankOne { column, row });
        }
        terms
    }

    /// The value of a formula at a vertex; `absent` without a formula.
    fn at_vertex(&self, node: Option<Node>, absent: f64, vertex: u32) -> f64 {
        let at = self.space.mesh.point(&[vertex], &[1.0]).into();
        node.map_or(absent, |node| self.exact.data.graph.evaluate(node, &at))
    }
}
