//! What a cell says: a number as programs print it and papers set it, or the name of a column.

use std::collections::{HashMap, HashSet};
use std::sync::LazyLock;

/// What the commas of a number are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Comma {
    None,
    Decimal,
    Thousands,
    /// Three digits follow, as in `2,312`: the value is that of 2312.
    Either,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Number {
    pub(super) value: f64,
    pub(super) comma: Comma,
    /// `ms` of `0.5ms`, or nothing.
    pub(super) unit: String,
}

pub(super) fn is_missing(cell: &str) -> bool {
    const MISSING: &str = "- -- --- – — * n/a na <na> n.a. none null nothing missing ...";
    // `< 1e-12` is a bound and no error.
    let bound = cell.strip_prefix('<').is_some_and(|bound| number(bound.trim()).is_some());
    bound || cell.is_empty() || MISSING.split(' ').any(|word| cell.eq_ignore_ascii_case(word))
}

/// Whether a cell has no number but 0, as the first one of rates.
pub(super) fn is_missing_or_zero(cell: &str) -> bool {
    is_missing(cell) || number(cell).is_some_and(|number| number.value == 0.0)
}

pub(super) fn number(cell: &str) -> Option<Number> {
    let plain = |value, comma| Some(Number { value, comma, unit: String::new() });
    if let Ok(value) = cell.parse::<f64>() {
        return plain(value, Comma::None);
    }
    // Words are many: nothing but `nan` and `inf` begins with a letter.
    let first = cell.trim_start_matches([' ', '$', '`', '*', '{']).chars().next()?;
    if first.is_alphabetic() && !"nNiIπ".contains(first) {
        return None;
    }
    let mut text = cell.trim().trim_matches(['$', '`']).replace("\\%", "%");
    // A macro of a mantissa and an exponent, whatever its name.
    if text.starts_with('\\')
        && let Some((mantissa, exponent)) = text.split_once("}{")
        && let Some((command, mantissa)) = mantissa.split_once('{')
        && let Some(exponent) = exponent.strip_suffix('}')
        && command[1..].chars().all(char::is_alphabetic)
        && exponent.trim().parse::<i32>().is_ok()
    {
        let sign = if command.ends_with("frac") { '/' } else { 'e' };
        return number(&format!("{}{sign}{}", mantissa.trim(), exponent.trim()));
    }
    text = text
        .replace(['\u{2212}', '–'], "-")
        .replace("\\pi", "π")
        .replace("\\(", "")
        .replace("\\)", "");
    for command in ["\\num", "\\textbf", "\\mathbf", "\\text", "\\,", "~", "≈"] {
        text = text.replace(command, "");
    }
    text.retain(|c| !"{}$_'\u{2009}\u{202f}\u{a0}".contains(c));
    text = text.replace("**", "^");
    for times in ["×10^", "x10^", "*10^"] {
        text = text.replace(times, "e");
    }
    let text = text.trim();
    // `1.28e-2 (2.00)`: a rate stands behind, or a deviation.
    for behind in [" (", " [", "(-)", "±", "+/-"] {
        if let Some((value, _)) = text.split_once(behind).filter(|(v, _)| !v.trim().is_empty()) {
            return number(value);
        }
    }
    // So may a note, without numbers: `1.28e-2 ← floor`, `16 cells`.
    if let Some((value, note)) = text.split_once(' ')
        && let mut letters = note.chars().map(char::is_alphabetic)
        && (note.chars().count() > 3 && letters.all(|letter| letter)
            || !note.starts_with(|c: char| c.is_alphanumeric() || "%×*/^+-πe".contains(c)))
        && !note.contains(|c: char| c.is_ascii_digit())
    {
        return number(value);
    }
    if !text.starts_with(|c: char| c.is_ascii_digit() || "+-.π".contains(c)) {
        return text.parse().ok().and_then(|value| plain(value, Comma::None));
    }
    if let Some(percent) = text.strip_suffix('%') {
        return number(percent.trim_end()).map(|n| Number { value: n.value / 100.0, ..n });
    }
    let float = |text: &str| match text.trim().strip_suffix('π') {
        Some("") => Some(std::f64::consts::PI),
        Some(factor) => factor.trim().parse().ok().map(|factor: f64| factor * std::f64::consts::PI),
        None => text.trim().parse::<f64>().ok(),
    };
    let fortran = text.replace(['d', 'D'], "e");
    if let Some(value) = float(text).or_else(|| float(&fortran)) {
        return plain(value, Comma::None);
    }
    if let Some((a, b)) = text.split_once('/') {
        return float(a).zip(float(b)).and_then(|(a, b)| plain(a / b, Comma::None));
    }
    if let Some((a, b)) = text.split_once('^') {
        // What stands high behind any other number is a note, or that of the sides of a mesh.
        let base = |a: f64| if a <= 10.0 { a } else { f64::NAN };
        let whole = float(a).filter(|a| a.fract() == 0.0);
        return whole.zip(float(b)).and_then(|(a, b)| plain(base(a).powf(b), Comma::None));
    }
    if text.contains(['x', '×']) {
        // `32x32` are 32 along each side; of `20x40` the other rows say what it is.
        let sides: Option<Vec<f64>> = text.split(['x', '×']).map(float).collect();
        let sides = sides?;
        let same = sides.iter().all(|side| *side == sides[0]);
        return plain(if same { sides[0] } else { f64::NAN }, Comma::None);
    }
    if text.contains(',') {
        return commas(&fortran).and_then(|(value, comma)| plain(value, comma));
    }
    let letters = text.trim_end_matches(|c: char| c.is_alphabetic());
    let unit = &text[letters.len()..];
    let value = float(letters).filter(|_| (1..=3).contains(&unit.chars().count()))?;
    // `1e`, `2D` are numbers cut short.
    (!["e", "E", "d", "D"].contains(&unit)).then(|| Number {
        value,
        comma: Comma::None,
        unit: unit.into(),
    })
}

