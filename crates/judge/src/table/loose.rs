//! Tables that stand in no rows: records of a log, lists, sizes across, and a table on its side.

use super::cell::{is_missing, is_norm, is_rate, is_size, number};
use super::text::{BARS, Block, Cells, Kind, Line, Separator, classify, is_rule, is_word};

const MOST_PAIRS: usize = 10_000;

/// Words of a name.
const MOST_WORDS: usize = 12;

/// `name = value` and `name: value` of a line, in order, and `l-2 0.25` for a norm; what stands between is passed over.
fn pairs(line: &str) -> Vec<(String, String)> {
    let bare: String = line.chars().filter(|c| !"{}\"'".contains(*c)).collect();
    let spaced = bare.replace(":=", "=").replace(['=', ':'], " = ").replace([',', ';'], " , ");
    let (mut found, mut name) = (Vec::new(), Vec::new());
    let mut words = spaced.split_whitespace().peekable();
    let value = |word: &str| number(word).is_some() || is_missing(word);
    while let Some(word) = words.next() {
        let named = name.join(" ");
        match word {
            "," => name.clear(),
            "=" => {
                let worded = named.chars().any(char::is_alphabetic);
                if let Some(value) = words.next_if(|word| worded && value(word)) {
                    found.push((named, value.to_owned()));
                }
                name.clear();
            }
            // What stands in brackets after a value is no name.
            _ if word.starts_with('(') && name.is_empty() => {}
            _ if number(word).is_some() && is_norm(&named) => {
                found.push((named, word.to_owned()));
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

/// Records of `name = value`.
pub(super) fn records(text: &str, begins: Records) -> Vec<Block> {
    let lines: Vec<(u64, Vec<(String, String)>)> =
        (1..).zip(text.lines().map(pairs)).filter(|(_, pairs)| !pairs.is_empty()).collect();
    // Names are looked up one by one: a log with more of them is none of a study.
    if lines.iter().map(|(_, pairs)| pairs.len()).sum::<usize>() > MOST_PAIRS {
        return Vec::new();
    }
    let sized = |pairs: &[(String, String)]| pairs.iter().any(|(name, _)| is_size(name));
    let any = lines.iter().any(|(_, pairs)| sized(pairs));
    let mut records: Vec<(u64, Vec<(String, String)>)> = Vec::new();
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
    if records.len() < 2 {
        return Vec::new();
    }
    // A name of one record alone is a heading of the log.
    let mut names: Vec<String> = Vec::new();
    let mut count = std::collections::HashMap::new();
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
    let row = |(line, pairs): &(u64, Vec<(String, String)>)| {
        let value = |name: &String| pairs.iter().find(|(key, _)| key == name);
        let text = |name: &String| value(name).map_or(String::new(), |(_, value)| value.clone());
        Cells { line: *line, cells: names.iter().map(text).collect() }
    };
    let there = |row: &Cells| row.cells.iter().any(|cell| !cell.is_empty());
    let rows: Vec<Cells> = records.iter().map(row).filter(there).collect();
    let Some(line) = rows.first().map(|row| row.line).filter(|_| !names.is_empty()) else {
        return Vec::new();
    };
    vec![Block { repeated, ..Block::of_rows(line, names, rows) }]
}

/// `h = [0.5, 0.25]` and the like, as Python, Julia and MATLAB write lists: columns of equal length.
pub(super) fn arrays(text: &str) -> Vec<Block> {
    let mut columns: Vec<(usize, String, Vec<String>)> = Vec::new();
    for (open, _) in text.match_indices('[') {
        let Some(close) = text[open + 1..].find([']', '[']).map(|at| open + 1 + at) else { break };
        let inside = text[open + 1..close].replace("...", " ").replace([',', ';', '\n', '\t'], " ");
        let cells: Vec<String> = inside.split_whitespace().map(str::to_owned).collect();
        if cells.len() < 2 || !cells.iter().all(|cell| number(cell).is_some()) {
            continue;
        }
        let start = text[..open].rfind(['\n', ',', '{', ']', ';']).map_or(0, |at| at + 1);
        let before = &text[start..open];
        let Some((name, _)) = before.rsplit_once(['=', ':']) else { continue };
        let name = name.trim_matches(|c: char| c.is_whitespace() || "\"':".contains(c));
        if is_rate(name) {
            continue;
        }
        columns.push((
            open,
            name.rsplit_once(' ').map_or(name, |(_, last)| last).to_owned(),
            cells,
        ));
    }
    let Some((open, _, first)) = columns.first() else { return Vec::new() };
    let (line, count) = (1 + text[..*open].matches('\n').count() as u64, first.len());
    if columns.iter().any(|(.., cells)| cells.len() != count) {
        return Vec::new();
    }
    let names = columns.iter().map(|(_, name, _)| name.clone()).collect();
    let row =
        |at: usize| Cells { line, cells: columns.iter().map(|(.., c)| c[at].clone()).collect() };
    let rows = (0..count).map(row).collect();
    vec![Block::of_rows(line, names, rows)]
}

/// A table on its side: every line is a name and its numbers.
pub(super) fn lying(text: &str) -> Vec<Block> {
    let separator = [
        ('|', Separator::Pipe),
        ('\t', Separator::Character('\t')),
        (';', Separator::Character(';')),
        (',', Separator::Character(',')),
    ];
    let separator =
        separator.iter().find(|(c, _)| text.contains(*c)).map_or(Separator::Blanks, |s| s.1);
    let mut lines: Vec<Line> = classify(text, separator);
    lines.retain(|line| line.kind != Kind::Gap);
    let Some(width) = lines.iter().map(|line| line.cells.len()).max() else { return Vec::new() };
    let named = |line: &Line| {
        let sound = |cell: &String| !is_word(cell);
        let split = line.cells.split_first();
        line.cells.len() == width
            && split.is_some_and(|(name, cells)| is_word(name) && cells.iter().all(sound))
    };
    if lines.iter().any(|line| line.kind == Kind::Row && !named(line)) {
        return Vec::new();
    }
    lines.retain(named);
    if lines.len() < 2 || width < 3 {
        return Vec::new();
    }
    let line = lines[0].number;
    let names = lines.iter().map(|line| line.cells[0].clone()).collect();
    let row = |at: usize| Cells {
        line,
        cells: lines.iter().map(|line| line.cells[at].clone()).collect(),
    };
    let rows = (1..width).map(row).collect();
    vec![Block::of_rows(line, names, rows)]
}

/// Sizes across, `h = 1/2   h = 1/4`, above rows that begin with what they are.
pub(super) fn across(text: &str) -> Vec<Block> {
    let lines: Vec<&str> = text.lines().collect();
    for (at, line) in lines.iter().enumerate().filter(|(_, line)| line.contains('=')) {
        let sizes = pairs(line);
        let name = |pair: &(String, String)| {
            pair.0.trim_matches(|c: char| !c.is_alphanumeric()).to_owned()
        };
        let Some(size) = sizes.first().map(name).filter(|size| is_size(size)) else { continue };
        if sizes.len() < 2 || sizes.iter().any(|pair| name(pair) != size) {
            continue;
        }
        let row = |line: &&str| -> Option<(String, Vec<String>)> {
            let words: Vec<String> =
                line.replace(BARS, " ").split_whitespace().map(str::to_owned).collect();
            let (label, values) = words.split_at_checked(words.len().checked_sub(sizes.len())?)?;
            let sound = !label.is_empty() && values.iter().all(|value| number(value).is_some());
            sound.then(|| (format!("error of {}", label.join(" ")), values.to_vec()))
        };
        let below = lines[at + 1..].iter().filter(|line| !is_rule(line));
        let (names, columns): (Vec<String>, Vec<Vec<String>>) = below.map_while(row).unzip();
        let cells = |row: usize| {
            let values = columns.iter().map(|column| column[row].clone());
            Cells {
                line: at as u64 + 1,
                cells: std::iter::once(sizes[row].1.clone()).chain(values).collect(),
            }
        };
        if !names.is_empty() {
            let rows = (0..sizes.len()).map(cells).collect();
            return vec![Block::of_rows(at as u64 + 1, [vec![size], names].concat(), rows)];
        }
    }
    Vec::new()
}
