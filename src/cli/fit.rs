//! `sweep fit`: orders and verdicts for any table.

mod asked;
mod claims;
mod eoc;
mod grid;
mod line;
mod path;
mod picture;
mod values;
mod window;
mod wording;

use std::path::{Path, PathBuf};

use clap::Args;

use self::asked::Asked;
use self::claims::Claims;
use self::eoc::Style;
use self::window::Window;
use self::wording::Part;
use super::output::write_user_file;
use super::{CliError, print_json, print_text};
use files::{FileError, read_at_most, up_to};
use judge::fit::{Claim, Direction, Point, TOLERANCE, deviation, path};
use judge::table::{Group, Quantity, Reading, Tables, read};
use judge::verdict::Decision;

/// `sweep fit`.
#[derive(Args)]
#[command(
    after_help = "The table: columns that comma, semicolon, tab, blanks or | separate, a LaTeX tabular, or lines of \
`name = value`; # and % begin comments, and a header may be one. Sizes: h, dx or hmax; k, dt or tau; n or N and \
steps, which are 1/h and 1/k; cells or dofs with --dimension; level, where h = 2^-level. Errors: error, or norms side by side (L2, H1, \
Linf, energy, error_u, ...), each of them judged. A column value in place of error is a functional without an exact value: the \
extrapolated value, its order, the grid convergence index and the Eça-Hoekstra uncertainty are printed. Optional: \
floor, sigma (standard deviation of the error), norm, scene, status. Rates and counters (rate, eoc, order, cycle, ...) are skipped. Rows with the same scene and norm are \
one table, and several rows of one level are runs: the mean of the logarithms counts, and their scatter is the noise. `cases.csv` of a sweep is such a file.\n\n\
Examples:\n  \
sweep fit errors.csv --p 2                              is it second order?\n  \
program | sweep fit - --dimension 2 --p L2=2,H1=1       a printed table, h from its cells\n  \
sweep fit errors.csv --p 1 --window 0.01,0.1            of some meshes alone\n  \
sweep fit errors.csv --latex --svg errors.svg           the table and the picture for a paper\n\n\
JSON keys with --json: one object per table and direction, with scene, norm, variable (h, k, joint, path), \
predicted, observed (order is the same), interval, verdict, reason, at_least, exact, tolerance, and
  h, k of errors: probability, local_slopes, coarse_left_out, floor_from, log, constant, constant_interval, next, points_used, points_left_out
  joint: probability, predicted_k, observed_k, interval_k, models, better, constants
  path (k = c h^s): probability, exponent, path_constant, local_slopes, predicted_k, next
  h, k of values: probability, behaviour, finest, extrapolated, order_of_last_three, gci, half_range, eca_hoekstra, caution, next, points_used

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
    /// How far an order may lie from the prediction
    #[arg(long, value_name = "D", default_value_t = TOLERANCE, allow_hyphen_values = true)]
    tolerance: f64,
    /// Only steps from A to B: h, or k where the table has no h
    #[arg(long, value_name = "A,B")]
    window: Option<Window>,
    /// The error has a factor |log h|^M, or |log k|^M where the table has no h
    #[arg(long, value_name = "M", default_value_t = 0.0, allow_hyphen_values = true)]
    log: f64,
    /// Relative standard deviation of the errors, where it is known: 0.01 for 1 %
    #[arg(long, value_name = "S", allow_hyphen_values = true)]
    noise: Option<f64>,
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

/// The norms of a table, for error messages.
fn norms_there(groups: &[Group]) -> String {
    let mut names: Vec<&str> = groups.iter().filter_map(|group| group.norm.as_deref()).collect();
    names.sort_unstable();
    names.dedup();
    let list = names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
    match names.len() {
        0 => ": the errors of the table have no name; an order without one is theirs, as in --p 2"
            .into(),
        1 => format!("; there is {list}"),
        _ => format!("; there are {list}"),
    }
}

