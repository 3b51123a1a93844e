//! Lines of a text, made plain and cut into cells; rows that agree make a block.

use std::collections::HashSet;

use super::cell::{is_missing, is_norm, is_rate, is_size, number, sides};

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
    /// What was taken from elsewhere.
    pub(super) notes: Vec<String>,
}

/// Names in a sentence.
pub(super) fn listed(names: impl IntoIterator<Item = impl AsRef<str>>) -> String {
    let names: Vec<String> = names.into_iter().map(|n| format!("`{}`", n.as_ref())).collect();
    let more = names.len().saturating_sub(8);
    let rest = if more > 0 { format!(" and {more} more") } else { String::new() };
    names[..names.len() - more].join(", ") + &rest
}

impl Block {
    /// The name of a column, or what one without a name is called.
    pub(super) fn name(&self, at: usize) -> &str {
        Some(&*self.names[at]).filter(|name| !name.is_empty()).unwrap_or("first column")
    }

    /// Rows below no title, with nothing between them.
    pub(super) fn of_rows(line: u64, names: Vec<String>, rows: Vec<Cells>) -> Self {
        let (left_out, repeated, notes) = (Vec::new(), Vec::new(), Vec::new());
        let end = rows.last().map_or(line, |row| row.line);
        Self { title: String::new(), line, end, names, rows, left_out, repeated, notes }
    }

    /// Cells `h = 0.1` or `mesh 16x16` of a column are numbers; an empty one below the first of several rows is as above.
    pub(super) fn tidied(mut self) -> Self {
        // Blanks that kept columns in their places.
        for name in &mut self.names {
            *name = name.replace("`      ", "`");
        }
        if self.names.is_empty() || self.rows.is_empty() {
            return self;
        }
        // One name above words and meshes is that of the meshes.
        let cells =
            |at| self.rows.iter().map(move |row| row.cells.get(at).map_or("", String::as_str));
        if self.names.len() > 2
            && self.names[1].is_empty()
            && is_size(&self.names[0])
            && cells(0).all(|cell| number(cell).is_none())
            && sides(cells(1)).is_some()
        {
            self.names[1] = self.names[0].clone();
            self.names[0] += " (words)";
        }
        for at in (0..self.names.len()).rev() {
            // `50/9` unknowns are those of two fields.
            let counts = |cell: &String| {
                let (first, second) = cell.split_once('/')?;
                let [one, other] = [first, second].map(|part| number(part.trim()));
                (one?.value > other?.value).then(|| first.trim().to_owned())
            };
            let of_mesh = is_size(&self.names[at]);
            let firsts = self.rows.iter().map(|row| row.cells.get(at).and_then(counts));
            if let Some(firsts) = firsts.collect::<Option<Vec<_>>>().filter(|_| of_mesh) {
                self.rows.iter_mut().zip(firsts).for_each(|(row, first)| row.cells[at] = first);
                self.notes.push(format!("the first of two counts in `{}`", self.names[at]));
            }
            let cells = self.rows.iter().map(|row| row.cells.get(at).map(|cell| phrases(cell)));
            let Some(rows) = cells.collect::<Option<Vec<_>>>() else { continue };
            let count = rows[0].len();
            let equal = |of: fn(&Phrase) -> &str, at: usize| {
                rows.iter().all(|row| of(&row[at]) == of(&rows[0][at]))
            };
            if count == 0 || rows.iter().any(|row| row.len() != count) {
                continue;
            }
            let names = (0..count).map(|place| {
                let name: [fn(&Phrase) -> &str; 2] = [Phrase::last, |p| &p.name];
                let first = &rows[0][place];
                let sized = name.into_iter().find(|of| is_size(of(first)) && equal(*of, place));
                let plain = first.assigned && !first.name.contains([' ', '(']);
                let of = sized.or(name.into_iter().find(|of| plain && equal(*of, place)))?;
                Some(of(first).to_owned())
            });
            let Some(names) = names.collect::<Option<Vec<String>>>() else { continue };
            // `Euler, dt = 0.1`: the words before the name are a column of their own.
            let words = |row: &[Phrase]| {
                row[0]
                    .name
                    .strip_suffix(&*names[0])
                    .map(|w| w.trim_end_matches([' ', ',']).to_owned())
            };
            let worded = rows.iter().any(|row| row[0].name != names[0]);
            for (row, phrases) in self.rows.iter_mut().zip(&rows) {
                let words = worded.then(|| words(phrases).unwrap_or_default());
                let numbers = phrases.iter().map(|phrase| phrase.number.clone());
                row.cells.splice(at..=at, words.into_iter().chain(numbers)).for_each(drop);
            }
            let word = worded.then(|| self.names[at].clone());
            self.names.splice(at..=at, word.into_iter().chain(names)).for_each(drop);
        }
        let sized = self.names.iter().position(|name| is_size(name)).unwrap_or(0);
        let mut filled = Vec::new();
        let open = |row: &Cells, at| row.cells.get(at).is_some_and(String::is_empty);
        for at in 0..=sized {
            let many = self.rows.iter().filter(|row| open(row, at)).count();
            if is_norm(&self.names[at]) || open(&self.rows[0], at) || 2 * many < self.rows.len() {
                continue;
            }
            filled.push(self.names[at].clone());
            for row in 1..self.rows.len() {
                let above = self.rows[row - 1].cells.get(at).cloned();
                if let Some(above) = above.filter(|_| open(&self.rows[row], at)) {
                    self.rows[row].cells[at] = above;
                }
            }
        }
        if !filled.is_empty() {
            self.notes.push(format!("empty cells of {} as those above", listed(filled)));
        }
        self
    }

