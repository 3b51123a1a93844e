//! Lines of a text, cut into cells.

use super::{TableError, latex};

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Cells {
    pub(super) line: u64,
    pub(super) cells: Vec<String>,
}

pub(super) struct Cut {
    pub(super) header: Cells,
    pub(super) rows: Vec<Cells>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Separator {
    Character(u8),
    Pipe,
    Latex,
    Pairs,
    Blanks,
}

/// Cuts a text into cells; comments and rules are dropped.
///
/// # Errors
/// A text without a header.
pub(super) fn cut(text: &str) -> Result<Cut, TableError> {
    let lines: Vec<(u64, &str)> =
        (1..).zip(text.lines()).filter(|(_, line)| !line.trim().is_empty()).collect();
    let (comments, mut body): (Vec<_>, Vec<_>) =
        lines.into_iter().partition(|(_, line)| is_comment(line));
    let separator = separator(&body);
    if separator == Separator::Latex {
        body.retain(|(_, line)| !latex::is_rule(line));
    }
    body.retain(|(_, line)| !is_rule(line));
    let mut rows = match separator {
        Separator::Character(byte) => csv_rows(text, byte)?,
        _ => body.iter().map(|&(line, text)| plain(separator, line, text)).collect(),
    };
    if separator == Separator::Pairs {
        return pairs(&body);
    }
    let first = rows.first().ok_or_else(|| TableError::at(1, NO_HEADER))?;
    // A header that begins with `#` is the last comment above the numbers.
    let header = if first.cells.iter().all(|cell| is_entry(cell)) {
        let above = comments.iter().rev().find(|(line, _)| *line < first.line);
        let Some(&(line, text)) = above else {
            return Err(TableError::at(first.line, NO_HEADER));
        };
        let text = text.trim_start().trim_start_matches(['#', '%']);
        plain(separator, line, text)
    } else {
        rows.remove(0)
    };
    let header = match (separator, rows.first()) {
        (Separator::Blanks, Some(row)) => spread(header, row.cells.len(), &body, &comments),
        _ => header,
    };
    Ok(Cut { header, rows })
}

const NO_HEADER: &str =
    "no header: the first line names the columns, `h,error` or `h,L2,H1` for example";

fn is_comment(line: &str) -> bool {
    line.trim_start().starts_with(['#', '%'])
}

fn is_rule(line: &str) -> bool {
    let drawn = |c: char| "-+|=:_ \t".contains(c) || ('\u{2500}'..='\u{257f}').contains(&c);
    line.chars().all(drawn) && line.chars().filter(|&c| !" \t".contains(c)).count() > 2
}

fn is_entry(cell: &str) -> bool {
    let cell = cell.trim();
    cell.is_empty()
        || super::number::is_missing(cell)
        || super::number::parse(cell).is_ok()
        || cell.replacen(',', ".", 1).parse::<f64>().is_ok()
}

fn separator(lines: &[(u64, &str)]) -> Separator {
    let drawn: Vec<&str> =
        lines.iter().map(|(_, line)| *line).filter(|line| !is_rule(line)).take(5).collect();
    let any = |what: &str| drawn.iter().any(|line| line.contains(what));
    let all = |what: &str| !drawn.is_empty() && drawn.iter().all(|line| line.contains(what));
    if drawn.first().is_some_and(|line| pair_list(line).is_some()) {
        Separator::Pairs
    } else if any("&") && any("\\") {
        Separator::Latex
    } else if all("|") || all("\u{2502}") {
        Separator::Pipe
    } else if all("\t") {
        Separator::Character(b'\t')
    } else if all(";") {
        Separator::Character(b';')
    } else if drawn.first().is_some_and(|line| line.contains(',') && !has_decimal_comma(line)) {
        Separator::Character(b',')
    } else {
        Separator::Blanks
    }
}

/// Decimal commas in numbers separated by blanks: `0,5 0,25`.
fn has_decimal_comma(line: &str) -> bool {
    let comma = |word: &str| word.replacen(',', ".", 1).parse::<f64>().is_ok();
    line.split_whitespace().count() > 1
        && line.split_whitespace().any(|word| word.contains(',') && comma(word))
}

fn plain(separator: Separator, line: u64, text: &str) -> Cells {
    let owned = |cell: &str| cell.trim().to_owned();
    let cells = match separator {
        Separator::Character(byte) => text.split(char::from(byte)).map(owned).collect(),
        Separator::Pipe => {
            let text = text.trim();
            let bars = ['|', '\u{2502}'];
            let text = text.strip_prefix(bars).unwrap_or(text);
            text.strip_suffix(bars).unwrap_or(text).split(bars).map(owned).collect()
        }
        Separator::Latex => latex::cells(text),
        Separator::Pairs | Separator::Blanks => {
            text.split_whitespace().map(str::to_owned).collect()
        }
    };
    Cells { line, cells }
}

/// Quoted cells may contain separators and line ends; comments are emptied, which keeps line numbers.
fn csv_rows(text: &str, separator: u8) -> Result<Vec<Cells>, TableError> {
    let kept: String = text
        .split_inclusive('\n')
        .map(|line| if is_comment(line) || is_rule(line.trim_end()) { "\n" } else { line })
        .collect();
    let mut reader = csv::ReaderBuilder::new()
        .delimiter(separator)
        .trim(csv::Trim::All)
        .flexible(true)
        .has_headers(false)
        .from_reader(kept.as_bytes());
    let lines: Vec<&str> = kept.lines().collect();
    let mut rows = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|error| TableError::at(1, error.to_string()))?;
        // The reader's position is the end of the previous record: empty lines follow.
        let mut line = record.position().map_or(1, csv::Position::line);
        let empty =
            |line: u64| lines.get(line as usize - 1).is_some_and(|text| text.trim().is_empty());
        while empty(line) {
            line += 1;
        }
        let cells: Vec<String> = record.iter().map(str::to_owned).collect();
        if cells.len() > 1 || cells.iter().any(|cell| !cell.is_empty()) {
            rows.push(Cells { line, cells });
        }
    }
    Ok(rows)
}

