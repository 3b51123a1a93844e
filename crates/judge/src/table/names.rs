//! The names of the columns of a block, from the lines above its rows.

use super::cell::{
    Measure, Role, is_missing, is_missing_or_zero, is_norm, is_rate, is_size, normal, number, role,
};
use super::line::{Block, Cells, Kind, Line, Separator, is_computed, is_title, is_word};

/// The block below `above`, with the names that stand there; no names if there are none that fit.
pub(super) fn head(
    above: &[Line],
    separator: Separator,
    width: usize,
    mut rows: Vec<Cells>,
    mut left_out: Vec<u64>,
) -> Block {
    let (mut texts, types) = nearest(above);
    left_out.extend(types);
    let words = |line: &Line| {
        let mut names = line.names(separator, width);
        // pandas ends a line that is to go on.
        names.retain(|name| name != "\\");
        names
    };
    // `ans =` above a matrix and `error = 0.1` of a log name no columns.
    let assigns = |line: &Line| {
        line.text.trim().rsplit_once('=').is_some_and(|(name, value)| {
            (!value.is_empty() || name.split_whitespace().count() < 2)
                && value.split([' ', ',']).all(|word| word.is_empty() || number(word).is_some())
        })
    };
    // A row with one number, as that of an exact value, below the names of so many columns.
    let numbers = |line: &Line| line.cells.iter().filter(|cell| number(cell).is_some()).count();
    if let [row, names, ..] = texts[..]
        && [row, names].iter().all(|line| line.cells.len() == width && width > 2)
        && numbers(row) > 0
        && numbers(names) == 0
        && names.cells.iter().any(|name| is_norm(name))
    {
        left_out.push(texts.remove(0).number);
    }
    // A title may stand between the names and the rows.
    if let [title, names, ..] = texts[..]
        && (is_title(title) || assigns(title))
        && title.cells.len() < width
        && names.cells.len() == width
        && (title.text.trim() == "ans =" || names.cells.iter().any(|name| is_size(name)))
        && names.cells.iter().any(|name| is_norm(name))
    {
        texts.swap(0, 1);
    }
    // Names of several words stand two blanks apart.
    let groups = |line: &Line| -> Vec<String> {
        let bare = line.bare().replace('\t', "  ");
        let names = bare.split("  ").map(|name| name.trim().trim_end_matches([',', ';', '\\']));
        names.filter(|name| !name.is_empty()).map(str::to_owned).collect()
    };
    let line = texts.first().map_or(rows[0].line, |line| line.number);
    let title = |at: usize| texts.get(at).map_or(String::new(), |line| line.bare().to_owned());
    let block = |names, title, rows, left_out| Block {
        title,
        left_out,
        ..Block::of_rows(line, names, rows)
    };
    let Some(first) = texts.first().filter(|line| !assigns(line)) else {
        return block(Vec::new(), String::new(), rows, left_out);
    };
    if let Some(second) = texts.get(1).filter(|_| separator != Separator::Blanks)
        && let Some(names) = below_spanning(&words(second), &words(first), width)
    {
        return block(names, title(2), rows, left_out);
    }
    // A size of a row above, and below the others an error with its order each.
    if let Some(above) = texts[1..]
        .iter()
        .map(|line| words(line))
        .find(|names| separator != Separator::Blanks && names.len() > 1 && is_size(&names[0]))
        && words(first).len() + 1 == width
        && let [size, over @ ..] = &above[..]
        && words(first).iter().all(|name| is_norm(name) || is_rate(name))
        && let Some(names) = below_spanning(over, &words(first), width - 1)
    {
        fill_rates(&mut rows, &[vec![size.clone()], names.clone()].concat(), 0);
        return block([vec![size.clone()], names].concat(), title(3), rows, left_out);
    }
    // Two rows of names: `rho` over `error EOC`.
    if let Some(second) = texts.get(1)
        && let Some(names) = two_rows(&words(second), &words(first), width)
    {
        return block(names, title(2), rows, left_out);
    }
    if separator == Separator::Blanks
        && let Some(names) = texts.get(1).and_then(|line| named_rows(&words(line), &words(first)))
        && names.len() == width
    {
        return block(names, title(2), rows, left_out);
    }
    // pandas prints the name of an index below the others.
    if separator == Separator::Blanks
        && let Some(second) = texts.get(1)
        && !words(first).iter().any(|name| is_norm(name))
        && let Some(above) = [words(second), groups(second)].into_iter().find(|above| {
            above.len() + words(first).len() == width && above.iter().any(|name| is_norm(name))
        })
    {
        return block([words(first), above].concat(), title(2), rows, left_out);
    }
    let mut ways = vec![words(first)];
    if separator == Separator::Blanks {
        let groups = groups(first);
        let counts = |group: &String| {
            group.split_whitespace().all(|name| is_size(name) || role(name) == Role::Ignored)
        };
        let split = |group: &String| match counts(group) {
            true => group.split_whitespace().map(str::to_owned).collect(),
            false => vec![group.clone()],
        };
        ways.push(groups.iter().flat_map(split).collect());
        // A unit in brackets belongs to the name before it.
        let mut united: Vec<String> = Vec::new();
        for word in words(first) {
            match united.last_mut().filter(|_| word.starts_with(['[', '('])) {
                Some(name) => *name += &format!(" {word}"),
                None => united.push(word),
            }
        }
        ways.push(united);
        ways.push(groups);
    } else {
        ways.push(words(first).into_iter().filter(|name| !name.is_empty()).collect());
    }
    let unknown = |names: &Vec<String>| names.iter().filter(|n| role(n) == Role::Unknown).count();
    let fits = ways.iter().filter_map(|names| fitted(names.clone(), width, &rows));
    // A column of row numbers has no name.
    let shifted = |names: &[String]| {
        (separator == Separator::Blanks || !names[0].is_empty()) && shifted(names, &rows)
    };
    let best = fits.min_by_key(|(names, extra)| (shifted(names), unknown(names), *extra));
    let Some((names, _)) = best else {
        return block(ways.swap_remove(0), title(1), rows, left_out);
    };
    let last = if separator == Separator::Blanks { rows.len() - 1 } else { 0 };
    fill_rates(&mut rows, &names, last);
    block(names, title(1), rows, left_out)
}

