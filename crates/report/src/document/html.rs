//! The document as a page that holds its pictures, up to a number of scenes; a script only sorts tables.

use super::terminal::VERDICT_HEADS;
use super::{Block, Card, Document, Equation, Figure, Run, Section, Table, Tone, terminal};
use crate::sheet;
use crate::symbols::{escaped, scripts};
use files::counted;

/// Light, or dark by the reader's system.
const STYLE: &str = include_str!("page.css");

/// Heads become buttons that sort their column.
const SCRIPT: &str = include_str!("sort.js");

/// Longer tables are folded.
const MOST_ROWS: usize = 12;

/// Scenes of a group that are shown as the page opens: two rows on a screen of 1280 px.
const MOST_CARDS: usize = 8;

/// In a report of more scenes their large pictures are the files beside the page, loaded when they are looked at.
const MOST_INSIDE: usize = 40;

pub(crate) fn page(document: &Document) -> String {
    let sections = sections(document);
    let link = |s: &Section| format!("<a href=\"#{}\">{}</a>", escaped(&s.id), escaped(&s.title));
    let parts: Vec<String> = document.sections.iter().filter(|s| s.level == 1).map(link).collect();
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>{title}</title>\n<link rel=\"icon\" href=\"data:,\">\n\
         <style>\n{STYLE}{}</style>\n</head>\n<body>\n<header>\n<h1>{title}</h1>\n<p>{}</p>\n\
         <nav aria-label=\"chapters\">{}</nav>\n</header>\n<main>\n{sections}</main>\n<script>\n{SCRIPT}</script>\n</body>\n</html>\n",
        sheet::RULES,
        escaped(&document.made_by),
        parts.join(" "),
        title = escaped(&document.title),
    )
}

/// All sections: cards of scenes side by side, other sections below a chapter folded.
fn sections(document: &Document) -> String {
    let beside = document.sections.iter().filter(|s| s.card.is_some()).count() > MOST_INSIDE;
    let alike = document.sections.chunk_by(|a, b| a.card.is_some() == b.card.is_some());
    let text = |part: &[Section]| match part.first() {
        Some(Section { card: Some(_), .. }) => cards(part, beside),
        _ => part.iter().map(section).collect(),
    };
    alike.map(text).collect()
}

/// The scenes of a group; those beyond [`MOST_CARDS`] are folded, unless a verdict in them is not as expected.
fn cards(group: &[Section], beside: bool) -> String {
    let grid = |part: &[Section]| {
        let cards: String =
            part.iter().filter_map(|s| s.card.as_ref().map(|of| card(s, of, beside))).collect();
        format!("<div class=\"cards\">\n{cards}</div>\n")
    };
    let (shown, more) = group.split_at(group.len().min(MOST_CARDS));
    if more.is_empty() {
        return grid(shown);
    }
    let missed =
        |s: &Section| s.card.iter().flat_map(|of| &of.verdict).any(|run| run.tone == Tone::Miss);
    let open = if more.iter().any(missed) { " open" } else { "" };
    let (summary, shown, more) = (counted(more.len(), "more scene"), grid(shown), grid(more));
    format!(
        "{shown}<details class=\"more\"{open}>\n<summary>{summary}</summary>\n{more}</details>\n"
    )
}

fn section(section: &Section) -> String {
    let (id, title) = (escaped(&section.id), escaped(&section.title));
    let blocks: String = section.blocks.iter().map(block).collect();
    match (section.level, section.blocks.is_empty()) {
        (1, _) => format!("<section id=\"{id}\">\n<h2>{title}</h2>\n{blocks}</section>\n"),
        (_, true) => format!("<h3 id=\"{id}\">{title}</h3>\n"),
        _ => {
            let blocks = folded(&format!("<h3>{title}</h3>"), &blocks);
            format!("<section id=\"{id}\">\n{blocks}</section>\n")
        }
    }
}

/// A scene: verdict and pictures, the rest folded.
fn card(section: &Section, card: &Card, beside: bool) -> String {
    let pictures: String =
        card.pictures.iter().map(|figure| labelled(&figure.svg, &figure.caption)).collect();
    let mut blocks = section.blocks.iter();
    let question = match section.blocks.first() {
        Some(Block::Text(runs)) => {
            blocks.next();
            joined(runs)
        }
        _ => String::new(),
    };
    let shown = |part: &Block| match part {
        Block::Figure(figure) if beside => framed(figure, &lazy(figure)),
        part => block(part),
    };
    let rest: String = blocks.map(shown).collect();
    format!(
        "<article class=\"card\" id=\"{}\">\n<h4>{}</h4>\n<p>{}</p>\n<div class=\"pair\">{pictures}</div>\n{}</article>\n",
        escaped(&section.id),
        escaped(&section.title),
        joined(&card.verdict),
        folded(&question, &rest),
    )
}

fn folded(summary: &str, text: &str) -> String {
    format!("<details>\n<summary>{summary}</summary>\n{text}</details>\n")
}

