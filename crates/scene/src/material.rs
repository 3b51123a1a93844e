//! `[material]`: elasticity, optional memory and projection, and named regions.

use super::data::AXES;
use super::domain::{Domain, Shape};
use super::memory;
use super::memory::RelaxationTerm;
use super::reading::{Reading, heading, join};
use super::source::Result;
use super::validated::Hypothesis;
use fem::mesh::CoarseMesh;
use files::digits;
use formula::{Graph, Interval, Node, Scope, Variable};
use vhi::law::{FourthOrder, Isotropic};

/// The law (5.1) with the terms that the scene has.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// 𝒜 outside all named regions, positive definite.
    pub elastic: FourthOrder,
    /// The terms of ℬ; empty without memory.
    pub memory: Vec<RelaxationTerm>,
    pub projection: Option<Projection>,
    /// `[[material.region]]`, in file order.
    pub regions: Vec<Region>,
}

/// A named part of the body with a separate elasticity; separate memory is in [`RelaxationTerm::regions`].
#[derive(Debug, Clone, PartialEq)]
pub struct Region {
    pub name: String,
    pub place: Place,
    pub elastic: FourthOrder,
}

/// Regions are numbered by a byte.
const MOST_REGIONS: usize = 200;

impl Material {
    pub(super) fn validate(
        reading: &mut Reading,
        horizon: f64,
        domain: &Domain,
    ) -> Result<Material> {
        let elastic = elastic(reading, "material", domain.dimension())?;
        let base = memory::parts(reading, None, horizon, domain.dimension())?.unwrap_or_default();
        let (mut regions, mut parts) = (Vec::new(), Vec::new());
        for index in reading.entries("material.region")? {
            let region = Region::validate(reading, index, domain)?;
            let known = regions.iter().any(|other: &Region| other.name == region.name);
            let message = format!("two regions are called `{}`", region.name);
            let key = format!("material.region.{index}.name");
            reading.refuse_if(known, &key, message, "rename one of them")?;
            regions.push(region);
            let separate = memory::parts(reading, Some(index), horizon, domain.dimension())?;
            parts.push(separate.unwrap_or_else(|| base.clone()));
        }
        let message = format!("{} regions: at most {MOST_REGIONS} are told apart", regions.len());
        let (many, hint) = (regions.len() > MOST_REGIONS, "merge regions of one material");
        reading.refuse_if(many, "material.region", message, hint)?;
        let memory = memory::terms(reading, &base, &parts);
        let projection = reading
            .if_given("material.projection", |reading, _| Projection::validate(reading, horizon))?;
        let both = projection.is_some() && memory.iter().any(|term| term.inner.is_some());
        let message = "no bound of zeta is proved beside a history of a history";
        let hint = "remove `inner` from the terms of the memory, or the projection";
        reading.refuse_if(both, "material.projection", message, hint)?;
        Ok(Material { elastic, memory, projection, regions })
    }

    /// The key of the list with an inner kernel, if there is one.
    pub(super) fn nested_key(&self) -> Option<String> {
        let nested = self.memory.iter().any(|term| term.inner.is_some());
        nested.then(|| "material.memory.terms".to_string())
    }

    /// The key of the first exponent of a kernel that is infinite at s = t.
    pub(super) fn singular_key(&self) -> Option<String> {
        let singular = self.memory.iter().find_map(|term| term.singular)?;
        Some(format!("{}.singular", memory::key(singular.region)))
    }

    /// Whether 𝒜 is given in full somewhere.
    pub fn is_anisotropic(&self) -> bool {
        let mut elastic = self.regions.iter().map(|region| &region.elastic).chain([&self.elastic]);
        elastic.any(|elastic| matches!(elastic, FourthOrder::Full(_)))
    }
}

