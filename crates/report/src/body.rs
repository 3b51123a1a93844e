//! A deformed plane body: stress by shade, yielding cells, pressure on Γ3 as arrows.

use crate::canvas::{
    Anchor, Canvas, CanvasPoint, DASHES, EDGE, LINE, TEXT, View, WIDTH, corners as corners_of,
    heading, span,
};
use crate::chart::{Frame, beside_axis};
use crate::digits;
use crate::palette::{Colour, INK, colour, mixed};
use crate::ruler::{Room, Ruler, Scale};
use crate::sheet::PAPER;

/// A triangle of the deformed mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Cell {
    pub corners: [(f64, f64); 3],
    pub stress: f64,
    /// The projection acts there.
    pub yields: bool,
}

/// The picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Deformed {
    pub title: String,
    /// Includes the magnification of displacements.
    pub subtitle: String,
    /// Meaning of the shade.
    pub quantity: String,
    pub cells: Vec<Cell>,
    pub rest: Vec<[(f64, f64); 2]>,
    /// Edges between yielding and other cells, deformed.
    pub yield_border: Vec<[(f64, f64); 2]>,
    pub arrows: Vec<Arrow>,
}

/// A pressure at a point of Γ3.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arrow {
    pub foot: (f64, f64),
    /// The direction in which it presses, of length 1.
    pub direction: (f64, f64),
    pub pressure: f64,
}

/// Height of the body with its arrows.
const TALL: f64 = 760.0;
/// Longest arrow.
const ARROW: f64 = 95.0;
/// The legend below: its second column, the width of a sample with the distance to its words, and the colour bar.
const SECOND: f64 = 520.0;
const SAMPLE: f64 = 76.0;
const BAR: f64 = 360.0;
/// Steps of the colour bar.
const SHADES: usize = 24;

/// Light to dark with monotone lightness, blue to yellow for colour-blind readers.
const RAMP: [[f64; 3]; 4] =
    [[253.0, 246.0, 214.0], [236.0, 206.0, 120.0], [122.0, 142.0, 150.0], [28.0, 58.0, 110.0]];

fn shade(part: f64) -> Colour {
    let at = part.clamp(0.0, 1.0) * (RAMP.len() - 1) as f64;
    let i = (at.floor() as usize).min(RAMP.len() - 2);
    mixed(RAMP[i], RAMP[i + 1], at - i as f64)
}

impl Deformed {
    /// The picture; none without a cell.
    pub fn svg(&self) -> Option<String> {
        let corners = self.cells.iter().flat_map(|cell| cell.corners);
        let rest = self.rest.iter().flatten().copied();
        let said = heading(&self.subtitle);
        let top = LINE * (2.0 + said.len() as f64);
        let room = [4.0 * EDGE, top, WIDTH - 4.0 * EDGE, top + TALL - ARROW];
        let view = View::of(corners.chain(rest), room)?;
        let below = top + TALL + LINE;
        let mut canvas = Canvas::new();
        canvas.heading(&self.title, &said);
        let stresses = self.cells.iter().map(|cell| cell.stress);
        let most = stresses.fold(0.0, f64::max);
        let part = |stress: f64| if most > 0.0 { stress / most } else { 0.0 };
        // Lines of a fine mesh would hide the shades.
        let lines = self.cells.len() <= 2500;
        for cell in &self.cells {
            let corners = cell.corners.map(|corner| view.place(corner));
            canvas.fill(&corners, shade(part(cell.stress)), 1.0);
            if lines {
                canvas.line(&[corners[0], corners[1], corners[2], corners[0]], THIN, 1);
            }
        }
        for &[a, b] in &self.rest {
            canvas.dashed(&[view.place(a), view.place(b)], INK, DASHES);
        }
        if self.yielding() > 0 && self.hatched().count() > 0 {
            let areas = self.hatched().map(|cell| cell.corners.map(|corner| view.place(corner)));
            let swatch = corners_of([SECOND, below - 18.0, SECOND + 60.0, below + 18.0]);
            canvas.hatch(areas.map(Vec::from).chain([swatch.into()]), colour(1));
        }
        for &[a, b] in &self.yield_border {
            canvas.line(&[view.place(a), view.place(b)], colour(1), 4);
        }
        let largest = self.arrows.iter().map(|arrow| arrow.pressure).fold(0.0, f64::max);
        for one in self.arrows.iter().filter(|arrow| arrow.pressure > 0.0) {
            let length = ARROW * one.pressure / largest;
            arrow(&mut canvas, view.place(one.foot), one.direction, length);
        }
        self.legend(&mut canvas, below, [most, largest]);
        Some(canvas.finish_at(below + 4.0 * LINE))
    }

