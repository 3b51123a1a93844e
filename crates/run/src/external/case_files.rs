//! A case as files: mesh, times, loads and numbers, so that a solver needs no formula but κ(ζ).

use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::Serialize;
use serde_json::{Value, json};

use super::answer::{Array, encode};
use fem::contact::{CaseError, Discretization, LoadError};
use fem::space::quadrature::Rule;
use files::replace_file;
use scene::Contact;
use scene::setup::{MeshData, Setup};
use vhi::history::TimeGrid;
use vhi::law::{FourthOrder, TensorField};

/// Description of the files for authors of solvers.
const FORMAT: &str = include_str!("format.md");
/// Up to this N kernels are written for all pairs of levels on non-uniform grids.
const MOST_PAIRS: usize = 4096;

/// Names of the arrays of loads as functions: points and weights of the rule in a cell, points × (d + 2), with the weights last;
/// f0, (N + 1) × cells × points × d; the same of the facets of the boundary.
const DENSITIES: [&str; 4] = ["cell_rule", "cell_loads", "facet_rule", "facet_loads"];

/// A row of the table of Γ3.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactRow {
    pub vertex: u32,
    /// Unit normal.
    pub normal: [f64; 3],
    /// The integral of its hat function, gap at t = 0 (∞: none), shift and factor of the law.
    pub numbers: [f64; 4],
    /// The displacement is zero there.
    pub clamped: bool,
    /// Of its side, among the tables `[[contact]]` of the scene; 0 with one `[contact]`.
    pub table: usize,
}

/// The data of a case beside the mesh.
#[derive(Debug, Clone)]
pub struct Given {
    /// Contents of `case.json`.
    pub document: Value,
    /// By their names: `times`, t_0 … t_N; `kernels`, b_i at the lags of the grid, with memory; `gap` at the rows of Γ3,
    /// (N + 1) × rows, where it depends on t; `friction`, the factor of its bound there, with friction; loads of the strong form
    /// before they are assembled, as `cell_rule` and so on; `loads` of every level, (N + 1) × vertices × d.
    pub arrays: Vec<(&'static str, Array)>,
    pub contact: Vec<ContactRow>,
}

impl Given {
    /// The case on a mesh with N steps.
    ///
    /// # Errors
    /// A load that is not finite, a grid too long for its kernels.
    pub(crate) fn new(setup: &Setup, data: &MeshData, steps: u32) -> Result<Self, CaseError> {
        let (model, space, grid) = (&setup.model, &*data.space, setup.grid(steps));
        let times = Array { shape: vec![grid.times().len()], numbers: grid.times().to_vec() };
        let moves = setup.body.gap_moves(&setup.scene.formulas);
        let gap = moves.then(|| by_level(|side, x, t| model.gap(side, x, t), space, &grid));
        // c(x, t) of S = c S_0(|u_τ|), or of S = c p(u_ν).
        let factor = model.friction.as_ref().map(|friction| &friction.factor);
        let friction = factor.map(|factor| by_level(|_, x, t| factor(x, t), space, &grid));
        let kernels = (!model.memory.is_empty()).then(|| kernels(setup, &grid)).transpose()?;
        let some = [("kernels", kernels), ("gap", gap), ("friction", friction)];
        let mut arrays = vec![("times", times)];
        arrays.extend(some.into_iter().filter_map(|(name, array)| Some((name, array?))));
        arrays.extend(DENSITIES.into_iter().zip(densities(data, &grid)?.into_iter().flatten()));
        arrays.push(("loads", loads(data, &grid)?));
        Ok(Self { document: case(setup, data, &grid), arrays, contact: contact(setup, space) })
    }

    /// Whether a vertex of the mesh has no unknowns.
    pub fn clamped(space: &Discretization, vertex: usize) -> bool {
        space.nodes.of_vertex[vertex] as usize >= space.nodes.free
    }

