//! Columns by their names.

/// What a size counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Measure {
    /// A length or a time.
    Length,
    /// Cells or steps along one side: the size is 1 over it.
    Number,
    /// Cells or unknowns of the mesh: the size is it to the power -1/D.
    Count,
    /// Halvings of the mesh: the size is 2 to the power of minus it.
    Level,
}

/// What a column holds.
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
    /// The error in one norm, of several side by side.
    Wide,
    /// Rates that somebody else has computed, counters and costs.
    Ignored,
    Unknown,
}

const LENGTHS: &[&str] =
    &["h", "hmax", "dx", "deltax", "meshsize", "maxh", "hx", "cellsize", "gridspacing"];
const TIMES: &[&str] =
    &["k", "dt", "deltat", "tau", "timestep", "timestepsize", "stepsize", "htime"];
const SIDES: &[&str] = &["n", "nx", "cellsperside", "elementsperside", "resolution", "grid"];
const STEPS: &[&str] = &["steps", "nsteps", "nt", "timesteps", "numberofsteps"];
const CELLS: &[&str] = &[
    "cells",
    "ncells",
    "numcells",
    "numberofcells",
    "activecells",
    "nactivecells",
    "elements",
    "nelements",
    "numelements",
    "numberofelements",
    "nel",
    "nelem",
    "triangles",
    "elems",
];
const DOFS: &[&str] = &[
    "dofs",
    "dof",
    "ndof",
    "ndofs",
    "numdofs",
    "numberofdofs",
    "degreesoffreedom",
    "unknowns",
    "nodes",
    "vertices",
    "points",
];
const RATES: &[&str] =
    &["rate", "eoc", "order", "reduction", "slope", "roc", "ratio", "convergence"];
const LEVELS: &[&str] = &[
    "level",
    "levels",
    "lvl",
    "refinement",
    "refinements",
    "refinementlevel",
    "numberofrefinements",
    "nref",
];
const COUNTERS: &[&str] = &[
    "cycle",
    "cycles",
    "ref",
    "iter",
    "iters",
    "iterations",
    "its",
    "it",
    "time",
    "times",
    "cpu",
    "seconds",
    "walltime",
    "cost",
    "newton",
    "cg",
    "gmres",
    "nnz",
    "degree",
    "seed",
    "run",
    "conv",
    "red",
    "red2",
];
const NORM_PARTS: &[&str] = &[
    "error", "err", "norm", "energy", "semi", "hdiv", "hcurl", "rms", "inf", "max", "l1", "l2",
    "l4", "l8", "h0", "h1", "h2", "w1", "sup",
];
const NORM_NAMES: &[&str] = &[
    "e",
    "eu",
    "ep",
    "eh",
    "u",
    "v",
    "uh",
    "velocity",
    "pressure",
    "displacement",
    "stress",
    "gradient",
    "grad",
    "flux",
    "dg",
    "temperature",
    "div",
    "curl",
];

/// The names that columns may have, for messages.
pub fn understood() -> &'static str {
    "h, dx or hmax, k, dt or tau, n or N, steps; cells or dofs with --dimension; level (h = 2^-level); error, value, or norms side by side \
     (L2, H1, Linf, energy, u, ...); floor, sigma, scene, norm, status; rate, eoc, order, reduction and counters are skipped"
}

/// A name without case, signs and the commands of LaTeX.
pub(super) fn normal(name: &str) -> String {
    let mut text =
        name.to_lowercase().replace('δ', "delta").replace('τ', "tau").replace('∞', "inf");
    for command in ["\\textrm", "\\mathrm", "\\mathbf", "\\textbf", "\\text", "\\mbox", "\\bm"] {
        text = text.replace(command, "");
    }
    text.retain(|c| c.is_ascii_alphanumeric());
    text
}

/// What a column of this name holds.
pub(super) fn role(name: &str) -> Role {
    let own = normal(name);
    let is = |list: &[&str]| list.contains(&own.as_str());
    let has = |list: &[&str]| list.iter().any(|part| own.contains(part));
    match own.as_str() {
        "error" | "err" => Role::Error,
        "value" => Role::Value,
        "floor" => Role::Floor,
        "sigma" => Role::Sigma,
        "scene" => Role::Scene,
        "norm" => Role::Norm,
        "status" => Role::Status,
        _ if is(LENGTHS) || is(&["1n"]) => Role::Space(Measure::Length),
        _ if is(TIMES) => Role::Time(Measure::Length),
        _ if is(SIDES) => Role::Space(Measure::Number),
        _ if is(STEPS) => Role::Time(Measure::Number),
        _ if is(CELLS) || is(DOFS) => Role::Space(Measure::Count),
        _ if is(LEVELS) => Role::Space(Measure::Level),
        _ if has(RATES) || is(COUNTERS) || own.is_empty() => Role::Ignored,
        _ if has(NORM_PARTS) || is(NORM_NAMES) => Role::Wide,
        _ => Role::Unknown,
    }
}

/// Whether a column of this name holds errors.
pub(super) fn is_norm(name: &str) -> bool {
    matches!(role(name), Role::Wide | Role::Error | Role::Value)
}

/// Among names of counts: cells follow the mesh size on uniform meshes, unknowns in the limit alone.
pub(super) fn is_cells(name: &str) -> bool {
    CELLS.contains(&normal(name).as_str())
}

/// Whether a name is a size or is skipped.
pub(super) fn is_size_or_counter(name: &str) -> bool {
    matches!(role(name), Role::Space(_) | Role::Time(_) | Role::Ignored)
}

/// Whether a name is none of those that are understood.
pub(super) fn is_unknown(name: &str) -> bool {
    role(name) == Role::Unknown
}
