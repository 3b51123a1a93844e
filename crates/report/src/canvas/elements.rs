//! Elements of an SVG, without attributes that say nothing. Consecutive lines of one style are one path, and scripts are
//! set low and high.

use super::{Anchor, Canvas, CanvasPoint};
use crate::palette::Colour;
use crate::symbols::{escaped, scripts};

/// Scripts are this much smaller, and this much lower or higher.
const SMALLER: f64 = 0.72;
const APART: f64 = 0.3;

const PATH_END: &str = "\"/>\n";

impl Canvas {
    fn push(&mut self, element: &str) {
        self.path.clear();
        self.elements += element;
        self.elements.push('\n');
    }

    pub(crate) fn line(&mut self, path: &[CanvasPoint], ink: Colour, width: u32) {
        self.stroke(path, format!("stroke=\"{ink}\" stroke-width=\"{width}\""));
    }

    /// A path of strokes of length `on` with gaps of length `off`.
    pub(crate) fn dashed(&mut self, path: &[CanvasPoint], ink: Colour, (on, off): (f64, f64)) {
        let style = format!("stroke=\"{ink}\" stroke-width=\"4\" stroke-dasharray=\"{on} {off}\"");
        self.stroke(path, style);
    }

    fn stroke(&mut self, path: &[CanvasPoint], style: String) {
        if style == self.path {
            self.elements.truncate(self.elements.len() - PATH_END.len());
        } else {
            self.elements += &format!("<path fill=\"none\" {style} d=\"");
            self.path = style;
        }
        self.elements += &moves(path);
        self.elements += PATH_END;
    }

    pub(crate) fn fill(&mut self, corners: &[CanvasPoint], ink: Colour, opacity: f64) {
        let clear = if opacity < 1.0 { format!(" opacity=\"{opacity}\"") } else { String::new() };
        let points = corners.iter().map(|corner| pixel(*corner));
        let points: String = points.map(|(x, y)| format!("{x},{y} ")).collect();
        self.push(&format!("<polygon{clear} fill=\"{ink}\" points=\"{points}\"/>"));
    }

    /// Areas under lines from lower left to upper right.
    pub(crate) fn hatch(&mut self, areas: impl Iterator<Item = Vec<CanvasPoint>>, colour: Colour) {
        let data: String = areas.map(|corners| moves(&corners) + "Z").collect();
        self.push(&format!(
            "<pattern id=\"hatch\" patternUnits=\"userSpaceOnUse\" width=\"13\" height=\"13\" patternTransform=\"rotate(45)\">\
             <path fill=\"none\" stroke=\"{colour}\" stroke-width=\"3\" d=\"M6 0L6 13\"/></pattern>\n\
             <path fill=\"url(#hatch)\" d=\"{data}\"/>"
        ));
    }

    pub(super) fn disc(&mut self, centre: CanvasPoint, radius: f64, ink: Colour) {
        let (x, y) = pixel(centre);
        self.push(&format!(
            "<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" fill=\"{ink}\" stroke-width=\"1\"/>"
        ));
    }

    /// Words; `weight` is an attribute or empty.
    pub(super) fn styled(
        &mut self,
        words: &str,
        place: CanvasPoint,
        anchor: Anchor,
        (weight, ink): (&str, Colour),
    ) {
        if words.is_empty() {
            return;
        }
        let ((x, y), size) = (pixel(place), self.text);
        let from = match anchor {
            Anchor::Left => "",
            Anchor::Centre | Anchor::Upwards => " text-anchor=\"middle\"",
            Anchor::Right => " text-anchor=\"end\"",
        };
        let turned = match anchor {
            Anchor::Upwards => format!(" transform=\"rotate(270, {x}, {y})\""),
            _ => String::new(),
        };
        self.push(&format!(
            "<text x=\"{x}\" y=\"{y}\" dy=\"0.5ex\"{from} font-size=\"{size}\" fill=\"{ink}\"{weight}{turned}>{}</text>",
            set(words, size)
        ));
    }
}

/// `M1 2L3 4`: from the first point through the others.
fn moves(path: &[CanvasPoint]) -> String {
    let letters = std::iter::once('M').chain(std::iter::repeat('L'));
    let places = path.iter().map(|place| pixel(*place));
    letters.zip(places).map(|(letter, (x, y))| format!("{letter}{x} {y}")).collect()
}

fn pixel((x, y): CanvasPoint) -> (i32, i32) {
    (x.round() as i32, y.round() as i32)
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
