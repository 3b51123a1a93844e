//! `sweep fit`: orders and verdicts for any table.

mod eoc;
mod parts;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::str::FromStr;

use self::eoc::Style;
use self::parts::{Asked, Part};
use super::output::print_error;
use super::swept::{announce, in_file, on_github};
use super::{CliError, print_json, print_text};
use clap::Args;
use files::{FileError, read_at_most, same_file, up_to, write_named};
use judge::fit::{Claim, Direction, Known, Point, TOLERANCE, deviation, path};
use judge::record::V_TIME_MAX;
use judge::table::{Group, Quantity, Reading, Row, Tables, named, read};
use judge::verdict::{Decision, Prediction, Variable, Verdict};
use report::{AnnotationPlace, write_junit};
use run::sweep::Provenance;
use scene::{Data, Scene};
use serde_json::{Value, json};

/// `sweep fit`.
#[derive(Args)]
#[command(
    after_help = "The table may be copied from a program's output or from a paper, with prose, log lines and other tables around it. Columns may be separated by \
comma, semicolon, tab, blanks or |; LaTeX, lines of `name = value`, lists and transposed tables are read too. The last line says what was read \
and what was left out. Sizes: h, dx or hmax; k, dt or tau; n or N and steps, which are 1/h and 1/k (11, 21, 41 are points: 1/10, 1/20, 1/40); cells or dofs with --dimension; level, \
where h = 2^-level; none with --ratio. Errors: error, norms side by side (L2, H1, Linf, energy, error_u, ...), and every column that \
--p or --q name, each of them judged. Results without an exact value, such as a largest displacement or a force, \
go into a column named `value`. The \
extrapolated value, its order and the grid convergence index are then printed. Optional: \
floor, sigma (standard deviation of the error), norm, scene, status. Rates and counters are left out. Rows with the same scene and norm are \
one table, and so are those with one value of a column of words, or of one that tells levels apart which come again (degree, scheme); its name is then \
COLUMN=VALUE, as in --p degree=1=2,degree=2=3. `cases.csv` of a sweep is such a file.\n\n\
Examples:\n  \
sweep fit errors.csv --p 2                              is it second order?\n  \
program | sweep fit - --dimension 2 --p L2=2,H1=1       a printed table, h from its cells\n  \
sweep fit errors.csv --p 1 --window 0.01,0.1            of some meshes alone\n  \
sweep fit errors.csv --latex --svg errors.svg           the table and the picture for a paper\n\n\
Keys of --json: docs/JSON.md.\n\nExit codes: 0 without --p and --q, or if all verdicts pass; 1 if one fails or is unresolved; 2 if the table \
cannot be read."
)]
pub(crate) struct Fit {
    /// Table of errors or values, - for standard input
    file: PathBuf,
    /// Predicted order in h: a number for all norms, or NORM=P,...; NORM>=P is a lower bound, NORM==P exact, P:D has the tolerance D
    #[arg(long, allow_hyphen_values = true)]
    p: Option<Claims>,
    /// Predicted order in k: a number for all norms, or NORM=Q,..., as --p
    #[arg(long, allow_hyphen_values = true)]
    q: Option<Claims>,
    /// Treat the orders as lower bounds
    #[arg(long)]
    at_least: bool,
    /// Fail an order that is too high as well
    #[arg(long, conflicts_with = "at_least")]
    exact: bool,
    /// How far an order may lie from the prediction
    #[arg(long, value_name = "D", default_value_t = TOLERANCE, allow_hyphen_values = true)]
    tolerance: f64,
    /// Use only steps from A to B, in h, or in k if the table has no h
    #[arg(long, value_name = "A,B")]
    window: Option<Window>,
    /// Allow a factor |log h|^M in the error, or |log k|^M if the table has no h
    #[arg(long, value_name = "M", default_value_t = 0.0, allow_hyphen_values = true)]
    log: f64,
    /// What the relative standard deviation of the errors is at most, such as 0.01 for 1 %
    #[arg(long, value_name = "S", allow_hyphen_values = true)]
    noise: Option<f64>,
    /// The errors are measured against a run of step H in place of an exact solution; 0 says that the solution is exact. In k
    /// where the table has no h
    #[arg(long, value_name = "H", allow_hyphen_values = true)]
    reference: Option<f64>,
    /// Part of the errors that is not from discretisation: rounding, tolerance of the solver. Errors below 20 F are left out
    #[arg(long, value_name = "F", allow_hyphen_values = true)]
    floor: Option<f64>,
    /// Dimension of the mesh, where its size is a number of cells or unknowns: h = cells^(-1/D)
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=3))]
    dimension: Option<u32>,
    /// Refinement factor between rows if the table has no sizes, or between levels if it has levels
    #[arg(long, value_name = "R")]
    ratio: Option<f64>,
    /// Make a separate table for each value of this column; may be given several times
    #[arg(long, value_name = "COLUMN")]
    by: Vec<String>,
    /// Treat rows of one level as repeated runs: average their logarithms, and use the scatter as the noise
    #[arg(long, conflicts_with = "by")]
    runs: bool,
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
    /// Write the verdicts as JUnit XML
    #[arg(long, value_name = "FILE")]
    junit: Option<PathBuf>,
    /// Print annotations for GitHub Actions, and append the verdicts to the file that GITHUB_STEP_SUMMARY names; set by
    /// GITHUB_ACTIONS=true as well, unless JSON, Markdown or LaTeX is printed
    #[arg(long)]
    github: bool,
}

