//! `[contact]`: gap, shift and law at given displacements.

use fem::contact::BoundaryRule;
use formula::EvaluationPoint;
use scene::ContactQuadrature;
use scene::setup::Setup;
use vhi::law::Potential;

use super::{BLOCK, ORIGIN, Tie, block, near, value, with};

pub const TIES: &[Tie] = &[
    (&["contact.gap", "contact.shift"], gap_and_shift),
    (&["contact.bilateral"], bilateral),
    (&["contact.sides"], sides),
    (&["contact.quadrature"], quadrature),
    (&["discretization.element"], element),
    (&["contact.law.kind", "contact.law.stiffness"], linear),
    (
        &["contact.law.points", "contact.law.slope_before", "contact.law.slope_after"],
        piecewise_linear,
    ),
    (&["contact.law.length", "contact.law.jump"], decaying),
    (&["contact.law.coefficient", "contact.law.exponent", "contact.law.until"], power),
    (&["contact.law.scale"], scale),
    (
        &[
            "contact.friction.bound.kind",
            "contact.friction.bound.points",
            "contact.friction.bound.coefficient",
        ],
        friction,
    ),
];

fn with_contact(text: &str) -> Setup {
    crate::shipped::setup_of(with(BLOCK, &[("[contact]", &format!("[contact]\n{text}"))]))
}

/// ξ of the solver's law at u_ν, at a place of the contact side; and the exact side's numbers are the same.
#[track_caller]
fn law(text: &str, points: &[(f64, f64)]) {
    // The slope of an uneven law may not outdo the body's.
    let setup = with_contact(&format!("law = {{ {text} }}"));
    let boundary = setup.model.boundary.first().expect("a law");
    for &(r, exact) in points {
        let (low, high) = boundary.potential_at([0.3, 0.0, 0.0]).subdifferential(r);
        near(low, exact);
        near(high, exact);
    }
}

/// u_ν ≤ g and ξ ∈ p(u_ν - s), both at x = 0.25.
fn gap_and_shift() {
    let setup = with_contact(
        "gap = \"0.1 + x + t\"\nshift = \"0.02*x\"\nlaw = { kind = \"linear\", stiffness = 0.3 }",
    );
    let boundary = setup.model.boundary.first().expect("a boundary");
    near((boundary.gap)([0.25, 0.0, 0.0], 0.5), 0.85);
    near((boundary.shift)([0.25, 0.0, 0.0]), 0.005);
    let contact = setup.body.contact.first().expect("a contact");
    let at = EvaluationPoint { x: 0.25, ..ORIGIN };
    near(value(&setup.scene, contact.gap.expect("a gap"), at), 0.35);
    near(value(&setup.scene, contact.shift.expect("a shift"), at), 0.005);
}

/// u_ν = 0 at the free vertices of the contact side, three unknowns of the block with two squares a side.
fn bilateral() {
    let [without, with] = ["", "bilateral = true"].map(|key| {
        let space = with_contact(key).space(2).expect("a mesh");
        space.supports.len()
    });
    assert_eq!([without, with], [0, 3]);
}

/// A law on the left, a gap on the bottom.
fn sides() {
    let tables = "[[contact]]\nsides = [\"left\"]\nlaw = { kind = \"linear\", stiffness = 0.3 }\n[[contact]]\nsides = [\"bottom\"]\ngap = \"0.1\"";
    let setup = crate::shipped::setup_of(with(
        BLOCK,
        &[
            ("[\"left\", \"right\"]", "[\"right\"]"),
            ("contact = [\"bottom\"]", "contact = [\"bottom\", \"left\"]"),
            ("[contact]", tables),
        ],
    ));
    let mesh = setup.body.domain.mesh(2);
    for (side, pressure, gap) in [("left", 0.06, f64::INFINITY), ("bottom", 0.0, 0.1)] {
        let boundary = setup.model.boundary_on(mesh.side(side).expect("a side")).expect("contact");
        near(boundary.potential_at([0.0; 3]).subdifferential(0.2).0, pressure);
        assert_eq!((boundary.gap)([0.0; 3], 0.0), gap);
    }
}

fn quadrature() {
    for (word, read, built) in [
        ("vertex", ContactQuadrature::Vertex, BoundaryRule::Vertex),
        ("gauss", ContactQuadrature::Gauss, BoundaryRule::Gauss),
        ("exact", ContactQuadrature::Exact, BoundaryRule::Exact),
    ] {
        let setup = with_contact(&format!(
            "quadrature = \"{word}\"\nlaw = {{ kind = \"linear\", stiffness = 0.3 }}"
        ));
        assert_eq!(setup.body.contact.first().expect("a contact").quadrature, read);
        assert_eq!(setup.model.boundary.first().expect("a boundary").rule, built);
    }
}

