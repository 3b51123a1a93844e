//! `cases.csv`, written as each case ends, and read back after any interruption.

use std::collections::{BTreeMap, HashMap};
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use csv::StringRecord;

use super::row::{self, Row};
use super::{COLUMNS, CaseRecord, Key, RecordError, norm_rank};
use files::{FileError, if_there, read_file, replace_file};

/// The table of cases, open for appending.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: File,
}

impl Journal {
    /// Opens or creates the table at `path`; a torn last line of an interrupted write is cut off first.
    ///
    /// # Errors
    /// [`RecordError::Header`] if the file is something else (it is left untouched), and those of [`read`].
    pub fn open(path: &Path) -> Result<Self, RecordError> {
        let refused = FileError::at(path);
        let bytes = if_there(read_file(path))?.unwrap_or_default();
        let Scan { intact, width, .. } = scan(path, &bytes)?;
        // Rows of two lengths would make the table unreadable.
        check_header(path, &bytes, intact == 0 || width == COLUMNS.len())?;
        let file = OpenOptions::new().create(true).append(true).open(path).map_err(&refused)?;
        file.set_len(intact).map_err(&refused)?;
        let mut journal = Self { path: path.to_owned(), file };
        if intact == 0 {
            journal.write(header().as_bytes())?;
        }
        Ok(journal)
    }

    /// Appends all rows of a case in one write, and flushes.
    ///
    /// # Errors
    /// [`RecordError::Name`] if a name has a line break; [`RecordError::Io`].
    pub fn append(&mut self, case: &CaseRecord) -> Result<(), RecordError> {
        let bytes = case_lines(case, &self.path)?;
        self.in_place()?;
        self.write(&bytes)
    }

    /// Whether the table is still the one at its path: writes into a removed file are lost silently.
    pub fn in_place(&self) -> Result<(), RecordError> {
        let opened = self.file.metadata().map_err(FileError::at(&self.path))?;
        match fs::metadata(&self.path) {
            Ok(there) if same_file(&opened, &there) => Ok(()),
            _ => Err(RecordError::Gone { path: self.path.clone() }),
        }
    }

    fn write(&mut self, bytes: &[u8]) -> Result<(), RecordError> {
        let written = self.file.write_all(bytes).and_then(|()| self.file.flush());
        Ok(written.map_err(FileError::at(&self.path))?)
    }
}

#[cfg(unix)]
fn same_file(one: &fs::Metadata, other: &fs::Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    (one.dev(), one.ino()) == (other.dev(), other.ino())
}

/// No file identity on this platform: existence has to suffice.
#[cfg(not(unix))]
fn same_file(_: &fs::Metadata, _: &fs::Metadata) -> bool {
    true
}

#[derive(Debug, Clone, PartialEq)]
pub struct CaseTable {
    /// Sorted by key, whatever the order of the rows; of two entries of one case the later wins. Lost rows show in
    /// [`CaseRecord::norms`].
    pub cases: Vec<CaseRecord>,
    /// Numbers of lines that fail their checksum; they are left out.
    pub changed: Vec<u64>,
    pub torn: bool,
    pub checked: bool,
}

impl CaseTable {
    /// Refuses a table with a changed line; `path` is for the message.
    pub fn unchanged(self, path: &Path) -> Result<Self, RecordError> {
        match self.changed.first() {
            Some(&line) => Err(RecordError::Changed { path: path.to_owned(), line }),
            None => Ok(self),
        }
    }
}

/// Reads the cases of a table; a torn last line is dropped.
///
/// # Errors
/// A torn, malformed or changed line anywhere else.
pub fn read(path: &Path) -> Result<Vec<CaseRecord>, RecordError> {
    Ok(read_table(path)?.unchanged(path)?.cases)
}

/// Reads a table and reports its defects.
///
/// # Errors
/// A torn or malformed line that is not the last; no file.
pub fn read_table(path: &Path) -> Result<CaseTable, RecordError> {
    let found = every_entry(path)?;
    let last: BTreeMap<Key, CaseRecord> =
        found.cases.into_iter().map(|case| (case.key(), case)).collect();
    Ok(CaseTable { cases: last.into_values().collect(), ..found })
}

/// Reads the cases of a finished table, sorted by key; a case that stands there twice is returned twice.
///
/// # Errors
/// A torn, malformed or changed line.
pub fn read_finished(path: &Path) -> Result<Vec<CaseRecord>, RecordError> {
    match every_entry(path)?.unchanged(path)? {
        CaseTable { torn: true, .. } => Err(RecordError::Torn { path: path.to_owned() }),
        table => Ok(table.cases),
    }
}

/// A table with every entry of a case.
fn every_entry(path: &Path) -> Result<CaseTable, RecordError> {
    let bytes = read_file(path)?;
    let Scan { rows, intact, width } = scan(path, &bytes)?;
    let (sound, changed): (Vec<Line>, Vec<Line>) = rows
        .into_iter()
        .partition(|(line, fields)| Row { path, line: *line, fields }.is_unchanged());
    Ok(CaseTable {
        cases: cases(path, &sound)?,
        changed: changed.into_iter().map(|(line, _)| line).collect(),
        torn: intact < bytes.len() as u64,
        checked: width == COLUMNS.len(),
    })
}

