//! Finds the tables of a text: lines are classified, rows that agree make a block, the line above names its columns.

use super::cell::{Role, is_missing, is_norm, is_rate, is_size, normal, number, role};
use super::loose::{self, Records};

/// A row, cut into cells.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Cells {
    pub(super) line: u64,
    pub(super) cells: Vec<String>,
}

/// Rows that agree, with the names of their columns.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Block {
    /// The line above the names, which tells tables of one text apart.
    pub(super) title: String,
    /// The line of the names, and the last line.
    pub(super) line: u64,
    pub(super) end: u64,
    pub(super) names: Vec<String>,
    pub(super) rows: Vec<Cells>,
    /// Lines between the rows that are none: means, column types.
    pub(super) left_out: Vec<u64>,
    /// Several values of a name in one record: none of them is read.
    pub(super) repeated: Vec<String>,
}

impl Block {
    /// Rows below no title, with nothing between them.
    pub(super) fn of_rows(line: u64, names: Vec<String>, rows: Vec<Cells>) -> Self {
        let (left_out, repeated) = (Vec::new(), Vec::new());
        let end = rows.last().map_or(line, |row| row.line);
        Self { title: String::new(), line, end, names, rows, left_out, repeated }
    }

    /// Columns of equal length with their names.
    pub(super) fn of_columns(line: u64, end: u64, columns: Vec<(String, Vec<String>)>) -> Self {
        let count = columns.first().map_or(0, |(_, cells)| cells.len());
        let cells = |at: usize| columns.iter().map(|(_, cells)| cells[at].clone()).collect();
        let rows = (0..count).map(|at| Cells { line, cells: cells(at) }).collect();
        let names = columns.iter().map(|(name, _)| name.clone()).collect();
        Self { end, ..Self::of_rows(line, names, rows) }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Separator {
    Latex,
    Pipe,
    Character(char),
    Blanks,
}

impl Separator {
    pub(super) const ALL: [Self; 6] = [
        Self::Latex,
        Self::Pipe,
        Self::Character('\t'),
        Self::Character(';'),
        Self::Character(','),
        Self::Blanks,
    ];

    pub(super) fn is_in(self, text: &str) -> bool {
        match self {
            Self::Latex => text.contains(" & ") || text.contains('&') && text.contains('\\'),
            Self::Pipe => text.contains(BARS),
            Self::Character(c) => text.contains(c),
            Self::Blanks => true,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// Blank, or a drawn rule.
    Gap,
    Comment,
    Text,
    Row,
}

/// The ways to cut a text into blocks.
const WAYS: [fn(&str) -> Vec<Block>; 14] = [
    loose::arrays,
    loose::assigned,
    loose::across,
    |text| blocks(text, Separator::Latex),
    |text| blocks(text, Separator::Pipe),
    |text| blocks(text, Separator::Character('\t')),
    |text| blocks(text, Separator::Character(';')),
    |text| blocks(text, Separator::Character(',')),
    loose::ruled,
    |text| blocks(text, Separator::Blanks),
    |text| loose::records(text, Records::Lines),
    |text| loose::records(text, Records::BySize),
    |text| loose::records(text, Records::InTurn),
    loose::lying,
];

/// A longer line is no row that somebody set.
const LONGEST: usize = 10_000;

pub(super) const BARS: [char; 2] = ['|', '\u{2502}'];

pub(super) struct Line<'a> {
    pub(super) number: u64,
    text: &'a str,
    pub(super) cells: Vec<String>,
    pub(super) kind: Kind,
}

impl Line<'_> {
    fn bare(&self) -> &str {
        self.text.trim().trim_start_matches(['#', '%']).trim()
    }

    /// The names above `width` columns; `#` may be one of a column that counts.
    fn names(&self, separator: Separator, width: usize) -> Vec<String> {
        match self.kind {
            Kind::Comment if self.cells.len() != width || self.cells[0] != "#" => {
                cut(self.bare(), separator)
            }
            _ => self.cells.clone(),
        }
    }
}

/// The blocks by every way to cut the text, each as a list: the first with a table in it is meant. What nothing is found in is
/// read once more without the signs of comments, quotations and changes before its lines.
pub(super) fn readings(text: &str) -> impl Iterator<Item = Vec<Block>> {
    let text = plain(text);
    let signed = text.clone();
    let bare = std::iter::once_with(move || {
        let bare = signed.lines().map(uncommented).collect::<Vec<_>>().join("\n");
        (bare != signed).then_some(bare)
    });
    let texts = std::iter::once(text).chain(bare.flatten());
    texts.flat_map(|text| WAYS.iter().map(move |way| way(&text)))
}

/// The text with cells of one row in one line, and numbers as programs write them: `1.2×10⁻³` for `1.2\times 10^{-3}`.
fn plain(text: &str) -> String {
    let (html, list) = (text.contains("<td"), text.contains("* - "));
    let mut out: Vec<String> = Vec::new();
    // The line on which the row begins whose cells are read.
    let mut row = None;
    for line in text.split('\n') {
        let bare = line.trim();
        let cell = bare.strip_prefix("- ").or((bare == "-").then_some(""));
        match (row, cell) {
            _ if html && (row.is_some() || bare.contains("<tr")) => {
                let at = *row.get_or_insert(out.len());
                out.resize(out.len() + 1, String::new());
                out[at] += &untagged(bare);
                row = row.filter(|_| !bare.contains("</tr"));
            }
            _ if html => out.push(untagged(line)),
            _ if list && bare.starts_with("* - ") => {
                row = Some(out.len());
                out.push(typed(&bare[4..]));
            }
            (Some(at), Some(cell)) => {
                out[at] += &format!("\t{}", typed(cell.trim()));
                out.push(String::new());
            }
            _ => {
                row = None;
                out.push(typed(line));
            }
        }
    }
    out.join("\n")
}

/// A line of HTML, its cells parted by tabs.
fn untagged(line: &str) -> String {
    let (mut out, mut rest) = (String::new(), line);
    while let Some((before, behind)) = rest.split_once('<') {
        out += before;
        let Some((tag, behind)) = behind.split_once('>') else { break };
        out += if tag == "/td" || tag == "/th" { "\t" } else { "" };
        rest = behind;
    }
    typed(&(out + rest).replace("&nbsp;", " "))
}

fn uncommented(line: &str) -> &str {
    let bare = line.trim_start_matches(|c: char| "%#>!/".contains(c) || c.is_whitespace());
    bare.strip_prefix("+ ")
        .or(bare.strip_prefix('+').filter(|b| b.starts_with('|')))
        .unwrap_or(bare)
}

/// Powers of ten as typeset, without blanks.
fn typed(line: &str) -> String {
    let marks = [" x ", "\\times", "\\cdot", "* 10^", ":math:"];
    let plain = line.is_ascii() && !marks.iter().any(|mark| line.contains(mark));
    if plain || line.len() > LONGEST {
        return line.into();
    }
    let (mut out, mut raised) = (String::new(), false);
    for c in line.chars() {
        let digit = "⁰¹²³⁴⁵⁶⁷⁸⁹⁻".chars().position(|raised| raised == c);
        if digit.is_some() && !raised && out.ends_with(|c: char| c.is_ascii_digit()) {
            out.push('^');
        }
        out.push(digit.map_or(c, |at| char::from(b"0123456789-"[at])));
        raised = digit.is_some();
    }
    for times in ["\\times", "\\cdot", "· 10", "·10"] {
        out = out.replace(times, if times.ends_with('0') { "×10" } else { "×" });
    }
    out = out.replace(":math:", "");
    for times in ["×", " x ", " * 10^"] {
        let joined = times.trim();
        for (a, b) in [(" ", " "), (" ", ""), ("", " ")] {
            let digit = |c: Option<char>| c.is_some_and(|c| c.is_ascii_digit() || c == '.');
            let wide = format!("{a}{joined}{b}");
            while let Some(at) = out.find(&wide).filter(|&at| {
                digit(out[..at].chars().next_back()) && digit(out[at + wide.len()..].chars().next())
            }) {
                out.replace_range(at..at + wide.len(), joined);
            }
        }
    }
    out
}

pub(super) fn is_rule(text: &str) -> bool {
    let drawn = |c: char| "-+|=:_#*~. \t".contains(c) || ('\u{2500}'..='\u{257f}').contains(&c);
    let latex = [
        "\\begin",
        "\\end",
        "\\hline",
        "\\toprule",
        "\\midrule",
        "\\bottomrule",
        "\\cline",
        "\\cmidrule",
    ];
    let text = text.trim();
    let bare = latex.iter().any(|rule| text.starts_with(rule)) && !text.contains('&');
    bare || text.chars().all(drawn) && text.chars().filter(|&c| !" \t".contains(c)).count() > 2
}

fn cut(text: &str, separator: Separator) -> Vec<String> {
    let owned = |cell: &str| cell.trim().trim_matches('"').trim().to_owned();
    match separator {
        Separator::Latex => {
            let row = text.split("\\\\").next().unwrap_or_default().replace("\\hline", "");
            row.split('&').map(|cell| owned(&cell.replace(['$', '~'], ""))).collect()
        }
        Separator::Pipe => {
            let text = text.trim();
            let inner = text.strip_prefix(BARS);
            let inner = inner.map_or(text, |inner| inner.strip_suffix(BARS).unwrap_or(inner));
            inner.split(BARS).map(owned).collect()
        }
        Separator::Character(separator) => {
            // A separator between quotes is text.
            let (mut cells, mut start, mut quoted) = (Vec::new(), 0, false);
            for (at, c) in text.char_indices() {
                quoted ^= c == '"';
                if c == separator && !quoted {
                    cells.push(owned(&text[start..at]));
                    start = at + c.len_utf8();
                }
            }
            cells.push(owned(&text[start..]));
            cells
        }
        Separator::Blanks => {
            // A bar that stands alone parts columns; `||u-u_h||` is a name.
            let bare = text.trim().trim_start_matches(BARS).trim_end_matches("\u{2502}");
            let bare = if text.trim().starts_with('|') { bare.trim_end_matches('|') } else { bare };
            bare.split_whitespace()
                .map(|word| owned(word.trim_end_matches([',', ';'])))
                .filter(|word| !word.is_empty() && !BARS.iter().any(|bar| *word == bar.to_string()))
                .collect()
        }
    }
}

pub(super) fn classify(text: &str, separator: Separator) -> Vec<Line<'_>> {
    let mut lines = Vec::new();
    for (at, text) in (1..).zip(text.lines()) {
        let empty = text.trim().trim_matches(BARS).is_empty();
        if empty || is_rule(text) {
            lines.push(Line { number: at, text, cells: Vec::new(), kind: Kind::Gap });
            continue;
        }
        let cells = cut(text, separator);
        let numbers = numbers(&cells);
        let words = cells.iter().filter(|cell| is_word(cell)).count();
        let row = match separator {
            Separator::Blanks => numbers > 0 && numbers >= words,
            _ => numbers > 1 || numbers == 1 && words < 2,
        };
        let kind = match (text.trim_start().starts_with(['#', '%']), row) {
            (true, _) => Kind::Comment,
            (_, true) => Kind::Row,
            _ => Kind::Text,
        };
        lines.push(Line { number: at, text, cells, kind });
    }
    lines
}

fn numbers(cells: &[String]) -> usize {
    cells.iter().filter(|cell| number(cell).is_some()).count()
}

pub(super) fn is_word(cell: &str) -> bool {
    !is_missing(cell) && number(cell).is_none()
}

fn blocks(text: &str, separator: Separator) -> Vec<Block> {
    if !separator.is_in(text) {
        return Vec::new();
    }
    let lines = classify(text, separator);
    let (mut found, mut at) = (Vec::new(), 0);
    while at < lines.len() {
        let first = at;
        at += 1;
        if lines[first].kind != Kind::Row {
            continue;
        }
        // The first row may lack a rate, which needs two.
        let second = lines.get(at).filter(|line| line.kind == Kind::Row);
        let width = lines[first].cells.len().max(second.map_or(0, |line| line.cells.len()));
        let front = lines[first].cells.first().map(|cell| is_word(cell));
        let (mut rows, mut left_out, mut gap) = (vec![first], Vec::new(), false);
        while at < lines.len() {
            let line = &lines[at];
            let same = line.cells.len() == width;
            let begins = line.cells.first().map(|cell| is_word(cell));
            let alike = begins == front;
            match line.kind {
                Kind::Gap => gap = true,
                Kind::Comment => {
                    let names = line.names(separator, width);
                    if names.len() == width && names.iter().any(|name| is_size(name)) {
                        break;
                    }
                    // A row that somebody has taken out.
                    left_out.extend((numbers(&names) > 1).then_some(line.number));
                }
                // `EOC  h  L2` are the names of another table.
                _ if begins == Some(true)
                    && !alike
                    && is_summary(line.text)
                    && !line.cells.iter().any(|cell| is_size(cell)) =>
                {
                    left_out.push(line.number)
                }
                // Where cells are parted by a character, a row is one after a blank line too.
                Kind::Row if same && (alike || separator != Separator::Blanks) => {
                    rows.push(at);
                    gap = false;
                }
                // Ragged or broken rows are refused where they are read.
                Kind::Row if !gap && (same || begins == Some(false)) => rows.push(at),
                Kind::Text if !gap && same && separator != Separator::Blanks => rows.push(at),
                Kind::Text
                    if !gap && separator == Separator::Pipe && line.bare().starts_with('|') =>
                {
                    rows.push(at);
                }
                // So is one that is torn, between rows that are whole.
                _ if !gap && separator != Separator::Blanks && goes_on(&lines, at + 1, width) => {
                    rows.push(at);
                }
                _ => {
                    // A row of too many words is prose, or is torn.
                    let apart = |c: char| c.is_whitespace() || ",;|\"".contains(c);
                    let words = line.text.split(apart).filter(|word| number(word).is_some());
                    let torn = !gap && line.kind == Kind::Text && words.count() > 1;
                    left_out.extend(torn.then_some(line.number));
                    break;
                }
            }
            at += 1;
        }
        let cells = |&at: &usize| Cells { line: lines[at].number, cells: lines[at].cells.clone() };
        let rows = rows.iter().map(cells).collect();
        let block = head(&lines[..first], separator, width, rows, left_out);
        // One column alone is one of errors, or a list of something else.
        let one = |name: &String| is_norm(name) && !name.contains([',', ';', '|', '&', '=']);
        if width > 1 || block.names.first().is_some_and(one) {
            found.push(block);
        }
    }
    // A program that prints names and one row is run again and again.
    let mut joined: Vec<Block> = Vec::new();
    for same in found.chunk_by(|a, b| a.names == b.names && a.rows.len() * b.rows.len() == 1) {
        let rows = same.iter().flat_map(|block| block.rows.clone()).collect();
        joined.push(Block { rows, end: same[same.len() - 1].end, ..same[0].clone() });
    }
    joined
}

fn goes_on(lines: &[Line], at: usize, width: usize) -> bool {
    lines.get(at).is_some_and(|line| line.kind == Kind::Row && line.cells.len() == width)
}

fn is_summary(text: &str) -> bool {
    let word = text.split(|c: char| !c.is_alphanumeric()).find(|word| !word.is_empty());
    let words = "mean average avg overall expected theoretical theory exact fitted order rate eoc asymptotic slope";
    word.is_some_and(|word| words.split(' ').any(|known| word.eq_ignore_ascii_case(known)))
}

/// The block below `above`, with the names that stand there; no names if there are none that fit.
fn head(
    above: &[Line],
    separator: Separator,
    width: usize,
    mut rows: Vec<Cells>,
    mut left_out: Vec<u64>,
) -> Block {
    let mut texts = Vec::new();
    for line in above.iter().rev() {
        match line.kind {
            Kind::Gap => {}
            Kind::Row => break,
            _ if line.cells.iter().all(|cell| cell.is_empty() || is_type(cell)) => {
                left_out.push(line.number);
            }
            _ => texts.push(line),
        }
        if texts.len() == 3 {
            break;
        }
    }
    let words = |line: &Line| line.names(separator, width);
    let line = texts.first().map_or(rows[0].line, |line| line.number);
    let title = |at: usize| texts.get(at).map_or(String::new(), |line| line.bare().to_owned());
    let block = |names, title, rows, left_out| Block {
        title,
        left_out,
        ..Block::of_rows(line, names, rows)
    };
    // `ans =` above a matrix and `error = 0.1` of a log name no columns.
    let assigns = |line: &&&Line| {
        let value = line.text.rsplit_once('=').map(|(_, value)| value.trim());
        value.is_some_and(|value| value.is_empty() || number(value).is_some())
    };
    let Some(first) = texts.first().filter(|line| !assigns(line)) else {
        return block(Vec::new(), String::new(), rows, left_out);
    };
    // Two rows of names: `rho` over `error EOC`.
    if let Some(second) = texts.get(1)
        && let Some(names) = two_rows(&words(second), &words(first), width)
    {
        return block(names, title(2), rows, left_out);
    }
    // pandas prints the name of an index below the others.
    if separator == Separator::Blanks
        && let Some(above) = texts.get(1).map(|second| words(second))
        && above.len() + words(first).len() == width
        && above.iter().any(|name| is_norm(name))
    {
        return block([words(first), above].concat(), title(2), rows, left_out);
    }
    let mut ways = vec![words(first)];
    if separator == Separator::Blanks {
        let groups: Vec<String> = (first.bare().replace('\t', "  ").split("  "))
            .map(|name| name.trim().trim_end_matches([',', ';']).to_owned())
            .filter(|name| !name.is_empty())
            .collect();
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
    let best = fits.min_by_key(|(names, extra)| (unknown(names), *extra));
    let Some((names, _)) = best else {
        return block(ways.swap_remove(0), title(1), rows, left_out);
    };
    // Cells of rates that the first rows lack, each beside its norm or all at the end, or the last row at its end: between whole rows
    // any cell may be the lost one.
    let rates: Vec<usize> = (0..width).filter(|&at| is_rate(&names[at])).collect();
    let rest = |from: usize, unread: fn(&String) -> bool| names[from..].iter().all(unread);
    let first = rows.iter().position(|row| row.cells.len() == width).unwrap_or(0);
    let last = if separator == Separator::Blanks { rows.len() - 1 } else { 0 };
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
    block(names, title(1), rows, left_out)
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
    // A last separator without a cell.
    let last = |row: &Cells| row.cells.last().is_none_or(String::is_empty);
    if extra == 1 && rows.iter().all(last) {
        return Some(([names, vec![String::new()]].concat(), 1));
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
            is_missing(cell) || number(cell).is_some_and(|n| n.value.is_nan() || n.value == 0.0)
        };
        let open = |at: usize| with[at] != "rate" || first.get(at).is_some_and(no_rate);
        let short = first.len() + extra == width;
        if short || first.len() == width && (0..width).all(open) {
            return Some((with, 1));
        }
    }
    (extra == 1 && is_index(rows)).then(|| ([vec![String::new()], names].concat(), 1))
}

/// Whether the names are of a size and of an error, so that the block is a table, sound or not.
pub(super) fn is_table(block: &Block) -> bool {
    block.names.iter().any(|name| is_size(name)) && block.names.iter().any(|name| is_norm(name))
}

/// How many columns have names that say what they are.
pub(super) fn known(block: &Block) -> usize {
    block.names.iter().filter(|name| !matches!(role(name), Role::Unknown | Role::Ignored)).count()
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
