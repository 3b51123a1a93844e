//! Source: (5.1)-(5.5) in three dimensions; plane strain.
//! Goal: the solver on tetrahedra. A plane scene continued along z, with the tractions of plane strain on its ends, has the
//!   plane solution, to rounding, where the strain is one tensor; order 2 in time on any mesh; loads of formulas, a symmetric
//!   scene with every term, sampled constants; the tangent is the derivative of the force with all terms present.
//! Mesh: boxes of n³ cubes, six tetrahedra each; top (y = 1) clamped, bottom in contact.
//! Data: affine (λ = μ_L = 1, ℬ = -exp(-t)/4 𝒜, compliance with a falling branch) without projection.

use crate::samples::sample;
use crate::shipped::{edited, setup_of, text};
use fem::contact::{
    ContactProblem, Discretization, LastSlot, Load, LoadError, Model, march, stress_force,
};
use fem::mesh::{Family, lattice};
use scene::setup::{Setup, constants};
use vhi::law::{AnyProjection, Isotropic, VonMises, YieldLimit};
use vhi::{Newton, StepInequality};

fn space(n: u32, family: Family) -> Discretization {
    let mesh = lattice([1.0, 1.0, 0.5], n, family);
    let (top, bottom) = (mesh.side("top").unwrap(), mesh.side("bottom").unwrap());
    Discretization::new(mesh, &[top], &[bottom])
}

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

/// Which of the two terms a run has. With both the time error meets the law, and the discrete solution is no longer one
/// tensor: neither run is then exact in space, and they differ.
#[derive(Clone, Copy, PartialEq)]
enum Terms {
    Memory,
    Law,
    Both,
}

/// F(v) = ∫ σ:ε(v) + ∫_{Γ3} p(u_ν) v_ν with the plane-strain stress of the exact displacement.
struct Extruded<'a>(&'a Discretization, Terms);

impl Load for Extruded<'_> {
    fn assemble(&mut self, t: f64, out: &mut [f64]) -> Result<(), LoadError> {
        let (space, terms) = (self.0, self.1);
        let [past_b, past_a] = if terms == Terms::Law { [0.0; 2] } else { remembered(t) };
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
        let active = if terms == Terms::Memory { 0.0 } else { 1.0 };
        let pressure = active * if r <= 0.04 { 2.0 * r } else { 0.08 - 0.5 * (r - 0.04) };
        for (i, point) in space.trace.points.iter().enumerate() {
            space.trace.add_normal(i, point.weight * pressure, &mut force);
        }
        out.copy_from_slice(&force[..out.len()]);
        Ok(())
    }
}

fn with(terms: Terms) -> Setup {
    let scene = text("affine");
    let cut = |text: &str, from: &str, to: &str| {
        let (before, after) = text.split_once(from).expect("a term");
        format!("{before}{to}{}", after.split_once(to).expect("the next term").1)
    };
    let mut scene = cut(&scene, "[material.projection]", "[contact]");
    if terms == Terms::Law {
        scene = cut(&scene, "[material.memory]", "[contact]");
    }
    if terms == Terms::Memory {
        scene = cut(&scene, "law =", "quadrature");
    }
    setup_of(edited(&scene, "name = \"affine\"", "name = \"extruded\""))
}

/// Largest difference from the plane run at common vertices, and from the exact displacement at all, over all levels.
fn against_plane(
    terms: Terms,
    change: impl Fn(&mut Model),
    family: Family,
    steps: u32,
) -> (f64, f64) {
    let (setup, n) = (with(terms), 4);
    let data = crate::shipped::on_mesh(&setup, n);
    let mut plane_u: Vec<Vec<f64>> = Vec::new();
    crate::shipped::run(&setup, &setup.model, &data, steps, |view| plane_u.push(view.u.to_vec()))
        .unwrap();
    let mut model = Model { projection: None, ..with(terms).model };
    change(&mut model);
    let space = space(n, family);
    let (mut different, mut error, mut level) = (0f64, 0f64, 0);
    let grid = setup.grid(steps);
    march(&space, &model, &grid, &mut Extruded(&space, terms), &Newton::default(), &mut |view| {
        let flat = &data.space;
        for v in 0..space.mesh.vertices() {
            let x = space.mesh.vertex(v as u32);
            let at_node = &view.u[3 * space.nodes.of_vertex[v] as usize..][..3];
            let exact = [b(view.t) * (1.0 - x[1]), -a(view.t) * (1.0 - x[1]), 0.0];
            error = (0..3).map(|i| (at_node[i] - exact[i]).abs()).fold(error, f64::max);
            let same = |p: &usize| (0..2).all(|i| flat.mesh.vertex(*p as u32)[i] == x[i]);
            let Some(p) = (0..flat.mesh.vertices()).find(same) else { continue };
            let twin = &plane_u[level][2 * flat.nodes.of_vertex[p] as usize..][..2];
            different = (0..2).map(|i| (at_node[i] - twin[i]).abs()).fold(different, f64::max);
            different = different.max(at_node[2].abs());
        }
        level += 1;
        Ok(())
    })
    .unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(level, steps as usize + 1);
    (different, error)
}

