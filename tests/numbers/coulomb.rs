//! Source: -σ_τ ∈ S ∂|u_τ| with S = μ_f p(u_ν); the sharp form of (2.9) for it, docs/CONTACT-LAWS.md.
//! Goal: the entries of the Jacobian are differences of the residual; the constants bound what they must. Wrong bounds: docs/SABOTAGE.md.
//! Mesh: n × n squares cut from lower left to upper right.
//! Data: friction-coulomb.

use crate::judged::{errors, foreseen};
use crate::shipped::{edited, on_mesh, refusal, setup, setup_of, text};
use algebra::linalg::signed_unit;
use fem::contact::Evolution;
use scene::setup::{Coulomb, Setup, Subject, TruthLoad, constants};
use scene::{Direction, Norm};
use vhi::{BoundaryGraph, HistoryInequality, StepInequality};

/// Unbalanced forces at u, each graph on the side of its jump where u is.
fn force(level: &mut Evolution<'_>, u: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; u.len()];
    level.residual(u, &mut out);
    let graph = level.graph();
    for (i, coordinate) in graph.coordinates.iter().enumerate() {
        out[coordinate.dof as usize] +=
            coordinate.sign * coordinate.weight * pressure(graph, i, u).0;
    }
    out
}

fn pressure(graph: &BoundaryGraph, i: usize, u: &[f64]) -> (f64, f64) {
    let normal = graph.normal(i, u);
    let jumps = graph.potentials[graph.coordinates[i].law as usize].jumps();
    graph.value_and_slope(i, jumps.iter().filter(|jump| normal > **jump).count(), normal)
}

/// What the Jacobian makes of a state in which vertices slip both ways.
pub struct Slipping {
    /// ‖J⁻¹(F(u + s d) - F(u - s d))/2s - d‖/‖d‖ with the pressures of the pieces, and without.
    pub off: [f64; 2],
    pub pressures: Vec<f64>,
    /// Slopes of the pieces times their weights.
    pub slopes: Vec<f64>,
}

/// Of a scene on n = 4, with one coordinate prescribed or none.
pub fn slipping(setup: &Setup, pinned: Option<usize>) -> Slipping {
    const STEP: f64 = 1e-7;
    let (data, grid) = (on_mesh(setup, 4), setup.grid(4));
    let mut load = TruthLoad(&*data.truth);
    let mut level =
        Evolution::new(&data.space, &setup.model, &grid, &mut load).expect("an analysis");
    level.open().expect("a level");
    let free = &data.space.nodes.vertex[..data.space.nodes.free];
    let at = |&v: &u32| -> [f64; 2] {
        let (x, y) = (data.space.mesh.vertex(v)[0], data.space.mesh.vertex(v)[1]);
        [(1.0 - y) * 0.05 * (x - 0.4), -(1.0 - y) * (0.012 + 0.06 * x)]
    };
    let u: Vec<f64> = free.iter().flat_map(at).collect();
    let mut seed = 5;
    let d: Vec<f64> = u.iter().map(|_| signed_unit(&mut seed)).collect();
    let moved =
        |sign: f64| -> Vec<f64> { u.iter().zip(&d).map(|(u, d)| u + sign * STEP * d).collect() };
    let (plus, minus) = (force(&mut level, &moved(1.0)), force(&mut level, &moved(-1.0)));
    let right: Vec<f64> = plus.iter().zip(&minus).map(|(p, m)| (p - m) / (2.0 * STEP)).collect();
    force(&mut level, &u);
    let graph = level.graph();
    let piece = |i: usize| {
        let (value, slope) = pressure(graph, i, &u);
        (value, graph.coordinates[i].weight * slope)
    };
    let (pressures, slopes): (Vec<f64>, Vec<f64>) = (0..graph.coordinates.len()).map(piece).unzip();
    let mut prescribed = vec![None; slopes.len()];
    if let Some(i) = pinned {
        prescribed[i] = Some(d[graph.coordinates[i].dof as usize]);
    }
    let off = [&pressures[..], &vec![0.0; slopes.len()]].map(|pressures| {
        let mut x = right.clone();
        level.take_pressures(pressures);
        level.linearize(&slopes, &prescribed).expect("a positive definite tangent");
        level.solve(&mut x, 1e-12).expect("a solve");
        let size = |v: &mut dyn Iterator<Item = f64>| v.map(|v| v * v).sum::<f64>().sqrt();
        size(&mut x.iter().zip(&d).map(|(x, d)| x - d)) / size(&mut d.iter().copied())
    });
    Slipping { off, pressures, slopes }
}

/// With vertices that slip both ways on both branches of p, and one whose u_ν is prescribed; not without the entries.
#[test]
fn the_jacobian_has_the_slopes_in_u_nu() {
    let setup = setup("friction-coulomb");
    for pinned in [None, Some(2)] {
        let Slipping { off: [whole, part], pressures, slopes } = slipping(&setup, pinned);
        let half = slopes.len() / 2;
        let both = [f64::lt as fn(&f64, &f64) -> bool, f64::gt];
        assert!(both.iter().all(|is| pressures[half..].iter().any(|s| is(s, &0.0))));
        assert!(both.iter().all(|is| slopes[..half].iter().any(|s| is(s, &0.0))));
        // Rounding 1e-16/1e-7 times a condition of 1e2.
        assert!(whole < 1e-6 && part > 1e-2, "{pinned:?}: {whole} {part}");
    }
}

