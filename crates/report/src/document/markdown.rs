//! The document for a pull request: outcome, verdicts, remarks, links.

use super::content::verdict_row;
use super::verdicts::VERDICT_HEADS;
use super::{Block, Document, Equation, Figure, Run, Section, Table, Tone};
use crate::symbols::replaced;
use files::harmless;
use judge::verdict::Verdict;

/// The document as Markdown; pictures are linked, tables of evidence folded.
pub(crate) fn markdown(document: &Document) -> String {
    let mut text = format!("# {}\n\n{}\n\n", plain(&document.title), plain(&document.made_by));
    for section in &document.sections {
        text += &of_section(section);
    }
    text
}

/// The verdicts as a table, with their reasons.
pub(crate) fn verdict_rows(verdicts: &[Verdict]) -> String {
    let row = |verdict: &Verdict| {
        verdict_row(verdict, None).into_iter().chain([Run::plain(&*verdict.reason)]).collect()
    };
    let heads = [&VERDICT_HEADS[..], &["reason"]].concat();
    rows(&Table::new("", &heads, verdicts.iter().map(row).collect()))
}

fn of_section(section: &Section) -> String {
    let level = "#".repeat(section.level + 1);
    let blocks: String = section.blocks.iter().map(|b| of_block(b, section.level > 1)).collect();
    format!("<a id=\"{}\"></a>\n\n{level} {}\n\n{blocks}", section.id, plain(&section.title))
}

fn of_block(block: &Block, folded: bool) -> String {
    match block {
        Block::Text(runs) => format!("{}\n\n", runs.iter().map(of_run).collect::<String>()),
        Block::Formulas(formulas) => {
            let line =
                |Equation { plain, number, .. }: &Equation| format!("    {plain}    {number}\n");
            format!("{}\n", formulas.iter().map(line).collect::<String>())
        }
        Block::Table(table) if folded => {
            let Table { number, caption, .. } = table;
            format!(
                "<details><summary>Table {number}. {}</summary>\n\n{}\n</details>\n\n",
                html(caption),
                rows(table)
            )
        }
        Block::Table(table) => {
            format!("Table {}. {}\n\n{}\n", table.number, plain(&table.caption), rows(table))
        }
        Block::Figure(Figure { number, file, caption, .. }) => {
            format!("Figure {number}. {}\n\n![{}](<{file}>)\n\n", plain(caption), plain(caption))
        }
        Block::Code(text) => format!("```sh\n{}\n```\n\n", harmless(text)),
    }
}

fn rows(table: &Table) -> String {
    let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
    let rule = |numeric: &bool| if *numeric { "---:" } else { "---" }.to_owned();
    let mut text = line(table.head.iter().map(|head| plain(head)).collect());
    text += &line(table.numeric.iter().map(rule).collect());
    for row in &table.rows {
        text += &line(row.iter().map(of_run).collect());
    }
    text
}

fn of_run(run: &Run) -> String {
    let text = match run.tone {
        // A bar ends a cell, even in code.
        Tone::Code if run.text.is_empty() => String::new(),
        Tone::Code => format!("<code>{}</code>", html(&run.text)),
        // Closing stars must not follow a blank.
        Tone::Strong | Tone::Miss => {
            let words = run.text.trim_end();
            format!("**{}**{}", plain(words), &run.text[words.len()..])
        }
        Tone::Plain | Tone::Pass | Tone::Formula => plain(&run.text),
    };
    match &run.target {
        Some(target) => format!("[{text}](<{target}>)"),
        None => text,
    }
}

/// Escapes words.
fn plain(text: &str) -> String {
    let signs = r"& &amp; < &lt; \ \\ ` \` * \* _ \_ | \| [ \[ ] \] # \#";
    replaced(text, signs).replace('\n', "<br>")
}

/// Escapes words inside an element, where backslashes do not work.
fn html(text: &str) -> String {
    replaced(text, "& &amp; < &lt; | &#124; * &#42; _ &#95; ` &#96;").replace('\n', "<br>")
}