impl Fit {
    pub(super) fn execute(&self) -> Result<u8, CliError> {
        for (option, path) in [("--svg", &self.svg), ("--junit", &self.junit)] {
            let same = |path: &&PathBuf| same_file(path, &self.file);
            if let Some(path) = path.as_ref().filter(same) {
                let why = "this is the table itself, which would be overwritten: name another file";
                return Err(CliError::about(format!("{option} {}", path.display()), why));
            }
        }
        let mut tables = self.tables()?;
        let mut claims = [self.p.clone(), self.q.clone()];
        for claims in claims.iter_mut().flatten() {
            claims.resolve(&tables.groups).map_err(|why| CliError::about(self.name(), why))?;
        }
        self.one_direction(&tables)?;
        self.of_errors_alone(&tables)?;
        if let Some(Err(error)) = self.noise.map(deviation) {
            return Err(CliError::about("--noise", error));
        }
        self.state_floor(&mut tables)?;
        self.check_reference(&tables)?;
        let Self { at_least, exact, tolerance, log, .. } = *self;
        let claim = Claim { order: 1.0, at_least, exact, tolerance, log }.checked()?;
        let left_out = self.window.map(|window| window.narrow(&mut tables)).unwrap_or_default();
        let [p, q] = &claims;
        let exact = self.exact_scenes(&tables);
        for claims in claims.iter().flatten() {
            let mut all = tables.groups.iter().filter_map(|group| claims.of(group, claim));
            all.try_for_each(|claim| claim.checked().map(drop))?;
        }
        let asked = |group: &Group| {
            let of = |claims: &Option<Claims>| claims.as_ref().and_then(|c| c.of(group, claim));
            let (p, q) = (of(p), of(q));
            Asked {
                p: p.map(|claim| claim.order),
                q: q.map(|claim| claim.order),
                claim: p.unwrap_or(claim),
                in_time: q.unwrap_or(claim),
                noise: self.noise,
                reference: self.reference.or_else(|| {
                    let is_exact = |group: &Group| group.norm.as_deref() == Some(V_TIME_MAX);
                    let scene = group.scene.as_ref().filter(|scene| exact.contains_key(*scene))?;
                    (exact[scene] || is_exact(group)).then_some(0.0)
                }),
            }
        };
        let found = judged(&self.name(), &tables, asked, &left_out)?;
        if let Some(file) = &self.svg {
            let order = |group: &Group, direction| asked(group).order(direction);
            let drawn = eoc::svg(&tables.groups, order)?;
            write_named(file, drawn.as_bytes())?;
        }
        let texts = match (self.markdown, self.latex) {
            (true, _) => eoc::tables(&tables.groups, Style::Markdown),
            (_, true) => {
                let order = |group: &Group, direction| order_in(&found.objects, group, direction);
                eoc::tables(&tables.groups, Style::Latex(&order))
            }
            _ => found.texts,
        };
        match self.json {
            true => print_json(&found.objects)?,
            false => texts.iter().for_each(|text| print_text(text)),
        }
        if let Some(path) = &self.junit {
            let version = json!({ "version": env!("CARGO_PKG_VERSION") });
            write_junit(path, &found.verdicts, &version, None)?;
        }
        let printed = self.json || self.markdown || self.latex;
        if !found.verdicts.is_empty() && (self.github || on_github(false) && !printed) {
            announce(&[], &found.verdicts, |_, of| self.place(&tables, of?))?;
        }
        if self.markdown || self.latex {
            tables.said.iter().for_each(|line| print_error(line));
        }
        let all_pass = found.verdicts.iter().all(|verdict| verdict.decision == Decision::Pass);
        Ok(u8::from(!all_pass))
    }

