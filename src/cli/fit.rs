//! `sweep fit`: orders and verdict for anybody's table.

mod claims;
mod eoc;
mod grid;
mod line;
mod path;
mod picture;
mod values;

use std::io::Read;
use std::path::{Path, PathBuf};

use clap::Args;

use self::claims::Claims;
use self::eoc::{Style, plain};
use super::output::write_user_file;
use super::{CliError, print_json, print_text};
use files::read_at_most;
use judge::fit::{Direction, Point, joint_fits, path};
use judge::table::{Group, Quantity, Reading, Tables, read};
use judge::verdict::{Aim, Decision};

/// `sweep fit`.
#[derive(Args)]
#[command(
    after_help = "The table: columns that comma, semicolon, tab, blanks or | separate, a LaTeX tabular, or lines of \
`name = value`; # and % begin comments, and a header may be one. Sizes: h, dx or hmax; k, dt or tau; n or N and \
steps, which are 1/h and 1/k; cells or dofs with --dimension; level, where h = 2^-level. Errors: error, or norms side by side (L2, H1, \
Linf, energy, error_u, ...), each of them judged. A column value in place of error is a functional without an exact value: the \
extrapolated value, its order, the grid convergence index and the Eça-Hoekstra uncertainty are printed. Optional: \
floor, norm, scene, status. Rates and counters (rate, eoc, order, cycle, ...) are skipped. Rows with the same scene and norm are \
one table, and several rows of one level are runs, of which the mean of the logarithms counts; `cases.csv` of a sweep is such a file.\n\n\
Examples:\n  \
sweep fit errors.csv --p 2                              is it second order?\n  \
program | sweep fit - --dimension 2 --p L2=2,H1=1       a printed table, h from its cells\n  \
sweep fit errors.csv --latex --svg errors.svg           the table and the picture for a paper\n\n\
JSON keys with --json: one object a table and direction, with scene, norm, variable (h, k, joint, path), \
predicted, observed, interval, verdict, reason, and
  h, k of errors: local_slopes, constant, constant_interval, points_used, points_left_out
  joint: predicted_k, observed_k, interval_k, models, better, constants
  path (k = c h^s): exponent, path_constant, local_slopes, predicted_k
  h, k of values: behaviour, finest, extrapolated, order_of_last_three, gci, half_range, eca_hoekstra, points_used

Exit codes: 0 without --p and --q, or if all verdicts pass; 1 if one fails or is unresolved; 2 if the table \
cannot be read."
)]
pub(crate) struct Fit {
    /// Table of errors or values, - for standard input
    file: PathBuf,
    /// Predicted order in h: one number for all norms, or NORM=P,...
    #[arg(long, allow_hyphen_values = true)]
    p: Option<Claims>,
    /// Predicted order in k: one number for all norms, or NORM=Q,...
    #[arg(long, allow_hyphen_values = true)]
    q: Option<Claims>,
    /// The orders are lower bounds
    #[arg(long)]
    at_least: bool,
    /// A higher order fails as well
    #[arg(long, conflicts_with = "at_least")]
    exact: bool,
    /// Dimension of the mesh, where its size is a number of cells or unknowns: h = cells^(-1/D)
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=3))]
    dimension: Option<u32>,
    /// Print JSON
    #[arg(long)]
    json: bool,
    /// Print the table with its orders in Markdown
    #[arg(long, conflicts_with = "json")]
    markdown: bool,
    /// Print the table with its orders in LaTeX
    #[arg(long, conflicts_with_all = ["json", "markdown"])]
    latex: bool,
    /// Draw the errors into this file, with triangles of the predicted orders
    #[arg(long, value_name = "FILE")]
    svg: Option<PathBuf>,
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
    at_least: bool,
    exact: bool,
}

impl Predicted {
    fn order(self, direction: Direction) -> Option<f64> {
        match direction {
            Direction::Space => self.p,
            Direction::Time => self.q,
        }
    }

    fn aim(self, order: f64) -> Aim {
        Aim { order, at_least: self.at_least, exact: self.exact }
    }
}