/// Cells along a side, where all cells of a column are meshes, `32x32` or `50^3`.
pub(super) fn sides<'a>(cells: impl Iterator<Item = &'a str>) -> Option<Vec<f64>> {
    let (mut power, mut shape) = (None, None::<Vec<f64>>);
    let side = |cell: &str| {
        let cell = cell.trim_matches(['$', '`', '*', ' ']).replace('×', "x");
        if cell.contains('x') {
            let sides: Option<Vec<f64>> =
                cell.split('x').map(|side| side.trim().parse().ok()).collect();
            let sides = sides?;
            let first = shape.get_or_insert_with(|| sides.clone());
            // `21x41` below `11x21` has one shape with it.
            let near = |(a, b): (&f64, &f64)| (a * first[0] / (b * sides[0]) - 1.0).abs() < 0.06;
            let same = sides.len() == first.len() && sides.iter().zip(first.iter()).all(near);
            return same.then(|| sides[0]);
        }
        let (side, exponent) = cell.split_once('^')?;
        let same = *power.get_or_insert(exponent.to_owned()) == exponent;
        (same && ["2", "3"].contains(&exponent)).then(|| side.parse().ok())?
    };
    cells.map(side).collect()
}

fn commas(text: &str) -> Option<(f64, Comma)> {
    let joined: f64 = text.replace(',', "").parse().ok()?;
    let (whole, fraction) = text.split_once('.').unwrap_or((text, ""));
    let mut groups = whole.trim_start_matches(['+', '-']).split(',');
    let first = groups.next()?;
    let digits = |group: &str| group.bytes().all(|byte| byte.is_ascii_digit());
    let grouped = (1..=3).contains(&first.len())
        && !first.starts_with('0')
        && digits(first)
        && groups.clone().all(|group| group.len() == 3 && digits(group))
        && !fraction.contains(',');
    match (grouped, groups.count()) {
        (true, 1) if !text.contains('.') => Some((joined, Comma::Either)),
        (true, _) => Some((joined, Comma::Thousands)),
        (false, 1) => Some((text.replace(',', ".").parse().ok()?, Comma::Decimal)),
        _ => None,
    }
}

