//! Finds the tables of a text: lines are classified, rows that agree make a block, the line above names its columns.

use super::cell::{Role, is_norm, is_size, number, role};
use super::guess::{has_errors, ladders, unnamed};
use super::line::{
    Block, Cells, Kind, Line, Separator, classify, is_rule, is_title, is_word, numbers, plain,
    uncommented,
};
use super::lists::{lists, sizes};
use super::loose::{self, Records, Text};
use super::names::head;

/// The ways to cut a text into blocks.
const WAYS: [fn(&Text) -> Vec<Block>; 16] = [
    |text| lists(text, true),
    |text| blocks(text, Separator::Latex),
    |text| blocks(text, Separator::Pipe),
    |text| blocks(text, Separator::Character('\t')),
    |text| blocks(text, Separator::Character(';')),
    |text| blocks(text, Separator::Character(',')),
    |text| loose::ruled(text),
    |text| blocks(text, Separator::Blanks),
    |text| loose::tupled(text),
    |text| loose::records(text, Records::Lines),
    |text| loose::records(text, Records::BySize),
    |text| loose::records(text, Records::InTurn),
    |text| lists(text, false),
    |text| nameless(text),
    |text| bracketed(text),
    |text| leading(text),
];

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
    texts.flat_map(|text| {
        let (sizes, text) = (sizes(&text), Text::of(text));
        WAYS.iter().map(move |way| {
            let blocks =
                way(&text).into_iter().map(|block| block.tidied().within()).flat_map(Block::parted);
            blocks.map(|block| block.sized(&sizes)).collect()
        })
    })
}

/// Rows below no names: their numbers say what they are.
fn nameless(text: &str) -> Vec<Block> {
    for separator in Separator::ALL {
        let blocks = cut(text, separator, true);
        // Names that fit are not passed over.
        let fits = |block: &Block| block.names.len() == block.rows[0].cells.len();
        if blocks.iter().any(|block| fits(block) && block.names.len() > 1 && block.rows.len() > 1) {
            break;
        }
        let bare = |block: Block| unnamed(&block).unwrap_or(block);
        // `a = 1 2` is no row.
        let row = |block: &Block| !block.rows[0].cells.contains(&"=".to_owned());
        let bare = blocks.into_iter().filter(row).flat_map(ladders).map(bare);
        let bare: Vec<Block> = bare.collect();
        if bare.iter().any(has_errors) {
            return bare;
        }
    }
    Vec::new()
}

/// The numbers that lines begin with, whatever stands behind and between them; a line of words above them may hold names.
fn leading(text: &str) -> Vec<Block> {
    let (mut rows, mut passed, mut above) = (Vec::new(), Vec::new(), None);
    for (at, line) in (1..).zip(text.lines()) {
        let words = line.split_whitespace().map(|word| word.trim_end_matches([',', ';', ':']));
        let bare: Vec<&str> = words.take_while(|word| number(word).is_some()).collect();
        let names = |line: &&str| {
            let words = line.split_whitespace();
            // One word names no row of two numbers, nor does a sentence.
            !line.trim_end().ends_with(['.', ':'])
                && !is_rule(line)
                && words.clone().all(|word| number(word).is_none())
                && words.count() >= bare.len().max(3) - 1
        };
        let row = bare.len() > 1;
        if row && above.as_ref().is_some_and(names) {
            return Vec::new();
        }
        if !row && !line.trim().is_empty() {
            above = Some(line);
            passed.extend(line.contains(|c: char| c.is_ascii_digit()).then_some(at));
        } else if row {
            above = None;
        }
        rows.push(if row { bare.join(" ") } else { String::new() });
    }
    let mut found = nameless(&rows.join("\n"));
    for block in &mut found {
        let within = block.line..block.end;
        block.left_out.extend(passed.iter().filter(|line| within.contains(line)));
    }
    found
}

