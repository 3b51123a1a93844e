//! Source: lifting, docs/THEORY.md section 2. With u = w + G(t), G_ν = g(t) on Γ3 and G = 0 on Γ1, w has the fixed set
//!   w_ν ≤ 0, and the load of u minus what G(t_n) and its history take of it.
//! Goal: a gap that moves. The solution with the gap g(x, t) is that of the lifted problem plus G, at every level, with its
//!   multiplier: condensed, in the volume with friction, P1 and P2, in the plane and in space.
//! Mesh: 6 cells along an edge, in space 2. Data: elasticity, memory, body force; the obstacle comes nearer and withdraws.
//! Defects: the matrix of docs/EXTERNAL.md.

use crate::shipped::{errors, on_mesh, setup, setup_of};
use fem::contact::{Discretization, Load, LoadError, Model, Plan, march};
use scene::setup::{MeshData, Setup, TruthLoad};
use vhi::Newton;
use vhi::history::TimeGrid;
use vhi::law::Convolution;

const STEPS: u32 = 6;
/// Displacements and multipliers are of order 1 and below: Newton stops at 16 units of rounding of forces, which the
/// condition of the stiffness (below 1e3 on these meshes) turns into 1e-12.
const EQUAL: f64 = 1e-10;

/// g, concave in x and z.
fn gap([x, _, z]: [f64; 3], t: f64) -> f64 {
    0.06 - 0.04 * (5.0 * t).sin() - 0.02 * t * (x * x + z * z)
}

const GAP: [&str; 2] =
    ["0.06 - 0.04*sin(5*t) - 0.02*t*x^2", "0.06 - 0.04*sin(5*t) - 0.02*t*(x^2 + z^2)"];

fn scene(d: usize, more: &str) -> Setup {
    let [shape, size, sides, last] = match d {
        2 => ["rectangle", "[1.0, 1.0]", "\"left\", \"right\"", ""],
        _ => {
            ["box", "[1.0, 1.0, 1.0]", "\"left\", \"right\", \"front\", \"back\"", ", \"0.5*t*z\""]
        }
    };
    setup_of(format!(
        "[scene]\nname = \"lifted\"\nquestion = \"?\"\ndimension = {d}\njudge = false\n\
         [domain]\nshape = \"{shape}\"\nsize = {size}\nclamped = [\"top\"]\ntraction = [{sides}]\ncontact = [\"bottom\"]\n\
         [time]\nhorizon = 1.0\n[material]\nlambda = 1.0\nmu_L = 1.0\n\
         [material.memory]\nkernel = \"-exp(-t)\"\nlambda = 0.25\nmu = 0.25\n\
         [contact]\ngap = \"{}\"\n{more}\n\
         [loads]\nbody = [\"0.3*t\", \"0.2 - 1.5*x\"{last}]\n\
         [sweep]\nn = [2]\nsteps = [{STEPS}]\nreference = {{ n = 4, steps = {STEPS} }}\n",
        GAP[d - 2]
    ))
}

/// u and λ at all levels.
type Levels = Vec<(Vec<f64>, Vec<f64>)>;

fn levels(setup: &Setup, model: &Model, data: &MeshData, load: &mut dyn Load) -> Levels {
    let (grid, mut found) = (setup.grid(STEPS), Levels::new());
    march(&data.space, model, &grid, load, &Newton::default(), &mut |view| {
        found.push((view.u.to_vec(), view.multiplier.to_vec()));
        Ok(())
    })
    .unwrap_or_else(|error| panic!("{error}"));
    found
}

/// G(t) at the nodes: g on the bottom, whose normal is -e_y, and 0 on the top.
fn lift(space: &Discretization, t: f64) -> Vec<f64> {
    let at = |&vertex: &u32| {
        let place = space.mesh.point(&[vertex], &[1.0]);
        let mut of_node = vec![0.0; space.mesh.dimension];
        of_node[1] = -gap(place, t) * (1.0 - place[1]);
        of_node
    };
    space.nodes.vertex.iter().flat_map(at).collect()
}

