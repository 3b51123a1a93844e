//! Source: (5.1)-(5.5) in three dimensions; plane strain.
//! Goal: the solver on tetrahedra. A plane scene continued along z, with the tractions of plane strain on its ends, has order 2
//!   in time on any mesh; loads of formulas, a symmetric scene with every term.
//! Mesh: boxes of n³ cubes, six tetrahedra each; top (y = 1) clamped, bottom in contact.
//! Data: affine (λ = μ_L = 1, ℬ = -exp(-t)/4 𝒜, compliance with a falling branch) without projection.

use crate::shipped::{edited, setup_of, text};
use fem::contact::{Discretization, Load, LoadError, Model, march, stress_force};
use fem::mesh::{Family, lattice};
use scene::setup::Setup;
use vhi::Newton;
use vhi::law::Isotropic;

/// u = (b(1-y), -a(1-y), 0): the exact displacement of the scene.
fn b(t: f64) -> f64 {
    0.3 * (2.0 * t).sin()
}

fn a(t: f64) -> f64 {
    0.08 * t * (2.0 - t)
}

/// ∫_0^t e^{-(t-s)} b(s) ds and the same of a, by hand.
fn remembered(t: f64) -> [f64; 2] {
    let (s, c) = (2.0 * t).sin_cos();
    let decay = (-t).exp();
    let of_b = 0.3 * (s - 2.0 * c + 2.0 * decay) / 5.0;
    let of_a = 0.08 * (2.0 * (t - 1.0 + decay) - (t * t - 2.0 * t + 2.0 - 2.0 * decay));
    [of_b, of_a]
}

/// F(v) = ∫ σ:ε(v) + ∫_{Γ3} p(u_ν) v_ν with the plane-strain stress of the exact displacement.
struct Extruded<'a>(&'a Discretization);

impl Load for Extruded<'_> {
    fn assemble(&mut self, t: f64, out: &mut [f64]) -> Result<(), LoadError> {
        let (space, [past_b, past_a]) = (self.0, remembered(t));
        let (shear, normal) = (b(t) - 0.25 * past_b, a(t) - 0.25 * past_a);
        // ε_yy = a, ε_xy = -b/2: σ = 2ε + tr ε I; Mandel order xx, yy, zz, yz, xz, xy.
        let stress = [normal, 3.0 * normal, normal, 0.0, 0.0, -shear * 2f64.sqrt()];
        let mut force = vec![0.0; space.nodes.len()];
        for c in 0..space.mesh.cell_count() {
            let scaled = stress.map(|s| s * space.geometry.measure[c]);
            let (gradients, nodes) = (space.geometry.gradients(c), space.cell_nodes(c));
            stress_force::<3, 6>(gradients, nodes, &scaled, &mut force);
        }
        // The rising branch 2 r: a(t) <= 0.08 passes the kink at 0.04.
        let r = a(t);
        let pressure = if r <= 0.04 { 2.0 * r } else { 0.08 - 0.5 * (r - 0.04) };
        for (i, point) in space.trace.points.iter().enumerate() {
            space.trace.add_normal(i, point.weight * pressure, &mut force);
        }
        out.copy_from_slice(&force[..out.len()]);
        Ok(())
    }
}

/// The largest difference from the exact displacement, at all vertices and levels, of `affine` without projection.
fn largest_error(change: impl Fn(&mut Model), steps: u32) -> f64 {
    let scene = text("affine");
    let (before, after) = scene.split_once("[material.projection]").expect("a projection");
    let (_, after) = after.split_once("[contact]").expect("the next term");
    let mut setup = setup_of(format!("{before}[contact]{after}"));
    change(&mut setup.model);
    let family = Family::Perturbed { amplitude: 0.15, seed: 2, axes: [true; 3] };
    let mesh = lattice([1.0, 1.0, 0.5], 4, family);
    let [top, bottom] = ["top", "bottom"].map(|side| mesh.side(side).expect("a side"));
    let space = Discretization::new(mesh, &[top], &[bottom]);
    let (mut error, mut load, grid) = (0f64, Extruded(&space), setup.grid(steps));
    march(&space, &setup.model, &grid, &mut load, &Newton::default(), &mut |view| {
        for v in 0..space.mesh.vertices() {
            let y = space.mesh.vertex(v as u32)[1];
            let at_node = &view.u[3 * space.nodes.of_vertex[v] as usize..][..3];
            let exact = [b(view.t) * (1.0 - y), -a(view.t) * (1.0 - y), 0.0];
            error = (0..3).map(|i| (at_node[i] - exact[i]).abs()).fold(error, f64::max);
        }
        Ok(())
    })
    .unwrap_or_else(|error| panic!("{error}"));
    error
}

