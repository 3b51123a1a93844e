//! Reads a text into one group per scene and norm.

use std::collections::HashMap;

use super::cells::cut;
use super::columns::Columns;
use super::{Group, Reading, Row, TableError};
use crate::fit::Direction;

/// All tables of a text.
#[derive(Debug, Clone, PartialEq)]
pub struct Tables {
    /// One per scene and norm, in the order of their first rows.
    pub groups: Vec<Group>,
    /// Columns that are not understood, and not read.
    pub unknown: Vec<String>,
}

/// # Errors
/// A text that is not a table, with the line.
pub fn read(bytes: &[u8], reading: &Reading) -> Result<Tables, TableError> {
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let before = &bytes[..error.valid_up_to()];
        let line = 1 + before.iter().filter(|&&byte| byte == b'\n').count() as u64;
        TableError::at(line, "not UTF-8: it is no text")
    })?;
    let cut = cut(text.trim_start_matches('\u{feff}'))?;
    let columns = Columns::of(&cut.header, reading)?;
    columns.sizes_agree(&cut.rows)?;
    let mut groups: Vec<Group> = Vec::new();
    let mut places = HashMap::new();
    for cells in &cut.rows {
        let rows = columns.rows(cells)?;
        let name = |at: Option<usize>| at.and_then(|at| cells.cells.get(at)).cloned();
        for (row, column) in rows.into_iter().zip(&columns.measured) {
            let norms = [name(columns.norm), column.norm.clone()];
            let norms: Vec<String> = norms.into_iter().flatten().collect();
            let norm = (!norms.is_empty()).then(|| norms.join(" "));
            let key = (name(columns.scene), norm, column.at);
            let place = *places.entry(key.clone()).or_insert(groups.len());
            if place == groups.len() {
                let (scene, norm, _) = key;
                groups.push(Group { scene, norm, quantity: columns.quantity, rows: Vec::new() });
            }
            groups[place].rows.push(row);
        }
    }
    if groups.is_empty() {
        return Err(TableError::at(cut.header.line, "no rows below the header"));
    }
    share_nameless(&mut groups);
    groups.iter_mut().for_each(mark_missing_steps);
    Ok(Tables { groups, unknown: columns.unknown })
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