/// Of several sizes the first of these is taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Measure {
    Length,
    /// Cells of the mesh: size n^{-1/D}.
    Cells,
    /// Unknowns of the mesh: size n^{-1/D} in the limit.
    Unknowns,
    /// Cells or steps along one side: size 1/n.
    Number,
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

impl Role {
    /// Of a size its measure, and whether it is a time step.
    pub(super) fn size(self) -> Option<(Measure, bool)> {
        match self {
            Role::Space(measure) => Some((measure, false)),
            Role::Time(measure) => Some((measure, true)),
            _ => None,
        }
    }
}

const LENGTH: Role = Role::Space(Measure::Length);

/// A longer one is prose, or a line that is torn.
const LONGEST_NAME: usize = 200;

// Names of columns in normal form, as `normal` gives it.
const LENGTHS: &str = "h hmax dx deltax meshsize maxh hx cellsize gridspacing spacing meshwidth elementsize panelsize";
const TIMES: &str = "k dt deltat tau dtau timestep timestepsize stepsize htime";
const SIDES: &str = "n nx mx nx1 nx2 nx3 grille gitter maillage cellsperside elementsperside resolution grid mesh numpts npts ngridpoints gridpoints 1h oneoverh 1dx hinv ny nz res intervals";
const STEPS: &str = "steps nsteps nt timesteps numberofsteps 1dt 1k";
const CELLS: &str = "cells ncells numcells numberofcells activecells nactivecells numberofactivecells cellnumbers \
    elements nelements numelements numberofelements numel nel ne nelem triangles elems";
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
    div curl semi rms rmse mae mse diff discrepancy inf max sup maximum emax";
const SPACES: &str = "l1 l2 l4 l8 linf h0 h1 h2 w1";

/// A name in lower case without signs and LaTeX commands.
pub(super) fn normal(name: &str) -> String {
    let mut text = name
        .to_lowercase()
        .replace('阶', "order")
        .replace('δ', "delta")
        .replace('τ', "tau")
        .replace('∞', "inf");
    for command in ["\\textrm", "\\mathrm", "\\mathbf", "\\textbf", "\\text", "\\mbox", "\\bm"] {
        text = text.replace(command, "");
    }
    text.retain(|c| c.is_ascii_alphanumeric() || ('α'..='ω').contains(&c));
    text
}

/// Names that say what a column is; the first list with a name counts.
const ROLES: [(Role, &str); 16] = [
    (Role::Error, "error err"),
    (Role::Value, "value"),
    (Role::Floor, "floor"),
    (Role::Sigma, "sigma"),
    (Role::Scene, "scene"),
    (Role::Norm, "norm"),
    (Role::Status, "status"),
    (Role::Space(Measure::Length), LENGTHS),
    (Role::Time(Measure::Length), TIMES),
    (Role::Space(Measure::Number), SIDES),
    (Role::Time(Measure::Number), STEPS),
    (Role::Space(Measure::Cells), CELLS),
    (Role::Space(Measure::Unknowns), DOFS),
    (Role::Space(Measure::Level), LEVELS),
    (Role::Run, RUNS),
    (Role::Parameter, PARAMETERS),
];

/// Every column of every way to read a text is looked up: the lists are cut once.
static KNOWN: LazyLock<HashMap<&str, Role>> = LazyLock::new(|| {
    let names = |(role, list): &(Role, &'static str)| {
        let role = *role;
        list.split_whitespace().map(move |name| (name, role))
    };
    // Of equal keys the last is kept.
    ROLES.iter().rev().flat_map(names).collect()
});
static IGNORED: LazyLock<HashSet<&str>> = LazyLock::new(|| COUNTERS.split_whitespace().collect());
static NORMS: LazyLock<HashSet<&str>> = LazyLock::new(|| NORM_NAMES.split_whitespace().collect());

