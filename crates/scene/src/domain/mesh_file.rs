//! `shape = "mesh"`: a gmsh file beside the scene file.

use std::path::{Path, PathBuf};

use crate::diagnostic::{Result, SceneError};
use crate::reading::Reading;
use crate::source::Source;
use crate::spans::Spans;
use fem::mesh::{CoarseMesh, Fault, read_gmsh};
use files::read_file_up_to;
use toml::de::DeTable;

/// Largest mesh file, 64 MiB; a coarse mesh has a few thousand cells.
const LARGEST_FILE: u64 = 64 << 20;

/// Adds the text of the mesh file that the domain names, unless present.
pub(crate) fn with_mesh(source: Source, spans: &Spans, table: &DeTable<'_>) -> Result<Source> {
    let word = |key| table.get("domain")?.get_ref().get(key)?.get_ref().as_str();
    let (Some("mesh"), Some(file), None) = (word("shape"), word("file"), &source.mesh) else {
        return Ok(source);
    };
    let path = path_of(&source, file);
    let inside = source.beside.iter().find(|(name, _)| *name == file);
    match inside.map_or_else(|| text(&path), |(_, text)| Ok((*text).to_owned())) {
        Ok(mesh) => Ok(source.with_mesh(mesh)),
        Err((reason, hint)) => {
            let message = format!("cannot read the mesh {}: {reason}", path.display());
            Err(SceneError::at(&source, spans.value("domain.file"), message, hint))
        }
    }
}

fn path_of(source: &Source, file: &str) -> PathBuf {
    source.path.parent().unwrap_or(Path::new("")).join(file)
}

pub(super) fn mesh_file(reading: &Reading, dimension: usize) -> Result<CoarseMesh> {
    let path = path_of(reading.source, &reading.required::<String>("domain.file")?);
    let text = reading.source.mesh.as_deref().unwrap_or_default();
    let mesh = read_gmsh(text).map_err(|error| {
        let message = format!("the mesh file, {error}");
        let hint = error.fault.hint();
        SceneError::at(&Source::from_text(path.clone(), text), error.span, message, hint)
    })?;
    let cells = match mesh.dimension {
        found if found == dimension => return Ok(mesh),
        3 => "tetrahedra, and dimension = 2",
        _ => "triangles and no tetrahedra, and dimension = 3",
    };
    let message = format!("the mesh {} has {cells}", path.display());
    let hint = "write the other dimension, or export the elements of this one from gmsh";
    Err(reading.error("domain.file", message, hint))
}

fn text(path: &Path) -> Result<String, (String, &'static str)> {
    let hint = "give the path of a gmsh file (.msh, ASCII), relative to the folder of the scene";
    let bytes =
        read_file_up_to(path, LARGEST_FILE).map_err(|error| (error.source.to_string(), hint))?;
    String::from_utf8(bytes).map_err(|error| {
        let head = error.as_bytes().split(|byte| *byte == b'\n').nth(1);
        if head.is_some_and(|head| head.split(|byte| *byte == b' ').nth(1) == Some(b"1")) {
            return (Fault::Binary.to_string(), Fault::Binary.hint());
        }
        let byte = error.utf8_error().valid_up_to();
        (format!("byte {byte} is not text"), "write names of groups in UTF-8, or without accents")
    })
}
