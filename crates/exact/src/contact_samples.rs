//! The exact solution on Γ3 with the contact state of every point, for errors split by state.

use super::exact::{Exact, LawNumbers};
use super::shapes::Shapes;
use super::shared_program::SharedProgram;
use fem::contact::Discretization;
use fem::norms::{ContactSamples, ContactState, is_locked, state_rule};

/// Relative distance within which r counts as the place of a jump: formulas round.
const AT_JUMP_WITHIN: f64 = 1e-9;

/// The formulas of Γ3 bound to the nodes, corners first, and the points of the state rule of each facet.
pub(super) struct StatePoints {
    sides: Vec<PartOfTrace>,
    /// Shape functions at the points, if the exact solution is an interpolant: u_ν and the pressure then come from the
    /// nodes.
    shapes: Option<Vec<Vec<f64>>>,
    nodes: usize,
    facets: usize,
}

/// Facets of Γ3 with one normal and one law.
struct PartOfTrace {
    facets: Vec<usize>,
    law: Option<LawNumbers>,
    /// s at the points.
    shift: Vec<f64>,
    bound: SharedProgram,
}

impl StatePoints {
    /// Binds the formulas of `exact` on the trace of `space`, a plane mesh.
    pub(super) fn new(exact: &Exact, space: &Discretization, interpolated: bool) -> Self {
        let (mesh, trace, rule) = (&space.mesh, &space.trace, state_rule());
        let nodes = space.element.nodes(2);
        let functions = Shapes::of_facet(space.element, 2);
        let shapes = interpolated.then(|| rule.points.iter().map(|b| functions.at(b)).collect());
        let mut sides = Vec::new();
        for part in mesh.plane_parts(&trace.mesh_facet) {
            let contact = exact.contact_on(part.side);
            let shift = contact.and_then(|contact| contact.shift);
            let law = contact.and_then(|contact| contact.law.clone());
            let facets = part.members;
            let places: Vec<&Vec<f64>> = nodes.iter().chain(&rule.points).collect();
            let points: Vec<[f64; 3]> = facets
                .iter()
                .flat_map(|&f| {
                    let facet = mesh.facet(trace.mesh_facet[f] as usize);
                    places.iter().map(|b| mesh.point(facet, b)).collect::<Vec<_>>()
                })
                .collect();
            let graph = &exact.data.graph;
            let value = |x: &[f64; 3]| shift.map_or(0.0, |s| graph.evaluate(s, &(*x).into()));
            let bound = exact.boundary(part.side, &part.normal[..2]).program.bind(&points);
            let shift = points.iter().map(value).collect();
            sides.push(PartOfTrace { facets, law, shift, bound: bound.into() });
        }
        Self { sides, shapes, nodes: nodes.len(), facets: trace.measure.len() }
    }

    /// The exact solution and its states at time t.
    pub(super) fn at(&self, t: f64) -> ContactSamples {
        let rule = state_rule();
        let count = rule.weights.len();
        let points = count * self.facets;
        let mut samples = ContactSamples {
            normal: vec![0.0; points],
            pressure: vec![0.0; points],
            state: vec![ContactState::Open; points],
            gap: vec![f64::INFINITY; 2 * self.facets],
        };
        for side in &self.sides {
            let out = side.bound.values_at(t);
            let [normal, pressure, gap] = [&out[0], &out[1], &out[2]];
            for (index, &f) in side.facets.iter().enumerate() {
                let first = (count + self.nodes) * index;
                samples.gap[2 * f..2 * f + 2].copy_from_slice(&gap[first..first + 2]);
                for q in 0..count {
                    let value = |field: &[f64]| match &self.shapes {
                        Some(shapes) => {
                            shapes[q].iter().zip(&field[first..]).map(|(s, v)| s * v).sum()
                        }
                        None => field[first + self.nodes + q],
                    };
                    let at = count * f + q;
                    (samples.normal[at], samples.pressure[at]) = (value(normal), value(pressure));
                    let gap = value(gap);
                    let r = samples.normal[at] - value(&side.shift);
                    let locked = is_locked(samples.normal[at], gap);
                    samples.state[at] = state(side.law.as_ref(), r, locked);
                }
            }
        }
        samples
    }
}

/// The state at r = u_ν - s.
fn state(law: Option<&LawNumbers>, r: f64, locked: bool) -> ContactState {
    if locked {
        return ContactState::Locked;
    }
    let Some(law) = law else { return ContactState::Open };
    let scale = law.points.iter().fold(0.0, |largest: f64, point| largest.max(point[0].abs()));
    let jumps = law.points.windows(2).filter(|p| p[0][0] == p[1][0] && p[0][1] != p[1][1]);
    if jumps.into_iter().any(|pair| (r - pair[0][0]).abs() <= AT_JUMP_WITHIN * scale) {
        return ContactState::AtJump;
    }
    // A factor c(x) > 0 of the law changes no sign.
    match (law.slope(r), law.pressure(r)) {
        (slope, _) if slope < 0.0 => ContactState::Falling,
        (0.0, 0.0) => ContactState::Open,
        _ => ContactState::Rising,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::CurveNumbers;

    #[test]
    fn every_piece_of_a_law_has_its_state() {
        let law = LawNumbers {
            points: vec![[0.0, 0.0], [0.04, 0.08], [0.06, 0.02], [0.06, 0.05], [0.1, 0.05]],
            slope_before: 0.0,
            slope_after: 0.5,
            curve: None,
        };
        let at = |r: f64| state(Some(&law), r, false);
        let (jump, next) = (0.02 + 0.04, 0.06_f64.next_up());
        for (r, expected) in [
            (-0.1, ContactState::Open),
            (0.02, ContactState::Rising),
            (0.05, ContactState::Falling),
            (0.06, ContactState::AtJump),
            (jump, ContactState::AtJump),
            (next, ContactState::AtJump),
            // A plateau under pressure, and the rise behind it.
            (0.08, ContactState::Rising),
            (0.2, ContactState::Rising),
        ] {
            assert_eq!(at(r), expected, "r = {r}");
        }
        assert_eq!(state(Some(&law), 0.05, true), ContactState::Locked);
        assert_eq!(state(None, 0.05, false), ContactState::Open);
        // c r r0²/(r0² + r²) rises to r0 and falls beyond.
        let curve = Some(CurveNumbers::Rational { c: 2.0, r0: 0.05 });
        let points = vec![[0.0, 0.0]];
        let law = LawNumbers { points, slope_before: 0.0, slope_after: 0.0, curve };
        let curved = [-0.1, 0.04, 0.06].map(|r| state(Some(&law), r, false));
        assert_eq!(curved, [ContactState::Open, ContactState::Rising, ContactState::Falling]);
    }
}
