//! What the numbers of columns say where their names do not.

use super::Reading;
use super::cell::{
    Measure, Role, is_missing, is_norm, is_rate, is_residual, is_size, normal, number,
};
use super::line::{Block, Cells, evenly, is_word, listed};

/// Sizes that a person takes for such refine by one factor, as far as they are printed.
const FACTORS_DIFFER: f64 = 0.005;
/// Unknowns, points and rounded lengths do so less closely.
const COUNTS_DIFFER: f64 = 0.4;
/// A larger factor is that of tolerances, of cells in three dimensions, or of samples.
const LARGEST_FACTOR: f64 = 3.1;
/// Digits of a size that people choose.
const ROUND: usize = 3;
/// Numbers that fall by less in all may be values of something that tends to a limit.
const LEAST_FALL: f64 = 3.5;
/// Beside such a column others that fall by so much are errors, too.
const LEAST_BESIDE: f64 = 1.5;
/// Names of what has none, with a number.
const COLUMN: &str = "column";
const LINE: &str = "line";
const OTHERS: &str = "time cpu wall sec tol eps iter expect predict theor std deviation log memory speed balance change";
/// Names of what a mesh of an unknown dimension has.
const OF_MESH: &str = "node vert point count unknown dof";
/// Names of what falls with the size and is no error.
const LENGTHS: &str = "size edge width length spacing diameter radius volume area mass";
/// Orders of what falls like a power of the size lie between these, and differ by less than this factor. A value that tends to a limit
/// has none. What falls by so much in all needs no steady order.
const ORDERS: std::ops::Range<f64> = 0.25..15.0;
const ORDERS_DIFFER: f64 = 2.0;
const CLEAR_FALL: f64 = 50.0;
/// Printed powers of a size are off by so much, as logarithms.
const POWERS_OFF: f64 = 0.005;
/// What has fallen by so much may meet rounding.
const ROUNDED: f64 = 1e4;
/// Smaller errors may be rounding.
const ROUNDING: f64 = 1e-11;

/// Falls by powers of two for each level are off by so much.
const POWER_OFF: f64 = 0.06;
/// Numbers that fall so much at a steady order are errors, whatever stands beside them.
const TWO_DECADES: f64 = 100.0;

fn value(row: &Cells, at: usize) -> Option<f64> {
    number(row.cells.get(at)?).map(|number| number.value)
}

/// The numbers of a column without gaps.
fn numbers(rows: &[Cells], at: usize) -> Option<Vec<f64>> {
    let numbers = rows.iter().map(|row| value(row, at));
    numbers.collect::<Option<Vec<f64>>>().filter(|n| n.len() > 2 && n.iter().all(|n| *n > 0.0))
}

/// The factor from row to row, if it is about the same everywhere.
fn factor(numbers: &[f64], differ: f64) -> Option<f64> {
    let factors = || numbers.windows(2).map(|pair| pair[1] / pair[0]);
    let first = factors().next()?;
    factors().all(|factor| (factor / first - 1.0).abs() < differ).then_some(first)
}

/// What the sizes of a column without such a name are.
fn size(rows: &[Cells], at: usize) -> Option<Measure> {
    let numbers = numbers(rows, at)?;
    let whole = numbers.iter().all(|number| number.fract() == 0.0);
    // Counts in the first column may grow as people choose them, not evenly as rows and degrees do.
    // What grows tenfold in all may do so slowly.
    let least = if numbers[numbers.len() - 1] >= 10.0 * numbers[0] { 1.1 } else { 1.2 };
    let grows = |pair: &[f64]| (least..LARGEST_FACTOR).contains(&(pair[1] / pair[0]));
    if at == 0 && whole && !evenly(&numbers) && numbers.windows(2).all(grows) {
        return Some(Measure::Number);
    }
    let factor = factor(&numbers, if whole { 1e-9 } else { FACTORS_DIFFER })?;
    let sound = factor.max(1.0 / factor) < LARGEST_FACTOR && (factor - 1.0).abs() > 0.2;
    match (sound, whole, factor > 1.0) {
        (true, true, true) => Some(Measure::Number),
        (true, false, _) => Some(Measure::Length),
        _ => None,
    }
}