    /// The first line of the table of a verdict.
    fn place(&self, tables: &Tables, verdict: &Verdict) -> Option<AnnotationPlace> {
        let wanted = (verdict.scene.as_str(), verdict.norm.as_str());
        let mut groups = tables.groups.iter().filter(|_| !self.is_piped());
        let group = groups.find(|group| of_group(&self.name(), group) == wanted)?;
        Some(in_file(&self.file, usize::try_from(group.rows.first()?.line).ok()?))
    }

    fn name(&self) -> String {
        if self.is_piped() { "standard input".into() } else { self.file.display().to_string() }
    }

    fn is_piped(&self) -> bool {
        self.file.as_os_str() == "-"
    }

    fn tables(&self) -> Result<Tables, CliError> {
        let bytes = match self.is_piped() {
            true => up_to(std::io::stdin(), LARGEST).map_err(FileError::at(self.name().as_ref())),
            false => read_at_most(&self.file, LARGEST),
        };
        let names = [&self.p, &self.q].into_iter().flatten().flat_map(Claims::names);
        let reading = Reading {
            dimension: self.dimension,
            ratio: self.ratio,
            in_time: self.p.is_none() && self.q.is_some(),
            by: self.by.clone(),
            runs: self.runs,
            errors: names.map(str::to_owned).collect(),
        };
        tables(&self.name(), &bytes?, &reading)
    }

    /// Whether the solution is known, of the scenes whose records these are: of a table of cases beside the texts of its
    /// scenes, which its errors were judged by as well.
    fn exact_scenes(&self, tables: &Tables) -> BTreeMap<String, bool> {
        let dir = self.file.parent().filter(|_| self.file.ends_with("cases.csv"));
        let known = dir.and_then(|dir| Some((dir, Provenance::read(dir).ok()??)));
        let Some((dir, known)) = known else { return BTreeMap::new() };
        let names = tables.groups.iter().filter_map(|group| group.scene.as_deref());
        let scene = |name: &str| known.scene(dir, name).ok().flatten();
        let is_exact = |scene: &Scene| {
            let data = scene.as_contact().map(|body| &body.data);
            !matches!(data, Some(Data::Loads { .. }))
        };
        let known = |name: &str| Some((name.to_owned(), is_exact(&scene(name)?)));
        names.filter_map(known).collect()
    }

    /// What is said of errors is no word about values.
    fn of_errors_alone(&self, tables: &Tables) -> Result<(), CliError> {
        let values = tables.groups.iter().find(|group| group.quantity == Quantity::Value);
        let options = [
            ("--floor", self.floor.is_some()),
            ("--reference", self.reference.is_some()),
            ("--log", self.log != 0.0),
        ];
        let given = options.iter().find(|(_, given)| *given);
        let Some((group, (option, _))) = values.zip(given) else { return Ok(()) };
        let table = group.heading().map_or(String::new(), |heading| format!(" `{heading}`"));
        let what = format!(
            "the table{table} has values, of which no error is known: leave it out, or write the errors as `error`"
        );
        Err(CliError::about(option, what))
    }

