//! Streaming of tables of any length.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use csv::StringRecord;

use super::journal::{case_lines, lines};
use super::row::{Row, same_case, width};
use super::{COLUMNS, CaseRecord, RecordError, norm_rank};
use files::{Replacement, open_file};

/// Cases of a finished table, one at a time. Unlike [`super::read`] it refuses a torn last line.
#[derive(Debug)]
pub struct CaseStream {
    path: PathBuf,
    rows: csv::Reader<File>,
    width: usize,
    ahead: Option<(u64, StringRecord)>,
    ended: bool,
}

impl CaseStream {
    /// Opens the table at `path`.
    ///
    /// # Errors
    /// [`RecordError::Io`], [`RecordError::Header`], [`RecordError::Torn`], [`RecordError::Changed`].
    pub fn open(path: &Path) -> Result<Self, RecordError> {
        let refused = |source| RecordError::Io { path: path.to_owned(), source };
        let mut file = open_file(path).map_err(refused)?;
        let whole = ends_with_line(&mut file).map_err(refused)?;
        let rows = csv::ReaderBuilder::new().has_headers(false).flexible(true).from_reader(file);
        let mut stream =
            Self { path: path.to_owned(), rows, width: COLUMNS.len(), ahead: None, ended: false };
        let mut header = StringRecord::new();
        let found = stream.rows.read_record(&mut header);
        let Some(width) = width(&header).filter(|_| found.is_ok_and(|found| found)) else {
            let found = header.iter().collect::<Vec<_>>().join(",");
            let found = found.chars().take(60).collect();
            return Err(RecordError::Header { path: path.to_owned(), found });
        };
        stream.width = width;
        if !whole {
            return Err(RecordError::Torn { path: path.to_owned() });
        }
        stream.ahead = stream.row()?;
        Ok(stream)
    }

    fn row(&mut self) -> Result<Option<(u64, StringRecord)>, RecordError> {
        let mut fields = StringRecord::new();
        let there = self
            .rows
            .read_record(&mut fields)
            .map_err(|error| RecordError::Io { path: self.path.clone(), source: error.into() })?;
        let line = fields.position().map_or(0, csv::Position::line);
        match there {
            false => Ok(None),
            true if fields.len() == self.width => {
                match (Row { path: &self.path, line, fields: &fields }).is_unchanged() {
                    true => Ok(Some((line, fields))),
                    false => Err(RecordError::Changed { path: self.path.clone(), line }),
                }
            }
            true => {
                let path = self.path.clone();
                Err(RecordError::Fields { path, line, found: fields.len() })
            }
        }
    }

    fn case(&mut self) -> Result<Option<CaseRecord>, RecordError> {
        let Some((line, first)) = self.ahead.take() else { return Ok(None) };
        let row = Row { path: &self.path, line, fields: &first };
        let mut case = row.case()?;
        case.errors.extend(row.norm()?);
        while let Some((line, fields)) = self.row()? {
            let norm = Row { path: &self.path, line, fields: &fields }.norm()?;
            let new = norm.filter(|entry| case.norm(&entry.norm).is_none());
            match new.filter(|_| same_case(&first, &fields)) {
                Some(entry) => case.errors.push(entry),
                None => {
                    self.ahead = Some((line, fields));
                    break;
                }
            }
        }
        Ok(Some(case))
    }
}

impl Iterator for CaseStream {
    type Item = Result<CaseRecord, RecordError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.ended {
            return None;
        }
        let case = self.case().transpose();
        self.ended = !matches!(case, Some(Ok(_)));
        case
    }
}

/// Whether the last byte ends a line; rewinds the file.
fn ends_with_line(file: &mut File) -> io::Result<bool> {
    let mut last = [0];
    if file.metadata()?.len() > 0 {
        file.seek(SeekFrom::End(-1))?;
        file.read_exact(&mut last)?;
    }
    file.rewind()?;
    Ok(last == *b"\n")
}

/// Writes a table case by case in the caller's order; it appears at its path when finished.
#[derive(Debug)]
pub struct TableWriter {
    path: PathBuf,
    file: Replacement,
}

impl TableWriter {
    /// Begins the table that is to stand at `path`.
    ///
    /// # Errors
    /// [`RecordError::Io`].
    pub fn create(path: &Path) -> Result<Self, RecordError> {
        let begun = || -> io::Result<Replacement> {
            let mut file = Replacement::create(path)?;
            file.write_all(&lines(&[COLUMNS.map(str::to_owned).to_vec()])?)?;
            Ok(file)
        };
        let file = begun().map_err(|source| RecordError::Io { path: path.to_owned(), source })?;
        Ok(Self { path: path.to_owned(), file })
    }

    /// Adds a case, norms in table order.
    ///
    /// # Errors
    /// [`RecordError::Name`], [`RecordError::Io`].
    pub fn append(&mut self, case: &mut CaseRecord) -> Result<(), RecordError> {
        case.errors.sort_by_cached_key(|entry| (norm_rank(&entry.norm), entry.norm.clone()));
        let bytes = case_lines(case, &self.path)?;
        let written = self.file.write_all(&bytes);
        written.map_err(|source| RecordError::Io { path: self.path.clone(), source })
    }

    /// Puts the table at its place, in one step.
    ///
    /// # Errors
    /// [`RecordError::Io`].
    pub fn finish(self) -> Result<(), RecordError> {
        let Self { path, file } = self;
        file.finish().map_err(|source| RecordError::Io { path, source })
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::super::{NormError, Status, read};
    use super::*;

    fn case(n: u32, norms: &[&str]) -> CaseRecord {
        let entry =
            |norm: &&str| NormError { norm: (*norm).into(), error: Some(0.1), floor: Some(1e-17) };
        CaseRecord {
            status: Status::Converged,
            errors: norms.iter().map(entry).collect(),
            ..CaseRecord::without_work("block", Some(n), 4, 0.25)
        }
    }

    #[test]
    fn what_is_written_case_by_case_is_read_case_by_case() {
        let folder = std::env::temp_dir().join(format!("gronwall-stream-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let path = folder.join("cases.csv");
        let mut cases = [case(4, &["V_max", "L2_max"]), case(8, &[]), case(16, &["V_max"])];
        let mut table = TableWriter::create(&path).unwrap();
        cases.iter_mut().for_each(|case| table.append(case).unwrap());
        assert!(!path.exists(), "an unfinished table stands at its place");
        table.finish().unwrap();
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 1);
        let streamed: Vec<CaseRecord> =
            CaseStream::open(&path).unwrap().collect::<Result<_, _>>().unwrap();
        assert_eq!(streamed, cases);
        assert_eq!(streamed, read(&path).unwrap());

        let whole = fs::read(&path).unwrap();
        for (cut, torn) in [(whole.len() - 9, true), (whole.len() - 1, true), (20, false)] {
            fs::write(&path, &whole[..cut]).unwrap();
            match CaseStream::open(&path).unwrap_err() {
                RecordError::Torn { .. } => assert!(torn, "{cut}"),
                RecordError::Header { .. } => assert!(!torn, "{cut}"),
                other => panic!("{other}"),
            }
        }
        let text = String::from_utf8(whole).unwrap().replacen(",converged", "", 1);
        fs::write(&path, text).unwrap();
        let error = CaseStream::open(&path).unwrap_err().to_string();
        assert!(error.contains("cases.csv:2: 21 fields"), "{error}");
        // A dropped writer leaves nothing.
        drop(TableWriter::create(&folder.join("other.csv")).unwrap());
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 1);
        fs::remove_dir_all(&folder).unwrap();
    }
}