/// Below the name of the columns, `method Euler RK4`, pandas prints that of the rows.
fn named_rows(above: &[String], below: &[String]) -> Option<Vec<String>> {
    let ([row], [_, names @ ..]) = (below, above) else { return None };
    let other = |name: &String| !is_size(name) && number(name).is_none();
    let found = is_size(row) && above.iter().all(other);
    found.then(|| [std::slice::from_ref(row), names].concat())
}

/// Whether names stand above other columns than theirs: the first row has no rate, but an error, and no mesh of no cells.
fn shifted(names: &[String], rows: &[Cells]) -> bool {
    let none = |at: usize| rows[0].cells.get(at).is_some_and(|cell| is_missing_or_zero(cell));
    let level = role(&names[0]) == Role::Space(Measure::Level);
    let counts = is_index(rows) && is_size(&names[0]) && !level && none(0);
    rows.len() > 1 && (counts || (0..names.len()).any(|at| is_norm(&names[at]) && none(at)))
}

/// Cells of rates that the first rows lack, each beside its norm or all at the end, or the `last` row at its end: between whole rows
/// any cell may be the lost one.
fn fill_rates(rows: &mut [Cells], names: &[String], last: usize) {
    let width = names.len();
    let rates: Vec<usize> = (0..width).filter(|&at| is_rate(&names[at])).collect();
    let rest = |from: usize, unread: fn(&String) -> bool| names[from..].iter().all(unread);
    let first = rows.iter().position(|row| row.cells.len() == width).unwrap_or(0);
    // So has a column computed from another one, whatever its name.
    let front = rows[0].cells.len();
    if front + 1 == width && (1..front).any(|from| is_computed(rows, front, from)) {
        rows[0].cells.push(String::new());
    }
    for (at, row) in rows.iter_mut().enumerate().filter(|(_, row)| row.cells.len() < width) {
        let there = row.cells.len();
        let rates_lack = there + rates.len() == width;
        if at < first && rates_lack {
            rates.iter().for_each(|&at| row.cells.insert(at, String::new()));
        } else if at == 0 && rest(there, |name| matches!(role(name), Role::Unknown | Role::Ignored))
            || at == last && rates_lack && rest(there, |name| is_rate(name))
        {
            row.cells.resize(width, String::new());
        }
    }
}