    /// A floor for the errors that have none of their own.
    fn state_floor(&self, tables: &mut Tables) -> Result<(), CliError> {
        let Some(floor) = self.floor else { return Ok(()) };
        if !(floor.is_finite() && floor > 0.0) {
            let what = format!("{floor} is no floor of errors; 1e-12 is");
            return Err(CliError::about("--floor", what));
        }
        for row in tables.groups.iter_mut().flat_map(|group| &mut group.rows) {
            if row.point.floor == 0.0 {
                row.point.floor = floor;
            }
        }
        Ok(())
    }

    /// A reference is one run, finer than the levels of one direction.
    fn check_reference(&self, tables: &Tables) -> Result<(), CliError> {
        let known = Known { reference: self.reference, ..Known::default() };
        if matches!(self.reference, None | Some(0.0)) {
            return Ok(());
        }
        let refused = |what: String| CliError::about("--reference", what);
        for group in &tables.groups {
            let along_path = path(&group.points()).is_some();
            if Direction::BOTH.iter().all(|along| group.refined(*along)) && !along_path {
                let what = "h and k are both refined: the step of the reference in one of them does not tell its error";
                return Err(refused(what.into()));
            }
            let finest = |direction: Direction| {
                let steps = group.rows.iter().map(|row| direction.step(&row.point));
                steps.fold(f64::NAN, f64::min)
            };
            let [space, time] = Direction::BOTH.map(finest);
            let finest = if space.is_nan() { time } else { space };
            known.check_reference(finest).map_err(|error| refused(error.to_string()))?;
        }
        Ok(())
    }

