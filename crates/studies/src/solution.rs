//! What one case leaves behind for people and other programs: named quantities, VTU files.

mod vtu;

pub use vtu::{Field, VtuGrid, write_pvd, write_vtu};

use std::cmp::Ordering;
use std::path::{Path, PathBuf};

use algebra::in_dimension;
use algebra::tensor::contract;
use fem::contact::{Discretization, Model, StepView};
use fem::norms::is_locked;
use files::{FileError, make_directory};
use serde::Serialize;

// Named quantities of a solution at one time (t = T in `sweep solve`).

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
    /// Half of the length of Γ3 on which ξ + λ > 0, each vertex with its share of the edges (plane scenes; null in
    /// space). It changes by whole cells.
    pub contact_half_width: Option<f64>,
    /// Largest ξ + λ; null without Γ3.
    pub peak_pressure: Option<f64>,
    /// √(∫ p |x - x̄|² / ∫ p), x̄ the centre of pressure p = ξ + λ > 0: half of the half-width under Hertz's pressure;
    /// null where there is no pressure.
    pub pressure_spread: Option<f64>,
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
        let (mut elastic_energy, mut yielding_elements) = (0.0, 0);
        in_dimension!(space.mesh.dimension, D, S => {
            for at in space.points() {
                let strain = at.strain::<S>(view.u);
                let stress = model.elasticity.on(space.region(at.cell)).apply(&strain);
                elastic_energy += 0.5 * at.weight * contract(&stress, &strain);
            }
            for c in 0..space.mesh.cell_count() {
                yielding_elements += usize::from(view.yields::<S>(space, model, c));
            }
        });
        let (mesh, trace, d) = (&space.mesh, &space.trace, space.mesh.dimension);
        // Of equal values the first vertex in mesh order.
        let values = space.at_vertices(view.u);
        let heights = values.iter().skip(1).step_by(d).copied().zip(0u32..);
        let lower = |best: (f64, u32), next: (f64, u32)| if next.0 < best.0 { next } else { best };
        let (min_uy, lowest) = heights.fold((f64::INFINITY, 0), lower);
        let mut state = Self {
            element: space.element.name(),
            strain_norm: view.strain_norm,
            zeta: view.zeta,
            elastic_energy,
            yielding_elements,
            min_uy,
            min_uy_vertex: mesh.vertex(lowest).to_vec(),
            friction_force: vec![0.0; d],
            ..Self::default()
        };
        let (mut length, mut force, mut first, mut second) = (0.0, 0.0, [0.0; 3], 0.0);
        let most =
            |known: Option<f64>, value: f64| Some(known.unwrap_or(f64::NEG_INFINITY).max(value));
        for (i, point) in trace.points.iter().enumerate() {
            let (normal, x) = (trace.normal(i, view.u), mesh.point(&[point.vertex], &[1.0]));
            state.compliance_force += point.weight * view.compliance[i];
            state.multiplier_force += point.weight * view.multiplier[i];
            let pressure = view.compliance[i] + view.multiplier[i];
            state.peak_pressure = most(state.peak_pressure, pressure);
            if pressure > 0.0 {
                length += point.weight;
                force += point.weight * pressure;
                second += point.weight * pressure * x.iter().map(|x| x * x).sum::<f64>();
                (0..3).for_each(|a| first[a] += point.weight * pressure * x[a]);
            }
            let gap = model.gap(point.side, x, view.t);
            state.locked_vertices += usize::from(is_locked(normal, gap));
            if gap.is_finite() {
                let smallest = state.min_normal_gap.unwrap_or(f64::INFINITY);
                state.min_normal_gap = Some(smallest.min(gap - normal));
            }
            state.max_normal_displacement = most(state.max_normal_displacement, normal);
            let row = |value: f64| [mesh.vertex(point.vertex), &[value]].concat();
            state.normal_displacement.push(row(normal));
            state.compliance_pressure.push(row(view.compliance[i]));
            if let Some(boundary) = model.boundary_on(point.side).filter(|_| point.carries()) {
                let r = normal - (boundary.shift)(x);
                let mut jumps = boundary.potential.jumps().iter();
                let at_jump = jumps.any(|jump| (r - jump).abs() <= AT_JUMP * jump.abs().max(1.0));
                state.jump_vertices += usize::from(at_jump);
            }
        }
        for rows in [&mut state.normal_displacement, &mut state.compliance_pressure] {
            // By their coordinates.
            rows.sort_by(|a, b| {
                let pairs = a.iter().zip(b);
                pairs.fold(Ordering::Equal, |order, (p, q)| order.then(p.total_cmp(q)))
            });
        }
        state.contact_force = state.compliance_force + state.multiplier_force;
        let plane = d == 2 && !trace.points.is_empty();
        state.contact_half_width = plane.then_some(0.5 * length);
        if force > 0.0 {
            let centre: f64 = first.iter().map(|moment: &f64| (moment / force).powi(2)).sum();
            state.pressure_spread = Some((second / force - centre).max(0.0).sqrt());
        }
        let points = trace.points.iter().zip(view.friction_stresses(space));
        for (point, s) in points.filter(|(point, _)| point.carries()) {
            for (s, tangent) in s.iter().zip(point.tangents()) {
                let along = state.friction_force.iter_mut().zip(tangent);
                along.for_each(|(sum, along)| *sum += point.weight * s * along);
            }
            // A vertex that sticks is held at u_τ = 0, to rounding of a frame.
            let sticks = point.slip(view.u).iter().all(|u| u.abs() <= AT_JUMP);
            state.stick_vertices += usize::from(sticks);
            state.slip_vertices += usize::from(!sticks);
        }
        state
    }
}