/// The three lines of text that are nearest above the rows, and the lines of types between.
fn nearest<'a, 'b>(above: &'a [Line<'b>]) -> (Vec<&'a Line<'b>>, Vec<u64>) {
    let (mut texts, mut types) = (Vec::new(), Vec::new());
    for line in above.iter().rev() {
        match line.kind {
            Kind::Gap => {}
            Kind::Row => break,
            _ if line.cells.iter().all(|cell| cell.is_empty() || is_type(cell)) => {
                types.push(line.number);
            }
            _ => texts.push(line),
        }
        if texts.len() == 3 {
            break;
        }
    }
    (texts, types)
}

/// The type of a column, or its unit, as Julia and R print them below the names.
fn is_type(cell: &str) -> bool {
    let types = ["int64", "float64", "string", "int", "dbl", "chr", "fct", "i64", "f64", "str"];
    let bracketed = cell.starts_with('[') && cell.ends_with(']');
    let bare = cell.to_lowercase().replace(['<', '>', '?'], "");
    bracketed || types.contains(&bare.as_str())
}

/// Names for `width` columns, and how many were put in: a column of row numbers, or rates after each norm.
fn fitted(names: Vec<String>, width: usize, rows: &[Cells]) -> Option<(Vec<String>, usize)> {
    let extra = width.checked_sub(names.len())?;
    if extra == 0 {
        return Some((names, 0));
    }
    // A last separator without a cell, or one word behind all rows.
    let last = |row: &Cells| {
        row.cells.last() == rows[0].cells.last()
            && row
                .cells
                .last()
                .is_none_or(|cell| cell.is_empty() || rows.len() > 1 && is_word(cell))
    };
    if extra == 1 && rows.iter().all(last) {
        return Some(([names, vec![String::new()]].concat(), 1));
    }
    // Rates without names are the columns whose first cell is missing.
    let missing = |at: &usize| rows[0].cells.get(*at).is_some_and(|cell| is_missing(cell));
    let rates: Vec<usize> = (0..width).filter(missing).collect();
    // Beside a column of row numbers the last may have one.
    let numbered =
        || extra == 1 && is_index(rows) && names.last().is_some_and(|name| is_rate(name));
    if rates.len() == extra && rows.len() > 1 && !(rates == [width - 1] && numbered()) {
        let mut names = names.into_iter();
        let name = |at: usize| match rates.contains(&at) {
            true => Some("rate".to_owned()),
            false => names.next(),
        };
        return (0..width).map(name).collect::<Option<_>>().map(|names| (names, 1));
    }
    let norms = names.iter().filter(|name| is_norm(name)).count();
    if norms > 0 && extra.is_multiple_of(norms) {
        let behind = |name: &String| if is_norm(name) { extra / norms } else { 0 };
        let with: Vec<String> = names
            .iter()
            .flat_map(|name| {
                let rates = std::iter::repeat_n("rate".to_owned(), behind(name));
                std::iter::once(name.clone()).chain(rates)
            })
            .collect();
        // The coarsest level has no rate; what has a number there is none.
        let first = &rows[0].cells;
        let no_rate = |cell: &String| {
            is_missing_or_zero(cell) || number(cell).is_some_and(|n| n.value.is_nan())
        };
        let open = |at: usize| with[at] != "rate" || first.get(at).is_some_and(no_rate);
        let short = first.len() + extra == width;
        if short || first.len() == width && (0..width).all(open) {
            return Some((with, 1));
        }
    }
    (extra == 1 && is_index(rows)).then(|| ([vec![String::new()], names].concat(), 1))
}

