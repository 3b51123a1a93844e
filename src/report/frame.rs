//! Logarithmic axes with ticks of their own, a title above and room for a legend beside.

use super::ReportError;
use super::canvas::{Anchor, Canvas, Place};
use super::legend::wrapped;
use super::palette::{GRID, INK};

const LEFT: f64 = 150.0;
pub(super) const RIGHT: f64 = 1160.0;
pub(super) const TOP: f64 = 190.0;
const BOTTOM: f64 = 990.0;

/// Distance of lines of text.
pub(super) const LINE: f64 = 44.0;

/// Characters of plain text in the width of the picture.
const TITLE_CHARACTERS: usize = 92;

/// Decades that get a label each; of more, every second or third does.
const LABELLED_DECADES: i32 = 8;

/// Distance that two labels of the x axis need.
const LABEL_DISTANCE: f64 = 95.0;

/// Powers of ten that a double can hold: a range outside would have no logarithm.
const EXPONENTS: std::ops::RangeInclusive<i32> = -320..=310;

/// The axes of a picture.
pub(super) struct Frame {
    x: [f64; 2],
    y: [i32; 2],
    levels: Vec<f64>,
}

impl Frame {
    /// Axes for all the given data (positive and finite): y in whole decades, x a little wider
    /// than its levels, which are its ticks. None without data.
    pub(super) fn new(data: &[(f64, f64)]) -> Option<Self> {
        let mut levels: Vec<f64> = data.iter().map(|point| point.0).collect();
        levels.sort_by(f64::total_cmp);
        levels.dedup();
        let (first, last) = (levels.first()?.ln(), levels.last()?.ln());
        let margin = (0.08 * (last - first)).max(0.2);
        let exponents = data.iter().map(|point| point.1.log10());
        let lowest = exponents.clone().fold(f64::INFINITY, f64::min).floor() as i32;
        let highest = exponents.fold(f64::NEG_INFINITY, f64::max).ceil() as i32;
        let y = [lowest.max(*EXPONENTS.start()), highest.max(lowest + 1).min(*EXPONENTS.end())];
        Some(Self { x: [first - margin, last + margin], y, levels })
    }

    /// Place of a point; y is kept within the frame.
    pub(super) fn place(&self, x: f64, y: f64) -> Place {
        let share = (x.ln() - self.x[0]) / (self.x[1] - self.x[0]);
        let decades = f64::from(self.y[1] - self.y[0]);
        let height = ((y.log10() - f64::from(self.y[0])) / decades).clamp(0.0, 1.0);
        (LEFT + share * (RIGHT - LEFT), BOTTOM - height * (BOTTOM - TOP))
    }

    /// Title, grid, ticks and labels.
    pub(super) fn draw(&self, canvas: &Canvas<'_>, title: &Title<'_>) -> Result<(), ReportError> {
        canvas.bold(title.scene, (30.0, 44.0))?;
        for (i, line) in wrapped(title.question, TITLE_CHARACTERS, 2).iter().enumerate() {
            canvas.text(line, (30.0, 44.0 + LINE * (i + 1) as f64), Anchor::Left)?;
        }
        self.draw_decades(canvas)?;
        self.draw_levels(canvas)?;
        let corners = [(LEFT, TOP), (RIGHT, TOP), (RIGHT, BOTTOM), (LEFT, BOTTOM), (LEFT, TOP)];
        canvas.line(&corners, INK, 3)?;
        canvas.text(title.x_label, (0.5 * (LEFT + RIGHT), BOTTOM + 96.0), Anchor::Centre)?;
        canvas.text(title.y_label, (34.0, 0.5 * (TOP + BOTTOM)), Anchor::Upwards)
    }

    fn draw_decades(&self, canvas: &Canvas<'_>) -> Result<(), ReportError> {
        let every = (self.y[1] - self.y[0] - 1) / LABELLED_DECADES + 1;
        for exponent in self.y[0]..=self.y[1] {
            let height = self.place(1.0, 10f64.powi(exponent)).1;
            canvas.line(&[(LEFT, height), (RIGHT, height)], GRID, 2)?;
            if (exponent - self.y[0]) % every == 0 {
                let label = format!("10{}", superscript(exponent));
                canvas.text(&label, (LEFT - 16.0, height), Anchor::Right)?;
            }
            if exponent < self.y[1] && every == 1 {
                for digit in 2..10 {
                    let height = self.place(1.0, f64::from(digit) * 10f64.powi(exponent)).1;
                    canvas.line(&[(LEFT, height), (LEFT + 12.0, height)], INK, 2)?;
                }
            }
        }
        Ok(())
    }

    fn draw_levels(&self, canvas: &Canvas<'_>) -> Result<(), ReportError> {
        let mut free_from = f64::NEG_INFINITY;
        for level in &self.levels {
            let x = self.place(*level, 1.0).0;
            canvas.line(&[(x, TOP), (x, BOTTOM)], GRID, 2)?;
            if x >= free_from {
                canvas.text(&step_label(*level), (x, BOTTOM + 36.0), Anchor::Centre)?;
                free_from = x + LABEL_DISTANCE;
            }
        }
        Ok(())
    }
}

/// The words around the axes.
pub(super) struct Title<'a> {
    pub(super) scene: &'a str,
    pub(super) question: &'a str,
    pub(super) x_label: &'a str,
    pub(super) y_label: &'a str,
}

/// A step as 1/n where it is one.
pub(super) fn step_label(step: f64) -> String {
    let inverse = 1.0 / step;
    // 1/n as computed is off by a rounding; a step of a graded grid by far more.
    if inverse > 1.5 && inverse < 1e6 && (inverse - inverse.round()).abs() < 1e-9 * inverse {
        format!("1/{}", inverse.round())
    } else if (1e-3..1e4).contains(&step) {
        format!("{}", (step * 1e4).round() / 1e4)
    } else {
        format!("{step:.1e}")
    }
}

fn superscript(exponent: i32) -> String {
    let raised = |c: char| match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        '4' => '⁴',
        '5' => '⁵',
        '6' => '⁶',
        '7' => '⁷',
        '8' => '⁸',
        '9' => '⁹',
        _ => '⁰',
    };
    exponent.to_string().chars().map(raised).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_read_as_they_should() {
        assert_eq!(superscript(-10), "⁻¹⁰");
        assert_eq!(step_label(1.0 / 49.0), "1/49");
        assert_eq!(step_label(0.3), "0.3");
    }

    #[test]
    fn the_range_is_whole_decades_and_never_empty() {
        let frame = Frame::new(&[(0.1, 0.01)]).unwrap();
        assert_eq!(frame.y, [-2, -1]);
        assert_eq!(Frame::new(&[(0.1, 3e-3), (0.2, 9e-3)]).unwrap().y, [-3, -2]);
        assert!(Frame::new(&[]).is_none());
    }
}