/// Lengths in the first of several columns without names fall and are round, as people choose them.
fn round(block: &Block) -> Option<Measure> {
    let bare = block.names.len() > 1 && block.names[0] == format!("{COLUMN} 1");
    let numbers = numbers(&block.rows, 0).filter(|_| bare)?;
    let short = |row: &Cells| row.cells[0].trim_matches(['0', '.']).len() <= ROUND;
    let falls = numbers.windows(2).all(|pair| pair[1] < pair[0]);
    (falls && block.rows.iter().all(short)).then_some(Measure::Length)
}

/// The only numbers beside errors that names say, where they fall and the errors rise: so do the steps of a difference quotient below
/// which rounding grows. Tolerances do not.
fn only(block: &Block, roles: &[Role]) -> Option<(usize, Measure)> {
    let said = |at: &usize| matches!(roles[*at], Role::Error | Role::Wide);
    let numeric = |at: &usize| block.rows.iter().all(|row| value(row, *at).is_some());
    let other = |at: &usize| !said(at) && !is_rate(&block.names[*at]) && numeric(at);
    let mut open = (0..roles.len()).filter(other);
    let (at, None) = (open.next()?, open.next()) else { return None };
    let rises = |of: usize| fall(&block.rows, of, false).is_some_and(|by| by > LEAST_FALL);
    let sound = (0..roles.len()).filter(said).all(rises);
    let small = numbers(&block.rows, at)?[0] < 1.0 && fall(&block.rows, at, true).is_some();
    (sound && small).then_some((at, Measure::Length))
}

/// Whether the rows refine from first to last, or from last to first, at one rate.
fn refines(rows: &[Cells], at: usize, measure: Measure) -> Option<bool> {
    let factor = || factor(&numbers(rows, at)?, COUNTS_DIFFER).filter(|f| (f - 1.0).abs() > 0.2);
    let level = measure == Measure::Level;
    if level { Some(true) } else { Some((factor()? > 1.0) != (measure == Measure::Length)) }
}

/// By how much the numbers of a column fall towards the finest row, if they do in each.
fn fall(rows: &[Cells], at: usize, forward: bool) -> Option<f64> {
    let mut numbers = numbers(rows, at)?;
    if !forward {
        numbers.reverse();
    }
    let down = 1 + numbers.windows(2).take_while(|pair| pair[1] < pair[0]).count();
    let fall = numbers[0] / numbers[down - 1];
    // Behind so many decades rounding, or another error, may let them rise again.
    let rises = down > 3
        && fall >= TWO_DECADES
        && numbers[down..].iter().all(|number| *number >= numbers[down - 1]);
    (down == numbers.len() || rises).then_some(fall)
}

/// By how much a column below 1 falls that may be one of errors, 0 if it does not; none for what has no number.
fn fall_of_errors(block: &Block, at: usize, forward: bool) -> Option<f64> {
    let numbers = numbers(&block.rows, at).filter(|_| !is_other(&block.names[at]))?;
    let small = numbers.iter().all(|number| *number < 1.0);
    let fall = fall(&block.rows, at, forward).filter(|_| small).unwrap_or(0.0);
    Some(fall)
}

fn is_other(name: &str) -> bool {
    is_residual(name) || OTHERS.split(' ').any(|other| name.to_lowercase().contains(other))
}

