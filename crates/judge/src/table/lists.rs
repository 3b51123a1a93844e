//! Lists of numbers behind their names, wherever they stand: in brackets of a script, behind `=` or a colon, in the lines of a table that
//! lies on its side, or with their name before each number.

use super::cell::{Role, is_missing, is_norm, is_rate, is_size, normal, number, role};
use super::line::{BARS, Block, is_rule};

/// More lists are those of no study.
const MOST_LISTS: usize = 1000;
/// A longer word is no number.
const LONGEST_WORD: usize = 64;

#[derive(Debug, Clone, Default)]
struct List {
    name: String,
    /// Whether a sign says that the numbers are those of the name.
    assigned: bool,
    line: u64,
    end: u64,
    cells: Vec<String>,
    /// The numbers before `:` in `16: 0.1, 32: 0.02`.
    keys: Vec<String>,
    /// Names before the first number.
    labels: Vec<String>,
    /// Whether they stand before each number, as sizes do across the head of a table, and whether words follow in that line.
    across: bool,
    followed: bool,
    /// Where its row begins, and whether several have more than one number.
    row: usize,
    matrix: bool,
}

impl List {
    fn end_row(&mut self) {
        self.matrix |= self.row > 0 && self.cells.len() > self.row + 1;
        self.row = self.cells.len();
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Token<'a> {
    Number(&'a str),
    Word(&'a str),
    Equal,
    Bar,
    Open,
    Close,
    Part(char),
}

fn tokens(line: &str, mut depth: usize) -> Vec<Token<'_>> {
    let mut found = Vec::new();
    // `NN,ND` in a cell is one word.
    let barred = line.trim_start().starts_with('|');
    for mut rest in line.split_whitespace() {
        while let Some(first) = rest.chars().next() {
            let next = &rest[first.len_utf8()..];
            let numeric =
                |text: &str| text.starts_with(|c: char| c.is_ascii_digit() || "+-.[`'".contains(c));
            let behind = matches!(found.last(), Some(Token::Number(_)));
            let (token, length) = match first {
                ',' | ';' => (Token::Part(first), 1),
                '∈' => (Token::Equal, first.len_utf8()),
                '=' => (Token::Equal, 1 + usize::from(next.starts_with(['=', '>']))),
                ':' if next.starts_with('=') => (Token::Equal, 2),
                ':' if !next.starts_with(char::is_alphabetic) => (Token::Equal, 1),
                '[' | '{' => (Token::Open, 1),
                '(' if numeric(next) => (Token::Open, 1),
                ']' | '}' => (Token::Close, 1),
                ')' if behind => (Token::Close, 1),
                c if (BARS.contains(&c) || c == '&')
                    && (next.is_empty() || behind || numeric(next)) =>
                {
                    (Token::Bar, c.len_utf8())
                }
                _ => {
                    let whole = if rest.len() > LONGEST_WORD { "" } else { rest };
                    let whole = whole.trim_end_matches([',', ';', ']', ')', '}']);
                    let whole =
                        if number(whole).is_some() { whole } else { whole.trim_end_matches('.') };
                    // `16,32,64` are three, `0,5` may be one.
                    let one = whole.matches(',').count() < if depth > 0 { 1 } else { 2 };
                    let joins = |at: usize| {
                        let letter = |c: char| c.is_alphabetic();
                        barred && rest[..at].ends_with(letter) && rest[at + 1..].starts_with(letter)
                    };
                    let marks = |at: usize, c: char| {
                        ",;=:[]".contains(c) && !(c == ',' && joins(at))
                            || BARS.contains(&c) && behind
                    };
                    let stop = rest
                        .char_indices()
                        .skip(1)
                        .find(|(at, c)| marks(*at, *c))
                        .map_or(rest.len(), |(at, _)| at);
                    // `error[0]` is a name.
                    let index =
                        |inner: &str| inner.bytes().take(LONGEST_WORD).position(|b| b == b']');
                    let stop = match rest[stop..].strip_prefix('[').and_then(index) {
                        Some(close) if !rest[..stop].ends_with('(') && !numeric(rest) => {
                            stop + close + 2
                        }
                        _ => stop,
                    };
                    match number(whole).is_some() && one {
                        true => (Token::Number(whole), whole.len()),
                        false if number(&rest[..stop]).is_some() => {
                            (Token::Number(&rest[..stop]), stop)
                        }
                        false => (Token::Word(&rest[..stop]), stop),
                    }
                }
            };
            match token {
                Token::Open => depth += 1,
                Token::Close => depth = depth.saturating_sub(1),
                _ => {}
            }
            found.push(token);
            rest = &rest[length..];
        }
    }
    found
}

/// What is read of a text so far.
#[derive(Default)]
struct Scan<'a> {
    lists: Vec<List>,
    list: Option<List>,
    name: Vec<&'a str>,
    /// Names before signs: both of `nx = ny = 8`.
    labels: Vec<&'a str>,
    /// Words of the name in the cells before its last.
    barred: usize,
    /// Whether a sign stands behind the name.
    assigned: bool,
    /// Whether the sign ended its line: the numbers stand in those below.
    open: bool,
    depth: usize,
    /// MATLAB prints a factor above its vectors.
    scale: Option<f64>,
}

impl<'a> Scan<'a> {
    fn close(&mut self) {
        self.lists.extend(self.list.take().filter(|list| !list.matrix));
    }

