//! Long horizons: uniform where the memory fades, e^{C2 T} where it does not.

use super::super::study::{horizon_rows, horizons};
use super::super::*;
use super::subject;
use judge::claim::Claim;
use scene::setup::Subject;

const HORIZONS: [f64; 5] = [4.0, 8.0, 16.0, 32.0, 64.0];

/// Horizon, error, weighted and primed envelope, C2 and growth of each row; the chain holds on every horizon.
fn rows(name: &str, of: &[f64]) -> Vec<[f64; 6]> {
    let (_, runs) = horizons(&subject(name), Some(4), 0.125, of).unwrap();
    assert!(runs.iter().all(|run| Claim::all_hold(&run.claims(Some(4)))));
    let value = |row: &serde_json::Value, key: &str| row[key].as_f64().unwrap_or(f64::NAN);
    let keys = ["horizon", "error", "weighted", "primed", "c2", "growth"];
    horizon_rows(&runs).iter().map(|row| keys.map(|key| value(row, key))).collect()
}

#[test]
fn a_fading_memory_keeps_error_and_weighted_envelope_uniform() {
    let found = rows("long-fading", &HORIZONS);
    let ([_, first, bound, ..], [_, last, weighted, primed, ..]) = (found[0], found[4]);
    // The states differ from period to period by the phases of sin 2t on the grid alone.
    assert!(last < 1.01 * first && weighted < 1.01 * bound && weighted < 1.1 * last);
    // The bounds that know only ‖q‖ grow all the same: by e^{C2·32} from T = 32 to 64, within e^{1/4}.
    let growth = (primed / found[3][3]).ln() / 32.0;
    assert!((growth - 0.25).abs() < 0.25 / 32.0, "{growth}");
}

#[test]
fn a_memory_that_does_not_fade_makes_the_error_grow_like_the_envelope() {
    let found = rows("long-growing", &HORIZONS);
    let [horizon, error, _, primed, c2, growth] = found[4];
    // e_n solves the recurrence of the envelope up to directions and the sign of g_n.
    assert!(horizon == 64.0 && (growth - c2).abs() < 1e-3 && c2 == 0.25, "{growth}");
    assert!(primed < 1.01 * error);
    // Shorter horizons are beginnings of the same run.
    let short = rows("long-growing", &[4.0]);
    let same = short[0][1] / found[0][1] - 1.0;
    assert!(same.abs() < 1e-9, "{same}");
}

#[test]
fn horizons_are_whole_steps_on_a_uniform_grid() {
    let refused =
        |k, horizon: f64| horizons(&subject("long-fading"), Some(4), k, &[horizon]).err().unwrap();
    for (k, horizon) in [(0.3, 1.0), (0.25, 0.1), (0.25, -1.0), (0.25, f64::NAN)] {
        assert!(matches!(refused(k, horizon), GronwallError::Horizon { .. }), "{k} {horizon}");
    }
    let Subject::Contact(mut graded) = subject("long-fading") else { panic!("a body") };
    graded.scene.time.grid = scene::TimeGrid::Graded { exponent: 2.0 };
    let error = horizons(&Subject::Contact(graded), Some(4), 0.25, &[1.0]).err().unwrap();
    assert!(error.to_string().contains("need a uniform grid"), "{error}");
}
