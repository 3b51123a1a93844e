//! Tables that stand in no plain rows: records of a log, and columns below a rule.

use std::cell::OnceCell;
use std::collections::HashMap;
use std::ops::Deref;

use super::cell::{Measure, Role, is_missing, is_norm, is_size, is_solver, number, role};
use super::line::{Block, Cells};

const MOST_PAIRS: usize = 10_000;

/// Words of a name.
const MOST_WORDS: usize = 12;

/// The name of a number that has none, behind a size.
const BEHIND: &str = "number behind";

/// Comma and semicolon within a name.
const JOINED: [&str; 2] = ["\u{e000}", "\u{e001}"];

/// `name = value` and `name: value` of a line, in order, and `l-2 0.25` for a norm; what stands between is passed over.
fn pairs(line: &str) -> Vec<(String, String)> {
    let each = each(line);
    let line = each.as_deref().unwrap_or(line);
    // `L2(0,T;L2)` is one name, `(h=1, e=2)` are two.
    let mut parts: Vec<String> = line.split_inclusive(')').map(str::to_owned).collect();
    for part in parts.iter_mut().filter(|part| part.ends_with(')')) {
        let Some(inside) = part.rfind('(').map(|at| part.split_off(at)) else { continue };
        *part += &match inside.contains(['=', ':']) {
            true => inside.replace(['(', ')'], " "),
            false => inside.replace(',', JOINED[0]).replace(';', JOINED[1]),
        };
    }
    // A list of records.
    for (outer, inner) in [("[ ", " "), ("[{", "{"), ("}]", "}"), (" ]", " ")] {
        parts.iter_mut().for_each(|part| *part = part.replace(outer, inner));
    }
    let bare: String = parts.concat().chars().filter(|c| !"{}\"'".contains(*c)).collect();
    let spaced = bare
        .replace(":=", "=")
        .replace("::", " , ")
        .replace(['=', ':'], " = ")
        .replace([',', ';'], " , ")
        .replace(" %", "%");
    let (mut found, mut name): (Vec<(String, String)>, Vec<&str>) = (Vec::new(), Vec::new());
    let mut words = spaced.split_whitespace().peekable();
    let value = |word: &str| number(word).is_some() || is_missing(word);
    // Three numbers and more are a list.
    let listed = |words: &mut std::iter::Peekable<std::str::SplitWhitespace>| {
        let more = words.clone().take_while(|word| number(word).is_some()).count();
        more > 1 && words.nth(more - 1).is_some()
    };
    // `122 elements` has its name behind.
    let count = |word: Option<&&str>| {
        let word = word.map(|word| word.trim_matches(['(', ')', '.']));
        let counts = |word: &&str| role(word).size().is_some_and(|(of, _)| of != Measure::Length);
        // A number is looked at no further: lines hold many.
        let named = |word: &&str| word.len() > 2 && word.starts_with(char::is_alphabetic);
        word.filter(named).filter(counts).map(str::to_owned)
    };
    // `L2 error with N = 16: 0.05` is a size, and an error before and behind it.
    let mut error_of: Option<String> = None;
    while let Some(word) = words.next() {
        // `test_order[2] n = 16`.
        let from = name.iter().rposition(|word| word.contains('[')).map_or(0, |at| at + 1);
        let from = from.min(name.len().saturating_sub(1));
        let named = name[from..].join(" ").replace(JOINED[0], ",").replace(JOINED[1], ";");
        // A sentence may end with a number.
        let bare = word.trim_end_matches('.');
        let word = if number(bare).is_some() { bare } else { word };
        // A mark of a list may touch a mesh.
        let word = word.strip_prefix('-').filter(|mesh| mesh.contains(['x', '×'])).unwrap_or(word);
        match word {
            "," => name.clear(),
            "=" => {
                let named = error_of.take().filter(|_| name.is_empty()).unwrap_or(named);
                // `L2error 0 = 0.05` counts its errors.
                let named = match named.rsplit_once(' ') {
                    Some((of, count)) if is_norm(of) && value(count) => of.to_owned(),
                    _ => named,
                };
                // What stands behind a size without a name: `n = 8: 0.1`.
                let bare = name.is_empty() && found.last().is_some_and(|(name, _)| is_size(name));
                let named = if named.is_empty() && bare { BEHIND.into() } else { named };
                let worded = named.chars().any(char::is_alphabetic);
                if let Some(value) = words.next_if(|word| worded && value(word))
                    && !listed(&mut words)
                {
                    let (named, error) = split(named);
                    (error_of, _) = (error, found.push((named, value.to_owned())));
                }
                name.clear();
            }
            // What stands in brackets after a value is no name, nor is a mark of a list.
            _ if name.is_empty() && (word.starts_with('(') || word == "|" || is_mark(word)) => {}
            // `N=16 1.4e-2`.
            _ if name.is_empty()
                && error_of.is_none()
                && number(word).is_some()
                && found.last().is_some_and(|(name, _)| is_size(name))
                && words.peek().is_none() =>
            {
                found.push((BEHIND.into(), word.to_owned()));
            }
            "is" | "was" if error_of.is_some() && name.is_empty() => {}
            _ if number(word).is_some() && count(words.peek()).is_some() && !is_solver(&named) => {
                found.extend(count(words.peek()).map(|name| (name, word.to_owned())));
                words.next();
                name.clear();
            }
            // `13.6% error for df/du`.
            _ if words.peek().is_some_and(|next| matches!(*next, "error" | "errors"))
                && number(word).is_some()
                && !is_norm(&named) =>
            {
                let of: Vec<&str> =
                    words.clone().take_while(|w| *w != "," && number(w).is_none()).collect();
                words.nth(of.len() - 1);
                found.push((of[..of.len().min(MOST_WORDS)].join(" "), word.to_owned()));
                name.clear();
            }
            // A row of numbers names nothing.
            _ if number(word).is_some()
                && (words.peek() != Some(&"=") || !is_norm(&named))
                && (!name.iter().all(|word| value(word))
                    && (is_norm(&named) || is_size(&named))
                    || name.is_empty() && error_of.is_some()) =>
            {
                let named = error_of.take().filter(|_| name.is_empty()).unwrap_or(named);
                let (named, error) = split(named);
                error_of = error;
                if !listed(&mut words) {
                    found.push((named, word.to_owned()));
                }
                name.clear();
            }
            _ => {
                name.push(word);
                // More words are prose.
                name.drain(..name.len().saturating_sub(MOST_WORDS));
            }
        }
    }
    found
}

