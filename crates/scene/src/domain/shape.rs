//! `[domain] shape`: its keys and its meaning.

use super::{Shape, mesh_file, polygon, side};
use crate::diagnostic::SceneError;
use crate::reading::Reading;
use crate::written;
use fem::mesh::CoarseMesh;

type Parts = (Shape, Vec<f64>, Vec<String>);

pub(super) fn shape(
    reading: &Reading,
    written: &written::Domain,
    dimension: usize,
) -> Result<Parts, SceneError> {
    let known: &[(&str, &str)] = match dimension {
        3 => &[("box", "box"), ("mesh", "mesh")],
        _ => &[("rectangle", "rectangle"), ("polygon", "polygon"), ("mesh", "mesh")],
    };
    if dimension == 3 && written.shape == "polygon" {
        let message = "the shape `polygon` is plane, and dimension = 3";
        let hint = "write shape = \"box\" or \"mesh\", or dimension = 2";
        return Err(reading.error("domain.shape", message, hint));
    }
    let word = reading.choice("domain.shape", &written.shape, known)?;
    let keys = [
        ("size", written.size.is_some(), ["rectangle", "box"].as_slice()),
        ("vertices", written.vertices.is_some(), &["polygon"]),
        ("sides", written.sides.is_some(), &["polygon"]),
        ("triangles", written.triangles.is_some(), &["polygon"]),
        ("points", written.points.is_some(), &["polygon"]),
        ("file", written.file.is_some(), &["mesh"]),
    ];
    if let Some((key, _, owner)) =
        keys.iter().find(|(_, present, owner)| *present && !owner.contains(&word))
    {
        let message = format!("shape `{word}` takes no `{key}`");
        let hint = format!("remove `{key}`, or write shape = \"{}\"", owner[0]);
        return Err(reading.key_error(&format!("domain.{key}"), message, hint));
    }
    let missing = |key: &str, line: &str| {
        let message = format!("shape `{word}` needs the key `{key}`");
        reading.error("domain.shape", message, format!("for instance: {line}"))
    };
    let coarse = match word {
        "polygon" => {
            let vertices = written.vertices.as_ref().ok_or_else(|| {
                missing("vertices", "vertices = [[0.0, 0.0], [1.0, 0.0], [0.5, 1.0]]")
            })?;
            CoarseMesh::from(polygon::polygon(reading, written, vertices)?)
        }
        "mesh" => {
            let file =
                written.file.as_ref().ok_or_else(|| missing("file", "file = \"block.msh\""))?;
            mesh_file::mesh_file(reading, file, dimension)?
        }
        _ => {
            let line = if dimension == 3 { "size = [1.0, 1.0, 1.0]" } else { "size = [1.0, 1.0]" };
            let written = written.size.as_ref().ok_or_else(|| missing("size", line))?;
            let size = size(reading, written, dimension)?;
            let names = side::OF_A_BOX[..2 * dimension].iter().map(|name| (*name).to_string());
            return Ok((Shape::Box, size, names.collect()));
        }
    };
    let [low, high] = coarse.bounds();
    let (size, sides) = ((0..dimension).map(|i| high[i] - low[i]), coarse.sides().to_vec());
    Ok((Shape::Refined(coarse), size.collect(), sides))
}

fn size(reading: &Reading, size: &[f64], dimension: usize) -> Result<Vec<f64>, SceneError> {
    if size.len() != dimension {
        let message = format!("`size` has {} entries in dimension {dimension}", size.len());
        return Err(reading.error(
            "domain.size",
            message,
            "give one length a dimension: size = [1.0, 1.0]",
        ));
    }
    size.iter()
        .enumerate()
        .map(|(index, &length)| reading.positive(&format!("domain.size.{index}"), length))
        .collect()
}