    /// Sizes within the words of the first column, `Binomial (N=10)` or `Modes: 31 to 241`, as a column of their own.
    pub(super) fn within(mut self) -> Self {
        let width = self.names.len();
        let worded = self
            .rows
            .iter()
            .all(|row| row.cells.len() == width && width > 1 && number(&row.cells[0]).is_none());
        let sized = |at: usize| {
            is_size(&self.names[at]) && self.rows.iter().all(|row| number(&row.cells[at]).is_some())
        };
        if !worded || self.rows.len() < 3 || (1..width).any(sized) {
            return self;
        }
        let mut groups: Vec<(String, Vec<usize>)> = Vec::new();
        let parts: Vec<(String, Vec<String>)> =
            self.rows.iter().map(|row| words_and_numbers(&row.cells[0])).collect();
        for (at, (words, numbers)) in parts.iter().enumerate() {
            match groups.iter_mut().find(|(known, _)| known == words) {
                Some((_, rows)) => rows.push(at),
                None if numbers.is_empty() || !words.contains(char::is_alphabetic) => {}
                None => groups.push((words.clone(), vec![at])),
            }
        }
        groups.retain(|(_, rows)| rows.len() > 2);
        // Of the numbers of a row one is a mesh, has the name of a size before it, or goes towards another that stays; seeds do not.
        let column = |words: &str, rows: &[usize], place: usize| -> Option<Vec<f64>> {
            let sides = |place: usize| -> Option<Vec<f64>> {
                let side = |at: &usize| parts[*at].1.get(place)?.split('x').next()?.parse().ok();
                rows.iter().map(side).collect()
            };
            let sizes = sides(place)?;
            let before = words.split('…').nth(place)?.trim_end_matches([' ', '=', ':']);
            let name = before.rsplit([' ', '(', ',']).next()?;
            let towards = sides(place + 1).is_some_and(|to| {
                to.iter().zip(&sizes).all(|(end, size)| *end == to[0] && end > size)
            });
            let known = parts[rows[0]].1[place].contains('x') || is_size(name) || towards;
            let grow = sizes.windows(2).all(|pair| pair[1] > pair[0]);
            let whole = sizes.iter().all(|size| size.fract() == 0.0);
            (known && grow && !evenly(&sizes) && whole).then_some(sizes)
        };
        let mut rows = Vec::new();
        for (words, of) in &groups {
            let mut sizes = (0..parts[of[0]].1.len()).filter_map(|place| column(words, of, place));
            let (Some(sizes), None) = (sizes.next(), sizes.next()) else { return self };
            for (&at, size) in of.iter().zip(&sizes) {
                let mut row = self.rows[at].clone();
                let words = words.trim_matches(|c: char| !c.is_alphanumeric() && c != ')');
                row.cells.splice(0..1, [words.to_owned(), size.to_string()]).for_each(drop);
                rows.push(row);
            }
        }
        if rows.is_empty() {
            return self;
        }
        let lost = |row: &&Cells| rows.iter().all(|kept: &Cells| kept.line != row.line);
        self.left_out.extend(self.rows.iter().filter(lost).map(|row| row.line));
        self.notes.push(format!("`n` stands within `{}`", self.names[0]));
        self.names.insert(1, "n".into());
        self.rows = rows;
        self
    }

