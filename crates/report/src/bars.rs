//! Horizontal bars with names and a common limit.

use plotters::style::RGBColor;

use super::ReportError;
use super::canvas::{Anchor, Canvas};
use super::legend::wrapped;
use super::palette::{COLOURS, GRID, INK};
use super::sheet::with_sheet;

/// A bar.
#[derive(Debug, Clone, PartialEq)]
pub struct Bar {
    pub name: String,
    /// The value in words, beside the bar.
    pub says: String,
    /// 1 is the limit.
    pub length: f64,
    /// Whether the bar is of the second kind.
    pub second: bool,
    /// Set if the value is not as it should be.
    pub fails: bool,
}

/// Bars of two kinds.
#[derive(Debug, Clone, PartialEq)]
pub struct Bars {
    pub bars: Vec<Bar>,
    /// What the bars of the first kind measure.
    pub first: String,
    /// What those of the second kind measure.
    pub second: String,
    pub limit: String,
}

/// Width of the picture, start of names and words, ends of the axis.
const WIDTH: f64 = 1800.0;
const NAME: f64 = 16.0;
const SAYS: f64 = 230.0;
const AXIS: (f64, f64) = (1130.0, 1560.0);
const ROW: f64 = 50.0;
const TOP: f64 = 110.0;
const TEXT: f64 = 30.0;
/// Characters of the words beside a bar, markup of scripts included.
const CHARACTERS: usize = 66;
const CHARACTER: f64 = 16.0;

impl Bars {
    /// The picture; none without bars.
    ///
    /// # Errors
    /// [`ReportError::Drawing`].
    pub fn svg(&self) -> Result<Option<String>, ReportError> {
        if self.bars.is_empty() {
            return Ok(None);
        }
        let bottom = TOP + ROW * self.bars.len() as f64;
        let mut svg = String::new();
        let canvas = Canvas::of_size(&mut svg, (WIDTH as u32, (bottom + 20.0) as u32), TEXT)?;
        let mut x = NAME;
        for (kind, words) in [(false, &self.first), (true, &self.second)] {
            if self.bars.iter().any(|bar| bar.second == kind) {
                canvas.fill_box([x, 24.0, x + 44.0, 48.0], ink(kind), 1.0)?;
                canvas.text(words, (x + 58.0, 36.0), Anchor::Left)?;
                x += 110.0 + CHARACTER * words.chars().count() as f64;
            }
        }
        for (at, label) in [(0.0, "0"), (0.5, "½"), (1.0, "1")] {
            let x = across(at);
            let (colour, width) = if at == 1.0 { (INK, 3) } else { (GRID, 2) };
            canvas.line(&[(x, TOP - 8.0), (x, bottom)], colour, width)?;
            let label = if at == 1.0 { format!("1: {}", self.limit) } else { label.into() };
            canvas.text(&label, (x, TOP - 28.0), Anchor::Centre)?;
        }
        for (i, bar) in self.bars.iter().enumerate() {
            draw(&canvas, bar, TOP + ROW * (i as f64 + 0.5))?;
        }
        canvas.finish()?;
        Ok(Some(with_sheet(&svg)))
    }
}

fn draw(canvas: &Canvas<'_>, bar: &Bar, y: f64) -> Result<(), ReportError> {
    canvas.text(&bar.name, (NAME, y), Anchor::Left)?;
    let says = wrapped(&bar.says, CHARACTERS, 1).concat();
    canvas.text(&says, (SAYS, y), Anchor::Left)?;
    // Slightly beyond the limit may still be within the accuracy, so the caller decides.
    let colour = if bar.fails { COLOURS[1] } else { ink(bar.second) };
    let shown = if bar.length.is_nan() { 1.0 } else { bar.length.clamp(0.0, 1.08) };
    canvas.fill_box([across(0.0), y - 13.0, across(shown), y + 13.0], colour, 1.0)?;
    let number = match bar.length {
        length if length.is_nan() => "no number".to_owned(),
        length if length.abs() >= 0.01 && length.abs() < 100.0 => format!("{length:.2}"),
        0.0 => "0".to_owned(),
        length => format!("{length:.0e}"),
    };
    let number = if bar.fails { format!("{number}, fails") } else { number };
    canvas.text(&number, (across(1.08) + 14.0, y), Anchor::Left)
}

fn ink(second: bool) -> RGBColor {
    COLOURS[if second { 2 } else { 0 }]
}

fn across(length: f64) -> f64 {
    AXIS.0 + length * (AXIS.1 - AXIS.0)
}

#[cfg(test)]
mod tests {
    use super::super::sheet::without;
    use super::*;

    #[test]
    fn what_fails_is_told() {
        let drawn = |length, fails| {
            let (name, says) = ("(4.7)".into(), "a <= b".into());
            let bar = Bar { name, says, length, second: false, fails };
            let words = String::new;
            let bars = Bars { bars: vec![bar], first: words(), second: words(), limit: words() };
            without(&bars.svg().unwrap().unwrap())
        };
        for (length, words) in [(0.5, "0.50"), (1.0, "1.00"), (3e-9, "3e-9"), (-0.6, "-0.60")] {
            let svg = drawn(length, false);
            assert!(svg.contains(words) && !svg.contains("fails"), "{svg}");
            assert!(!svg.contains("#D55E00"));
        }
        for length in [1.01, 1e9, f64::NAN, f64::INFINITY] {
            let svg = drawn(length, true);
            assert!(svg.contains("fails") && svg.contains("#D55E00"), "{svg}");
        }
        assert!(drawn(f64::NAN, true).contains("no number"));
        let none = Bars {
            bars: Vec::new(),
            first: String::new(),
            second: String::new(),
            limit: String::new(),
        };
        assert!(none.svg().unwrap().is_none());
    }
}
