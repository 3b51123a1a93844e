//! Ladders of units: the nondimensional answer does not depend on them.

use super::UnderTest;
use super::answer::solve;
use super::rung::{Expected, Ladder, Measured, Rung, power_of_ten};
use super::units::{Unitless, Units};
use algebra::linalg::larger;

/// Scaling by a power of ten rounds every number of a scene, ε/2 each, and every operation on it; the condition
/// number of the scenes on n = 4 is about 10 n² = 160, which leaves a factor of 30 to 1e-12.
pub const INVARIANT: f64 = 1e-12;

/// Exponents of the units.
const EXPONENTS: [i32; 10] = [-150, -100, -50, -10, -1, 1, 10, 50, 100, 150];

/// The largest relative difference of the answer in `units` to that in units of 1, nondimensional, over `scenes`.
fn difference(
    scenes: &[Unitless],
    units: Units,
    under_test: &UnderTest<'_>,
) -> Result<Measured, super::answer::Unanswered> {
    let mut worst: Option<Measured> = None;
    for scene in scenes {
        let run = |units: Units| {
            let answer = solve(scene.text(&units), 4, 4, under_test.prepare)?;
            Ok::<_, super::answer::Unanswered>(units.nondimensional(answer, scene.dimension()))
        };
        let (found, known) = (run(units)?, run(Units::default())?);
        let here = Measured::of(found.distance(&known), &found).noted(scene.name());
        let before = worst.as_ref().map_or(-1.0, |worst| worst.value);
        if larger(here.value, before) != before {
            worst = Some(here);
        }
    }
    Ok(worst.unwrap_or_else(|| Measured::number(f64::NAN)))
}

fn ladder(
    name: &'static str,
    parameter: &'static str,
    scenes: &'static [Unitless],
    exponents: &[i32],
    refused: fn(i32) -> Option<&'static str>,
    with: fn(f64) -> Units,
) -> Ladder {
    let rung = |&e: &i32| {
        let expected = refused(e).map_or(Expected::AtMost(INVARIANT), Expected::Refused);
        Rung::new(format!("1e{e}"), expected, move |under_test: &UnderTest<'_>| {
            difference(scenes, with(power_of_ten(e)), under_test)
        })
    };
    Ladder {
        name,
        parameter,
        quantity: "change of the nondimensional answer",
        why: "(5.1)-(5.5) are invariant under a change of units; rounding times the condition number",
        rungs: exponents.iter().map(rung).collect(),
    }
}

const PLANE: &[Unitless] = &Unitless::PLANE;
const ALL: &[Unitless] = &Unitless::ALL;

/// The unit of length, in the plane: in space n counts cells per unit length, which is then part of the mesh. Beyond
/// 1e±150 areas leave the doubles, and the scene is refused.
pub(crate) fn length() -> Ladder {
    let with = |length| Units { length, ..Units::default() };
    let refused = |e: i32| (e.abs() > 150).then_some("outside 1e-150 to 1e150");
    ladder("unit-length", "unit of length", PLANE, &with_ends(200), refused, with)
}

/// The unit of stiffness; beyond 1e±152 squares of stresses leave the doubles.
pub(crate) fn stiffness() -> Ladder {
    let with = |stiffness| Units { stiffness, ..Units::default() };
    let refused = |e: i32| (e.abs() > 150).then_some("the stiffest modulus");
    ladder("unit-stiffness", "unit of stiffness", ALL, &with_ends(200), refused, with)
}

/// The unit of time: nothing squares it.
pub(crate) fn time() -> Ladder {
    let with = |time| Units { time, ..Units::default() };
    ladder("unit-time", "unit of time", ALL, &EXPONENTS, |_| None, with)
}

/// The unit of displacement; strains beyond 1e±152 are refused, subnormal ones among them.
pub(crate) fn displacement() -> Ladder {
    let with = |displacement| Units { displacement, ..Units::default() };
    let refused = |e: i32| (e.abs() > 150).then_some("state the scene in other units");
    ladder("unit-displacement", "unit of displacement", ALL, &with_ends(200), refused, with)
}

/// The exponents, and one beyond them at either end.
fn with_ends(end: i32) -> Vec<i32> {
    let inner = EXPONENTS.into_iter();
    std::iter::once(-end).chain(inner).chain([end]).collect()
}

/// All units at once, as programs in SI units meet them: from films to faults.
pub(crate) fn together() -> Ladder {
    let cases: [(&str, Units); 4] = [
        ("nm", Units { length: 1e-9, stiffness: 1e9, time: 1e-9, displacement: 1e-12 }),
        ("mm", Units { length: 1e-3, stiffness: 1e6, time: 1.0, displacement: 1e-6 }),
        ("km", Units { length: 1e3, stiffness: 1e9, time: 3.2e7, displacement: 1.0 }),
        ("1e50", Units { length: 1e50, stiffness: 1e50, time: 1e50, displacement: 1e50 }),
    ];
    let rung = |(label, units): (&str, Units)| {
        Rung::new(label, Expected::AtMost(INVARIANT), move |under_test| {
            difference(PLANE, units, under_test)
        })
    };
    Ladder {
        name: "units",
        parameter: "all units: nm GPa ns pm, mm MPa s µm, km GPa years m, 1e50 each",
        quantity: "change of the nondimensional answer",
        why: "as for each unit alone",
        rungs: cases.map(rung).into(),
    }
}
