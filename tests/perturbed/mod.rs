//! A scene as it is, on another mesh, other levels of refinement, another time grid: nothing that its prediction rests
//! on is touched, so a sound program must give the same verdict.

use gronwall::linalg::signed_unit;
use gronwall::scene::{Body, Direction, MeshFamily, Norm, Scene, TimeGrid};

/// Interior vertices move by at most this part of the mesh width in each coordinate. Over 128² squares the smallest
/// angle is then 17 degrees; the generator allows up to 0.25, where triangles turn over.
const LARGEST_AMPLITUDE: f64 = 0.2;

/// No finer mesh, so that 200 gates stay cheap; one step more costs little.
const LARGEST_N: usize = 72;
const LARGEST_STEADY_N: usize = 128;

/// Histories of abstract scenes are direct sums: their cost grows like N².
const LARGEST_STEPS: usize = 1024;

/// What a scene's prediction needs of its numbers of steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Steps {
    /// Any levels, on any grid.
    Any,
    /// Any levels of the grid that the scene names.
    OwnGrid,
    /// N = m 2^j: an event at T/3 keeps its place in its step, up to reflection.
    Doubled,
    /// These very numbers.
    Own,
}

/// The scenes whose prediction rests on a time grid, and why.
const BOUND_TO_THEIR_STEPS: [(&str, Steps, &str); 13] = [
    ("abstract-contact", Steps::OwnGrid, "events: k² in the mean, the largest step says nothing"),
    ("abstract-graded", Steps::OwnGrid, "asks for graded grids"),
    ("affine-graded", Steps::OwnGrid, "asks for graded grids"),
    ("broken-body", Steps::OwnGrid, "k^{3/2} comes from the last step, not from the largest"),
    ("broken-body-end", Steps::OwnGrid, "asks for uniform grids"),
    ("broken-kernel", Steps::OwnGrid, "k^{3/2} comes from the last step, not from the largest"),
    ("broken-start", Steps::OwnGrid, "k^{3/2} comes from the first step, not from the largest"),
    ("broken-m0-at", Steps::OwnGrid, "the error alternates from step to step"),
    ("broken-jump", Steps::Doubled, "jump at T/3"),
    ("broken-kink", Steps::Doubled, "kink at T/3"),
    ("broken-zeta", Steps::Doubled, "kink of the rate of ζ at T/3"),
    ("affine-kink", Steps::Doubled, "kink at T/3"),
    ("broken-step", Steps::Own, "violates (3.4), which these steps do"),
];

/// Seeded numbers.
pub struct Draws(u64);

impl Draws {
    /// The draws of one run for one scene: scenes that come or go leave the others' draws alone.
    pub fn new(seed: u64, name: &str) -> Self {
        // FNV-1a of the name.
        let start = 0xcbf2_9ce4_8422_2325 ^ seed.wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let fold = |state: u64, byte: u8| (state ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        Self(name.bytes().fold(start, fold))
    }

    /// A number in [lo, hi).
    pub fn between(&mut self, lo: f64, hi: f64) -> f64 {
        lo + (hi - lo) * 0.5 * (signed_unit(&mut self.0) + 1.0)
    }

    /// One of `count`.
    pub fn below(&mut self, count: usize) -> usize {
        (self.between(0.0, count as f64) as usize).min(count - 1)
    }

    /// Seeds of meshes and grids, small enough to be written into a scene file.
    fn seed(&mut self) -> u64 {
        self.below(1_000_000) as u64
    }
}

/// The scene of run `seed`.
pub fn perturbed(mut scene: Scene, seed: u64) -> Scene {
    let mut draws = Draws::new(seed, &scene.name);
    let bound = BOUND_TO_THEIR_STEPS.iter().find(|(name, ..)| *name == scene.name);
    let freedom = bound.map_or(Steps::Any, |(_, freedom, _)| *freedom);
    let in_space = scene.predicts.iter().any(|p| p.variable != Direction::K);
    let in_time = scene.predicts.iter().any(|p| p.variable != Direction::H);
    if let Body::Contact(body) = &mut scene.body {
        // One run in four keeps the structured mesh.
        if draws.below(4) > 0 {
            let amplitude = draws.between(0.02, LARGEST_AMPLITUDE);
            body.domain.mesh = MeshFamily::Perturbed { amplitude, seed: draws.seed() };
        }
    }
    // The time error is measured against a grid that contains the case's, as random grids do not.
    let nested = scene.predicts.iter().any(|p| p.norm == Norm::VTimeMax);
    let any_grid = scene.time.grid == TimeGrid::Uniform && freedom == Steps::Any && !nested;
    let random = any_grid && draws.below(2) > 0;
    if random || matches!(scene.time.grid, TimeGrid::Random { .. }) {
        scene.time.grid = TimeGrid::Random { seed: draws.seed() };
    }
    let asymptotic = scene.window_n.map(|window| window[0]);
    let Some(sweep) = &mut scene.sweep else { return scene };
    let dear = sweep.steps != [1] && asymptotic.is_none();
    if in_space {
        let largest = if dear { LARGEST_N } else { LARGEST_STEADY_N };
        sweep.n = levels(&mut draws, &sweep.n, asymptotic, true, largest);
    } else if let [n] = sweep.n[..] {
        sweep.n = vec![(n as f64 * draws.between(0.75, 1.25)).round() as usize];
    }
    if in_time && freedom != Steps::Own {
        let any_ratio = freedom != Steps::Doubled;
        // Random steps scatter: few of them have no order yet.
        let first = random.then_some(16.max(sweep.steps[0]));
        sweep.steps = levels(&mut draws, &sweep.steps, first, any_ratio, LARGEST_STEPS);
    } else if !in_time {
        // The time error must stay what it is beside the space error: no fewer steps than the scene has.
        let most = sweep.steps.iter().copied().max().unwrap_or(1);
        let steps = if most == 1 { 1.0 } else { most as f64 * draws.between(1.0, 1.5) };
        sweep.steps = vec![steps.round() as usize];
    }
    let n = sweep.n.clone();
    for prediction in &mut scene.predicts {
        // A window of one mesh means: on some mesh.
        if let Some([first, last]) = prediction.window_n
            && first == last
            && let Some(&near) = n.iter().min_by_key(|n| n.abs_diff(first))
        {
            prediction.window_n = Some([near, near]);
        }
    }
    scene
}

/// Other levels in place of `own`: scaled by a drawn factor, with the ratio of the scene, with 3/2, or with ratios drawn
/// anew between 1.3 and 2; from `first` on where the scene says that coarser ones tell nothing.
fn levels(
    draws: &mut Draws,
    own: &[usize],
    first: Option<usize>,
    any_ratio: bool,
    largest: usize,
) -> Vec<usize> {
    let (low, high) = (own[0], own[own.len() - 1]);
    let start = match first {
        Some(first) => first as f64 * draws.between(1.0, 1.25),
        None => low as f64 * draws.between(0.75, 1.25),
    };
    let start = start.round().max(1.0);
    let most = own.len().max(4);
    let family = if any_ratio { draws.below(3) } else { 0 };
    let end = (high as f64 * 1.25).min(largest as f64);
    let (mut found, mut level) = (vec![start as usize], start);
    // A level more for narrow ratios: what counts is the span.
    while found.len() < most + usize::from(family > 0) {
        level *= match family {
            0 => 2.0,
            1 => 1.5,
            _ => draws.between(1.3, 2.0),
        };
        if level > end {
            break;
        }
        found.push(level.round() as usize);
    }
    found
}
