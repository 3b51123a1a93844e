//! `shape = "mesh"`: a gmsh file beside the scene file.

use std::path::Path;

use crate::mesh::{Coarse, read_gmsh};
use crate::scene::diagnostic::SceneError;
use crate::scene::reading::Reading;
use crate::scene::source::Source;

/// Largest mesh file that is read, in bytes (64 MiB): a coarse mesh has a few thousand triangles.
const LARGEST_FILE: u64 = 64 << 20;

/// The coarse triangulation in a file, whose path is relative to the folder of the scene.
pub(super) fn mesh_file(reading: &Reading, file: &str) -> Result<Coarse, SceneError> {
    let folder = reading.source.path.parent().unwrap_or(Path::new(""));
    let path = folder.join(file);
    let text = text(&path).map_err(|reason| {
        let message = format!("cannot read the mesh {}: {reason}", path.display());
        let hint =
            "give the path of a gmsh file (.msh, ASCII), relative to the folder of the scene";
        reading.error("domain.file", message, hint)
    })?;
    read_gmsh(&text).map_err(|error| {
        let message = format!("the mesh file, {error}");
        let hint = "export the mesh from gmsh as ASCII, version 4.1 or 2.2, order 1, with a physical group for every side";
        SceneError::at(&Source::from_text(path.clone(), text.clone()), error.span, message, hint)
    })
}

fn text(path: &Path) -> Result<String, String> {
    let size = std::fs::metadata(path).map_err(|error| error.to_string())?.len();
    if size > LARGEST_FILE {
        return Err("it is larger than 64 MiB".to_string());
    }
    let bytes = std::fs::read(path).map_err(|error| error.to_string())?;
    String::from_utf8(bytes).map_err(|error| {
        let byte = error.utf8_error().valid_up_to();
        format!("byte {byte} is not text: export as ASCII")
    })
}
