//! A scene as it is, on another mesh, other levels of refinement, another time grid: nothing that its prediction rests
//! on is touched, so a sound program must give the same verdict.

use algebra::linalg::signed_unit;
use scene::{Body, Direction, MeshFamily, Scene, TimeGrid, TimeRule};

/// Interior vertices move by at most this part of the mesh width in each coordinate. At 0.2 the smallest angle over 128²
/// squares is 17 degrees; the generator allows up to 0.25, where triangles turn over. Meshes of different levels are
/// unrelated, so that errors scatter, and the interval of few of them is rightly wider than a verdict admits: half as
/// much for four levels as for five, and half of that for three.
fn largest_amplitude(levels: usize) -> f64 {
    match levels {
        5.. => 0.2,
        4 => 0.1,
        _ => 0.05,
    }
}

/// Levels are those of the scene times a common factor below this: less than a level further on.
const LARGEST_SHIFT: f64 = 1.25;

/// Coarser levels than this are not shifted: rounding would change their ratios by more than a tenth.
const COARSEST_SHIFTED: u32 = 4;

/// What a scene's prediction needs of its time grid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Steps {
    /// Shifted levels, on any smooth grid.
    Any,
    /// Shifted levels of the grid that the scene names.
    OwnGrid,
    /// These very numbers.
    Own,
}

/// The scenes whose prediction rests on a time grid, and why.
const BOUND_TO_THEIR_STEPS: [(&str, Steps, &str); 22] = [
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
    (
        "broken-jump",
        Steps::OwnGrid,
        "jump at T/3, which doubled steps of equal length keep in its place",
    ),
    ("broken-kink", Steps::OwnGrid, "kink at T/3"),
    ("zone-appears-in-time", Steps::Own, "an event at any time: the error scatters between levels"),
    ("moving-load", Steps::Own, "its reference run has a multiple of these steps"),
    ("singular-start", Steps::OwnGrid, "the order is that of equal steps"),
    ("singular-graded", Steps::OwnGrid, "asks for the exponent 1/(1 - a)"),
    ("singular-contact", Steps::OwnGrid, "asks for the exponent 1/(1 - a) at least"),
    ("broken-zeta", Steps::OwnGrid, "kink of the rate of ζ at T/3"),
];

/// Scenes whose exact histories depend on x and t alone: where vertices keep their x, there are as many of them as there
/// are columns, and not as many as there are points, which costs a hundred times as much.
const KEEP_COLUMNS: [&str; 11] = [
    "broken-gap",
    "compliance",
    "law-exponential",
    "law-jump",
    "law-power",
    "law-rational",
    "law-scaled",
    "pure-mild",
    "pure-strong",
    "signorini",
    "sourced",
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

/// Levels of the prediction in h that has the fewest.
fn levels_in_h(scene: &Scene) -> usize {
    let Some(sweep) = &scene.sweep else { return 0 };
    let counted = |window: Option<[u32; 2]>| match window {
        Some([first, last]) => sweep.n.iter().filter(|&&n| first <= n && n <= last).count(),
        None => sweep.n.len(),
    };
    let in_h = scene.predicts.iter().filter(|p| p.variable != Direction::K);
    in_h.map(|p| counted(p.window_n.or(scene.window_n))).min().unwrap_or(sweep.n.len())
}

/// The scene of run `seed`.
pub fn perturbed(mut scene: Scene, seed: u64) -> Scene {
    let mut draws = Draws::new(seed, &scene.name);
    let bound = BOUND_TO_THEIR_STEPS.iter().find(|(name, ..)| *name == scene.name);
    // Gregory's corrections by differences mean nothing on unequal steps, and a scene file with both is refused.
    let equal = matches!(scene.time.rule, TimeRule::Gregory { .. });
    let free = if equal { Steps::OwnGrid } else { Steps::Any };
    let freedom = bound.map_or(free, |(_, freedom, _)| *freedom);
    let in_time = scene.predicts.iter().any(|p| p.variable != Direction::H);
    let levels = levels_in_h(&scene);
    let mut own_mesh = false;
    if let Body::Contact(body) = &mut scene.body {
        // A reference run needs nested meshes, regions mesh lines on their boundaries; a graded mesh is the question.
        let nests = scene.sweep.as_ref().is_some_and(|sweep| sweep.reference.is_some());
        let graded = matches!(body.domain.mesh, MeshFamily::Graded { .. });
        own_mesh = nests || graded || !body.material.regions.is_empty();
        // One run in four keeps the structured mesh.
        if draws.below(4) > 0 && !own_mesh {
            let amplitude = draws.between(0.02, largest_amplitude(levels));
            let axes =
                if KEEP_COLUMNS.contains(&&*scene.name) { [false, true, false] } else { [true; 3] };
            body.domain.mesh = MeshFamily::Perturbed { amplitude, seed: draws.seed(), axes };
        }
    }
    scene.time.grid = match scene.time.grid {
        TimeGrid::Random { .. } => TimeGrid::Random { seed: draws.seed() },
        // Random steps scatter the error, which an order in k would have to average out.
        TimeGrid::Uniform if !in_time && !equal && draws.below(2) > 0 => {
            TimeGrid::Random { seed: draws.seed() }
        }
        grid if freedom != Steps::Any || (grid == TimeGrid::Uniform && draws.below(2) > 0) => grid,
        _ => TimeGrid::Graded { exponent: draws.between(1.0, 2.5) },
    };
    let Some(sweep) = &mut scene.sweep else { return scene };
    // Of levels 3, 4 and 6 a shifted copy has other ratios.
    let own_levels = own_mesh || sweep.n.first().is_some_and(|&n| n < COARSEST_SHIFTED);
    let n = if own_levels { sweep.n.clone() } else { shifted(&mut draws, &sweep.n) };
    let moved = |[first, last]: [u32; 2]| {
        // A window of levels means the same levels, shifted.
        let at = |value: u32| {
            let levels = sweep.n.iter().zip(&n);
            levels
                .min_by_key(|(level, _)| level.abs_diff(value))
                .map_or(value, |(_, &shifted)| shifted)
        };
        [at(first), at(last)]
    };
    scene.window_n = scene.window_n.map(moved);
    for prediction in &mut scene.predicts {
        prediction.window_n = prediction.window_n.map(moved);
    }
    sweep.n = n;
    if in_time && freedom != Steps::Own {
        sweep.steps = shifted(&mut draws, &sweep.steps);
    }
    scene
}

/// `levels` times a common factor: ratios stay, to rounding, and doubled levels are doubled exactly.
fn shifted(draws: &mut Draws, levels: &[u32]) -> Vec<u32> {
    let Some(&first) = levels.first() else { return Vec::new() };
    let coarsest = (f64::from(first) * draws.between(1.0, LARGEST_SHIFT)).round();
    levels
        .iter()
        .map(|&level| (coarsest * f64::from(level) / f64::from(first)).round() as u32)
        .collect()
}
