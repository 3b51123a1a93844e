//! The document as a PDF, set by Typst from memory: no network, system fonts or clock.

use std::collections::BTreeMap;

use typst::diag::{FileError, FileResult, SourceDiagnostic};
use typst::foundations::{Bytes, Datetime, Duration};
use typst::syntax::{FileId, RootedPath, Source, VirtualPath, VirtualRoot};
use typst::text::{Font, FontBook};
use typst::utils::LazyHash;
use typst::{Library, LibraryExt, World};
use typst_layout::PagedDocument;
use typst_pdf::{PdfOptions, pdf as export};

use super::{Block, DATA, Document, TEMPLATE, data};
use crate::{ReportError, sheet};

const MAIN: &str = "report.typ";
/// The font of pictures: the generic name in their SVG has none in a PDF.
const FACE: &str = "font-family=\"DejaVu Sans\"";

/// The document as a PDF; `date` is printed below the title. Deterministic.
///
/// # Errors
/// [`ReportError::Typesetting`].
pub fn pdf(document: &Document, date: Option<&str>) -> Result<Vec<u8>, ReportError> {
    let world = Sheets::new(document, date)?;
    let set = typst::compile::<PagedDocument>(&world).output;
    let paged = set.map_err(|errors| refused(&errors))?;
    export(&paged, &PdfOptions::default()).map_err(|errors| refused(&errors))
}

fn refused(errors: &[SourceDiagnostic]) -> ReportError {
    let what: Vec<&str> = errors.iter().map(|error| error.message.as_str()).collect();
    ReportError::Typesetting { what: what.join("; ") }
}

/// Everything that the typesetter may read.
struct Sheets {
    library: LazyHash<Library>,
    book: LazyHash<FontBook>,
    fonts: Vec<Font>,
    main: Source,
    files: BTreeMap<String, Bytes>,
}

impl Sheets {
    fn new<'a>(document: &'a Document, date: Option<&str>) -> Result<Self, ReportError> {
        let path = VirtualPath::new(MAIN)
            .map_err(|_| ReportError::Typesetting { what: format!("no path: {MAIN}") })?;
        let main = RootedPath::new(VirtualRoot::Project, path).intern();
        let of_pictures = [dejavu::sans::regular(), dejavu::sans::bold()];
        let all = typst_assets::fonts().chain(of_pictures);
        let fonts: Vec<Font> = all.flat_map(|face| Font::iter(Bytes::new(face))).collect();
        let mut files = BTreeMap::new();
        files.insert(DATA.to_owned(), Bytes::from_string(data(document, date)));
        let of_block = |block: &'a Block| match block {
            Block::Figure(figure) => Some(figure),
            _ => None,
        };
        let figures = document.sections.iter().flat_map(|section| {
            let of_card = section.card.iter().flat_map(|card| &card.pictures);
            section.blocks.iter().filter_map(of_block).chain(of_card)
        });
        for figure in figures {
            let svg = sheet::without(&figure.svg).replace("font-family=\"sans-serif\"", FACE);
            files.insert(figure.file.clone(), Bytes::from_string(svg));
        }
        Ok(Self {
            library: LazyHash::new(Library::default()),
            book: LazyHash::new(FontBook::from_fonts(&fonts)),
            fonts,
            main: Source::new(main, TEMPLATE.to_owned()),
            files,
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
        self.files.get(name).cloned().ok_or_else(|| FileError::NotFound(name.into()))
    }

    fn font(&self, index: usize) -> Option<Font> {
        self.fonts.get(index).cloned()
    }

    fn today(&self, _: Option<Duration>) -> Option<Datetime> {
        None
    }
}
