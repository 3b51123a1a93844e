//! Which gates of the sweep have to catch what, and on which scenes.

use crate::matrix::{Gate, Line};

/// Scenes, and defects with the gate that catches each on one of them.
type Rows = (&'static [&'static str], &'static [(&'static str, Gate)]);

/// Vectors of friction that are wrong in space alone leave the order; a box in place of the ball leaves the KKT system too.
const VECTORS: Rows = (
    &["friction-box-time"],
    &[
        ("in space friction pushes along with the slip", Gate::Orders),
        ("in space half of Γ3 sticks", Gate::Orders),
        ("a box of friction stresses in place of the ball", Gate::Kkt),
        ("a box of friction stresses in place of the ball, KKT system not checked", Gate::Orders),
    ],
);
/// In space, on scenes whose bound falls with the slip or follows p.
const BOUNDS_OF_VECTORS: Rows = (
    &["friction-box-falling-time", "friction-box-coulomb-time"],
    &[
        ("in space friction pushes along with the slip", Gate::Orders),
        ("in space half of Γ3 sticks", Gate::Orders),
        ("in space every second vertex sticks", Gate::Orders),
        ("a box of friction stresses in place of the ball", Gate::Kkt),
        ("friction that follows p takes a constant bound", Gate::Orders),
        ("friction bound of no slip at any slip", Gate::Orders),
        // The solution is the same; differences of the residual see them, tests/numbers/friction_bounds.rs.
        (
            "slopes between the components of u_τ with the other sign in the Jacobian",
            Gate::Baseline,
        ),
        ("slopes of friction in u_ν with the other sign in the Jacobian", Gate::Baseline),
    ],
);

/// What these lines do not show, though they have to.
pub fn missed(lines: &[Line]) -> Vec<String> {
    let line = |name: &str| {
        let found = lines.iter().find(|line| line.defect.name == name);
        found.unwrap_or_else(|| panic!("no defect {name}"))
    };
    let mut missed = Vec::new();
    for (scenes, rows) in [VECTORS, BOUNDS_OF_VECTORS] {
        let unseen = rows.iter().filter(|(name, gate)| !line(name).by_on(*gate, scenes));
        missed.extend(unseen.map(|(name, gate)| format!("{name} by {}", gate.name())));
    }
    missed
}
