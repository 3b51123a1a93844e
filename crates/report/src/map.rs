//! A map: one row of cells per line, each cell with words and a colour for its outcome.

use plotters::style::RGBColor;

use super::ReportError;
use super::canvas::{Anchor, Canvas, SIZE};
use super::palette::{INK, mixed};
use super::sheet::with_sheet;

/// How a cell ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shade {
    /// Success: from 0, far within what is allowed, to 1, just within it.
    Within(f64),
    /// Success without a number.
    Outside,
    /// Failure.
    Wrong,
}

/// A cell: its words and how it ended.
pub type Cell = (String, Shade);

/// A map.
#[derive(Debug, Clone, PartialEq)]
pub struct Map {
    pub title: String,
    /// Meaning of a row.
    pub subtitle: String,
    pub rows: Vec<(String, Vec<Cell>)>,
    /// Meanings of `Shade::Within`, `Outside` and `Wrong`.
    pub legend: [String; 3],
}

const LEFT: f64 = 265.0;
const RIGHT: f64 = 1770.0;
const TOP: f64 = 116.0;
/// Height of a row, and of text.
const ROW: f64 = 46.0;
const TEXT: f64 = 25.0;
/// From the last row to the middle of the legend, and to the end.
const LEGEND: f64 = 46.0;
const MARGIN: f64 = 84.0;
/// Maximal width of a character.
const CHARACTER: f64 = 14.0;

/// Light to dark, both light enough for dark words; then grey and vermilion.
const NEAR: [f64; 3] = [226.0, 240.0, 250.0];
const FAR: [f64; 3] = [110.0, 180.0, 228.0];
const GREY: RGBColor = RGBColor(214, 214, 214);
const VERMILION: RGBColor = RGBColor(230, 130, 60);

fn colour(shade: Shade) -> RGBColor {
    match shade {
        Shade::Within(part) => mixed(NEAR, FAR, part.clamp(0.0, 1.0)),
        Shade::Outside => GREY,
        Shade::Wrong => VERMILION,
    }
}

impl Map {
    /// The picture.
    ///
    /// # Errors
    /// [`ReportError::Drawing`].
    pub fn svg(&self) -> Result<String, ReportError> {
        let mut svg = String::new();
        let bottom = TOP + ROW * self.rows.len() as f64;
        let size = (SIZE.0, (bottom + MARGIN) as u32);
        let canvas = Canvas::of_size(&mut svg, size, TEXT)?;
        canvas.bold(&self.title, (30.0, 40.0))?;
        canvas.text(&self.subtitle, (30.0, 88.0), Anchor::Left)?;
        let columns = self.rows.iter().map(|(_, cells)| cells.len()).max().unwrap_or(0).max(1);
        let width = (RIGHT - LEFT) / columns as f64;
        for (r, (name, cells)) in self.rows.iter().enumerate() {
            let top = TOP + r as f64 * ROW;
            let middle = top + 0.5 * ROW;
            canvas.text(name, (LEFT - 16.0, middle), Anchor::Right)?;
            for (c, (words, shade)) in cells.iter().enumerate() {
                let left = LEFT + c as f64 * width;
                cell(&canvas, [left, top, left + width - 4.0, top + ROW - 4.0], words, *shade)?;
            }
        }
        let shades = [Shade::Within(0.3), Shade::Outside, Shade::Wrong];
        let mut x = 30.0;
        for (words, shade) in self.legend.iter().zip(shades) {
            cell(
                &canvas,
                [x, bottom + LEGEND - 16.0, x + 60.0, bottom + LEGEND + 16.0],
                "",
                shade,
            )?;
            canvas.text(words, (x + 76.0, bottom + LEGEND), Anchor::Left)?;
            x += 110.0 + CHARACTER * words.chars().count() as f64;
        }
        canvas.finish()?;
        Ok(with_sheet(&svg))
    }
}

/// A cell (left, top, right, bottom); failures are also crossed, for prints without colours.
fn cell(
    canvas: &Canvas<'_>,
    [left, top, right, bottom]: [f64; 4],
    words: &str,
    shade: Shade,
) -> Result<(), ReportError> {
    canvas.fill_box([left, top, right, bottom], colour(shade), 1.0)?;
    if shade == Shade::Wrong {
        canvas.line(&[(left, top), (right, bottom)], INK, 3)?;
        canvas.line(&[(left, bottom), (right, top)], INK, 3)?;
    }
    let room = ((right - left) / CHARACTER).floor() as usize;
    let mut shown: String = words.chars().take(room.max(1)).collect();
    if shown.len() < words.len() {
        // Truncation is marked: half a number is another number.
        shown.pop();
        shown.push('…');
    }
    canvas.on_tint(&shown, (0.5 * (left + right), 0.5 * (top + bottom)))
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
            legend: ["well".into(), "refused".into(), "wrong".into()],
        };
        let (right, wrong) = (map(Shade::Outside).svg().unwrap(), map(Shade::Wrong).svg().unwrap());
        for words in ["units", "gap", "1e50", "refused"] {
            assert!(right.contains(words), "{words}");
        }
        // A line to its end.
        let lines = |svg: &str| svg.matches('L').count();
        assert_eq!(lines(&wrong), lines(&right) + 2);
    }
}