/// `(N, dt) = (16, 0.01)` as `N = 16 , dt = 0.01`.
fn each(line: &str) -> Option<String> {
    let (before, (names, rest)) =
        line.split_once('(').and_then(|(b, r)| Some((b, r.split_once(')')?)))?;
    let values = rest.trim_start().strip_prefix('=')?.trim_start().strip_prefix('(')?;
    let (values, behind) = values.split_once(')')?;
    let alike = names.matches(',').count() == values.matches(',').count();
    let pairs =
        names.split(',').zip(values.split(',')).map(|(name, value)| format!("{name}={value} , "));
    alike.then(|| format!("{before} {}{behind}", pairs.collect::<String>()))
}

/// Records of names in brackets, each line with as many numbers behind them: `(N, error) 16 0.01`.
pub(super) fn tupled(text: &str) -> Vec<Block> {
    let record = |line: &str| {
        let (names, values) = line.trim_start().strip_prefix('(')?.split_once(')')?;
        let values: Vec<&str> = values.split_whitespace().collect();
        let alike = values.len() > 1
            && values.len() == names.split(',').count()
            && values.iter().all(|word| number(word).is_some());
        let pairs = names.split(',').zip(values).map(|(name, value)| format!("{name}={value} , "));
        alike.then(|| pairs.collect::<String>())
    };
    let lines: Vec<String> = text.lines().map(|line| record(line).unwrap_or_default()).collect();
    records(&Text::of(lines.join("\n")), Records::Lines)
}

fn is_mark(word: &str) -> bool {
    !word.contains('|') && !word.chars().any(|c| c.is_alphanumeric() || c == '‖')
}

/// `L2 error with N` before `= 16: 0.05` or `= 16 is 0.05` as the size and the error.
fn split(named: String) -> (String, Option<String>) {
    match named.rsplit_once(' ').filter(|(error, size)| is_norm(error) && is_size(size)) {
        Some((error, size)) => {
            let error =
                ["at", "with", "for"].iter().fold(error, |e, word| e.trim_end_matches(word));
            (size.to_owned(), Some(error.trim().to_owned()))
        }
        None => (named, None),
    }
}

/// A line, and the names and values from there on.
type Record = (u64, Vec<(String, String)>);

/// A text with the names and values of its lines, which are looked for when they are first asked for, and once.
pub(super) struct Text {
    text: String,
    paired: OnceCell<Vec<Record>>,
}

impl Text {
    pub(super) fn of(text: String) -> Self {
        Self { text, paired: OnceCell::new() }
    }
}

impl Deref for Text {
    type Target = str;

