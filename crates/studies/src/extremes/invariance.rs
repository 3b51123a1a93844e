//! Ladders of units: the nondimensional answer does not depend on them.

use super::UnderTest;
use super::answer::solve;
use super::rung::{Ladder, Measured, Relation, Rung, power_of_ten};
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

/// A ladder of units by their names, each with what it must show.
fn ladder(
    name: &'static str,
    parameter: &'static str,
    why: &'static str,
    scenes: &'static [Unitless],
    units: Vec<(String, Relation, Units)>,
) -> Ladder {
    let rung = |(label, expected, units): (String, Relation, Units)| {
        Rung::new(label, expected, move |under_test| difference(scenes, units, under_test))
    };
    Ladder {
        name,
        parameter,
        quantity: "change of the nondimensional answer",
        why,
        rungs: units.into_iter().map(rung).collect(),
    }
}

/// The powers of ten of one unit; at 1e±200 the scene is refused with the words `beyond`, where there are any.
fn powers(with: fn(f64) -> Units, beyond: Option<&'static str>) -> Vec<(String, Relation, Units)> {
    let end = |e: i32| beyond.map(|saying| (e, Relation::Refused(saying)));
    let inner = EXPONENTS.map(|e| (e, Relation::AtMost(INVARIANT)));
    let all = end(-200).into_iter().chain(inner).chain(end(200));
    all.map(|(e, expected)| (format!("1e{e}"), expected, with(power_of_ten(e)))).collect()
}

const WHY: &str =
    "(5.1)-(5.5) are invariant under a change of units; rounding times the condition number";

/// The unit of length, in the plane: in space n counts cells per unit length, which is then part of the mesh. Beyond
/// 1e±150 areas leave the doubles, and the scene is refused.
pub(crate) fn length() -> Ladder {
    let with = |length| Units { length, ..Units::default() };
    let units = powers(with, Some("outside 1e-150 to 1e150"));
    ladder("unit-length", "unit of length", WHY, &Unitless::PLANE, units)
}

/// The unit of stiffness; beyond 1e±152 squares of stresses leave the doubles.
pub(crate) fn stiffness() -> Ladder {
    let with = |stiffness| Units { stiffness, ..Units::default() };
    let units = powers(with, Some("the stiffest modulus"));
    ladder("unit-stiffness", "unit of stiffness", WHY, &Unitless::ALL, units)
}

/// The unit of time: nothing squares it.
pub(crate) fn time() -> Ladder {
    let with = |time| Units { time, ..Units::default() };
    ladder("unit-time", "unit of time", WHY, &Unitless::ALL, powers(with, None))
}

/// The unit of displacement; strains beyond 1e±152 are refused, subnormal ones among them.
pub(crate) fn displacement() -> Ladder {
    let with = |displacement| Units { displacement, ..Units::default() };
    let units = powers(with, Some("state the scene in other units"));
    ladder("unit-displacement", "unit of displacement", WHY, &Unitless::ALL, units)
}

/// All units at once, as programs in SI units meet them: from films to faults.
pub(crate) fn together() -> Ladder {
    let units = [
        ("nm", Units { length: 1e-9, stiffness: 1e9, time: 1e-9, displacement: 1e-12 }),
        ("mm", Units { length: 1e-3, stiffness: 1e6, time: 1.0, displacement: 1e-6 }),
        ("km", Units { length: 1e3, stiffness: 1e9, time: 3.2e7, displacement: 1.0 }),
        ("1e50", Units { length: 1e50, stiffness: 1e50, time: 1e50, displacement: 1e50 }),
    ];
    let units = units.map(|(label, units)| (label.into(), Relation::AtMost(INVARIANT), units));
    let parameter = "all units: nm GPa ns pm, mm MPa s µm, km GPa years m, 1e50 each";
    ladder("units", parameter, "as for each unit alone", &Unitless::PLANE, units.into())
}
