//! The file of `sweep fit`: rows of any origin, sorted into tables.

use std::path::Path;

use csv::StringRecord;

use super::super::CliError;
use files::{counted, read_at_most};
use judge::fit::{Direction, Point, same_level, screen};

/// What a table measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Quantity {
    /// The error against a known solution.
    Error,
    /// A functional without an exact value.
    Value,
}

/// A row that serves, or the reason why it does not.
struct Row {
    line: u64,
    /// Its `error` is the value where the table has values.
    point: Point,
    gap: Option<String>,
}

/// The rows of one scene and norm.
pub(super) struct Group {
    pub(super) scene: Option<String>,
    pub(super) norm: Option<String>,
    pub(super) quantity: Quantity,
    rows: Vec<Row>,
}

/// The longest table that is read, in bytes (256 MiB): a million rows of a sweep.
const LARGEST: u64 = 256 << 20;

/// Gaps that are named before the rest is counted.
const NAMED_GAPS: usize = 3;

impl Group {
    /// The points of all rows without a gap.
    pub(super) fn points(&self) -> Vec<Point> {
        self.rows.iter().filter(|row| row.gap.is_none()).map(|row| row.point).collect()
    }

    /// Scene and norm above the parts, where the file has such columns.
    pub(super) fn heading(&self) -> Option<String> {
        let names: Vec<&str> =
            [&self.scene, &self.norm].into_iter().filter_map(|name| name.as_deref()).collect();
        Some(names.join(" ")).filter(|text| !text.is_empty())
    }

    pub(super) fn gaps_in_words(&self) -> Option<String> {
        let gap = |row: &Row| row.gap.as_ref().map(|gap| format!("line {}: {gap}", row.line));
        let gaps: Vec<String> = self.rows.iter().filter_map(gap).collect();
        let named = gaps.iter().take(NAMED_GAPS).cloned().collect::<Vec<_>>().join("; ");
        match gaps.len() {
            0 => None,
            count if count > NAMED_GAPS => {
                Some(format!("{named}; and {} more", count - NAMED_GAPS))
            }
            _ => Some(named),
        }
    }

    /// Whether a step takes two values and more.
    pub(super) fn refined(&self, direction: Direction) -> bool {
        let mut steps = self.rows.iter().map(|row| direction.step(&row.point));
        let first = steps.find(|step| step.is_finite());
        first.is_some_and(|first| steps.any(|step| step.is_finite() && !same_level(step, first)))
    }

    /// The points that share a step of the other direction: the one with most points, the
    /// finest of several; all points where the table does not have that step.
    pub(super) fn line(&self, direction: Direction) -> Vec<Point> {
        let other = match direction {
            Direction::Space => Direction::Time,
            Direction::Time => Direction::Space,
        };
        let mut points = self.points();
        points.retain(|point| direction.step(point).is_finite());
        points.sort_by(|a, b| other.step(b).total_cmp(&other.step(a)));
        let level = |a: &Point, b: &Point| {
            let (a, b) = (other.step(a), other.step(b));
            same_level(a, b) || a.is_nan() && b.is_nan()
        };
        // Of equals the last is taken, which has the finest step.
        let longest = points.chunk_by(level).max_by_key(|line| line.len());
        longest.unwrap_or_default().to_vec()
    }
}

/// Places of the columns.
struct Columns {
    h: Option<usize>,
    k: Option<usize>,
    measured: usize,
    quantity: Quantity,
    floor: Option<usize>,
    scene: Option<usize>,
    norm: Option<usize>,
    status: Option<usize>,
    count: usize,
}

impl Columns {
    fn of(header: &StringRecord) -> Result<Self, String> {
        let place = |name: &str| header.iter().position(|own| own.eq_ignore_ascii_case(name));
        let (measured, quantity) = match (place("error"), place("value")) {
            (Some(_), Some(_)) => {
                return Err("line 1: both `error` and `value`: which of them is judged?".into());
            }
            (Some(error), None) => (error, Quantity::Error),
            (None, Some(value)) => (value, Quantity::Value),
            (None, None) => return Err("line 1: no column `error` (or `value`)".into()),
        };
        let (h, k) = (place("h"), place("k"));
        if h.is_none() && k.is_none() {
            return Err("line 1: no column `h` and no column `k`".into());
        }
        Ok(Self {
            h,
            k,
            measured,
            quantity,
            floor: place("floor"),
            scene: place("scene"),
            norm: place("norm"),
            status: place("status"),
            count: header.len(),
        })
    }