    fn yielding(&self) -> usize {
        self.cells.iter().filter(|cell| cell.yields).count()
    }

    /// Hatches the smaller set: yielding cells, or the others.
    fn hatched(&self) -> impl Iterator<Item = &Cell> {
        let which = 2 * self.yielding() <= self.cells.len();
        self.cells.iter().filter(move |cell| cell.yields == which)
    }

    fn legend(&self, canvas: &mut Canvas, top: f64, [most, largest]: [f64; 2]) {
        let shades = BAR / SHADES as f64;
        for i in 0..SHADES {
            let x = EDGE + shades * i as f64;
            let sides = [x, top + LINE - 18.0, x + shades, top + LINE + 18.0];
            canvas.fill_box(sides, shade((i as f64 + 0.5) / SHADES as f64), 1.0);
        }
        let (below, last) = (top + 2.0 * LINE, top + 3.2 * LINE);
        canvas.text(&self.quantity, (EDGE, top), Anchor::Left);
        canvas.text("0", (EDGE, below), Anchor::Left);
        canvas.text(&digits(most, 4), (EDGE + BAR, below), Anchor::Right);
        let words = |canvas: &mut Canvas, words: &str, x: f64, y: f64| {
            canvas.text(words, (x + SAMPLE, y), Anchor::Left);
        };
        canvas.dashed(&[(EDGE, last), (EDGE + 60.0, last)], INK, DASHES);
        words(canvas, "body at rest", EDGE, last);
        let (all, yielding) = (self.cells.len(), self.yielding());
        if yielding > 0 {
            let hatched = match self.hatched().count() {
                0 => "all cells yield",
                count if count == yielding => "yielding:",
                _ => "elastic; yielding:",
            };
            words(canvas, hatched, SECOND, top);
            if yielding < all {
                words(canvas, &format!("{yielding} of {all} cells"), SECOND, top + LINE);
            }
        }
        if largest > 0.0 {
            arrow(canvas, (SECOND, last), (-1.0, 0.0), 60.0);
            let most = format!("pressure ξ+λ ≤ {}", digits(largest, 4));
            words(canvas, &most, SECOND, last);
        }
    }
}

const THIN: Colour = Colour(150, 150, 150);

/// An arrow that ends at its foot, pressing in its direction (y upwards).
fn arrow(canvas: &mut Canvas, foot: CanvasPoint, (dx, dy): (f64, f64), length: f64) {
    let (ux, uy) = (dx, -dy);
    let tail = (foot.0 - ux * length, foot.1 - uy * length);
    canvas.line(&[tail, foot], colour(0), 4);
    let head = (0.4 * length).min(16.0);
    let side = |sign: f64| {
        (foot.0 - ux * head - sign * uy * 0.5 * head, foot.1 - uy * head + sign * ux * 0.5 * head)
    };
    canvas.fill(&[foot, side(1.0), side(-1.0)], colour(0), 1.0);
}

// A small picture of a domain, readable at 240 pixels.

/// Size in units, two per pixel.
const SKETCH: (u32, u32) = (480, 404);
/// Text height: 11 pixels.
const SKETCH_TEXT: f64 = 22.0;
/// Drawing area: left, top, right, bottom. The legend is below.
const SKETCHED: [f64; 4] = [24.0, 16.0, 456.0, 292.0];
/// Legend: entries per line, height of the first line, line spacing.
const ENTRIES: usize = 2;
const FIRST_LINE: f64 = 322.0;
const NEXT_LINE: f64 = 32.0;

