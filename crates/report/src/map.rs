//! A map: one row of cells per line, each cell with words and a colour for its outcome.

use crate::SceneSummary;
use crate::canvas::{Anchor, Canvas, EDGE, LINE, TEXT, WIDTH, breadth, heading, lines};
use crate::convergence::norms;
use crate::palette::{Colour, mixed};
use crate::ruler::step_label;
use crate::sheet::PAPER;
use judge::fit::{Direction, JointFit, Point, joint_fits, screen};
use judge::record::{CaseRecord, norm_label};

/// How a cell ended.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Shade {
    /// There is no such cell.
    #[default]
    Absent,
    /// Success: from 0, far within what is allowed, to 1, just within it.
    Within(f64),
    /// Success without a number.
    Outside,
    /// Failure.
    Wrong,
    /// Shared by two parts: from 0, all of the first, to 1, all of the second.
    Shared(f64),
}

/// A cell: its lines of words and how it ended.
pub type Cell = (String, Shade);

/// A map.
#[derive(Debug, Clone, PartialEq)]
pub struct Map {
    /// In bold; empty if a heading above the picture says it.
    pub title: String,
    pub subtitle: String,
    /// Above the names of rows, and above the columns; none: columns without names.
    pub heads: Vec<String>,
    pub rows: Vec<(String, Vec<Cell>)>,
    /// Meanings of shades.
    pub legend: [(Shade, &'static str); 3],
    /// Lines below the legend.
    pub notes: Vec<String>,
}

/// Widest column, and the distance of two cells.
const WIDEST: f64 = 320.0;
const GAP: f64 = 4.0;
/// The rest of the height of a row, and of the width of a cell beside its words.
const PADDING: f64 = 18.0;
/// Longer names of rows are broken.
const NAME: f64 = 7.5;

/// Light to dark, both light enough for dark words; then grey and vermilion.
const NEAR: [f64; 3] = [226.0, 240.0, 250.0];
const FAR: [f64; 3] = [110.0, 180.0, 228.0];
const GREY: Colour = Colour(214, 214, 214);
const VERMILION: Colour = Colour(230, 130, 60);

/// All of the first part, both alike, all of the second: light enough for dark words.
const FIRST: [f64; 3] = [140.0, 190.0, 226.0];
const BOTH: [f64; 3] = [246.0, 246.0, 246.0];
const SECOND: [f64; 3] = [242.0, 180.0, 134.0];

/// The colour of a cell, and whether it is crossed for prints without colours.
fn tint(shade: Shade) -> (Colour, bool) {
    match shade {
        Shade::Absent => (PAPER, false),
        Shade::Within(part) => (mixed(NEAR, FAR, part.clamp(0.0, 1.0)), false),
        Shade::Outside => (GREY, false),
        Shade::Wrong => (VERMILION, true),
        Shade::Shared(part) => {
            let end = if part < 0.5 { FIRST } else { SECOND };
            (mixed(BOTH, end, (2.0 * part - 1.0).abs().min(1.0)), false)
        }
    }
}

impl Map {
    /// The picture. Below heads cells stand in columns; without any each is as wide as its words, and a row that is too long
    /// goes on below.
    pub fn svg(&self) -> String {
        let rows = self.rows.iter().map(|(name, cells)| (broken(name), cells));
        let rows: Vec<(Vec<String>, &Vec<Cell>)> = rows.collect();
        let names = rows.iter().flat_map(|(name, _)| name).chain(self.heads.first());
        let left = EDGE + TEXT * (0.5 + names.map(|name| breadth(name)).fold(0.0, f64::max));
        let most = rows.iter().map(|(_, cells)| cells.len()).max().unwrap_or(0).max(1);
        let column = ((WIDTH - EDGE - left) / most as f64).min(WIDEST);
        let width = |cell: &Cell| match self.heads.is_empty() {
            true => TEXT * breadth(&cell.0) + PADDING + GAP,
            false => column,
        };
        let titles = if self.title.is_empty() { Vec::new() } else { heading(&self.subtitle) };
        let mut y = if self.title.is_empty() { 0.0 } else { LINE * (1.7 + titles.len() as f64) };
        let mut canvas = Canvas::new();
        canvas.heading(&self.title, &titles);
        for (c, head) in self.heads.iter().enumerate() {
            let across = left + column * (c as f64 - 0.5);
            match c {
                0 => canvas.text(head, (left - 0.5 * TEXT, y + LINE), Anchor::Right),
                _ => canvas.text(head, (across, y + LINE), Anchor::Centre),
            }
        }
        y += if self.heads.is_empty() { 0.0 } else { 1.6 * LINE };
        for (name, cells) in rows {
            let said = |cell: &Cell| -> Vec<String> {
                let room = (width(cell) - GAP) / TEXT;
                cell.0.lines().flat_map(|line| lines(line, room)).collect()
            };
            let tallest = cells.iter().map(|cell| said(cell).len()).max().unwrap_or(0).max(1);
            let (row, top, mut x) = (PADDING + LINE * tallest as f64, y, left);
            for cell in cells {
                if x > left && x + width(cell) > WIDTH - EDGE + GAP {
                    (x, y) = (left, y + row);
                }
                let sides = [x, y, x + width(cell) - GAP, y + row - GAP];
                canvas.tinted(sides, tint(cell.1), &said(cell));
                x += width(cell);
            }
            y = (y + row).max(top + LINE * name.len() as f64);
            let middle = 0.5 * (top + y - LINE * (name.len() as f64 - 1.0));
            canvas.lines(&name, (left - 0.5 * TEXT, middle), LINE, Anchor::Right);
        }
        let legend = self.legend.map(|(shade, words)| (tint(shade), words));
        y = canvas.swatches((EDGE, y + LINE), &legend);
        let notes: Vec<String> = self.notes.iter().flat_map(|note| heading(note)).collect();
        canvas.lines(&notes, (EDGE, y), LINE, Anchor::Left);
        canvas.finish_at(y + LINE * (notes.len() as f64 - 0.4))
    }
}

/// A name in lines, broken behind a dash.
fn broken(name: &str) -> Vec<String> {
    let parts =
        if breadth(name) > NAME { name.split_inclusive('-') } else { name.split_inclusive('\n') };
    parts.map(str::to_owned).collect()
}

// The error over h and k: a cell per run, with its error and the share that the fitted model attributes to either step.

/// The picture of one scene; None if no norm has a grid of h and k from which both parts can be fitted.
pub fn split_svg(scene: &SceneSummary, records: &[CaseRecord]) -> Option<String> {
    let (norm, rows) = grid(scene, records)?;
    let points: Vec<Point> = rows.iter().flatten().copied().collect();
    let best = joint_fits(&points, false).ok()?.best;
    let mut steps: Vec<f64> = points.iter().map(|point| point.k).collect();
    steps.sort_by(|a, b| b.total_cmp(a));
    steps.dedup();
    let row = |row: &Vec<Point>| {
        let at = |k: &f64| row.iter().find(|point| point.k == *k);
        let cells = steps.iter().map(|k| at(k).map_or_else(Cell::default, |p| cell(p, &best)));
        (row.first().map_or_else(String::new, |point| step_label(point.h)), cells.collect())
    };
    let mut notes = vec![format!(
        "{}; {} model, p = {:.2} in h, q = {:.2} in k",
        norm_label(&norm),
        best.model.name(),
        best.order_h.value,
        best.order_k.value
    )];
    if points.iter().any(|point| screen(point).is_err()) {
        notes.push("[in brackets]: below the floor of the error".into());
    }
    let map = Map {
        title: String::new(),
        subtitle: String::new(),
        heads: std::iter::once("h \\ k".into())
            .chain(steps.iter().copied().map(step_label))
            .collect(),
        rows: rows.iter().map(row).collect(),
        legend: [
            (Shade::Shared(0.0), "the error is of h"),
            (Shade::Shared(0.5), "of both alike"),
            (Shade::Shared(1.0), "of k"),
        ],
        notes,
    };
    Some(map.svg())
}

/// The error of a run, and the larger share in it.
fn cell(point: &Point, fit: &JointFit) -> Cell {
    let of_k = fit.share(Direction::Time, point);
    let error = match screen(point) {
        Ok(_) => format!("{:.1e}", point.error),
        Err(_) => format!("[{:.1e}]", point.error),
    };
    let share = match of_k {
        more if more >= 0.5 => format!("{:.0} % of k", 100.0 * more),
        less => format!("{:.0} % of h", 100.0 * (1.0 - less)),
    };
    (format!("{error}\n{share}"), Shade::Shared(of_k))
}

/// The first norm with two levels of h and of k, and its points: a row per h, coarse to fine, along falling k.
fn grid(scene: &SceneSummary, records: &[CaseRecord]) -> Option<(String, Vec<Vec<Point>>)> {
    let records: Vec<&CaseRecord> =
        records.iter().filter(|record| record.scene == scene.name).collect();
    let norms = norms(records.iter().copied()).into_iter();
    let mut all = norms.map(|norm| (norm, rows(&records, norm)));
    let is_grid = |rows: &[Vec<Point>]| rows.len() >= 2 && rows.iter().any(|row| row.len() >= 2);
    let (norm, rows) = all.find(|(_, rows)| is_grid(rows))?;
    Some((norm.to_owned(), rows))
}

fn rows(records: &[&CaseRecord], norm: &str) -> Vec<Vec<Point>> {
    let point = |record: &&CaseRecord| {
        let entry = record.norm(norm).filter(|_| record.converged())?;
        let error = entry.error.filter(|error| *error > 0.0 && error.is_finite())?;
        Some(Point { h: record.h?, k: record.k, error, floor: entry.floor.unwrap_or(0.0) })
    };
    let mut points: Vec<Point> = records.iter().filter_map(point).collect();
    points.sort_by(|a, b| b.h.total_cmp(&a.h).then(b.k.total_cmp(&a.k)));
    points.chunk_by(|a, b| a.h == b.h).map(<[Point]>::to_vec).collect()
}

#[cfg(test)]
mod tests {
    mod map {
        use super::super::*;

        #[test]
        fn a_map_shows_every_row_and_crosses_what_is_wrong() {
            let row = |name: &str, shade| (name.to_owned(), vec![("1e50".to_owned(), shade)]);
            let map = |shade| Map {
                title: "Map".into(),
                subtitle: "rows".into(),
                rows: vec![row("units", Shade::Within(0.5)), row("gap", shade)],
                legend: [
                    (Shade::Within(0.3), "well"),
                    (Shade::Outside, "refused"),
                    (shade, "wrong"),
                ],
                heads: Vec::new(),
                notes: Vec::new(),
            };
            let (right, wrong) = (map(Shade::Outside).svg(), map(Shade::Wrong).svg());
            for words in ["units", "gap", "1e50", "refused"] {
                assert!(right.contains(words), "{words}");
            }
            // Two lines to their ends in the cell, and two in the legend.
            let lines = |svg: &str| svg.matches('M').count();
            assert_eq!(lines(&wrong), lines(&right) + 4);
        }
    }
    mod split {
        use super::super::*;
        use judge::record::{NormError, Status};

        fn drawn(error: impl Fn(f64, f64) -> f64) -> String {
            let grid =
                [4u32, 8, 16, 32].into_iter().flat_map(|n| [4u32, 8, 16, 32].map(|s| (n, s)));
            let case = |(n, steps): (u32, u32)| {
                let (h, k) = (1.0 / f64::from(n), 1.0 / f64::from(steps));
                let error = Some(error(h, k));
                CaseRecord {
                    status: Status::Converged,
                    errors: vec![NormError { norm: "V_max".into(), error, floor: Some(1e-12) }],
                    ..CaseRecord::without_work("s", Some(n), steps, k)
                }
            };
            let records: Vec<CaseRecord> = grid.map(case).collect();
            let scene = SceneSummary { name: "s".into(), ..SceneSummary::default() };
            split_svg(&scene, &records).unwrap()
        }

        /// h + k² with equal constants: a coarse mesh with many steps has the error of h, few steps on a fine mesh that of
        /// k; and the reverse with exchanged roles.
        #[test]
        fn the_larger_part_is_named() {
            let of_space = drawn(|h, k| h + k * k);
            let of_time = drawn(|h, k| h * h + k);
            let count = |svg: &str, words: &str| svg.matches(words).count();
            assert!(count(&of_space, " % of h") > count(&of_space, " % of k"));
            assert!(count(&of_time, " % of k") > count(&of_time, " % of h"));
            for svg in [&of_space, &of_time] {
                assert_eq!(count(svg, " % of h") + count(svg, " % of k"), 16);
                assert!(!svg.contains("NaN"));
            }
            // h = k = 1/4: 1/4 against 1/16.
            assert!(of_space.contains("80 % of h") && of_time.contains("80 % of k"));
        }
    }
}
