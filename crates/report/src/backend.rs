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

use super::symbols::{escaped, scripts};

/// Scripts are this much smaller, and this much lower or higher.
const SMALLER: f64 = 0.72;
const APART: f64 = 0.3;

const PATH_END: &str = "\"/>\n";

type Drawn = Result<(), DrawingErrorKind<Infallible>>;

/// Elements of an SVG; clones share them.
#[derive(Clone)]
pub(super) struct Elements {
    size: (u32, u32),
    written: Rc<RefCell<Written>>,
}

#[derive(Default)]
struct Written {
    elements: String,
    /// Beginning of the last element if it is a path, which a line of the same style continues.
    path: String,
}

impl Elements {
    pub(super) fn new(size: (u32, u32)) -> Self {
        Self { size, written: Rc::default() }
    }

    pub(super) fn text(&self) -> String {
        self.written.borrow().elements.clone()
    }

    pub(super) fn push(&self, element: &str) {
        let mut written = self.written.borrow_mut();
        written.path.clear();
        written.elements += element;
        written.elements.push('\n');
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
        let (ink, width) = (hex(style.color()), style.stroke_width());
        let begins = format!("<path fill=\"none\" stroke=\"{ink}\" stroke-width=\"{width}\" d=\"");
        let written = &mut *self.written.borrow_mut();
        if begins == written.path {
            let end = written.elements.len() - PATH_END.len();
            written.elements.truncate(end);
        } else {
            written.elements += &begins;
            written.path = begins;
        }
        written.elements += &moves(path);
        written.elements += PATH_END;
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
        self.push(&format!("<polygon{opacity} fill=\"{ink}\" points=\"{points}\"/>"));
        Ok(())
    }

    /// A disc.
    fn draw_circle<S: BackendStyle>(
        &mut self,
        (x, y): BackendCoord,
        radius: u32,
        style: &S,
        _: bool,
    ) -> Drawn {
        let ink = hex(style.color());
        self.push(&format!(
            "<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" fill=\"{ink}\" stroke-width=\"1\"/>"
        ));
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
        self.push(&format!(
            "<text x=\"{x}\" y=\"{y}\" dy=\"0.5ex\"{anchor} font-size=\"{size}\" fill=\"{ink}\"{weight}{turned}>{}</text>",
            set(words, size)
        ));
        Ok(())
    }
}

fn hex(BackendColor { rgb: (red, green, blue), .. }: BackendColor) -> String {
    format!("#{red:02X}{green:02X}{blue:02X}")
}

/// `M1 2L3 4`: from the first point through the others.
pub(super) fn moves(path: impl IntoIterator<Item = BackendCoord>) -> String {
    let mut data = String::new();
    for (i, (x, y)) in path.into_iter().enumerate() {
        let letter = if i == 0 { 'M' } else { 'L' };
        let _ = write!(data, "{letter}{x} {y}");
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
            (true, false) => format!("<tspan dy=\"{dy}\">{text}</tspan>"),
            (false, _) => format!("<tspan dy=\"{dy}\" font-size=\"{small}\">{text}</tspan>"),
        }
    };
    scripts(words, false).into_iter().map(piece).collect()
}
