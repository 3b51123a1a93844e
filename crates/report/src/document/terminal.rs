//! Blocks on a terminal: lines of text and tables of characters.

use comfy_table::presets::UTF8_HORIZONTAL_ONLY;
use comfy_table::{CellAlignment, ContentArrangement, LineStyle};

use super::{Block, Equation, Run, Table};

/// The blocks below a title.
pub(super) fn text(title: &str, blocks: &[Block], width: u16) -> String {
    let lines: Vec<String> = blocks.iter().filter_map(|own| block(own, width)).collect();
    format!("{title}\n\n{}", lines.join("\n\n"))
}

fn block(block: &Block, width: u16) -> Option<String> {
    Some(match block {
        Block::Text(runs) => joined(runs),
        Block::Formulas(formulas) => {
            let line = |Equation { plain, number, .. }: &Equation| format!("{plain}  {number}");
            formulas.iter().map(line).collect::<Vec<_>>().join("\n")
        }
        Block::Table(own) => format!("{}\n{}", own.caption, table(own, width)),
        Block::Figure(_) => return None,
        Block::Code(lines) => lines.lines().map(|line| format!("  {line}\n")).collect(),
    })
}

/// A table of characters.
pub(super) fn table(own: &Table, width: u16) -> String {
    let mut table = comfy_table::Table::new();
    table.set_content_arrangement(ContentArrangement::Dynamic).force_no_tty();
    table.set_width(width).load_style(UTF8_HORIZONTAL_ONLY.row_separator(LineStyle::none()));
    table.set_header(&own.head);
    table.add_rows(own.rows.iter().map(|row| row.iter().map(|run| run.text.clone())));
    for (column, _) in table.column_iter_mut().zip(&own.numeric).filter(|(_, numeric)| **numeric) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table.trim_fmt()
}

fn joined(runs: &[Run]) -> String {
    runs.iter().map(|run| run.text.as_str()).collect()
}