    fn row(&self, record: &StringRecord, line: u64) -> Result<Row, String> {
        if record.len() != self.count {
            let (own, wanted) = (counted(record.len(), "field"), self.count);
            return Err(format!("line {line}: {own}, the header has {wanted}"));
        }
        let text =
            |at: Option<usize>| at.and_then(|at| record.get(at)).filter(|text| !text.is_empty());
        let number = |at: Option<usize>, absent: f64| -> Result<f64, String> {
            let Some(text) = text(at) else { return Ok(absent) };
            text.parse().map_err(|_| format!("line {line}: `{text}` is not a number"))
        };
        let step = |at: Option<usize>, name: &str| -> Result<f64, String> {
            let step = number(at, f64::NAN)?;
            if text(at).is_none() || step.is_finite() && step > 0.0 {
                Ok(step)
            } else {
                Err(format!("line {line}: {name} = {step} is no step size, which is positive"))
            }
        };
        let point = Point {
            h: step(self.h, "h")?,
            k: step(self.k, "k")?,
            error: number(Some(self.measured), f64::NAN)?,
            floor: number(self.floor, 0.0)?,
        };
        let gap = match (text(self.status), text(Some(self.measured)), self.quantity) {
            (Some(status), ..) if status != "converged" => Some(format!("the case is {status}")),
            (_, None, Quantity::Error) => Some("no error".into()),
            (_, None, Quantity::Value) => Some("no value".into()),
            (.., Quantity::Error) => {
                screen(&point).err().filter(|why| why.is_broken()).map(|why| why.to_string())
            }
            _ if point.error.is_finite() => None,
            _ => Some(format!("the value {} is no number", point.error)),
        };
        Ok(Row { line, point, gap })
    }
}

/// Reads a file.
pub(super) fn read(path: &Path) -> Result<Vec<Group>, CliError> {
    let fail = |what: String| CliError::about(path.display(), what);
    let bytes = read_at_most(path, LARGEST).map_err(|error| fail(error.to_string()))?;
    let mut reader =
        csv::ReaderBuilder::new().trim(csv::Trim::All).flexible(true).from_reader(&bytes[..]);
    let header = reader.headers().map_err(|error| fail(error.to_string()))?.clone();
    let columns = Columns::of(&header).map_err(fail)?;
    let mut groups: Vec<Group> = Vec::new();
    let mut places = std::collections::HashMap::new();
    for record in reader.records() {
        let record = record.map_err(|error| fail(error.to_string()))?;
        let line = record.position().map_or(0, csv::Position::line);
        let row = columns.row(&record, line).map_err(fail)?;
        let name = |at: Option<usize>| at.and_then(|at| record.get(at)).map(str::to_owned);
        let (scene, norm) = (name(columns.scene), name(columns.norm));
        let place = *places.entry((scene.clone(), norm.clone())).or_insert(groups.len());
        if place == groups.len() {
            groups.push(Group { scene, norm, quantity: columns.quantity, rows: Vec::new() });
        }
        groups[place].rows.push(row);
    }
    if groups.is_empty() {
        return Err(fail("no rows below the header".into()));
    }
    share_nameless(&mut groups);
    groups.iter_mut().for_each(mark_missing_steps);
    Ok(groups)
}

/// A case that failed has no norm in `cases.csv`: it is missing in all norms of its scene.
fn share_nameless(groups: &mut Vec<Group>) {
    let nameless = |group: &Group| group.norm.as_deref() == Some("");
    let named = |group: &Group, scene: &Option<String>| group.scene == *scene && !nameless(group);
    let (lost, mut kept): (Vec<Group>, Vec<Group>) =
        std::mem::take(groups).into_iter().partition(nameless);
    for group in lost {
        let takers: Vec<&mut Group> =
            kept.iter_mut().filter(|own| named(own, &group.scene)).collect();
        if takers.is_empty() {
            kept.push(group);
            continue;
        }
        for taker in takers {
            taker.rows.extend(group.rows.iter().map(|row| Row {
                line: row.line,
                point: row.point,
                gap: Some(row.gap.clone().unwrap_or_else(|| "a row without a norm".into())),
            }));
        }
    }
    *groups = kept;
}

/// A row without h in a table that has h elsewhere can take no part in it; the same for k.
fn mark_missing_steps(group: &mut Group) {
    for (direction, name) in [(Direction::Space, "h"), (Direction::Time, "k")] {
        let missing = |row: &Row| direction.step(&row.point).is_nan();
        if group.rows.iter().all(missing) {
            continue;
        }
        for row in group.rows.iter_mut().filter(|row| missing(row)) {
            row.gap.get_or_insert(format!("no {name}"));
        }
    }
}

#[cfg(test)]
mod tests;
