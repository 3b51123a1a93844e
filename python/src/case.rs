//! A case as Python has it: arrays as bytes, shape and kind.

use bytemuck::{cast_slice, pod_collect_to_vec};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use run::external::{Array, Given};
use scene::setup::MeshData;

/// Doubles in native byte order.
pub fn numbers(bytes: &Bound<'_, PyBytes>) -> Vec<f64> {
    pod_collect_to_vec(bytes.as_bytes())
}

/// The case: arrays as pairs of bytes and shape.
pub fn case<'py>(py: Python<'py>, given: &Given, data: &MeshData) -> PyResult<Bound<'py, PyDict>> {
    let (space, case) = (&*data.space, PyDict::new(py));
    let (mesh, d) = (&space.mesh, space.mesh.dimension);
    let doubles = |name: &str, shape: &[usize], values: &[f64]| {
        case.set_item(name, (PyBytes::new(py, cast_slice(values)), shape.to_vec(), "f8"))
    };
    let indices = |name: &str, shape: &[usize], values: &mut dyn Iterator<Item = u32>| {
        let values: Vec<i64> = values.map(i64::from).collect();
        case.set_item(name, (PyBytes::new(py, cast_slice(&values)), shape.to_vec(), "i8"))
    };
    let (vertices, cells, facets) = (mesh.vertices(), mesh.cell_count(), mesh.facet_side.len());
    let points: Vec<f64> =
        (0..vertices).flat_map(|v| mesh.vertex(v as u32).iter().copied()).collect();
    doubles("points", &[vertices, d], &points)?;
    let clamped = |v: usize| u32::from(Given::clamped(space, v));
    indices("clamped", &[vertices], &mut (0..vertices).map(clamped))?;
    let supports = &space.supports;
    indices("symmetry_vertices", &[supports.len()], &mut supports.iter().map(|at| at.vertex))?;
    let normals: Vec<f64> = supports.iter().flat_map(|at| at.normal[..d].iter().copied()).collect();
    doubles("symmetry_normals", &[supports.len(), d], &normals)?;
    let (a_cell, a_facet) = (space.nodes.a_cell, space.nodes.a_facet);
    indices("cells", &[cells, a_cell], &mut (0..cells).flat_map(|c| Given::of_cell(space, c)))?;
    let region = |c: usize| space.regions.get(c).map_or(0, |&region| region as u32);
    indices("regions", &[cells], &mut (0..cells).map(region))?;
    let of_facet = |f: usize| space.nodes.on_facet(f).iter().copied();
    indices("facets", &[facets, a_facet], &mut (0..facets).flat_map(of_facet))?;
    indices("facet_sides", &[facets], &mut mesh.facet_side.iter().copied())?;
    case.set_item("sides", mesh.sides.clone())?;
    let (rows, contact) = (given.contact.len(), &given.contact);
    indices("contact_vertices", &[rows], &mut contact.iter().map(|row| row.vertex))?;
    let normals: Vec<f64> =
        contact.iter().flat_map(|row| row.normal[..d].iter().copied()).collect();
    doubles("contact_normals", &[rows, d], &normals)?;
    let numbers: Vec<f64> = contact.iter().flat_map(|row| row.numbers).collect();
    doubles("contact_numbers", &[rows, 4], &numbers)?;
    indices("contact_clamped", &[rows], &mut contact.iter().map(|row| u32::from(row.clamped)))?;
    indices("contact_table", &[rows], &mut contact.iter().map(|row| row.table as u32))?;
    for (name, Array { shape, numbers }) in &given.arrays {
        doubles(name, shape, numbers)?;
    }
    case.set_item("json", given.document.to_string())?;
    Ok(case)
}
