//! Pictures of one case: the contact state along Γ3 over time, and the deformed body at t = T.

use std::collections::BTreeMap;

use algebra::tensor::{deviator, norm};
use exact::Truth;
use fem::contact::{Discretization, LoadError, Model, StepView};
use fem::norms::{ContactState, is_locked, state_rule};
use report::{Arrow, BodyCell, Deformed, Panel, SpaceTime, Zone};

/// Largest displacement as drawn, relative to the body's extent, if displacements are small.
const REACH: f64 = 0.1;

/// Data for the pictures of a plane body.
pub(super) struct Pictures {
    name: String,
    grid: String,
    /// Facets of Γ3 ordered by midpoint, each with its arc length and whether it runs backwards.
    order: Vec<(usize, f64, bool)>,
    discrete: Panel,
    exact: Panel,
    body: Option<Deformed>,
}

impl Pictures {
    pub(super) fn new(space: &Discretization, name: &str, n: u32, steps: u32) -> Self {
        let trace = &space.trace;
        let at = |f: usize, corner: usize| {
            let vertex = space.mesh.facet(trace.mesh_facet[f] as usize)[corner];
            let place = space.mesh.vertex(vertex);
            (place[0], place[1])
        };
        let middle = |f: usize| (at(f, 0).0 + at(f, 1).0, at(f, 0).1 + at(f, 1).1);
        let mut facets: Vec<usize> = (0..trace.measure.len()).collect();
        facets.sort_by(|&a, &b| {
            let (a, b) = (middle(a), middle(b));
            a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1))
        });
        let mut length = 0.0;
        let placed = |f: usize| {
            let from = length;
            length += trace.measure[f];
            (f, from, at(f, 0) > at(f, 1))
        };
        let order = facets.into_iter().map(placed).collect();
        let panel = |title: &str| Panel { title: title.into(), ..Panel::default() };
        Self {
            name: name.to_owned(),
            grid: format!("n = {n}, N = {steps}"),
            order,
            discrete: panel("discrete"),
            exact: panel("exact"),
            body: None,
        }
    }

    /// Adds a time level; the last one is used for the body.
    pub(super) fn add(
        &mut self,
        space: &Discretization,
        model: &Model,
        truth: &dyn Truth,
        view: &StepView<'_>,
        last: bool,
    ) -> Result<(), LoadError> {
        if let Some(samples) = truth.contact_samples(view.t)? {
            let (weights, mut level) = (state_rule().weights, Vec::new());
            for &(f, mut from, backwards) in &self.order {
                for q in 0..weights.len() {
                    // The rule is symmetric.
                    let place = if backwards { weights.len() - 1 - q } else { q };
                    let to = from + weights[q] * space.trace.measure[f];
                    level.push((from, to, zone(samples.state[weights.len() * f + place])));
                    from = to;
                }
            }
            self.exact.times.push(view.t);
            self.exact.levels.push(level);
        }
        let trace = &space.trace;
        let locked = |i: usize| {
            let place = space.mesh.point(&[trace.points[i].vertex], &[1.0]);
            let gap = model.gap(trace.points[i].side, place, view.t);
            is_locked(trace.normal(i, view.u), gap)
        };
        let pressed = |i: usize| view.compliance[i] + view.multiplier[i] > 0.0;
        let piece = |&(f, from, _): &(usize, f64, bool)| {
            let mut ends = trace.facet(f).iter().map(|&i| i as usize);
            let zone = if ends.clone().all(locked) {
                Zone::Locked
            } else if ends.any(pressed) {
                Zone::Compliant
            } else {
                Zone::Open
            };
            (from, from + trace.measure[f], zone)
        };
        let level = self.order.iter().map(piece).collect();
        self.discrete.times.push(view.t);
        self.discrete.levels.push(level);
        if last {
            self.body = Some(self.deformed(space, model, view));
        }
        Ok(())
    }

    fn deformed(&self, space: &Discretization, model: &Model, view: &StepView<'_>) -> Deformed {
        let mesh = &space.mesh;
        let values = space.at_vertices(view.u);
        let displacement = |v: u32| (values[2 * v as usize], values[2 * v as usize + 1]);
        let vertices = || 0..mesh.vertices() as u32;
        let largest = vertices().map(displacement).fold(0.0f64, |m, u| m.max(u.0.hypot(u.1)));
        let extent = (0..2).map(|c| {
            let values = || vertices().map(|v| mesh.vertex(v)[c]);
            values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min)
        });
        let factor = magnification(largest, extent.fold(0.0, f64::max));
        let moved = |v: u32| {
            let (place, u) = (mesh.vertex(v), displacement(v));
            (place[0] + factor * u.0, place[1] + factor * u.1)
        };
        let cell = |c: usize| BodyCell {
            corners: [0, 1, 2].map(|a| moved(mesh.cell(c)[a])),
            stress: norm(&deviator(&view.stress::<3>(space, model, c))),
            yields: view.yields::<3>(space, model, c),
        };
        let cells: Vec<BodyCell> = (0..mesh.cell_count()).map(cell).collect();
        let flat = |v: u32| (mesh.vertex(v)[0], mesh.vertex(v)[1]);
        let rest = mesh.facets.as_chunks().0.iter().map(|ends: &[u32; 2]| ends.map(flat));
        let arrow = |(i, point): (usize, &fem::contact::TracePoint)| {
            let [x, y, _] = point.normal;
            let pressure = view.compliance[i] + view.multiplier[i];
            Arrow { foot: moved(point.vertex), direction: (-x, -y), pressure }
        };
        let drawn = match factor {
            1.0 => "as they are".into(),
            _ => format!("{factor} times as large as they are"),
        };
        Deformed {
            title: format!("{}: the body at t = {}", self.name, view.t),
            subtitle: format!("{}; displacements {drawn}", self.grid),
            quantity: "‖σ^D‖, a stress".into(),
            rest: rest.collect(),
            yield_border: border(&mesh.cells, &cells).into_iter().map(|e| e.map(moved)).collect(),
            arrows: space.trace.points.iter().enumerate().map(arrow).collect(),
            cells,
        }
    }

    /// Names and texts of the files; without Γ3 there is no contact state.
    pub(super) fn finish(self) -> Vec<(String, String)> {
        let both = [self.exact, self.discrete];
        let panels = both.into_iter().filter(|panel| !panel.levels.is_empty()).collect();
        let picture = SpaceTime {
            title: format!("{}: contact state on Γ3", self.name),
            subtitle: format!(
                "{}; an edge is locked if both ends are, and compliant if one end is under pressure",
                self.grid
            ),
            panels,
        };
        let contact = picture.svg().map(|svg| (format!("{}-contact.svg", self.name), svg));
        let body = self.body.and_then(|body| body.svg());
        let body = body.map(|svg| (format!("{}-body.svg", self.name), svg));
        contact.into_iter().chain(body).collect()
    }
}

