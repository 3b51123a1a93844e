//! One row of `cases.csv`: a case and a norm.

use std::path::Path;
use std::str::FromStr;

use csv::StringRecord;

use super::{COLUMNS, CaseRecord, NormError, RecordError, Status};
use files::fnv_1a;

/// Columns of the norm; the others belong to the case.
const NORM_COLUMNS: std::ops::Range<usize> = 8..11;
/// Columns that may differ between equal runs.
const SECONDS: std::ops::Range<usize> = 15..20;
/// Checksum of all other columns but `seconds_*`.
const CHECKSUM: usize = COLUMNS.len() - 1;

/// Number of fields under this header; none if it is not that of a table of cases. Foreign tables may lack checksums.
pub(super) fn width(header: &StringRecord) -> Option<usize> {
    [COLUMNS.len(), CHECKSUM].into_iter().find(|&width| *header == COLUMNS[..width])
}

/// Hash of the fields without `seconds_*`: equal runs have equal rows.
fn checksum<'a>(fields: impl Iterator<Item = &'a str>) -> String {
    let lasting = fields.take(CHECKSUM).enumerate().filter(|(i, _)| !SECONDS.contains(i));
    // No field contains a line break.
    let bytes = lasting.flat_map(|(_, field)| field.bytes().chain([b'\n']));
    format!("{:016x}", fnv_1a(bytes))
}

/// One row per norm; a case without norms has one row with an empty name.
pub(super) fn encode(case: &CaseRecord) -> Vec<Vec<String>> {
    let nameless = [NormError { norm: String::new(), error: None, floor: None }];
    let entries = if case.errors.is_empty() { &nameless[..] } else { &case.errors[..] };
    entries.iter().map(|entry| encode_row(case, entry)).collect()
}

fn encode_row(case: &CaseRecord, entry: &NormError) -> Vec<String> {
    let error = entry.error.filter(|_| case.converged());
    let status = match case.status {
        Status::Converged => "converged",
        Status::Failed { .. } => "failed",
        Status::Skipped => "skipped",
    };
    let mut fields = vec![
        case.scene.clone(),
        case.dimension.to_string(),
        case.n.map_or_else(String::new, |n| n.to_string()),
        case.steps.to_string(),
        optional(case.h),
        number(case.k),
        case.dofs.to_string(),
        case.elements.to_string(),
        entry.norm.clone(),
        optional(error),
        optional(entry.floor),
        status.to_owned(),
        case.newton_iterations.to_string(),
        case.active_set_changes.to_string(),
        case.factorizations.to_string(),
        number(case.seconds_load),
        number(case.seconds_assemble),
        number(case.seconds_factor),
        number(case.seconds_solve),
        number(case.seconds_total),
        case.peak_history_bytes.to_string(),
    ];
    fields.push(checksum(fields.iter().map(String::as_str)));
    fields
}

/// The shortest decimal that reads back to the same bits.
fn number(value: f64) -> String {
    format!("{value:?}")
}

fn optional(value: Option<f64>) -> String {
    value.map_or_else(String::new, number)
}

/// The fields of the case in a row.
pub(super) fn of_case(fields: &StringRecord) -> Vec<&str> {
    let of_case = (0..CHECKSUM).filter(|i| !NORM_COLUMNS.contains(i));
    of_case.filter_map(|i| fields.get(i)).collect()
}

pub(super) struct Row<'a> {
    pub(super) path: &'a Path,
    pub(super) line: u64,
    pub(super) fields: &'a StringRecord,
}

impl Row<'_> {
    /// Whether the checksum holds; true in a table without checksums.
    pub(super) fn is_unchanged(&self) -> bool {
        self.fields.get(CHECKSUM).is_none_or(|stored| stored == checksum(self.fields.iter()))
    }

    pub(super) fn case(&self) -> Result<CaseRecord, RecordError> {
        Ok(CaseRecord {
            scene: self.text(0).to_owned(),
            dimension: self.parse(1)?,
            n: self.parse_optional(2)?,
            steps: self.parse(3)?,
            h: self.parse_optional(4)?,
            k: self.parse(5)?,
            dofs: self.parse(6)?,
            elements: self.parse(7)?,
            status: self.status()?,
            newton_iterations: self.parse(12)?,
            active_set_changes: self.parse(13)?,
            factorizations: self.parse(14)?,
            seconds_load: self.parse(15)?,
            seconds_assemble: self.parse(16)?,
            seconds_factor: self.parse(17)?,
            seconds_solve: self.parse(18)?,
            seconds_total: self.parse(19)?,
            peak_history_bytes: self.parse(20)?,
            errors: Vec::new(),
        })
    }

    pub(super) fn norm(&self) -> Result<Option<NormError>, RecordError> {
        let entry = NormError {
            norm: self.text(8).to_owned(),
            error: self.parse_optional(9)?,
            floor: self.parse_optional(10)?,
        };
        Ok(Some(entry).filter(|entry| !entry.norm.is_empty()))
    }

    fn status(&self) -> Result<Status, RecordError> {
        match self.text(11) {
            "converged" => Ok(Status::Converged),
            "failed" => Ok(Status::Failed { reason: String::new() }),
            "skipped" => Ok(Status::Skipped),
            _ => Err(self.malformed(11)),
        }
    }

    fn text(&self, column: usize) -> &str {
        self.fields.get(column).unwrap_or_default()
    }

    fn parse<T: FromStr>(&self, column: usize) -> Result<T, RecordError> {
        self.text(column).parse().map_err(|_| self.malformed(column))
    }

    fn parse_optional<T: FromStr>(&self, column: usize) -> Result<Option<T>, RecordError> {
        if self.text(column).is_empty() { Ok(None) } else { self.parse(column).map(Some) }
    }

    fn malformed(&self, column: usize) -> RecordError {
        RecordError::Value {
            path: self.path.to_owned(),
            line: self.line,
            column: COLUMNS[column],
            value: self.text(column).to_owned(),
        }
    }
}
