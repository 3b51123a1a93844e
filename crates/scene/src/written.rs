//! A scene file as written: keys and types only.
//!
//! Plain nested tables; a `kind` is a string here, and its further keys are decided in validation. Counts are signed,
//! so that a negative one can be refused with a message.

use std::collections::BTreeMap;
use std::fmt;

use serde::{Deserialize, Deserializer, de};

use super::friction_stress::FrictionStress;
use super::or_table::{OrTable, Plain};

/// A formula as text; a bare TOML number is a formula too.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Formula(pub String);

impl<'de> Deserialize<'de> for Formula {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Formula, D::Error> {
        deserializer.deserialize_any(FormulaVisitor)
    }
}

struct FormulaVisitor;

impl de::Visitor<'_> for FormulaVisitor {
    type Value = Formula;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(Formula::IS)
    }

    fn visit_str<E>(self, text: &str) -> Result<Formula, E> {
        Ok(Formula(text.to_string()))
    }

    fn visit_f64<E>(self, value: f64) -> Result<Formula, E> {
        Ok(Formula(value.to_string()))
    }

    fn visit_i64<E>(self, value: i64) -> Result<Formula, E> {
        Ok(Formula(value.to_string()))
    }
}

impl Plain for Formula {
    const IS: &'static str = "a formula in quotes or a number";
}

/// The whole file.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct File {
    pub scene: Heading,
    pub domain: Domain,
    pub time: Time,
    pub material: Material,
    pub contact: Option<Contact>,
    pub discretization: Option<Discretization>,
    pub loads: Option<Loads>,
    pub exact: Option<Exact>,
    pub sweep: Option<Sweep>,
    #[serde(default)]
    pub predicts: Vec<Prediction>,
}

/// `[discretization]`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Discretization {
    pub element: Option<String>,
}

/// `[scene]`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Heading {
    pub name: String,
    pub question: String,
    /// Read before, to choose the kind of file.
    #[expect(dead_code)]
    pub kind: Option<String>,
    pub dimension: i64,
    #[serde(default = "yes")]
    pub judge: bool,
    pub expect: Option<String>,
    #[serde(default)]
    pub long: bool,
    pub window_n: Option<Vec<i64>>,
    pub window_steps: Option<Vec<i64>>,
    #[serde(default)]
    pub violates: Vec<String>,
}

/// `[domain]`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Domain {
    pub shape: String,
    pub size: Option<Vec<f64>>,
    pub vertices: Option<Vec<Vec<f64>>>,
    pub sides: Option<Vec<String>>,
    pub points: Option<Vec<Vec<f64>>>,
    pub triangles: Option<Vec<Vec<i64>>>,
    pub file: Option<String>,
    #[serde(default)]
    pub clamped: Vec<String>,
    #[serde(default)]
    pub traction: Vec<String>,
    #[serde(default)]
    pub contact: Vec<String>,
    pub mesh: Option<Mesh>,
}

/// `mesh = { kind = "perturbed", amplitude = 0.2, seed = 1 }`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Mesh {
    pub kind: String,
    pub amplitude: Option<f64>,
    pub seed: Option<i64>,
    pub axes: Option<Vec<String>>,
    pub corner: Option<Vec<f64>>,
    pub exponent: Option<f64>,
}

/// `[time]`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Time {
    pub horizon: f64,
    pub grid: Option<Grid>,
    pub rule: Option<Rule>,
}

/// `rule = "left"`, or `rule = { kind = "corrected-end", exponent = 0.5 }`
pub(crate) type Rule = OrTable<RuleName, RuleTable>;

/// A rule without parameters.
#[derive(Debug, Clone, Deserialize)]
#[serde(transparent)]
pub(crate) struct RuleName(pub String);

impl Plain for RuleName {
    const IS: &'static str = "the name of a rule";
}

/// A rule with the parameters of its kind.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RuleTable {
    pub kind: String,
    pub exponent: Option<f64>,
    pub order: Option<i64>,
}

/// `grid = { kind = "graded", exponent = 2.0 }`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Grid {
    pub kind: String,
    pub exponent: Option<f64>,
    pub seed: Option<i64>,
}

/// `[material]`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Material {
    pub lambda: Option<f64>,
    #[serde(rename = "mu_L")]
    pub mu_l: Option<f64>,
    #[serde(rename = "E")]
    pub young: Option<f64>,
    #[serde(rename = "nu")]
    pub poisson: Option<f64>,
    pub elasticity: Option<Elasticity>,
    pub memory: Option<Memory>,
    pub projection: Option<Projection>,
    #[serde(default)]
    pub region: Vec<Region>,
}

