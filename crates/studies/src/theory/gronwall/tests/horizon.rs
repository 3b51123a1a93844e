//! Long horizons: uniform where the memory fades, e^{C2 T} where it does not.

use super::super::horizon::horizons;
use super::super::*;
use super::subject;
use scene::setup::Subject;

const HORIZONS: [f64; 5] = [4.0, 8.0, 16.0, 32.0, 64.0];

#[test]
fn a_fading_memory_keeps_error_and_weighted_envelope_uniform() {
    let found = horizons(&subject("long-fading"), Some(4), 0.125, &HORIZONS).unwrap();
    assert!(found.judged.violations.is_empty());
    let (first, last) = (&found.rows[0], &found.rows[4]);
    // The states differ from period to period by the phases of sin 2t on the grid alone.
    assert!(last.error < 1.01 * first.error && last.bounds.weighted < 1.01 * first.bounds.weighted);
    assert!(last.bounds.weighted < 1.1 * last.error);
    // The bounds that know only ‖q‖ grow all the same: by e^{C2·32} from T = 32 to 64, within e^{1/4}.
    let growth = (last.bounds.primed / found.rows[3].bounds.primed).ln() / 32.0;
    assert!((growth - 0.25).abs() < 0.25 / 32.0, "{growth}");
}

#[test]
fn a_memory_that_does_not_fade_makes_the_error_grow_like_the_envelope() {
    let found = horizons(&subject("long-growing"), Some(4), 0.125, &HORIZONS).unwrap();
    assert!(found.judged.violations.is_empty());
    let last = &found.rows[4];
    // e_n solves the recurrence of the envelope up to directions and the sign of g_n.
    assert!((last.growth.unwrap() - last.c2).abs() < 1e-3 && last.c2 == 0.25, "{:?}", last.growth);
    assert!(last.bounds.primed < 1.01 * last.error);
    // Shorter horizons are beginnings of the same run.
    let short = horizons(&subject("long-growing"), Some(4), 0.125, &[4.0]).unwrap();
    let same = short.rows[0].error / found.rows[0].error - 1.0;
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
    assert!(matches!(error, GronwallError::NotUniform { .. }));
}
