//! The words beside a picture.

use super::canvas::Colour;
use super::canvas::{Anchor, Canvas, LINE};
use super::chart::Part;
use super::frame::Frame;

/// Characters in the width of the legend.
pub(super) const LEGEND_CHARACTERS: usize = 28;

pub(super) struct Legend<'a> {
    canvas: &'a mut Canvas,
    left: f64,
    y: f64,
}

impl<'a> Legend<'a> {
    pub(super) fn new(canvas: &'a mut Canvas, frame: &Frame) -> Self {
        let [_, top, right, _] = frame.room;
        Self { canvas, left: right + 50.0, y: top + 22.0 }
    }

    /// Continues below this height.
    pub(super) fn below(&mut self, y: f64) {
        self.y = self.y.max(y + LINE);
    }

    /// An entry: a sample of each part, and its words in at most six lines. What does not fit is left to the table.
    pub(super) fn entry(&mut self, parts: &[&Part], ink: (Colour, usize), words: &str) {
        let (left, right, y) = (self.left, self.left + 64.0, self.y);
        if y > self.canvas.height() - LINE {
            return;
        }
        for part in parts {
            let sample = match part {
                Part::Points(_) | Part::Hollow(_) => vec![(0.5 * (left + right), y)],
                _ => vec![(left, y), (right, y)],
            };
            part.draw(self.canvas, &sample, ink);
        }
        for text in wrapped(words, LEGEND_CHARACTERS, 6) {
            self.canvas.text(&text, (right + 18.0, self.y), Anchor::Left);
            self.y += LINE;
        }
    }

    pub(super) fn space(&mut self) {
        self.y += 0.35 * LINE;
    }
}

/// Heights or places in ascending order, moved apart, and where possible not beyond the ends.
pub(super) fn spread(wanted: &[f64], apart: f64, [low, high]: [f64; 2]) -> Vec<f64> {
    let mut places = wanted.to_vec();
    let mut least = low;
    for place in &mut places {
        *place = place.max(least);
        least = *place + apart;
    }
    let mut most = high;
    for place in places.iter_mut().rev() {
        *place = place.min(most);
        most = *place - apart;
    }
    places
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
    fn names_stand_a_line_apart_and_near_their_ends() {
        let spread = |wanted: &[f64]| spread(wanted, LINE, [190.0, 990.0]);
        assert_eq!(spread(&[300.0, 500.0]), [300.0, 500.0]);
        assert_eq!(spread(&[300.0, 300.0, 310.0]), [300.0, 300.0 + LINE, 300.0 + 2.0 * LINE]);
        assert_eq!(spread(&[990.0, 990.0]), [990.0 - LINE, 990.0]);
        assert!(spread(&[]).is_empty());
    }

    #[test]
    fn text_breaks_at_blanks_and_says_if_it_is_cut() {
        assert_eq!(wrapped("aa bb cc dd", 5, 2), ["aa bb", "cc dd"]);
        assert_eq!(wrapped("aa bb cc dd", 5, 1), ["aa bb…"]);
        assert!(wrapped("", 5, 1).is_empty());
    }
}
