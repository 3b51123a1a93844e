//! c_j² = sup ‖v_ν‖²/‖ε(v)‖² and c_τ² of a domain: the one computation that all commands take them from.
//!
//! On nested spaces the quotients are lower bounds that grow. Quadratics on triangles that are small where v is singular
//! make them grow fast; halving all triangles shows how fast. Near a corner with v ~ r^s a halving leaves 2^{-2s} of the
//! error or less, and no corner of an elastic body in the plane has s < 1/4 (clamped next to free around a whole turn):
//! what is missing is at most the last growth over √2 - 1, once each growth is a share of the one before.

use std::f64::consts::{PI, SQRT_2};
use std::sync::{Arc, Mutex, PoisonError};

use super::{Result, SetupError, discretized};
use crate::{Domain, Shape, Side};
use fem::contact::{TraceMass, TracePart, weighted_trace_constants};
use fem::mesh::{BoundaryFacet, CoarseMesh, Family, lattice};
use fem::space::Element;
use vhi::law::TensorField;

/// sup ‖v_ν‖²/(𝒞ε(v), ε(v)), or the same of v_τ.
#[derive(Debug, Clone, PartialEq)]
pub struct TraceConstant {
    /// The limit.
    pub value: f64,
    /// It lies within this of the value; infinite where the meshes do not show it.
    pub uncertainty: f64,
    /// Number of cells, and a lower bound of the limit there; each space holds the one before.
    pub values: Vec<(usize, f64)>,
    /// A proved upper bound.
    pub bound: Option<f64>,
}

/// Triangles before all are halved twice.
const CELLS: usize = 320;
/// Tetrahedra of a box before.
const IN_SPACE: f64 = 48.0;
/// Cells with quadratics at most, in the plane and in space; four times as many if the domain has them.
const MOST_CELLS: [usize; 2] = [8_000, 1_000];
/// Relative rounding of an eigenvalue, which settles to 1e-13, with room for the condition of the matrix.
const ROUNDING: f64 = 1e-9;
/// The least and the largest share by which a halving divides the error: s = 1/4, and quadratics of a smooth v.
const SHARES: [f64; 2] = [SQRT_2, 16.0];
/// Growths whose quotient is below show no limit.
const SETTLING: f64 = 1.05;

impl TraceConstant {
    /// No trace.
    pub const ZERO: Self = Self::exactly(0.0);

    /// A number that is known.
    pub const fn exactly(value: f64) -> Self {
        Self { value, uncertainty: 0.0, values: Vec::new(), bound: None }
    }

    /// The limit of values on nested spaces, below the bound.
    pub fn new(values: Vec<(usize, f64)>, bound: Option<f64>) -> Self {
        let (value, uncertainty) = match values[..] {
            [.., (_, value)] if bound.is_some_and(|bound| attains(value, bound)) => {
                (value, ROUNDING * value)
            }
            [.., (_, a), (_, b), (_, c)] => {
                let (before, last) = ((b - a).max(0.0), (c - b).max(0.0));
                let rounding = ROUNDING * c;
                let share = if last > rounding { before / last } else { SHARES[1] };
                let missing = |share: f64| match share > SETTLING {
                    true => last / (share - 1.0),
                    false => f64::INFINITY,
                };
                // It may become slower, to the slowest of all.
                let most = missing(share.min(SHARES[0])).max(rounding);
                let likely = missing(share.clamp(SHARES[0], SHARES[1]));
                (c + likely, most.max(likely))
            }
            // How fast they grow is not seen: as slowly as can be.
            [(_, b), (_, c)] => {
                let missing = (c - b).max(ROUNDING * c) / (SHARES[0] - 1.0);
                (c + missing, missing)
            }
            [(_, c)] => (c, f64::INFINITY),
            [] => (f64::NAN, f64::INFINITY),
        };
        let value = bound.map_or(value, |bound| value.min(bound));
        Self { value, uncertainty, values, bound }
    }

