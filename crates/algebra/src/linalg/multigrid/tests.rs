//! Elasticity on Kuhn's tetrahedra of a box clamped at the top: along a path of edges the gradient of a P1 function is
//! its differences.

use super::super::conjugate_gradient::{Directions, conjugate_gradients};
use super::super::gmres::Preconditioned;
use super::super::jacobian::Jacobian;
use super::super::multigrid_sequence::MultigridSequence;
use super::super::signed_unit;
use super::super::tangent_solver::TangentSolver;
use super::*;

const PATHS: [[usize; 3]; 6] = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [1, 0, 2], [2, 1, 0]];

/// A box of counts cubes of unit side; nodes are numbered as vertices, free ones first.
struct Body {
    counts: [usize; 3],
    of_vertex: Vec<u32>,
    pattern: BlockPattern,
    values: Vec<f64>,
    coordinates: Vec<f64>,
}

fn vertex(counts: [usize; 3], at: [usize; 3]) -> usize {
    (at[2] * (counts[1] + 1) + at[1]) * (counts[0] + 1) + at[0]
}

fn lattice(counts: [usize; 3]) -> Vec<[usize; 3]> {
    let [a, b, c] = counts;
    (0..=c).flat_map(|l| (0..=b).flat_map(move |j| (0..=a).map(move |i| [i, j, l]))).collect()
}

impl Body {
    fn new(counts: [usize; 3], lambda: f64) -> Self {
        let points = lattice(counts);
        let clamped = |at: &[usize; 3]| at[1] == counts[1];
        let free: Vec<_> = points.iter().filter(|at| !clamped(at)).copied().collect();
        let mut of_vertex = vec![0; points.len()];
        let nodes = free.iter().chain(points.iter().filter(|at| clamped(at)));
        nodes.enumerate().for_each(|(node, &at)| of_vertex[vertex(counts, at)] = node as u32);
        let coordinates = free.iter().flatten().map(|&x| x as f64).collect();
        let mut cells = Vec::new();
        let corner = |at: &[usize; 3]| (0..3).all(|axis| at[axis] < counts[axis]);
        for start in points.iter().filter(|at| corner(at)) {
            for path in PATHS {
                let mut at = *start;
                cells.push(of_vertex[vertex(counts, at)]);
                for axis in path {
                    at[axis] += 1;
                    cells.push(of_vertex[vertex(counts, at)]);
                }
            }
        }
        let pattern = BlockPattern::new(&cells, 4, 3, free.len());
        let mut values = vec![0.0; pattern.entries()];
        let local = PATHS.map(|path| stiffness(path, lambda));
        for (c, nodes) in cells.chunks_exact(4).enumerate() {
            pattern.scatter::<3>(c, nodes, &local[c % 6], &mut values);
        }
        Self { counts, of_vertex, pattern, values, coordinates }
    }

    /// Levels down to an odd count, each halving the `axes`.
    fn levels(&self, axes: [bool; 3]) -> Levels {
        let (mut counts, mut all) = (self.counts, Vec::new());
        while counts.iter().zip(axes).all(|(count, halved)| !halved || count % 2 == 0) {
            let by = axes.map(|halved| if halved { 2 } else { 1 });
            let coarse = std::array::from_fn(|axis| counts[axis] / by[axis]);
            let parent = |at: [usize; 3], up: usize| {
                vertex(
                    coarse,
                    std::array::from_fn(|axis| (at[axis] + up * (by[axis] - 1)) / by[axis]),
                )
            };
            let parents = lattice(counts).into_iter();
            all.push(parents.map(|at| [0, 1].map(|up| parent(at, up) as u32)).collect());
            counts = coarse;
        }
        let levels =
            Levels::new(&self.pattern, &self.of_vertex, &all, &self.coordinates, Vec::new());
        levels.unwrap().unwrap()
    }

    fn free(&self, at: [usize; 3]) -> usize {
        self.of_vertex[vertex(self.counts, at)] as usize
    }

    /// Holds the normal unknown of the bottom vertices that `chosen` selects.
    fn hold(&mut self, chosen: impl Fn([usize; 3]) -> bool) -> Vec<usize> {
        let bottom = lattice(self.counts).into_iter().filter(|at| at[1] == 0 && chosen(*at));
        let held: Vec<usize> = bottom.map(|at| 3 * self.free(at) + 1).collect();
        let dofs: Vec<u32> = held.iter().map(|&dof| dof as u32).collect();
        for (_, position) in self.pattern.couplings(&dofs).into_iter().flatten() {
            self.values[position as usize] = 0.0;
        }
        held
    }
}

