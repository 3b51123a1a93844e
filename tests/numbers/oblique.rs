//! Source: rotations leave the problem (5.1)-(5.5) and its discrete form as they are.
//! Goal: contact sides whose normals are no axes. Turned vertices, formulas, gap and loads give the same errors, to rounding, from
//!   the file to the records; a wrong normal gives others.
//! Mesh, data: the scenes of tests/turned: all terms, all three boundary rules, contact on one side or on two that meet.

use crate::turned::{Kind, Normals, difference, records, text};

/// Errors are differences of fields a hundred times as large, which agree to 1e-11 and better; formulas in turned
/// coordinates round their arguments.
const OF_ERRORS: f64 = 1e-9;

#[test]
fn a_turned_scene_file_has_the_same_errors() {
    for kind in Kind::ALL {
        let straight = records(&text(kind, 0.0), None);
        for angle in [0.3, 2.0, -2.2, std::f64::consts::FRAC_PI_2, 5.1] {
            let records = records(&text(kind, angle), None);
            let (off, what) = difference(&straight, &records);
            assert!(off < OF_ERRORS, "{kind:?} {angle}: {what}");
        }
    }
}

/// A normal that is negated, not turned, or turned by too little is another problem, in every kind of scene.
#[test]
fn a_wrong_normal_of_a_scene_is_seen() {
    type Wrong = fn([f64; 2]) -> [f64; 2];
    let defects: [Wrong; 3] =
        [|[x, y]| [-x, -y], |_| [0.0, -1.0], |[x, y]| [x - 1e-3 * y, y + 1e-3 * x]];
    for kind in Kind::ALL {
        let straight = records(&text(kind, 0.0), None);
        for (d, defect) in defects.into_iter().enumerate() {
            // A corner of two sides has two normals, which must stay two.
            if kind == Kind::Loaded && d == 1 {
                continue;
            }
            let scheme = std::sync::Arc::new(Normals(defect));
            let records = records(&text(kind, 0.3), Some(scheme));
            let (off, what) = difference(&straight, &records);
            assert!(off > 1e3 * OF_ERRORS, "{kind:?}, defect {d}: {what}");
        }
    }
}