impl Fit {
    pub(super) fn execute(&self) -> Result<u8, CliError> {
        let mut tables = self.tables()?;
        for claims in [&self.p, &self.q].into_iter().flatten() {
            let known =
                |norm: &str| tables.groups.iter().any(|group| group.norm.as_deref() == Some(norm));
            if let Some(norm) = claims.norms().find(|norm| !known(norm)) {
                let words = format!("no norm `{norm}` to judge{}", norms_there(&tables.groups));
                return Err(CliError::about(self.name(), words));
            }
        }
        if let Some(Err(error)) = self.noise.map(deviation) {
            return Err(CliError::about("--noise", error));
        }
        let Self { at_least, exact, tolerance, log, .. } = *self;
        let claim = Claim { order: 1.0, at_least, exact, tolerance, log };
        let claim = claim.checked().map_err(CliError::other)?;
        let left_out = self.window.map(|window| window.narrow(&mut tables)).unwrap_or_default();
        let asked = |norm: Option<&str>| Asked {
            p: self.p.as_ref().and_then(|claims| claims.of(norm)),
            q: self.q.as_ref().and_then(|claims| claims.of(norm)),
            claim,
            noise: self.noise,
        };
        let found = judged(&self.name(), &tables, asked, &left_out)?;
        if let Some(file) = &self.svg {
            let drawn = picture::svg(&tables.groups, asked)?;
            write_user_file(file, drawn)?;
        }
        let texts = match (self.markdown, self.latex) {
            (true, _) => eoc::tables(&tables.groups, Style::Markdown),
            (_, true) => eoc::tables(&tables.groups, Style::Latex),
            _ => found.texts,
        };
        match self.json {
            true => print_json(&found.objects)?,
            false => texts.iter().for_each(|text| print_text(text)),
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
        let bytes = match self.file.as_os_str() == "-" {
            true => {
                up_to(std::io::stdin(), LARGEST).map_err(FileError::at("standard input".as_ref()))
            }
            false => read_at_most(&self.file, LARGEST),
        };
        tables(&self.name(), &bytes?, &Reading { dimension: self.dimension })
    }
}

/// Largest table, 256 MiB: a million rows of a sweep.
const LARGEST: u64 = 256 << 20;

fn tables(name: &str, bytes: &[u8], reading: &Reading) -> Result<Tables, CliError> {
    read(bytes, reading).map_err(|error| CliError::other(format!("{name}:{error}")))
}

/// The result of `sweep fit` for a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Fitted {
    /// The tables with their local orders, then a text per table and direction.
    pub texts: Vec<String>,
    /// The parts as JSON, without headings.
    pub objects: Vec<serde_json::Value>,
    /// No predicted order fails or is unresolved.
    pub all_pass: bool,
}

/// Reads and fits the tables of a file, against predicted orders in h and k if given.
///
/// # Errors
/// A file that is not a table, or has nothing to fit.
pub fn fitted(file: &Path, [p, q]: [Option<f64>; 2]) -> Result<Fitted, CliError> {
    let name = file.display().to_string();
    let tables = tables(&name, &read_at_most(file, LARGEST)?, &Reading::default())?;
    let claim = Claim::new(1.0).map_err(CliError::other)?;
    judged(&name, &tables, |_| Asked { p, q, claim, noise: None }, &[])
}

fn judged(
    name: &str,
    tables: &Tables,
    asked: impl Fn(Option<&str>) -> Asked,
    left_out: &[Vec<Point>],
) -> Result<Fitted, CliError> {
    let mut found = Fitted { texts: Vec::new(), objects: Vec::new(), all_pass: true };
    found.texts = eoc::tables(&tables.groups, Style::Text);
    for (at, group) in tables.groups.iter().enumerate() {
        let asked = asked(group.norm.as_deref());
        let outside = left_out.get(at).map_or(&[][..], Vec::as_slice);
        for mut part in parts(group, asked, outside).map_err(|why| CliError::about(name, why))? {
            found.all_pass &= part.decision.is_none_or(|d| d == Decision::Pass);
            part.json["scene"] = group.scene.clone().into();
            part.json["norm"] = group.norm.clone().into();
            found.objects.push(part.json);
            found.texts.push(match group.heading() {
                Some(heading) => format!("{heading}, {}", part.text),
                None => part.text,
            });
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

/// All results for one table.
fn parts(group: &Group, asked: Asked, outside: &[Point]) -> Result<Vec<Part>, &'static str> {
    let directions = Direction::BOTH.into_iter();
    if group.quantity == Quantity::Value {
        let part = |direction| values::part(group, direction, asked);
        return Ok(directions.filter_map(part).collect());
    }
    let both = directions.clone().all(|direction| group.refined(direction));
    if both && asked.claim.log != 0.0 {
        return Err("--log needs a table in which one step is refined: h and k both are");
    }
    if let Some(found) = path(&group.points()) {
        return Ok(vec![path::part(group, found, asked)]);
    }
    let joint = both.then(|| grid::Joint::of(group, asked));
    let line = |direction| line::part(group, direction, asked, joint.as_ref(), outside);
    let grid = joint.as_ref().map(|joint| grid::part(group, joint, asked));
    Ok(directions.filter_map(line).chain(grid).collect())
}
