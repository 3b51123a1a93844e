//! Text tables that fit the available width without breaking numbers or words.

use crate::legend::wrapped;

/// Characters between columns.
pub(super) const GAP: usize = 2;

/// Longer cells are prose and may be wrapped.
const PROSE: usize = 30;

/// Prose is not made narrower while there is another way.
const NARROWEST: usize = 28;

/// A table for a terminal of `width` columns; heads that begin with `>` are numeric and right-aligned. Columns without
/// room stand in further tables, which repeat the first column.
pub fn text_table(heads: &[&str], rows: &[Vec<String>], width: u16) -> String {
    let width = usize::from(width);
    let columns_of = |in_parts: bool| -> Vec<Column> {
        let heads = heads.iter().enumerate();
        heads.map(|(at, head)| Column::new(at, head, rows, in_parts)).collect()
    };
    let mut columns = columns_of(false);
    if taken(&columns.iter().collect::<Vec<_>>()) > width {
        columns = columns_of(true);
    }
    let mut tables: Vec<Vec<&Column>> = vec![Vec::new()];
    for column in &columns {
        let last = tables.len() - 1;
        let longer = [&tables[last][..], &[column]].concat();
        if taken(&longer) <= width || tables[last].len() < 2 {
            tables[last] = longer;
        } else {
            tables.push(vec![&columns[0], column]);
        }
    }
    let drawn = tables.iter().map(|columns| grid(columns, rows, width));
    drawn.collect::<Vec<_>>().join("\n")
}

/// Words beside a label of width `room`; later lines are aligned with the words.
pub fn beside(label: &str, room: usize, words: &str, width: u16) -> String {
    let room = room.max(length(label));
    let lines = wrapped(words, usize::from(width).saturating_sub(room).max(NARROWEST), usize::MAX);
    let line = |(at, line): (usize, &String)| match at {
        0 => format!("{label:<room$}{line}"),
        _ => format!("{:<room$}{line}", ""),
    };
    lines.iter().enumerate().map(line).collect::<Vec<_>>().join("\n")
}

struct Column {
    at: usize,
    head: String,
    numeric: bool,
    /// Characters of its longest line.
    whole: usize,
    /// Minimum without breaking a number or word.
    least: usize,
}

impl Column {
    fn new(at: usize, head: &str, rows: &[Vec<String>], in_parts: bool) -> Self {
        let (numeric, head) = (head.starts_with('>'), head.trim_start_matches('>'));
        let narrowest = if in_parts { 0 } else { NARROWEST };
        let lines = || rows.iter().filter_map(|row| row.get(at)).flat_map(|cell| cell.lines());
        let content = lines().map(length).max().unwrap_or(0);
        // Cells other than prose stay whole; only a head and, in parts, a name takes several lines.
        let least = |line: &str| match line.split_whitespace().nth(1) {
            Some(_) if numeric || content <= PROSE => length(line),
            Some(_) => line.split_whitespace().map(length).fold(narrowest, usize::max),
            None if in_parts => parts(line).map(length).max().unwrap_or(0),
            None => length(line),
        };
        let word = head.split_whitespace().map(length).max().unwrap_or(0);
        let least = lines().map(least).fold(word, usize::max);
        let whole = content.max(length(head));
        Self { at, head: head.to_owned(), numeric, whole, least: least.min(whole) }
    }
}

fn length(text: &str) -> usize {
    text.chars().count()
}

/// The parts of a name, which a narrow column sets below each other; other words are whole.
fn parts(word: &str) -> impl Iterator<Item = &str> {
    let is_name = word.starts_with(char::is_alphabetic);
    word.split_inclusive(move |c| is_name && "-_".contains(c))
}

/// Least width of these columns.
fn taken(columns: &[&Column]) -> usize {
    columns.iter().map(|column| column.least + GAP).sum()
}