/// BᵀCB of a tetrahedron over 6 times its volume.
fn stiffness(path: [usize; 3], lambda: f64) -> Vec<f64> {
    let mut gradients = [[0.0; 3]; 4];
    for (step, axis) in path.into_iter().enumerate() {
        gradients[step][axis] -= 1.0;
        gradients[step + 1][axis] += 1.0;
    }
    let mut local = vec![0.0; 144];
    for (p, q) in (0..12).flat_map(|p| (0..12).map(move |q| (p, q))) {
        let ((g, i), (f, j)) = ((gradients[p / 3], p % 3), (gradients[q / 3], q % 3));
        let same = if i == j { g.iter().zip(f).map(|(g, f)| g * f).sum() } else { 0.0 };
        local[12 * p + q] = lambda * g[i] * f[j] + g[j] * f[i] + same;
    }
    local
}

struct Preconditioner<'s, C>(&'s Body, Multigrid<'s, C>);

impl<C: Parts> Preconditioned for Preconditioner<'_, C> {
    fn apply(&mut self, x: &[f64], out: &mut [f64]) {
        self.0.pattern.multiply(&self.0.values, x, out);
    }
    fn precondition(&mut self, x: &mut [f64]) {
        self.1.cycle(x);
    }
}

fn random(length: usize, mut seed: u64) -> Vec<f64> {
    (0..length).map(|_| signed_unit(&mut seed)).collect()
}

/// Iterations to a residual of 1e-8, the outcome, and |x·By - y·Bx| over √(x·Bx y·By).
fn trial<C: Parts>(
    body: &Body,
    levels: &Levels,
    held: &[usize],
    parts: C,
) -> (Result<u32, FactorError>, f64) {
    let order = body.pattern.order();
    let mut cycle = Multigrid::new(parts, levels, &body.pattern);
    if let Err(error) = cycle.set(&body.values, held) {
        return (Err(error), f64::NAN);
    }
    let mut both = Preconditioner(body, cycle);
    let [x, y] = [1, 2].map(|seed| random(order, seed));
    let [mut bx, mut by] = [x.clone(), y.clone()];
    both.precondition(&mut bx);
    both.precondition(&mut by);
    let product = |a: &[f64], b: &[f64]| super::super::dot(a, b);
    let size = (product(&x, &bx) * product(&y, &by)).sqrt();
    let skew = (product(&x, &by) - product(&y, &bx)).abs() / size;
    let (mut residual, mut solution) = (random(order, 3), vec![0.0; order]);
    for &dof in held {
        residual[dof] = 0.0;
    }
    let target = 1e-8 * super::super::norm(&residual);
    let vectors = &mut Directions::default();
    let outcome =
        conjugate_gradients(&mut both, &mut residual, &mut solution, target, 300, vectors);
    (outcome, skew)
}

/// Products of some thousand numbers of single precision, each rounded to 6e-8.
const SYMMETRIC: f64 = 1e-5;
/// V(1,1) gains a digit in two iterations, on any mesh.
const FEW: u32 = 18;

fn cube(n: usize) -> (Body, Levels) {
    let body = Body::new([n; 3], 1.0);
    let levels = body.levels([true; 3]);
    (body, levels)
}

#[test]
fn few_iterations_on_any_mesh_and_a_symmetric_cycle() {
    for n in [4, 8, 16] {
        let (mut body, levels) = cube(n);
        let (outcome, skew) = trial(&body, &levels, &[], Symmetric);
        assert!(outcome.unwrap() <= FEW && skew < SYMMETRIC);
        // A held zone with a boundary between coarse vertices, and single vertices.
        let held = body.hold(|[i, _, l]| 3 * i < n + 2 || (i * l) % 5 == 3);
        let (outcome, skew) = trial(&body, &levels, &held, Symmetric);
        assert!(outcome.unwrap() <= FEW && skew < SYMMETRIC);
    }
}

#[test]
fn axes_that_do_not_divide_stay() {
    let body = Body::new([8, 5, 8], 1.0);
    let (outcome, skew) = trial(&body, &body.levels([true, false, true]), &[], Symmetric);
    assert!(outcome.unwrap() <= FEW && skew < SYMMETRIC);
}

/// No post-smoothing.
struct OneSided;

impl Parts for OneSided {
    fn after<const D: usize>(&self, _: (&Sweeps, &BlockPattern), _: &mut Vectors) {}
}

/// Injection in place of Pᵀ.
struct Injected;

impl Parts for Injected {
    fn restrict<const D: usize>(&self, by: (&Transfer, &Turns), rest: &[f32], coarse: &mut [f32]) {
        for (out, &twin) in coarse.chunks_exact_mut(3).zip(&by.0.twins) {
            out.copy_from_slice(&rest[3 * twin as usize..3 * twin as usize + 3]);
        }
    }
}