fn block(block: &Block) -> String {
    match block {
        Block::Text(runs) => format!("<p>{}</p>\n", joined(runs)),
        Block::Formulas(formulas) => {
            let lines: String = formulas.iter().map(formula).collect();
            format!("<div class=\"formulas\">\n{lines}</div>\n")
        }
        Block::Table(table) => of_table(table),
        Block::Figure(figure) => of_figure(figure),
        Block::Code(text) => format!("<pre tabindex=\"0\"><code>{}</code></pre>\n", escaped(text)),
        Block::Scene(text) => {
            folded("The scene file", &format!("<pre tabindex=\"0\">{}</pre>\n", quoted(text)))
        }
    }
}

fn formula(equation: &Equation) -> String {
    let Equation { plain, number, .. } = equation;
    format!("<p><span>{}</span> <span>{}</span></p>\n", set(plain, true), escaped(number))
}

/// Words, or a formula, with what stands low and high.
fn set(text: &str, formula: bool) -> String {
    let piece = |(sign, text): (char, String)| match sign {
        '_' => format!("<sub>{}</sub>", set(&text, formula)),
        '^' => format!("<sup>{}</sup>", set(&text, formula)),
        _ => escaped(&text),
    };
    scripts(text, formula).into_iter().map(piece).collect()
}

/// Evidence as lines of characters, which can be copied into `sweep fit`; other tables are elements that sort.
fn of_table(table: &Table) -> String {
    let caption = set(&table.caption, false);
    let has_links = table.rows.iter().flatten().any(|run| run.target.is_some());
    if table.evidence && !has_links {
        let lines = terminal::table(table, u16::MAX);
        let lines: Vec<&str> = lines.lines().filter(|line| !line.starts_with(['─', '═'])).collect();
        let lines = format!("<pre tabindex=\"0\">{}</pre>\n", quoted(&lines.join("\n")));
        return folded(&caption, &lines);
    }
    let class = |column: usize| if table.numeric[column] { " class=\"number\"" } else { "" };
    let head = |(column, head): (usize, &String)| {
        format!("<th scope=\"col\"{}>{}</th>", class(column), set(head, false))
    };
    let head: String = table.head.iter().enumerate().map(head).collect();
    let row = |cells: &Vec<Run>| {
        let cell = |(column, run)| format!("<td{}>{}</td>", class(column), of_run(run));
        format!("<tr>{}</tr>\n", cells.iter().enumerate().map(cell).collect::<String>())
    };
    let rows: String = table.rows.iter().map(row).collect();
    // A narrow window sets the cells of a verdict below each other.
    let kind = if table.head == VERDICT_HEADS { " class=\"verdicts\"" } else { "" };
    let rows = format!(
        "<div class=\"scroll\" tabindex=\"0\"><table{kind} aria-label=\"{}\">\n\
         <thead><tr>{head}</tr></thead>\n<tbody>\n{rows}</tbody>\n</table></div>\n",
        escaped(&table.caption),
    );
    let inside = match table.rows.len() > MOST_ROWS {
        true => folded(&caption, &rows),
        false => format!("<figcaption>{caption}</figcaption>\n{rows}"),
    };
    format!("<figure>\n{inside}</figure>\n")
}

/// Text between tags, where quotes stand for themselves.
fn quoted(text: &str) -> String {
    escaped(text).replace("&quot;", "\"").replace("&#39;", "'")
}

fn of_figure(figure: &Figure) -> String {
    let whole = std::slice::from_ref(figure);
    let pieces = if figure.pieces.is_empty() { whole } else { &figure.pieces };
    let kind = if figure.pieces.is_empty() { "scroll" } else { "pieces" };
    let pieces: String = pieces.iter().map(|piece| labelled(&piece.svg, &figure.caption)).collect();
    framed(figure, &format!("<div class=\"{kind}\" tabindex=\"0\">{pieces}</div>"))
}

fn framed(figure: &Figure, picture: &str) -> String {
    let (caption, file) = (escaped(&figure.caption), escaped(&figure.file));
    format!(
        "<figure>\n{picture}\n<figcaption>{caption} <a href=\"{file}\">{file}</a></figcaption>\n</figure>\n"
    )
}

/// The picture from its file.
fn lazy(figure: &Figure) -> String {
    let (caption, file) = (escaped(&figure.caption), escaped(&figure.file));
    format!(
        "<div class=\"scroll\" tabindex=\"0\"><img loading=\"lazy\" src=\"{file}\" alt=\"{caption}\"></div>"
    )
}

/// An accessible picture. The page has the style sheet of all pictures once, their paper, and sets their sizes.
fn labelled(svg: &str, caption: &str) -> String {
    let label = escaped(caption);
    let (head, rest) = svg.split_once('>').unwrap_or((svg, ""));
    let head = head.replace(" xmlns=\"http://www.w3.org/2000/svg\"", "");
    let svg = format!("{head}>{}", sheet::without(rest));
    svg.replacen("<svg ", &format!("<svg role=\"img\" aria-label=\"{label}\" "), 1)
}

fn joined(runs: &[Run]) -> String {
    runs.iter().map(of_run).collect()
}

fn of_run(run: &Run) -> String {
    let text = match run.tone {
        // A link keeps the words of its target.
        Tone::Plain | Tone::Pass if run.target.is_none() => set(&run.text, false),
        Tone::Formula => set(&run.text, true),
        _ => escaped(&run.text),
    };
    let text = text.replace('\n', "<br>");
    let text = match run.tone {
        Tone::Plain | Tone::Formula => text,
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