/// The load of w.
struct Lifted<'a> {
    sound: TruthLoad<'a>,
    space: &'a Discretization,
    model: &'a Model,
    grid: TimeGrid,
}

impl Load for Lifted<'_> {
    fn assemble(&mut self, t: f64, out: &mut [f64]) -> Result<(), LoadError> {
        self.sound.assemble(t, out)?;
        let (space, rule) = (self.space, &self.model.time_rule);
        let n = (t * f64::from(STEPS)).round() as usize;
        let mut force = vec![0.0; out.len()];
        let mut take = |law, weight: f64, of: usize| {
            let lifted = lift(space, self.grid.time(of));
            space.pattern.multiply(&space.stiffness(law), &lifted[..force.len()], &mut force);
            out.iter_mut().zip(&force).for_each(|(out, f)| *out -= weight * f);
        };
        take(&self.model.elasticity, 1.0, n);
        for term in &self.model.memory {
            for j in 0..=n {
                let kernel = Convolution(&*term.kernel);
                take(&term.tensor, rule.kernel_weight(&kernel, &self.grid, n, j), j);
            }
        }
        Ok(())
    }
}

fn largest_difference(a: &Levels, b: &Levels) -> f64 {
    assert_eq!(a.len(), b.len());
    let numbers = |of: &Levels| -> Vec<f64> {
        of.iter().flat_map(|(u, lambda)| u.iter().chain(lambda).copied()).collect()
    };
    let (a, b) = (numbers(a), numbers(b));
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, algebra::linalg::larger)
}

#[test]
fn a_gap_that_moves_is_a_load_of_the_lifted_problem() {
    let quadratic = "[discretization]\nelement = \"P2\"";
    for (d, more, plan) in [
        (2, "", Plan::Condensed),
        (2, "friction = { bound = \"0.05\" }", Plan::Newton),
        (2, quadratic, Plan::Condensed),
        (3, "", Plan::Newton),
        (3, quadratic, Plan::Newton),
    ] {
        let setup = scene(d, more);
        let data = on_mesh(&setup, if d == 2 { 6 } else { 2 });
        let space = &*data.space;
        assert_eq!(Plan::of(space, &setup.model), plan, "{d} {more}");
        let moving = levels(&setup, &setup.model, &data, &mut TruthLoad(&*data.truth));
        let held: usize =
            moving.iter().flat_map(|(_, lambda)| lambda).filter(|l| **l > 0.0).count();
        let points = space.trace.points.len() * moving.len();
        assert!(0 < held && held < points, "{d} {more}: {held} of {points} points are locked");

        let mut model = setup.scene_model();
        model.boundary.first_mut().expect("contact").gap = Box::new(|_, _| 0.0);
        let (grid, sound) = (setup.grid(STEPS), TruthLoad(&*data.truth));
        let mut load = Lifted { sound, space, model: &setup.model, grid: grid.clone() };
        let mut lifted = levels(&setup, &model, &data, &mut load);
        for (n, (u, _)) in lifted.iter_mut().enumerate() {
            u.iter_mut().zip(lift(space, grid.time(n))).for_each(|(u, g)| *u += g);
        }
        let off = largest_difference(&moving, &lifted);
        assert!(off < EQUAL, "{d} {more}: {off:e}");
    }
}

/// The obstacle of the scene is reached everywhere and always; by the gap of another time little or nothing would be locked.
#[test]
fn the_locked_set_is_that_of_its_time() {
    let setup = setup("moving-obstacle-time");
    let found = errors(&setup, &setup.model, &on_mesh(&setup, 4), 4);
    let apart: Vec<f64> = found.iter().map(|errors| errors.contact_set).collect();
    assert_eq!(apart, [0.0; 5]);
}
