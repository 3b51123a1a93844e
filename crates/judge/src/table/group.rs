//! The rows of one scene and norm.

use super::runs;
use crate::fit::{Direction, Point, same_level};

/// What a table measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// The error against a known solution.
    Error,
    /// A functional without an exact value.
    Value,
}

/// A row that serves, or the reason why it does not.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Its line in the text.
    pub line: u64,
    /// Its `error` is the value where the table has values.
    pub point: Point,
    /// Standard deviation of the error, in its unit.
    pub sigma: Option<f64>,
    /// Why the row cannot serve.
    pub gap: Option<String>,
}

/// The rows of one scene and norm.
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    /// Name of the scene, where the table has such a column.
    pub scene: Option<String>,
    /// Name of the norm, where the table has such a column or norms side by side.
    pub norm: Option<String>,
    /// What is measured.
    pub quantity: Quantity,
    /// The rows, in the order of the text.
    pub rows: Vec<Row>,
}

/// A point with the standard deviation of its error, relative to it, where that is known.
pub type Measurement = (Point, Option<f64>);

/// Gaps that are named before the rest is counted.
const NAMED_GAPS: usize = 3;

impl Group {
    /// The points of all rows without a gap, runs at one level as one, with relative standard deviations.
    pub fn measurements(&self) -> Vec<Measurement> {
        runs::merged(self.quantity, self.rows.iter().filter(|row| row.gap.is_none()))
    }

    /// The points alone.
    pub fn points(&self) -> Vec<Point> {
        self.measurements().into_iter().map(|(point, _)| point).collect()
    }

    /// Scene and norm above the parts, where the table has such columns.
    pub fn heading(&self) -> Option<String> {
        let names: Vec<&str> =
            [&self.scene, &self.norm].into_iter().filter_map(|name| name.as_deref()).collect();
        Some(names.join(" ")).filter(|text| !text.is_empty())
    }

    /// The gaps with their lines.
    pub fn gaps_in_words(&self) -> Option<String> {
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
    pub fn refined(&self, direction: Direction) -> bool {
        let mut steps = self.rows.iter().map(|row| direction.step(&row.point));
        let first = steps.find(|step| step.is_finite());
        first.is_some_and(|first| steps.any(|step| step.is_finite() && !same_level(step, first)))
    }

    /// The measurements that share a step of the other direction: the line with most points, the
    /// finest of several; all points where the table does not have that step.
    pub fn line(&self, direction: Direction) -> Vec<Measurement> {
        let other = match direction {
            Direction::Space => Direction::Time,
            Direction::Time => Direction::Space,
        };
        let mut points = self.measurements();
        points.retain(|(point, _)| direction.step(point).is_finite());
        points.sort_by(|(a, _), (b, _)| other.step(b).total_cmp(&other.step(a)));
        let level = |(a, _): &Measurement, (b, _): &Measurement| {
            let (a, b) = (other.step(a), other.step(b));
            same_level(a, b) || a.is_nan() && b.is_nan()
        };
        // Of equals the last is taken, which has the finest step.
        let longest = points.chunk_by(level).max_by_key(|line| line.len());
        longest.unwrap_or_default().to_vec()
    }
}