    /// An order in h alone is no claim on a table of time steps, nor the reverse.
    fn one_direction(&self, tables: &Tables) -> Result<(), CliError> {
        let there = |direction: Direction| {
            let rows = tables.groups.iter().flat_map(|group| &group.rows);
            rows.into_iter().any(|row| !direction.step(&row.point).is_nan())
        };
        let (wrong, right) = match (&self.p, &self.q) {
            (Some(_), None) if !there(Direction::Space) => ("--p", "--q"),
            (None, Some(_)) if !there(Direction::Time) => ("--q", "--p"),
            _ => return Ok(()),
        };
        let (has, lacks) = if wrong == "--p" { ("k", "h") } else { ("h", "k") };
        let what = format!(
            "the table has {has} alone and no {lacks}, whose order {wrong} is: write {right} ({})",
            tables.said.join("; ")
        );
        Err(CliError::about(self.name(), what))
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
    /// One for each predicted order.
    pub verdicts: Vec<Verdict>,
}

/// Reads and fits the tables of a file, against predicted orders in h and k if given.
///
/// # Errors
/// A file that is not a table, or has nothing to fit.
pub fn fitted(file: &Path, [p, q]: [Option<f64>; 2]) -> Result<Fitted, CliError> {
    let name = file.display().to_string();
    let tables = tables(&name, &read_at_most(file, LARGEST)?, &Reading::default())?;
    let claim = Claim::new(1.0)?;
    let asked = Asked { p, q, claim, in_time: claim, noise: None, reference: None };
    judged(&name, &tables, |_| asked, &[])
}

/// The order of a group in a direction and its interval, from what is printed as JSON.
fn order_in(objects: &[Value], group: &Group, direction: Direction) -> Option<[f64; 3]> {
    let of_group = |object: &&Value| {
        object["scene"] == json!(group.scene) && object["norm"] == json!(group.norm)
    };
    let ours = objects.iter().filter(of_group).find_map(|object| {
        match (object["variable"].as_str()?, direction) {
            ("joint", Direction::Time) => Some((&object["observed_k"], &object["interval_k"])),
            ("joint" | "path" | "h", Direction::Space) | ("k", Direction::Time) => {
                Some((&object["observed"], &object["interval"]))
            }
            _ => None,
        }
    })?;
    Some([ours.0.as_f64()?, ours.1[0].as_f64()?, ours.1[1].as_f64()?])
}

fn judged(
    name: &str,
    tables: &Tables,
    asked: impl Fn(&Group) -> Asked,
    left_out: &[Vec<Point>],
) -> Result<Fitted, CliError> {
    let texts = eoc::tables(&tables.groups, Style::Text);
    let mut found = Fitted { texts, objects: Vec::new(), verdicts: Vec::new() };
    for (at, group) in tables.groups.iter().enumerate() {
        let asked = asked(group);
        let outside = left_out.get(at).map_or(&[][..], Vec::as_slice);
        for mut part in parts(group, asked, outside).map_err(|why| CliError::about(name, why))? {
            found.verdicts.extend(verdict(of_group(name, group), &part));
            part.json["read"] = tables.said.join("\n").into();
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
    found.texts.extend(tables.said.iter().cloned());
    Ok(found)
}

/// What a suite and a test of JUnit are called: the file or the scene in it, and the norm.
fn of_group<'a>(file: &'a str, group: &'a Group) -> (&'a str, &'a str) {
    (group.scene.as_deref().unwrap_or(file), group.norm.as_deref().unwrap_or("error"))
}

/// A result as a verdict; none if no order is predicted.
fn verdict((scene, norm): (&str, &str), part: &Part) -> Option<Verdict> {
    let (decision, json) = (part.decision?, &part.json);
    let number = |key: &str| json[key].as_f64();
    let interval = |key: &str| Some([json[key][0].as_f64()?, json[key][1].as_f64()?]);
    let variable = [Variable::H, Variable::K, Variable::Joint, Variable::Path];
    let variable = variable.into_iter().find(|variable| json["variable"] == variable.name())?;
    // Along a path h and k are refined together: an order in k alone is that of the path.
    let order = number("predicted").or(number("predicted_k"))?;
    let prediction = Prediction {
        order_k: number("predicted_k"),
        at_least: json["at_least"] == true,
        why: "the caller".into(),
        ..Prediction::new(norm, variable, order)
    };
    Some(Verdict {
        observed: number("observed"),
        interval: interval("interval"),
        observed_k: number("observed_k"),
        interval_k: interval("interval_k"),
        order: decision,
        decision,
        reason: json["reason"].as_str().unwrap_or_default().to_owned(),
        ..Verdict::open(scene, &prediction, Decision::Pass)
    })
}

/// All results for one table.
fn parts(group: &Group, asked: Asked, outside: &[Point]) -> Result<Vec<Part>, &'static str> {
    let directions = Direction::BOTH.into_iter();
    if group.quantity == Quantity::Value {
        let part = |direction| parts::values_part(group, direction, asked.along(direction));
        return Ok(directions.filter_map(part).collect());
    }
    let both = directions.clone().all(|direction| group.refined(direction));
    if both && asked.claim.log != 0.0 {
        return Err("--log needs a table in which one step is refined: h and k both are");
    }
    if let Some(found) = path(&group.points()) {
        return Ok(vec![parts::path_part(group, found, asked)]);
    }
    let joint = both.then(|| parts::Joint::of(group, asked));
    let line = |direction: Direction| {
        parts::line_part(group, direction, asked.along(direction), joint.as_ref(), outside)
    };
    let grid = joint.as_ref().map(|joint| parts::grid_part(group, joint, asked));
    Ok(directions.filter_map(line).chain(grid).collect())
}

// Claimed orders of the command line: one for all norms, or one for each, with its bound and its tolerance.

/// `2`, or `L2=2,H1>=1,energy==1.5:0.3`: the order of every norm, or those of named ones, beside which none is judged.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Claims(Vec<Claimed>);

#[derive(Debug, Clone, PartialEq)]
struct Claimed {
    name: Option<String>,
    order: f64,
    at_least: bool,
    exact: bool,
    tolerance: Option<f64>,
}

impl Claims {
    /// The claim on a table, what it does not say taken from `common`.
    pub(super) fn of(&self, group: &Group, common: Claim) -> Option<Claim> {
        let heading = group.heading();
        let means = |claimed: &&Claimed| match claimed.name.as_deref() {
            None => true,
            name => {
                [&heading, &group.norm, &group.scene].iter().any(|known| known.as_deref() == name)
            }
        };
        let claimed = self.0.iter().find(means)?;
        let own = claimed.at_least || claimed.exact;
        let at_least = if own { claimed.at_least } else { common.at_least };
        let exact = if own { claimed.exact } else { common.exact };
        let tolerance = claimed.tolerance.unwrap_or(common.tolerance);
        Some(Claim { order: claimed.order, at_least, exact, tolerance, ..common })
    }

    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        self.0.iter().filter_map(|claimed| claimed.name.as_deref())
    }

