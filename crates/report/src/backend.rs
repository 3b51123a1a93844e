//! What plotters draws on: an SVG without attributes that say nothing. Consecutive lines of one style are one path, and
//! scripts are set low and high.

use std::cell::RefCell;
use std::convert::Infallible;
use std::fmt::Write;
use std::rc::Rc;

use plotters::prelude::DrawingBackend;
use plotters_backend::text_anchor::HPos;
use plotters_backend::{
    BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingErrorKind, FontStyle,
    FontTransform,
};

use super::sheet::WORDS;
use super::symbols::{escaped, scripts};

/// Scripts are this much smaller, and this much lower or higher.
pub(super) const SMALLER: f64 = 0.72;
const APART: f64 = 0.3;

/// The width of curves, which a picture states once.
pub(super) const LINE_WIDTH: u32 = 4;

type Drawn = Result<(), DrawingErrorKind<Infallible>>;

/// Elements of an SVG; clones share them.
#[derive(Clone)]
pub(super) struct Elements {
    size: (u32, u32),
    /// Text height of the picture, which its words do not repeat.
    text: f64,
    written: Rc<RefCell<Vec<Element>>>,
}

enum Element {
    /// Words, which lines may pass below.
    Words(String),
    /// Lines of one style: the beginning of their element, and their data.
    Lines(String, String),
    Other(String),
}

impl Elements {
    pub(super) fn new(size: (u32, u32), text: f64) -> Self {
        Self { size, text, written: Rc::default() }
    }

    pub(super) fn text(&self) -> String {
        let text = |element: &Element| match element {
            Element::Words(text) | Element::Other(text) => format!("{text}\n"),
            Element::Lines(begins, data) => format!("{begins}{data}\"/>\n"),
        };
        self.written.borrow().iter().map(text).collect()
    }

    /// A line; one like it is continued, if only words and lines that do not cover it stand between.
    pub(super) fn line(&self, ink: &str, width: u32, more: &str, data: &str) {
        let width =
            if width == LINE_WIDTH { String::new() } else { format!(" stroke-width=\"{width}\"") };
        let begins = format!("<path fill=\"none\" stroke=\"{ink}\"{width}{more} d=\"");
        let mut written = self.written.borrow_mut();
        let passable = |element: &&mut Element| match element {
            Element::Words(_) => true,
            Element::Lines(other, _) => *other == begins || [other, &begins].iter().all(is_thin),
            Element::Other(_) => false,
        };
        let like = |element: &&mut Element| matches!(element, Element::Lines(other, _) if *other == begins);
        match written.iter_mut().rev().take_while(passable).find(like) {
            Some(Element::Lines(_, lines)) => *lines += data,
            _ => written.push(Element::Lines(begins, data.to_owned())),
        }
    }

    pub(super) fn push(&self, element: String) {
        self.written.borrow_mut().push(Element::Other(element));
    }
}

impl DrawingBackend for Elements {
    type ErrorType = Infallible;

    fn get_size(&self) -> (u32, u32) {
        self.size
    }

    fn ensure_prepared(&mut self) -> Drawn {
        Ok(())
    }

    fn present(&mut self) -> Drawn {
        Ok(())
    }

    fn draw_pixel(&mut self, (x, y): BackendCoord, colour: BackendColor) -> Drawn {
        self.fill_polygon([(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)], &colour)
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        path: I,
        style: &S,
    ) -> Drawn {
        self.line(&hex(style.color()), style.stroke_width(), "", &moves(path));
        Ok(())
    }

    fn fill_polygon<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        corners: I,
        style: &S,
    ) -> Drawn {
        let (ink, alpha) = (hex(style.color()), style.color().alpha);
        let opacity = if alpha < 1.0 { format!(" opacity=\"{alpha}\"") } else { String::new() };
        let points: String = corners.into_iter().map(|(x, y)| format!("{x},{y} ")).collect();
        self.push(format!("<polygon{opacity} fill=\"{ink}\" points=\"{points}\"/>"));
        Ok(())
    }

    fn draw_text<S: BackendTextStyle>(
        &mut self,
        words: &str,
        style: &S,
        (x, y): BackendCoord,
    ) -> Drawn {
        let (ink, size) = (hex(style.color()), style.size());
        let anchor = match style.anchor().h_pos {
            HPos::Left => "",
            HPos::Center => " text-anchor=\"middle\"",
            HPos::Right => " text-anchor=\"end\"",
        };
        let weight = match style.style() {
            FontStyle::Bold => " font-weight=\"bold\"",
            _ => "",
        };
        let turned = match style.transform() {
            FontTransform::Rotate270 => format!(" transform=\"rotate(270, {x}, {y})\""),
            _ => String::new(),
        };
        let height =
            if size == self.text { String::new() } else { format!(" font-size=\"{size}\"") };
        let fill =
            if ink == WORDS.to_string() { String::new() } else { format!(" fill=\"{ink}\"") };
        // Half of the height of an x below the middle.
        let y = y + (0.26 * size).round() as i32;
        self.written.borrow_mut().push(Element::Words(format!(
            "<text x=\"{x}\" y=\"{y}\"{anchor}{height}{fill}{weight}{turned}>{}</text>",
            set(words, size)
        )));
        Ok(())
    }
}

/// Grid and ticks, whose order does not show.
fn is_thin(begins: &&String) -> bool {
    begins.contains("stroke-width=\"2\"")
}

fn hex(BackendColor { rgb: (red, green, blue), .. }: BackendColor) -> String {
    format!("#{red:02X}{green:02X}{blue:02X}")
}

/// `M1 2l2 2h5`: from the first point through the others, by their differences.
pub(super) fn moves(path: impl IntoIterator<Item = BackendCoord>) -> String {
    let mut data = String::new();
    let mut before = None;
    for (x, y) in path {
        let _ = match before.replace((x, y)) {
            None => write!(data, "M{x} {y}"),
            Some((left, up)) => match (x - left, y - up) {
                (right, 0) => write!(data, "h{right}"),
                (0, down) => write!(data, "v{down}"),
                (right, down) if down < 0 => write!(data, "l{right}{down}"),
                (right, down) => write!(data, "l{right} {down}"),
            },
        };
    }
    data
}

/// Words with their scripts low and high.
fn set(words: &str, size: f64) -> String {
    let (shift, small) = ((APART * size).round(), (SMALLER * size).round());
    let mut back = 0.0;
    let piece = |(sign, text): (char, String)| {
        let there = match sign {
            '_' => shift,
            '^' => -shift,
            _ => 0.0,
        };
        let text = escaped(&text);
        let dy = there + std::mem::replace(&mut back, -there);
        match (there == 0.0, dy == 0.0) {
            (true, true) => text,
            // Some viewers drop a blank at the start of a piece.
            (true, false) => {
                let text =
                    text.strip_prefix(' ').map_or(text.clone(), |rest| format!("\u{a0}{rest}"));
                format!("<tspan dy=\"{dy}\">{text}</tspan>")
            }
            (false, _) => format!("<tspan dy=\"{dy}\" font-size=\"{small}\">{text}</tspan>"),
        }
    };
    scripts(words, false).into_iter().map(piece).collect()
}