fn zone(state: ContactState) -> Zone {
    match state {
        ContactState::Open => Zone::Open,
        ContactState::Rising | ContactState::Falling | ContactState::AtJump => Zone::Compliant,
        ContactState::Locked => Zone::Locked,
    }
}

/// Magnification of displacements: 1, 2 or 5 times a power of ten, at least one.
fn magnification(largest: f64, extent: f64) -> f64 {
    let wanted = REACH * extent / largest;
    if !wanted.is_finite() || wanted < 1.5 {
        return 1.0;
    }
    let power = 10f64.powf(wanted.log10().floor());
    let digit = [5.0, 2.0].into_iter().find(|digit| digit * power <= wanted).unwrap_or(1.0);
    digit * power
}

/// Edges between yielding and other cells.
fn border(corners: &[u32], cells: &[BodyCell]) -> Vec<[u32; 2]> {
    let mut sides: BTreeMap<[u32; 2], (u32, u32)> = BTreeMap::new();
    for (cell, corners) in cells.iter().zip(corners.chunks(3)) {
        for [a, b] in [[0, 1], [1, 2], [2, 0]].map(|ends| ends.map(|i| corners[i])) {
            let count = sides.entry([a.min(b), a.max(b)]).or_default();
            if cell.yields { count.0 += 1 } else { count.1 += 1 }
        }
    }
    sides.into_iter().filter(|(_, count)| *count == (1, 1)).map(|(edge, _)| edge).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn displacements_are_drawn_by_a_round_factor() {
        assert_eq!(magnification(0.1, 1.0), 1.0);
        assert_eq!(magnification(0.01, 1.0), 10.0);
        assert_eq!(magnification(0.03, 1.0), 2.0);
        assert_eq!(magnification(1e-4, 5.0), 5000.0);
        assert_eq!(magnification(0.0, 1.0), 1.0);
    }

    #[test]
    fn the_border_lies_between_what_yields_and_what_does_not() {
        let cell = |yields| BodyCell { corners: [(0.0, 0.0); 3], stress: 0.0, yields };
        let corners = [0, 1, 2, 1, 3, 2, 3, 4, 2];
        assert_eq!(border(&corners, &[cell(true), cell(true), cell(false)]), [[2, 3]]);
        assert!(border(&corners, &[cell(true), cell(true), cell(true)]).is_empty());
    }
}
