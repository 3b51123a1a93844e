//! Linearised response of Γ3 to changes of u: slopes of the laws at vertices, held vertices, and friction that follows
//! the normal law.

use super::in_space::{InSpace, RankOne, State};
use exact::{FrictionBound, FrictionFormulas, LawNumbers, Sliding};
use formula::Node;

/// Stiffness of a held vertex in units of the largest entry; reduces its motion to 1e-10.
const HELD: f64 = 1e10;

impl<const S: usize> InSpace<S> {
    /// Response of the pressure at each point of the trace; None where u = 0 is given or there is no law.
    pub(super) fn answers(&self, state: &State<S>) -> Vec<Option<Answer>> {
        let contact = self.exact.data.contact.as_ref();
        let law = contact.and_then(|contact| contact.law.as_ref());
        let mut answers = Vec::with_capacity(state.contact.len());
        for (point, &[normal, _, _, xi, lambda]) in
            self.space.trace.points.iter().zip(&state.contact)
        {
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

    /// Adds the slopes of the law at the vertices; holds the vertices whose u_ν does not move.
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
        self.exact.data.contact.as_ref()?.friction.as_ref()
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

// Response of ξ ∈ ∂j_ν(r) to small changes of r.

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Answer {
    /// ξ changes by this slope times the change of r.
    Slope(f64),
    /// r does not change: the constraint is active, or ξ is inside a jump.
    Held,
}

pub(super) fn answer(law: Option<&LawNumbers>, r: f64, xi: f64, lambda: f64) -> Answer {
    if lambda.abs() > 0.0 {
        return Answer::Held;
    }
    let Some(law) = law else { return Answer::Slope(0.0) };
    let mut pairs = law.points.windows(2).map(|pair| (pair[0], pair[1]));
    // Strictly inside a jump ξ keeps r fixed.
    let jump = pairs.any(|([from, low], [to, high])| {
        from == to && (r - from).abs() <= ROUNDING * from.abs().max(1.0) && xi > low && xi < high
    });
    if jump {
        return Answer::Held;
    }
    Answer::Slope(law.slope(r))
}

/// w ∂s/∂u_τ by components at a vertex of weight w, s ∈ S ∂|u_τ|; `held` is the stiffness while it sticks, below the
/// bound. The response to u_ν of a bound that follows the normal law is nonsymmetric, and not in it.
pub(super) fn sliding_block(
    bound: &FrictionBound,
    sliding: &Sliding,
    [weight, held]: [f64; 2],
) -> [[f64; 3]; 3] {
    let along = match sliding.sticks() {
        true => [[held, 0.0], [0.0, held]],
        false => {
            turning(sliding, bound.slope(sliding.slipped())).map(|row| row.map(|k| weight * k))
        }
    };
    let mut block = [[0.0; 3]; 3];
    for (p, row) in sliding.tangents.iter().zip(&along) {
        for (q, answer) in sliding.tangents.iter().zip(row) {
            for (line, p) in block.iter_mut().zip(p) {
                line.iter_mut().zip(q).for_each(|(sum, q)| *sum += answer * p * q);
            }
        }
    }
    block
}

/// ∂s/∂u_τ along the tangents of a slipping vertex: the slope of S along the slip, S/|u_τ| across it. At the bound
/// without slip the derivative across does not exist, and the slope is used on all sides.
fn turning(sliding: &Sliding, slope: f64) -> [[f64; 2]; 2] {
    let (slip, [a, b]) = (sliding.slipped(), sliding.slip);
    if slip == 0.0 || b == 0.0 && sliding.tangents[1] == [0.0; 3] {
        return [[slope, 0.0], [0.0, slope]];
    }
    let ([a, b], across) = ([a / slip, b / slip], sliding.bound / slip);
    let mixed = (slope - across) * a * b;
    [[slope * a * a + across * b * b, mixed], [mixed, slope * b * b + across * a * a]]
}

/// Rounding of a formula that is meant to stay at a jump.
const ROUNDING: f64 = 1e-12;

#[cfg(test)]
mod of_law_slope {
    use super::*;

    #[test]
    fn friction_holds_below_its_bound_and_follows_it_beyond() {
        let held = 7.0;
        let response = |bound: &FrictionBound, values: [f64; 3]| {
            let plane = [[1.0, 0.0, 0.0], [0.0; 3]];
            sliding_block(bound, &Sliding::new(plane, 2, |i| values[i]), [1.0, held])[0][0]
        };
        let given = FrictionBound::Given(formula::Graph::new().constant(0.3));
        assert_eq!(response(&given, [0.2, 0.0, 0.3]), held);
        assert_eq!(response(&given, [-0.3, -0.1, 0.3]), 0.0);
        let falling = FrictionBound::Slip(vec![[0.0, 0.3], [0.5, 0.2]]);
        for (u_tau, slope) in [(0.1, -0.2), (-0.1, -0.2), (0.6, 0.0)] {
            let found = response(&falling, [0.28, u_tau, 0.28]);
            assert!((found - slope).abs() < 1e-12, "{u_tau}: {found}");
        }
    }

    #[test]
    fn every_branch_answers_with_its_slope() {
        let points = vec![[0.0, 0.0], [0.04, 0.08], [0.10, 0.05], [0.10, 0.09]];
        let law = LawNumbers { points, slope_before: 0.5, slope_after: 3.0, curve: None };
        let at = |r, xi, lambda| answer(Some(&law), r, xi, lambda);
        let slope = |answer| match answer {
            Answer::Slope(slope) => slope,
            Answer::Held => f64::NAN,
        };
        assert_eq!(at(-0.1, 0.0, 0.0), Answer::Slope(0.5));
        assert_eq!(at(0.02, 0.04, 0.0), Answer::Slope(2.0));
        assert!((slope(at(0.07, 0.065, 0.0)) + 0.5).abs() < 1e-14);
        assert_eq!(at(0.2, 0.4, 0.0), Answer::Slope(3.0));
        assert_eq!(at(0.10, 0.07, 0.0), Answer::Held);
        assert_eq!(at(0.02, 0.04, 0.1), Answer::Held);
        assert_eq!(answer(None, 0.02, 0.0, 0.0), Answer::Slope(0.0));
        let line = LawNumbers {
            points: vec![[0.0, 0.0]],
            slope_before: 1.0,
            slope_after: 2.0,
            curve: None,
        };
        assert_eq!(answer(Some(&line), 0.1, 0.2, 0.0), Answer::Slope(2.0));
        assert_eq!(answer(Some(&line), -0.1, 0.2, 0.0), Answer::Slope(1.0));
    }
}
