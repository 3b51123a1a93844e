//! Reads a text into one group per scene, parameter and norm.

use std::collections::HashMap;

use super::columns::Columns;
use super::line::{Block, Cells};
use super::text::{is_table, known, readings};
use super::{Group, Quantity, Reading, Row, TableError};
use fit::{Direction, Point, deviation, is_step, screen};

/// More lines are no table of a study.
const MOST_LINES: usize = 1_100_000;

/// Tables are compared with one another.
const MOST_TABLES: usize = 1000;

/// All tables of a text.
#[derive(Debug, Clone, PartialEq)]
pub struct Tables {
    /// One per scene, parameter and norm, in the order of their first rows.
    pub groups: Vec<Group>,
    /// What was read and what was left out, a line for each table of the text.
    pub said: Vec<String>,
}

/// # Errors
/// A text without a table, with the line and what to do.
pub fn read(bytes: &[u8], reading: &Reading) -> Result<Tables, TableError> {
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let before = &bytes[..error.valid_up_to()];
        let line = 1 + before.iter().filter(|&&byte| byte == b'\n').count() as u64;
        TableError::at(line, "not UTF-8: it is no text")
    })?;
    if let Some(ratio) = reading.ratio.filter(|ratio| !(ratio.is_finite() && *ratio > 1.0)) {
        return Err(TableError::at(
            1,
            format!("--ratio {ratio} is none: it is above 1, 2 halves the step"),
        ));
    }
    let lines = bytes.iter().filter(|&&byte| byte == b'\n').count();
    if lines > MOST_LINES {
        return Err(TableError::at(1, format!("{lines} lines: at most {MOST_LINES} are read")));
    }
    let text = text.trim_start_matches('\u{feff}');
    let mut best: Option<((usize, usize, usize), TableError)> = None;
    for blocks in readings(text) {
        let mut found: Vec<(&Block, Columns)> = Vec::new();
        for block in &blocks {
            match Columns::of(block, reading) {
                Ok(columns) => found.push((block, columns)),
                Err(error) => {
                    // What comes closest to a table says what is missing.
                    let width = block.names.len();
                    let fits = block.rows.iter().all(|row| row.cells.len() == width);
                    let rank = (usize::from(fits), known(block), block.rows.len());
                    if best.as_ref().is_none_or(|(most, _)| rank > *most) {
                        best = Some((rank, error));
                    }
                }
            }
        }
        if let Some((block, _)) = found.get(MOST_TABLES) {
            let what = format!("{} tables: at most {MOST_TABLES} are read", found.len());
            return Err(TableError::at(block.line, what));
        }
        // A log prints the table again after each level: the last has all rows.
        let longer = |at: usize| {
            let (names, rows) = (&found[at].0.names, &found[at].0.rows);
            found[at + 1..].iter().any(|(later, _)| {
                let mut pairs = rows.iter().zip(&later.rows);
                later.names == *names
                    && later.rows.len() >= rows.len()
                    && pairs.all(|(a, b)| a.cells == b.cells)
            })
        };
        let again: Vec<bool> = (0..found.len()).map(longer).collect();
        let mut kept = again.iter();
        found.retain(|_| kept.next() == Some(&false));
        if !found.is_empty() {
            let mut tables = tables(&found, reading);
            if let (Some(line), Some(last)) =
                (unread(text, &blocks, &found, reading), tables.said.last_mut())
            {
                *last += &format!("; not read: the rows of line {line}");
            }
            return Ok(tables);
        }
        // A table that is broken is not cut another way until something comes out.
        if blocks.iter().any(is_table) {
            break;
        }
    }
    let nothing = "no table: rows of numbers below a line with their names, `h,error` for example";
    Err(best.map_or_else(|| TableError::at(1, nothing), |(_, error)| error))
}

/// The first row of what else looks like a table.
fn unread(
    text: &str,
    blocks: &[Block],
    found: &[(&Block, Columns)],
    reading: &Reading,
) -> Option<u64> {
    // A single row is noise of a log, unless it has the cells of a table or stands right below it.
    let belongs = |row: &Cells| {
        let there = row.cells.iter().filter(|cell| !cell.is_empty()).count();
        found.iter().any(|(of, _)| {
            [there, row.cells.len()].contains(&of.names.len())
                || (of.end..=of.end + 2).contains(&row.line)
        })
    };
    let is_found = |block: &Block| found.iter().any(|(of, _)| of.line == block.line);
    let rows = |block: &&Block| block.rows.len() > 1 || belongs(&block.rows[0]);
    let other = blocks.iter().filter(|block| !is_found(block)).find(rows);
    // In the lines that are left the cells may be parted otherwise.
    let table = |block: &Block| {
        is_table(block) || block.rows.len() > 1 && Columns::of(block, reading).is_ok()
    };
    let of_rest = || {
        let mut taken = found.iter().map(|(block, _)| block).peekable();
        let rest = (1..).zip(text.lines()).map(|(line, text)| {
            while taken.next_if(|block| block.end < line).is_some() {}
            if taken.peek().is_some_and(|block| block.line <= line) { "" } else { text }
        });
        let rest = rest.collect::<Vec<_>>().join("\n");
        if rest.trim().is_empty() {
            return None;
        }
        readings(&rest).flatten().find(table)
    };
    other.cloned().or_else(of_rest).map(|block| block.rows[0].line)
}