impl Region {
    fn validate(reading: &mut Reading, index: usize, domain: &Domain) -> Result<Region> {
        let table = format!("material.region.{index}");
        let key = join(&table, "name");
        let name = reading.text(&key)?;
        let (condition, physical) = (join(&table, "where"), join(&table, "physical"));
        let place = match (reading.has(&condition), reading.has(&physical), &domain.shape) {
            (true, false, _) => {
                let scope = Scope::new(&AXES[..domain.dimension()]);
                Place::Where(reading.formula(&condition, &scope)?)
            }
            (false, true, Shape::Refined(coarse)) => {
                let regions = coarse.regions.iter().map(String::as_str).zip(0..);
                Place::Physical(reading.choice(&physical, &regions.collect::<Vec<_>>())?)
            }
            (false, true, Shape::Box) => {
                let message = "physical groups are in mesh files, and the domain is none";
                let hint = "write where = \"y - 0.5\", or shape = \"mesh\" with a file";
                return Err(reading.error(&physical, message, hint));
            }
            (both, ..) => {
                let count = if both { "two places" } else { "no place" };
                let message = format!("the region `{name}` has {count}");
                let hint = "give either where = \"y - 0.5\", positive inside, or physical = \"name\", a group of the mesh file";
                return Err(reading.error(&table, message, hint));
            }
        };
        Ok(Region { name, place, elastic: elastic(reading, &table, domain.dimension())? })
    }
}

// The elasticity tensor 𝒜 of a body or region: by two numbers, by moduli along the axes, or in full.

/// Kinds of the table `elasticity` with their keys.
const TENSORS: [(&str, &str); 2] = [("full", "mandel"), ("orthotropic", "normal coupling shear")];

/// Exactly one of the pairs (lambda, mu_L) and (E, nu), or the table `elasticity`, in `[material]` or a region.
pub(super) fn elastic(reading: &Reading, key: &str, dimension: usize) -> Result<FourthOrder> {
    let names = ["lambda", "mu_L", "E", "nu", "elasticity"].into_iter();
    let given: Vec<&str> = names.filter(|name| reading.has(&join(key, name))).collect();
    match given[..] {
        ["lambda", "mu_L"] => elliptic(reading, key, dimension),
        ["E", "nu"] => from_young(reading, key),
        ["elasticity"] => full(reading, &join(key, "elasticity"), dimension),
        _ => {
            let list = if given.is_empty() { "nothing".to_string() } else { given.join(", ") };
            let part = heading(key);
            let message = format!("{part} gives {list}: elasticity needs exactly one pair");
            let hint = "give lambda and mu_L, or E and nu, or elasticity = { kind = \"full\", … }";
            Err(reading.error(key, message, hint))
        }
    }
}

/// m_𝒜 > 0: the eigenvalues 2 mu and 2 mu + d lambda of 𝒜 on S^d are positive.
fn elliptic(reading: &Reading, key: &str, dimension: usize) -> Result<FourthOrder> {
    let lambda = reading.finite(&join(key, "lambda"))?;
    // Half of the eigenvalue 2 mu_L of the elasticity tensor.
    let mu = reading.positive(&join(key, "mu_L"))?;
    let d = dimension as f64;
    let eigenvalue = 2.0 * mu + d * lambda;
    let message = format!(
        "2 mu_L + {dimension} lambda = {eigenvalue} is not positive: this eigenvalue of the elasticity tensor must be"
    );
    let hint = format!("give lambda > {}", -2.0 * mu / d);
    reading.refuse_if(eigenvalue <= 0.0, &join(key, "lambda"), message, hint)?;
    Ok(Isotropic { lambda, mu }.into())
}

/// Plane strain: λ = E ν/((1+ν)(1-2ν)), μ = E/(2(1+ν)).
fn from_young(reading: &Reading, key: &str) -> Result<FourthOrder> {
    let young = reading.positive(&join(key, "E"))?;
    let hint = "at 0.5 the material is incompressible: give less, such as 0.3";
    let fits = |poisson: f64| poisson > -1.0 && poisson < 0.5;
    let poisson = reading.number(&join(key, "nu"), fits, ["is outside (-1, 0.5)", hint])?;
    let lambda = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
    Ok(Isotropic { lambda, mu: young / (2.0 * (1.0 + poisson)) }.into())
}

