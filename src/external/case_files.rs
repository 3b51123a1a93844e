//! A case as files: mesh, times, loads and numbers, so that a solver needs no formula but κ(ζ).

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use super::npy::encode;
use crate::contact::{CaseError, Discretization};
use crate::history::TimeGrid;
use crate::law::{FourthOrder, TensorField};
use crate::record::replace_file;
use crate::setup::{MeshData, Setup};

/// What the files mean, for who writes a solver.
const FORMAT: &str = include_str!("format.md");
/// Kernels of all pairs of levels are written up to this N on grids that are not uniform.
const MOST_PAIRS: usize = 4096;

/// Writes the files of a case into `dir`, which is created.
///
/// # Errors
/// A load that is not finite, a file that cannot be written, a grid too long for its kernels.
pub fn write_case(dir: &Path, setup: &Setup, data: &MeshData, steps: u32) -> Result<(), CaseError> {
    let (space, grid) = (&*data.space, setup.grid(steps));
    std::fs::create_dir_all(dir).map_err(|error| outside(dir, error))?;
    let file = |name: &str, bytes: &[u8]| {
        let path = dir.join(name);
        replace_file(&path, bytes).map_err(|error| outside(&path, error))
    };
    file("README.md", FORMAT.as_bytes())?;
    let document = case(setup, data, &grid);
    let text = serde_json::to_string_pretty(&document).map_err(|error| outside(dir, error))?;
    file("case.json", text.as_bytes())?;
    file("mesh.msh", crate::mesh::write_gmsh(&space.mesh).as_bytes())?;
    file("vertices.csv", vertices(space).as_bytes())?;
    file("cells.csv", cells(space).as_bytes())?;
    file("facets.csv", facets(space).as_bytes())?;
    file("contact.csv", contact(setup, space).as_bytes())?;
    file("times.npy", &encode(&[grid.steps() + 1], grid.times()))?;
    if !setup.model.memory.is_empty() {
        file("kernels.npy", &kernels(setup, &grid)?)?;
    }
    file("loads.npy", &loads(data, &grid)?)
}

fn outside(path: &Path, error: impl std::fmt::Display) -> CaseError {
    CaseError::Outside(format!("{}: {error}", path.display()))
}

