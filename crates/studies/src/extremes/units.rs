//! Units of length, stiffness, time and displacement, and scenes written in them.

use super::UnderTest;
use super::bodies::SceneText;
use super::rung::{Ladder, Measured, Relation, Rung, SceneAnswer, power_of_ten, solve};
use algebra::linalg::larger;

/// The units in which a scene is written: a number of the scene is its nondimensional value times the
/// unit of its dimension. Strains are small, so displacements are not measured in the unit of length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Units {
    /// Unit of x.
    pub length: f64,
    /// Unit of 𝒜, ℬ₀ and μ.
    pub stiffness: f64,
    /// Unit of t.
    pub time: f64,
    /// Unit of u and g.
    pub displacement: f64,
}

impl Default for Units {
    fn default() -> Self {
        Self { length: 1.0, stiffness: 1.0, time: 1.0, displacement: 1.0 }
    }
}

impl Units {
    /// The unit of strains and κ.
    pub(crate) fn strain(&self) -> f64 {
        self.displacement / self.length
    }

    /// The unit of stresses and pressures.
    pub(crate) fn stress(&self) -> f64 {
        self.stiffness * self.strain()
    }

    /// Of f0, which is not formed from unit to unit where an intermediate one overflows.
    pub(crate) fn body_force(&self) -> f64 {
        self.stress() / self.length
    }

    /// Of ζ = ∫‖ε‖: a strain times a length to the power d/2 times a time.
    pub(crate) fn zeta(&self, dimension: i32) -> f64 {
        self.strain() * self.length.powf(0.5 * f64::from(dimension)) * self.time
    }

    /// An answer with its fields in these units.
    pub fn nondimensional(&self, mut answer: SceneAnswer, dimension: i32) -> SceneAnswer {
        let divide = |field: &mut Vec<f64>, unit: f64| field.iter_mut().for_each(|v| *v /= unit);
        divide(&mut answer.displacement, self.displacement);
        divide(&mut answer.stress, self.stress());
        divide(&mut answer.pressure, self.stress());
        divide(&mut answer.zeta, self.zeta(dimension));
        answer.errors = answer.errors.map(|errors| {
            let volume = self.length.powf(0.5 * f64::from(dimension));
            let area = self.length.powf(0.5 * f64::from(dimension - 1));
            let unit = [
                self.strain() * volume,
                self.displacement * volume,
                self.stress() * volume,
                self.displacement * area,
                self.stress() * area,
            ];
            std::array::from_fn(|i| errors[i] / unit[i])
        });
        answer
    }
}

/// The scenes whose answers must not depend on units.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unitless {
    /// A linear viscoelastic body with a smooth exact solution.
    Linear,
    /// Every term of (5.1)-(5.5): the block that is pressed on a soft layer over a rigid one.
    EveryTerm,
    /// Memory and a law with a jump, the pressure of some vertices inside its interval.
    SetValued,
    /// A linear body in space.
    Box,
}

impl Unitless {
    /// All plane ones.
    pub const PLANE: [Self; 3] = [Self::Linear, Self::EveryTerm, Self::SetValued];