/// Matches a blank-separated header to the columns: a name may have several words, separated from the next by two
/// blanks, and an unnamed column after a norm is a rate. Of all readings that fit, the one with the fewest unknown
/// names is taken.
fn spread(header: Cells, wanted: usize, body: &[(u64, &str)], comments: &[(u64, &str)]) -> Cells {
    let is_header = |(line, _): &&(u64, &str)| *line == header.line;
    let text = body.iter().chain(comments).find(is_header).map_or("", |(_, text)| *text);
    let text = text.trim().trim_start_matches(['#', '%']);
    let groups: Vec<String> = text
        .split("  ")
        .map(str::trim)
        .filter(|name| !name.is_empty())
        .map(str::to_owned)
        .collect();
    let counts = |group: &String| group.split_whitespace().all(super::name::is_size_or_counter);
    let split = |group: &String| match counts(group) {
        true => group.split_whitespace().map(str::to_owned).collect(),
        false => vec![group.clone()],
    };
    let parts = groups.iter().flat_map(split).collect();
    let readings = [header.cells.clone(), parts, groups];
    let unknown =
        |names: &Vec<String>| names.iter().filter(|name| super::name::is_unknown(name)).count();
    let fits = readings.into_iter().filter_map(|names| with_rates(names, wanted));
    match fits.min_by_key(|(names, extra)| (unknown(names), *extra > 0)) {
        Some((cells, _)) => Cells { cells, ..header },
        None => header,
    }
}

/// Names with unnamed rate columns inserted to reach the wanted number, and how many were inserted.
fn with_rates(names: Vec<String>, wanted: usize) -> Option<(Vec<String>, usize)> {
    let norms = names.iter().filter(|name| super::name::is_norm(name)).count();
    let extra = wanted.checked_sub(names.len())?;
    if extra == 0 {
        return Some((names, 0));
    }
    if norms == 0 || !extra.is_multiple_of(norms) {
        return None;
    }
    let behind = |name: &String| if super::name::is_norm(name) { extra / norms } else { 0 };
    let cells = names.iter().flat_map(|name| {
        std::iter::once(name.clone()).chain(std::iter::repeat_n("rate".to_owned(), behind(name)))
    });
    Some((cells.collect(), extra))
}

/// `h = 0.25, E = 1e-3` as names and values; none if a part is not such a pair.
fn pair_list(line: &str) -> Option<Vec<(String, String)>> {
    if !line.contains(['=', ':']) {
        return None;
    }
    let spaced = line.replace(['=', ':'], " = ").replace([',', ';'], " ");
    let words: Vec<&str> = spaced.split_whitespace().collect();
    let mut pairs = Vec::new();
    let mut name = Vec::new();
    let mut place = 0;
    while place < words.len() {
        if words[place] != "=" {
            name.push(words[place]);
            place += 1;
            continue;
        }
        let value = *words.get(place + 1)?;
        if name.is_empty() || !is_entry(value) {
            return None;
        }
        pairs.push((name.join(" "), value.to_owned()));
        name.clear();
        place += 2;
    }
    (name.is_empty() && pairs.len() > 1).then_some(pairs)
}

/// Names are those of the line with most pairs: the coarsest mesh has no rate.
fn pairs(body: &[(u64, &str)]) -> Result<Cut, TableError> {
    let mut found = Vec::new();
    for &(line, text) in body {
        let what = format!("`{text}` is no list of `name = value`, which the first line is");
        found.push((line, pair_list(text).ok_or_else(|| TableError::at(line, what))?));
    }
    let longest = found.iter().rev().max_by_key(|(_, pairs)| pairs.len());
    let (line, names) = longest.cloned().ok_or_else(|| TableError::at(1, NO_HEADER))?;
    let names: Vec<String> = names.into_iter().map(|(name, _)| name).collect();
    let row = |(line, pairs): &(u64, Vec<(String, String)>)| {
        let value = |name: &String| pairs.iter().find(|(key, _)| key == name);
        let text = |name: &String| value(name).map_or(String::new(), |(_, value)| value.clone());
        Cells { line: *line, cells: names.iter().map(text).collect() }
    };
    let rows = found.iter().map(row).collect();
    Ok(Cut { header: Cells { line, cells: names }, rows })
}
