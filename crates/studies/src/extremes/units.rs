//! Units of length, stiffness, time and displacement, and scenes written in them.

use super::ladders::{Filling, Texts};
use super::rung::{Measured, Result, SceneAnswer, UnderTest, solve};
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
    pub(super) fn new([length, stiffness, time, displacement]: [f64; 4]) -> Self {
        Self { length, stiffness, time, displacement }
    }

    /// The unit of strains and κ.
    pub(crate) fn strain(&self) -> f64 {
        self.displacement / self.length
    }

    /// The unit of stresses and pressures.
    pub(crate) fn stress(&self) -> f64 {
        self.stiffness * self.strain()
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

/// A scene whose answer must not depend on units: its name in the data, the domain, and d.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Unitless(&'static str, &'static str, i32);

impl Unitless {
    const LINEAR: Self = Self("linear", "unit-free", 2);
    const EVERY_TERM: Self = Self("every term", "unit-touching", 2);
    const SET_VALUED: Self = Self("set-valued", "unit-touching", 2);

    /// All plane ones.
    pub const PLANE: [Self; 3] = [Self::LINEAR, Self::EVERY_TERM, Self::SET_VALUED];

    /// All.
    pub const ALL: [Self; 4] =
        [Self::LINEAR, Self::EVERY_TERM, Self::SET_VALUED, Self("box", "unit-box", 3)];

    /// The scene in the given units.
    pub fn text(self, units: &Units) -> String {
        let Self(name, domain, dimension) = self;
        let with = [("domain", format!("${{{domain}}}")), ("dimension", dimension.to_string())];
        let with: Texts = with.map(|(name, text)| (name.to_owned(), text)).into();
        let numbers = [
            ("length", units.length),
            ("stiffness", units.stiffness),
            ("time", units.time),
            ("displacement", units.displacement),
            ("strain", units.strain()),
            ("stress", units.stress()),
            // Of f0, which is not formed from unit to unit where an intermediate one overflows.
            ("force", units.stress() / units.length),
            ("past", units.zeta(dimension)),
        ];
        let numbers = numbers.map(|(name, unit)| (name.to_owned(), unit)).into();
        Filling { at: "", with: vec![&with], numbers }.filled(&format!("${{{name}}}"))
    }
}

/// The largest relative difference of the answer in `units` to that in units of 1, nondimensional, over `scenes`.
pub(super) fn difference(
    scenes: &[Unitless],
    units: Units,
    under_test: &UnderTest<'_>,
) -> Result<Measured> {
    let mut worst: Option<Measured> = None;
    for scene in scenes {
        let run = |units: Units| -> Result<SceneAnswer> {
            let answer = solve(scene.text(&units), 4, 4, under_test.prepare)?;
            Ok(units.nondimensional(answer, scene.2))
        };
        let (found, known) = (run(units)?, run(Units::default())?);
        let here = Measured::of(found.distance(&known), &found).noted(scene.0);
        let before = worst.as_ref().map_or(-1.0, |worst| worst.value);
        if larger(here.value, before) != before {
            worst = Some(here);
        }
    }
    Ok(worst.unwrap_or_else(|| Measured::number(f64::NAN)))
}