/// What a line or area stands for; each has a colour and a line style, for prints without colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ink {
    /// Γ1: a heavy line with hatches.
    Clamped,
    /// A plane of symmetry: a heavy line without hatches, which shows on both sides of the body moved along it.
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
    /// Lines with their words.
    pub legend: Vec<(Ink, String)>,
}

impl Sketch {
    /// Renders the picture as SVG.
    pub fn svg(&self) -> String {
        let mut canvas = Canvas::of_size(SKETCH, SKETCH_TEXT);
        let view = self.view();
        let path = |points: &[_]| points.iter().map(|&p| view.place(p)).collect::<Vec<_>>();
        for (corners, ink, opacity) in &self.areas {
            canvas.fill(&path(corners), look(*ink).0, *opacity);
        }
        for stroke in &self.strokes {
            draw(&mut canvas, stroke.ink, &path(&stroke.path));
        }
        let column = (SKETCHED[2] - SKETCHED[0]) / ENTRIES as f64;
        for (i, (ink, words)) in self.legend.iter().enumerate() {
            let x = SKETCHED[0] + column * (i % ENTRIES) as f64;
            let y = FIRST_LINE + NEXT_LINE * (i / ENTRIES) as f64;
            draw(&mut canvas, *ink, &[(x, y), (x + 36.0, y)]);
            canvas.text(words, (x + 44.0, y), Anchor::Left);
        }
        canvas.finish()
    }

    fn view(&self) -> View {
        let strokes = self.strokes.iter().flat_map(|stroke| &stroke.path);
        let areas = self.areas.iter().flat_map(|(corners, ..)| corners);
        View::of(strokes.chain(areas).copied(), SKETCHED).unwrap_or_default()
    }
}

/// Colour, width, and strokes and gaps of what is broken.
fn look(ink: Ink) -> (Colour, u32, Option<(f64, f64)>) {
    match ink {
        Ink::Clamped => (Colour(0, 0, 0), 5, None),
        Ink::Symmetry => (Colour(0, 0, 0), 9, None),
        Ink::Traction => (colour(0), 4, None),
        Ink::Contact => (colour(1), 9, None),
        Ink::Moved => (colour(2), 4, Some((18.0, 11.0))),
        Ink::Obstacle => (INK, 4, Some((4.0, 7.0))),
        Ink::Edge => (INK, 3, None),
        Ink::Region => (Colour(170, 170, 170), 18, None),
        Ink::Thin => (THIN, 1, None),
    }
}

fn draw(canvas: &mut Canvas, ink: Ink, path: &[CanvasPoint]) {
    match look(ink) {
        (colour, _, Some(pattern)) => canvas.dashed(path, colour, pattern),
        (colour, width, None) => canvas.line(path, colour, width),
    }
    if ink == Ink::Clamped {
        path.windows(2).for_each(|pair| hatches(canvas, pair[0], pair[1]));
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

// The contact state along Γ3 over time, exact and discrete.

/// State of Γ3 at a place and time; shades get darker, for prints without colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Zone {
    /// No pressure.
    Open,
    /// Pressure by the law, u_ν < g.
    Compliant,
    /// u_ν = g.
    Locked,
}

/// One panel: the zones along Γ3 at each time level.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Panel {
    pub title: String,
    /// t_n, rising.
    pub times: Vec<f64>,
    /// At each level pieces of Γ3 between two arc lengths, in order.
    pub levels: Vec<Vec<(f64, f64, Zone)>>,
}

/// The picture.
#[derive(Debug, Clone, PartialEq)]
pub struct SpaceTime {
    pub title: String,
    pub subtitle: String,
    pub panels: Vec<Panel>,
}

/// Overlap of neighbouring boxes.
const SEAM: f64 = 1.0;
/// Height of a panel, and the widest single one.
const PANEL: f64 = 480.0;
const WIDEST: f64 = 800.0;

