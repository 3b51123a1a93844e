//! Text tables that fit the available width without breaking numbers or words.

use comfy_table::presets::UTF8_HORIZONTAL_ONLY;
use comfy_table::{CellAlignment, ColumnConstraint, ContentArrangement, LineStyle, Width};

use crate::legend::wrapped;

/// Characters between columns.
const GAP: usize = 2;

/// Longer cells are prose and may be wrapped.
const PROSE: usize = 30;

/// Narrower prose goes below its row.
const NARROWEST: usize = 28;

/// A table for a terminal of `width` columns; heads that begin with `>` are numeric and right-aligned.
pub fn text_table(heads: &[&str], rows: &[Vec<String>], width: u16) -> String {
    let width = usize::from(width);
    let columns: Vec<Column> =
        heads.iter().enumerate().map(|(at, head)| Column::new(at, head, rows)).collect();
    let refs: Vec<&Column> = columns.iter().collect();
    if fits(&refs, |column| column.whole, width) {
        return grid(&refs, rows, |column| column.whole);
    }
    if fits(&refs, |column| column.least, width) {
        let spare = width.saturating_sub(taken(&refs, |column| column.least));
        return grid(&refs, rows, shares(&refs, spare));
    }
    apart(&columns, rows, width)
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
    prose: bool,
    /// Characters of its longest cell or head.
    whole: usize,
    /// Minimum without breaking a number or word.
    least: usize,
}

impl Column {
    fn new(at: usize, head: &str, rows: &[Vec<String>]) -> Self {
        let cells = || rows.iter().filter_map(|row| row.get(at)).map(String::as_str);
        let longest = |text: &str| text.split_whitespace().map(length).max().unwrap_or(0);
        let (numeric, head) = (head.starts_with('>'), head.trim_start_matches('>'));
        let content = cells().map(length).max().unwrap_or(0);
        let prose = !numeric && content > PROSE;
        let words = cells().map(longest).max().unwrap_or(0);
        // Cells other than prose stay whole; only the head may take several lines.
        let least = if prose { words.max(NARROWEST) } else { content }.max(longest(head));
        let whole = content.max(length(head));
        Self { at, head: head.to_owned(), numeric, prose, whole, least: least.min(whole) }
    }
}

fn length(text: &str) -> usize {
    text.chars().count()
}

/// Total width of these columns.
fn taken(columns: &[&Column], of: impl Fn(&Column) -> usize) -> usize {
    columns.iter().map(|column| of(column) + GAP).sum()
}

fn fits(columns: &[&Column], of: impl Fn(&Column) -> usize, width: usize) -> bool {
    taken(columns, of) <= width
}

/// Distributes spare width to prose, as far as useful.
fn shares(columns: &[&Column], spare: usize) -> impl Fn(&Column) -> usize {
    let wanted: usize = columns.iter().map(|column| column.whole - column.least).sum();
    move |column| {
        let more = column.whole - column.least;
        column.least + (spare * more).checked_div(wanted).unwrap_or(0).min(more)
    }
}

/// Prose below its row, and remaining columns in further tables that repeat the first column.
fn apart(columns: &[Column], rows: &[Vec<String>], width: usize) -> String {
    let (prose, short): (Vec<&Column>, Vec<&Column>) =
        columns.iter().partition(|column| column.prose);
    let Some((first, others)) = short.split_first() else {
        return below(&prose, rows, width);
    };
    let mut tables: Vec<Vec<&Column>> = vec![vec![first]];
    for column in others {
        let last = tables.len() - 1;
        let longer = [&tables[last][..], &[column]].concat();
        if fits(&longer, |column| column.least, width) || tables[last].len() == 1 {
            tables[last] = longer;
        } else {
            tables.push(vec![first, column]);
        }
    }
    let drawn = tables.iter().enumerate().map(|(at, columns)| {
        let table = grid(columns, rows, |column| column.least);
        if at > 0 || prose.is_empty() { table } else { with_prose(&table, &prose, rows, width) }
    });
    drawn.collect::<Vec<_>>().join("\n")
}

/// A table whose rows take a line each, with the prose of each row below it.
fn with_prose(table: &str, prose: &[&Column], rows: &[Vec<String>], width: usize) -> String {
    let mut lines = table.lines();
    let mut out: Vec<String> = Vec::new();
    for line in lines.by_ref() {
        out.push(line.to_owned());
        if line.contains('═') {
            break;
        }
    }
    for (row, line) in rows.iter().zip(lines.by_ref()) {
        out.push(line.to_owned());
        out.extend(prose_of(row, prose, width));
    }
    out.extend(lines.map(str::to_owned));
    out.join("\n")
}

fn below(prose: &[&Column], rows: &[Vec<String>], width: usize) -> String {
    let lines: Vec<String> = rows.iter().flat_map(|row| prose_of(row, prose, width)).collect();
    lines.join("\n")
}

/// The prose of a row, each with its head if there are several.
fn prose_of(row: &[String], prose: &[&Column], width: usize) -> Vec<String> {
    let cells = prose.iter().filter_map(|column| {
        let text = row.get(column.at).filter(|text| !text.is_empty())?;
        Some(if prose.len() > 1 { format!("{}: {text}", column.head) } else { text.clone() })
    });
    let indented = |text: String| {
        let lines = wrapped(&text, width.saturating_sub(6), usize::MAX);
        let indent =
            |(at, line)| if at == 0 { format!("    {line}") } else { format!("      {line}") };
        lines.into_iter().enumerate().map(indent).collect::<Vec<_>>()
    };
    cells.flat_map(indented).collect()
}

fn grid(columns: &[&Column], rows: &[Vec<String>], of: impl Fn(&Column) -> usize) -> String {
    let mut table = comfy_table::Table::new();
    table.set_content_arrangement(ContentArrangement::Dynamic).force_no_tty();
    table.load_style(UTF8_HORIZONTAL_ONLY.row_separator(LineStyle::none()));
    table.set_header(columns.iter().map(|column| &column.head));
    table.add_rows(rows.iter().map(|row| {
        columns.iter().map(|column| row.get(column.at).map_or("", String::as_str).to_owned())
    }));
    for (column, drawn) in columns.iter().zip(table.column_iter_mut()) {
        // One character between columns belongs to the table.
        drawn.set_padding((0, GAP as u16 - 1));
        let characters = of(column) + GAP - 1;
        drawn.set_constraint(ColumnConstraint::Absolute(Width::Fixed(characters as u16)));
        if column.numeric {
            drawn.set_cell_alignment(CellAlignment::Right);
        }
    }
    table.trim_fmt()
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
