//! The compliance law p = ∂j_ν: piecewise linear or curved, with upward jumps only.

use super::domain::{Domain, largest_on, place};
use super::gap::finite_on_contact;
use super::reading::{Reading, join};
use super::source::Result;
use exact::{CurveNumbers, LawNumbers};
use formula::Node;
use vhi::law::Curve;

/// The kinds of law with their keys; docs/CONTACT-LAWS.md explains them.
const LAWS: [(&str, &str); 6] = [
    ("none", ""),
    ("linear", "stiffness scale"),
    ("piecewise-linear", "points slope_before slope_after scale"),
    ("rational", "stiffness length jump scale"),
    ("exponential", "stiffness length jump scale"),
    ("power", "coefficient exponent until jump scale"),
];

/// p = ∂j_ν as a graph: `slope_before`, the points joined by lines, `slope_after`. Two points of one abscissa are a
/// jump, where p is the interval between them. A curve is added to the graph, and a factor multiplies the sum.
#[derive(Debug, Clone, PartialEq)]
pub struct Law {
    /// (r, p(r)), at least one, r nondecreasing and at most twice equal.
    pub points: Vec<[f64; 2]>,
    pub slope_before: f64,
    pub slope_after: f64,
    /// None for a piecewise linear law.
    pub curve: Option<Curve>,
    /// c(x): the law at x is c p; None is 1.
    pub scale: Option<Scale>,
}

impl Law {
    /// The law of a table; none without it.
    pub(super) fn validate(reading: &Reading, table: &str) -> Result<Option<Law>> {
        let kind = if reading.has(table) { reading.kind(table, &LAWS)? } else { "none" };
        let positive = |name: &str| reading.positive(&join(table, name));
        let curve = match kind {
            "none" => return Ok(None),
            "linear" => {
                let stiffness = reading.finite(&join(table, "stiffness"))?;
                return Ok(Some(Law::graph(vec![[0.0, 0.0]], stiffness, stiffness)));
            }
            "piecewise-linear" => {
                let key = join(table, "points");
                let points = reading.points(&key)?;
                let slope = |name: &str| reading.finite(&join(table, name));
                let (before, after) = (slope("slope_before")?, slope("slope_after")?);
                for (index, pair) in points.windows(2).enumerate() {
                    admissible(reading, &format!("{key}.{}", index + 1), pair[0], pair[1])?;
                }
                for (index, three) in points.windows(3).enumerate() {
                    let message = format!("three points at r = {}", three[0][0]);
                    let hint = "a jump needs its lower and its upper end: remove the point between";
                    let odd = three[0][0] == three[2][0];
                    reading.refuse_if(odd, &format!("{key}.{}", index + 1), message, hint)?;
                }
                return Ok(Some(Law::graph(points, before, after)));
            }
            "power" => {
                let coefficient = positive("coefficient")?;
                let fits = |exponent: f64| exponent >= 1.0 && exponent.is_finite();
                let fault = "is not at least 1: below it the slope of the law is infinite at r = 0";
                let range = [fault, "give an exponent of at least 1"];
                let exponent = reading.number(&join(table, "exponent"), fits, range)?;
                let until = positive("until")?;
                let slope = coefficient * exponent * until.powf(exponent - 1.0);
                let message = format!("the slope of the law at r = {until} is {slope}");
                let hint = "(2.8b) asks for linear growth: lower `until` or `exponent`";
                reading.refuse_if(!slope.is_finite(), &join(table, "until"), message, hint)?;
                Curve::Power { coefficient, exponent, until }
            }
            "rational" => {
                Curve::Rational { stiffness: positive("stiffness")?, length: positive("length")? }
            }
            _ => Curve::Exponential {
                stiffness: positive("stiffness")?,
                length: positive("length")?,
            },
        };
        // A curve after an optional jump at r = 0: [0, jump] there, jump + p(r) beyond.
        let mut points = vec![[0.0, 0.0]];
        if reading.has(&join(table, "jump")) {
            points.push([0.0, positive("jump")?]);
        }
        Ok(Some(Law { curve: Some(curve), ..Law::graph(points, 0.0, 0.0) }))
    }

    pub(crate) fn graph(points: Vec<[f64; 2]>, slope_before: f64, slope_after: f64) -> Law {
        Law { points, slope_before, slope_after, curve: None, scale: None }
    }

    /// α_ν ≥ 0, the steepest descent of p (per unit of r): the constant of relaxed monotonicity (2.8c).
    ///
    /// Sufficient: for r1 > r2 and ξi ∈ p(ri), ξ1 - ξ2 is the integral of the slopes over (r2, r1) plus parts of upward
    /// jumps, hence at least -α (r1 - r2); times (r1 - r2) this is (2.8c). Optimal: two points of the steepest segment
    /// give equality. A curve adds its α: for a sum of laws the inequalities add, and if the graph is a jump at r = 0,
    /// as beside every curve of a scene, no smaller constant does. A factor c(x) > 0 multiplies it; α includes the
    /// largest c. A downward jump by δ would need α (r1 - r2)² ≥ δ (r1 - r2) for r1 - r2 → 0.
    pub fn alpha(&self) -> f64 {
        let graph = self.slopes().fold(0.0f64, |alpha, slope| alpha.max(-slope));
        let curve = self.curve.map_or(0.0, |curve| curve.alpha());
        self.largest_scale() * (graph + curve)
    }

