//! The rows of one scene and norm; several runs at one level count as one point with a standard deviation.

use fit::{Direction, Point, same_level};

/// Why a text is no table.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{line}: {what}")]
pub struct TableError {
    pub line: u64,
    /// What is wrong there, with the value, and the way out.
    pub what: String,
}

impl TableError {
    pub(super) fn at(line: u64, what: impl Into<String>) -> Self {
        Self { line, what: what.into() }
    }
}

/// What a reader has to know beside the text.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Reading {
    /// Dimension of the mesh, if sizes are counts of cells or unknowns.
    pub dimension: Option<u32>,
    /// Each row refines by it where the table has no sizes; a level does where it has levels.
    pub ratio: Option<f64>,
    /// Sizes by the ratio are time steps.
    pub in_time: bool,
    /// Columns that tell tables apart.
    pub by: Vec<String>,
    /// Rows of one level are runs, and their mean counts.
    pub runs: bool,
    /// Columns that are errors, whatever their names.
    pub errors: Vec<String>,
}

/// What a table measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    Error,
    /// A functional whose exact value is unknown.
    Value,
}

/// A row that serves, or the reason why it does not.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    pub line: u64,
    /// With values in place of errors, `error` holds the value.
    pub point: Point,
    /// Standard deviation of the error, absolute.
    pub sigma: Option<f64>,
    pub gap: Option<String>,
}

/// A point with the relative standard deviation of its error, if known.
pub type Measurement = (Point, Option<f64>);

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
        merged(self.quantity, self.rows.iter().filter(|row| row.gap.is_none()))
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

/// Several runs at one level (random meshes) merged into one point with a standard deviation.
/// Levels in the order of their first rows. Errors are averaged on logarithms; the deviation of that mean is pooled
/// over all levels, because two runs alone would leave it open by a factor of ten. Values are averaged.
fn merged<'a>(quantity: Quantity, rows: impl Iterator<Item = &'a Row>) -> Vec<Measurement> {
    let mut levels: Vec<Vec<&Row>> = Vec::new();
    let mut rows: Vec<(usize, &Row)> = rows.enumerate().collect();
    rows.sort_by(|(i, a), (j, b)| {
        (a.point.h.total_cmp(&b.point.h)).then(a.point.k.total_cmp(&b.point.k)).then(i.cmp(j))
    });
    for (_, row) in rows {
        match levels.last_mut() {
            Some(level) if same(&level[0].point, &row.point) => level.push(row),
            _ => levels.push(vec![row]),
        }
    }
    levels.sort_by_key(|level| level.iter().map(|row| row.line).min());
    let spread = spread(&levels).filter(|_| quantity == Quantity::Error);
    levels.iter().map(|level| one(quantity, level, spread)).collect()
}

fn same(a: &Point, b: &Point) -> bool {
    let equal = |a: f64, b: f64| same_level(a, b) || a.is_nan() && b.is_nan();
    equal(a.h, b.h) && equal(a.k, b.k)
}

/// Pooled standard deviation of log error; none if no runs differ.
fn spread(levels: &[Vec<&Row>]) -> Option<f64> {
    let (mut squares, mut freedom) = (0.0, 0usize);
    for level in levels.iter().filter(|level| level.len() > 1) {
        let logs: Vec<f64> = level.iter().map(|row| row.point.error.ln()).collect();
        let mean = logs.iter().sum::<f64>() / logs.len() as f64;
        squares += logs.iter().map(|log| (log - mean).powi(2)).sum::<f64>();
        freedom += logs.len() - 1;
    }
    let spread = (squares / freedom as f64).sqrt();
    (spread > 0.0 && spread.is_finite()).then_some(spread)
}

fn one(quantity: Quantity, level: &[&Row], spread: Option<f64>) -> Measurement {
    let runs = level.len() as f64;
    let mean = |f: &dyn Fn(&Row) -> f64| level.iter().map(|row| f(row)).sum::<f64>() / runs;
    let first = level[0].point;
    // A zero error stays zero and is dropped later as below any floor.
    let error = match quantity {
        _ if level.len() == 1 => first.error,
        Quantity::Error => mean(&|row| row.point.error.ln()).exp(),
        Quantity::Value => mean(&|row| row.point.error),
    };
    let floor = level.iter().map(|row| row.point.floor).fold(0.0, f64::max);
    let given: Option<Vec<f64>> =
        level.iter().map(|row| row.sigma.map(|sigma| sigma / row.point.error)).collect();
    let given = given.map(|all| (all.iter().map(|s| s * s).sum::<f64>()).sqrt() / runs);
    let sigma = given.or(spread.map(|spread| spread / runs.sqrt()));
    (Point { error, floor, ..first }, sigma.filter(|sigma| sigma.is_finite()))
}