/// Rows in brackets, or parted by semicolons, as scripts write matrices and pairs.
fn bracketed(text: &str) -> Vec<Block> {
    let (mut rows, mut lines) = (String::new(), Vec::new());
    for (line, text) in (1..).zip(text.lines()) {
        for piece in text.split(['[', ']', '(', ')', '{', '}', ';']) {
            let piece = piece.replace([',', '\t'], " ");
            let bare = piece.split_whitespace().all(|word| number(word).is_some());
            rows += if bare { &piece } else { "" };
            rows.push('\n');
            lines.push(line);
        }
    }
    if !text.contains(['[', '(']) {
        return Vec::new();
    }
    let mut found = nameless(&rows);
    let place = |line: &mut u64| *line = lines.get(*line as usize - 1).copied().unwrap_or(*line);
    for block in &mut found {
        [&mut block.line, &mut block.end].into_iter().for_each(place);
        block.rows.iter_mut().for_each(|row| place(&mut row.line));
        block.left_out.iter_mut().for_each(place);
    }
    found
}

fn blocks(text: &str, separator: Separator) -> Vec<Block> {
    cut(text, separator, false)
}

/// `bare` keeps a column of numbers below no name.
fn cut(text: &str, separator: Separator, bare: bool) -> Vec<Block> {
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
                // `1  exact  0.5` below the levels of problem 1.
                Kind::Row
                    if line.cells.len() < width
                        && line.cells.iter().any(|cell| is_word(cell) && is_summary(cell)) =>
                {
                    left_out.push(line.number);
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
        trim(&lines, &mut rows, &mut left_out);
        let cells = |&at: &usize| Cells { line: lines[at].number, cells: lines[at].cells.clone() };
        let rows = rows.iter().map(cells).collect();
        let block = head(&lines[..first], separator, width, rows, left_out);
        let block = titled(block, found.last(), &lines[..first], width);
        // One column alone is one of errors, or a list of something else.
        let one = |name: &String| is_norm(name) && !name.contains([',', ';', '|', '&', '=']);
        if width > 1 || bare || block.names.first().is_some_and(one) {
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

/// Leaves `exact` and `Richardson` out, before or behind the levels.
fn trim(lines: &[Line], rows: &mut Vec<usize>, left_out: &mut Vec<u64>) {
    let first = |at: &usize| lines[*at].cells.first();
    let long = |cell: &str| cell.chars().filter(|c| c.is_alphabetic()).count() > 2;
    let word = |cell: &String| {
        is_word(cell) && (cell == "∞" || cell.starts_with(char::is_alphabetic) && long(cell))
    };
    let worded = |at: &&usize| first(at).is_some_and(word);
    let sized = |at| first(at).is_some_and(|cell| cell.starts_with(|c: char| c.is_ascii_digit()));
    let front = rows.iter().take_while(worded).count();
    let end = rows.len() - rows[front..].iter().rev().take_while(worded).count();
    if end > front + 1 && rows[front..end].iter().all(sized) {
        let others = rows[..front].iter().chain(&rows[end..]);
        left_out.extend(others.map(|&at| lines[at].number));
        *rows = rows[front..end].to_vec();
    }
}

/// The block with the names of the one before, if a title alone stands between them.
fn titled(block: Block, before: Option<&Block>, above: &[Line], width: usize) -> Block {
    let named = |before: &&Block| before.names.len() == width && is_table(before);
    let Some(before) = before.filter(named).filter(|_| block.names.len() != width) else {
        return block;
    };
    let between = above.iter().rev().take_while(|line| line.number > before.end);
    let mut between = between.filter(|line| line.kind != Kind::Gap);
    match (between.next(), between.next()) {
        (Some(title), None) if is_title(title) => {
            Block { title: title.bare().to_owned(), names: before.names.clone(), ..block }
        }
        _ => block,
    }
}

fn goes_on(lines: &[Line], at: usize, width: usize) -> bool {
    lines.get(at).is_some_and(|line| line.kind == Kind::Row && line.cells.len() == width)
}

fn is_summary(text: &str) -> bool {
    let word = text.split(|c: char| !c.is_alphanumeric()).find(|word| !word.is_empty());
    let words = "mean average avg overall expected theoretical theory exact fitted order rate eoc asymptotic slope";
    word.is_some_and(|word| words.split(' ').any(|known| word.eq_ignore_ascii_case(known)))
}

/// Whether the names are of a size and of an error, so that the block is a table, sound or not.
pub(super) fn is_table(block: &Block) -> bool {
    block.names.iter().any(|name| is_size(name)) && block.names.iter().any(|name| is_norm(name))
}

/// How many columns have names that say what they are.
pub(super) fn known(block: &Block) -> usize {
    block.names.iter().filter(|name| !matches!(role(name), Role::Unknown | Role::Ignored)).count()
}