    /// The steepest rise of a law without a curve, including the largest factor (a stiffness).
    pub(crate) fn steepest_rise(&self) -> f64 {
        self.largest_scale() * self.slopes().fold(0.0, f64::max)
    }

    /// The largest factor.
    pub(crate) fn largest_scale(&self) -> f64 {
        self.scale.map_or(1.0, |scale| scale.largest)
    }

    /// Of a law that pulls at open contact, p < 0 for r below its first point: the keys of the law that does not.
    pub fn one_sided(&self) -> Option<String> {
        let [first, ..] = self.points[..] else { return None };
        if self.slope_before <= 0.0 || self.curve.is_some() {
            return None;
        }
        let after = self.slope_after;
        Some(match self.points.len() {
            1 if first == [0.0, 0.0] => format!(
                "law = {{ kind = \"piecewise-linear\", points = [[0.0, 0.0]], slope_before = 0.0, slope_after = {after:?} }}"
            ),
            _ => "slope_before = 0.0".into(),
        })
    }

    fn slopes(&self) -> impl Iterator<Item = f64> + '_ {
        let inner = self.points.windows(2).filter(|pair| pair[1][0] > pair[0][0]);
        let slopes = inner.map(|pair| (pair[1][1] - pair[0][1]) / (pair[1][0] - pair[0][0]));
        slopes.chain([self.slope_before, self.slope_after])
    }

    /// Its numbers without its factor, for the manufactured side.
    pub fn numbers(&self) -> LawNumbers {
        LawNumbers {
            points: self.points.clone(),
            slope_before: self.slope_before,
            slope_after: self.slope_after,
            curve: self.curve.map(|curve| match curve {
                Curve::Rational { stiffness: c, length } => {
                    CurveNumbers::Rational { c, r0: length }
                }
                Curve::Exponential { stiffness: c, length } => {
                    CurveNumbers::Exponential { c, r0: length }
                }
                Curve::Power { coefficient: c, exponent: m, until } => {
                    CurveNumbers::Power { c, m, r1: until }
                }
            }),
        }
    }

    /// Whether p has a jump, where ξ ∈ p(r) is not determined by r.
    pub fn is_set_valued(&self) -> bool {
        self.points.windows(2).any(|pair| pair[0][0] == pair[1][0])
    }
}

/// Checks the second of two neighbouring points: not to the left, not below at equal abscissa, of finite slope.
fn admissible(
    reading: &Reading,
    key: &str,
    [r, p]: [f64; 2],
    [next_r, next_p]: [f64; 2],
) -> Result<()> {
    let message = format!("the abscissa {next_r} comes after {r}: points must be sorted");
    reading.refuse_if(next_r < r, key, message, "sort the points by their first number")?;
    let message = format!("the point [{r}, {p}] is given twice");
    reading.refuse_if([next_r, next_p] == [r, p], key, message, "remove one of the two")?;
    let message = format!(
        "p jumps down from {p} to {next_p} at r = {r}: relaxed monotonicity (2.8c) then fails for every alpha"
    );
    let hint =
        "replace the jump by a steep slope: alpha is that slope, and (2.9) asks alpha c_j^2 < m_A";
    reading.refuse_if(next_r == r && next_p < p, key, message, hint)?;
    let endless = next_r > r && !((next_p - p) / (next_r - r)).is_finite();
    let message = format!("the slope from [{r}, {p}] to [{next_r}, {next_p}] is not finite");
    let hint = "give the points one abscissa for a jump upward, or set them apart";
    reading.refuse_if(endless, key, message, hint)
}

// Curved laws: rational, exponential, and a power continued by its tangent. All that a scene says of one is here.

/// Largest exponent integrated exactly between kinks: with a hat function and the 8 Gauss points of the exact rule, 14
/// + 1 = 15.
const EXACT_EXPONENT: f64 = 14.0;

/// Whether Gauss points between kinks integrate p to rounding.
pub(super) fn has_exact_rule(curve: Curve) -> bool {
    match curve {
        Curve::Rational { .. } | Curve::Exponential { .. } => true,
        Curve::Power { exponent, .. } => exponent.fract() == 0.0 && exponent <= EXACT_EXPONENT,
    }
}

// The factor c(x) of a law that varies in space: c ∂j_ν, c > 0 on Γ3.

/// c(x), and an upper bound.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    /// A formula in x, y (and z).
    pub formula: Node,
    /// A proved bound of max c over Γ3, attained but for a relative 1e-7.
    pub largest: f64,
}

impl Scale {
    pub(super) fn validate(reading: &mut Reading, key: &str, domain: &Domain) -> Result<Self> {
        let formula = finite_on_contact(reading, key, domain)?;
        let mut largest = 0.0f64;
        for &side in &domain.contact {
            for face in domain.faces(side) {
                let (least, at) = largest_on(&face, &reading.formulas, formula, -1.0);
                let here = place(&at.into(), domain.dimension());
                let (value, side) = (-least.attained, domain.name(side));
                let message = format!("`scale` is {value} at {here} on the side {side}");
                let hint = "the factor of a law must be positive on every contact side";
                reading.refuse_if(least.bound >= 0.0, key, message, hint)?;
                let (most, _) = largest_on(&face, &reading.formulas, formula, 1.0);
                let message = format!("`scale` has no bound on the side {side}");
                reading.refuse_if(!most.bound.is_finite(), key, message, hint)?;
                largest = largest.max(most.bound);
            }
        }
        Ok(Self { formula, largest })
    }
}