    /// Where the constant lies: not below the last value, which is one of a conforming space.
    pub fn range(&self) -> [f64; 2] {
        let largest = self.values.last().map_or(0.0, |(_, value)| (1.0 - ROUNDING) * value);
        let most = (self.value + self.uncertainty).min(self.bound.unwrap_or(f64::INFINITY));
        [(self.value - self.uncertainty).max(largest).min(self.value), most]
    }

    /// How it was obtained, in words.
    pub fn how(&self) -> String {
        let cells: Vec<String> = self.values.iter().map(|(cells, _)| cells.to_string()).collect();
        let off = match self.uncertainty {
            f64::INFINITY => "they do not show how far off it is".to_string(),
            off => format!("± {off:.1e}"),
        };
        format!("limit of meshes with {} cells, {off}", cells.join(", "))
    }
}

fn attains(value: f64, bound: f64) -> bool {
    value >= (1.0 - ROUNDING) * bound
}

/// What the constants of a domain depend on.
#[derive(Clone, PartialEq)]
struct Asked {
    /// Contact on the sides that count.
    domain: Domain,
    /// Factors of the squares on the contact sides; empty means one.
    weights: Vec<f64>,
    tensor: TensorField,
    part: TracePart,
}

type Answer = Arc<Mutex<Option<TraceConstant>>>;
/// Constants that were asked for in this process, the last ones last.
static KNOWN: Mutex<Vec<(Asked, Answer)>> = Mutex::new(Vec::new());
/// Only so many are kept.
const KEPT: usize = 64;

/// The factor of each side by its number; of all of them 1, if none is given.
pub fn weight_by_side(weights: &[(Side, f64)]) -> impl Fn(u32) -> f64 + Sync + '_ {
    move |side| match weights {
        [] => 1.0,
        _ => weights.iter().find(|(of, _)| of.0 == side).map_or(0.0, |(_, weight)| *weight),
    }
}

/// The constant of a domain with contact for a tensor that is the same everywhere: the identity for c_j² and c_τ². Where
/// contact is bilateral, c_j² = 0, and c_τ² is that of the space with u_ν = 0. Of Σ c_i ‖v_ν‖² over the given contact sides,
/// c_i > 0; of all of them, c_i = 1, if none is given.
///
/// # Errors
/// A stiffness matrix that cannot be factorized.
pub fn weighted_trace_constant(
    domain: &Domain,
    tensor: &TensorField,
    part: TracePart,
    weights: &[(Side, f64)],
) -> Result<TraceConstant> {
    if domain.bilateral && part == TracePart::Normal {
        return Ok(TraceConstant::ZERO);
    }
    let (mesh, traction) = (Family::Structured, Vec::new());
    let mut domain = Domain { mesh, traction, ..domain.clone() };
    if !weights.is_empty() {
        domain.contact = weights.iter().map(|(side, _)| *side).collect();
    }
    let alike = weights.iter().all(|(_, weight)| *weight == 1.0);
    let weights = if alike { &[] } else { weights };
    let weights = weights.iter().map(|(_, weight)| *weight).collect();
    let asked = Asked { domain, weights, tensor: tensor.clone(), part };
    let answer = {
        let mut known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
        let found =
            known.iter().find(|(other, _)| *other == asked).map(|(_, answer)| answer.clone());
        found.unwrap_or_else(|| {
            if known.len() == KEPT {
                known.remove(0);
            }
            let new = Answer::default();
            known.push((asked.clone(), new.clone()));
            new
        })
    };
    // Locked while it is computed: another that asks for the same waits for it.
    let mut answer = answer.lock().unwrap_or_else(PoisonError::into_inner);
    match &*answer {
        Some(found) => Ok(found.clone()),
        None => {
            // Proved of c_j² alone.
            let is_c_j = alike && part == TracePart::Normal && *tensor == TensorField::identity();
            let bound = asked.domain.depth_under_contact().filter(|_| is_c_j);
            Ok(answer.insert(TraceConstant::new(asked.values(bound)?, bound)).clone())
        }
    }
}