/// A cell in lines of at most so many characters.
fn lines(cell: &str, room: usize) -> Vec<String> {
    let mut lines = Vec::new();
    for line in cell.lines() {
        match (length(line) > room, line.contains(' ')) {
            (false, _) => lines.push(line.to_owned()),
            (true, true) => lines.extend(wrapped(line, room, usize::MAX)),
            (true, false) => parts(line).for_each(|part| match lines.last_mut() {
                Some(last) if length(last) + length(part) <= room => last.push_str(part),
                _ => lines.push(part.to_owned()),
            }),
        }
    }
    lines
}

fn grid(columns: &[&Column], rows: &[Vec<String>], width: usize) -> String {
    // Spare width goes to the columns that can use it, in shares of what they lack.
    let spare = width.saturating_sub(taken(columns));
    let wanted: usize = columns.iter().map(|column| column.whole - column.least).sum();
    let widths: Vec<usize> = columns
        .iter()
        .map(|column| {
            let more = column.whole - column.least;
            column.least + (spare * more).checked_div(wanted).unwrap_or(0).min(more)
        })
        .collect();
    let rule = |sign: &str| sign.repeat(widths.iter().map(|width| width + GAP).sum::<usize>() - 1);
    let row = |cell: &dyn Fn(&Column) -> String| -> Vec<String> {
        let cells: Vec<Vec<String>> = columns
            .iter()
            .zip(&widths)
            .map(|(column, width)| lines(&cell(column), *width))
            .collect();
        let height = cells.iter().map(Vec::len).max().unwrap_or(0).max(1);
        let line = |at: usize| {
            let each = columns.iter().zip(&widths).zip(&cells).map(|((column, &width), cell)| {
                let text = cell.get(at).map_or("", String::as_str);
                if column.numeric { format!("{text:>width$}") } else { format!("{text:<width$}") }
            });
            each.collect::<Vec<_>>().join("  ").trim_end().to_owned()
        };
        (0..height).map(line).collect()
    };
    let mut drawn = vec![rule("─")];
    drawn.extend(row(&|column| column.head.clone()));
    drawn.push(rule("═"));
    for cells in rows {
        drawn.extend(row(&|column| cells.get(column.at).cloned().unwrap_or_default()));
    }
    drawn.push(rule("─"));
    drawn.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows() -> Vec<Vec<String>> {
        let prose = "what holds because of a theorem with many words that take their room";
        ["0.0135847412", "1.2345678901"]
            .map(|number| {
                ["contact by Gauss points", number, number, number, prose].map(str::to_owned).into()
            })
            .into()
    }

    const HEADS: [&str; 5] = ["knob", ">spectral radius", ">norm", ">(3.15)", "because"];

    /// At any width every number and word stays whole in one line.
    #[test]
    fn nothing_is_broken_at_any_width() {
        for width in [20, 40, 60, 80, 100, 140, 200] {
            let text = text_table(&HEADS, &rows(), width);
            for word in ["0.0135847412", "1.2345678901", "Gauss", "theorem", "radius", "because"] {
                let there = text.contains(word) || word == "because" && width < 100;
                assert!(there, "{width}: {word}\n{text}");
            }
            assert_eq!(text.matches("1.2345678901").count(), 3, "{width}\n{text}");
            let longest = text.lines().map(length).max().unwrap_or(0);
            assert!(longest <= usize::from(width).max(60), "{width}: {longest}\n{text}");
        }
    }

    #[test]
    fn words_stand_beside_their_label() {
        let text = beside("terms", 8, &"word ".repeat(12), 40);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 2, "{text}");
        assert!(lines[0].starts_with("terms   word") && lines[1].starts_with("        word"));
        assert_eq!(beside("a", 3, "b c", u16::MAX), "a  b c");
    }

    #[test]
    fn a_table_takes_no_more_room_than_it_needs() {
        let rows = vec![vec!["a".to_owned(), "1".into()]];
        let text = text_table(&["x", ">y"], &rows, 140);
        assert!(text.lines().all(|line| length(line) < 8), "{text}");
    }
}
