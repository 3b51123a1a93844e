//! Text tables that fit the available width without breaking numbers or words.

use std::collections::BTreeSet;

use crate::canvas;
use crate::document::{Block, Equation, Run, Table};
use files::counted;
use judge::record::{CaseRecord, Status};
use judge::verdict::{Verdict, cell_texts};

/// Characters between columns.
const GAP: usize = 2;

/// Longer cells are prose and may be wrapped.
const PROSE: usize = 30;

/// Prose is not made narrower while there is another way.
const NARROWEST: usize = 28;

/// A table for a terminal of `width` columns. Columns without room stand in further tables, which repeat the first column.
pub(super) fn table(table: &Table, width: u16) -> String {
    let (width, rows) = (usize::from(width), &table.rows);
    let columns_of = |in_parts: bool| -> Vec<Column<'_>> {
        (0..table.head.len()).map(|at| Column::new(at, table, in_parts)).collect()
    };
    let mut columns = columns_of(false);
    if taken(&columns.iter().collect::<Vec<_>>()) > width {
        columns = columns_of(true);
    }
    let mut tables: Vec<Vec<&Column<'_>>> = vec![Vec::new()];
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
    let lines = wrapped(words, usize::from(width).saturating_sub(room).max(NARROWEST));
    let line = |(at, line): (usize, &String)| match at {
        0 => format!("{label:<room$}{line}"),
        _ => format!("{:<room$}{line}", ""),
    };
    lines.iter().enumerate().map(line).collect::<Vec<_>>().join("\n")
}

struct Column<'a> {
    at: usize,
    head: &'a str,
    numeric: bool,
    /// Characters of its longest line.
    whole: usize,
    /// Minimum without breaking a number or word.
    least: usize,
}

impl<'a> Column<'a> {
    fn new(at: usize, table: &'a Table, in_parts: bool) -> Self {
        let (numeric, head) = (table.numeric[at], table.head[at].as_str());
        let narrowest = if in_parts { 0 } else { NARROWEST };
        let cells = || table.rows.iter().filter_map(|row| row.get(at));
        let lines = || cells().flat_map(|cell| cell.text.lines());
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
        Self { at, head, numeric, whole, least: least.min(whole) }
    }
}