#[test]
fn unsymmetric_parts_are_seen() {
    let (body, levels) = cube(8);
    let one_sided = trial(&body, &levels, &[], OneSided).1;
    let injected = trial(&body, &levels, &[], Injected).1;
    assert!(one_sided > 100.0 * SYMMETRIC && injected > 100.0 * SYMMETRIC);
}

#[test]
fn a_wrong_weight_costs_iterations() {
    let (body, mut levels) = cube(16);
    levels.transfers.iter_mut().for_each(|transfer| transfer.weight = 0.4);
    let wrong = trial(&body, &levels, &[], Symmetric).0;
    assert!(wrong.map_or(true, |count| count > FEW));
}

#[test]
fn held_unknowns_are_on_no_coarse_level() {
    let (mut body, levels) = cube(8);
    let held = body.hold(|[i, _, _]| i < 5);
    // Held equations are decoupled: coarse matrices must not depend on them.
    let coarse = |factor: f64, named: &[usize]| {
        let mut values = body.values.clone();
        held.iter().for_each(|&dof| values[body.pattern.diagonal(dof)] *= factor);
        let mut cycle = Multigrid::new(Symmetric, &levels, &body.pattern);
        cycle.set(&values, named).unwrap();
        cycle.values
    };
    assert_eq!(coarse(1.0, &held), coarse(3.0, &held));
    assert_ne!(coarse(1.0, &held[1..]), coarse(3.0, &held[1..]));
    // Solved exactly, and moved by no correction.
    let mut cycle = Multigrid::new(Symmetric, &levels, &body.pattern);
    cycle.set(&body.values, &held).unwrap();
    let mut x = random(body.pattern.order(), 4);
    let right: Vec<f64> = held.iter().map(|&dof| x[dof]).collect();
    cycle.cycle(&mut x);
    for (&dof, right) in held.iter().zip(right) {
        let exact = right / body.values[body.pattern.diagonal(dof)];
        assert!((x[dof] - exact).abs() <= 1e-6 * exact.abs());
    }
    // Leaving free unknowns out of coarse levels as well is worse.
    let more: Vec<usize> = (0..body.pattern.order()).filter(|dof| dof % 3 == 1).collect();
    assert!(trial(&body, &levels, &more, Symmetric).0.map_or(true, |count| count > FEW));
}

/// Negative on one entry, on a mode that only coarse levels see, and in between.
#[test]
fn a_matrix_that_is_not_positive_definite_is_an_error_on_every_scale() {
    for (reach, slope) in [(0, -30.0), (1, -3.0), (4, -1.5), (16, -0.3)] {
        let (mut body, levels) = cube(16);
        let centre = |at: [usize; 3]| at[0].abs_diff(8) <= reach && at[2].abs_diff(8) <= reach;
        for at in lattice(body.counts).into_iter().filter(|at| at[1] == 0 && centre(*at)) {
            let dof = 3 * body.free(at) + 1;
            body.values[body.pattern.diagonal(dof)] += 6.0 * slope;
        }
        let natural: Vec<f64> = body.coordinates.clone();
        let analysis =
            Analysis::new(&body.pattern, &nested_dissection(&body.pattern, &natural, &[])).unwrap();
        let mut factor = analysis.factor::<f64>();
        let direct =
            analysis.factorize(&body.pattern, &body.values, &mut factor, &mut analysis.workspace());
        let found = trial(&body, &levels, &[], Symmetric).0;
        assert!(matches!(direct, Err(FactorError::NotPositiveDefinite { .. })));
        assert!(matches!(found, Err(FactorError::NotPositiveDefinite { .. })));
    }
}

/// Squares of forces of 2^±600 are out of range. A power of two changes no digit.
#[test]
fn the_unit_of_force_is_of_no_account() {
    let (body, levels) = cube(8);
    let solved = |unit: f64| {
        let mut sequence = MultigridSequence::new(&levels, &body.pattern);
        let jacobian = Jacobian { values: body.values.clone(), ..Jacobian::default() };
        sequence.prepare(&jacobian, false).unwrap();
        let mut x: Vec<f64> = random(body.pattern.order(), 5).iter().map(|f| f * unit).collect();
        sequence.solve(&jacobian, &mut x, 1e-8).unwrap();
        x.iter().map(|u| u / unit).collect::<Vec<f64>>()
    };
    let ordinary = solved(1.0);
    assert!(ordinary.iter().any(|u| *u != 0.0));
    for exponent in [-600, 600] {
        assert_eq!(solved(2f64.powi(exponent)), ordinary, "forces of 2^{exponent}");
    }
}