/// q a² - μ_f |q||a||b| + A a² + B b² ≥ 0 for every slope q of p, and no smaller multiple of A and B does it.
#[test]
fn the_constants_bound_what_they_must() {
    for (alpha, rise, mu) in [(0.5, 2.0, 0.4), (0.0, 2.0, 0.4), (0.5, 0.1, 0.3), (1.2, 0.0, 0.2)] {
        let (c_nu, c_tau) = (1.0, 6.444);
        let law = Coulomb { coefficient: mu, rise };
        let [a, b] = law.coefficients(alpha, c_nu, c_tau);
        let worst = |share: f64| {
            let mut least = f64::INFINITY;
            for q in (0..=100).map(|i| -alpha + (rise + alpha) * f64::from(i) / 100.0) {
                for angle in (0..=4000).map(|i| f64::from(i) * std::f64::consts::FRAC_PI_2 / 4e3) {
                    let (y, x) = angle.sin_cos();
                    let form = q * x * x - mu * q.abs() * x * y;
                    least = least.min(form + share * (a * x * x + b * y * y));
                }
            }
            least
        };
        assert!(worst(1.0) > -1e-9 && worst(0.98) < 0.0, "{alpha} {rise} {mu}: {}", worst(1.0));
        // Young's inequality with the constants as they are printed is worse.
        let printed = alpha * c_nu + mu * rise.max(alpha) * f64::sqrt(c_nu * c_tau);
        assert!(a * c_nu + b * c_tau <= printed + 1e-12);
    }
    // c_ν² = 1 and c_τ² = 6.444 (scipy): 2 - (0.5 + 0.125) - 0.04 · 2/2 ... of μ = 0.3 is 1.08, of 0.4 it is 0.86.
    let found = constants(&setup("friction-coulomb")).expect("constants");
    assert!((found.m0 - (2.0 - 0.625 - 0.08 * 6.444)).abs() < 1e-3, "{}", found.m0);
    let falls = found.alpha_nu * found.c_nu_squared + found.alpha_tau * found.c_tau_squared;
    let printed = found.m_elastic - falls - (found.alpha_phi_as_printed() - found.alpha_phi);
    assert!((printed - (2.0 - 0.5 - 0.8 * 6.444f64.sqrt())).abs() < 1e-3, "{printed}");
    // (2.9) as it is printed, with α_φ of all of φ: μ = 0 here, and 0.7 in a body that may yield.
    assert_eq!(
        found.m_a - found.alpha_phi_as_printed() - found.alpha_nu * found.c_j_squared,
        printed
    );
    let yields = edited(
        &text("friction-coulomb"),
        "[contact]\n",
        "[material.projection]\nmu = 0.7\nkappa = \"1\"\n[contact]\n",
    );
    let found = constants(&setup_of(yields)).expect("constants");
    let whole = found.alpha_phi_as_printed();
    assert!((whole - (0.7 + 0.8 * 6.444f64.sqrt())).abs() < 1e-3, "{whole}");
}

/// The predicted error in time of a scene on n = 8 with 64 steps.
fn in_time(scene: &str) -> f64 {
    let subject = Subject::Contact(Box::new(setup_of(scene.into())));
    foreseen(&subject, (Norm::VTimeMax, Direction::K, 2.0), Some(8), &[64]).points[0].error
}

/// The predicted error in time counts what friction answers to u_ν: with the bound as a formula, which answers
/// nothing, it is another one.
#[test]
fn the_constant_in_time_counts_the_bound_that_follows() {
    let written = text("friction-coulomb");
    let follows = "{ kind = \"coulomb\", coefficient = \"0.4\" }";
    let given = edited(&written, follows, "\"0.4*2*0.012*(1 + t)*(1 + cos(pi*x)/2)\"");
    let setup = setup_of(written.clone());
    let error = errors(&setup, &on_mesh(&setup, 8), 8, 64, &[Norm::VTimeMax])[0];
    let [sound, deaf] = [&written, &given].map(|scene| (in_time(scene) / error - 1.0).abs());
    // What is left of the expansion in k is of the size k²: some 1e-3 at k = 1/64 here.
    assert!(sound < 1.5e-3 && deaf > 3e-3, "{sound:e} {deaf:e}");
}

#[test]
fn what_is_wrong_is_refused() {
    let bound = "{ kind = \"coulomb\", coefficient = \"0.4\" }";
    let law = "[0.10, 0.05]], slope_before = 0.0, slope_after = 0.0";
    let pieces = "kind = \"piecewise-linear\", points = [[0.0, 0.0], [0.04, 0.08], [0.10, 0.05]], slope_before = 0.0, slope_after = 0.0";
    for (from, to, words) in [
        (bound, "{ kind = \"coulomb\", coefficient = \"0.8\" }", "A c_nu^2 + B c_tau^2 ="),
        (bound, "{ kind = \"coulomb\", coefficient = \"-0.1\" }", "coefficient"),
        (bound, "{ kind = \"coulomb\", coefficient = \"x\" }", "`x`"),
        (bound, "{ kind = \"coulomb\" }", "coefficient = \"0.3\""),
        (bound, "{ kind = \"coulomb\", coefficient = \"0.4\", points = [[0.0, 1.0]] }", "points"),
        (bound, "{ kind = \"slip\", coefficient = \"0.4\", points = [[0.0, 1.0]] }", "coefficient"),
        (law, "[0.04, 0.09], [0.10, 0.05]], slope_before = 0.0, slope_after = 0.0", "a jump"),
        (law, "[0.10, 0.05]], slope_before = 0.0, slope_after = -0.1", "is negative for some"),
        (pieces, "kind = \"rational\", stiffness = 2.0, length = 0.1", "a curved law"),
        (pieces, "kind = \"none\"", "without a normal law"),
        ("quadrature = \"vertex\"", "quadrature = \"gauss\"", "from the vertices"),
    ] {
        let said = refusal(edited(&text("friction-coulomb"), from, to));
        assert!(said.contains(words), "{to}: {said}");
    }
}
