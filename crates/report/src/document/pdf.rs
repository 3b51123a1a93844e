//! A written report as a PDF, set by Typst: no network, system fonts or clock.

use std::fmt::Display;
use std::path::{Path, PathBuf};

use files::read_text;
use typst::diag::{FileError, FileResult, SourceDiagnostic};
use typst::foundations::{Bytes, Datetime, Duration};
use typst::syntax::{FileId, RootedPath, Source, VirtualPath, VirtualRoot};
use typst::text::{Font, FontBook};
use typst::utils::LazyHash;
use typst::{Library, LibraryExt, World};
use typst_layout::PagedDocument;
use typst_pdf::{PdfOptions, pdf as export};

use super::DATA;
use crate::{ReportError, sheet};

const MAIN: &str = "report.typ";
/// The font of pictures: the generic name in their SVG has none in a PDF.
const FACE: &str = "font-family=\"DejaVu Sans\"";

/// The report that [`crate::write_all`] left in a directory, as a PDF; `date` is printed below the title. Deterministic.
///
/// # Errors
/// [`ReportError::Typesetting`].
pub fn pdf(dir: &Path, date: Option<&str>) -> Result<Vec<u8>, ReportError> {
    let paged = paged(dir, date)?;
    export(&paged, &PdfOptions::default()).map_err(|errors| refused(&errors))
}

/// Its pages.
pub(crate) fn paged(dir: &Path, date: Option<&str>) -> Result<PagedDocument, ReportError> {
    let world = Sheets::read(dir, date)?;
    let set = typst::compile::<PagedDocument>(&world).output;
    set.map_err(|errors| refused(&errors))
}

fn refused(errors: &[SourceDiagnostic]) -> ReportError {
    let what: Vec<&str> = errors.iter().map(|error| error.message.as_str()).collect();
    ReportError::Typesetting { what: what.join("; ") }
}

fn about(path: &Path, reason: impl Display) -> ReportError {
    ReportError::Typesetting { what: format!("{}: {reason}", path.display()) }
}

/// Everything that the typesetter may read.
struct Sheets {
    library: LazyHash<Library>,
    book: LazyHash<FontBook>,
    fonts: Vec<Font>,
    main: Source,
    data: Bytes,
    dir: PathBuf,
}

impl Sheets {
    fn read(dir: &Path, date: Option<&str>) -> Result<Self, ReportError> {
        let text = |path: &Path| read_text(path).map_err(|error| about(path, error.source));
        let path = VirtualPath::new(MAIN).map_err(|_| about(Path::new(MAIN), "no path"))?;
        let main = RootedPath::new(VirtualRoot::Project, path).intern();
        let of_pictures = [dejavu::sans::regular(), dejavu::sans::bold()];
        let all = typst_assets::fonts().chain(of_pictures);
        let fonts: Vec<Font> = all.flat_map(|face| Font::iter(Bytes::new(face))).collect();
        let data = dir.join(DATA);
        let mut content: serde_json::Value =
            serde_json::from_str(&text(&data)?).map_err(|error| about(&data, error))?;
        content["date"] = serde_json::json!(date);
        Ok(Self {
            library: LazyHash::new(Library::default()),
            book: LazyHash::new(FontBook::from_fonts(&fonts)),
            fonts,
            main: Source::new(main, text(&dir.join(MAIN))?),
            data: Bytes::from_string(content.to_string()),
            dir: dir.to_owned(),
        })
    }
}

impl World for Sheets {
    fn library(&self) -> &LazyHash<Library> {
        &self.library
    }

    fn book(&self) -> &LazyHash<FontBook> {
        &self.book
    }

    fn main(&self) -> FileId {
        self.main.id()
    }

    fn source(&self, id: FileId) -> FileResult<Source> {
        if id == self.main.id() { Ok(self.main.clone()) } else { Err(FileError::NotSource) }
    }

    fn file(&self, id: FileId) -> FileResult<Bytes> {
        let name = id.get().vpath().get_without_slash();
        if name == DATA {
            return Ok(self.data.clone());
        }
        let path = self.dir.join(name);
        let svg = read_text(&path).map_err(|error| FileError::from_io(error.source, &path))?;
        Ok(Bytes::from_string(sheet::without(&svg).replace("font-family=\"sans-serif\"", FACE)))
    }

    fn font(&self, index: usize) -> Option<Font> {
        self.fonts.get(index).cloned()
    }

    fn today(&self, _: Option<Duration>) -> Option<Datetime> {
        None
    }
}