/// `elasticity = { kind = "orthotropic", normal = [4.0, 2.0], coupling = [1.0], shear = [0.8] }`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Elasticity {
    pub kind: String,
    pub mandel: Option<Vec<Vec<f64>>>,
    pub normal: Option<Vec<f64>>,
    pub coupling: Option<Vec<f64>>,
    pub shear: Option<Vec<f64>>,
}

/// `[[material.region]]`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Region {
    pub name: String,
    #[serde(rename = "where")]
    pub condition: Option<Formula>,
    pub physical: Option<String>,
    pub lambda: Option<f64>,
    #[serde(rename = "mu_L")]
    pub mu_l: Option<f64>,
    #[serde(rename = "E")]
    pub young: Option<f64>,
    #[serde(rename = "nu")]
    pub poisson: Option<f64>,
    pub elasticity: Option<Elasticity>,
    pub memory: Option<Memory>,
}

/// `[material.memory]`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Memory {
    pub kernel: Option<Kernel>,
    pub lambda: Option<f64>,
    pub mu: Option<f64>,
    pub bulk: Option<Kernel>,
    pub shear: Option<Kernel>,
    pub singular: Option<f64>,
}

/// A memory kernel: a formula in t, or a table.
pub(crate) type Kernel = OrTable<Formula, KernelTable>;

/// `kernel = { kind = "prony", terms = [[-0.5, 0.2], [-0.3, 2.0]] }`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct KernelTable {
    pub kind: String,
    pub amplitude: Option<f64>,
    pub time: Option<f64>,
    pub exponent: Option<f64>,
    pub terms: Option<Vec<Vec<f64>>>,
}

/// `[material.projection]`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Projection {
    pub mu: f64,
    pub kappa: Formula,
}

/// `[contact]`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Contact {
    pub gap: Option<Formula>,
    pub shift: Option<Formula>,
    pub law: Option<Law>,
    pub quadrature: Option<String>,
    pub friction: Option<Friction>,
}

/// `[contact.friction]`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Friction {
    pub bound: FrictionBound,
}

/// The bound of the friction stress: a formula in x, y, t, or a table.
pub(crate) type FrictionBound = OrTable<Formula, FrictionBoundTable>;

/// `bound = { kind = "slip", points = [[0.0, 0.3], [0.1, 0.28]] }`, or `{ kind = "coulomb", coefficient = "0.3" }`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct FrictionBoundTable {
    pub kind: String,
    pub points: Option<Vec<Vec<f64>>>,
    pub coefficient: Option<Formula>,
}

/// `law = { kind = "piecewise-linear", points = [[0.0, 0.0], …], slope_before = 0.0, slope_after = 0.0 }`, or another
/// kind; docs/CONTACT-LAWS.md lists the keys of each.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Law {
    pub kind: String,
    pub stiffness: Option<f64>,
    pub points: Option<Vec<Vec<f64>>>,
    pub slope_before: Option<f64>,
    pub slope_after: Option<f64>,
    pub length: Option<f64>,
    pub coefficient: Option<f64>,
    pub exponent: Option<f64>,
    pub until: Option<f64>,
    pub jump: Option<f64>,
    pub scale: Option<Formula>,
}

/// `[loads]`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Loads {
    pub body: Vec<Formula>,
    #[serde(default)]
    pub traction: BTreeMap<String, Vec<Formula>>,
}

/// `[exact]`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Exact {
    pub u: Vec<Formula>,
    pub multiplier: Option<Formula>,
    pub selection: Option<Formula>,
    pub friction: Option<FrictionStress>,
    #[serde(default)]
    pub interpolated: bool,
    pub form: Option<String>,
    #[serde(default)]
    pub parameters: BTreeMap<String, Formula>,
    #[serde(default)]
    pub define: BTreeMap<String, Formula>,
}

/// `[sweep]`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Sweep {
    #[serde(default)]
    pub n: Vec<i64>,
    #[serde(default)]
    pub steps: Vec<i64>,
    pub pairs: Option<Vec<Vec<i64>>>,
    pub reference: Option<Reference>,
    pub norms: Option<Vec<String>>,
    #[serde(default)]
    pub by_state: bool,
}

/// `reference = { n = 128, steps = 64 }`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Reference {
    pub n: i64,
    pub steps: i64,
}

/// `[[predicts]]`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Prediction {
    pub norm: String,
    pub variable: String,
    pub order: f64,
    pub order_k: Option<f64>,
    #[serde(default)]
    pub at_least: bool,
    #[serde(default)]
    pub exact: bool,
    #[serde(default = "yes")]
    pub constant: bool,
    pub constant_within: Option<f64>,
    pub constant_why: Option<String>,
    pub why: String,
    pub window_n: Option<Vec<i64>>,
    pub window_steps: Option<Vec<i64>>,
}

fn yes() -> bool {
    true
}