    /// The vertices of cell c: corners, then the further nodes.
    pub fn of_cell(space: &Discretization, c: usize) -> Vec<u32> {
        let nodes = &space.nodes;
        nodes.of_cell(c).iter().map(|&node| nodes.vertex[node as usize]).collect()
    }
}

/// Writes the files of a case into `dir`, which is created.
///
/// # Errors
/// A load that is not finite, a file that cannot be written, a grid too long for its kernels.
pub fn write_case(dir: &Path, setup: &Setup, data: &MeshData, steps: u32) -> Result<(), CaseError> {
    let (space, given) = (&*data.space, Given::new(setup, data, steps)?);
    std::fs::create_dir_all(dir).map_err(|error| outside(dir, error))?;
    let file = |name: &str, bytes: &[u8]| {
        replace_file(&dir.join(name), bytes).map_err(|error| CaseError::Outside(error.to_string()))
    };
    let written = |name: &str, rows: Result<Vec<u8>, csv::Error>| {
        file(name, &rows.map_err(|error| outside(&dir.join(name), error))?)
    };
    file("README.md", FORMAT.as_bytes())?;
    let text =
        serde_json::to_string_pretty(&given.document).map_err(|error| outside(dir, error))?;
    file("case.json", text.as_bytes())?;
    let (mesh, nodes) = (&space.mesh, &space.nodes);
    let d = mesh.dimension;
    file("mesh.msh", fem::mesh::write_gmsh(mesh).as_bytes())?;
    let numbered = |count: usize| (0..count).map(|i| format!("v{i}")).collect::<Vec<_>>();
    let row = |v: usize| (v, mesh.vertex(v as u32), u8::from(Given::clamped(space, v)));
    let head = ("vertex", &["x", "y", "z"][..d], "clamped");
    written("vertices.csv", table(head, (0..mesh.vertices()).map(row)))?;
    let row = |c: usize| (c, Given::of_cell(space, c), space.regions.get(c).copied().unwrap_or(0));
    let head = ("cell", numbered(nodes.a_cell), "region");
    written("cells.csv", table(head, (0..mesh.cell_count()).map(row)))?;
    let row = |(f, &side): (usize, &u32)| (f, nodes.on_facet(f), &mesh.sides[side as usize]);
    let head = ("facet", numbered(nodes.a_facet), "side");
    written("facets.csv", table(head, mesh.facet_side.iter().enumerate().map(row)))?;
    let normal = &["nx", "ny", "nz"][..d];
    if !space.supports.is_empty() {
        // The conditions u·n = 0.
        let rows = space.supports.iter().map(|row| (row.vertex, &row.normal[..d]));
        written("symmetry.csv", table(("vertex", normal), rows))?;
    }
    // With the column `table` where there are several: readers of others count on nine columns in the plane.
    let several = usize::from(setup.body.contact.len() > 1);
    let rows = given.contact.iter().enumerate().map(|(i, row)| {
        let clamped = u8::from(row.clamped);
        (i, row.vertex, &row.normal[..d], row.numbers, clamped, vec![row.table; several])
    });
    let numbers = ["weight", "gap", "shift", "scale", "clamped"];
    let head = ("row", "vertex", normal, numbers, vec!["table"; several]);
    written("contact.csv", table(head, rows))?;
    let mut arrays = given.arrays.iter();
    arrays.try_for_each(|(name, Array { shape, numbers })| {
        file(&format!("{name}.npy"), &encode(shape, numbers))
    })
}

fn outside(path: &Path, error: impl std::fmt::Display) -> CaseError {
    CaseError::Outside(format!("{}: {error}", path.display()))
}

fn case(setup: &Setup, data: &MeshData, grid: &TimeGrid) -> Value {
    let (scene, model, mesh) = (&setup.scene, &setup.model, &data.space.mesh);
    let d = mesh.dimension;
    // The text has been parsed before.
    let written: Value = toml::from_str(&scene.source.text).unwrap_or(Value::Null);
    let regions = 1 + setup.body.material.regions.len();
    let names = setup.body.material.regions.iter().map(|region| region.name.as_str());
    let names: Vec<&str> = std::iter::once("").chain(names).collect();
    let tensors = |field: &TensorField| -> Vec<Value> {
        (0..regions).map(|region| tensor(field.on(region), d)).collect()
    };
    let memory: Vec<Value> =
        model.memory.iter().map(|term| Value::from(tensors(&term.tensor))).collect();
    json!({
        "format": 1,
        "scene": scene.name,
        "dimension": d,
        "element": data.space.element.name(),
        "n": mesh.n,
        "steps": grid.steps(),
        "horizon": scene.time.horizon,
        "uniform": is_uniform(setup),
        "h": mesh.h(),
        "k": grid.largest_step(),
        "vertices": mesh.vertices(),
        "midpoints": mesh.vertices() - mesh.corners(),
        "cells": mesh.cell_count(),
        "contact_rows": data.space.trace.points.len(),
        "symmetry_rows": data.space.supports.len(),
        "regions": names,
        "elasticity": tensors(&model.elasticity),
        "memory": memory,
        "singular": model.memory.iter().map(|term| term.kernel.power()).collect::<Vec<_>>(),
        "projection": written["material"]["projection"],
        "contact": written["contact"],
        "as_written": written,
        "displacement": [grid.steps() + 1, mesh.vertices(), d],
    })
}

fn tensor(tensor: &FourthOrder, d: usize) -> Value {
    match tensor {
        FourthOrder::Isotropic(law) => json!({ "lambda": law.lambda, "mu": law.mu }),
        FourthOrder::Full(_) if d == 2 => json!({ "mandel": tensor.matrix::<3>() }),
        FourthOrder::Full(_) => json!({ "mandel": tensor.matrix::<6>() }),
    }
}

/// A table of a head and rows, tuples and lists one after another; numbers read back to the same doubles.
fn table<R: Serialize>(
    head: impl Serialize,
    mut rows: impl Iterator<Item = R>,
) -> Result<Vec<u8>, csv::Error> {
    let mut writer = csv::WriterBuilder::new().has_headers(false).from_writer(Vec::new());
    writer.serialize(head)?;
    rows.try_for_each(|row| writer.serialize(row))?;
    writer.into_inner().map_err(|error| error.into_error().into())
}

fn contact(setup: &Setup, space: &Discretization) -> Vec<ContactRow> {
    let row = |point: &fem::contact::TracePoint| {
        let x = space.mesh.point(&[point.vertex], &[1.0]);
        let boundary = setup.model.boundary_on(point.side);
        let mut tables = setup.body.contact.iter();
        let on = |contact: &Contact| contact.sides.iter().any(|side| side.0 == point.side);
        let [gap, shift, scale] = match boundary {
            Some(boundary) => [(boundary.gap)(x, 0.0), (boundary.shift)(x), boundary.scale_at(x)],
            None => [f64::INFINITY, 0.0, 1.0],
        };
        ContactRow {
            vertex: point.vertex,
            normal: point.normal,
            numbers: [point.weight, gap, shift, scale],
            clamped: point.clamped,
            table: tables.position(on).unwrap_or(0),
        }
    };
    space.trace.points.iter().map(row).collect()
}

/// A function of side, place and time at the rows of Γ3 and all levels.
fn by_level(
    of: impl Fn(u32, [f64; 3], f64) -> f64,
    space: &Discretization,
    grid: &TimeGrid,
) -> Array {
    let points = &space.trace.points;
    let places: Vec<(u32, [f64; 3])> = points
        .iter()
        .map(|point| (point.side, space.mesh.point(&[point.vertex], &[1.0])))
        .collect();
    let times = grid.times().iter();
    let pairs = times.flat_map(|&t| places.iter().map(move |&(side, x)| (side, x, t)));
    let numbers = pairs.map(|(side, x, t)| of(side, x, t)).collect();
    Array { shape: vec![grid.steps() + 1, points.len()], numbers }
}

/// Whether lags of the grid are its times.
fn is_uniform(setup: &Setup) -> bool {
    setup.scene.time.grid == scene::TimeGrid::Uniform
}

/// For a kernel that is infinite at lag zero, the factor of its power.
fn kernels(setup: &Setup, grid: &TimeGrid) -> Result<Array, CaseError> {
    let (terms, levels) = (&setup.model.memory, grid.steps() + 1);
    if terms.iter().any(|term| term.kernel.nested().is_some()) {
        let reason = "the memory has a history of a history, and kernels.npy has room for one kernel a term: take a scene without `inner`";
        return Err(CaseError::Outside(reason.into()));
    }
    if is_uniform(setup) {
        let values =
            terms.iter().flat_map(|term| grid.times().iter().map(|&t| term.kernel.factor(t)));
        return Ok(Array { shape: vec![terms.len(), levels], numbers: values.collect() });
    }
    if grid.steps() > MOST_PAIRS {
        return Err(CaseError::Outside(format!(
            "the kernels of all pairs of {levels} levels are too many to write: use at most {MOST_PAIRS} steps, or a uniform grid"
        )));
    }
    let mut values = Vec::with_capacity(terms.len() * levels * levels);
    for term in terms {
        for n in 0..levels {
            let until = grid.time(n);
            let lag =
                |j: usize| if j <= n { term.kernel.factor(until - grid.time(j)) } else { 0.0 };
            values.extend((0..levels).map(lag));
        }
    }
    Ok(Array { shape: vec![terms.len(), levels, levels], numbers: values })
}

/// F(t) on the unknowns, without what supports planes of symmetry.
pub(super) fn load(data: &MeshData, t: f64) -> Result<Arc<Vec<f64>>, LoadError> {
    let load = data.truth.load(t)?;
    if data.space.supports.is_empty() {
        return Ok(load);
    }
    let mut kept = load.to_vec();
    data.space.frames.without_support(&mut kept);
    Ok(Arc::new(kept))
}

fn loads(data: &MeshData, grid: &TimeGrid) -> Result<Array, CaseError> {
    let (nodes, d) = (&data.space.nodes, data.space.mesh.dimension);
    let mut values = Vec::with_capacity((grid.steps() + 1) * nodes.of_vertex.len() * d);
    for &t in grid.times() {
        let load = load(data, t)?;
        for &node in &nodes.of_vertex {
            let at = node as usize * d;
            values.extend((at..at + d).map(|dof| load.get(dof).copied().unwrap_or(0.0)));
        }
    }
    Ok(Array { shape: vec![grid.steps() + 1, nodes.of_vertex.len(), d], numbers: values })
}

fn densities(data: &MeshData, grid: &TimeGrid) -> Result<Option<[Array; 4]>, CaseError> {
    let (mesh, mut rules) = (&data.space.mesh, None);
    let (mut body, mut traction) = (Vec::new(), Vec::new());
    for &t in grid.times() {
        let Some(found) = data.truth.densities(t)? else { return Ok(None) };
        body.extend(found.body);
        traction.extend(found.traction);
        rules = Some(found.rules);
    }
    let (levels, d) = (grid.steps() + 1, mesh.dimension);
    let of = |rule: &Rule, simplices: usize, values: Vec<f64>| {
        let points = rule.weights.len();
        let rows = rule.points.iter().zip(&rule.weights);
        let numbers: Vec<f64> = rows.flat_map(|(b, &w)| b.iter().copied().chain([w])).collect();
        let rule = Array { shape: vec![points, numbers.len() / points], numbers };
        [rule, Array { shape: vec![levels, simplices, points, d], numbers: values }]
    };
    Ok(rules.map(|[in_cell, on_facet]| {
        let [cell_rule, cell_loads] = of(&in_cell, mesh.cell_count(), body);
        let [facet_rule, facet_loads] = of(&on_facet, mesh.facet_side.len(), traction);
        [cell_rule, cell_loads, facet_rule, facet_loads]
    }))
}

/// Where the files of a case stand below `folder`.
pub fn case_dir(folder: &Path, scene: &str, n: u32, steps: u32) -> PathBuf {
    folder.join(scene).join(format!("n{n}-N{steps}"))
}