    fn take(&mut self, line: u64, token: Token<'a>, next: Option<&Token>) {
        let repeated = |list: &List, word| list.labels.iter().any(|label| label == word);
        match token {
            Token::Number(cell) => {
                let (name, assigned) = (self.name.join(" "), self.assigned);
                let labels = self.labels.drain(..).map(str::to_owned).collect();
                let fresh = || List { name, assigned, line, labels, ..List::default() };
                let list = self.list.get_or_insert_with(fresh);
                let scaled =
                    self.scale.and_then(|scale| Some(format!("{:e}", scale * number(cell)?.value)));
                list.cells.push(scaled.unwrap_or(cell.to_owned()));
                list.end = line;
                self.name.clear();
                self.assigned = false;
            }
            // `h = 1/2  h = 1/4`.
            Token::Word(word)
                if next == Some(&Token::Equal)
                    && self.list.as_ref().is_some_and(|list| repeated(list, word)) =>
            {
                self.list.iter_mut().for_each(|list| list.across = true);
            }
            Token::Word("in") if self.list.is_none() && next == Some(&Token::Open) => {
                self.assigned = true
            }
            Token::Word(word) => match &mut self.list {
                Some(list) if word == "*" && self.open => {
                    self.scale = list.cells.pop().and_then(|cell| number(&cell)).map(|n| n.value);
                }
                Some(_) if ["and", "...", "…", "→", "->"].contains(&word) => {}
                Some(list) if is_missing(word) => list.cells.push(word.to_owned()),
                list => {
                    if let Some(list) = list {
                        list.followed = word.contains(char::is_alphabetic);
                    }
                    self.close();
                    // `np.array(` is no name.
                    let mark = self.name.is_empty()
                        && !word.contains(|c: char| c.is_alphanumeric() || "|‖".contains(c));
                    if !word.ends_with('(') && !mark {
                        if std::mem::take(&mut self.assigned) {
                            self.name.clear();
                        }
                        self.name.push(word);
                    }
                }
            },
            Token::Equal => match &mut self.list {
                Some(list) if list.across => {}
                Some(list) if matches!(next, Some(Token::Number(_))) => {
                    list.keys.extend(list.cells.pop());
                }
                // `for N = 8, 16:`.
                Some(_) => self.close(),
                _ => {
                    self.name.drain(..self.barred.min(self.name.len()));
                    self.labels.extend(self.name.last());
                    (self.assigned, self.barred) = (true, 0);
                }
            },
            Token::Open => self.depth += 1,
            Token::Close => {
                self.depth = self.depth.saturating_sub(1);
                self.close();
                self.name.clear();
            }
            Token::Part(_) if self.list.is_none() => {
                self.name.clear();
                self.assigned = false;
            }
            Token::Part(';') if self.depth > 0 => self.list.iter_mut().for_each(List::end_row),
            Token::Part(_) | Token::Bar => self.barred = self.name.len(),
        }
    }
}

/// All lists of a text, in order.
fn scan(text: &str) -> Vec<List> {
    let mut scan = Scan::default();
    for (line, text) in (1..).zip(text.lines()) {
        // What ends a row of LaTeX is no part of its last number.
        let text = text.trim_end().trim_end_matches("\\hline").trim_end().trim_end_matches("\\\\");
        let rule = text.trim_start().starts_with('\\') && is_rule(text);
        let tokens = tokens(if rule { "" } else { text }, scan.depth);
        let bare = tokens.iter().all(|token| matches!(token, Token::Number(_) | Token::Word("*")));
        if scan.open && (bare || text.trim_start().starts_with("Column")) {
            let numbers = tokens.iter().filter(|_| bare);
            numbers.for_each(|&token| scan.take(line, token, None));
            match &mut scan.list {
                Some(list) if bare && !tokens.is_empty() => list.end_row(),
                // `Columns 1 through 4` begins no row.
                Some(list) if !bare => list.row = 0,
                _ => {}
            }
            continue;
        }
        if scan.open {
            scan.close();
            (scan.open, scan.scale) = (false, None);
        }
        for (at, &token) in tokens.iter().enumerate() {
            scan.take(line, token, tokens.get(at + 1));
        }
        scan.open = tokens.last() == Some(&Token::Equal) && scan.list.is_none();
        let goes_on = matches!(tokens.last(), Some(Token::Part(_) | Token::Word("..." | "and")));
        if !(scan.open || goes_on || scan.depth > 0 && !tokens.is_empty()) {
            scan.close();
            (scan.assigned, scan.depth, scan.barred) = (false, 0, 0);
            scan.name.clear();
            scan.labels.clear();
        }
        if scan.lists.len() > MOST_LISTS {
            return Vec::new();
        }
    }
    scan.close();
    scan.lists
}

/// A list of sizes may be called `hs`.
fn singular(name: &str) -> String {
    let ends = ["s", "_values", "_vals", "_list", "values", "vals", "list"];
    let mut single = ends.iter().filter_map(|end| name.strip_suffix(end)).map(str::trim);
    single.find(|single| !is_size(name) && is_size(single)).unwrap_or(name).to_owned()
}

/// Lists of one length, each with a name of its own, are the columns of a table. Sizes in a line for each level are a list.
fn tables(text: &str) -> Vec<Vec<List>> {
    let mut lists: Vec<List> = Vec::new();
    let (mut head, mut end, mut labelled): (Option<List>, u64, bool) = (None, 0, false);
    for mut list in scan(text) {
        // Of `Dict(:l2` the name stands behind the bracket.
        let name = list.name.rsplit_once('(').filter(|(_, inner)| !inner.contains(')'));
        let name = name.map_or(&*list.name, |(_, inner)| inner).replace('$', "");
        // The bars of `\| u \|` are its own.
        let marks = if name.contains("\\|") { "\"'`" } else { "\"'`|" };
        list.name = singular(name.trim_matches(|c: char| c.is_whitespace() || marks.contains(c)));
        // `L2 error at n = 8, 16, 32` lists sizes.
        let at = [" at ", " for ", " with "].iter().find_map(|of| list.name.rsplit_once(of));
        if let Some((_, size)) = at.filter(|(error, size)| is_norm(error) && is_size(size)) {
            list.name = size.to_owned();
        }
        if list.name.is_empty() && list.cells.iter().all(|cell| cell.contains(['x', '×'])) {
            (list.name, list.across) = ("mesh".into(), true);
        }
        let followed = list.followed && !list.assigned && list.cells.len() > 1;
        if (list.across || followed) && is_size(&list.name) {
            (head, end, labelled) = (Some(list.clone()), list.end, false);
        } else if let Some(head) = head.as_ref().filter(|_| list.line <= end + 2) {
            below(head, &mut list, &mut labelled);
            end = list.end;
        }
        let single = list.cells.len() == 1 && list.keys.is_empty();
        let known = |known: &&mut List| single && known.assigned && known.name == list.name;
        match lists.iter_mut().find(known).filter(|known| is_size(&known.name)) {
            Some(known) => {
                known.cells.extend(list.cells);
                known.end = list.end;
            }
            None if !single && list.keys.len() == list.cells.len() => {
                let cells = std::mem::take(&mut list.keys);
                let keys = List { name: "key".into(), cells, ..list.clone() };
                lists.extend([keys, list]);
            }
            None => lists.push(list),
        }
    }
    lists.retain(|list| list.cells.len() > 1 && !list.name.is_empty() && !is_rate(&list.name));
    let mut tables: Vec<Vec<List>> = Vec::new();
    for mut list in lists {
        // Sizes that come again begin another table; an error that does so is another one.
        let alike = |table: &&mut Vec<List>| {
            let known = |list: &List| table.iter().any(|known| known.name == list.name);
            table[0].cells.len() == list.cells.len()
                && (!known(&list) || is_size(&table[0].name) && !is_size(&list.name))
        };
        match tables.last_mut().filter(alike) {
            Some(table) => {
                let name = std::mem::take(&mut list.name);
                let mut names =
                    (1..).map(|n| if n > 1 { format!("{name} ({n})") } else { name.clone() });
                let free = |name: &String| table.iter().all(|known| known.name != *name);
                list.name = names.find(free).unwrap_or_default();
                table.push(list);
            }
            None => tables.push(vec![list]),
        }
    }
    tables
}

/// A row below sizes: behind its numbers may stand an order, and before them, where the sizes stand across, one more, as in `q = 1`.
fn below(head: &List, row: &mut List, labelled: &mut bool) {
    let width = head.cells.len();
    let value = |at: usize| row.cells.get(at).and_then(|cell| number(cell)).map(|n| n.value);
    // An order is larger than the finest error, which stands last where a number is in front.
    let order = row.cells.len() > width && (head.across || value(width) > value(width - 1));
    if head.followed && order {
        row.cells.truncate(width);
    }
    if !head.across {
        return;
    }
    if row.name.is_empty() && row.cells.len() <= width && *labelled {
        // Rates below the errors of a label.
        return;
    }
    *labelled = true;
    if row.cells.len() == width + 1 {
        let sign = if row.assigned { " = " } else { "" };
        row.name = [&*row.name, sign, &*row.cells.remove(0)].concat();
    } else if row.assigned {
        return;
    }
    let known = !normal(&row.name).is_empty();
    let other = known && (is_size(&row.name) || role(&row.name) == Role::Ignored);
    if !is_norm(&row.name) && !other && !row.name.to_lowercase().starts_with("cond") {
        row.name = format!("error of {}", row.name);
    }
    row.assigned = false;
}

/// Tables of lists; where no size is `said` to be one, the numbers or the caller may say so.
pub(super) fn lists(text: &str, said: bool) -> Vec<Block> {
    let known = |list: &List| is_size(&list.name) || is_norm(&list.name);
    let sound = |table: &Vec<List>| match said {
        _ if table.iter().all(|list| is_size(&list.name)) => false,
        true => table.iter().any(|list| is_size(&list.name) && list.assigned),
        false if table.len() > 1 => table.iter().any(known),
        false => table[0].assigned && table[0].cells.len() > 2,
    };
    let block = |table: Vec<List>| {
        let [line, end] = [table[0].line, table.iter().map(|list| list.end).max().unwrap_or(0)];
        let columns = table.into_iter().map(|list| (list.name, list.cells)).collect();
        Block::of_columns(line, end, columns)
    };
    tables(text).into_iter().filter(sound).map(block).collect()
}

/// Sizes that stand beside a table in one list: `(h = 1/8, 1/16, 1/32)`.
pub(super) fn sizes(text: &str) -> Vec<(String, Vec<String>)> {
    let sized = |list: &List| list.assigned && is_size(&list.name);
    let mut found: Vec<(String, Vec<String>)> = Vec::new();
    for list in tables(text).into_iter().flatten().filter(sized) {
        if found.iter().all(|(_, cells)| *cells != list.cells) {
            found.push((list.name, list.cells));
        }
    }
    found
}