impl Asked {
    /// On each space, up to one that attains the bound.
    fn values(&self, bound: Option<f64>) -> Result<Vec<(usize, f64)>> {
        let mut coarse = coarse(&self.domain);
        // The constant is a length: computed in a unit near to that of the domain, a power of two.
        let unit = coarse.longest_edge().log2().floor().exp2();
        coarse.vertices.iter_mut().flatten().for_each(|x| *x /= unit);
        let coarse = match coarse.dimension {
            2 => self.graded(coarse),
            _ => coarse,
        };
        let mut values = Vec::new();
        for (element, n) in spaces(coarse.count(), coarse.dimension) {
            let mesh = coarse.refined(n, Family::Structured);
            let cells = mesh.cell_count();
            let space = discretized(&self.domain, element, mesh);
            let square = [(self.part, TraceMass::Consistent)];
            let weight = |side: u32| {
                let at = self.domain.contact.iter().position(|known| known.0 == side);
                at.and_then(|at| self.weights.get(at)).copied().unwrap_or(1.0)
            };
            let [found] = weighted_trace_constants(&space, &self.tensor, square, &weight)
                .map_err(|source| SetupError::Constant { n, source })?;
            values.push((cells, unit * found.value));
            if bound.is_some_and(|bound| attains(unit * found.value, bound)) {
                break;
            }
        }
        Ok(values)
    }

    /// Bisects what is too large for its distance from a corner with v ~ r^s. With quadratics and a given number of triangles
    /// the error is smallest for diameters ~ r^{1-s/3}; but halvings divide what is left at the corner by 2^{2s} alone, so it
    /// is to be smaller than the rest beforehand. 1/5 for 1/3 halves the error
    /// of a small clamped side, and changes little on six other domains.
    fn graded(&self, mut mesh: CoarseMesh) -> CoarseMesh {
        let corners = self.corners(&mesh);
        let extent = mesh.longest_edge();
        while mesh.count() < CELLS {
            let sizes: Vec<f64> = (0..mesh.count())
                .map(|c| {
                    let [p, q, r] = [0, 1, 2].map(|a| mesh.corners(c)[a]);
                    let long = distance(p, q).max(distance(q, r)).max(distance(r, p));
                    let centre = [0, 1, 2].map(|i| (p[i] + q[i] + r[i]) / 3.0);
                    let finest = corners
                        .iter()
                        .map(|(place, s)| (distance(centre, *place) / extent).powf(1.0 - s / 5.0));
                    long / finest.fold(1.0, f64::min)
                })
                .collect();
            let largest = sizes.iter().copied().fold(0.0, f64::max);
            let marked: Vec<bool> = sizes.iter().map(|size| *size > 0.7 * largest).collect();
            mesh = mesh.bisected(&marked);
        }
        mesh
    }

    /// The vertices of the boundary near which v is singular, with an s that is not far from the least exponent there.
    fn corners(&self, mesh: &CoarseMesh) -> Vec<([f64; 3], f64)> {
        let mut angle = vec![0.0; mesh.vertices.len()];
        for c in 0..mesh.count() {
            let corners = mesh.corners(c);
            for a in 0..3 {
                let [x, y] = [1, 2].map(|b| {
                    let to = corners[(a + b) % 3];
                    [to[0] - corners[a][0], to[1] - corners[a][1]]
                });
                let (sine, cosine) = (x[0] * y[1] - x[1] * y[0], x[0] * y[0] + x[1] * y[1]);
                angle[mesh.cells[c][a] as usize] += sine.atan2(cosine);
            }
        }
        let mut around: Vec<Vec<[bool; 3]>> = vec![Vec::new(); angle.len()];
        let lists = [&self.domain.clamped, &self.domain.held(), &self.domain.contact];
        for BoundaryFacet { corners, side, .. } in &mesh.facets {
            let what = lists.map(|list| list.contains(&Side(*side)));
            corners.iter().for_each(|&v| around[v as usize].push(what));
        }
        let exponent = |v: usize| {
            let of = |list: usize| around[v].iter().filter(|facet| facet[list]).count();
            let [clamped, symmetry, _] = [0, 1, 2].map(of);
            let turns = angle[v] / PI;
            match around[v].len() {
                0 => None,
                // Clamped, or a plane of symmetry at more than a right angle, next to free.
                count if clamped > 0 && clamped < count => Some(0.5 / turns),
                count if turns > 0.5 + 1e-9 && symmetry > 0 && symmetry < count => {
                    Some(0.5 / turns)
                }
                // From a crack, 1/2, to a straight line.
                _ if turns > STRAIGHT => Some((1.9 - 0.9 * turns).clamp(0.5, 1.0)),
                // Contact next to free: the load jumps, r log r.
                _ if clamped == 0 && around[v].windows(2).any(|pair| pair[0] != pair[1]) => {
                    Some(1.0)
                }
                _ => None,
            }
        };
        let found =
            (0..angle.len()).filter_map(|v| Some((mesh.vertices[v], exponent(v)?.min(3.0))));
        found.collect()
    }
}

