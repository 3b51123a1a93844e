//! The contact state along Γ3 over time, exact and discrete.

use super::canvas::PAPER;
use super::canvas::{Anchor, Canvas, span};
use super::canvas::{Colour, INK};
use super::frame::Frame;
use super::ruler::{Room, Ruler, Scale};

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

const LEFT: f64 = 170.0;
const RIGHT: f64 = 1770.0;
/// Overlap of neighbouring boxes.
const SEAM: f64 = 1.0;
const GUTTER: f64 = 190.0;
const TOP: f64 = 190.0;
const BOTTOM: f64 = 910.0;
const LEGEND: f64 = 1070.0;
/// Widest single panel.
const WIDEST: f64 = 1000.0;

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
        let width = ((RIGHT - LEFT - (count - 1.0) * GUTTER) / count).min(WIDEST);
        let across = Room { length: width, label: 110.0 };
        let up = Room { length: BOTTOM - TOP, label: 90.0 };
        let mut canvas = Canvas::new();
        canvas.heading(&self.title, std::slice::from_ref(&self.subtitle));
        for (i, panel) in self.panels.iter().enumerate() {
            let left = LEFT + i as f64 * (width + GUTTER);
            let x = Ruler::new(Scale::Linear, &ends, &[], across)?;
            let y = Ruler::new(Scale::Linear, &times, &[], up)?;
            let room = [left, TOP, left + width, BOTTOM];
            draw(&mut canvas, panel, &Frame { x, y, room, unit: 1.0 });
        }
        let zones = [Zone::Open, Zone::Compliant, Zone::Locked].map(Zone::shown);
        canvas.swatches((LEFT, LEGEND), zones.map(|(colour, words)| ((colour, false), words)));
        (!ends.is_empty()).then(|| canvas.finish())
    }
}

fn draw(canvas: &mut Canvas, panel: &Panel, frame: &Frame) {
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
    use super::*;

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