    /// All.
    pub const ALL: [Self; 4] = [Self::Linear, Self::EveryTerm, Self::SetValued, Self::Box];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::EveryTerm => "every term",
            Self::SetValued => "set-valued",
            Self::Box => "box",
        }
    }

    /// d.
    pub(crate) fn dimension(self) -> i32 {
        if self == Self::Box { 3 } else { 2 }
    }

    /// The scene in the given units. Plane domains are polygons: their mesh n cuts a coarse triangle
    /// into n² ones, whatever the unit, where a rectangle has n cells per unit length.
    pub fn text(self, units: &Units) -> String {
        let Units { length, stiffness, time, displacement } = *units;
        let (x, y, t) =
            (format!("(x/{length:?})"), format!("(y/{length:?})"), format!("(t/{time:?})"));
        let z = format!("(z/{length:?})");
        let memory = format!(
            "[material.memory]\nkernel = \"{:?}*exp({:?}*t)\"\nlambda = {:?}\nmu = {:?}\n",
            -1.0 / time,
            -1.0 / time,
            0.25 * stiffness,
            0.25 * stiffness
        );
        let law = |points: &[[f64; 2]]| {
            let point =
                |[r, p]: &[f64; 2]| format!("[{:?}, {:?}]", r * displacement, p * units.stress());
            let points: Vec<String> = points.iter().map(point).collect();
            format!(
                "law = {{ kind = \"piecewise-linear\", points = [{}], slope_before = 0.0, slope_after = 0.0 }}",
                points.join(", ")
            )
        };
        let pressed =
            format!("[loads]\nbody = [\"0\", \"{:?}*{t}*{x}\"]\n", -3.0 * units.body_force());
        let terms = match self {
            Self::Linear => format!(
                "{memory}[exact]\nu = [\"{displacement:?}*0.2*sin(2*{t})*sin(pi*{x})*(1 - {y}^2)\", \"-{displacement:?}*0.1*{t}*exp(-{t})*(1 + cos(pi*{x}))*(1 - {y})*(1 + {y}/2)\"]\n"
            ),
            Self::EveryTerm => format!(
                "{memory}[material.projection]\nmu = {:?}\nkappa = \"{:?} + {:?}*zeta\"\n[contact]\ngap = \"{:?}\"\n{}\n{pressed}",
                stiffness,
                0.10 * units.strain(),
                0.05 * units.strain() / units.zeta(2),
                0.10 * displacement,
                law(&[[0.0, 0.0], [0.04, 0.08], [0.10, 0.05]]),
            ),
            Self::SetValued => format!(
                "{memory}[contact]\ngap = \"{:?}\"\n{}\n{pressed}",
                0.30 * displacement,
                law(&[[0.0, 0.0], [0.04, 0.03], [0.04, 0.40], [0.10, 0.38]]),
            ),
            Self::Box => format!(
                "[exact]\nu = [\"{displacement:?}*0.1*{t}*(1 - {y})*sin({z})\", \"-{displacement:?}*0.1*{t}*(1 - {y})*(1 + {x})\", \"0\"]\n"
            ),
        };
        let domain = if self == Self::Box {
            format!(
                "shape = \"box\"\nsize = [{length:?}, {length:?}, {length:?}]\nclamped = [\"top\"]\ntraction = [\"left\", \"right\", \"front\", \"back\", \"bottom\"]\n"
            )
        } else {
            format!(
                "shape = \"polygon\"\nvertices = [[0.0, 0.0], [{length:?}, 0.0], [{length:?}, {length:?}], [0.0, {length:?}]]\nsides = [\"bottom\", \"right\", \"top\", \"left\"]\nclamped = [\"top\"]\n{}\n",
                match self {
                    Self::Linear => "traction = [\"left\", \"right\", \"bottom\"]",
                    _ => "traction = [\"left\", \"right\"]\ncontact = [\"bottom\"]",
                }
            )
        };
        let (dimension, lame) = (self.dimension(), [stiffness; 2]);
        SceneText { dimension, domain, horizon: time, lame, rest: terms }.text()
    }
}

// Ladders of units: the nondimensional answer does not depend on them.

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
) -> Result<Measured, super::rung::Unanswered> {
    let mut worst: Option<Measured> = None;
    for scene in scenes {
        let run = |units: Units| {
            let answer = solve(scene.text(&units), 4, 4, under_test.prepare)?;
            Ok::<_, super::rung::Unanswered>(units.nondimensional(answer, scene.dimension()))
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

/// The units, each alone, then together. Of length in the plane: in space n counts cells per unit length, which is then part
/// of the mesh. Beyond 1e±150 areas leave the doubles, beyond 1e±152 squares of stresses do, strains beyond 1e±152 are
/// refused, subnormal ones among them; nothing squares a time.
pub(crate) fn ladders() -> [Ladder; 5] {
    type With = fn(f64) -> Units;
    let of_length: With = |length| Units { length, ..Units::default() };
    let of_stiffness: With = |stiffness| Units { stiffness, ..Units::default() };
    let of_time: With = |time| Units { time, ..Units::default() };
    let of_displacement: With = |displacement| Units { displacement, ..Units::default() };
    let alone = |name, parameter, scenes, with, beyond| {
        ladder(name, parameter, WHY, scenes, powers(with, beyond))
    };
    let (plane, all) = (&Unitless::PLANE[..], &Unitless::ALL[..]);
    let [areas, squares] = ["outside 1e-150 to 1e150", "the stiffest modulus"].map(Some);
    let strains = Some("state the scene in other units");
    [
        alone("unit-length", "unit of length", plane, of_length, areas),
        alone("unit-stiffness", "unit of stiffness", all, of_stiffness, squares),
        alone("unit-time", "unit of time", all, of_time, None),
        alone("unit-displacement", "unit of displacement", all, of_displacement, strains),
        together(),
    ]
}

/// All units at once, as programs in SI units meet them: from films to faults.
fn together() -> Ladder {
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