/// V^h holds the exact displacement on any mesh, so the error is that of the time rule: order 2. With another modulus it is not.
#[test]
fn the_time_order_is_two_on_a_perturbed_mesh() {
    let errors = [8, 16, 32, 64].map(|steps| largest_error(|_| (), steps));
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        // The kink of the law is passed at one time: pairs differ by the place of it in the grid.
        assert!((order - 2.0).abs() < 0.06, "{order}: {errors:?}");
    }
    let wrong = |model: &mut Model| {
        let more = |law: Isotropic| Isotropic { lambda: 1.01 * law.lambda, ..law };
        model.elasticity = model.elasticity.map(more);
    };
    let off = largest_error(wrong, 64);
    assert!(off > 10.0 * errors[3], "{off:e} {errors:?}");
}

/// A box as a scene file states it, its body force and its traction on the side z = 0.
fn pressed(body: &str, front: &str) -> Setup {
    let loads = format!("{body}\ntraction = {{ front = {front} }}");
    let given = "body = [\"0\", \"-3*t*(x + 0.5*z)\", \"0\"]";
    setup_of(edited(&text("punch-box"), given, &loads))
}

/// F(v) of formulas for v = (1-y) e_i, which is in V^h, against integrals by hand.
#[test]
fn loads_of_formulas_are_their_integrals() {
    let body = "body = [\"t*x^2*z\", \"x*y*z\", \"2 + t\"]";
    let setup = pressed(body, "[\"x*y\", \"t\", \"x^2\"]");
    let data = crate::shipped::on_mesh(&setup, 3);
    let load = data.truth.load(0.5).expect("finite loads");
    let space = &data.space;
    // ∫ 1-y = 1/2, ∫ y(1-y) = 1/6 on the edges of the cube; the rest are powers.
    let exact =
        [0.5 / 3.0 / 2.0 / 2.0 + 0.5 / 6.0, 0.5 / 6.0 / 2.0 + 0.5 * 0.5, 2.5 * 0.5 + 0.5 / 3.0];
    for (i, exact) in exact.into_iter().enumerate() {
        let work: f64 = (0..space.nodes.free)
            .map(|node| (1.0 - space.mesh.vertex(space.nodes.vertex[node])[1]) * load[3 * node + i])
            .sum();
        // The rules are exact here; sums of some hundred terms.
        assert!((work - exact).abs() < 1e-13, "{i}: {work} {exact}");
    }
}

/// x and z change places: Kuhn's triangulation of the cube does not notice, so nothing may, with every term of the model.
#[test]
fn a_symmetric_cube_stays_symmetric() {
    let symmetric = "body = [\"t*z\", \"-3*t*(x + z)\", \"t*x\"]";
    let difference = |body: &str| {
        let setup = setup_of(edited(
            &text("punch-box"),
            "body = [\"0\", \"-3*t*(x + 0.5*z)\", \"0\"]",
            body,
        ));
        let data = crate::shipped::on_mesh(&setup, 4);
        let (space, mut worst, mut locked) = (&data.space, 0f64, 0);
        crate::shipped::run(&setup, &setup.model, &data, 4, |view| {
            let at = |v: usize| &view.u[3 * space.nodes.of_vertex[v] as usize..][..3];
            for v in 0..space.mesh.vertices() {
                let x = space.mesh.vertex(v as u32);
                let swapped = [x[2], x[1], x[0]];
                let same = |w: &usize| space.mesh.vertex(*w as u32) == swapped;
                let twin = (0..space.mesh.vertices()).find(same).expect("a vertex");
                let (a, b) = (at(v), at(twin));
                worst = (0..3).map(|i| (a[i] - b[2 - i]).abs()).fold(worst, f64::max);
            }
            locked = view.multiplier.iter().filter(|lambda| **lambda > 0.0).count();
        })
        .unwrap_or_else(|error| panic!("{error}"));
        assert!(locked > 3, "{locked} locked vertices");
        worst
    };
    // As above: displacements of 0.3, a Newton tolerance of 16 units of rounding, a condition below 1e3.
    assert!(difference(symmetric) < 1e-12, "{:e}", difference(symmetric));
    assert!(difference("body = [\"0\", \"-3*t*(x + 0.99*z)\", \"0\"]") > 1e-5);
}
