//! The document as a self-contained page; a script only sorts tables.

use super::{Block, Card, Document, Equation, Figure, Run, Section, Table, Tone};
use crate::sheet;
use crate::symbols::{indexed, replaced};
use files::counted;

/// Light, or dark by the reader's system.
const STYLE: &str = include_str!("page.css");

/// Heads become buttons that sort their column.
const SCRIPT: &str = include_str!("sort.js");

/// Longer tables are folded.
const MOST_ROWS: usize = 12;

/// Scenes of a group that are shown as the page opens: two rows on a screen of 1280 px.
const MOST_CARDS: usize = 8;

pub(crate) fn page(document: &Document) -> String {
    let sections = sections(document);
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

fn contents(document: &Document) -> String {
    let link = |s: &Section| format!("<a href=\"#{}\">{}</a>", escaped(&s.id), escaped(&s.title));
    let parts: Vec<String> = document.sections.iter().filter(|s| s.level == 1).map(link).collect();
    format!("<nav aria-label=\"chapters\">{}</nav>\n", parts.join(" "))
}

/// All sections: cards of scenes side by side, other sections below a chapter folded.
fn sections(document: &Document) -> String {
    let alike = document.sections.chunk_by(|a, b| a.card.is_some() == b.card.is_some());
    let text = |part: &[Section]| match part.first() {
        Some(Section { card: Some(_), .. }) => cards(part),
        _ => part.iter().map(section).collect(),
    };
    alike.map(text).collect()
}

/// The scenes of a group; those beyond [`MOST_CARDS`] are folded, unless a verdict in them is not as expected.
fn cards(group: &[Section]) -> String {
    let grid = |part: &[Section]| {
        let cards: String =
            part.iter().filter_map(|s| s.card.as_ref().map(|of| card(s, of))).collect();
        format!("<div class=\"cards\">\n{cards}</div>\n")
    };
    let (shown, more) = group.split_at(group.len().min(MOST_CARDS));
    if more.is_empty() {
        return grid(shown);
    }
    let missed =
        |s: &Section| s.card.iter().flat_map(|of| &of.verdict).any(|run| run.tone == Tone::Miss);
    let open = if more.iter().any(missed) { " open" } else { "" };
    let summary = counted(more.len(), "more scene");
    format!(
        "{}<details class=\"more\"{open}>\n<summary>{summary}</summary>\n{}</details>\n",
        grid(shown),
        grid(more)
    )
}

fn section(section: &Section) -> String {
    let (id, title) = (escaped(&section.id), escaped(&section.title));
    let blocks: String = section.blocks.iter().map(block).collect();
    match (section.level, section.blocks.is_empty()) {
        (1, _) => format!("<section id=\"{id}\">\n<h2>{title}</h2>\n{blocks}</section>\n"),
        (_, true) => format!("<h3 id=\"{id}\">{title}</h3>\n"),
        _ => format!(
            "<section id=\"{id}\">\n{}</section>\n",
            folded(&format!("<h3>{title}</h3>"), &blocks)
        ),
    }
}

/// A scene: verdict and pictures, the rest folded.
fn card(section: &Section, card: &Card) -> String {
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
    let rest: String = blocks.map(block).collect();
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
            format!(
                "<div class=\"formulas\">\n{}</div>\n",
                formulas.iter().map(formula).collect::<String>()
            )
        }
        Block::Table(table) => of_table(table),
        Block::Figure(figure) => of_figure(figure),
        Block::Code(text) => format!("<pre tabindex=\"0\"><code>{}</code></pre>\n", escaped(text)),
    }
}

fn formula(equation: &Equation) -> String {
    let set = raised(&escaped(&equation.plain));
    format!("<p><span>{set}</span> <span>{}</span></p>\n", escaped(&equation.number))
}

/// Words whose symbols have their index low or high.
fn with_indices(text: &str) -> String {
    indexed(text, |sign, index| {
        let tag = if sign == '_' { "sub" } else { "sup" };
        format!("<{tag}>{index}</{tag}>")
    })
}