impl Fit {
    pub(super) fn execute(&self) -> Result<u8, CliError> {
        let tables = self.tables()?;
        for claims in [&self.p, &self.q].into_iter().flatten() {
            let known =
                |norm: &str| tables.groups.iter().any(|own| own.norm.as_deref() == Some(norm));
            if let Some(norm) = claims.norms().find(|norm| !known(norm)) {
                return Err(CliError::about(self.name(), format!("no norm `{norm}` to judge")));
            }
        }
        let predicted = |norm: Option<&str>| Predicted {
            p: self.p.as_ref().and_then(|claims| claims.of(norm)),
            q: self.q.as_ref().and_then(|claims| claims.of(norm)),
            at_least: self.at_least,
            exact: self.exact,
        };
        let found = judged(&self.name(), &tables, predicted)?;
        if let Some(file) = &self.svg {
            let drawn = picture::svg(&tables.groups, predicted)?;
            write_user_file(file, drawn)?;
        }
        match (self.json, self.markdown, self.latex) {
            (true, ..) => print_json(&found.objects.into())?,
            (_, true, _) => {
                eoc::tables(&tables.groups, Style::Markdown).iter().for_each(|t| print_text(t))
            }
            (.., true) => {
                eoc::tables(&tables.groups, Style::Latex).iter().for_each(|t| print_text(t))
            }
            _ => found.texts.iter().for_each(|text| print_text(text)),
        }
        Ok(u8::from(!found.all_pass))
    }

    fn name(&self) -> String {
        match self.file.as_os_str() == "-" {
            true => "standard input".into(),
            false => self.file.display().to_string(),
        }
    }

    fn tables(&self) -> Result<Tables, CliError> {
        let reading = Reading { dimension: self.dimension };
        if self.file.as_os_str() != "-" {
            return tables(&self.file, &reading);
        }
        let mut bytes = Vec::new();
        let said = std::io::stdin().take(LARGEST + 1).read_to_end(&mut bytes);
        said.map_err(|error| CliError::about(self.name(), error))?;
        if bytes.len() as u64 > LARGEST {
            return Err(CliError::about(self.name(), format!("more than {} MiB", LARGEST >> 20)));
        }
        read(&bytes, &reading).map_err(|error| CliError::other(format!("{}:{error}", self.name())))
    }
}

/// The longest table that is read, in bytes (256 MiB): a million rows of a sweep.
const LARGEST: u64 = 256 << 20;

fn tables(file: &Path, reading: &Reading) -> Result<Tables, CliError> {
    let bytes =
        read_at_most(file, LARGEST).map_err(|error| CliError::about(file.display(), error))?;
    read(&bytes, reading).map_err(|error| CliError::other(format!("{}:{error}", file.display())))
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
    let tables = tables(file, &Reading::default())?;
    let name = file.display().to_string();
    judged(&name, &tables, |_| Predicted { p, q, at_least: false, exact: false })
}

fn judged(
    name: &str,
    tables: &Tables,
    predicted: impl Fn(Option<&str>) -> Predicted,
) -> Result<Fitted, CliError> {
    let mut found = Fitted { texts: Vec::new(), objects: Vec::new(), all_pass: true };
    for group in &tables.groups {
        let parts = parts(group, predicted(group.norm.as_deref()));
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
        return Err(CliError::about(name, hint));
    }
    if !tables.unknown.is_empty() {
        found.texts.push(format!("not understood and not read: {}", tables.unknown.join(", ")));
    }
    Ok(found)
}

/// The points of a line of a table.
fn line_points(group: &Group, direction: Direction) -> Vec<Point> {
    group.line(direction).into_iter().map(|(point, _)| point).collect()
}

/// All that one table says.
fn parts(group: &Group, predicted: Predicted) -> Vec<Part> {
    let points = group.points();
    if group.quantity == Quantity::Value {
        return [Direction::Space, Direction::Time]
            .into_iter()
            .filter_map(|direction| values::part(group, direction, predicted))
            .collect();
    }
    if let Some(found) = path(&points) {
        return vec![path::part(group, found, predicted)];
    }
    let both = group.refined(Direction::Space) && group.refined(Direction::Time);
    let joint = both.then(|| joint_fits(&points, false));
    let lines = [Direction::Space, Direction::Time]
        .into_iter()
        .filter_map(|direction| line::part(group, direction, predicted, joint.as_ref()));
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
        [.., previous, last] => format!("run {name} = {}", plain(last * last / previous)),
        [only] => {
            format!("run {name} = {} and {name} = {}", plain(only / 2.0), plain(only / 4.0))
        }
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