/// `{ kind = "full", mandel = [[…], …] }`, or `{ kind = "orthotropic", normal = […], coupling = […], shear = […] }`
/// with 𝒜_iiii, 𝒜_iijj and 𝒜_ijij along the axes, pairs in the order 12 in the plane and 23, 13, 12 in space.
fn full(reading: &Reading, key: &str, dimension: usize) -> Result<FourthOrder> {
    let (matrix, place) = if reading.kind(key, &TENSORS)? == "full" {
        let (place, order) = (join(key, "mandel"), dimension * (dimension + 1) / 2);
        let rows = reading.matrix(&place, order)?;
        reading.symmetric(&place, &rows)?;
        let mut matrix = [[0.0; 6]; 6];
        for (of_matrix, row) in matrix.iter_mut().zip(&rows) {
            of_matrix[..order].copy_from_slice(row);
        }
        (matrix, place)
    } else {
        (orthotropic(reading, key, dimension)?, key.to_string())
    };
    let tensor = FourthOrder::Full(matrix);
    let (smallest, _) = tensor.eigenvalues(dimension);
    let message = format!(
        "the elasticity tensor is not positive definite: its smallest eigenvalue m_A is {}",
        digits(smallest, 7)
    );
    let hint = "an elastic energy must be positive for every strain: raise the diagonal entries, or lower what couples them";
    // NaN is refused.
    let positive = smallest > 0.0;
    reading.refuse_if(!positive, &place, message, hint).map(|()| tensor)
}

fn orthotropic(reading: &Reading, key: &str, d: usize) -> Result<[[f64; 6]; 6]> {
    let pairs: &[(usize, usize)] = if d == 2 { &[(0, 1)] } else { &[(1, 2), (0, 2), (0, 1)] };
    let list = |name: &str, count: usize| reading.numbers(&join(key, name), count);
    let normal = list("normal", d)?;
    let coupling = list("coupling", pairs.len())?;
    let shear = list("shear", pairs.len())?;
    let mut matrix = [[0.0; 6]; 6];
    for (i, value) in normal.into_iter().enumerate() {
        matrix[i][i] = value;
    }
    for (at, &(i, j)) in pairs.iter().enumerate() {
        (matrix[i][j], matrix[j][i]) = (coupling[at], coupling[at]);
        // σ_ij = 2 𝒜_ijij ε_ij, which also holds for √2 times both.
        matrix[d + at][d + at] = 2.0 * shear[at];
    }
    Ok(matrix)
}

// Location of a region: a condition on coordinates, or a physical group of the mesh file.

/// The cells of a region.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Place {
    /// Cells whose centroid has a positive value of the formula.
    Where(Node),
    /// Cells of a region of the mesh, an index into `Mesh::regions`.
    Physical(u32),
}

/// Barycentric coordinates down to this count as inside: boundary points of the body belong to it.
const INSIDE: f64 = 1e-9;

impl Place {
    /// A formula that is positive in the region: for a physical group the largest over its coarse simplices of the
    /// smallest barycentric coordinate, raised so that their faces are inside. On an interface either region may have
    /// the points.
    pub(crate) fn condition(self, graph: &mut Graph, shape: &Shape) -> Node {
        let (group, coarse) = match (self, shape) {
            (Place::Where(node), _) => return node,
            (Place::Physical(_), Shape::Box) => return graph.constant(-1.0),
            (Place::Physical(group), Shape::Refined(coarse)) => (group, coarse),
        };
        let simplices = (0..coarse.count()).filter(|&simplex| coarse.region[simplex] == group);
        let mut deepest = graph.constant(f64::NEG_INFINITY);
        for simplex in simplices {
            let least = smallest_coordinate(graph, coarse, simplex);
            deepest = graph.max(deepest, least);
        }
        let raised = graph.constant(INSIDE);
        graph.add(deepest, raised)
    }
}

/// min_a λ_a(x) of a coarse simplex.
fn smallest_coordinate(graph: &mut Graph, coarse: &CoarseMesh, simplex: usize) -> Node {
    let (corners, d) = (coarse.corners(simplex), coarse.dimension);
    // Rows of the inverse are the gradients of λ_1, …, λ_d; λ_0 = 1 minus their sum.
    let edges = nalgebra::DMatrix::from_fn(d, d, |i, a| corners[a + 1][i] - corners[0][i]);
    let inverse = edges.try_inverse().unwrap_or_else(|| nalgebra::DMatrix::zeros(d, d));
    let rows: Vec<Vec<f64>> = (0..d).map(|a| inverse.row(a).iter().copied().collect()).collect();
    let axes = AXES.map(|axis| graph.variable(axis));
    let one = graph.constant(1.0);
    let mut first = one;
    let mut least = None;
    for row in rows {
        let at_corner: f64 = row.iter().zip(corners[0]).map(|(slope, x)| slope * x).sum();
        let terms = row.into_iter().zip(axes);
        let coordinate = graph.weighted_sum([(-at_corner, one)].into_iter().chain(terms));
        first = graph.sub(first, coordinate);
        least = Some(least.map_or(coordinate, |least| graph.min(least, coordinate)));
    }
    least.map_or(first, |least| graph.min(least, first))
}