/// Prose, words that stand far apart, the piece of a row, or a title.
fn is_no_name(name: &str) -> bool {
    if name.len() > LONGEST_NAME {
        return true;
    }
    let bar = if name.starts_with('|') && !name.contains('-') { " | " } else { "\t" };
    let words = name.split('\t').flat_map(|part| part.split("   "));
    let words = words.flat_map(|part| part.split(bar));
    let words = words.filter(|part| part.contains(char::is_alphanumeric));
    let piece = || name.split_once(" | ").is_some_and(|(first, _)| number(first).is_some());
    let title = || name.get(..6).is_some_and(|begin| begin.eq_ignore_ascii_case("table "));
    words.count() > 1 || piece() || title()
}

pub(super) fn role(name: &str) -> Role {
    if is_no_name(name) {
        return Role::Unknown;
    }
    // A unit in brackets is no part of the name.
    let bare = name.split_once(['[', '(']).map_or(name, |(bare, _)| bare);
    let plain = if normal(bare).is_empty() { name } else { bare };
    let normalised = normal(plain);
    // A logarithm of an error is none.
    let mut words = name.split(|c: char| !c.is_alphanumeric()).map(str::to_lowercase);
    if words.any(|word| word.starts_with("log") || ["lg", "ln"].contains(&&*word)) {
        return Role::Unknown;
    }
    // `max dt` is a time step.
    if let Some((word, rest)) = bare.trim().split_once([' ', '_'])
        && ["max", "min", "mean", "avg"].contains(&word.to_lowercase().as_str())
        && let Some(&role) = KNOWN.get(&*normal(rest))
        && role.size().is_some()
    {
        return role;
    }
    // Nor is a quotient: `e_N/e_{2N}` is a rate, `dt/dx^2` no step.
    if let Some(role) = quotient(name) {
        return role;
    }
    let power = bare.trim_start_matches([' ', '$', '`']);
    if ["h^", "dx^", "dt^", "h²"].iter().any(|h| power.starts_with(h)) {
        return Role::Ignored;
    }
    // `hDEC`.
    let shouted = |of: &str| of.len() > 1 && of.chars().all(char::is_uppercase) && !is_rate(of);
    if bare.strip_prefix('h').is_some_and(shouted) {
        return LENGTH;
    }
    // `h||` is what is left of a norm.
    let bars = name.contains("||") || name.contains('‖');
    let bars = bars || name.matches('|').count() > 1 && name.contains('-') || name.contains("Vert");
    let bars = bars || name.matches("\\|").count() > 1;
    if let Some(&role) = KNOWN.get(&*normalised).filter(|_| !bars) {
        // `resolution (m)` counts nothing.
        let unit =
            name.split_once(['[', '(']).map_or("", |(_, unit)| unit.trim_end_matches([']', ')']));
        let length = ["m", "km", "cm", "mm"].contains(&unit.trim());
        return match role {
            Role::Space(Measure::Number) if length => LENGTH,
            _ => along_a_side(name, role),
        };
    }
    // `h = 1/N`, but not `k = 2`, nor `k = 1 error`.
    if let Some((front, value)) = name.split_once('=')
        && let Some(&role) = KNOWN.get(&*normal(front))
        && role.size().is_some()
    {
        match number(value.trim()) {
            None => return role,
            Some(_) if value.trim_matches([' ', '$']).parse::<f64>().is_ok() => {
                return Role::Unknown;
            }
            Some(_) => {}
        }
    }
    let lower = name.to_lowercase().replace('∞', "inf");
    let has = |parts: &str| parts.split(' ').any(|part| normalised.contains(part));
    // Of a vector normal no norm is taken.
    let measures = || {
        let mut words = lower.split(|c: char| !c.is_alphanumeric());
        let parts = |word: &str| {
            let word = word.replace("normal", "");
            ["err", "norm", "energy", "difference"].iter().any(|part| word.contains(part))
        };
        words.any(parts)
            || lower.trim_start_matches([' ', '{', '$', '`']).starts_with("e_")
            || has("hdiv hcurl")
    };
    match &*normalised {
        _ if is_rate(plain) || IGNORED.contains(&*normalised) => Role::Ignored,
        "" if bars || is_error_elsewhere(name) => Role::Wide,
        "" => Role::Ignored,
        // Nor is what theory expects.
        _ if has("iter expect predict theor std deviation") || is_residual(bare) => Role::Unknown,
        // Or what a solution has.
        _ if has("kineticenergy totalenergy potentialenergy freeenergy")
            && !has("err diff norm") =>
        {
            Role::Unknown
        }
        _ if measures() || NORMS.contains(&*normalised) || bars => Role::Wide,
        _ => {
            let known = |word: &str| {
                // `RKL1` is a scheme.
                SPACES.split(' ').any(|space| word.contains(space) && !word.starts_with("rk"))
                    || word.len() > 2 && NORMS.contains(word)
            };
            let words = |text: &str| text.split(|c: char| !c.is_alphanumeric()).any(known);
            match words(&lower) || known(&normalised) {
                true => Role::Wide,
                // Steps of a solver are no time steps.
                false if is_solver(&lower) => Role::Ignored,
                false => part(bare).map_or(Role::Unknown, |role| along_a_side(name, role)),
            }
        }
    }
}