/// Rounding of u_ν - s at a vertex that the solver holds at a jump (a length; displacements of size 1).
const AT_JUMP: f64 = 1e-14;

// A case as a series of VTU files with a .pvd index, for ParaView.

/// Files `SCENE_0000.vtu`, … and `SCENE.pvd` in one directory.
pub struct VtuSeries {
    dir: PathBuf,
    name: String,
    steps: Vec<(f64, String)>,
}

impl VtuSeries {
    /// Makes the directory.
    ///
    /// # Errors
    /// The file system's.
    pub fn new(dir: &Path, name: &str) -> Result<Self, FileError> {
        make_directory(dir)?;
        Ok(Self { dir: dir.to_owned(), name: name.to_owned(), steps: Vec::new() })
    }

    /// Writes one time level: at nodes the displacement and the contact pressure ξ + λ with its
    /// parts (zero off Γ3); on cells the mean stress (xx, yy, zz, xy, yz, xz) and where the body yields.
    ///
    /// # Errors
    /// The file system's.
    pub fn write(
        &mut self,
        space: &Discretization,
        model: &Model,
        view: &StepView<'_>,
    ) -> Result<(), FileError> {
        let mesh = &space.mesh;
        let points: Vec<[f64; 3]> =
            (0..mesh.vertices() as u32).map(|v| mesh.point(&[v], &[1.0])).collect();
        // Mandel (xx, yy, √2 xy) or (xx, yy, zz, √2 yz, √2 xz, √2 xy) to (xx, yy, zz, xy, yz, xz).
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let (mut stress, mut yields) = (Vec::new(), Vec::new());
        in_dimension!(mesh.dimension, D, S => for c in 0..mesh.cell_count() {
            stress.extend(match view.stress::<S>(space, model, c)[..] {
                [xx, yy, zz, yz, xz, xy] => [xx, yy, zz, half * xy, half * yz, half * xz],
                [xx, yy, xy] => [xx, yy, 0.0, half * xy, 0.0, 0.0],
                _ => [f64::NAN; 6],
            });
            yields.push(f64::from(u8::from(view.yields::<S>(space, model, c))));
        });
        let displacement = space.at_vertices(view.u);
        let (mut xi, mut lambda) = (vec![0.0; points.len()], vec![0.0; points.len()]);
        for (i, point) in space.trace.points.iter().enumerate() {
            xi[point.vertex as usize] += view.compliance[i];
            lambda[point.vertex as usize] += view.multiplier[i];
        }
        let pressure: Vec<f64> = xi.iter().zip(&lambda).map(|(a, b)| a + b).collect();
        let vertex = |&node: &u32| space.nodes.vertex[node as usize];
        let cells: Vec<u32> = space.nodes.cells.iter().map(vertex).collect();
        let grid =
            VtuGrid { points: &points, cells: &cells, vertices_per_cell: space.nodes.a_cell };
        let scalar = |name, values| Field { name, components: 1, values };
        let file = format!("{}_{:04}.vtu", self.name, view.n);
        write_vtu(
            &self.dir.join(&file),
            &grid,
            &[
                Field { name: "displacement", components: mesh.dimension, values: &displacement },
                scalar("contact pressure", &pressure),
                scalar("compliance", &xi),
                scalar("multiplier", &lambda),
            ],
            &[
                Field { name: "stress", components: 6, values: &stress },
                scalar("yielding", &yields),
            ],
        )?;
        self.steps.push((view.t, file));
        Ok(())
    }

    /// Writes the index.
    ///
    /// # Errors
    /// The file system's.
    pub fn finish(self) -> Result<(), FileError> {
        write_pvd(&self.dir.join(format!("{}.pvd", self.name)), &self.steps)
    }
}
