//! The words beside a picture.

use plotters::style::RGBColor;

use super::ReportError;
use super::canvas::{Anchor, Canvas, SIZE};
use super::frame::{LINE, RIGHT, TOP};

/// Characters in the width of the legend.
pub(super) const LEGEND_CHARACTERS: usize = 28;

/// A solid line, or one of strokes and gaps of these lengths.
#[derive(Clone, Copy)]
pub(super) enum Stroke {
    Full,
    Broken((f64, f64)),
}

#[derive(Clone, Copy)]
pub(super) enum Sample {
    /// A line, a marker of this shape, or both.
    Series {
        stroke: Option<Stroke>,
        shape: Option<usize>,
    },
    Hollow,
    Band,
    Text,
}

pub(super) struct Legend<'a, 'b> {
    canvas: &'b Canvas<'a>,
    y: f64,
}

impl<'a, 'b> Legend<'a, 'b> {
    pub(super) fn new(canvas: &'b Canvas<'a>) -> Self {
        Self { canvas, y: TOP + 22.0 }
    }

    /// Continues below this height.
    pub(super) fn below(&mut self, y: f64) {
        self.y = self.y.max(y + LINE);
    }

    /// An entry: a sample, and its words in at most six lines. What does not fit is left to the table.
    pub(super) fn entry(
        &mut self,
        sample: Sample,
        colour: RGBColor,
        words: &str,
    ) -> Result<(), ReportError> {
        let (left, middle, right) = (RIGHT + 50.0, RIGHT + 82.0, RIGHT + 114.0);
        if self.y > f64::from(SIZE.1) - LINE {
            return Ok(());
        }
        let line = [(left, self.y), (right, self.y)];
        match sample {
            Sample::Series { stroke, shape } => {
                match stroke {
                    Some(Stroke::Full) => self.canvas.line(&line, colour, 4)?,
                    Some(Stroke::Broken(pattern)) => self.canvas.dashed(&line, colour, pattern)?,
                    None => {}
                }
                if let Some(shape) = shape {
                    self.canvas.marker((middle, self.y), shape, colour, false)?;
                }
            }
            Sample::Hollow => self.canvas.marker((middle, self.y), 0, colour, true)?,
            Sample::Band => {
                let sides = [left, self.y - 12.0, right, self.y + 12.0];
                self.canvas.fill_box(sides, colour, 0.3)?;
            }
            Sample::Text => {}
        }
        for text in wrapped(words, LEGEND_CHARACTERS, 6) {
            self.canvas.text(&text, (right + 18.0, self.y), Anchor::Left)?;
            self.y += LINE;
        }
        Ok(())
    }

    pub(super) fn space(&mut self) {
        self.y += 0.35 * LINE;
    }
}

/// Wraps to `most` lines of at most `width` characters; the last one marks an omission.
pub(super) fn wrapped(text: &str, width: usize, most: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    let cut = lines.len() > most;
    lines.truncate(most);
    if let Some(last) = lines.last_mut().filter(|_| cut) {
        last.push('…');
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_breaks_at_blanks_and_says_if_it_is_cut() {
        assert_eq!(wrapped("aa bb cc dd", 5, 2), ["aa bb", "cc dd"]);
        assert_eq!(wrapped("aa bb cc dd", 5, 1), ["aa bb…"]);
        assert!(wrapped("", 5, 1).is_empty());
    }
}