    fn deref(&self) -> &str {
        &self.text
    }
}

/// Where a record of a log begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Records {
    /// A line with several names is one, with a size if any line has one.
    Lines,
    /// Where a size comes again.
    BySize,
    /// Where any name comes again.
    InTurn,
}

/// Records of `name = value`, below each heading of Markdown on their own if there are several.
pub(super) fn records(text: &Text, begins: Records) -> Vec<Block> {
    let paired = || (1..).zip(text.lines()).map(|(line, text)| (line, pairs(text))).collect();
    let lines: Vec<(&Record, &str)> =
        text.paired.get_or_init(paired).iter().zip(text.lines()).collect();
    let heading = |((_, pairs), line): &(&Record, &str)| {
        line.starts_with('#')
            || line.trim_end().ends_with(':') && pairs.is_empty()
            || pairs.len() == 1 && role(&pairs[0].0) == Role::Parameter
    };
    let below = || lines.chunk_by(|_, next| !heading(next));
    let several = lines.iter().skip(1).any(heading);
    let headed = below().filter(|_| several).filter_map(|lines| {
        let title = lines[0].1.trim().trim_matches(['#', ':']).trim().to_owned();
        records_of(lines, begins).map(|block| Block { title, ..block })
    });
    let headed: Vec<Block> = headed.collect();
    // No level below one of them may be lost.
    let sized = |lines: &&[(&Record, &str)]| {
        lines.iter().any(|((_, pairs), _)| pairs.iter().any(|(name, _)| is_size(name)))
    };
    match headed.len() > 1 && below().filter(sized).count() == headed.len() {
        true => headed,
        false => records_of(&lines, begins).into_iter().flat_map(apart).collect(),
    }
}

/// Lines that follow one another, and begin with one size each time, are tables of their own.
fn apart(block: Block) -> Vec<Block> {
    let Some(size) = block.names.iter().position(|name| is_size(name)) else { return vec![block] };
    let first = &block.rows[0].cells[size];
    let goes_on =
        |one: &Cells, next: &Cells| next.line == one.line + 1 || next.cells[size] != *first;
    let parts: Vec<&[Cells]> = block.rows.chunk_by(goes_on).collect();
    let close = |rows: &&[Cells]| {
        rows.len() > 2 && rows.windows(2).all(|pair| pair[1].line == pair[0].line + 1)
    };
    if parts.len() < 2 || !parts.iter().all(close) {
        return vec![block];
    }
    let table = |rows: &[Cells]| Block {
        line: rows[0].line,
        end: rows[rows.len() - 1].line,
        rows: rows.to_vec(),
        ..block.clone()
    };
    parts.into_iter().map(table).collect()
}

/// The norms and the rates of a level may stand in lines of their own, which name its sizes again.
fn joined(records: Vec<Record>) -> Vec<Record> {
    let mut joined: Vec<Record> = Vec::new();
    let mut places = HashMap::new();
    for (line, mut pairs) in records {
        let sizes: Vec<_> = pairs.iter().filter(|(name, _)| is_size(name)).cloned().collect();
        let place = *places.entry(sizes.clone()).or_insert(joined.len());
        let known = joined.get_mut(place).filter(|_| !sizes.is_empty());
        let other = |known: &Record| {
            let before = |name: &String| known.1.iter().find(|(known, _)| known == name);
            let same = |pair: &(String, String)| before(&pair.0).is_none_or(|known| known == pair);
            pairs.iter().all(same) && pairs.iter().any(|(name, _)| before(name).is_none())
        };
        match known.filter(|known| other(known)) {
            Some((_, known)) => {
                pairs.retain(|pair| !known.contains(pair));
                known.extend(pairs);
            }
            None => {
                places.insert(sizes, joined.len());
                joined.push((line, pairs));
            }
        }
    }
    joined
}

