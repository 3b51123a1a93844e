//! A small picture of a domain or a few curves, readable at 240 pixels.

use super::canvas::{Anchor, Canvas, CanvasPoint, View};
use super::palette::{Colour, INK, colour};

/// Size in units, two per pixel.
const SIZE: (u32, u32) = (480, 404);
/// Text height: 11 pixels.
const TEXT: f64 = 22.0;
/// Drawing area: left, top, right, bottom. The legend is below.
const ROOM: [f64; 4] = [24.0, 16.0, 456.0, 292.0];
/// Start of words at the left margin.
const MARGIN: f64 = 1.0;
/// Legend: entries per line, height of the first line, line spacing.
const ENTRIES: usize = 2;
const FIRST_LINE: f64 = 322.0;
const NEXT_LINE: f64 = 32.0;

/// What a line or area stands for; each has a colour and a line style, for prints without colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ink {
    /// Γ1: a heavy line with hatches.
    Clamped,
    /// A plane of symmetry, in long dashes.
    Symmetry,
    /// Γ2.
    Traction,
    /// Γ3: a heavy line.
    Contact,
    /// The body moved by u(T), dashed.
    Moved,
    /// What the body may touch, dotted.
    Obstacle,
    /// An edge of a body in space.
    Edge,
    Region,
    /// Lines of the mesh, hidden edges, axes.
    Thin,
    /// The i-th curve.
    Curve(usize),
}

/// Corners, y upwards, with ink and opacity.
pub(crate) type Area = (Vec<(f64, f64)>, Ink, f64);

/// A line.
#[derive(Debug, Clone, PartialEq)]
pub struct Stroke {
    pub ink: Ink,
    /// Points, y upwards.
    pub path: Vec<(f64, f64)>,
}

/// A picture without axes.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Sketch {
    /// Drawn first.
    pub areas: Vec<Area>,
    /// Lines, the first below the others.
    pub strokes: Vec<Stroke>,
    /// Words at the left margin, at the heights of these points.
    pub words: Vec<((f64, f64), String)>,
    /// Lines with their words.
    pub legend: Vec<(Ink, String)>,
    /// Scales each axis to its room, for curves; otherwise both are equal.
    pub stretched: bool,
}

impl Sketch {
    /// Renders the picture as SVG.
    pub fn svg(&self) -> String {
        let mut canvas = Canvas::of_size(SIZE, TEXT);
        let view = self.view();
        let path = |points: &[_]| points.iter().map(|&p| view.place(p)).collect::<Vec<_>>();
        for (corners, ink, opacity) in &self.areas {
            canvas.fill(&path(corners), tint(*ink), *opacity);
        }
        for stroke in &self.strokes {
            draw(&mut canvas, stroke.ink, &path(&stroke.path));
        }
        for (place, words) in &self.words {
            canvas.text(words, (MARGIN, view.place(*place).1), Anchor::Left);
        }
        let column = (ROOM[2] - ROOM[0]) / ENTRIES as f64;
        for (i, (ink, words)) in self.legend.iter().enumerate() {
            let x = ROOM[0] + column * (i % ENTRIES) as f64;
            let y = FIRST_LINE + NEXT_LINE * (i / ENTRIES) as f64;
            draw(&mut canvas, *ink, &[(x, y), (x + 36.0, y)]);
            canvas.text(words, (x + 44.0, y), Anchor::Left);
        }
        canvas.finish()
    }

    fn view(&self) -> View {
        let strokes = self.strokes.iter().flat_map(|stroke| &stroke.path);
        let areas = self.areas.iter().flat_map(|(corners, ..)| corners);
        let words = self.words.iter().map(|(place, _)| place);
        let all = strokes.chain(areas).chain(words).copied();
        View::of(all, ROOM, self.stretched).unwrap_or_default()
    }
}

fn tint(ink: Ink) -> Colour {
    match ink {
        Ink::Clamped | Ink::Symmetry => Colour(0, 0, 0),
        Ink::Traction => colour(0),
        Ink::Contact => colour(1),
        Ink::Moved => colour(2),
        Ink::Edge | Ink::Obstacle => INK,
        Ink::Region => Colour(170, 170, 170),
        Ink::Thin => Colour(150, 150, 150),
        Ink::Curve(i) => colour(i),
    }
}

fn draw(canvas: &mut Canvas, ink: Ink, path: &[CanvasPoint]) {
    let colour = tint(ink);
    match ink {
        Ink::Clamped => {
            canvas.line(path, colour, 5);
            path.windows(2).for_each(|pair| hatches(canvas, pair[0], pair[1]))
        }
        Ink::Traction | Ink::Curve(_) => canvas.line(path, colour, 4),
        Ink::Contact => canvas.line(path, colour, 9),
        Ink::Edge => canvas.line(path, colour, 3),
        Ink::Region => canvas.line(path, colour, 18),
        Ink::Symmetry => canvas.dashed(path, colour, (30.0, 8.0)),
        Ink::Moved => canvas.dashed(path, colour, (18.0, 11.0)),
        Ink::Obstacle => canvas.dashed(path, colour, (4.0, 7.0)),
        Ink::Thin => canvas.line(path, colour, 1),
    }
}

/// Short strokes on one side of a line.
fn hatches(canvas: &mut Canvas, from: CanvasPoint, to: CanvasPoint) {
    let length = (to.0 - from.0).hypot(to.1 - from.1);
    let (along, count) = (((to.0 - from.0) / length, (to.1 - from.1) / length), length / 14.0);
    (0..count as usize).for_each(|i| {
        let s = (i as f64 + 0.5) / count.floor() * length;
        let foot = (from.0 + s * along.0, from.1 + s * along.1);
        let tip = (foot.0 + 5.0 * along.0 + 9.0 * along.1, foot.1 + 5.0 * along.1 - 9.0 * along.0);
        canvas.line(&[foot, tip], Colour(0, 0, 0), 2)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Sketch {
        let path = vec![(0.0, 0.0), (2.0, 0.0), (2.0, 1.0)];
        let stroke = |ink| Stroke { ink, path: path.clone() };
        Sketch {
            strokes: vec![stroke(Ink::Contact), stroke(Ink::Clamped)],
            legend: vec![(Ink::Contact, "contact".into()), (Ink::Moved, "u(T) x 2".into())],
            ..Sketch::default()
        }
    }

    #[test]
    fn lengths_keep_their_ratio_unless_axes_are_stretched() {
        let (plain, stretched) = (square(), Sketch { stretched: true, ..square() });
        let extent = |sketch: &Sketch| {
            let view = sketch.view();
            let (a, b) = (view.place((0.0, 0.0)), view.place((2.0, 1.0)));
            ((b.0 - a.0) / (a.1 - b.1), a, b)
        };
        assert!((extent(&plain).0 - 2.0).abs() < 1e-12);
        let (_, a, b) = extent(&stretched);
        let [left, top, ..] = ROOM;
        assert!((a.0 - left).abs() + (b.1 - top).abs() < 1e-9);
        // Hatches mark what is clamped, dashes what is moved.
        let svg = plain.svg();
        assert!(svg.matches('M').count() > 20 && svg.contains("contact"), "{svg}");
        assert!(svg.len() < 8000 && !svg.contains("NaN"));
    }
}
