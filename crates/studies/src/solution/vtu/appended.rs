//! The appended part of a file: an underscore, then for each array its length in bytes (`u64`) and
//! its values, everything little endian. Offsets in the XML count from behind the underscore.

use super::grid::{Field, VtuError};
use report::escaped;

/// The XML declarations of the arrays, and the bytes that they point to.
#[derive(Default)]
pub(crate) struct Appended {
    declarations: String,
    bytes: Vec<u8>,
}

impl Appended {
    /// Opens an XML element that groups arrays.
    pub(crate) fn open(&mut self, element: &str) {
        self.declarations += &format!("      <{element}>\n");
    }

    pub(crate) fn close(&mut self, element: &str) {
        self.declarations += &format!("      </{element}>\n");
    }

    /// Declares an array and appends its values, with their number of bytes in front.
    pub(crate) fn array<const BYTES: usize>(
        &mut self,
        kind: &str,
        name: &str,
        components: usize,
        values: impl Iterator<Item = [u8; BYTES]>,
    ) {
        let offset = self.bytes.len();
        let name = escape(name);
        // One is the default, and readers make a flat array of it only if it is not stated.
        let shape = match components {
            1 => String::new(),
            components => format!(" NumberOfComponents=\"{components}\""),
        };
        self.declarations += &format!(
            "        <DataArray type=\"{kind}\" Name=\"{name}\"{shape} \
             format=\"appended\" offset=\"{offset}\"/>\n"
        );
        let start = offset + size_of::<u64>();
        self.bytes.resize(start, 0);
        values.for_each(|value| self.bytes.extend_from_slice(&value));
        let length = (self.bytes.len() - start) as u64;
        self.bytes[offset..start].copy_from_slice(&length.to_le_bytes());
    }

    /// Appends fields that have values at `count` points or in `count` cells.
    ///
    /// # Errors
    /// [`VtuError::Inconsistent`].
    pub(crate) fn fields(&mut self, fields: &[Field<'_>], count: usize) -> Result<(), VtuError> {
        for &Field { name, components, values } in fields {
            if components == 0 || count.checked_mul(components) != Some(values.len()) {
                let found = values.len();
                return Err(VtuError::Inconsistent(format!(
                    "field `{name}`: {found} values, expected {count} × {components}"
                )));
            }
            // Viewers take an array for a vector if it has three components.
            let written = if components == 2 { 3 } else { components };
            let padding = std::iter::repeat_n(0.0, written - components);
            let padded = values
                .chunks_exact(components)
                .flat_map(|value| value.iter().copied().chain(padding.clone()));
            self.array("Float64", name, written, padded.map(f64::to_le_bytes));
        }
        Ok(())
    }

    /// The whole file, for a grid of that many points and cells.
    pub(crate) fn document(&self, points: usize, cells: usize) -> Vec<u8> {
        let declarations = &self.declarations;
        let head = format!(
            "<?xml version=\"1.0\"?>\n\
             <VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" \
             header_type=\"UInt64\">\n  <UnstructuredGrid>\n    \
             <Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{cells}\">\n{declarations}    \
             </Piece>\n  </UnstructuredGrid>\n  <AppendedData encoding=\"raw\">\n_"
        );
        [head.as_bytes(), &self.bytes, b"\n  </AppendedData>\n</VTKFile>\n"].concat()
    }
}

/// `text` as the value of an XML attribute. Control characters, which XML cannot hold, become
/// blanks.
pub(crate) fn escape(text: &str) -> String {
    escaped(&text.replace(char::is_control, " "))
}