/// Words in lines of at most so many characters.
fn wrapped(words: &str, width: usize) -> Vec<String> {
    canvas::wrapped(words, |line| length(line) <= width)
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
fn taken(columns: &[&Column<'_>]) -> usize {
    columns.iter().map(|column| column.least + GAP).sum()
}

/// A cell in lines of at most so many characters.
fn lines(cell: &str, room: usize) -> Vec<String> {
    let mut lines = Vec::new();
    for line in cell.lines() {
        match (length(line) > room, line.contains(' ')) {
            (false, _) => lines.push(line.to_owned()),
            (true, true) => lines.extend(wrapped(line, room)),
            (true, false) => parts(line).for_each(|part| match lines.last_mut() {
                Some(last) if length(last) + length(part) <= room => last.push_str(part),
                _ => lines.push(part.to_owned()),
            }),
        }
    }
    lines
}

fn grid<'a>(columns: &[&Column<'a>], rows: &'a [Vec<Run>], width: usize) -> String {
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
    let row = |cell: &dyn Fn(&Column<'a>) -> &'a str| -> Vec<String> {
        let each = columns.iter().zip(&widths);
        let cells: Vec<_> = each.map(|(column, width)| lines(cell(column), *width)).collect();
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
    drawn.extend(row(&|column| column.head));
    drawn.push(rule("═"));
    for cells in rows {
        drawn.extend(row(&|column| cells.get(column.at).map_or("", |cell| &cell.text)));
    }
    drawn.push(rule("─"));
    drawn.join("\n")
}

// Blocks on a terminal: lines of text and tables of characters.

pub(super) fn text(title: &str, blocks: &[Block], width: u16) -> String {
    let lines: Vec<String> = blocks.iter().filter_map(|part| block(part, width)).collect();
    format!("{title}\n\n{}", lines.join("\n\n"))
}

fn block(block: &Block, width: u16) -> Option<String> {
    Some(match block {
        Block::Text(runs) => {
            paragraph(&runs.iter().map(|run| run.text.as_str()).collect::<String>(), width)
        }
        Block::Formulas(formulas) => {
            let line = |Equation { plain, number, .. }: &Equation| format!("{plain}  {number}");
            formulas.iter().map(line).collect::<Vec<_>>().join("\n")
        }
        Block::Table(table_block) => {
            format!("{}\n{}", paragraph(&table_block.caption, width), table(table_block, width))
        }
        Block::Figure(_) | Block::Scene(_) => return None,
        Block::Code(lines) => lines.lines().map(|line| format!("  {line}\n")).collect(),
    })
}

/// Wraps lines, at most at LONGEST for readability.
fn paragraph(text: &str, width: u16) -> String {
    wrapped(text, usize::from(width.min(LONGEST))).join("\n")
}

const LONGEST: u16 = 110;

// Verdicts as a text table, with reasons below.

/// Heads of the cells of verdicts.
pub(super) const VERDICT_HEADS: [&str; 7] =
    ["scene", "norm", "in", "predicted", "observed", "verdict", "by"];

/// What stands in place of an empty table.
const NOTHING_JUDGED: &str =
    "nothing was judged: every scene here says judge = false and is measured only";

/// The verdicts in `width` characters, a line each, with the theorems where they fit; below the table the reason of every
/// verdict that is not a plain pass.
pub fn verdict_table(verdicts: &[Verdict], width: u16) -> String {
    if verdicts.is_empty() {
        return NOTHING_JUDGED.into();
    }
    let mut rows: Vec<Vec<Run>> =
        verdicts.iter().map(|v| cell_texts(v).map(Run::plain).into()).collect();
    let heads = [&VERDICT_HEADS[..6], &["why"]].concat();
    let longest = |at: usize| {
        let lines = rows.iter().flat_map(|row| row[at].text.lines());
        lines.map(|line| line.chars().count()).fold(heads[at].len(), usize::max)
    };
    let others: usize = (0..6).map(longest).sum::<usize>() + 7 * GAP;
    let room = usize::from(width).saturating_sub(others);
    for row in &mut rows {
        row[6].text = short(&row[6].text, room);
    }
    let columns = 6 + usize::from(rows.iter().any(|row| !row[6].text.is_empty()));
    rows.iter_mut().for_each(|row| row.truncate(columns));
    let mut blocks = vec![table(&Table::new("", &heads[..columns], rows), width)];
    blocks.extend(reasons(verdicts, width.into()));
    blocks.join("\n")
}

/// A theorem in so many characters: without what follows it, or not at all.
fn short(why: &str, room: usize) -> String {
    let fits = |words: &&str| words.chars().count() <= room;
    let begin = why.split([':', ';']).next().unwrap_or_default();
    let number = begin.split(',').next().unwrap_or_default();
    [why, begin, number].into_iter().find(fits).unwrap_or_default().to_owned()
}

/// Verdicts and cases in numbers; tables where no cases were run.
pub(crate) fn outcome(records: &[CaseRecord], verdicts: &[Verdict]) -> String {
    let met = verdicts.iter().filter(|verdict| verdict.as_expected()).count();
    let failed = records.iter().filter(|record| matches!(record.status, Status::Failed { .. }));
    let judged = match verdicts.len() {
        0 => NOTHING_JUDGED.to_owned(),
        all => format!("{met} of {} as expected", counted(all, "verdict")),
    };
    if records.is_empty() {
        let tables: BTreeSet<_> = verdicts.iter().map(|v| (&v.scene, &v.norm)).collect();
        return format!("{judged}; {}", counted(tables.len(), "table"));
    }
    format!("{judged}; {}, {} of them failed", counted(records.len(), "case"), failed.count())
}

/// Reasons of all but plain passes; one that several orders of a scene share is stated once.
fn reasons(verdicts: &[Verdict], width: usize) -> Vec<String> {
    let explained: Vec<&Verdict> =
        verdicts.iter().filter(|verdict| !verdict.is_plain_pass()).collect();
    let shared = explained
        .chunk_by(|a, b| (&a.scene, a.decision, &a.reason) == (&b.scene, b.decision, &b.reason));
    let words = |group: &[&Verdict]| {
        let Verdict { scene, decision, reason, .. } = group[0];
        let orders =
            group.iter().map(|verdict| format!("{} in {}", verdict.norm, verdict.variable.name()));
        let orders = orders.collect::<Vec<_>>().join(", ");
        let words = format!("{scene} {orders}: {}: {reason}", decision.name());
        wrapped(&words, width.saturating_sub(4)).join("\n    ")
    };
    shared.map(words).collect()
}

#[cfg(test)]
mod tests {
    mod columns {
        use super::super::*;

        fn text_table(heads: &[&str], rows: &[Vec<String>], width: u16) -> String {
            let row = |row: &Vec<String>| row.iter().map(Run::plain).collect();
            table(&Table::new("", heads, rows.iter().map(row).collect()), width)
        }

        fn rows() -> Vec<Vec<String>> {
            let prose = "what holds because of a theorem with many words that take their room";
            ["0.0135847412", "1.2345678901"]
                .map(|number| {
                    ["contact by Gauss points", number, number, number, prose]
                        .map(str::to_owned)
                        .into()
                })
                .into()
        }

        const HEADS: [&str; 5] = ["knob", ">spectral radius", ">norm", ">(3.15)", "because"];

        /// At any width every number and word stays whole in one line.
        #[test]
        fn nothing_is_broken_at_any_width() {
            for width in [20, 40, 60, 80, 100, 140, 200] {
                let text = text_table(&HEADS, &rows(), width);
                for word in
                    ["0.0135847412", "1.2345678901", "Gauss", "theorem", "radius", "because"]
                {
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
    mod verdicts {
        use super::super::*;
        use judge::record::{NormError, V_MAX};
        use judge::verdict::{Decision, Prediction, Variable, judge};

        fn verdict(order: f64, predicted: f64) -> Verdict {
            let record = |n: u32| {
                let error = Some(f64::from(n).powf(-order));
                CaseRecord {
                    status: Status::Converged,
                    errors: vec![NormError { norm: V_MAX.into(), error, floor: Some(0.0) }],
                    ..CaseRecord::without_work("block", Some(n), 4, 0.25)
                }
            };
            let records = [8, 16, 32, 64, 128].map(record);
            let prediction = Prediction {
                why: "(5.26)".into(),
                ..Prediction::new(V_MAX, Variable::H, predicted)
            };
            judge("block", &records, &[], &prediction, Decision::Pass)
        }

        #[test]
        fn reasons_are_said_of_all_but_plain_passes() {
            let one = verdict(1.0, 1.0);
            assert_eq!(verdict_table(std::slice::from_ref(&one), 100).lines().count(), 5);
            let bound = Verdict { at_least: true, expect: Decision::Fail, ..one.clone() };
            let failed =
                Verdict { decision: Decision::Fail, reason: "because".into(), ..bound.clone() };
            for other in [&bound, &failed] {
                let text = verdict_table(&[one.clone(), other.clone()], 100);
                let reason =
                    format!("block V_max in h: {}: {}", other.decision.name(), other.reason);
                assert_eq!(text.lines().last(), Some(&*reason));
                assert_eq!(text.matches("in h:").count(), 1);
            }
        }

        #[test]
        fn the_table_fits_its_width_and_keeps_intervals_whole() {
            let mut verdicts = vec![verdict(1.7, 1.0)];
            let (scene, norm) = ("corner-reentrant-loaded".into(), "pressure_L2_max".into());
            let why = "(5.26): a theorem of many words that is too long for most tables".into();
            verdicts.push(Verdict { scene, norm, why, ..verdicts[0].clone() });
            let observed = cell_texts(&verdicts[0])[4].clone();
            for width in [80, 100, 140, 180] {
                let text = verdict_table(&verdicts, width);
                assert!(text.lines().all(|line| line.chars().count() <= width.into()), "{text}");
                assert!(
                    text.matches(&observed).count() == 2 && text.contains("unresolved"),
                    "{text}"
                );
                // One table: the verdict stands beside the order.
                assert_eq!(text.matches('═').count(), text.lines().next().unwrap().chars().count());
                // In one line: the theorem as far as it fits.
                assert!(width < 100 || text.contains("pressure_L2_max  h"), "{width}: {text}");
                assert_eq!(text.contains("(5.26)"), width >= 100, "{width}: {text}");
                assert_eq!(text.contains("many words"), width > 140, "{width}: {text}");
            }
        }
    }
}
