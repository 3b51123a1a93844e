//! The material of a scene: laws for the solver, numbers for the manufactured side, and the region of every cell.

use std::sync::Arc;

use super::KernelFormula;
use crate::{Material, Place, RelaxationTerm, Scene, SceneError, Shape};
use exact::{MaterialNumbers, RegionNumbers};
use fem::contact::MemoryTerm;
use fem::mesh::Mesh;
use files::digits;
use formula::Graph;
use vhi::law::{
    ExponentialSum, FourthOrder, Isotropic, MemoryKernel, Nested, Singular, TensorField,
};

/// 𝒜.
pub fn elasticity(material: &Material) -> TensorField {
    let others = material.regions.iter().map(|region| region.elastic);
    TensorField::new(material.elastic, others)
}

/// ℬ_i of a term of the memory.
pub fn memory_tensor(memory: &RelaxationTerm) -> TensorField {
    let (lambda, mu) = (memory.lambda, memory.mu);
    let others = memory.regions.iter().map(|&[lambda, mu]| Isotropic { lambda, mu }.into());
    TensorField::new(Isotropic { lambda, mu }.into(), others)
}

/// The terms of ℬ for the solver: recursion for sums of exponentials.
pub(super) fn memory_terms(material: &Material, formulas: &Arc<Graph>) -> Vec<MemoryTerm> {
    let formula = |node| Box::new(KernelFormula { graph: formulas.clone(), node });
    let plain = |memory: &RelaxationTerm| match (&memory.exponentials, memory.singular) {
        (Some(terms), _) => {
            Box::new(ExponentialSum { terms: terms.clone() }) as Box<dyn MemoryKernel>
        }
        (None, Some(singular)) => {
            Box::new(Singular { power: singular.power, factor: formula(singular.factor) })
        }
        (None, None) => formula(memory.kernel),
    };
    let inner = |r| match formulas.exponential_sum(r) {
        Some(terms) => Box::new(ExponentialSum { terms }) as Box<dyn MemoryKernel>,
        None => formula(r),
    };
    let kernel = |memory: &RelaxationTerm| match memory.inner {
        None => plain(memory),
        Some(r) => Box::new(Nested { outer: plain(memory), inner: inner(r) }),
    };
    let term = |memory| MemoryTerm { kernel: kernel(memory), tensor: memory_tensor(memory) };
    material.memory.iter().map(term).collect()
}

/// The numbers outside all regions, and in each of them, with its condition as a formula of `graph`.
pub(super) fn numbers(
    material: &Material,
    shape: &Shape,
    graph: &mut Graph,
) -> (MaterialNumbers, Vec<RegionNumbers>) {
    let projection = material.projection.as_ref().filter(|projection| projection.mu > 0.0);
    let of = |elastic: &FourthOrder, memory: Vec<(f64, f64)>| {
        let (lambda, mu_l, full) = match elastic {
            FourthOrder::Isotropic(law) => (law.lambda, law.mu, None),
            FourthOrder::Full(matrix) => (0.0, 0.0, Some(*matrix)),
        };
        MaterialNumbers { lambda, mu_l, full, memory, projection: projection.map(|p| p.mu) }
    };
    let base = material.memory.iter().map(|memory| (memory.lambda, memory.mu)).collect();
    let regions = material.regions.iter().enumerate().map(|(r, region)| {
        let memory = material.memory.iter().map(|memory| memory.regions[r].into()).collect();
        let condition = region.place.condition(graph, shape);
        RegionNumbers { condition, material: of(&region.elastic, memory) }
    });
    (of(&material.elastic, base), regions.collect())
}

/// Rounding of a condition, relative to its largest value on the mesh, within which a vertex is on an interface.
const ON_INTERFACE: f64 = 1e-9;

/// The region of every cell, by its centroid; empty without regions.
///
/// # Errors
/// A cell that an interface cuts, or that two regions claim.
pub fn cell_regions(
    scene: &Scene,
    material: &Material,
    mesh: &Mesh,
    n: u32,
) -> Result<Vec<u8>, SceneError> {
    let mut regions = vec![0; if material.regions.is_empty() { 0 } else { mesh.cell_count() }];
    let centroid = vec![1.0 / (mesh.dimension + 1) as f64; mesh.dimension + 1];
    for (index, region) in material.regions.iter().enumerate() {
        let name = &region.name;
        let value = |node, place: [f64; 3]| scene.formulas.evaluate(node, &place.into());
        let vertices: Vec<f64> = match region.place {
            Place::Physical(_) => Vec::new(),
            Place::Where(condition) => (0..mesh.vertices() as u32)
                .map(|v| value(condition, mesh.point(&[v], &[1.0])))
                .collect(),
        };
        let size = vertices.iter().fold(0.0, |size: f64, value| size.max(value.abs()));
        for (c, region_of_cell) in regions.iter_mut().enumerate() {
            let at = mesh.point(mesh.cell(c), &centroid);
            let place = || at.map(|x| digits(x, 5))[..mesh.dimension].join(", ");
            let (inside, key) = match region.place {
                Place::Physical(group) => (mesh.cell_region[c] == group, "physical"),
                Place::Where(condition) => {
                    let ends = mesh.cell(c).iter().map(|&v| vertices[v as usize]);
                    let low = ends.clone().fold(f64::INFINITY, f64::min);
                    let high = ends.fold(f64::NEG_INFINITY, f64::max);
                    let middle = value(condition, at);
                    // NaN counts as cut.
                    let cut = !(low >= -ON_INTERFACE * size || high <= ON_INTERFACE * size);
                    if cut || middle.is_nan() {
                        let [from, to] = [low, high].map(|value| digits(value, 5));
                        let message = format!(
                            "on the mesh n = {n} the boundary of region `{name}` cuts the cell at ({}), where the condition changes from {from} to {to}",
                            place()
                        );
                        let hint = "mesh lines must follow the interface, or the coefficients jump inside cells and order 1 is lost: choose another n, or move the interface onto a mesh line";
                        let key = format!("material.region.{index}.where");
                        return Err(scene.error(&key, message, hint));
                    }
                    (middle > 0.0, "where")
                }
            };
            if !inside {
                continue;
            }
            let other = usize::from(std::mem::replace(region_of_cell, index as u8 + 1));
            if let Some(other) = other.checked_sub(1).map(|other| &material.regions[other].name) {
                let message = format!(
                    "the cell at ({}) of the mesh n = {n} is in the regions `{other}` and `{name}`",
                    place()
                );
                let key = format!("material.region.{index}.{key}");
                return Err(scene.error(&key, message, "regions must not overlap"));
            }
        }
    }
    Ok(regions)
}
