//! Blocks on a terminal: lines of text and tables of characters.

use super::columns::text_table;
use super::{Block, Equation, Run, Table};
use crate::legend::wrapped;

pub(super) fn text(title: &str, blocks: &[Block], width: u16) -> String {
    let lines: Vec<String> = blocks.iter().filter_map(|part| block(part, width)).collect();
    format!("{title}\n\n{}", lines.join("\n\n"))
}

fn block(block: &Block, width: u16) -> Option<String> {
    Some(match block {
        Block::Text(runs) => paragraph(&joined(runs), width),
        Block::Formulas(formulas) => {
            let line = |Equation { plain, number, .. }: &Equation| format!("{plain}  {number}");
            formulas.iter().map(line).collect::<Vec<_>>().join("\n")
        }
        Block::Table(table_block) => {
            format!("{}\n{}", paragraph(&table_block.caption, width), table(table_block, width))
        }
        Block::Figure(_) => return None,
        Block::Code(lines) => lines.lines().map(|line| format!("  {line}\n")).collect(),
    })
}

fn table(table: &Table, width: u16) -> String {
    let head = |(head, numeric): (&String, &bool)| match numeric {
        true => format!(">{head}"),
        false => head.clone(),
    };
    let heads: Vec<String> = table.head.iter().zip(&table.numeric).map(head).collect();
    let heads: Vec<&str> = heads.iter().map(String::as_str).collect();
    let rows: Vec<Vec<String>> =
        table.rows.iter().map(|row| row.iter().map(|run| run.text.clone()).collect()).collect();
    text_table(&heads, &rows, width)
}

/// Wraps lines, at most at LONGEST for readability.
fn paragraph(text: &str, width: u16) -> String {
    wrapped(text, usize::from(width.min(LONGEST)), usize::MAX).join("\n")
}

const LONGEST: u16 = 110;

fn joined(runs: &[Run]) -> String {
    runs.iter().map(|run| run.text.as_str()).collect()
}