fn tables(found: &[(&Block, Columns)], reading: &Reading) -> Tables {
    let (mut groups, mut said) = (Vec::new(), Vec::new());
    for (at, (block, columns)) in found.iter().enumerate() {
        let title = (found.len() > 1).then(|| {
            let same = found.iter().filter(|(other, _)| other.title == block.title).count();
            let place = format!("table {} (line {})", at + 1, block.line);
            match (block.title.trim_end_matches(':'), same) {
                ("", _) => place,
                (title, 1) => title.to_owned(),
                (title, _) => format!("{title}, {place}"),
            }
        });
        let mut of_block = Vec::new();
        rows(block, columns, reading, title.as_deref(), &mut of_block);
        share_nameless(&mut of_block);
        of_block.iter_mut().for_each(mark_missing_steps);
        groups.extend(of_block);
        said.push(match &title {
            Some(title) => format!("{title}: {}", columns.said),
            None => columns.said.clone(),
        });
    }
    Tables { groups, said }
}

fn rows(
    block: &Block,
    columns: &Columns,
    reading: &Reading,
    title: Option<&str>,
    groups: &mut Vec<Group>,
) {
    let mut places = HashMap::new();
    let mut counts: HashMap<Vec<&str>, i32> = HashMap::new();
    let rows = block.rows.iter().enumerate().filter(|(at, _)| !columns.again.contains(at));
    for (at, cells) in rows {
        let text = |place: usize| cells.cells[place].as_str();
        let step = |direction: usize| {
            columns.steps[direction].as_ref().map_or(f64::NAN, |steps| steps[at])
        };
        let (mut h, mut k) = (step(0), step(1));
        let own: Vec<&str> =
            columns.scene.iter().chain(&columns.by).map(|&place| text(place)).collect();
        if let (None, None, Some(ratio)) = (&columns.steps[0], &columns.steps[1], columns.ratio) {
            let count = counts.entry(own.clone()).or_insert(0);
            let place = if reading.in_time { &mut k } else { &mut h };
            *place = ratio.powi(-*count);
            *count += 1;
        }
        let by = columns.by.iter().map(|&place| format!("{}={}", block.names[place], text(place)));
        let scene = columns.scene.map(|place| text(place).to_owned());
        let scene: Vec<String> =
            title.map(str::to_owned).into_iter().chain(scene).chain(by).collect();
        let scene = (!scene.is_empty()).then(|| scene.join(" "));
        let entry = |entries: &Option<Vec<Option<f64>>>| entries.as_ref().and_then(|e| e[at]);
        let (floor, sigma) = (entry(&columns.floor).unwrap_or(0.0), entry(&columns.sigma));
        for (number, measured) in columns.measured.iter().enumerate() {
            let norms = [columns.norm.map(|place| text(place).to_owned()), measured.norm.clone()];
            let norms: Vec<String> = norms.into_iter().flatten().collect();
            let norm = (!norms.is_empty()).then(|| norms.join(" "));
            let there = measured.entries[at];
            let error =
                there.map_or(f64::NAN, |error| if measured.signed { error.abs() } else { error });
            let point = Point { h, k, error, floor };
            let status = columns.status.map(text).filter(|status| !status.is_empty());
            let gap = match status {
                Some(status) if status != "converged" => Some(format!("the case is {status}")),
                _ => gap(columns.quantity, &point, there.is_some(), sigma),
            };
            let key = (scene.clone(), norm, number);
            let place = *places.entry(key.clone()).or_insert(groups.len());
            if place == groups.len() {
                let (scene, norm, _) = key;
                groups.push(Group { scene, norm, quantity: columns.quantity, rows: Vec::new() });
            }
            groups[place].rows.push(Row { line: cells.line, point, sigma, gap });
        }
    }
}

fn gap(quantity: Quantity, point: &Point, there: bool, sigma: Option<f64>) -> Option<String> {
    match (quantity, sigma) {
        (_, Some(sigma)) if !is_step(sigma) => {
            return Some(format!("sigma {sigma:?} is no standard deviation"));
        }
        (Quantity::Error, Some(sigma)) if screen(point).is_ok() => {
            if let Err(why) = deviation(sigma / point.error) {
                return Some(why.to_string());
            }
        }
        _ => {}
    }
    match quantity {
        Quantity::Error if !there => Some("no error".into()),
        Quantity::Value if !there => Some("no value".into()),
        Quantity::Error => {
            screen(point).err().filter(|why| why.is_broken()).map(|why| why.to_string())
        }
        Quantity::Value if point.error.is_finite() => None,
        Quantity::Value => Some(format!("the value {} is no number", point.error)),
    }
}

/// A failed case has no norm in `cases.csv`: it is missing in all norms of its scene.
fn share_nameless(groups: &mut Vec<Group>) {
    let nameless = |group: &Group| group.norm.as_deref() == Some("");
    let named = |group: &Group, scene: &Option<String>| group.scene == *scene && !nameless(group);
    let (lost, mut kept): (Vec<Group>, Vec<Group>) =
        std::mem::take(groups).into_iter().partition(nameless);
    for group in lost {
        let takers: Vec<&mut Group> =
            kept.iter_mut().filter(|candidate| named(candidate, &group.scene)).collect();
        if takers.is_empty() {
            kept.push(group);
            continue;
        }
        for taker in takers {
            taker.rows.extend(group.rows.iter().map(|row| Row {
                gap: Some(row.gap.clone().unwrap_or_else(|| "a row without a norm".into())),
                ..row.clone()
            }));
        }
    }
    *groups = kept;
}

/// A row without h in a table that has h elsewhere is unusable; the same for k.
fn mark_missing_steps(group: &mut Group) {
    for direction in Direction::BOTH {
        let missing = |row: &Row| direction.step(&row.point).is_nan();
        if group.rows.iter().all(missing) {
            continue;
        }
        for row in group.rows.iter_mut().filter(|row| missing(row)) {
            row.gap.get_or_insert(format!("no {}", direction.name()));
        }
    }
}