/// Where the numbers of a column of sizes contradict its name, they say what it is.
pub(super) fn by_values(block: &Block, roles: &mut [Role], notes: &mut Vec<String>) {
    for at in 0..roles.len() {
        let Some((measure, time)) = roles[at].size() else { continue };
        let cells = block.rows.iter().map(|row| value(row, at)).collect::<Option<Vec<f64>>>();
        let Some(rows) = cells.filter(|sizes| sizes.len() > 2) else { continue };
        // The same in all rows it is a setting; a length beside a time step is one of the two sizes.
        if measure != Measure::Length && rows.iter().all(|size| *size == rows[0]) {
            roles[at] = Role::Ignored;
            continue;
        }
        let other = (0..roles.len())
            .find(|&of| of != at && roles[of].size().is_some_and(|(_, other)| other == time));
        let mut sizes = rows.clone();
        sizes.sort_by(f64::total_cmp);
        sizes.dedup();
        let (least, most) = (sizes[0], sizes[sizes.len() - 1]);
        let whole = sizes.iter().all(|size| size.fract() == 0.0);
        let even = evenly(&sizes);
        // A count from 0 or 1 on beside another size numbers the rows.
        let numbers_rows = even && least <= 1.0 && most - least + 1.0 == sizes.len() as f64;
        if measure == Measure::Number && other.is_some() && numbers_rows {
            roles[at] = Role::Ignored;
            continue;
        }
        let geometric = sizes.len() > 2
            && !even
            && factor(&sizes, COUNTS_DIFFER).is_some_and(|factor| factor > 1.2);
        let powers = || (0..roles.len()).any(|of| falls_by_powers_of_two(block, &rows, of));
        let (found, word) = match measure {
            // There are 2, 4, 8 levels, but not sixteen, nor 1, 2, 4, 8.
            Measure::Level
                if geometric
                    && whole
                    && (most >= 16.0 || sizes.len() > 3 && factor(&sizes, 1e-9) == Some(2.0)) =>
            {
                (Measure::Number, "a count")
            }
            Measure::Number if geometric && most < 1.0 && other.is_none() => {
                (Measure::Length, "a step")
            }
            Measure::Length if time && other.is_none() && whole && even && powers() => {
                (Measure::Level, "the exponent of a step 2^-k")
            }
            _ => continue,
        };
        roles[at] = match time && found != Measure::Level {
            true => Role::Time(found),
            false => Role::Space(found),
        };
        notes.push(format!("`{}` taken for {word} by its numbers", block.names[at]));
    }
}

/// Whether a column falls by a whole power of two for each 1 by which the numbers of the rows grow.
fn falls_by_powers_of_two(block: &Block, rows: &[f64], at: usize) -> bool {
    let errors: Vec<f64> = block.rows.iter().map(|row| value(row, at).unwrap_or(0.0)).collect();
    let fall = |(k, e): (&[f64], &[f64])| (e[0] / e[1]).log2() / (k[1] - k[0]);
    let falls: Vec<f64> = rows.windows(2).zip(errors.windows(2)).map(fall).collect();
    // The first rows may be too coarse for their order, the last ones meet rounding.
    let whole = |fall: &&f64| fall.round() > 0.0 && (*fall - fall.round()).abs() < POWER_OFF;
    let sound: Vec<&f64> = falls.iter().skip_while(|f| !whole(f)).take_while(whole).collect();
    sound.len() > 2 && sound.iter().all(|fall| fall.round() == sound[0].round())
}