    /// Each name as the table writes it: `L2` may be `error_L2`.
    pub(super) fn resolve(&mut self, groups: &[Group]) -> Result<(), String> {
        let distinct = |name: &dyn Fn(&Group) -> Option<String>| {
            let mut found: Vec<String> = groups.iter().filter_map(name).collect();
            let mut seen = BTreeSet::new();
            found.retain(|name| seen.insert(name.clone()));
            found
        };
        let norms = distinct(&|group| group.norm.clone());
        let others = [distinct(&|group| group.scene.clone()), distinct(&Group::heading)].concat();
        for name in self.0.iter_mut().filter_map(|claimed| claimed.name.as_mut()) {
            if others.contains(name) {
                continue;
            }
            if norms.is_empty() {
                return Err(format!(
                    "there is no norm `{name}` to judge, because the errors of the table have no name: give the order without a name, as in --p 2"
                ));
            }
            let known: Vec<&str> = norms.iter().map(String::as_str).collect();
            let at = named(name, &known).map_err(|what| format!("nothing to judge: {what}"))?;
            norms[at].clone_into(name);
        }
        Ok(())
    }
}

impl FromStr for Claims {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let one = |part: &str| {
            let (name, value) = part.rsplit_once('=').unwrap_or(("", part));
            let (at_least, exact) = (name.ends_with('>'), name.ends_with('='));
            let name = name.trim_end_matches(['>', '=']).trim();
            if name.is_empty() && text.contains(',') {
                return Err(format!(
                    "`{part}` names no norm: L2=2,H1=1 is an order for each of two"
                ));
            }
            let (value, tolerance) = match value.split_once(':') {
                Some((value, tolerance)) => (value, Some(number(tolerance, "tolerance")?)),
                None => (value, None),
            };
            let name = (!name.is_empty()).then(|| name.to_owned());
            Ok(Claimed { name, order: number(value, "order")?, at_least, exact, tolerance })
        };
        text.split(',').map(one).collect::<Result<_, String>>().map(Self)
    }
}

/// Refuses what is not finite.
fn number(text: &str, what: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        _ => Err(format!("`{text}` is no finite {what}; 1, 1.5 and 2 are")),
    }
}

// Restricts a table to a window of steps.

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Window([f64; 2]);

/// Relative tolerance at the ends.
const ROUNDING: f64 = 1e-6;

impl Window {
    /// Removes the rows outside from all tables and returns their points, a list per table. The window is in h, or in k
    /// for a table without h.
    pub(super) fn narrow(self, tables: &mut Tables) -> Vec<Vec<Point>> {
        let Self([lo, hi]) = self;
        let narrowed = tables.groups.iter_mut().map(|group| {
            let space = group.rows.iter().any(|row| !row.point.h.is_nan());
            let step = |row: &Row| if space { row.point.h } else { row.point.k };
            // A row without a step stays, as a gap.
            let is_outside = |row: &mut Row| {
                !step(row).is_nan()
                    && !(lo * (1.0 - ROUNDING)..=hi * (1.0 + ROUNDING)).contains(&step(row))
            };
            let outside = group.rows.extract_if(.., is_outside);
            outside.map(|row| row.point).collect()
        });
        narrowed.collect()
    }
}

