//! The document as a page that needs nothing but itself: no script to read it, one to sort its tables.

use super::{Block, Document, Equation, Figure, Run, Section, Table, Tone};
use crate::sheet;
use files::harmless;

/// Light, and dark where the reader's system is.
const STYLE: &str = include_str!("page.css");

/// Heads become buttons that sort their table by their column; without it tables stand as written.
const SCRIPT: &str = include_str!("sort.js");

/// The page.
pub(crate) fn page(document: &Document) -> String {
    let sections: String = document.sections.iter().map(section).collect();
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>{title}</title>\n<link rel=\"icon\" href=\"data:,\">\n\
         <style>\n{STYLE}{}</style>\n</head>\n<body>\n<header>\n<h1>{title}</h1>\n<p>{}</p>\n\
         {}</header>\n<main>\n{sections}</main>\n<script>\n{SCRIPT}</script>\n</body>\n</html>\n",
        sheet::RULES,
        escaped(&document.made_by),
        contents(document),
        title = escaped(&document.title),
    )
}

/// Links to the chapters, and below them to the scenes.
fn contents(document: &Document) -> String {
    let link = |s: &Section| format!("<a href=\"#{}\">{}</a>", escaped(&s.id), escaped(&s.title));
    let parts: Vec<String> = document.sections.iter().filter(|s| s.level == 1).map(link).collect();
    let after = document.sections.iter().skip_while(|s| s.id != "scenes").skip(1);
    let scenes: Vec<String> = after.take_while(|s| s.level == 2).map(link).collect();
    format!("<nav><p>{}</p>\n<p class=\"scenes\">{}</p></nav>\n", parts.join(" "), scenes.join(" "))
}

fn section(section: &Section) -> String {
    let level = section.level + 1;
    let blocks: String = section.blocks.iter().map(block).collect();
    format!(
        "<section id=\"{}\">\n<h{level}>{}</h{level}>\n{blocks}</section>\n",
        escaped(&section.id),
        escaped(&section.title)
    )
}

fn block(block: &Block) -> String {
    match block {
        Block::Text(runs) => format!("<p>{}</p>\n", joined(runs)),
        Block::Formulas(formulas) => {
            format!(
                "<div class=\"formulas\">\n{}</div>\n",
                formulas.iter().map(formula).collect::<String>()
            )
        }
        Block::Table(table) => of_table(table),
        Block::Figure(figure) => of_figure(figure),
        Block::Code(text) => format!("<pre><code>{}</code></pre>\n", escaped(text)),
    }
}

fn formula(equation: &Equation) -> String {
    let set = raised(&escaped(&equation.plain));
    format!("<p><span>{set}</span> <span>{}</span></p>\n", escaped(&equation.number))
}

/// `a_b`, `a_{bc}` and `a^{bc}` with what is meant to be low or high.
fn raised(text: &str) -> String {
    let (mut result, mut rest) = (String::new(), text);
    while let Some(at) = rest.find(['_', '^']) {
        let tag = if rest[at..].starts_with('_') { "sub" } else { "sup" };
        let after = &rest[at + 1..];
        let (script, end) = match after.strip_prefix('{').and_then(|inner| inner.split_once('}')) {
            Some((inner, end)) => (inner, end),
            None => after.split_at(after.chars().next().map_or(0, char::len_utf8)),
        };
        result += &format!("{}<{tag}>{}</{tag}>", &rest[..at], raised(script));
        rest = end;
    }
    result + rest
}

fn of_table(table: &Table) -> String {
    let class = |column: usize| if table.numeric[column] { " class=\"number\"" } else { "" };
    let head: String = table
        .head
        .iter()
        .enumerate()
        .map(|(column, head)| format!("<th scope=\"col\"{}>{}</th>", class(column), escaped(head)))
        .collect();
    let row = |cells: &Vec<Run>| {
        let cell = |(column, run)| format!("<td{}>{}</td>", class(column), of_run(run));
        format!("<tr>{}</tr>\n", cells.iter().enumerate().map(cell).collect::<String>())
    };
    let rows: String = table.rows.iter().map(row).collect();
    format!(
        "<figure id=\"table-{number}\">\n<figcaption id=\"caption-{number}\">Table {number}. {}</figcaption>\n\
         <div class=\"scroll\" tabindex=\"0\"><table aria-labelledby=\"caption-{number}\">\n\
         <thead><tr>{head}</tr></thead>\n<tbody>\n{rows}</tbody>\n</table></div>\n</figure>\n",
        escaped(&table.caption),
        number = table.number,
    )
}

fn of_figure(figure: &Figure) -> String {
    // The page has the style sheet of all pictures once, and what a picture shows in words.
    let svg = sheet::without(&figure.svg);
    let label = escaped(&figure.caption);
    let svg = svg.replacen("<svg ", &format!("<svg role=\"img\" aria-label=\"{label}\" "), 1);
    let (number, file) = (figure.number, escaped(&figure.file));
    format!(
        "<figure id=\"figure-{number}\">\n<div class=\"scroll\" tabindex=\"0\">{svg}</div>\n<figcaption>Figure {number}. {label} <a href=\"{file}\">{file}</a></figcaption>\n</figure>\n"
    )
}

fn joined(runs: &[Run]) -> String {
    runs.iter().map(of_run).collect()
}

fn of_run(run: &Run) -> String {
    let text = escaped(&run.text).replace('\n', "<br>");
    let text = match run.tone {
        Tone::Plain => text,
        Tone::Strong => format!("<b>{text}</b>"),
        Tone::Code => format!("<code>{text}</code>"),
        Tone::Pass => format!("<span class=\"pass\">{text}</span>"),
        Tone::Miss => format!("<span class=\"miss\">{text}</span>"),
    };
    match &run.target {
        Some(target) => format!("<a href=\"{}\">{text}</a>", escaped(target)),
        None => text,
    }
}

fn escaped(text: &str) -> String {
    let mut result = String::with_capacity(text.len());
    for character in harmless(text).chars() {
        match character {
            '&' => result.push_str("&amp;"),
            '<' => result.push_str("&lt;"),
            '>' => result.push_str("&gt;"),
            '"' => result.push_str("&quot;"),
            '\'' => result.push_str("&#39;"),
            other => result.push(other),
        }
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scripts_are_set_low_and_high() {
        assert_eq!(raised("u_ν ≤ g"), "u<sub>ν</sub> ≤ g");
        assert_eq!(raised("P_{M(κ)}ε, ∫^{t_n}"), "P<sub>M(κ)</sub>ε, ∫<sup>t<sub>n</sub></sup>");
        assert_eq!(raised("a_"), "a<sub></sub>");
        assert_eq!(escaped("<a href='b'>&\""), "&lt;a href=&#39;b&#39;&gt;&amp;&quot;");
    }
}