/// Sizes and errors that no name says, by their numbers: the place of such a size, and whether the rows refine from first to last.
pub(super) fn by_numbers(
    block: &Block,
    reading: &Reading,
    roles: &mut [Role],
    notes: &mut Vec<String>,
) -> Option<(usize, bool)> {
    let rows = &block.rows;
    // Numbers are no names.
    if block.names.iter().any(|name| number(name).is_some()) {
        return None;
    }
    let unknown = |role: &Role| *role == Role::Unknown;
    let sized = |role: &Role| role.size().map(|(measure, _)| measure);
    let mut counted = None;
    if roles.iter().all(|role| sized(role).is_none()) && reading.ratio.is_none() && roles.len() > 1
    {
        let open = |at: &usize| unknown(&roles[*at]) && !is_other(&block.names[*at]);
        // A name in another script says nothing.
        let bare = |at: &usize| *at == 0 && normal(&block.names[0]).is_empty();
        let mut open = (0..roles.len()).filter(|at| open(at) || bare(at));
        counted = open.find_map(|at| size(rows, at).map(|measure| (at, measure)));
        counted = counted.or(round(block).map(|measure| (0, measure)));
        if let Some((at, measure @ Measure::Number)) = &mut counted
            && OF_MESH.split(' ').any(|of| block.names[*at].to_lowercase().contains(of))
        {
            *measure = Measure::Unknowns;
        }
        counted = counted.or_else(|| only(block, roles));
        if let Some((at, measure)) = counted {
            roles[at] = Role::Space(measure);
        }
    }
    let sizes = roles.iter().enumerate().filter_map(|(at, role)| Some((at, sized(role)?)));
    let mut forward = sizes.filter_map(|(at, measure)| refines(rows, at, measure));
    // Rows without sizes refine as they stand.
    let forward = forward.next().or(roles.iter().all(|role| sized(role).is_none()).then_some(true));
    let named = roles.iter().any(|role| matches!(role, Role::Error | Role::Value | Role::Wide));
    // Where names say something, they say one of the two, and nothing is beside the errors that does not fall. Of several columns
    // without names one is a size.
    let first = |what: &str| block.names.first().is_some_and(|name| *name == format!("{what} 1"));
    let (lines, bare) = (first(LINE), first(LINE) || first(COLUMN));
    let sizes = !bare || lines || counted.is_some() || roles.len() == 1;
    let open = !named && !of_errors(&block.title) && sizes && (bare || counted.is_none());
    if let Some(forward) = forward.filter(|_| open) {
        let open = (0..roles.len()).filter(|&at| unknown(&roles[at]));
        let falls = open.filter_map(|at| Some((at, fall_of_errors(block, at, forward)?)));
        let falls: Vec<(usize, f64)> =
            falls.filter(|(_, fall)| !bare || *fall > LEAST_BESIDE).collect();
        let sound = falls.iter().all(|(_, fall)| *fall > LEAST_BESIDE);
        if sound && falls.iter().any(|(_, fall)| *fall > LEAST_FALL) {
            let falling = falls.into_iter().map(|(at, _)| at);
            let with = |at: &usize| counted.is_some_and(|(of, _)| goes_with(rows, of, *at));
            let (sized, errors): (Vec<usize>, Vec<usize>) = falling.partition(with);
            let falling = if errors.is_empty() { sized } else { errors };
            let names = listed(falling.iter().map(|&at| &block.names[at]));
            notes.push(format!("{names} taken for errors because they fall"));
            falling.into_iter().for_each(|at| roles[at] = Role::Wide);
        }
    }
    counted.map(|(at, _)| (at, forward.unwrap_or(true)))
}

/// `r_{L2}`, orders behind an error that has a number in the first row where they have none.
pub(super) fn rates_of_norms(block: &Block, roles: &mut [Role]) {
    let missing = |row: &Cells, at: usize| is_missing(&row.cells[at]);
    for at in 1..roles.len() {
        let behind = matches!(roles[at - 1], Role::Wide | Role::Error)
            && !block.rows.iter().any(|row| missing(row, at - 1));
        let below = block.rows[1..].iter().map(|row| value(row, at));
        // Errors change by more: threefold over two halvings from order 0.8 on, by a half over one from 0.6 on.
        let rates = below.collect::<Option<Vec<f64>>>().filter(|rates| rates.len() > 1);
        let orders = |rates: &Vec<f64>| {
            let (least, most) = range(rates);
            least > 0.2 && most < 15.0 && most < if rates.len() > 2 { 3.0 } else { 1.5 } * least
        };
        let rates = missing(&block.rows[0], at) && rates.is_some_and(|rates| orders(&rates));
        if roles[at] == Role::Wide && behind && rates {
            roles[at] = Role::Ignored;
        }
    }
}

