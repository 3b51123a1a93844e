//! Columns by their names.

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Measure {
    Length,
    /// Cells or steps along one side: size 1/n.
    Number,
    /// Cells or unknowns of the mesh: size n^{-1/D}.
    Count,
    /// Halvings of the mesh: size 2^{-n}.
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
    Ignored,
    Unknown,
}

// Names of columns in normal form, as `normal` gives it.
const LENGTHS: &str = "h hmax dx deltax meshsize maxh hx cellsize gridspacing 1n";
const TIMES: &str = "k dt deltat tau timestep timestepsize stepsize htime";
const SIDES: &str = "n nx cellsperside elementsperside resolution grid";
const STEPS: &str = "steps nsteps nt timesteps numberofsteps";
const CELLS: &str = "cells ncells numcells numberofcells activecells nactivecells elements nelements numelements \
    numberofelements nel nelem triangles elems";
const DOFS: &str =
    "dofs dof ndof ndofs numdofs numberofdofs degreesoffreedom unknowns nodes vertices points";
const RATES: &str = "rate eoc order reduction slope roc ratio convergence";
const LEVELS: &str =
    "level levels lvl refinement refinements refinementlevel numberofrefinements nref";
const COUNTERS: &str = "cycle cycles ref iter iters iterations its it time times cpu seconds walltime cost newton cg \
    gmres nnz degree seed run conv red red2";
const NORM_PARTS: &str =
    "error err norm energy semi hdiv hcurl rms inf max l1 l2 l4 l8 h0 h1 h2 w1 sup";
const NORM_NAMES: &str = "e eu ep eh u v uh velocity pressure displacement stress gradient grad flux dg temperature \
    div curl";

/// Accepted column names, for messages.
pub fn understood() -> &'static str {
    "h, dx or hmax, k, dt or tau, n or N, steps; cells or dofs with --dimension; level (h = 2^-level); error, value, or norms side by side \
     (L2, H1, Linf, energy, u, ...); floor, sigma, scene, norm, status; rate, eoc, order, reduction and counters are skipped"
}

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
    let normalised = normal(name);
    let is = |names: &str| names.split(' ').any(|name| name == normalised);
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
        _ if is(CELLS) || is(DOFS) => Role::Space(Measure::Count),
        _ if is(LEVELS) => Role::Space(Measure::Level),
        _ if has(RATES) || is(COUNTERS) || normalised.is_empty() => Role::Ignored,
        _ if has(NORM_PARTS) || is(NORM_NAMES) => Role::Wide,
        _ => Role::Unknown,
    }
}

pub(super) fn is_norm(name: &str) -> bool {
    matches!(role(name), Role::Wide | Role::Error | Role::Value)
}

/// Prefer cells among counts: they follow the mesh size exactly, unknowns only in the limit.
pub(super) fn is_cells(name: &str) -> bool {
    CELLS.split(' ').any(|cells| cells == normal(name))
}

pub(super) fn is_size_or_counter(name: &str) -> bool {
    matches!(role(name), Role::Space(_) | Role::Time(_) | Role::Ignored)
}

pub(super) fn is_unknown(name: &str) -> bool {
    role(name) == Role::Unknown
}
