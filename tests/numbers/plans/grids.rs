//! The plan of a scene, Newton's method in the volume and fresh factors on other grids: graded and random steps,
//! on which last weights change from level to level. Shipped scenes on equal steps see neither a last weight that stays
//! nor a factor that does.

use scene::setup::Setup;

use fem::contact::Plan;

use super::anew::Anew;
use super::past::by_all_ways;
use super::{AGREE, distance, in_volume, run, shortest};
use crate::shipped::{edited, on_mesh, setup, setup_of, text};

const STEPS: u32 = 12;

/// Grids whose steps differ: by a factor 23 from first to last, by 3 at random.
const GRIDS: [scene::TimeGrid; 3] = [
    scene::TimeGrid::Graded { exponent: 2.0 },
    scene::TimeGrid::Random { seed: 7 },
    scene::TimeGrid::Random { seed: 8 },
];

/// Memory that is no multiple of the elasticity: factors follow the last weight.
fn no_multiple(name: &str) -> Setup {
    let other = edited(&text(name), "lambda = 0.25\nmu = 0.25", "lambda = 0.9\nmu = 0.3");
    setup_of(other)
}

/// Scenes of every plan, with factors that serve all levels and with factors of a level.
fn of_all_plans() -> [(Setup, Plan); 6] {
    [
        (setup("linear-punch"), Plan::Linear),
        (setup("elastic-punch"), Plan::Condensed),
        (no_multiple("elastic-punch"), Plan::Condensed),
        (no_multiple("linear-punch"), Plan::Linear),
        (setup("signorini"), Plan::Condensed),
        (setup("punch"), Plan::Newton),
    ]
}

#[test]
fn all_plans_agree_on_unequal_steps() {
    let mut anew = 0;
    for (mut setup, expected) in of_all_plans() {
        let data = on_mesh(&setup, 6);
        let name = setup.scene.name.clone();
        for grid in GRIDS {
            setup.scene.time.grid = grid;
            let plan = Plan::of(&data.space, &setup.model);
            assert_eq!(plan, expected, "{name}");
            let short = shortest(&setup, &data, STEPS);
            let fresh = run(&setup, &data, STEPS, &Anew::default());
            for (way, other) in [("plan", &short), ("volume", &in_volume(&setup, &data, STEPS))] {
                let off = distance(&fresh, other);
                assert!(off <= AGREE, "{name} {grid:?} {way}: {off:e}");
            }
            if plan != Plan::Newton && Plan::changes_factor(&setup.model) {
                // Level 0 has no weight; each of the others has another one.
                assert_eq!(short.info.work.linear.factorizations, STEPS + 1, "{name} {grid:?}");
                anew += 1;
            }
        }
    }
    assert_eq!(anew, 2 * GRIDS.len());
}

#[test]
fn all_sums_over_the_past_agree_on_unequal_steps() {
    for name in ["linear-punch", "elastic-punch", "punch"] {
        for grid in GRIDS {
            let mut setup = setup(name);
            setup.scene.time.grid = grid;
            let [recursive, fast, direct] = by_all_ways(setup);
            let direct = direct.expect("direct sums apply to all scenes");
            for (way, other) in [("recursion", recursive), ("interpolation", fast)] {
                let off = distance(&direct, &other.expect("the trapezoidal rule"));
                assert!(off <= AGREE, "{name} {grid:?} {way}: {off:e}");
            }
        }
    }
}