/// Where no other column is one of errors, a standard error that falls, or grows, in each row is.
pub(super) fn by_deviation(block: &Block, roles: &mut [Role], notes: &mut Vec<String>) {
    let names = ["stderr", "stderror", "standarderror", "se", "sem"];
    let deviation = |at: &usize| names.contains(&&*normal(&block.names[*at]));
    let measure = |at| matches!(roles[at], Role::Error | Role::Value | Role::Wide | Role::Norm);
    let mut places = (0..roles.len()).filter(|at| deviation(at) || measure(*at));
    let (Some(at), None) = (places.next(), places.next()) else { return };
    let falls = |forward| fall(&block.rows, at, forward).is_some();
    if deviation(&at) && (falls(true) || falls(false)) {
        roles[at] = Role::Error;
        notes.push(format!("`{}` taken for the error: no other column is one", block.names[at]));
    }
}

/// Columns without a known name that fall like powers of the size are errors.
pub(super) fn by_powers(block: &Block, named: bool, roles: &mut [Role], notes: &mut Vec<String>) {
    let size = |role: &Role| role.size().map(|(measure, _)| measure);
    let numeric = |at: usize| block.rows.iter().any(|row| value(row, at).is_some());
    let sized = roles.iter().enumerate().filter(|(at, _)| numeric(*at));
    let Some((at, measure)) = sized.into_iter().find_map(|(at, role)| Some((at, size(role)?)))
    else {
        return;
    };
    let step = |row: &Cells| {
        let number = value(row, at)?;
        Some(match measure {
            Measure::Level => -number,
            Measure::Length => number.ln(),
            _ => -number.ln(),
        })
    };
    let steps: Option<Vec<f64>> = block.rows.iter().map(step).collect();
    let Some(steps) = steps.filter(|steps| steps.iter().all(|step| step.is_finite())) else {
        return;
    };
    let falls = |at: usize| {
        let errors: Vec<f64> =
            block.rows.iter().map(|row| value(row, at).map_or(f64::NAN, f64::ln)).collect();
        // Above 1 they may be per cent.
        let unit = if block.names[at].contains('%') { 100f64.ln() } else { 0.0 };
        let errors: Vec<f64> = errors.iter().map(|error| error - unit).collect();
        falls_like_a_power(&steps, &errors)
    };
    let other = |at: usize| {
        let name = block.names[at].to_lowercase();
        is_other(&name) || LENGTHS.split(' ').any(|length| name.contains(length))
    };
    let open = |at: &usize| roles[*at] == Role::Unknown && !other(*at) && numeric(*at);
    let open: Vec<usize> = (0..roles.len()).filter(open).collect();
    let mut found: Vec<(usize, f64)> =
        open.iter().filter_map(|&at| Some((at, falls(at)?))).collect();
    // Made up errors are exact, too.
    let exact = (0..roles.len())
        .any(|of| matches!(roles[of], Role::Wide | Role::Error) && goes_with(&block.rows, at, of));
    if named && !exact {
        found.retain(|&(of, _)| !goes_with(&block.rows, at, of));
    }
    // Where no name says what an error is, a column that does not fall leaves it open, unless the others fall clearly.
    let clear = || found.iter().all(|(_, fall)| *fall >= TWO_DECADES);
    if !found.is_empty() && (named || found.len() == open.len() || clear()) {
        let names = listed(found.iter().map(|&(at, _)| &block.names[at]));
        // Beside a named error they are read where somebody asks for them.
        if !roles.contains(&Role::Error) {
            notes.push(format!("{names} taken for errors because they fall"));
        }
        found.into_iter().for_each(|(at, _)| roles[at] = Role::Wide);
    }
}