const COMPLIANT: Colour = Colour(134, 190, 226);
const LOCKED: Colour = Colour(20, 74, 122);

impl Zone {
    /// Its colour and its words in the legend.
    fn shown(self) -> (Colour, &'static str) {
        match self {
            Self::Open => (PAPER, "open: no pressure"),
            Self::Compliant => (COMPLIANT, "compliant: pressure, u_ν < g"),
            Self::Locked => (LOCKED, "locked: u_ν = g"),
        }
    }
}

impl SpaceTime {
    /// The picture; none without a level.
    pub fn svg(&self) -> Option<String> {
        let pieces = || self.panels.iter().flat_map(|p| &p.levels).flatten();
        let ends: Vec<f64> = pieces().flat_map(|piece| [piece.0, piece.1]).collect();
        let times: Vec<f64> = self.panels.iter().flat_map(|p| &p.times).copied().collect();
        let count = self.panels.len().max(1) as f64;
        let up = Room { length: PANEL, label: 90.0 };
        let ruler = || Ruler::new(Scale::Linear, &times, &[], up);
        // The name of an axis and its labels are left of each panel.
        let beside = 1.5 * TEXT + beside_axis(&ruler()?, TEXT);
        let width = ((WIDTH - EDGE) / count - EDGE - beside).min(WIDEST);
        let across = Room { length: width, label: 110.0 };
        let said = heading(&self.subtitle);
        let top = LINE * (3.2 + said.len() as f64);
        let mut canvas = Canvas::new();
        canvas.heading(&self.title, &said);
        for (i, panel) in self.panels.iter().enumerate() {
            let left = beside + i as f64 * (width + beside + EDGE);
            let x = Ruler::new(Scale::Linear, &ends, &[], across)?;
            let room = [left, top, left + width, top + PANEL];
            draw_panel(&mut canvas, panel, &Frame { x, y: ruler()?, room, text: TEXT });
        }
        let zones = [Zone::Open, Zone::Compliant, Zone::Locked].map(Zone::shown);
        let zones = zones.map(|(colour, words)| ((colour, false), words));
        let end = canvas.swatches((EDGE, top + PANEL + 3.6 * LINE), &zones);
        (!ends.is_empty()).then(|| canvas.finish_at(end))
    }
}

fn draw_panel(canvas: &mut Canvas, panel: &Panel, frame: &Frame) {
    let [left, top, right, _] = frame.room;
    frame.draw(canvas, ["length along Γ3", "time t"]);
    canvas.text(&panel.title, (0.5 * (left + right), top - 34.0), Anchor::Centre);
    // The area outside Γ3 and the time is not an open zone.
    let ends = panel.levels.iter().flatten().map(|piece| piece.1).fold(0.0, f64::max);
    let (first, last) = span(panel.times.iter().copied());
    let all = [frame.across(0.0), frame.up(last), frame.across(ends), frame.up(first)];
    canvas.fill_box(all, PAPER, 1.0);
    // A level covers the time halfway to its neighbours.
    let halfway = |a: usize, b: usize| 0.5 * (panel.times[a] + panel.times[b]);
    let last = panel.times.len().saturating_sub(1);
    for (n, pieces) in panel.levels.iter().enumerate() {
        let from = if n == 0 { panel.times[n] } else { halfway(n - 1, n) };
        let to = if n == last { panel.times[n] } else { halfway(n, n + 1) };
        for run in pieces.chunk_by(|a, b| a.2 == b.2).filter(|run| run[0].2 != Zone::Open) {
            // Without the overlap viewers show the seam.
            let (start, end) = (frame.across(run[0].0), frame.across(run[run.len() - 1].1));
            let sides = [start, frame.up(to) - SEAM, end, frame.up(from)];
            canvas.fill_box(sides, run[0].2.shown().0, 1.0);
        }
    }
    canvas.line_box(all, INK, 3);
}

