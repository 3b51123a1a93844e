//! Named quantities of a solution at one time (t = T in `sweep solve`).

use std::cmp::Ordering;

use algebra::in_dimension;
use serde::Serialize;

use super::pressed_zone::PressedZone;
use algebra::tensor::contract;
use fem::contact::{Discretization, Model, StepView};
use fem::norms::is_locked;

/// Named quantities; the field names are the JSON keys that other programs rely on.
#[derive(Debug, Clone, Default, Serialize)]
pub struct FinalState {
    /// The element of displacements.
    pub element: &'static str,
    /// ‖ε(u)‖.
    pub strain_norm: f64,
    /// ζ.
    pub zeta: f64,
    /// ½(𝒜ε, ε).
    pub elastic_energy: f64,
    /// ∫_{Γ3} (ξ + λ).
    pub contact_force: f64,
    /// Vertices with u_ν = g.
    pub locked_vertices: usize,
    /// ∫_{Γ3} ξ.
    pub compliance_force: f64,
    /// ∫_{Γ3} λ.
    pub multiplier_force: f64,
    /// Cells on which the projection acts.
    pub yielding_elements: usize,
    /// Smallest u_y over all vertices, and midpoints with nodes.
    pub min_uy: f64,
    /// Its place.
    pub min_uy_vertex: Vec<f64>,
    /// Smallest g - u_ν on Γ3; null without a finite gap.
    pub min_normal_gap: Option<f64>,
    /// Largest u_ν on Γ3; null without Γ3.
    pub max_normal_displacement: Option<f64>,
    /// Where Γ3 is under pressure.
    #[serde(flatten)]
    pub pressed: PressedZone,
    /// [x, y, u_ν] (in 3D [x, y, z, u_ν]) on the vertices of Γ3, along the side.
    pub normal_displacement: Vec<Vec<f64>>,
    /// [x, y, ξ] (in 3D [x, y, z, ξ]) at the same vertices: the selection ξ ∈ ∂j_ν(u_ν - s).
    pub compliance_pressure: Vec<Vec<f64>>,
    /// Vertices where u_ν - s is at a jump of the law, so that the balance chooses ξ.
    pub jump_vertices: usize,
    /// Σ w s over Γ3 by components, s = -σ_τ as a vector; zeros without friction.
    pub friction_force: Vec<f64>,
    /// Free vertices of Γ3 with friction and u_τ = 0.
    pub stick_vertices: usize,
    /// The other ones.
    pub slip_vertices: usize,
}

impl FinalState {
    /// The quantities of the level that `view` shows.
    pub fn new(space: &Discretization, model: &Model, view: &StepView<'_>) -> Self {
        let (elastic_energy, yielding_elements) =
            in_dimension!(space.mesh.dimension, D, S => over_cells::<S>(space, model, view));
        let (min_uy, min_uy_vertex) = lowest(space, view);
        let mut state = Self {
            element: space.element.name(),
            strain_norm: view.strain_norm,
            zeta: view.zeta,
            elastic_energy,
            yielding_elements,
            min_uy,
            min_uy_vertex,
            pressed: PressedZone::new(space, view),
            friction_force: vec![0.0; space.mesh.dimension],
            ..Self::default()
        };
        state.add_trace(space, model, view);
        state.add_friction(space, view);
        state
    }

    /// A vertex that sticks is held at u_τ = 0, to rounding of a frame.
    fn add_friction(&mut self, space: &Discretization, view: &StepView<'_>) {
        let points = space.trace.points.iter().zip(view.friction_stresses(space));
        for (point, s) in points.filter(|(point, _)| point.carries()) {
            for (s, tangent) in s.iter().zip(point.tangents()) {
                self.friction_force.iter_mut().zip(tangent).for_each(|(sum, along)| {
                    *sum += point.weight * s * along;
                });
            }
            let sticks = point.slip(view.u).iter().all(|u| u.abs() <= AT_JUMP);
            self.stick_vertices += usize::from(sticks);
            self.slip_vertices += usize::from(!sticks);
        }
    }

    fn add_trace(&mut self, space: &Discretization, model: &Model, view: &StepView<'_>) {
        let d = space.mesh.dimension;
        for (i, point) in space.trace.points.iter().enumerate() {
            let normal = space.trace.normal(i, view.u);
            self.compliance_force += point.weight * view.compliance[i];
            self.multiplier_force += point.weight * view.multiplier[i];
            let gap = model.boundary.as_ref().map_or(f64::INFINITY, |boundary| {
                (boundary.gap)(space.mesh.point(&[point.vertex], &[1.0]))
            });
            self.locked_vertices += usize::from(is_locked(normal, gap));
            if gap.is_finite() {
                let smallest = self.min_normal_gap.unwrap_or(f64::INFINITY);
                self.min_normal_gap = Some(smallest.min(gap - normal));
            }
            let largest = self.max_normal_displacement.unwrap_or(f64::NEG_INFINITY);
            self.max_normal_displacement = Some(largest.max(normal));
            let row = |value: f64| {
                let mut row = space.mesh.vertex(point.vertex)[..d].to_vec();
                row.push(value);
                row
            };
            self.normal_displacement.push(row(normal));
            self.compliance_pressure.push(row(view.compliance[i]));
            if let Some(boundary) = model.boundary.as_ref().filter(|_| point.carries()) {
                let r = normal - (boundary.shift)(space.mesh.point(&[point.vertex], &[1.0]));
                let mut jumps = boundary.potential.jumps().iter();
                let at_jump = jumps.any(|jump| (r - jump).abs() <= AT_JUMP * jump.abs().max(1.0));
                self.jump_vertices += usize::from(at_jump);
            }
        }
        along_the_side(&mut self.normal_displacement);
        along_the_side(&mut self.compliance_pressure);
        self.contact_force = self.compliance_force + self.multiplier_force;
    }
}

/// Rounding of u_ν - s at a vertex that the solver holds at a jump (a length; displacements of size 1).
const AT_JUMP: f64 = 1e-14;

/// Sorts rows by their coordinates.
fn along_the_side(rows: &mut [Vec<f64>]) {
    rows.sort_by(|a, b| {
        let pairs = a.iter().zip(b);
        pairs.fold(Ordering::Equal, |order, (p, q)| order.then(p.total_cmp(q)))
    });
}

fn over_cells<const S: usize>(
    space: &Discretization,
    model: &Model,
    view: &StepView<'_>,
) -> (f64, usize) {
    let (mut energy, mut yielding) = (0.0, 0);
    for at in space.points() {
        let strain = at.strain::<S>(view.u);
        let stress = model.elasticity.on(space.region(at.cell)).apply(&strain);
        energy += 0.5 * at.weight * contract(&stress, &strain);
    }
    for c in 0..space.mesh.cell_count() {
        yielding += usize::from(view.yields::<S>(space, model, c));
    }
    (energy, yielding)
}

/// Smallest u_y and its vertex; of equal values the first vertex in mesh order.
fn lowest(space: &Discretization, view: &StepView<'_>) -> (f64, Vec<f64>) {
    let (d, values) = (space.mesh.dimension, space.at_vertices(view.u));
    let heights = values.iter().skip(1).step_by(d).copied().zip(0u32..);
    let lower = |best: (f64, u32), next: (f64, u32)| if next.0 < best.0 { next } else { best };
    let best = heights.fold((f64::INFINITY, 0), lower);
    (best.0, space.mesh.vertex(best.1).to_vec())
}