/// Whether a column is exactly a power of a size, as a parameter that is refined with it.
fn goes_with(rows: &[Cells], size: usize, at: usize) -> bool {
    let log = |row: &Cells, at| value(row, at).map(f64::ln);
    let pair = |pair: &[Cells]| {
        let change = |at| Some(log(&pair[1], at)? - log(&pair[0], at)?);
        Some(change(at)? / change(size)?)
    };
    let powers: Option<Vec<f64>> = rows.windows(2).map(pair).collect();
    powers.is_some_and(|powers| {
        let exact = |power: &f64| power.round() != 0.0 && (power - powers[0].round()).abs() < 1e-6;
        powers.len() > 1 && powers.iter().all(exact)
    })
}

/// By how much numbers fall that do so like powers of sizes; both are logarithms. Rows may hold several ladders, of which each begins
/// where the size goes back.
fn falls_like_a_power(steps: &[f64], errors: &[f64]) -> Option<f64> {
    let pairs = steps.windows(2).zip(errors.windows(2));
    let pairs = || pairs.clone().map(|(h, e)| (h[0] - h[1], e[0] - e[1], e[0].min(e[1])));
    let forward = pairs().map(|(h, ..)| h.signum()).sum::<f64>();
    let ladders = 1 + pairs().filter(|(h, ..)| h * forward <= 0.0).count();
    let mut along: Vec<(f64, f64)> = pairs()
        .filter(|(h, _, least)| h * forward > 0.0 && *least >= ROUNDING.ln())
        .map(|(h, e, _)| (e / h, e.abs()))
        .collect();
    // What one ladder does below so many digits may be rounding.
    let sizes = |along: &[(f64, f64)]| along.iter().map(|(_, fall)| fall).sum::<f64>();
    let fallen = along.iter().take_while(|(order, _)| *order > ORDERS.start).count();
    if ladders == 1 && forward > 0.0 && sizes(&along[..fallen]) > ROUNDED.ln() {
        along.truncate(fallen);
    }
    let most = along.iter().map(|(order, _)| *order).fold(0.0, f64::max);
    let least = along.iter().map(|(order, _)| *order).fold(f64::MAX, f64::min);
    let steady = ORDERS.contains(&least) && most < ORDERS_DIFFER * least;
    let fall = sizes(&along) / ladders as f64;
    let clear = least > 0.0 && fall > CLEAR_FALL.ln();
    // `dx^2` is no error, nor is what is above 1 where no name says so.
    let power = |(h, e): (&f64, &f64)| (e - h * most).abs() < POWERS_OFF;
    let sound = errors.iter().all(|error| error.is_nan() || *error < 0.0) && most < ORDERS.end;
    let found = along.len() > 1 && sound && (steady || clear);
    (found && !steps.iter().zip(errors).all(power)).then(|| fall.exp())
}

/// A size by its numbers is one where all errors fall with it.
pub(super) fn confirm(
    block: &Block,
    counted: Option<(usize, bool)>,
    roles: &mut [Role],
    notes: &mut Vec<String>,
) {
    let Some((at, forward)) = counted else { return };
    let errors =
        (0..roles.len()).filter(|&of| matches!(roles[of], Role::Error | Role::Value | Role::Wide));
    let alone = only(block, roles).is_some_and(|(of, _)| of == at);
    let mut falls = errors.map(|of| alone || fall(&block.rows, of, forward).is_some());
    if falls.next() == Some(true) && falls.all(|falls| falls) {
        notes.insert(0, format!("`{}` taken for a size by its numbers", block.name(at)));
    } else {
        roles[at] = Role::Unknown;
    }
}

/// Rows whose first size comes again begin another ladder.
pub(super) fn ladders(block: Block) -> Vec<Block> {
    let first = block.rows[0].cells[0].clone();
    let parts = block.rows.chunk_by(|_, row| row.cells[0] != first);
    let part = |rows: &[Cells]| Block {
        rows: rows.to_vec(),
        end: rows[rows.len() - 1].line,
        ..block.clone()
    };
    let mut parts: Vec<Block> = parts.map(part).collect();
    parts.iter_mut().skip(1).for_each(|part| part.line = part.rows[0].line);
    parts
}

