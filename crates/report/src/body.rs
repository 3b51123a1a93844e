//! A deformed plane body: stress by shade, yielding cells, pressure on Γ3 as arrows.

use super::canvas::{Anchor, Canvas, CanvasPoint, DASHES, LINE, View, corners as corners_of};
use super::canvas::{Colour, INK, colour, mixed};
use super::digits;

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

/// Area of the body: left, top, right, bottom.
const ROOM: [f64; 4] = [150.0, 160.0, 1230.0, 1030.0];
/// Longest arrow.
const ARROW: f64 = 95.0;
/// Left end of the legend.
const LEGEND: f64 = 1310.0;
/// Height of its entry on yielding cells.
const YIELDING: f64 = 640.0;
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
        let [left, top, right, bottom] = ROOM;
        let view = View::of(corners.chain(rest), [left, top, right, bottom - ARROW], false)?;
        let mut canvas = Canvas::new();
        canvas.heading(&self.title, std::slice::from_ref(&self.subtitle));
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
            let swatch = corners_of([LEGEND, YIELDING - 18.0, LEGEND + 60.0, YIELDING + 18.0]);
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
        self.legend(&mut canvas, most, largest);
        Some(canvas.finish())
    }

    fn yielding(&self) -> usize {
        self.cells.iter().filter(|cell| cell.yields).count()
    }

    /// Hatches the smaller set: yielding cells, or the others.
    fn hatched(&self) -> impl Iterator<Item = &Cell> {
        let which = 2 * self.yielding() <= self.cells.len();
        self.cells.iter().filter(move |cell| cell.yields == which)
    }

    fn legend(&self, canvas: &mut Canvas, most: f64, largest: f64) {
        let words = |canvas: &mut Canvas, words: &str, y: f64| {
            canvas.text(words, (LEGEND + 76.0, y), Anchor::Left);
        };
        canvas.text(&self.quantity, (LEGEND, 175.0), Anchor::Left);
        let (top, height) = (230.0, 330.0 / SHADES as f64);
        for i in 0..SHADES {
            let y = top + height * (SHADES - 1 - i) as f64;
            let sides = [LEGEND, y, LEGEND + 60.0, y + height];
            canvas.fill_box(sides, shade((i as f64 + 0.5) / SHADES as f64), 1.0);
        }
        words(canvas, &digits(most, 4), top);
        words(canvas, "0", top + 330.0);
        let mut y = YIELDING;
        let (all, yielding) = (self.cells.len(), self.yielding());
        if yielding > 0 {
            let hatched = match self.hatched().count() {
                0 => "all cells yield",
                count if count == yielding => "yielding:",
                _ => "elastic; yielding:",
            };
            words(canvas, hatched, y);
            if yielding < all {
                words(canvas, &format!("{yielding} of {all} cells"), y + LINE);
            }
            y += 2.0 * LINE + 16.0;
        }
        canvas.dashed(&[(LEGEND, y), (LEGEND + 60.0, y)], INK, DASHES);
        words(canvas, "body at rest", y);
        if largest > 0.0 {
            y += 60.0;
            arrow(canvas, (LEGEND, y), (-1.0, 0.0), 60.0);
            words(canvas, "pressure ξ+λ on Γ3,", y);
            words(canvas, &format!("at most {}", digits(largest, 4)), y + LINE);
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Of 953 cells in 1152 the others are hatched.
    #[test]
    fn the_fewer_cells_are_hatched() {
        let cell =
            |yields| Cell { corners: [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)], stress: 1.0, yields };
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
        let cell =
            |stress, yields| Cell { corners: [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)], stress, yields };
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
        assert!(!less.contains("yielding") && !less.contains("pressure") && !less.contains("NaN"));
        assert_eq!(svg(&Deformed { cells: Vec::new(), rest: Vec::new(), ..whole }), None);
    }
}
