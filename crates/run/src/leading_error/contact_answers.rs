//! How Γ3 answers to a small change of u, in the linearised step: slopes of the laws at vertices, vertices that are held, and
//! friction that follows the normal law.

use super::in_space::{InSpace, State};
use super::law_slope::{Answer, answer, sliding_block};
use super::low_rank::RankOne;
use exact::FrictionBound;
use formula::{Node, Point};

/// Stiffness of a held vertex, in units of the largest entry: it moves by 1e-10 of what it would.
const HELD: f64 = 1e10;

impl<const S: usize> InSpace<S> {
    /// How the pressure at each point of the trace answers; `None` where u = 0 is given, and where no law is.
    pub(super) fn answers(&self, state: &State<S>) -> Vec<Option<Answer>> {
        let contact = self.exact.data.contact.as_ref();
        let law = contact.and_then(|contact| contact.law.as_ref());
        let mut answers = Vec::with_capacity(state.contact.len());
        for (point, &[normal, _, _, xi, lambda]) in
            self.space.trace.points.iter().zip(&state.contact)
        {
            // The law is c p: its slope is c times that of p at ξ/c.
            let shift =
                self.at_vertex(contact.and_then(|contact| contact.shift), 0.0, point.vertex);
            let scale =
                self.at_vertex(contact.and_then(|contact| contact.scale), 1.0, point.vertex);
            let own = match answer(law, normal - shift, xi / scale, lambda) {
                Answer::Slope(slope) => Answer::Slope(scale * slope),
                Answer::Held => Answer::Held,
            };
            answers.push(point.carries().then_some(own));
        }
        answers
    }

    /// Adds the slopes of the law at the vertices; holds the vertices whose u_ν does not move.
    pub(super) fn add_contact(&self, answers: &[Option<Answer>], values: &mut [f64]) {
        let stiffness = values.iter().fold(0.0, |size: f64, value| size.max(value.abs()));
        for (point, answer) in self.space.trace.points.iter().zip(answers) {
            let answer = match answer {
                None => continue,
                Some(Answer::Slope(slope)) => point.weight * slope,
                Some(Answer::Held) => HELD * stiffness,
            };
            // answer · ν νᵀ on the components of the vertex.
            let d = self.space.mesh.dimension;
            for i in 0..d {
                for j in 0..=i {
                    let first = d * point.node as usize;
                    if let Some(at) = self.space.pattern.position(first + i, first + j) {
                        values[at] += answer * point.normal[i] * point.normal[j];
                    }
                }
            }
        }
    }

    /// Adds the slopes of friction at the vertices that slip; holds u_τ of those that stick.
    pub(super) fn add_friction(&self, state: &State<S>, values: &mut [f64]) {
        let friction = self.exact.data.contact.as_ref().and_then(|own| own.friction.as_ref());
        let Some((friction, state)) = friction.zip(state.friction.as_ref()) else { return };
        let stiffness = values.iter().fold(0.0, |size: f64, value| size.max(value.abs()));
        let d = self.space.mesh.dimension;
        let points = self.space.trace.points.iter().zip(state);
        for (point, own) in points.filter(|(point, _)| point.carries()) {
            let block = sliding_block(&friction.bound, own, [point.weight, HELD * stiffness]);
            let first = d * point.node as usize;
            for (i, row) in block.iter().enumerate().take(d) {
                for (j, answer) in row.iter().enumerate().take(i + 1) {
                    self.space.pattern.add([first + i, first + j], *answer, values);
                }
            }
        }
    }

    /// The answers of friction to u_ν where its bound follows the normal law: μ_f p'(u_ν) along s at the vertices that slip.
    pub(super) fn following(&self, answers: &[Option<Answer>], state: &State<S>) -> Vec<RankOne> {
        let friction = self.exact.data.contact.as_ref().and_then(|own| own.friction.as_ref());
        let bound = friction.map(|own| &own.bound);
        let Some((FrictionBound::Coulomb(coefficient), state)) = bound.zip(state.friction.as_ref())
        else {
            return Vec::new();
        };
        let d = self.space.mesh.dimension;
        let mut terms = Vec::new();
        for ((point, answer), own) in self.space.trace.points.iter().zip(answers).zip(state) {
            let Some(Answer::Slope(slope)) = answer else { continue };
            let answer = point.weight * coefficient * slope;
            if answer == 0.0 || own.size() == 0.0 || own.sticks() {
                continue;
            }
            let mut column = vec![0.0; self.space.nodes.len()];
            let mut row = column.clone();
            let stress = own.stress();
            for i in 0..d {
                column[d * point.node as usize + i] = answer * stress[i] / own.size();
                row[d * point.node as usize + i] = point.normal[i];
            }
            terms.push(RankOne { column, row });
        }
        terms
    }

    /// The value of a formula at a vertex, or `absent` without one.
    fn at_vertex(&self, node: Option<Node>, absent: f64, vertex: u32) -> f64 {
        let [x, y, z] = self.space.mesh.point(&[vertex], &[1.0]);
        let at = Point { x, y, z, ..Point::default() };
        node.map_or(absent, |node| self.exact.data.graph.evaluate(node, &at))
    }
}
