//! Fields with known integrals and regularity on a triangle and on an L shape.

use std::sync::Arc;

use super::*;
use crate::check::check;
use crate::{ContactFormulas, ExactData, MaterialNumbers};
use fem::mesh::{Face, Piece, triangulate};
use formula::{Graph, Scope, Variable};

const TRIANGLE: [[f64; 2]; 3] = [[1.0, 0.5], [3.0, 1.0], [1.5, 2.5]];
const L_SHAPE: [[f64; 2]; 6] =
    [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];

/// u on a polytope, contact on its first edge, clamped on its last; with ζ in κ if `yields`.
fn exact(vertices: &[[f64; 2]], u: [&str; 2], yields: bool) -> Exact {
    let count = vertices.len() as u32;
    let sides: Vec<u32> = (0..count).collect();
    let names = sides.iter().map(u32::to_string).collect();
    let triangles = triangulate(vertices).unwrap();
    let coarse = CoarseMesh::polygon(vertices, &triangles, &sides, names).unwrap();
    let mut graph = Graph::new();
    let scope = Scope::new(&[Variable::X, Variable::Y, Variable::T]);
    let u = u.map(|text| graph.parse(text, &scope).expect("a formula")).to_vec();
    let in_zeta = Scope::new(&[Variable::Zeta]);
    let kappa = yields.then(|| graph.parse("0.1 + zeta", &in_zeta).expect("a formula"));
    let projection = yields.then_some(1.0);
    let material =
        MaterialNumbers { lambda: 1.3, mu_l: 0.7, full: None, memory: Vec::new(), projection };
    let [low, high] = coarse.bounds();
    let size = vec![high[0] - low[0], high[1] - low[1]];
    let polytope = Some(Arc::new(coarse));
    let (regions, kernels) = (Vec::new(), Vec::new());
    let (horizon, contact) = (1.0, vec![ContactFormulas::default()]);
    Exact::new(ExactData {
        graph,
        u,
        material,
        regions,
        inner: Vec::new(),
        kernels,
        kappa,
        contact,
        horizon,
        size,
        polytope,
    })
}

fn coarse(exact: &Exact) -> &CoarseMesh {
    exact.data.polytope.as_ref().unwrap()
}

fn findings(exact: &Exact) -> Vec<Finding> {
    let pieces = coarse(exact).pieces();
    let last = pieces.iter().map(|piece| piece.side).max();
    let face = |piece: &Piece| BodyFace {
        side: piece.side,
        face: Face::simplex(piece),
        clamped: Some(piece.side) == last,
        contact: piece.side == 0,
    };
    check(exact, &pieces.iter().map(face).collect::<Vec<_>>())
}

/// The status of the first finding on a subject.
fn status_of(exact: &Exact, subject: &str) -> Status {
    let findings = findings(exact);
    findings.iter().find(|f| f.subject.starts_with(subject)).expect(subject).status
}

#[test]
fn loads_agree_and_a_wrong_force_or_normal_is_seen() {
    let u = ["t*sin(x)*y^2", "x*exp(-t)*cos(y)"];
    for vertices in [&TRIANGLE[..], &L_SHAPE] {
        let mut solution = exact(vertices, u, false);
        assert_eq!(status_of(&solution, "loads"), Status::Verified);
        let other = exact(vertices, ["1.001*t*sin(x)*y^2", u[1]], false);
        solution.forces = other.forces;
        assert_eq!(status_of(&solution, "loads"), Status::Failed);
    }
    // A reversed normal.
    let mut solution = exact(&L_SHAPE, u, false);
    let coarse = solution.data.polytope.as_mut().unwrap();
    let normal = &mut Arc::make_mut(coarse).facets[1].normal;
    *normal = normal.map(|component| -component);
    assert_eq!(status_of(&solution, "loads"), Status::Failed);
}

#[test]
fn zeta_over_a_triangle_is_the_closed_form() {
    // ε = t (1, 0, 0), so ‖ε‖ = t √|Ω| and ζ(t) = t² √|Ω| / 2.
    let solution = exact(&TRIANGLE, ["t*x", "0"], true);
    let area = 0.5 * (2.0 * 2.0 - 0.5 * 0.5);
    assert!((solution.data.measure() - area).abs() < 1e-15);
    let expected = 0.5 * 0.64 * area.sqrt();
    // The integral in time is adaptive, to 1e-12.
    assert!((solution.zeta.at(0.8) - expected).abs() < 1e-12);
    let status = |u: [&str; 2]| {
        let solution = exact(&L_SHAPE, u, true);
        zeta(&solution, coarse(&solution)).unwrap().status
    };
    assert_eq!(status(["t*sin(3*x)*y", "t*x*cos(4*y)"]), Status::Verified);
    assert_eq!(status(["t*abs(x - 0.37)", "0"]), Status::Verified, "|eps| is constant");
    // Strips are cut along y at kinks, but not along slanted lines.
    assert_eq!(status(["t*max(x - 0.37, 0)", "t*max(y - 0.21, 0)"]), Status::Verified);
    assert_eq!(status(["t*max(x + y/3 - 0.37, 0)", "0"]), Status::Weak);
    let without = exact(&L_SHAPE, ["t*x", "0"], false);
    assert!(zeta(&without, coarse(&without)).is_none());
}

#[test]
fn a_corner_singularity_is_told_from_a_smooth_field() {
    let status = |u: [&str; 2]| {
        let solution = exact(&L_SHAPE, u, false);
        ["u in H2", "u_nu in H2"].map(|subject| status_of(&solution, subject))
    };
    let smooth = ["t*x^2*y", "t*sin(x + y)"];
    assert_eq!(status(smooth), [Status::Verified; 2]);
    // r^0.3 at the re-entrant corner.
    let singular = ["0", "t*((x - 1)^2 + (y - 1)^2)^0.15"];
    assert_eq!(status(singular)[0], Status::Weak);
    // A kink of u_ν along the contact edge y = 0.
    assert_eq!(status(["0", "t*abs(x - 0.61)*(2 - y)"])[1], Status::Weak);
}