// `[material.projection]`: the projection on the von Mises convex.

/// κ is examined on [0, 100 T]: mean strain norms up to 100.
const LARGEST_MEAN_STRAIN: f64 = 100.0;
/// Jumps are looked for up to this many horizons.
const FARTHEST_JUMP: f64 = 1e6;

/// The stress μ(ε - P_{M(κ(ζ))} ε) of (5.1).
#[derive(Debug, Clone, PartialEq)]
pub struct Projection {
    /// μ ≥ 0.
    pub mu: f64,
    /// κ ≥ 0, a formula in zeta, without jumps unless the scene violates (5.1) on purpose.
    pub kappa: Node,
    /// A proved bound of |κ'| for all ζ ≥ 0; infinite if there is none, or none was found. Then [`crate::setup::YieldSlope`]
    /// has one for the ζ that a run can reach.
    pub lipschitz: f64,
}

impl Projection {
    pub(super) fn validate(reading: &mut Reading, horizon: f64) -> Result<Projection> {
        let key = "material.projection.kappa";
        let fault = "is negative: the projection term would not be monotone";
        let hint = "give mu >= 0; remove [material.projection] for mu = 0";
        let fits = |mu: f64| mu >= 0.0 && mu.is_finite();
        let mu = reading.number("material.projection.mu", fits, [fault, hint])?;
        let kappa = reading.formula(key, &Scope::new(&[Variable::Zeta]))?;
        let over = Interval::new(0.0, LARGEST_MEAN_STRAIN * horizon);
        let must = "a yield bound must be finite and not negative";
        let hint = "give a formula with values >= 0 for all zeta >= 0, such as max(0, 0.2 - zeta)";
        let negative = reading.formulas.largest_negative(kappa, Variable::Zeta, over);
        let message =
            format!("kappa = {:.6} at zeta = {}: {must}", -negative.attained, negative.at[0]);
        reading.refuse_if(negative.attained > 0.0, key, message, hint)?;
        let size = reading.formulas.largest_modulus(kappa, Variable::Zeta, over);
        let message = format!("kappa has no finite value near zeta = {}: {must}", size.part[0].low);
        reading.refuse_if(!size.bound.is_finite(), key, message, hint)?;
        let lipschitz = lipschitz(reading, key, kappa, horizon)?;
        Ok(Projection { mu, kappa, lipschitz })
    }
}

/// The bound of |κ'| for all ζ ≥ 0; refuses a κ without one on [0, 100 T], or with a jump.
fn lipschitz(reading: &mut Reading, key: &str, kappa: Node, horizon: f64) -> Result<f64> {
    let graph = &mut reading.formulas;
    let slope = graph.derivative(kappa, Variable::Zeta);
    let bound = |high| graph.largest_modulus(slope, Variable::Zeta, Interval::new(0.0, high));
    let everywhere = bound(f64::INFINITY);
    let near = match everywhere.bound.is_finite() {
        true => everywhere,
        false => bound(LARGEST_MEAN_STRAIN * horizon),
    };
    let jumps = Interval::new(0.0, FARTHEST_JUMP * horizon);
    let jump = graph.jump(kappa, Variable::Zeta, jumps);
    let fault = match jump {
        Ok(Some(jump)) => Some(format!(
            "it jumps between {:.6} and {:.6} at zeta = {:.6}",
            jump.values.low, jump.values.high, jump.at.low
        )),
        Err(left) => Some(format!("its branches near zeta = {:.6} cannot be told apart", left.low)),
        Ok(None) if !near.bound.is_finite() => {
            Some(format!("its derivative has no bound near zeta = {:.6}", near.part[0].low))
        }
        Ok(None) => None,
    };
    let Some(fault) = fault else { return Ok(everywhere.bound) };
    let message = format!("kappa is not Lipschitz, and (5.1) asks for a constant L_kappa: {fault}");
    let hint = "to run it on purpose, write violates = [\"5.1\"] in [scene]";
    let refused = !reading.violates.contains(&Hypothesis::LipschitzKappa);
    reading.refuse_if(refused, key, message, hint).map(|()| f64::INFINITY)
}
