//! Noise that is told: errors scatter by at most so much.
//!
//! How much less they scatter nobody knows, and the answer has to hold for every noise of a list up to the one that is told.
//! A larger one adds answers to those of a smaller one: no interval becomes narrower, no verdict surer or another. The list
//! is one for all tables; a noise between two of it is rounded up.

use super::Posterior;

/// The noises of a decade: one that is rounded up is at most doubled.
const DIGITS: [f64; 4] = [1.0, 2.0, 3.0, 5.0];
/// Where the list begins: at 1e-15, below the rounding of numbers.
const FIRST: i32 = -60;
/// A noise leaves where a larger one explains the table a thousand times better, by this logarithm.
const CONTRADICTED: f64 = 6.9;

fn listed(at: i32) -> f64 {
    DIGITS[at.rem_euclid(4) as usize] * 10f64.powi(at.div_euclid(4))
}

/// The place of a noise in the list; what differs by rounding is equal.
fn place(noise: f64) -> i32 {
    (FIRST..).find(|at| listed(*at) * (1.0 + 1e-9) >= noise).unwrap_or(FIRST)
}

/// Posteriors for all noises of the list from the least that the table does not contradict to `noise`. The list begins at
/// `least`, and is compared up to `seen`. Several posteriors are of one table, with one evidence.
pub(crate) fn up_to<const N: usize, E>(
    noise: f64,
    [least, seen]: [f64; 2],
    of: impl Fn(f64) -> Result<[Posterior; N], E>,
) -> Result<[Posterior; N], E> {
    let [least, seen, told] = [least, seen, noise.max(least)].map(place);
    let all = (least..=seen.max(told)).map(|at| of(listed(at))).collect::<Result<Vec<_>, E>>()?;
    let compared: Vec<f64> =
        all[..=(seen - least) as usize].iter().map(|of| of[0].evidence).collect();
    let stands = |at: &usize| compared[*at..].iter().all(|e| *e <= compared[*at] + CONTRADICTED);
    let first = (0..compared.len()).find(stands).unwrap_or_default();
    let last = first.max((told - least) as usize);
    Ok(std::array::from_fn(|i| {
        let kept = || all[first..=last].iter().map(|of| &of[i]);
        let interval = kept().fold(all[last][i].interval, |hull, of| hull.hull(of.interval));
        let mut less: Vec<_> = kept().map(|of| Posterior { interval, ..of.clone() }).collect();
        Posterior { less: less.drain(..last - first).collect(), ..less.remove(0) }
    }))
}
