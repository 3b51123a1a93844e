//! Displacements as a series of `.vtu` files, one per level: indexed by `displacement.pvd`, or numbered.

use std::path::{Path, PathBuf};

use super::bounded::{Until, is_below, most_bytes, read_bounded};
use super::error::{AnswerError, SeriesError, VtuReadError};
use super::places::VertexPlaces;
use super::vtu::{Snapshot, read_vtu, xml};
use super::wanted::{COLLECTION, Wanted};

/// Without an index: displacement_0000.vtu, … by level.
const NUMBERED: (&str, &str) = ("displacement_", ".vtu");

/// Relative tolerance of times: those written with six digits are off by 5e-6.
const NEAR: f64 = 1e-5;
/// Size limit of an index; a level takes a line with a name.
const BYTES_A_LEVEL: [u64; 2] = [1 << 16, 1 << 12];

/// The files that the index names, by level.
pub(crate) fn indexed(
    dir: &Path,
    times: &[f64],
    until: Until,
) -> Result<Vec<PathBuf>, SeriesError> {
    let bytes = read_bounded(&dir.join(COLLECTION), most_bytes(BYTES_A_LEVEL, times.len()), until)
        .map_err(|reason| SeriesError::Index(VtuReadError::Unreadable(reason)))?;
    let text = std::str::from_utf8(&bytes)
        .map_err(|error| SeriesError::Index(VtuReadError::Xml(error.to_string())))?;
    let document = xml(text).map_err(SeriesError::Index)?;
    let entries = document.descendants().filter(|node| node.has_tag_name("DataSet"));
    let mut files = Vec::new();
    for (i, entry) in entries.enumerate() {
        let time = entry.attribute("timestep").and_then(|text| text.trim().parse().ok());
        let file = entry.attribute("file");
        let (time, file) = time.zip(file).ok_or(SeriesError::Entry(i))?;
        if !is_below(file) {
            return Err(SeriesError::Outside(file.to_owned()));
        }
        files.push((level(times, time)?, dir.join(file)));
    }
    each_level(files, times.len())
}

/// The level of a time, within the tolerance and a quarter of the adjacent steps.
fn level(times: &[f64], found: f64) -> Result<usize, SeriesError> {
    let after = times.partition_point(|&t| t < found).min(times.len() - 1);
    let before = after.saturating_sub(1);
    let n =
        if (found - times[before]).abs() <= (times[after] - found).abs() { before } else { after };
    let steps = times[n.saturating_sub(1)..].windows(2).take(if n == 0 { 1 } else { 2 });
    let shortest = steps.map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
    let near = (NEAR * times[times.len() - 1]).min(shortest / 4.0);
    if (found - times[n]).abs() <= near {
        return Ok(n);
    }
    Err(SeriesError::Time { found, n, nearest: times[n] })
}

/// The numbered files in a directory; empty if it does not exist.
pub(crate) fn numbered(dir: &Path) -> Result<Vec<(usize, PathBuf)>, AnswerError> {
    let unreadable = AnswerError::at(dir);
    let mut files = Vec::new();
    if !dir.exists() {
        return Ok(files);
    }
    for entry in std::fs::read_dir(dir).map_err(&unreadable)? {
        let path = entry.map_err(&unreadable)?.path();
        let name = path.file_name().and_then(|name| name.to_str());
        let digits = name
            .and_then(|name| name.strip_prefix(NUMBERED.0)?.strip_suffix(NUMBERED.1))
            .filter(|digits| digits.bytes().all(|byte| byte.is_ascii_digit()));
        if let Some(n) = digits.and_then(|digits| digits.parse().ok()) {
            files.push((n, path));
        }
    }
    files.sort();
    Ok(files)
}

/// Checks that each level has one file.
///
/// # Errors
/// [`SeriesError`]: a level without a file, with two, or beyond the last.
pub(crate) fn each_level(
    files: Vec<(usize, PathBuf)>,
    levels: usize,
) -> Result<Vec<PathBuf>, SeriesError> {
    let last = levels - 1;
    let mut of_level = vec![None; levels];
    let name = |path: &Path| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    for (n, path) in files {
        let Some(place) = of_level.get_mut(n) else {
            return Err(SeriesError::Beyond { n, last, file: name(&path) });
        };
        let second = name(&path);
        if let Some(first) = place.replace(path) {
            return Err(SeriesError::Twice { n, first: name(&first), second });
        }
    }
    let found = |(n, path): (usize, Option<PathBuf>)| path.ok_or(SeriesError::Level { n, last });
    of_level.into_iter().enumerate().map(found).collect()
}

/// The displacements of all levels, d numbers per vertex, for any order of the points.
pub(crate) fn read_levels(
    files: &[PathBuf],
    wanted: &Wanted<'_>,
    until: Until,
) -> Result<Vec<f64>, AnswerError> {
    let (vertices, d) = (wanted.vertices.len(), wanted.dimension);
    let places = VertexPlaces::new(wanted.vertices);
    let mut u = vec![f64::NAN; files.len() * vertices * d];
    let mut known: Option<(Vec<[f64; 3]>, Vec<u32>)> = None;
    for (level, path) in u.chunks_exact_mut(vertices * d).zip(files) {
        let fault = |source| AnswerError::Vtu { path: path.clone(), source };
        let Snapshot { points, u } = read_vtu(path, [vertices, d], until).map_err(fault)?;
        // Most solvers write equal points at every level.
        let vertex = match known.take() {
            Some((same, vertex)) if same == points => vertex,
            _ => places.of(&points).map_err(fault)?,
        };
        for (value, &vertex) in u.chunks_exact(d).zip(&vertex) {
            let at = vertex as usize * d;
            level[at..at + d].copy_from_slice(value);
        }
        known = Some((points, vertex));
    }
    Ok(u)
}