impl FromStr for Window {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("`{text}` is no window: 0.01,0.1 takes the steps from 0.01 to 0.1");
        let (a, b) = text.split_once([',', ':']).ok_or_else(wrong)?;
        let end = |text: &str| text.trim().parse::<f64>().ok().filter(|step| *step > 0.0);
        let (a, b) = end(a).zip(end(b)).ok_or_else(wrong)?;
        Ok(Self([a.min(b), a.max(b)]))
    }
}

#[cfg(test)]
mod tests {
    mod claims {
        use super::super::*;
        use judge::table::{Reading, read};

        #[test]
        fn orders_are_claimed_of_all_norms_or_of_each() {
            let text = b"h,error_L2,H1\n0.5,1,1\n0.25,1,1\n";
            let groups = read(text, &Reading::default()).unwrap().groups;
            let common = Claim::new(1.0).unwrap();
            let of = |text: &str| {
                let mut claims: Claims = text.parse().unwrap();
                claims.resolve(&groups)?;
                Ok::<_, String>(
                    groups.iter().map(|group| claims.of(group, common)).collect::<Vec<_>>(),
                )
            };
            let orders = |text: &str| -> Vec<Option<f64>> {
                of(text).unwrap().iter().map(|claim| claim.map(|claim| claim.order)).collect()
            };
            assert_eq!(orders("1.5"), [Some(1.5); 2]);
            assert_eq!(orders("L2=2, H1=1"), [Some(2.0), Some(1.0)]);
            assert_eq!(orders("H1=1"), [None, Some(1.0)]);
            let each = of("L2>=2:0.3,H1==1").unwrap();
            assert_eq!(
                each[0],
                Some(Claim { order: 2.0, at_least: true, tolerance: 0.3, ..common })
            );
            assert_eq!(each[1], Some(Claim { order: 1.0, exact: true, ..common }));
            assert!(of("L4=1").is_err());
            for wrong in ["nan", "inf", "-inf", "two", "", "L2=nan", "L2=2,1", "L2=", "2:x"] {
                assert!(wrong.parse::<Claims>().is_err(), "{wrong}");
            }
        }
    }

    mod window {
        use super::super::*;
        use judge::table::{Reading, read};

        #[test]
        fn a_window_takes_rows_out_of_every_table() {
            let window: Window = "0.3,0.1".parse().unwrap();
            assert_eq!(Ok(window), "0.1:0.3".parse());
            let text = "h,L2,H1\n0.5,1,1\n0.3,0.5,-\n0.2,0.3,0.5\n0.1,0.1,0.3\n0.05,0.1,0.2\n";
            let mut tables = read(text.as_bytes(), &Reading::default()).unwrap();
            let left_out = window.narrow(&mut tables);
            assert_eq!(left_out.iter().map(Vec::len).collect::<Vec<_>>(), [2, 2]);
            let steps =
                |at: usize| tables.groups[at].points().iter().map(|p| p.h).collect::<Vec<_>>();
            assert_eq!((steps(0), steps(1)), (vec![0.3, 0.2, 0.1], vec![0.2, 0.1]));
            assert!(tables.groups[1].gaps_in_words().is_some(), "a gap inside stays one");
            // Without h the window is in k.
            let mut tables = read(b"k,error\n0.5,1\n0.2,1\n", &Reading::default()).unwrap();
            assert_eq!(window.narrow(&mut tables)[0].len(), 1);
            for wrong in ["", "1", "0,1", "-1,1", "nan,1", "a,b"] {
                assert!(wrong.parse::<Window>().is_err(), "{wrong}");
            }
        }
    }
}
