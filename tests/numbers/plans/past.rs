//! Recursive, interpolated and direct sums over the past, for every scene whose kernels and rule have all three.

use scene::setup::{MeshData, Setup};
use vhi::history::{Memory, TimeRule, Trapezoid};

use super::{AGREE, Run, distance, same_bits, shortest};
use crate::shipped::bodies;
use crate::wrong::{Rule, see_kernels};

/// Steps from which on interpolation pays with any number of nodes, and some.
const STEPS: u32 = 520;

/// The coarsest mesh of a scene: sums over the past are the same for every number of unknowns.
fn coarsest(setup: &Setup) -> MeshData {
    let data = [1, 2, 4, 6, 8].into_iter().find_map(|n| MeshData::new(setup, n, None).ok());
    data.unwrap_or_else(|| panic!("{} has no mesh", setup.scene.name))
}

/// Whether all terms of the memory are summed in a way.
fn all_are(setup: &Setup, way: fn(&Memory) -> bool) -> bool {
    let (grid, rule) = (setup.grid(STEPS), &*setup.model.time_rule);
    setup.model.memory.iter().all(|term| way(&Memory::new(&*term.kernel, rule, &grid, 1)))
}

/// What a scene has by all ways, `None` where a way does not apply: recursion, interpolation, direct sums.
pub fn by_all_ways(mut setup: Setup) -> [Option<Run>; 3] {
    let data = coarsest(&setup);
    let recursion = all_are(&setup, |memory| matches!(memory, Memory::Recursive { .. }));
    let recursive = recursion.then(|| shortest(&setup, &data, STEPS));
    // Kernels that do not say what they are a sum of.
    see_kernels(&mut setup.model, |b, lag| b.value(lag));
    let interpolation = all_are(&setup, |memory| matches!(memory, Memory::Fast(_)));
    // Every kernel of a shipped scene is smooth enough away from zero lag.
    assert_eq!(interpolation, setup.model.time_rule.is_trapezoidal(), "{}", setup.scene.name);
    let fast = interpolation.then(|| shortest(&setup, &data, STEPS));
    if interpolation {
        // The same weights under a name that does not promise them: sums over the past are direct.
        setup.model.time_rule = Box::new(Rule::of(|grid, n, j| Trapezoid.weight(grid, n, j)));
    }
    assert!(all_are(&setup, |memory| matches!(memory, Memory::Direct { .. })));
    [recursive, fast, Some(shortest(&setup, &data, STEPS))]
}

#[test]
#[ignore = "seconds for each scene: make test-long"]
fn long_all_sums_over_the_past_have_the_same_solution() {
    let (mut recursive, mut interpolated, mut direct_alone) = (0, 0, Vec::new());
    for setup in bodies().filter(|setup| !setup.model.memory.is_empty()) {
        let name = setup.scene.name.clone();
        let [recursion, fast, direct] = by_all_ways(setup);
        let direct = direct.expect("direct sums apply to all scenes");
        let Some(fast) = fast else {
            direct_alone.push(name);
            continue;
        };
        let bytes = |run: &Run| run.info.peak_history_bytes;
        let agree = |way: &str, other: &Run, least: usize, most: usize| {
            let off = distance(&direct, other);
            assert!(off <= AGREE, "{name} {way}: {off:e}");
            // Way by way less is kept, and rounding is another.
            assert!((least..most).contains(&bytes(other)), "{name} {way}: {}", bytes(other));
            assert!(!same_bits(&direct, other), "{name} {way}");
        };
        agree("interpolation", &fast, 1, bytes(&direct));
        interpolated += 1;
        if let Some(recursion) = &recursion {
            agree("recursion", recursion, 1, bytes(&fast));
            recursive += 1;
        }
    }
    // The scenes with another rule than the trapezoidal one.
    let other_rules = [
        "broken-body-end",
        "graded-end",
        "gregory-four",
        "gregory-four-start",
        "gregory-three",
        "left-rule",
        "left-rule-graded",
        "product-integrated",
        "product-integrated-graded",
        "quadratic-compliance",
        "quadratic-friction",
        "quadratic-memory",
        "short-memory-body",
        "short-memory-time",
        "singular-contact",
        "symmetry-quadratic",
    ];
    assert_eq!(direct_alone, other_rules);
    assert!(recursive >= 40 && interpolated > recursive, "{recursive} {interpolated}");
}