/// The entries of cases, sorted by key, and of one case in the order of their first rows. Rows belong together that agree
/// in all columns of the case, seconds included, wherever they stand; a norm that comes again begins another entry.
fn cases(path: &Path, rows: &[Line]) -> Result<Vec<CaseRecord>, RecordError> {
    let mut cases: Vec<CaseRecord> = Vec::new();
    let mut entries: HashMap<Vec<&str>, usize> = HashMap::new();
    for (line, fields) in rows {
        let row = Row { path, line: *line, fields };
        let norm = row.norm()?;
        let is_new =
            |case: &CaseRecord| norm.as_ref().is_some_and(|entry| case.norm(&entry.norm).is_none());
        let entry = entries.entry(row::of_case(fields)).or_insert(usize::MAX);
        match cases.get_mut(*entry).filter(|case| is_new(case)) {
            Some(case) => case.errors.extend(norm),
            None => {
                *entry = cases.len();
                cases.push(CaseRecord { errors: Vec::from_iter(norm), ..row.case()? });
            }
        }
    }
    cases.iter_mut().for_each(sort_norms);
    cases.sort_by_key(CaseRecord::key);
    Ok(cases)
}

fn sort_norms(case: &mut CaseRecord) {
    case.errors.sort_by_cached_key(|entry| (norm_rank(&entry.norm), entry.norm.clone()));
}

/// Replaces the table, sorted by scene, n, steps and norm; of two entries of one case the later wins.
///
/// # Errors
/// [`RecordError::Name`], [`RecordError::Io`].
pub fn write_sorted(path: &Path, cases: &[CaseRecord]) -> Result<(), RecordError> {
    let mut sorted: BTreeMap<Key, CaseRecord> =
        cases.iter().map(|case| (case.key(), case.clone())).collect();
    let mut bytes = header().into_bytes();
    for case in sorted.values_mut() {
        sort_norms(case);
        bytes.extend(case_lines(case, path)?);
    }
    Ok(replace_file(path, &bytes)?)
}

fn case_lines(case: &CaseRecord, path: &Path) -> Result<Vec<u8>, RecordError> {
    for name in case.norms().chain([case.scene.as_str()]) {
        if name.contains(['\n', '\r']) {
            return Err(RecordError::Name { name: name.to_owned() });
        }
    }
    Ok(lines(&row::encode(case)).map_err(FileError::at(path))?)
}

/// The first line.
fn header() -> String {
    COLUMNS.join(",") + "\n"
}

fn lines(rows: &[Vec<String>]) -> io::Result<Vec<u8>> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows {
        writer.write_record(row)?;
    }
    writer.into_inner().map_err(|error| io::Error::other(error.to_string()))
}

type Line = (u64, StringRecord);

/// Rows with line numbers, length of the intact part in bytes, fields per row.
struct Scan {
    rows: Vec<Line>,
    intact: u64,
    width: usize,
}

fn scan(path: &Path, bytes: &[u8]) -> Result<Scan, RecordError> {
    let whole = bytes.iter().rposition(|&byte| byte == b'\n').map_or(0, |last| last + 1);
    if whole == 0 {
        check_header(path, bytes, header().as_bytes().starts_with(bytes))?;
        return Ok(Scan { rows: Vec::new(), intact: 0, width: COLUMNS.len() });
    }
    let (mut rows, mut places) = parse_lines(path, &bytes[..whole])?;
    let width = rows.first().and_then(|(_, first)| row::width(first));
    check_header(path, bytes, width.is_some())?;
    let width = width.unwrap_or(COLUMNS.len());
    rows.remove(0);
    let mut intact = whole as u64;
    if rows.last().is_some_and(|(_, last)| last.len() != width) {
        rows.pop();
        intact = places.pop().unwrap_or(intact);
    }
    match rows.iter().find(|(_, fields)| fields.len() != width) {
        Some((line, fields)) => {
            Err(RecordError::Fields { path: path.to_owned(), line: *line, found: fields.len() })
        }
        None => Ok(Scan { rows, intact, width }),
    }
}

/// Lines with their numbers and offsets.
fn parse_lines(path: &Path, bytes: &[u8]) -> Result<(Vec<Line>, Vec<u64>), RecordError> {
    let mut reader = csv::ReaderBuilder::new().has_headers(false).flexible(true).from_reader(bytes);
    let mut rows = Vec::new();
    let mut places = Vec::new();
    for record in reader.byte_records() {
        let record = record.map_err(io::Error::from).map_err(FileError::at(path))?;
        let (line, byte) = record.position().map_or((0, 0), |at| (at.line(), at.byte()));
        rows.push((line, StringRecord::from_byte_record_lossy(record)));
        places.push(byte);
    }
    Ok((rows, places))
}

fn check_header(path: &Path, bytes: &[u8], ours: bool) -> Result<(), RecordError> {
    if ours {
        return Ok(());
    }
    let first = bytes.split(|&byte| byte == b'\n').next().unwrap_or_default();
    let found = String::from_utf8_lossy(&first[..first.len().min(60)]).into_owned();
    Err(RecordError::Header { path: path.to_owned(), found })
}

#[cfg(test)]
mod tests;