/// Whether the first cells are words, or count 0, 1, 2 or 1, 2, 3, before numbers.
fn is_index(rows: &[Cells]) -> bool {
    if rows.iter().any(|row| row.cells.iter().skip(1).any(|cell| is_word(cell))) {
        return false;
    }
    let first = |row: &Cells| row.cells.first().map(|cell| cell.trim_end_matches(':').to_owned());
    let counted = |at: usize, row: &Cells, from: usize| {
        first(row).is_some_and(|cell| cell.parse() == Ok(at + from))
    };
    // `25  0` of `25  0,004` is no name.
    let word = |cell: String| cell.split(' ').next().is_some_and(is_word);
    let words = rows.iter().all(|row| first(row).is_some_and(word));
    let counts = |from| rows.iter().enumerate().all(|(at, row)| counted(at, row, from));
    words || counts(0) || counts(1)
}

/// Names that stand twice below `k = 1` and `k = 2`, which span columns: the first of them is of the first.
fn below_spanning(above: &[String], below: &[String], width: usize) -> Option<Vec<String>> {
    // What stands above a size, or above nothing, spans nothing.
    let own = |at: usize| {
        above.len() == width && below.get(at).is_some_and(|name| is_size(name) || name.is_empty())
    };
    let over = above.iter().enumerate().filter(|(at, n)| !n.is_empty() && !is_size(n) && !own(*at));
    let over: Vec<&String> = over.map(|(_, name)| name).collect();
    let same =
        |names: &[String], name: &String| names.iter().filter(|other| *other == name).count();
    let spanned = |name: &String| {
        !is_size(name) && !is_rate(name) && !name.is_empty() && same(below, name) == over.len()
    };
    let name = |(at, name): (usize, &String)| match spanned(name) {
        true => format!("{} {name}", over[same(&below[..at], name)]),
        false if name.is_empty() && own(at) => above[at].clone(),
        false => name.clone(),
    };
    let found = below.len() == width && over.len() > 1 && below.iter().any(spanned);
    found.then(|| below.iter().enumerate().map(name).collect())
}

/// `rho` and `error` of two rows of names as `rho`; what stands beside the errors of the lower row is a rate.
fn two_rows(above: &[String], below: &[String], width: usize) -> Option<Vec<String>> {
    let is_error = |name: &String| matches!(normal(name).as_str(), "error" | "err" | "errors");
    let errors = below.iter().filter(|name| is_error(name)).count();
    let others = below
        .iter()
        .filter(|name| !is_error(name))
        .all(|name| !matches!(role(name), Role::Wide | Role::Unknown));
    let sizes = width.checked_sub(below.len())?;
    // One name above a row with a size is a title.
    let title = errors == 1 && sizes == 0 && below.iter().any(|name| is_size(name));
    if errors == 0 || !others || title || above.len() < sizes + errors {
        return None;
    }
    let (front, names) = above.split_at(above.len() - errors);
    // Sizes may stand in either row; `L2 errors` above a row with an index is a title.
    let fits = match sizes {
        0 => front.iter().all(|name| name.is_empty() || is_size(name)),
        _ => front.len() == sizes && !front.iter().any(|name| is_norm(name)),
    };
    if !fits {
        return None;
    }
    let mut next = names.iter();
    let below = below.iter().map(|name| match is_error(name) {
        true => next.next().map_or(String::new(), |name| match is_norm(name) {
            true => name.clone(),
            false => format!("{name} error"),
        }),
        false => name.clone(),
    });
    let front: &[String] = if sizes > 0 { front } else { &[] };
    Some(front.iter().cloned().chain(below).collect())
}