fn records_of(lines: &[(&Record, &str)], begins: Records) -> Option<Block> {
    let paired = lines.iter().map(|(record, _)| *record);
    let lines: Vec<Record> = paired.filter(|(_, pairs)| !pairs.is_empty()).cloned().collect();
    // Names are looked up one by one: a log with more of them is none of a study.
    if lines.iter().map(|(_, pairs)| pairs.len()).sum::<usize>() > MOST_PAIRS {
        return None;
    }
    let sized = |pairs: &[(String, String)]| pairs.iter().any(|(name, _)| is_size(name));
    // `(h = 1/32, 1/64)` in one line is a remark.
    let any = lines.iter().filter(|(_, pairs)| sized(pairs)).count() > 1;
    let mut records: Vec<Record> = Vec::new();
    for (line, pairs) in lines {
        if begins == Records::Lines {
            if pairs.len() > 1 && sized(&pairs) == any {
                records.push((line, pairs));
            }
            continue;
        }
        for (name, value) in pairs {
            let again = records.last().is_none_or(|(_, known)| known.iter().any(|k| k.0 == name));
            let first = records.is_empty() || begins == Records::InTurn || is_size(&name);
            if again && first {
                records.push((line, Vec::new()));
            }
            if let Some((_, pairs)) = records.last_mut() {
                pairs.push((name, value));
            }
        }
    }
    let end = records.last().map_or(0, |(line, _)| *line);
    let records = joined(records);
    if records.len() < 2 {
        return None;
    }
    // A name of one record alone is a heading of the log.
    let mut names: Vec<String> = Vec::new();
    let mut count = HashMap::new();
    let mut repeated = Vec::new();
    for (_, pairs) in &records {
        for (at, (name, _)) in pairs.iter().enumerate() {
            if pairs[..at].iter().any(|(known, _)| known == name) {
                repeated.push(name.clone());
            } else if *count.entry(name.clone()).and_modify(|n| *n += 1).or_insert(1) == 1 {
                names.push(name.clone());
            }
        }
    }
    names.retain(|name| 2 * count[name] > records.len() && !repeated.contains(name));
    repeated.sort();
    repeated.dedup();
    let row = |(line, pairs): &Record| {
        let value = |name: &String| pairs.iter().find(|(key, _)| key == name);
        let text = |name: &String| value(name).map_or(String::new(), |(_, value)| value.clone());
        Cells { line: *line, cells: names.iter().map(text).collect() }
    };
    let there = |row: &Cells| row.cells.iter().any(|cell| !cell.is_empty());
    let rows: Vec<Cells> = records.iter().map(row).filter(there).collect();
    let line = rows.first().map(|row| row.line).filter(|_| !names.is_empty())?;
    Some(Block { repeated, end, ..Block::of_rows(line, names, rows) })
}

/// Rows below a rule of dashes with gaps, `----  ----`, which says where each column stands: cells may be empty there.
pub(super) fn ruled(text: &str) -> Vec<Block> {
    let lines: Vec<Vec<char>> =
        text.lines().map(|line| line.trim_end().chars().collect()).collect();
    let mut found = Vec::new();
    for (at, rule) in lines.iter().enumerate().filter(|(_, rule)| rule.contains(&' ')) {
        let drawn = |c: &char| "-= ".contains(*c);
        let blank = |before: usize| before == 0 || rule[before - 1] == ' ';
        let starts: Vec<usize> =
            (0..rule.len()).filter(|&place| rule[place] != ' ' && blank(place)).collect();
        if at == 0 || starts.len() < 2 || !rule.iter().all(drawn) {
            continue;
        }
        let ends = starts[1..].iter().copied().chain([usize::MAX]);
        let columns: Vec<(usize, usize)> = starts.iter().copied().zip(ends).collect();
        let cells = |line: &Vec<char>| -> Option<Vec<String>> {
            let parted =
                starts.iter().all(|&at| at == 0 || line.get(at - 1).is_none_or(|c| *c == ' '));
            let cell = |&(start, end): &(usize, usize)| {
                let length = end.min(line.len()).saturating_sub(start);
                let cell: String = line.iter().skip(start).take(length).collect();
                cell.split_whitespace().collect::<Vec<_>>().join(" ")
            };
            (parted && !line.is_empty()).then(|| columns.iter().map(cell).collect())
        };
        let Some(names) = cells(&lines[at - 1]) else { continue };
        let below = lines.iter().enumerate().skip(at + 1);
        let row = |(at, line): (usize, &Vec<char>)| {
            let cells = cells(line).filter(|cells| cells.iter().any(|c| number(c).is_some()))?;
            Some(Cells { line: at as u64 + 1, cells })
        };
        let rows: Vec<Cells> = below.map_while(row).collect();
        // Where no cell is empty and no name has two words, blanks part them.
        let empty = |row: &Cells| row.cells.iter().any(String::is_empty);
        let spaced = names.iter().any(|name| name.contains(' ')) && !names.contains(&String::new());
        if rows.iter().any(empty) || spaced && rows.len() > 1 {
            let above = lines[..at - 1].iter().rev().find(|line| !line.is_empty());
            let title = above.map_or(String::new(), |line| line.iter().collect());
            found.push(Block { title, ..Block::of_rows(at as u64, names, rows) });
        }
    }
    found
}
