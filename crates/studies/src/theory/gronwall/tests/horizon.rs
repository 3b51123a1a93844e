//! Long horizons: uniform where the memory fades, e^{C2 T} where it does not.

use super::super::study::Bounded;
use super::super::*;
use super::subject;
use algebra::linalg::largest;
use judge::claim::Claim;
use scene::setup::Subject;

/// The largest error, weighted and primed envelope up to T = 4, 8, …, 64 at k = 1/8, and C2; the chain holds.
fn maxima(name: &str) -> ([[f64; 3]; 5], f64) {
    let mut scene = subject(name).scene().clone();
    scene.time.horizon = 64.0;
    let subject = Subject::new(scene).unwrap();
    let estimate = prepare(&subject, Some(4), &[512]).unwrap().measure(512).unwrap();
    let run = Bounded::new("time".into(), estimate).unwrap();
    assert!(Claim::all_hold(&run.claims(Some(4))));
    let of = [&run.estimate.error, &run.envelopes.weighted, &run.envelopes.primed];
    let upto = |horizon: usize| of.map(|values| largest(&values[..=8 * horizon]));
    ([4, 8, 16, 32, 64].map(upto), run.estimate.c2())
}

#[test]
fn a_fading_memory_keeps_error_and_weighted_envelope_uniform() {
    let (found, _) = maxima("long-fading");
    let ([first, bound, _], [last, weighted, primed]) = (found[0], found[4]);
    // The states differ from period to period by the phases of sin 2t on the grid alone.
    assert!(last < 1.01 * first && weighted < 1.01 * bound && weighted < 1.1 * last);
    // The bounds that know only ‖q‖ grow all the same: by e^{C2·32} from T = 32 to 64, within e^{1/4}.
    let growth = (primed / found[3][2]).ln() / 32.0;
    assert!((growth - 0.25).abs() < 0.25 / 32.0, "{growth}");
}

#[test]
fn a_memory_that_does_not_fade_makes_the_error_grow_like_the_envelope() {
    let (found, c2) = maxima("long-growing");
    let [error, _, primed] = found[4];
    // e_n solves the recurrence of the envelope up to directions and the sign of g_n.
    let growth = (error / found[3][0]).ln() / 32.0;
    assert!((growth - c2).abs() < 1e-3 && c2 == 0.25, "{growth}");
    assert!(primed < 1.01 * error);
}