#[cfg(test)]
mod tests {
    mod body {
        use super::super::*;

        /// Of 953 cells in 1152 the others are hatched.
        #[test]
        fn the_fewer_cells_are_hatched() {
            let cell = |yields| Cell {
                corners: [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)],
                stress: 1.0,
                yields,
            };
            let picture = |yields: &[bool]| Deformed {
                title: String::new(),
                subtitle: String::new(),
                quantity: String::new(),
                cells: yields.iter().map(|yielding| cell(*yielding)).collect(),
                rest: Vec::new(),
                yield_border: Vec::new(),
                arrows: Vec::new(),
            };
            let most = picture(&[true, true, true, false]);
            assert!(most.hatched().count() == 1 && most.hatched().all(|cell| !cell.yields));
            let few = picture(&[true, false, false, false]);
            assert!(few.hatched().count() == 1 && few.hatched().all(|cell| cell.yields));
            assert!(most.svg().unwrap().contains("elastic; yielding:"));
            assert!(picture(&[true]).svg().unwrap().contains("all cells yield"));
        }

        #[test]
        fn what_is_absent_is_not_drawn() {
            let cell = |stress, yields| Cell {
                corners: [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)],
                stress,
                yields,
            };
            let whole = Deformed {
                title: "s".into(),
                subtitle: "displacements 3 times".into(),
                quantity: "‖σ^D‖".into(),
                cells: vec![cell(0.5, true), cell(1.0, false)],
                rest: vec![[(0.0, 0.0), (1.0, 0.0)]],
                yield_border: vec![[(1.0, 0.0), (0.0, 1.0)]],
                arrows: vec![Arrow { foot: (0.5, 0.0), direction: (0.0, 1.0), pressure: 2.0 }],
            };
            let svg = |picture: &Deformed| picture.svg();
            let all = svg(&whole).unwrap();
            assert!(all.contains("yielding") && all.contains("pressure") && !all.contains("NaN"));
            let elastic = Deformed {
                cells: vec![cell(0.0, false)],
                yield_border: Vec::new(),
                arrows: Vec::new(),
                ..whole.clone()
            };
            let less = svg(&elastic).unwrap();
            assert!(
                !less.contains("yielding") && !less.contains("pressure") && !less.contains("NaN")
            );
            assert_eq!(svg(&Deformed { cells: Vec::new(), rest: Vec::new(), ..whole }), None);
        }
    }
    mod sketch {
        use super::super::*;

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
        fn lengths_keep_their_ratio() {
            let plain = square();
            let view = plain.view();
            let (a, b) = (view.place((0.0, 0.0)), view.place((2.0, 1.0)));
            assert!(((b.0 - a.0) / (a.1 - b.1) - 2.0).abs() < 1e-12);
            // Hatches mark what is clamped, dashes what is moved.
            let svg = plain.svg();
            assert!(svg.matches('M').count() > 20 && svg.contains("contact"), "{svg}");
            assert!(svg.len() < 8000 && !svg.contains("NaN"));
        }
    }
    mod space_time {
        use super::super::*;

        #[test]
        fn zones_next_to_each_other_are_one_box() {
            let panel = |zone| Panel {
                title: "discrete".into(),
                times: vec![0.0, 1.0],
                levels: vec![
                    vec![(0.0, 0.5, Zone::Open), (0.5, 1.0, Zone::Open)],
                    vec![(0.0, 0.5, Zone::Locked), (0.5, 1.0, zone)],
                ],
            };
            let picture = |zone| SpaceTime {
                title: "s".into(),
                subtitle: String::new(),
                panels: vec![panel(zone)],
            };
            let boxes = |zone| picture(zone).svg().unwrap().matches("<polygon").count();
            // Four more are the empty panel and those of the legend.
            assert_eq!([Zone::Locked, Zone::Open, Zone::Compliant].map(boxes), [5, 5, 6]);
            assert_eq!(SpaceTime { panels: Vec::new(), ..picture(Zone::Open) }.svg(), None);
        }
    }
}
