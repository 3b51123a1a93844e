//! `sweep fit`: orders and verdict for anybody's table.

use std::path::PathBuf;

use clap::Args;

use super::{CliError, print_json, print_text};
use crate::fit::{
    Correction, Direction, OrderInterval, Point, local_slopes, order_interval, samples, screen,
};
use crate::record::counted;
use crate::verdict::{Aim, Decision, compare};

/// `sweep fit`.
#[derive(Args)]
#[command(
    after_help = "JSON keys with --json: one object a direction with variable, local_slopes, observed, interval, constant, predicted, verdict, reason."
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

impl Fit {
    pub(super) fn execute(&self) -> Result<u8, CliError> {
        let points = read(&self.file)?;
        let mut rows = Vec::new();
        let mut all_pass = true;
        for (direction, name, predicted) in
            [(Direction::Space, "h", self.p), (Direction::Time, "k", self.q)]
        {
            let line = finest_line(&points, direction);
            let steps = || line.iter().map(|p| direction.step(p)).filter(|step| step.is_finite());
            let refined = steps().any(|step| Some(step) != steps().next());
            if !refined && predicted.is_none() {
                continue;
            }
            let correction = match direction {
                Direction::Time if predicted == Some(2.0) => Correction::Quadratic,
                _ => Correction::Linear,
            };
            let fitted = samples(&line, direction).and_then(|s| {
                order_interval(&s, correction).map(|found| (local_slopes(&s), found))
            });
            // A broken row is a failure of the table, as a missing case is one of a sweep.
            let broken = line.iter().filter_map(|p| screen(p).err()).find(|why| why.is_broken());
            let (decision, reason) = match (&fitted, predicted) {
                (_, Some(_)) if broken.is_some() => {
                    (Some(Decision::Fail), broken.map_or(String::new(), |why| why.to_string()))
                }
                (Ok((_, found)), Some(order)) => {
                    let aim = Aim { order, at_least: false, exact: false };
                    let (decision, reason) = compare(found.interval, aim);
                    (Some(decision), reason)
                }
                (Ok(_), None) => (None, String::new()),
                (Err(error), _) => (predicted.map(|_| Decision::Unresolved), error.to_string()),
            };
            all_pass &= decision.is_none_or(|decision| decision == Decision::Pass);
            rows.push(Row { name, predicted, fitted: fitted.ok(), decision, reason });
        }
        if rows.is_empty() {
            let hint = "neither h nor k takes two values: nothing to fit";
            return Err(CliError::Other(format!("{}: {hint}", self.file.display())));
        }
        if self.json {
            print_json(&rows.iter().map(Row::json).collect())?;
        } else {
            rows.iter().for_each(|row| print_text(&row.text()));
        }
        Ok(u8::from(!all_pass))
    }
}

struct Row {
    name: &'static str,
    predicted: Option<f64>,
    fitted: Option<(Vec<f64>, OrderInterval)>,
    decision: Option<Decision>,
    reason: String,
}

impl Row {
    fn json(&self) -> serde_json::Value {
        let found = self.fitted.as_ref();
        serde_json::json!({
            "variable": self.name,
            "local_slopes": found.map(|(slopes, _)| slopes.clone()),
            "observed": found.map(|(_, found)| found.law.order),
            "interval": found.map(|(_, found)| [found.interval.lo, found.interval.hi]),
            "constant": found.map(|(_, found)| found.law.constant),
            "predicted": self.predicted,
            "verdict": self.decision.map(Decision::name),
            "reason": self.reason,
        })
    }

    fn text(&self) -> String {
        let verdict = self.decision.zip(self.predicted).map(|(decision, order)| {
            format!("predicted {order}: {}, {}", decision.name(), self.reason)
        });
        let Some((slopes, found)) = &self.fitted else {
            return format!("{}: {}", self.name, verdict.unwrap_or_else(|| self.reason.clone()));
        };
        let slopes: Vec<String> = slopes.iter().map(|slope| format!("{slope:.3}")).collect();
        let verdict = verdict.map_or(String::new(), |verdict| format!("; {verdict}"));
        format!(
            "{}: order {:.3} in [{:.3}, {:.3}], constant {:.4e}{verdict}\n   local orders {}",
            self.name,
            found.law.order,
            found.interval.lo,
            found.interval.hi,
            found.law.constant,
            slopes.join(" ")
        )
    }
}

/// The points with the finest step of the other direction.
fn finest_line(points: &[Point], direction: Direction) -> Vec<Point> {
    let other = |p: &Point| match direction {
        Direction::Space => p.k,
        Direction::Time => p.h,
    };
    let finest = points.iter().map(other).fold(f64::INFINITY, f64::min);
    points.iter().filter(|p| other(p).is_nan() || other(p) == finest).copied().collect()
}

fn read(path: &std::path::Path) -> Result<Vec<Point>, CliError> {
    let fail = |what: String| CliError::Other(format!("{}: {what}", path.display()));
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .flexible(true)
        .from_path(path)
        .map_err(|error| fail(error.to_string()))?;
    let header = reader.headers().map_err(|error| fail(error.to_string()))?.clone();
    let column = |name: &str| header.iter().position(|own| own.eq_ignore_ascii_case(name));
    let (h, k, floor) = (column("h"), column("k"), column("floor"));
    let error = column("error").ok_or_else(|| fail("line 1: no column `error`".into()))?;
    if h.is_none() && k.is_none() {
        return Err(fail("line 1: no column `h` and no column `k`".into()));
    }
    let mut points = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|error| fail(error.to_string()))?;
        let line = record.position().map_or(0, csv::Position::line);
        if record.len() != header.len() {
            let (own, wanted) = (record.len(), header.len());
            return Err(fail(format!(
                "line {line}: {}, the header has {wanted}",
                counted(own, "field")
            )));
        }
        let number = |at: Option<usize>, absent: f64| -> Result<f64, CliError> {
            let Some(text) = at.and_then(|at| record.get(at)).filter(|text| !text.is_empty())
            else {
                return Ok(absent);
            };
            text.parse().map_err(|_| fail(format!("line {line}: `{text}` is not a number")))
        };
        points.push(Point {
            h: number(h, f64::NAN)?,
            k: number(k, f64::NAN)?,
            error: number(Some(error), f64::NAN)?,
            floor: number(floor, 0.0)?,
        });
    }
    if points.is_empty() {
        return Err(fail("no rows below the header".into()));
    }
    Ok(points)
}
