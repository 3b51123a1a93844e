//! `[domain] shape`: its keys and its meaning.

use super::{Shape, mesh_file, polygon, side};
use crate::diagnostic::Result;
use crate::reading::Reading;

type Parts = (Shape, Vec<f64>, Vec<String>);

/// The shapes with their keys.
const SHAPES: [(&str, &str); 4] = [
    ("rectangle", "size"),
    ("box", "size"),
    ("polygon", "vertices sides points triangles"),
    ("mesh", "file"),
];

pub(super) fn shape(reading: &Reading, dimension: usize) -> Result<Parts> {
    let known: &[(&str, &str)] = match dimension {
        3 => &[("box", "box"), ("mesh", "mesh")],
        _ => &[("rectangle", "rectangle"), ("polygon", "polygon"), ("mesh", "mesh")],
    };
    let plane = reading.required::<String>("domain.shape")? == "polygon";
    let message = "the shape `polygon` is plane, and dimension = 3";
    let hint = "write shape = \"box\" or \"mesh\", or dimension = 2";
    reading.refuse_if(dimension == 3 && plane, "domain.shape", message, hint)?;
    let shape = reading.choice("domain.shape", known)?;
    reading.only("domain", ("shape", shape), &SHAPES)?;
    let coarse = match shape {
        "polygon" => polygon::polygon(reading)?,
        "mesh" => mesh_file::mesh_file(reading, dimension)?,
        _ => {
            let hint = "give one length a dimension: size = [1.0, 1.0]";
            let lengths = reading.entries_of("domain.size", dimension, hint)?;
            let length = |index| reading.positive(&format!("domain.size.{index}"));
            let size = lengths.map(length).collect::<Result<_, _>>()?;
            let names = side::OF_A_BOX[..2 * dimension].iter().map(|name| (*name).to_string());
            return Ok((Shape::Box, size, names.collect()));
        }
    };
    let [low, high] = coarse.bounds();
    let (size, sides) = ((0..dimension).map(|i| high[i] - low[i]), coarse.sides.clone());
    Ok((Shape::Refined(coarse.into()), size.collect(), sides))
}
