//! Blocks on a terminal: lines of text and tables of characters.

use super::columns::text_table;
use super::{Block, Equation, Run, Table};
use crate::legend::wrapped;

/// The blocks below a title.
pub(super) fn text(title: &str, blocks: &[Block], width: u16) -> String {
    let lines: Vec<String> = blocks.iter().filter_map(|own| block(own, width)).collect();
    format!("{title}\n\n{}", lines.join("\n\n"))
}

fn block(block: &Block, width: u16) -> Option<String> {
    Some(match block {
        Block::Text(runs) => paragraph(&joined(runs), width),
        Block::Formulas(formulas) => {
            let line = |Equation { plain, number, .. }: &Equation| format!("{plain}  {number}");
            formulas.iter().map(line).collect::<Vec<_>>().join("\n")
        }
        Block::Table(own) => format!("{}\n{}", paragraph(&own.caption, width), table(own, width)),
        Block::Figure(_) => return None,
        Block::Code(lines) => lines.lines().map(|line| format!("  {line}\n")).collect(),
    })
}

/// A table of characters.
fn table(own: &Table, width: u16) -> String {
    let head = |(head, numeric): (&String, &bool)| match numeric {
        true => format!(">{head}"),
        false => head.clone(),
    };
    let heads: Vec<String> = own.head.iter().zip(&own.numeric).map(head).collect();
    let heads: Vec<&str> = heads.iter().map(String::as_str).collect();
    let rows: Vec<Vec<String>> = own
        .rows
        .iter()
        .map(|row| row.iter().map(|run| run.in_line().into_owned()).collect())
        .collect();
    text_table(&heads, &rows, width)
}

/// Lines broken at blanks; those that are longer than a page of a book is wide are not read.
fn paragraph(text: &str, width: u16) -> String {
    wrapped(text, usize::from(width.min(LONGEST)), usize::MAX).join("\n")
}

/// Characters of a line of words.
const LONGEST: u16 = 110;

fn joined(runs: &[Run]) -> String {
    runs.iter().map(Run::in_line).collect()
}
