//! A scene as it is, on another mesh, other levels of refinement, another time grid: nothing that its prediction rests
//! on is touched, so a sound program must give the same verdict.

use gronwall::linalg::signed_unit;
use gronwall::scene::{Body, Direction, MeshFamily, Scene, TimeGrid};

/// Interior vertices move by at most this part of the mesh width in each coordinate. Over 128² squares the smallest
/// angle is then 17 degrees; the generator allows up to 0.25, where triangles turn over.
const LARGEST_AMPLITUDE: f64 = 0.2;

/// No finer mesh, so that 200 gates stay cheap; where there is one step, or a window of fine meshes, more is needed and
/// affordable.
const LARGEST_N: usize = 84;
const LARGEST_N_ASKED_FOR: usize = 128;

/// Histories of abstract scenes are direct sums, whose cost grows like N²; those of exact fields on a mesh are integrated
/// anew at every time that no other grid has.
const LARGEST_STEPS: usize = 1280;
const LARGEST_STEPS_OF_A_BODY: usize = 320;

/// What a scene's prediction needs of its numbers of steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Steps {
    /// Any levels, on any smooth grid.
    Any,
    /// Any levels of the grid that the scene names.
    OwnGrid,
    /// N = m 2^j: an event at T/3 keeps its place in its step, up to reflection.
    Doubled,
    /// These very numbers.
    Own,
}

/// The scenes whose prediction rests on a time grid, and why.
const BOUND_TO_THEIR_STEPS: [(&str, Steps, &str); 17] = [
    ("abstract-contact", Steps::Own, "events at any time: k² in the mean over many doublings"),
    ("abstract-random", Steps::Own, "errors scatter like 1/√N: order 2 in the mean of many"),
    ("affine-random", Steps::Own, "errors scatter like 1/√N: order 2 in the mean of many"),
    ("broken-m0-at", Steps::Own, "the error alternates, from an event at any time on"),
    ("broken-step", Steps::Own, "violates (3.4), which these steps do"),
    ("in-space", Steps::OwnGrid, "costs too much where no grid is part of the next"),
    (
        "pure-mild",
        Steps::OwnGrid,
        "its fewest steps are too few for grids that leave the end coarse",
    ),
    ("broken-body", Steps::OwnGrid, "k^{3/2} comes from the last step, not from the largest"),
    ("broken-body-end", Steps::OwnGrid, "asks for uniform grids"),
    ("broken-kernel", Steps::OwnGrid, "k^{3/2} comes from the last step, not from the largest"),
    ("broken-kernel-end", Steps::OwnGrid, "asks for uniform grids"),
    ("broken-kernel-grid", Steps::OwnGrid, "asks for the exponent 2"),
    ("broken-start", Steps::OwnGrid, "k^{3/2} comes from the first step, not from the largest"),
    ("broken-start-grid", Steps::OwnGrid, "asks for the exponent 2"),
    ("broken-jump", Steps::Doubled, "jump at T/3"),
    ("broken-kink", Steps::Doubled, "kink at T/3"),
    ("broken-zeta", Steps::Doubled, "kink of the rate of ζ at T/3"),
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
    scene.time.grid = match scene.time.grid {
        TimeGrid::Random { .. } => TimeGrid::Random { seed: draws.seed() },
        // Random steps scatter the error, which an order in k would have to average out.
        TimeGrid::Uniform if !in_time && draws.below(2) > 0 => {
            TimeGrid::Random { seed: draws.seed() }
        }
        own if freedom != Steps::Any || (own == TimeGrid::Uniform && draws.below(2) > 0) => own,
        _ => TimeGrid::Graded { exponent: draws.between(1.0, 2.5) },
    };
    let asymptotic = scene.window_n.map(|window| window[0]);
    let Some(sweep) = &mut scene.sweep else { return scene };
    if in_space {
        let dear = sweep.steps != [1] && asymptotic.is_none();
        let most = if dear { LARGEST_N } else { LARGEST_N_ASKED_FOR };
        sweep.n = levels(&mut draws, &sweep.n, asymptotic, true, most);
    } else if let [n] = sweep.n[..] {
        sweep.n = vec![(n as f64 * draws.between(0.75, 1.25)).round() as usize];
    }
    if in_time {
        if freedom != Steps::Own {
            // Contact and yielding set in at any time of a body: their place in a step makes errors oscillate, which
            // ratios below 2 magnify.
            let any_ratio = freedom != Steps::Doubled && sweep.n.is_empty();
            let most = if sweep.n.is_empty() { LARGEST_STEPS } else { LARGEST_STEPS_OF_A_BODY };
            sweep.steps = levels(&mut draws, &sweep.steps, None, any_ratio, most);
        }
    } else {
        // The time error must stay what it is beside the space error: no fewer steps than the scene has.
        let most = sweep.steps.iter().copied().max().unwrap_or(1);
        let steps = if most == 1 { 1.0 } else { most as f64 * draws.between(1.0, 1.25) };
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

/// Other levels in place of `own`, over the same span from a coarsest one drawn between the scene's and 5/4 of it (what
/// is coarser tells nothing, says the scene; `first`, where it says so by a window): with ratio 2, with 3/2, or with
/// ratios drawn anew. Where the finest would be too fine, ratios are small, so that there are five levels: of four, an interval has one degree of
/// freedom left for the scatter of meshes that are no refinements of each other.
fn levels(
    draws: &mut Draws,
    own: &[usize],
    first: Option<usize>,
    any_ratio: bool,
    largest: usize,
) -> Vec<usize> {
    let (low, high) = (first.unwrap_or(own[0]) as f64, own[own.len() - 1] as f64);
    let end = (1.25 * high).min(largest as f64);
    let family = if any_ratio { draws.below(3) } else { 0 };
    let narrow = end < 8.0 * 1.25 * low;
    // Whole, so that doubled levels are doubled exactly.
    let mut level = (low * draws.between(1.0, if narrow { 1.1 } else { 1.25 })).round();
    let mut found = vec![level as usize];
    loop {
        level *= match (family, any_ratio && narrow) {
            (0, false) => 2.0,
            (_, true) => draws.between(1.3, 1.42),
            (1, false) => 1.5,
            (_, false) => draws.between(1.3, 2.0),
        };
        if level > end {
            return found;
        }
        found.push(level.round() as usize);
    }
}
