//! Columns by their names.

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Measure {
    Length,
    /// Cells or steps along one side: size 1/n.
    Number,
    /// Cells of the mesh: size n^{-1/D}.
    Cells,
    /// Unknowns of the mesh: size n^{-1/D} in the limit.
    Unknowns,
    /// Refinements of the mesh: size R^{-n}.
    Level,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    Space(Measure),
    Time(Measure),
    Error,
    Value,
    Floor,
    Sigma,
    Scene,
    Norm,
    Status,
    Wide,
    /// A rate, or a count of no interest.
    Ignored,
    /// Tells runs of one level apart.
    Run,
    /// Tells tables apart: a degree, a scheme.
    Parameter,
    Unknown,
}

// Names of columns in normal form, as `normal` gives it.
const LENGTHS: &str = "h hmax dx deltax meshsize maxh hx cellsize gridspacing spacing meshwidth";
const TIMES: &str = "k dt deltat tau timestep timestepsize stepsize htime";
const SIDES: &str = "n nx cellsperside elementsperside resolution grid mesh numpts npts ngridpoints gridpoints 1h oneoverh 1dx hinv";
const STEPS: &str = "steps nsteps nt timesteps numberofsteps 1dt 1k";
const CELLS: &str = "cells ncells numcells numberofcells activecells nactivecells numberofactivecells \
    elements nelements numelements numberofelements nel ne nelem triangles elems";
const DOFS: &str = "dofs dof ndof ndofs numdofs numberofdofs degreesoffreedom numberofdegreesoffreedom \
    unknowns nodes vertices points";
const RATES: &str = "rate eoc ooc order reduction slope roc ratio convergence";
const LEVELS: &str =
    "level levels lvl refinement refinements refinementlevel numberofrefinements nref";
const COUNTERS: &str = "cycle cycles ref iter iters iterations its it time times cpu seconds walltime cost newton cg \
    gmres nnz conv red red2 row index unnamed0";
const RUNS: &str = "seed run runs trial sample repetition rep";
const PARAMETERS: &str = "degree deg p polynomialdegree polydeg scheme method element fe cfl solver case problem test type integrator";
const NORM_NAMES: &str = "e eu ep eh u v uh velocity pressure displacement stress gradient grad flux dg temperature \
    div curl semi rms inf max sup maximum";
const SPACES: &str = "l1 l2 l4 l8 linf h0 h1 h2 w1";

/// A name in lower case without signs and LaTeX commands.
pub(super) fn normal(name: &str) -> String {
    let mut text =
        name.to_lowercase().replace('δ', "delta").replace('τ', "tau").replace('∞', "inf");
    for command in ["\\textrm", "\\mathrm", "\\mathbf", "\\textbf", "\\text", "\\mbox", "\\bm"] {
        text = text.replace(command, "");
    }
    text.retain(|c| c.is_ascii_alphanumeric());
    text
}

pub(super) fn role(name: &str) -> Role {
    // A unit in brackets is no part of the name.
    let bare = name.split_once(['[', '(']).map_or(name, |(bare, _)| bare);
    let normalised = if normal(bare).is_empty() { normal(name) } else { normal(bare) };
    let is = |names: &str| names.split_whitespace().any(|name| name == normalised);
    let has = |parts: &str| parts.split(' ').any(|part| normalised.contains(part));
    match normalised.as_str() {
        "error" | "err" => Role::Error,
        "value" => Role::Value,
        "floor" => Role::Floor,
        "sigma" => Role::Sigma,
        "scene" => Role::Scene,
        "norm" => Role::Norm,
        "status" => Role::Status,
        _ if is(LENGTHS) => Role::Space(Measure::Length),
        _ if is(TIMES) => Role::Time(Measure::Length),
        _ if is(SIDES) => Role::Space(Measure::Number),
        _ if is(STEPS) => Role::Time(Measure::Number),
        _ if is(CELLS) => Role::Space(Measure::Cells),
        _ if is(DOFS) => Role::Space(Measure::Unknowns),
        _ if is(LEVELS) => Role::Space(Measure::Level),
        _ if is(RUNS) => Role::Run,
        _ if is(PARAMETERS) => Role::Parameter,
        _ if has(RATES) || is(COUNTERS) => Role::Ignored,
        "" if name.contains(['‖', '|']) => Role::Wide,
        "" => Role::Ignored,
        // A logarithm of an error is none.
        _ if normalised.starts_with("log") || has("iter residual") => Role::Unknown,
        _ if has("err norm energy hdiv hcurl") || is(NORM_NAMES) => Role::Wide,
        _ if name.contains('‖') || name.contains("||") => Role::Wide,
        _ => {
            let lower = name.to_lowercase().replace('∞', "inf");
            let known = |word: &str| {
                SPACES.split(' ').any(|space| word.contains(space))
                    || NORM_NAMES.split_whitespace().any(|norm| norm == word && norm.len() > 2)
            };
            let words = |text: &str| text.split(|c: char| !c.is_alphanumeric()).any(known);
            match words(&lower) || known(&normalised) {
                true => Role::Wide,
                false => Role::Unknown,
            }
        }
    }
}

pub(super) fn is_size(name: &str) -> bool {
    matches!(role(name), Role::Space(_) | Role::Time(_))
}

pub(super) fn is_norm(name: &str) -> bool {
    matches!(role(name), Role::Wide | Role::Error | Role::Value)
}

pub(super) fn is_rate(name: &str) -> bool {
    let normalised = normal(name);
    RATES.split(' ').any(|rate| normalised.contains(rate))
}

/// How well a column answers to a name that a caller gives: 3 for the name itself, 2 but for case and signs, 1 if `L2`
/// is asked and it is `error_L2` or `L2 norm`.
pub(super) fn likeness(asked: &str, column: &str) -> u8 {
    let core = |name: &str| {
        let mut text = normal(name);
        for part in ["errors", "error", "err", "norm"] {
            let without = text.replacen(part, "", 1);
            text = if without.is_empty() { text } else { without };
        }
        text
    };
    let same = [asked == column, normal(asked) == normal(column), core(asked) == core(column)];
    same.iter().position(|same| *same).map_or(0, |at| 3 - at as u8)
}

/// Which of several names is asked for: the one that is most alike.
///
/// # Errors
/// What is wrong, and which names there are.
pub fn named(asked: &str, names: &[&str]) -> Result<usize, String> {
    let most = names.iter().map(|name| likeness(asked, name)).max().unwrap_or(0);
    let mut alike = (0..names.len()).filter(|&at| most > 0 && likeness(asked, names[at]) == most);
    match (alike.next(), alike.next()) {
        (Some(at), None) => Ok(at),
        (Some(a), Some(b)) => {
            Err(format!("`{asked}` may be `{}` or `{}`: write one of them", names[a], names[b]))
        }
        _ => {
            let first: Vec<String> = names.iter().take(6).map(|name| format!("`{name}`")).collect();
            let dots = if names.len() > first.len() { ", ..." } else { "" };
            Err(format!("no `{asked}`; there is {}{dots}", first.join(", ")))
        }
    }
}