/// `a_b`, `a_{bc}` and `a^{bc}` with low and high signs.
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
    let number = table.number;
    let class = |column: usize| if table.numeric[column] { " class=\"number\"" } else { "" };
    let head: String = table
        .head
        .iter()
        .enumerate()
        .map(|(column, head)| {
            format!("<th scope=\"col\"{}>{}</th>", class(column), with_indices(&escaped(head)))
        })
        .collect();
    let row = |cells: &Vec<Run>| {
        let cell = |(column, run)| format!("<td{}>{}</td>", class(column), of_run(run));
        format!("<tr>{}</tr>\n", cells.iter().enumerate().map(cell).collect::<String>())
    };
    let rows: String = table.rows.iter().map(row).collect();
    let caption = format!("Table {number}. {}", with_indices(&escaped(&table.caption)));
    let rows = format!(
        "<div class=\"scroll\" tabindex=\"0\"><table aria-label=\"{}\">\n\
         <thead><tr>{head}</tr></thead>\n<tbody>\n{rows}</tbody>\n</table></div>\n",
        escaped(&table.caption),
    );
    let inside = match table.evidence || table.rows.len() > MOST_ROWS {
        true => folded(&caption, &rows),
        false => format!("<figcaption>{caption}</figcaption>\n{rows}"),
    };
    format!("<figure id=\"table-{number}\">\n{inside}</figure>\n")
}

fn of_figure(figure: &Figure) -> String {
    let (number, file) = (figure.number, escaped(&figure.file));
    let whole = std::slice::from_ref(&figure.svg);
    let pieces = if figure.pieces.is_empty() { whole } else { &figure.pieces };
    let kind = if figure.pieces.is_empty() { "scroll" } else { "pieces" };
    let pieces: String = pieces.iter().map(|svg| labelled(svg, &figure.caption)).collect();
    format!(
        "<figure id=\"figure-{number}\">\n<div class=\"{kind}\" tabindex=\"0\">{pieces}</div>\n<figcaption>Figure {number}. {} <a href=\"{file}\">{file}</a></figcaption>\n</figure>\n",
        escaped(&figure.caption)
    )
}

/// An accessible picture. The page has the style sheet of all pictures once, and sets their sizes.
fn labelled(svg: &str, caption: &str) -> String {
    let label = escaped(caption);
    sheet::without(svg).replacen("<svg ", &format!("<svg role=\"img\" aria-label=\"{label}\" "), 1)
}

fn joined(runs: &[Run]) -> String {
    runs.iter().map(of_run).collect()
}

fn of_run(run: &Run) -> String {
    let text = escaped(&run.text).replace('\n', "<br>");
    let text = match run.tone {
        // A link keeps the words of its target.
        Tone::Plain | Tone::Pass if run.target.is_none() => with_indices(&text),
        _ => text,
    };
    let text = match run.tone {
        Tone::Plain => text,
        Tone::Formula => raised(&text),
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

/// Text as the content or an attribute of an element.
pub fn escaped(text: &str) -> String {
    replaced(text, |character| {
        Some(match character {
            '&' => "&amp;",
            '<' => "&lt;",
            '>' => "&gt;",
            '"' => "&quot;",
            '\'' => "&#39;",
            _ => return None,
        })
    })
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

    #[test]
    fn a_long_group_is_folded_unless_that_hides_a_miss() {
        let group = |length: usize, missed: Option<usize>| {
            let scene = |at: usize| {
                let tone = if Some(at) == missed { Tone::Miss } else { Tone::Pass };
                let mut scene = Section::new(3, &format!("scene-{at}"), "scene");
                scene.card = Some(Card { verdict: vec![Run::of("word", tone)], pictures: vec![] });
                scene
            };
            cards(&(0..length).map(scene).collect::<Vec<_>>())
        };
        assert!(!group(MOST_CARDS, None).contains("more"));
        let folded = group(MOST_CARDS + 2, Some(0));
        let (shown, more) = folded.split_once("<details class=\"more\">").expect("folded");
        assert_eq!(shown.matches("<article").count(), MOST_CARDS);
        assert!(more.contains("2 more scenes") && more.contains("id=\"scene-9\""), "{more}");
        assert!(group(MOST_CARDS + 2, Some(9)).contains("<details class=\"more\" open>"));
    }
}
