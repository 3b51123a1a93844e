//! Source: the discrete problem (4.3) has one solution, whatever way it is computed.
//! Goal: all ways that apply to a scene agree: condensation onto Γ3 and Newton's method in the volume; lagged factors and
//!   fresh ones; recursive, interpolated and direct sums over the past. Each way is really taken where it is claimed, by the
//!   counters of the run, and a seeded defect in one of them is seen.
//!   Grids are those of the scenes, and graded and random ones of this test.
//! Mesh: for every shipped scene 6 × 6 squares or 2 × 2 × 2 cubes and 8 steps; the coarsest mesh and 520
//!   steps for sums over the past.

mod anew;
mod factors;
mod grids;
mod past;

use fem::contact::{CaseInfo, StepView, march};
use scene::setup::{MeshData, Setup, TruthLoad};
use vhi::{InVolume, Newton, StepSolver};

/// A level is accepted at 16 units of rounding of its forces, 3.6e-15, and the condition number of a mesh n, some 10 n²,
/// makes at most 1.3e-12 of it for n = 6, 2e-11 for n = 24 and 8e-11 for n = 48 in displacements; locked pressures are
/// forces over a weight of 1/n.
const AGREE: f64 = 1e-10;
/// [`AGREE`] for a scene: the condition number is as many times larger as its moduli differ, which a nearly incompressible
/// body shows.
fn agree(setup: &Setup) -> f64 {
    let (low, high) = setup.model.elasticity.eigenvalues(setup.scene.dimension);
    AGREE.max(1.3e-12 * high / low)
}

/// Pressures are what is left of stresses: below this share of the largest modulus times the largest strain they are
/// measured against that. Rounding of stresses of order one, 2.9e-14, is 8e-11 of a pressure of 3.6e-4.
const SMALL: f64 = 1e-2;

/// Displacements, pressures and ζ of all levels, and what they took.
struct Run {
    u: Vec<Vec<f64>>,
    pressure: Vec<Vec<f64>>,
    zeta: Vec<Vec<f64>>,
    info: CaseInfo,
    /// The largest modulus times ‖ε(u)‖.
    stress: f64,
}

fn run(setup: &Setup, data: &MeshData, steps: u32, solver: &dyn StepSolver) -> Run {
    let (mut u, mut pressure, mut zeta) = (Vec::new(), Vec::new(), Vec::new());
    let mut load = TruthLoad(&*data.truth);
    let grid = setup.grid(steps);
    let mut see = |view: &StepView<'_>| {
        u.push(view.u.to_vec());
        pressure.push(view.compliance.iter().zip(view.multiplier).map(|(a, b)| a + b).collect());
        zeta.push(vec![view.zeta]);
        Ok(())
    };
    let model = &setup.model;
    let info = march(&data.space, model, &grid, &mut load, solver, &mut see);
    let info = info.unwrap_or_else(|error| panic!("{}: {error}", setup.scene.name));
    assert_eq!(u.len(), steps as usize + 1);
    let stress = model.elasticity.eigenvalues(setup.scene.dimension).1 * info.strain_norm;
    Run { u, pressure, zeta, info, stress }
}

/// The run that a user gets.
fn shortest(setup: &Setup, data: &MeshData, steps: u32) -> Run {
    run(setup, data, steps, &Newton::default())
}

/// Newton's method in the volume.
fn in_volume(setup: &Setup, data: &MeshData, steps: u32) -> Run {
    run(setup, data, steps, &InVolume::default())
}

/// The largest difference of two runs; displacements, pressures and ζ each relative to their largest.
fn distance(a: &Run, b: &Run) -> f64 {
    let off = |a: &[Vec<f64>], b: &[Vec<f64>], least: f64| {
        assert_eq!(a.len(), b.len());
        let pairs = a.iter().flatten().zip(b.iter().flatten());
        let largest = a.iter().flatten().fold(least, |most, value| most.max(value.abs()));
        // A NaN is larger than any tolerance.
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, |most, d| if d <= most { most } else { d })
            / largest
    };
    let larger = |a: f64, b: f64| if a.is_nan() || a > b { a } else { b };
    // What is zero throughout is that in both runs.
    let least = f64::MIN_POSITIVE;
    let fields = larger(off(&a.u, &b.u, least), off(&a.zeta, &b.zeta, least));
    larger(fields, off(&a.pressure, &b.pressure, least.max(SMALL * a.stress)))
}

/// Whether two runs have the same bits: they were computed in one way.
fn same_bits(a: &Run, b: &Run) -> bool {
    let bits = |run: &Run| -> Vec<u64> {
        run.u.iter().chain(&run.pressure).flatten().map(|value| value.to_bits()).collect()
    };
    bits(a) == bits(b)
}