#[test]
fn a_plane_scene_continued_along_z_has_the_plane_solution() {
    for terms in [Terms::Memory, Terms::Law] {
        for steps in [4, 8] {
            let (different, error) = against_plane(terms, |_| (), Family::Structured, steps);
            // Displacements of 0.3, a Newton tolerance of 16 units of rounding, a condition below 1e3.
            assert!(different < 1e-12, "N = {steps}: {different:e}");
            // Without memory there is no time error either.
            assert_eq!(error < 1e-12, terms == Terms::Law, "{error:e}");
        }
        let wrong = |model: &mut Model| {
            let more = |law: Isotropic| Isotropic { lambda: 1.01 * law.lambda, ..law };
            model.elasticity = model.elasticity.map(more);
        };
        assert!(against_plane(terms, wrong, Family::Structured, 4).0 > 1e-5);
    }
}

/// V^h holds the exact displacement on any mesh, so the error is that of the time rule: order 2.
#[test]
fn the_time_order_is_two_on_a_perturbed_mesh() {
    let family = Family::Perturbed { amplitude: 0.15, seed: 2, axes: [true; 3] };
    let errors = [8, 16, 32, 64].map(|steps| against_plane(Terms::Both, |_| (), family, steps).1);
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        // The kink of the law is passed at one time: pairs differ by the place of it in the grid.
        assert!((order - 2.0).abs() < 0.06, "{order}: {errors:?}");
    }
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

/// The constants of (2.5b), (2.7b) and of S hold on samples, with deviators of trace tr/3; smaller ones do not.
#[test]
fn declared_constants_hold_on_samples() {
    let setup = setup_of(text("punch-box"));
    let space = setup.space(2).unwrap_or_else(|error| panic!("{error}"));
    let declared = constants(&setup).unwrap_or_else(|error| panic!("{error}"));
    let rows = sample(&setup, &declared, &space);
    assert!(rows.len() > 5 && rows.iter().all(|row| row.reason().is_none()), "{rows:?}");
    let mut small = declared.clone();
    (small.m_a, small.l_a) = (1.5 * declared.m_a, 0.5 * declared.l_a);
    (small.alpha_phi, small.memory.operator) = (0.2 * declared.alpha_phi, 0.0);
    let rows = sample(&setup, &small, &space);
    for refuted in ["(2.5b): -m_A", "L_A", "(2.7b): alpha_phi, same y", "Lipschitz constant of S"] {
        let row = rows.iter().find(|row| row.statement.source == refuted).expect("a row");
        assert!(row.reason().is_some(), "{row:?}");
    }
}

struct Rising;
impl YieldLimit for Rising {
    fn value(&self, zeta: f64) -> f64 {
        0.1 + 0.3 * zeta
    }

    fn slope(&self, _: f64) -> f64 {
        0.3
    }
}

#[test]
fn the_tangent_is_the_derivative_of_the_force() {
    let space = space(2, Family::Perturbed { amplitude: 0.15, seed: 3, axes: [true; 3] });
    let projection = Some(AnyProjection::new(VonMises { mu: 0.7, limit: Rising }));
    let model = Model { projection, ..with(Terms::Both).model };
    let mut problem = ContactProblem::new(&space, &model).expect("an analysis");
    let order = space.dofs();
    problem.begin(&LastSlot { zeta: 0.4, memory: vec![-0.2] }, 0.3, &vec![0.0; order], &[]);
    let u: Vec<f64> = (0..order).map(|i| 0.2 * (1.7 * i as f64).sin()).collect();
    let v: Vec<f64> = (0..order).map(|i| (0.9 * i as f64).cos()).collect();
    let force = |problem: &mut ContactProblem<'_>, scale: f64| {
        let at: Vec<f64> = u.iter().zip(&v).map(|(u, v)| u + scale * v).collect();
        let mut out = vec![0.0; order];
        problem.residual(&at, &mut out);
        out
    };
    let step = 1e-6;
    let (up, down) = (force(&mut problem, step), force(&mut problem, -step));
    let mut slope: Vec<f64> = up.iter().zip(&down).map(|(a, b)| (a - b) / (2.0 * step)).collect();
    force(&mut problem, 0.0);
    let graphs = problem.graph().coordinates.len();
    problem.linearize(&vec![0.0; graphs], &vec![None; graphs]).unwrap();
    // J⁻¹ of the difference quotient is v.
    problem.solve(&mut slope, 1e-13).unwrap();
    let off = slope.iter().zip(&v).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    // Rounding 1e-16 / 1e-6, truncation 1e-12 times third derivatives, a condition below 1e3.
    assert!(off < 1e-6, "{off:e}");
}