/// The role of a quotient of two errors, or of two sizes.
fn quotient(name: &str) -> Option<Role> {
    let sides: [&str; 2] = name.splitn(2, '/').collect::<Vec<_>>().try_into().ok()?;
    let plain = sides.map(|side| side.replace(['$', '|', '\\', ' ', '‖', '`'], ""));
    let power = |side: &String| normal(side).trim_end_matches('2').to_owned();
    let length = |side: &String| {
        matches!(
            KNOWN.get(&*power(side)),
            Some(Role::Space(Measure::Length) | Role::Time(Measure::Length))
        )
    };
    let error = |side: &String| side.starts_with("e_") || side.starts_with("E_");
    match () {
        () if plain.iter().all(error) => Some(Role::Ignored),
        () if plain.iter().all(length) => Some(Role::Unknown),
        () => None,
    }
}

/// Whether a name is that of a norm of the solution or the data: `L2 norm of u`, `\|u_h\|`, but not `\|u - u_h\|`.
pub(super) fn is_of_solution(name: &str) -> bool {
    let lower = name.to_lowercase();
    let differs =
        ["err", "diff", "dist", "-", "\u{2212}", "resid"].iter().any(|of| lower.contains(of));
    let inside = lower.split(['|', '‖']).find(|part| !normal(part).is_empty());
    let symbol = inside.map(|part| part.trim_matches(['\\', '$', ' ', '{', '}', '`']));
    let of_one = symbol.and_then(|part| part.split('_').next()).is_some_and(|symbol| {
        lower.contains(['|', '‖']) && ["u", "v", "w", "p", "f", "\\sigma"].contains(&symbol)
    });
    let words = || lower.split(|c: char| !c.is_alphanumeric());
    !differs && (of_one || words().any(|word| word == "norm"))
}

/// `elements per edge`, `cells in x` and `sqrt(dofs)` are counted along a side.
fn along_a_side(name: &str, role: Role) -> Role {
    let side = ["sqrt", "cbrt", "^{1/", "^(1/", "^0.5", " per ", "(per ", "along", " in x"];
    let lower = name.to_lowercase();
    match role {
        Role::Space(Measure::Cells | Measure::Unknowns)
            if side.iter().any(|s| lower.contains(s)) =>
        {
            Role::Space(Measure::Number)
        }
        _ => role,
    }
}

/// Whether a name or a sentence speaks of what solves an equation.
pub(super) fn is_solver(text: &str) -> bool {
    let words = "cg pcg newton gmres bicgstab picard krylov multigrid smoothing smoother converged iterations";
    let mut said = text.split(|c: char| !c.is_alphanumeric());
    said.any(|word| words.split(' ').any(|solver| solver.eq_ignore_ascii_case(word)))
}