/// Angles up to this many half turns are straight: boundaries of files have many vertices of nearly half a turn.
const STRAIGHT: f64 = 1.05;

fn distance(p: [f64; 3], q: [f64; 3]) -> f64 {
    (p[0] - q[0]).hypot(p[1] - q[1])
}

/// Nested spaces on the refinements of so many coarse simplices, the last three that are not too large.
fn spaces(coarse: usize, dimension: usize) -> Vec<(Element, u32)> {
    let most = MOST_CELLS[usize::from(dimension == 3)];
    let mut all = vec![(Element::P1, 1)];
    let fits =
        |n: u32| coarse * n.pow(dimension as u32) as usize <= if n == 1 { 4 * most } else { most };
    all.extend([1, 2, 4, 8].into_iter().filter(|&n| fits(n)).map(|n| (Element::P2, n)));
    all[all.len().saturating_sub(3)..].to_vec()
}

/// The simplices of a domain: those it has, or of a box as few as fill it with cells that are not much longer than wide.
fn coarse(Domain { shape, size, .. }: &Domain) -> CoarseMesh {
    if let Shape::Refined(coarse) = shape {
        return CoarseMesh::clone(coarse);
    }
    let mesh = match size[..] {
        [a, b, c] => {
            let unit = a.min(b).min(c).max((6.0 / IN_SPACE * a * b * c).cbrt());
            let mut mesh = lattice([a / unit, b / unit, c / unit], 1, Family::Structured);
            mesh.coordinates.iter_mut().for_each(|x| *x *= unit);
            mesh
        }
        _ => {
            let mut mesh = lattice([1.0; 2], 1, Family::Structured);
            for place in mesh.coordinates.chunks_exact_mut(2) {
                place.iter_mut().zip(size).for_each(|(x, size)| *x *= size);
            }
            mesh
        }
    };
    let facet = |f: usize| BoundaryFacet {
        corners: mesh.facet(f).to_vec(),
        side: mesh.facet_side[f],
        normal: mesh.normal(f),
    };
    CoarseMesh {
        dimension: mesh.dimension,
        vertices: (0..mesh.vertices() as u32).map(|v| mesh.point(&[v], &[1.0])).collect(),
        cells: (0..mesh.cell_count()).map(|c| mesh.cell(c).to_vec()).collect(),
        region: vec![0; mesh.cell_count()],
        regions: mesh.regions.clone(),
        facets: (0..mesh.facet_side.len()).map(facet).collect(),
        sides: mesh.sides.clone(),
        inner: Vec::new(),
    }
}

/// Unknowns of the largest space for the constants of a domain are about those of linear functions on so many cells.
pub fn trace_cells(domain: &Domain) -> f64 {
    let Shape::Refined(coarse) = &domain.shape else { return 0.0 };
    let cells = |(element, n): (Element, u32)| {
        let halvings = n * if element == Element::P1 { 1 } else { 2 };
        domain.cells(halvings)
    };
    spaces(coarse.count(), coarse.dimension).into_iter().map(cells).fold(0.0, f64::max)
}
