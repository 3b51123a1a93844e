//! `shape = "polygon"`: vertices, named edges, and a coarse triangulation.

use crate::diagnostic::{Result, SceneError};
use crate::reading::Reading;
use serde::de::IgnoredAny;

use fem::mesh::{CoarseMesh, PolygonError, triangulate};

pub(super) fn polygon(reading: &Reading) -> Result<CoarseMesh> {
    let _: IgnoredAny = reading.required("domain.vertices")?;
    let boundary = &places(reading, "domain.vertices")?[..];
    measurable(reading, boundary)?;
    let triangles = triangulate(boundary).map_err(|error| refused(reading, &error))?;
    let mut vertices = boundary.to_vec();
    let triangles = match (reading.has("domain.triangles"), reading.has("domain.points")) {
        (false, false) => triangles,
        (false, true) => {
            let message = "`points` are vertices of `triangles`, and there are none";
            let hint = "add triangles = [[i, j, k], ...], numbered from 0, first the vertices, then the points";
            return Err(reading.key_error("domain.points", message, hint));
        }
        (true, _) => {
            vertices.extend(places(reading, "domain.points")?);
            numbered(reading, vertices.len())?
        }
    };
    let (sides, of_edge) = names(reading, boundary.len())?;
    CoarseMesh::polygon(&vertices, &triangles, &of_edge, sides).map_err(|error| {
        let hint = "the triangles must cover the polygon, edge to edge, and each edge of the polygon must be an edge of one of them";
        reading.error("domain.triangles", error.to_string(), hint)
    })
}

/// Range in which areas of polygons and of all their cells are doubles.
const EXTENTS: std::ops::RangeInclusive<f64> = 1e-150..=1e150;

fn measurable(reading: &Reading, boundary: &[[f64; 2]]) -> Result<()> {
    let range = |axis: usize| {
        let ends = boundary.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], p| {
            [low.min(p[axis]), high.max(p[axis])]
        });
        ends[1] - ends[0]
    };
    let extent = range(0).max(range(1));
    // Coinciding or too few points get better messages below.
    let known = extent <= 0.0 || EXTENTS.contains(&extent);
    let message = format!("the polygon is {extent:.1e} across, outside 1e-150 to 1e150");
    let hint = "areas leave the range of doubles there; state the scene in another unit of length";
    reading.refuse_if(!known, "domain.vertices", message, hint)
}

fn places(reading: &Reading, key: &str) -> Result<Vec<[f64; 2]>> {
    reading.entries(key)?.map(|i| reading.pair(&format!("{key}.{i}"), A_POINT)).collect()
}

pub(super) const A_POINT: &str = "a point of the plane has two numbers: write [x, y]";

/// Triangles of the file, with checked vertex numbers.
fn numbered(reading: &Reading, count: usize) -> Result<Vec<[u32; 3]>> {
    let triangle = |t| {
        let key = format!("domain.triangles.{t}");
        reading.entries_of(&key, 3, "a triangle has three vertices: write [i, j, k]")?;
        let corner = |a: usize| vertex(reading, &format!("{key}.{a}"), count);
        Ok([corner(0)?, corner(1)?, corner(2)?])
    };
    reading.entries("domain.triangles")?.map(triangle).collect()
}

/// The number of one of the vertices.
fn vertex(reading: &Reading, key: &str, count: usize) -> Result<u32> {
    let value: i64 = reading.required(key)?;
    let known = u32::try_from(value).ok().filter(|&v| (v as usize) < count);
    let message = format!("there is no vertex {value}: {count} are numbered from 0");
    known.ok_or_else(|| reading.error(key, message, "first the vertices, then the points"))
}

/// Names of the sides in order of appearance, and the side of each edge.
fn names(reading: &Reading, count: usize) -> Result<(Vec<String>, Vec<u32>)> {
    let names: Option<Vec<String>> = reading.optional("domain.sides")?;
    let names = names.unwrap_or_else(|| (1..=count).map(|i| format!("s{i}")).collect());
    let message = format!("{} names for {count} edges", names.len());
    let hint = "give one name per edge; edge i goes from vertex i to the next, and several may share a name";
    reading.refuse_if(names.len() != count, "domain.sides", message, hint)?;
    let mut sides: Vec<String> = Vec::new();
    let mut of_edge = Vec::new();
    for (i, name) in names.into_iter().enumerate() {
        let (key, what) = (format!("domain.sides.{i}"), "a side without name");
        let hint = "give the side a name: sides = [\"bottom\", ...]";
        reading.refuse_if(name.trim().is_empty(), &key, what, hint)?;
        let side = sides.iter().position(|known| *known == name).unwrap_or_else(|| {
            sides.push(name);
            sides.len() - 1
        });
        of_edge.push(side as u32);
    }
    Ok((sides, of_edge))
}

fn refused(reading: &Reading, error: &PolygonError) -> SceneError {
    let (key, hint) = match error {
        PolygonError::TooFew { .. } => {
            ("domain.vertices".to_string(), "vertices = [[0.0, 0.0], [1.0, 0.0], [0.5, 1.0]]")
        }
        PolygonError::Repeated { second, .. } => (
            format!("domain.vertices.{second}"),
            "name each corner once; the last edge returns to the first vertex by itself",
        ),
        PolygonError::Crossing { second, .. } => {
            (format!("domain.vertices.{second}"), "order the vertices along the boundary")
        }
        PolygonError::Clockwise { .. } => (
            "domain.vertices".to_string(),
            "reverse them: the domain lies on the left of each edge",
        ),
        PolygonError::TooThin { vertex } => (
            format!("domain.vertices.{vertex}"),
            "widen the polygon, or give triangles = [[i, j, k], ...]",
        ),
    };
    // Vertices in messages count from 0, as in `triangles`.
    reading.error(&key, error.to_string(), hint)
}
