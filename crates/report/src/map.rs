//! A map: one row of cells per line, each cell with words and a colour for its outcome.

use super::canvas::PAPER;
use super::canvas::{Anchor, Canvas, SIZE};
use super::canvas::{Colour, mixed};

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

const LEFT: f64 = 265.0;
const RIGHT: f64 = 1770.0;
/// Widest column.
const WIDEST: f64 = 320.0;
/// Height of text.
const TEXT: f64 = 25.0;
/// In heights of text: a line in a cell and in the notes, the rest of a row, heads, the maximal width of a character.
const LINES: f64 = 1.27;
const ROW: f64 = 0.57;
const NOTES: f64 = 1.6;
const HEADS: f64 = 2.3;
const CHARACTER: f64 = 0.56;
/// Height of the title; from the last row to the middle of the legend, and to the end.
const TITLE: f64 = 116.0;
const LEGEND: f64 = 46.0;
const MARGIN: f64 = 84.0;

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
    /// The picture.
    pub fn svg(&self) -> String {
        self.with_text(TEXT)
    }

    /// The picture with words of this height.
    pub(super) fn with_text(&self, text: f64) -> String {
        let cells = || self.rows.iter().flat_map(|(_, cells)| cells);
        let lines = cells().map(|(words, _)| words.lines().count()).max().unwrap_or(0).max(1);
        let row = (ROW + LINES * lines as f64) * text;
        let titled = if self.title.is_empty() { 0.0 } else { TITLE };
        let top = titled + if self.heads.is_empty() { 0.0 } else { HEADS * text };
        let bottom = top + row * self.rows.len() as f64;
        let notes = NOTES * text * self.notes.len() as f64;
        let mut canvas = Canvas::of_size((SIZE.0, (bottom + MARGIN + notes) as u32), text);
        canvas.heading(&self.title, std::slice::from_ref(&self.subtitle));
        let columns = self.rows.iter().map(|(_, cells)| cells.len()).max().unwrap_or(0).max(1);
        let width = ((RIGHT - LEFT) / columns as f64).min(WIDEST);
        let room = ((width - 4.0) / (CHARACTER * text)).floor() as usize;
        for (c, head) in self.heads.iter().enumerate() {
            let y = top - 0.93 * text;
            match c {
                0 => canvas.text(head, (LEFT - 16.0, y), Anchor::Right),
                _ => canvas.text(head, (LEFT + width * (c as f64 - 0.5), y), Anchor::Centre),
            }
        }
        for (r, (name, cells)) in self.rows.iter().enumerate() {
            let top = top + row * r as f64;
            canvas.text(name, (LEFT - 16.0, top + 0.5 * row), Anchor::Right);
            for (c, (words, shade)) in cells.iter().enumerate() {
                let left = LEFT + c as f64 * width;
                let sides = [left, top, left + width - 4.0, top + row - 4.0];
                let lines: Vec<String> = words.lines().map(|line| cut(line, room)).collect();
                canvas.tinted(sides, tint(*shade), &lines);
            }
        }
        let left = if self.title.is_empty() { LEFT } else { 30.0 };
        let legend = self.legend.map(|(shade, words)| (tint(shade), words));
        canvas.swatches((left, bottom + LEGEND), legend);
        for (i, note) in self.notes.iter().enumerate() {
            let y = bottom + LEGEND + NOTES * text * (i + 1) as f64;
            canvas.text(note, (left, y), Anchor::Left);
        }
        canvas.finish()
    }
}

/// Words in a room of so many characters. Truncation is marked: half a number is another number.
fn cut(words: &str, room: usize) -> String {
    let mut shown: String = words.chars().take(room.max(1)).collect();
    if shown.len() < words.len() {
        shown.pop();
        shown.push('…');
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_map_shows_every_row_and_crosses_what_is_wrong() {
        let row = |name: &str, shade| (name.to_owned(), vec![("1e50".to_owned(), shade)]);
        let map = |shade| Map {
            title: "Map".into(),
            subtitle: "rows".into(),
            rows: vec![row("units", Shade::Within(0.5)), row("gap", shade)],
            legend: [(Shade::Within(0.3), "well"), (Shade::Outside, "refused"), (shade, "wrong")],
            heads: Vec::new(),
            notes: Vec::new(),
        };
        let (right, wrong) = (map(Shade::Outside).svg(), map(Shade::Wrong).svg());
        for words in ["units", "gap", "1e50", "refused"] {
            assert!(right.contains(words), "{words}");
        }
        // Two lines to their ends in the cell, and two in the legend.
        let lines = |svg: &str| svg.matches('L').count();
        assert_eq!(lines(&wrong), lines(&right) + 4);
    }
}