fn case(setup: &Setup, data: &MeshData, grid: &TimeGrid) -> Value {
    let (scene, model, mesh) = (&setup.scene, &setup.model, &data.space.mesh);
    let d = mesh.dimension;
    // The text has been read as TOML before.
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
        "n": mesh.n,
        "steps": grid.steps(),
        "horizon": scene.time.horizon,
        "uniform": is_uniform(grid),
        "h": mesh.h(),
        "k": grid.largest_step(),
        "vertices": mesh.vertices(),
        "cells": mesh.cell_count(),
        "contact_rows": data.space.trace.points.len(),
        "regions": names,
        "elasticity": tensors(&model.elasticity),
        "memory": memory,
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

/// A row of numbers: shortest texts that read back to the same doubles.
fn row(text: &mut String, cells: impl IntoIterator<Item = String>) {
    let cells: Vec<String> = cells.into_iter().collect();
    let _ = writeln!(text, "{}", cells.join(","));
}

const COORDINATES: [&str; 3] = ["x", "y", "z"];

fn vertices(space: &Discretization) -> String {
    let (mesh, d) = (&space.mesh, space.mesh.dimension);
    let mut text = format!("vertex,{},clamped\n", COORDINATES[..d].join(","));
    for v in 0..mesh.vertices() {
        let clamped = space.nodes.of_vertex[v] as usize >= space.nodes.free;
        let at = mesh.vertex(v as u32).iter().map(f64::to_string);
        let last = [u8::from(clamped).to_string()];
        row(&mut text, std::iter::once(v.to_string()).chain(at).chain(last));
    }
    text
}

fn numbered(names: &str, count: usize) -> String {
    (0..count).map(|i| format!("{names}{i},")).collect()
}

fn cells(space: &Discretization) -> String {
    let mesh = &space.mesh;
    let mut text = format!("cell,{}region\n", numbered("v", mesh.dimension + 1));
    for c in 0..mesh.cell_count() {
        let corners = mesh.cell(c).iter().map(u32::to_string);
        let region = [space.regions.get(c).copied().unwrap_or(0).to_string()];
        row(&mut text, std::iter::once(c.to_string()).chain(corners).chain(region));
    }
    text
}

fn facets(space: &Discretization) -> String {
    let mesh = &space.mesh;
    let mut text = format!("facet,{}side\n", numbered("v", mesh.dimension));
    for (f, &side) in mesh.facet_side.iter().enumerate() {
        let corners = mesh.facet(f).iter().map(u32::to_string);
        let side = [mesh.sides[side as usize].clone()];
        row(&mut text, std::iter::once(f.to_string()).chain(corners).chain(side));
    }
    text
}

fn contact(setup: &Setup, space: &Discretization) -> String {
    let d = space.mesh.dimension;
    let normal: String = COORDINATES[..d].iter().map(|x| format!("n{x},")).collect();
    let mut text = format!("row,vertex,{normal}weight,gap,shift,scale,clamped\n");
    for (i, point) in space.trace.points.iter().enumerate() {
        let x = space.mesh.point(&[point.vertex], &[1.0]);
        let [gap, shift, scale] = match &setup.model.boundary {
            Some(boundary) => [(boundary.gap)(x), (boundary.shift)(x), boundary.scale_at(x)],
            None => [f64::INFINITY, 0.0, 1.0],
        };
        let numbers = [point.weight, gap, shift, scale].map(|number| number.to_string());
        let first = [i.to_string(), point.vertex.to_string()].into_iter();
        let normal = point.normal[..d].iter().map(f64::to_string);
        let last = [u8::from(point.clamped).to_string()];
        row(&mut text, first.chain(normal).chain(numbers).chain(last));
    }
    text
}

/// Whether lags of the grid are its times, to rounding.
fn is_uniform(grid: &TimeGrid) -> bool {
    let equal = grid.time(grid.steps()) / grid.steps() as f64;
    (1..=grid.steps()).all(|n| (grid.step(n) - equal).abs() <= 1e-12 * grid.time(grid.steps()))
}

fn kernels(setup: &Setup, grid: &TimeGrid) -> Result<Vec<u8>, CaseError> {
    let (terms, levels) = (&setup.model.memory, grid.steps() + 1);
    if is_uniform(grid) {
        let values =
            terms.iter().flat_map(|term| grid.times().iter().map(|&t| term.kernel.value(t)));
        return Ok(encode(&[terms.len(), levels], &values.collect::<Vec<f64>>()));
    }
    if grid.steps() > MOST_PAIRS {
        return Err(CaseError::Outside(format!(
            "kernels of all pairs of {levels} levels are too many to write: take at most {MOST_PAIRS} steps, or a uniform grid"
        )));
    }
    let mut values = Vec::with_capacity(terms.len() * levels * levels);
    for term in terms {
        for n in 0..levels {
            let until = grid.time(n);
            let lag = |j: usize| if j <= n { term.kernel.value(until - grid.time(j)) } else { 0.0 };
            values.extend((0..levels).map(lag));
        }
    }
    Ok(encode(&[terms.len(), levels, levels], &values))
}

fn loads(data: &MeshData, grid: &TimeGrid) -> Result<Vec<u8>, CaseError> {
    let (nodes, d) = (&data.space.nodes, data.space.mesh.dimension);
    let mut values = Vec::with_capacity((grid.steps() + 1) * nodes.len());
    for &t in grid.times() {
        let load = data.truth.load(t)?;
        for &node in &nodes.of_vertex {
            let at = node as usize * d;
            values.extend((at..at + d).map(|dof| load.get(dof).copied().unwrap_or(0.0)));
        }
    }
    Ok(encode(&[grid.steps() + 1, nodes.of_vertex.len(), d], &values))
}

/// Where the files of a case stand below `folder`.
pub fn case_dir(folder: &Path, scene: &str, n: u32, steps: u32) -> PathBuf {
    folder.join(scene).join(format!("n{n}-N{steps}"))
}
