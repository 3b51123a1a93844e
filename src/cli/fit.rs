//! `sweep fit`: orders and verdict for anybody's table.

mod grid;
mod line;
mod path;
mod table;
mod values;

use std::path::{Path, PathBuf};

use clap::Args;

use self::table::{Group, Quantity};
use super::{CliError, print_json, print_text};
use judge::fit::{Direction, joint_fits, path};
use judge::verdict::Decision;

/// `sweep fit`.
#[derive(Args)]
#[command(
    after_help = "Columns: h, k (one of them may be missing), error or value, and optionally floor, \
norm, scene, status; others are ignored. Rows with the same scene and norm are one table: `cases.csv` of \
a sweep is such a file. A column value in place of error is a functional without an exact value: the \
extrapolated value, its order, the grid convergence index and the Eça-Hoekstra uncertainty are printed.\n\n\
JSON keys with --json: one object a table and direction, with scene, norm, variable (h, k, joint, path), \
predicted, observed, interval, verdict, reason, and
  h, k of errors: local_slopes, constant, constant_interval, points_used, points_left_out
  joint: predicted_k, observed_k, interval_k, models, better, constants
  path (k = c h^s): exponent, path_constant, local_slopes, predicted_k
  h, k of values: behaviour, finest, extrapolated, order_of_last_three, gci, half_range, eca_hoekstra, points_used

Exit codes: 0 without --p and --q, or if all verdicts pass; 1 if one fails or is unresolved; 2 if the table \
cannot be read."
)]
pub struct Fit {
    /// Table with columns h, k, error (one of h, k may be missing) and optionally floor
    file: PathBuf,
    /// Predicted order in h
    #[arg(long)]
    p: Option<f64>,
    /// Predicted order in k
    #[arg(long)]
    q: Option<f64>,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// What is said of one table in one direction.
struct Part {
    text: String,
    json: serde_json::Map<String, serde_json::Value>,
    /// The verdict, where an order is predicted.
    decision: Option<Decision>,
}

/// The orders that are predicted.
#[derive(Debug, Clone, Copy)]
struct Predicted {
    p: Option<f64>,
    q: Option<f64>,
}

impl Fit {
    pub(super) fn execute(&self) -> Result<u8, CliError> {
        let Fitted { texts, objects, all_pass } = fitted(&self.file, [self.p, self.q])?;
        if self.json {
            print_json(&objects.into())?;
        } else {
            texts.iter().for_each(|text| print_text(text));
        }
        Ok(u8::from(!all_pass))
    }
}

/// What `sweep fit` says of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Fitted {
    /// A text a table and direction, headings between them.
    pub texts: Vec<String>,
    /// The same as JSON, without headings.
    pub objects: Vec<serde_json::Value>,
    /// No order that is predicted fails or is unresolved.
    pub all_pass: bool,
}

/// Reads and fits the tables of a file, against predicted orders in h and k where there are any.
///
/// # Errors
/// A file that is no table, or has nothing to fit.
pub fn fitted(file: &Path, [p, q]: [Option<f64>; 2]) -> Result<Fitted, CliError> {
    let predicted = Predicted { p, q };
    let mut found = Fitted { texts: Vec::new(), objects: Vec::new(), all_pass: true };
    for group in &table::read(file)? {
        let parts = parts(group, predicted);
        let passes = |part: &Part| part.decision.is_none_or(|d| d == Decision::Pass);
        found.all_pass &= parts.iter().all(passes);
        found.texts.extend(group.heading().filter(|_| !parts.is_empty()));
        for mut part in parts {
            part.json.insert("scene".into(), group.scene.clone().into());
            part.json.insert("norm".into(), group.norm.clone().into());
            found.objects.push(serde_json::Value::Object(part.json));
            found.texts.push(part.text);
        }
    }
    if found.objects.is_empty() {
        let hint = "neither h nor k takes two values: nothing to fit";
        return Err(CliError::about(file.display(), hint));
    }
    Ok(found)
}

/// All that one table says.
fn parts(group: &Group, predicted: Predicted) -> Vec<Part> {
    let points = group.points();
    if group.quantity == Quantity::Value {
        return [(Direction::Space, predicted.p), (Direction::Time, predicted.q)]
            .into_iter()
            .filter_map(|(direction, order)| values::part(group, direction, order))
            .collect();
    }
    if let Some(found) = path(&points) {
        return vec![path::part(group, found, predicted)];
    }
    let both = group.refined(Direction::Space) && group.refined(Direction::Time);
    let joint = both.then(|| joint_fits(&points, false));
    let lines = [(Direction::Space, predicted.p), (Direction::Time, predicted.q)]
        .into_iter()
        .filter_map(|(direction, order)| line::part(group, direction, order, joint.as_ref()));
    let lines: Vec<Part> = lines.collect();
    let grid = joint.map(|joint| grid::part(group, &joint, predicted));
    lines.into_iter().chain(grid).collect()
}

/// The verdict of a table with gaps: as in a sweep, a case that is missing is a failure.
fn gap_verdict(group: &Group) -> Option<(Decision, String)> {
    group.gaps_in_words().map(|gaps| (Decision::Fail, gaps))
}

/// `; predicted 1: pass, 1 lies in …` for the end of a line of text.
fn verdict_text(predicted: Option<String>, verdict: Option<&(Decision, String)>) -> String {
    match (predicted, verdict) {
        (Some(order), Some((decision, reason))) => {
            format!("predicted {order}: {}, {reason}", decision.name())
        }
        (_, Some((_, reason))) => reason.clone(),
        _ => String::new(),
    }
}

/// The step of one more level, in the ratio of the last two.
fn next_step(name: &str, steps: &[f64]) -> String {
    match steps {
        [.., previous, last] => format!("run {name} = {:.4}", last * last / previous),
        [only] => format!("run {name} = {:.4} and {name} = {:.4}", only / 2.0, only / 4.0),
        [] => format!("run three values of {name}"),
    }
}

/// Name of the step in tables.
fn step_name(direction: Direction) -> &'static str {
    match direction {
        Direction::Space => "h",
        Direction::Time => "k",
    }
}

/// Local orders that are printed; --json has all of them.
const PRINTED: usize = 12;

/// `1.234 0.987`, the last ones of many.
fn orders_text(orders: &[f64]) -> String {
    let last = &orders[orders.len().saturating_sub(PRINTED)..];
    let dots = (last.len() < orders.len()).then(|| "…".to_owned());
    let texts = last.iter().map(|order| format!("{order:.3}"));
    dots.into_iter().chain(texts).collect::<Vec<_>>().join(" ")
}

/// The entries of a JSON object.
fn map(object: serde_json::Value) -> serde_json::Map<String, serde_json::Value> {
    match object {
        serde_json::Value::Object(map) => map,
        _ => serde_json::Map::new(),
    }
}