/// A block below no text, its columns numbered, or its lines if they are few and long.
pub(super) fn unnamed(block: &Block) -> Option<Block> {
    let width = block.rows[0].cells.len();
    let sound =
        |row: &Cells| row.cells.len() == width && !row.cells.iter().any(|cell| is_word(cell));
    // A sentence names no columns.
    let prose = block.names.len() > width
        && block.names.last().is_some_and(|name| name.ends_with([':', '.']));
    if !block.names.is_empty() && !prose && (width > 1 || is_size(&block.names[0]))
        || !block.rows.iter().all(sound)
    {
        return None;
    }
    let numbered =
        |what: &str, count: usize| (1..=count).map(|at| format!("{what} {at}")).collect();
    let lying = width > 2 * block.rows.len();
    let named = if lying {
        let lines: Vec<String> = numbered(LINE, block.rows.len());
        let cells = block.rows.iter().map(|row| row.cells.clone());
        Block::of_columns(block.line, block.end, lines.into_iter().zip(cells).collect())
    } else {
        Block { names: numbered(COLUMN, width), ..block.clone() }
    };
    Some(Block { title: block.names.join(" "), ..named })
}

/// Whether a column without a name is one of errors.
pub(super) fn has_errors(block: &Block) -> bool {
    let mut roles = vec![Role::Unknown; block.names.len()];
    by_numbers(block, &Reading::default(), &mut roles, &mut Vec::new());
    roles.contains(&Role::Wide)
}

/// Whether a title says that errors stand below it; `rate error` is the error of a rate.
pub(super) fn of_errors(title: &str) -> bool {
    is_norm(title) || title.to_lowercase().contains("rate error")
}

/// Numbers between 0.2 and 15 that change by less than a factor of three, below a line that speaks of rates. An error that is refined
/// twice changes by more, unless its order is below 0.8.
pub(super) fn are_orders(title: &str, entries: &[Option<f64>]) -> bool {
    let said = ["rate", "order", "eoc", "slope"].iter().any(|w| title.to_lowercase().contains(w));
    let all = || entries.iter().flatten().copied();
    let (least, most) = (all().fold(f64::MAX, f64::min), all().fold(0.0, f64::max));
    said && all().count() > 2 && least > 0.2 && most < 15.0 && most < 3.0 * least
}

/// The least and the largest magnitude.
fn range(entries: &[f64]) -> (f64, f64) {
    let sizes = || entries.iter().map(|entry| entry.abs());
    (sizes().fold(f64::MAX, f64::min), sizes().fold(0.0, f64::max))
}

/// Whether three numbers and more are within a tenth: an error that is refined twice changes by more.
pub(super) fn hardly_changes(entries: &[f64]) -> bool {
    let (least, most) = range(entries);
    entries.len() > 2 && most < 1.1 * least
}

/// Whether numbers are as small as rounding and fall no further.
pub(super) fn is_rounding(entries: &[f64]) -> bool {
    let (least, most) = range(entries);
    most < ROUNDING / 10.0 && most < 10.0 * least
}

/// Numbers that change in one direction, by less from row to row, and by less than half in all. An error that is refined
/// twice does so only where it stagnates.
pub(super) fn approach_a_limit(entries: &[f64]) -> bool {
    let (least, most) = range(entries);
    let mut changes: Vec<f64> = entries.windows(2).map(|pair| pair[1] - pair[0]).collect();
    // Rows may go from fine to coarse.
    if changes.len() > 1 && changes[0].abs() < changes[1].abs() {
        changes.reverse();
    }
    let shrinks = |pair: &[f64]| pair[0] * pair[1] > 0.0 && pair[1].abs() < 0.8 * pair[0].abs();
    changes.len() > 1 && most < 1.5 * least && changes.windows(2).all(shrinks)
}