    /// With the one list of sizes in the text that has a number for each row, where no column holds any.
    pub(super) fn sized(mut self, lists: &[(String, Vec<String>)]) -> Self {
        let mut fit =
            lists.iter().filter(|(_, cells)| cells.len() == self.rows.len() && cells.len() > 2);
        let whole = || self.rows.iter().all(|row| row.cells.len() == self.names.len());
        let open =
            !self.names.iter().any(|name| is_size(name)) && !self.names.is_empty() && whole();
        if let (Some((name, cells)), None) = (fit.next().filter(|_| open), fit.next()) {
            self.names.insert(0, name.clone());
            self.rows
                .iter_mut()
                .zip(cells)
                .for_each(|(row, cell)| row.cells.insert(0, cell.clone()));
            self.notes.push(format!("`{name}` stands beside the rows"));
        }
        self
    }

    /// Tables that stand side by side, each with sizes of its own, as blocks; titles may stand so too. Two halves of one table, which
    /// have no size in common, are stacked.
    pub(super) fn parted(self) -> Vec<Self> {
        let width = self.names.len();
        let firsts: Vec<usize> = (0..width).filter(|&at| self.names[at] == self.names[0]).collect();
        let alike = |one: &usize| firsts.iter().copied().eq((0..width).step_by(*one));
        let one = firsts.get(1).copied().filter(alike);
        let one = one.filter(|one| *one > 1 && width.is_multiple_of(*one));
        let whole = self.rows.iter().all(|row| row.cells.len() == width);
        let sized = |one: &usize| self.names.chunks(*one).all(|part| is_size_of(part).is_some());
        let Some(one) = one.filter(|one| whole && sized(one)) else { return vec![self] };
        let size = is_size_of(&self.names[..one]).unwrap_or(0);
        let differ =
            |row: &Cells| (size..width).step_by(one).any(|at| row.cells[at] != row.cells[size]);
        // Sizes that are printed again before each error are those of one table.
        if !self.rows.iter().any(differ) {
            return vec![self];
        }
        let titles: Vec<&str> = self.title.split(BARS).map(str::trim).collect();
        let table = |at: usize| {
            let row = |row: &Cells| Cells {
                line: row.line,
                cells: row.cells[at * one..(at + 1) * one].to_vec(),
            };
            let there = |row: &Cells| row.cells.iter().any(|cell| !cell.is_empty());
            let own = titles.len() == width / one;
            Self {
                title: if own { titles[at].to_owned() } else { self.title.clone() },
                names: self.names[at * one..(at + 1) * one].to_vec(),
                rows: self.rows.iter().map(row).filter(there).collect(),
                ..self.clone()
            }
        };
        let tables: Vec<Self> = (0..width / one).map(table).collect();
        let sizes =
            |of: &Self| of.rows.iter().map(|row| row.cells[size].clone()).collect::<HashSet<_>>();
        let halves = |pair: &[Self]| {
            pair[0].names == pair[1].names && sizes(&pair[0]).is_disjoint(&sizes(&pair[1]))
        };
        if !tables.windows(2).all(halves) || titles.len() == tables.len() {
            return tables;
        }
        let mut stacked =
            Self { rows: tables.into_iter().flat_map(|table| table.rows).collect(), ..self };
        stacked.names.truncate(one);
        stacked.notes.push("halves that stand side by side are one table".into());
        vec![stacked]
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

/// Whether numbers are evenly spaced, as rows, levels and degrees are.
pub(super) fn evenly(numbers: &[f64]) -> bool {
    numbers.windows(3).all(|three| three[2] - three[1] == three[1] - three[0])
}

/// A cell with a mark in place of each number, and these; `P2` and `RK4` are words.
fn words_and_numbers(cell: &str) -> (String, Vec<String>) {
    let (mut words, mut numbers, mut open) = (String::new(), Vec::<String>::new(), false);
    let cell = cell.replace('×', "x");
    for (at, c) in cell.char_indices() {
        let next = cell[at + c.len_utf8()..].starts_with(|c: char| c.is_ascii_digit());
        match numbers.last_mut() {
            Some(number) if open && (c.is_ascii_digit() || ".x".contains(c) && next) => {
                number.push(c)
            }
            _ if c.is_ascii_digit() && !words.ends_with(char::is_alphanumeric) => {
                numbers.push(c.to_string());
                words.push('…');
                open = true;
            }
            _ => {
                words.push(c);
                open = false;
            }
        }
    }
    (words, numbers)
}

/// The place of the first size whose name says so.
fn is_size_of(names: &[String]) -> Option<usize> {
    names.iter().position(|name| is_size(name))
}

/// A number of a cell, and the words before it.
struct Phrase {
    name: String,
    number: String,
    /// Whether a sign stands between.
    assigned: bool,
}

impl Phrase {
    fn last(&self) -> &str {
        self.name.rsplit(' ').next().unwrap_or_default()
    }
}

/// The numbers of a cell behind words: `level 3 (h = 0.125)` has two. A cell that is a number has none.
fn phrases(cell: &str) -> Vec<Phrase> {
    let (mut found, mut name, mut assigned) = (Vec::new(), Vec::new(), false);
    if cell.len() > LONGEST || number(cell).is_some() {
        return found;
    }
    let parted = cell.replace(['$', '`'], "").replace('=', " = ").replace([':', '(', ')'], " ");
    for word in parted.split_whitespace() {
        match number(word.trim_end_matches(',')) {
            _ if word == "=" => assigned = true,
            Some(_) if !name.is_empty() => {
                let number = word.trim_end_matches(',').to_owned();
                found.push(Phrase { name: name.join(" "), number, assigned });
                (name, assigned) = (Vec::new(), false);
            }
            _ => name.push(word),
        }
    }
    found
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

/// A bar within a cell of Markdown.
const ESCAPED: &str = "\u{e002}";

/// No cell spans more columns.
const MOST_SPANNED: usize = 100;

/// A longer line is no row that somebody set.
const LONGEST: usize = 10_000;

pub(super) const BARS: [char; 3] = ['|', '\u{2502}', '\u{2503}'];

pub(super) struct Line<'a> {
    pub(super) number: u64,
    pub(super) text: &'a str,
    pub(super) cells: Vec<String>,
    pub(super) kind: Kind,
}

impl Line<'_> {
    pub(super) fn bare(&self) -> &str {
        self.text.trim().trim_start_matches(['#', '%']).trim()
    }

    /// The names above `width` columns; `#` may be one of a column that counts.
    pub(super) fn names(&self, separator: Separator, width: usize) -> Vec<String> {
        match self.kind {
            Kind::Comment if self.cells.len() != width || self.cells[0] != "#" => {
                cut(self.bare(), separator)
            }
            // `max |u|` has bars of its own: those that part cells have a blank on both sides.
            _ if separator == Separator::Pipe && self.cells.len() > width => {
                let cells: Vec<&str> = self.text.trim().trim_matches(BARS).split(" | ").collect();
                let parted = cells.iter().map(|cell| cell.trim().to_owned());
                if cells.len() == width { parted.collect() } else { self.cells.clone() }
            }
            _ => self.cells.clone(),
        }
    }
}

/// The text with cells of one row in one line, and numbers as programs write them: `1.2×10⁻³` for `1.2\times 10^{-3}`.
pub(super) fn plain(text: &str) -> String {
    let (html, list) = (text.contains("<td"), text.contains("* - "));
    let latex = text.contains('&') && text.contains("\\\\");
    // The line of a row of LaTeX that has not ended.
    let mut open: Option<usize> = None;
    let mut out: Vec<String> = Vec::new();
    // The line on which the row begins whose cells are read.
    let mut row = None;
    let rows = if html { text.replace("</tr><tr", "</tr>\n<tr") } else { text.into() };
    for line in rows.split('\n').map(message) {
        let line = line.trim_start().strip_prefix(":header:").unwrap_or(line);
        let bare = line.trim();
        let cell = bare.strip_prefix("- ").or((bare == "-").then_some(""));
        if let Some(at) = open.filter(|&at| {
            bare.starts_with('&') || bare.starts_with("\\\\") || out[at].trim_end().ends_with('&')
        }) {
            out[at] += &format!(" {bare}");
            out.push(String::new());
            open = open.filter(|_| !bare.contains("\\\\"));
            continue;
        }
        let ends =
            bare.is_empty() || bare.contains("\\\\") || is_rule(bare) || bare.starts_with('%');
        open = (latex && !ends).then_some(out.len());
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

/// The line of a log without the time, the program and the process before it.
fn message(line: &str) -> &str {
    let mut line = line;
    let (mut bare, mut timed) = (line.trim_start(), false);
    while let Some((word, rest)) = bare.split_once(' ') {
        let time = |word: &str| {
            let marks = word.chars().filter(|c| "-:".contains(*c)).count();
            let dated = word.trim_start_matches('[').starts_with(|c: char| c.is_ascii_digit());
            // `0.5,0.0128,-,-0.2` is a row.
            dated
                && marks > 1
                && !word.contains(",-")
                && word.chars().all(|c| c.is_ascii_digit() || "-:.,TZ+[]".contains(c))
        };
        let level = || ["INFO", "INFO:", "DEBUG", "Info:"].contains(&word);
        // `[program 0]` holds no list.
        let bracketed = bare.strip_prefix('[').and_then(|tag| tag.split_once("] "));
        let bracketed = bracketed.filter(|(tag, _)| {
            !tag.contains(['=', ',', '{', '[', '\'', '"'])
                && (!tag.trim().contains(' ') || tag.contains(char::is_alphabetic))
        });
        bare = match bracketed {
            Some((_, behind)) => behind,
            None if time(word) || level() && timed => rest,
            None if bare.starts_with("[ Info:") => rest,
            None => break,
        };
        (line, timed) = (bare, true);
        bare = bare.trim_start();
    }
    line
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

pub(super) fn uncommented(line: &str) -> &str {
    let bare = line.trim_start_matches(|c: char| "%#>!/".contains(c) || c.is_whitespace());
    bare.strip_prefix("+ ")
        .or(bare.strip_prefix('+').filter(|b| b.starts_with('|')))
        .unwrap_or(bare)
}

/// Powers of ten as typeset, without blanks.
fn typed(line: &str) -> String {
    let marks = [" x ", "\\times", "\\cdot", "* 10^", ":math:", "np.float", "tensor("];
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
    for call in ["np.float64(", "np.float32(", "tensor("] {
        while let Some((before, inside)) = out.split_once(call) {
            out = before.to_owned() + &inside.replacen(')', "", 1);
        }
    }
    for times in ["\\times", "\\cdot", "· 10", "·10"] {
        out = out.replace(times, if times.ends_with('0') { "×10" } else { "×" });
    }
    // What stands behind keeps its place.
    while let Some((before, inside)) = out.split_once(":math:") {
        let (inside, behind) = inside.split_at(inside.find("` ").map_or(inside.len(), |at| at + 1));
        out = [before, inside, if behind.is_empty() { "" } else { "      " }, behind].concat();
    }
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
    let drawn = |c: char| "-+|=:_#*~.'\"` \t".contains(c) || ('\u{2500}'..='\u{257f}').contains(&c);
    let latex = "\\begin \\end \\hline \\toprule \\midrule \\bottomrule \\cline \\cmidrule";
    let text = text.trim();
    let bare = latex.split(' ').any(|rule| text.starts_with(rule)) && !text.contains('&');
    bare || text.chars().all(drawn) && text.chars().filter(|&c| !" \t".contains(c)).count() > 2
}

fn cut(text: &str, separator: Separator) -> Vec<String> {
    let owned = |cell: &str| cell.trim().trim_matches('"').replace("**", "").trim().to_owned();
    match separator {
        Separator::Latex => {
            let row = text.split("\\\\").next().unwrap_or_default().replace("\\hline", "");
            // The environment may begin and end in the lines of its rows.
            let begun = row.split_once("\\begin{").and_then(|(_, begun)| begun.split_once("} "));
            let row = begun.map_or(row.as_str(), |(_, row)| row);
            let row = row.split("\\end{").next().unwrap_or_default();
            let cells = row.split('&').flat_map(spanned);
            cells.map(|cell| owned(&cell.replace(['$', '~'], ""))).collect()
        }
        Separator::Pipe => {
            let text = &*text.trim().replace("\\|", ESCAPED);
            let inner = text.strip_prefix(BARS);
            let inner = inner.map_or(text, |inner| inner.strip_suffix(BARS).unwrap_or(inner));
            inner.split(BARS).map(|cell| owned(&cell.replace(ESCAPED, "\\|"))).collect()
        }
        Separator::Character(separator) => {
            // A separator between quotes is text, and so is one in brackets behind a word.
            let (mut cells, mut start, mut quoted, mut depth) = (Vec::new(), 0, false, 0usize);
            let closed = text.matches('(').count() == text.matches(')').count();
            for (at, c) in text.char_indices() {
                quoted ^= c == '"';
                match c {
                    '(' if closed && text[start..at].contains(char::is_alphabetic) => depth += 1,
                    ')' => depth = depth.saturating_sub(1),
                    _ => {}
                }
                if c == separator && !quoted && depth == 0 {
                    cells.push(owned(&text[start..at]));
                    start = at + c.len_utf8();
                }
            }
            cells.push(owned(&text[start..]));
            cells
        }
        Separator::Blanks => {
            // A bar that stands alone parts columns; `||u-u_h||` is a name.
            let text = text.trim().trim_end_matches("\u{2502}");
            let norm =
                text.strip_prefix("||").is_some_and(|of| of.starts_with(char::is_alphabetic));
            let bare = if norm { text } else { text.trim_start_matches(BARS) };
            let bared = text.starts_with('|') && !norm;
            let bare = if bared { bare.trim_end_matches('|') } else { bare };
            let mut cells: Vec<String> = Vec::new();
            for word in bare.split_whitespace() {
                let inner =
                    word.strip_prefix(['(', '[']).and_then(|word| word.strip_suffix([')', ']']));
                let rate = inner.is_some_and(|rate| !is_word(rate));
                match cells.last_mut().filter(|cell| rate && number(cell).is_some()) {
                    Some(cell) => *cell += &format!(" {word}"),
                    None => cells.push(owned(word.trim_end_matches([',', ';']))),
                }
            }
            cells.retain(|word| {
                !word.is_empty() && !BARS.iter().any(|bar| *word == bar.to_string())
            });
            cells
        }
    }
}

/// A cell of LaTeX that spans columns is followed by empty ones.
fn spanned(cell: &str) -> impl Iterator<Item = String> {
    let behind = cell.split_once("\\multi").map(|(_, behind)| behind);
    let (mut text, mut columns) = (cell.to_owned(), 1);
    if let Some(behind) = behind {
        let mut parts = behind.splitn(3, "}{");
        let count = parts.next().and_then(|kind| kind.strip_prefix("column{")?.parse().ok());
        columns = count.unwrap_or(1).clamp(1, MOST_SPANNED);
        let star = behind.split_once("*{").filter(|_| behind.starts_with("row"));
        let inner = star.map(|(_, inner)| inner).or(parts.nth(1)).unwrap_or_default().trim_end();
        text = inner.strip_suffix('}').unwrap_or(inner).to_owned();
    }
    std::iter::once(text).chain(std::iter::repeat_n(String::new(), columns - 1))
}

pub(super) fn classify(text: &str, separator: Separator) -> Vec<Line<'_>> {
    let mut lines = Vec::new();
    // Rows of LaTeX may stand in one line.
    let parts = |text| match separator {
        Separator::Latex => str::split(text, "\\\\").filter(|part| part.contains('&')).count(),
        _ => 0,
    };
    let several = |(at, text): (u64, _)| {
        let pieces = if parts(text) > 1 { "\\\\" } else { "\n" };
        str::split(text, pieces).map(move |text| (at, text))
    };
    for (at, text) in (1..).zip(text.lines()).flat_map(several) {
        let empty = text.trim().trim_matches(BARS).is_empty() || is_rule(text);
        let cells = if empty { Vec::new() } else { cut(text, separator) };
        // So is `-  -` of a level that failed.
        if empty || separator == Separator::Blanks && cells.iter().all(|cell| is_missing(cell)) {
            lines.push(Line { number: at, text, cells, kind: Kind::Gap });
            continue;
        }
        let numbers = numbers(&cells);
        let words = cells.iter().filter(|cell| is_word(cell)).count();
        let row = match separator {
            // Braces hold names and values.
            Separator::Blanks => {
                numbers > 0 && numbers >= words && !text.trim_start().starts_with(['{', '['])
            }
            _ => numbers > 1 || numbers == 1 && words < 2,
        };
        // A heading of Markdown ends a table, a comment does not.
        let mark = text.trim_start();
        let is_comment = mark.starts_with(['#', '%']) && !mark.starts_with("##");
        let kind = match (is_comment, row) {
            (true, _) => Kind::Comment,
            (_, true) => Kind::Row,
            _ => Kind::Text,
        };
        lines.push(Line { number: at, text, cells, kind });
    }
    lines
}

pub(super) fn numbers(cells: &[String]) -> usize {
    cells.iter().filter(|cell| number(cell).is_some()).count()
}

pub(super) fn is_word(cell: &str) -> bool {
    !is_missing(cell) && number(cell).is_none()
}

/// How far a printed rate may be from that of the printed errors.
const RATES_DIFFER: f64 = 0.02;

/// Whether a column, empty in the first row, is the ratio of two rows of another, or its binary logarithm.
pub(super) fn is_computed(rows: &[Cells], at: usize, from: usize) -> bool {
    let cell = |row: &Cells, at: usize| number(row.cells.get(at)?).map(|number| number.value);
    let known = |row: &Cells| cell(row, at).filter(|rate| *rate != 0.0 && !rate.is_nan());
    let lacks = known(&rows[0]).is_none();
    let near = |a: f64, b: f64| (a / b - 1.0).abs() < RATES_DIFFER;
    let is = |of: fn(f64) -> f64| {
        let computed = |pair: &[Cells]| {
            let ratio = cell(&pair[0], from).zip(cell(&pair[1], from)).map(|(a, b)| a / b);
            ratio.zip(known(&pair[1])).is_some_and(|(ratio, rate)| near(of(ratio), rate))
        };
        // A rate of what begins later begins later, too.
        let mut pairs = rows.windows(2).skip_while(|pair| known(&pair[1]).is_none()).peekable();
        pairs.peek().is_some() && pairs.clone().count() > 1 && pairs.all(computed)
    };
    lacks && (is(|ratio| ratio) || is(f64::log2))
}

/// Whether a line names none of the columns.
pub(super) fn is_title(line: &Line) -> bool {
    let column = |cell: &String| is_size(cell) || is_norm(cell) || is_rate(cell);
    line.kind == Kind::Text && !line.cells.iter().any(column)
}
