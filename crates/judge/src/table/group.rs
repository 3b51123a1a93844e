//! The rows of one scene and norm.

use super::{Measurement, Quantity, Row, runs};
use crate::fit::{Direction, Point, same_level};

/// The rows of one scene and norm.
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    /// If the table has such a column.
    pub scene: Option<String>,
    /// If the table has such a column, or several norms.
    pub norm: Option<String>,
    pub quantity: Quantity,
    /// The rows, in the order of the text.
    pub rows: Vec<Row>,
}

/// Gaps named before the rest is counted.
const NAMED_GAPS: usize = 3;

impl Group {
    /// Points of all usable rows, with repeated runs of a level merged.
    pub fn measurements(&self) -> Vec<Measurement> {
        runs::merged(self.quantity, self.rows.iter().filter(|row| row.gap.is_none()))
    }

    /// The points alone.
    pub fn points(&self) -> Vec<Point> {
        self.measurements().into_iter().map(|(point, _)| point).collect()
    }

    /// Scene and norm, if the table has such columns.
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

    /// Measurements on one line: the step of the other direction with most points, the finest of several; all points if
    /// the table lacks that step.
    pub fn line(&self, direction: Direction) -> Vec<Measurement> {
        let other = direction.other();
        let mut points = self.measurements();
        points.retain(|(point, _)| direction.step(point).is_finite());
        points.sort_by(|(a, _), (b, _)| other.step(b).total_cmp(&other.step(a)));
        let level = |(a, _): &Measurement, (b, _): &Measurement| {
            let (a, b) = (other.step(a), other.step(b));
            same_level(a, b) || a.is_nan() && b.is_nan()
        };
        // Of equals `max_by_key` takes the last, which has the finest step.
        let longest = points.chunk_by(level).max_by_key(|line| line.len());
        longest.unwrap_or_default().to_vec()
    }
}