/// A name that begins or ends with that of a size: `mesh size h`, `coarse_res`.
fn part(name: &str) -> Option<Role> {
    let words: Vec<&str> =
        name.split(|c: char| !c.is_alphanumeric()).filter(|w| !w.is_empty()).collect();
    let ends = (1..words.len()).map(|at| words[at..].concat());
    // Of `grid_spacing_m` the longest says what it is.
    let parts = ends.chain((1..words.len()).rev().map(|at| words[..at].concat()));
    // `u_h` is a solution.
    let sized = |part: &String| part.len() > 1 || name.split_whitespace().any(|word| word == "h");
    // `Running with N`.
    let last = name.split_whitespace().last().filter(|word| word.eq_ignore_ascii_case("n"));
    parts
        .filter(sized)
        .chain((words.len() > 1).then_some(last).flatten().map(str::to_owned))
        .map(|part| role(&part))
        .find(|role| role.size().is_some())
}

pub(super) fn is_size(name: &str) -> bool {
    role(name).size().is_some()
}

pub(super) fn is_norm(name: &str) -> bool {
    matches!(role(name), Role::Wide | Role::Error | Role::Value)
}

/// Whether a name speaks of what a solver has left; `k-space` is no `ksp`.
pub(super) fn is_residual(name: &str) -> bool {
    let lower = name.to_lowercase();
    ["residual", "function norm", "snes ", "ksp "].iter().any(|part| lower.contains(part))
}

/// Whether a name says error in Chinese or Russian.
fn is_error_elsewhere(name: &str) -> bool {
    name.contains(['误', '誤']) || name.to_lowercase().contains("ошиб")
}

/// Whether a name speaks of an error or a norm; `max` or `stress` may be those of a result.
pub(super) fn says_error(name: &str) -> bool {
    let normalised = normal(name);
    let mut parts = ["err", "norm", "diff", "dist", "rms"].into_iter().chain(SPACES.split(' '));
    parts.any(|part| normalised.contains(part))
        || ["e", "eu", "ep", "eh"].contains(&&*normalised)
        || name.contains(['|', '‖'])
        || name.contains("Vert")
        || is_error_elsewhere(name)
}

/// Whether a word of a name is one of rates, as `L2rate` and `eoc2` are; `iterations` and `procs` are none.
pub(super) fn is_rate(name: &str) -> bool {
    let says = |word: &str| {
        let bare = word.trim_end_matches(|c: char| c == 's' || c.is_ascii_digit());
        RATES.split(' ').any(|rate| {
            let behind = word.strip_prefix(rate).is_some_and(|behind| {
                behind.len() < 2 || behind.contains(|c: char| c.is_ascii_digit())
            });
            // `integrate` is none.
            behind || bare.strip_suffix(rate).is_some_and(|front| front.len() < 5)
        })
    };
    let words = name.split(|c: char| !c.is_alphanumeric()).map(normal);
    words.chain([normal(name)]).any(|word| says(&word))
}

/// How well a column answers to a name that a caller gives: 4 for the name itself, 3 but for case and signs, 2 if `L2`
/// is asked and it is `error_L2` or `L2 norm`, 1 if it is `||u - u_h||_L2`.
pub(super) fn likeness(asked: &str, column: &str) -> u8 {
    let core = |name: &str| {
        let mut text = normal(name);
        for part in ["errors", "error", "err", "norm"] {
            let without = text.replacen(part, "", 1);
            text = if without.is_empty() { text } else { without };
        }
        text
    };
    // H^1 of |u-u_h|_{H^1} is one word.
    let flat = column.replace('^', "");
    let mut words = flat.split(|c: char| !c.is_alphanumeric());
    let same = [
        asked == column,
        normal(asked) == normal(column),
        core(asked) == core(column),
        !is_rate(column) && words.any(|word| word.len() > 1 && word.eq_ignore_ascii_case(asked)),
    ];
    same.iter().position(|same| *same).map_or(0, |at| 4 - at as u8)
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