/// Unknowns of 2 × 2 squares below a clamped top: nodes at the vertices, and at the midpoints of edges.
fn element() {
    let written = crate::shipped::text("quadratic-elastic");
    for (line, nodes) in [("element = \"P1\"", 9 - 3), ("element = \"P2\"", 25 - 5), ("", 9 - 3)] {
        let setup = crate::shipped::setup_of(with(&written, &[("element = \"P2\"", line)]));
        assert_eq!(setup.space(2).expect("a mesh").dofs(), 2 * nodes, "{line}");
    }
}

fn linear() {
    law("kind = \"linear\", stiffness = 0.3", &[(0.2, 0.06), (-0.2, -0.06)]);
    let none = block(&[("[contact]", "[contact]\nlaw = { kind = \"none\" }")]);
    let body = none.as_contact().expect("a body");
    assert!(body.contact.first().expect("a contact").law.is_none());
}

/// Slope 0.2 up to (0.1, 0.01), 0.5 up to (0.3, 0.11), then 0.4.
fn piecewise_linear() {
    law(
        "kind = \"piecewise-linear\", points = [[0.1, 0.01], [0.3, 0.11]], slope_before = 0.2, slope_after = 0.4",
        &[(0.0, -0.01), (0.1, 0.01), (0.2, 0.06), (0.3, 0.11), (0.5, 0.19)],
    );
}

/// s r/(1 + (r/l)²) and s r exp(-r/l), the second after a jump.
fn decaying() {
    law("kind = \"rational\", stiffness = 0.3, length = 0.2", &[(0.4, 0.12 / 5.0), (-0.1, 0.0)]);
    let exponential = 0.3 * 0.4 * (-2.0f64).exp();
    law("kind = \"exponential\", stiffness = 0.3, length = 0.2", &[(0.4, exponential)]);
    law(
        "kind = \"exponential\", stiffness = 0.3, length = 0.2, jump = 0.01",
        &[(0.4, 0.01 + exponential), (-0.1, 0.0)],
    );
}

/// 0.5 r^1.5 up to 0.25, then the tangent 0.0625 + 0.375 (r - 0.25).
fn power() {
    law(
        "kind = \"power\", coefficient = 0.5, exponent = 1.5, until = 0.25",
        &[(0.16, 0.032), (0.25, 0.0625), (0.35, 0.1)],
    );
}

/// c(x) p(r) with c = 1 + x at x = 0.5.
fn scale() {
    let setup = with_contact("law = { kind = \"linear\", stiffness = 0.3, scale = \"1 + x\" }");
    let boundary = setup.model.boundary.first().expect("a law");
    near(boundary.scale_at([0.5, 0.0, 0.0]), 1.5);
    near(boundary.potential_at([0.5, 0.0, 0.0]).subdifferential(0.2).0, 0.09);
}

/// S(x, t) = 0.1 x (1 + t); from 0.3 at rest to 0.28 at a slip of 0.1, constant beyond; 0.4 p whatever the slip. Each on both
/// sides of u_τ = 0, where the interval lies between them.
fn friction() {
    type Row<'a> = (&'a str, f64, &'a [(f64, f64)]);
    let law = "law = { kind = \"linear\", stiffness = 0.0 }\n[contact.friction]";
    let slip = "bound = { kind = \"slip\", points = [[0.0, 0.3], [0.1, 0.28]] }";
    let coulomb = "bound = { kind = \"coulomb\", coefficient = \"0.4\" }";
    let rows: [Row; 3] = [
        ("bound = \"0.1*x*(1 + t)\"", 0.0, &[(0.0, 0.1), (0.02, 0.1)]),
        (slip, 0.2, &[(0.0, 0.3), (0.05, 0.29), (0.4, 0.28)]),
        (coulomb, 0.0, &[(0.0, 0.2), (0.02, 0.2), (0.3, 0.2)]),
    ];
    for (bound, alpha, points) in rows {
        let setup = with_contact(&format!("{law}\n{bound}"));
        let friction = setup.model.friction.as_ref().expect("friction");
        // A pressure of 0.5, which the first two do not follow.
        let law = friction.at([0.5, 0.0, 0.0], 1.0, 0.5);
        near(law.alpha(), alpha);
        for &(slip, stress) in points {
            let ahead = law.subdifferential(slip);
            let back = law.subdifferential(-slip);
            near(ahead.1, stress);
            near(back.0, -stress);
            near(ahead.0, if slip == 0.0 { -stress } else { stress });
            near(back.1, -ahead.0);
        }
    }
}
