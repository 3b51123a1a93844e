//! The contact state along Γ3 over time, exact and discrete.

use plotters::style::RGBColor;

use super::ReportError;
use super::canvas::{Anchor, Canvas};
use super::palette::INK;
use super::ruler::{Room, Ruler, Scale};
use super::sheet::with_sheet;

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

const LEFT: f64 = 130.0;
const RIGHT: f64 = 1770.0;
/// Overlap of neighbouring boxes.
const SEAM: f64 = 1.0;
const GUTTER: f64 = 170.0;
const TOP: f64 = 190.0;
const BOTTOM: f64 = 910.0;
const LEGEND: f64 = 1070.0;
/// Widest single panel.
const WIDEST: f64 = 1000.0;

const COMPLIANT: RGBColor = RGBColor(134, 190, 226);
const LOCKED: RGBColor = RGBColor(20, 74, 122);

impl Zone {
    fn colour(self) -> Option<RGBColor> {
        match self {
            Self::Open => None,
            Self::Compliant => Some(COMPLIANT),
            Self::Locked => Some(LOCKED),
        }
    }

    fn words(self) -> &'static str {
        match self {
            Self::Open => "open: no pressure",
            Self::Compliant => "compliant: pressure, u_ν < g",
            Self::Locked => "locked: u_ν = g",
        }
    }
}

impl SpaceTime {
    /// The picture; none without a level.
    ///
    /// # Errors
    /// [`ReportError::Drawing`].
    pub fn svg(&self) -> Result<Option<String>, ReportError> {
        let pieces = || self.panels.iter().flat_map(|p| &p.levels).flatten();
        let ends: Vec<f64> = pieces().flat_map(|piece| [piece.0, piece.1]).collect();
        let times: Vec<f64> = self.panels.iter().flat_map(|p| &p.times).copied().collect();
        let count = self.panels.len().max(1) as f64;
        let width = ((RIGHT - LEFT - (count - 1.0) * GUTTER) / count).min(WIDEST);
        let across = Room { length: width, label: 110.0 };
        let up = Room { length: BOTTOM - TOP, label: 90.0 };
        let rulers = (
            Ruler::new(Scale::Linear, &ends, &[], across),
            Ruler::new(Scale::Linear, &times, &[], up),
        );
        let (Some(x), Some(t)) = rulers else { return Ok(None) };
        let mut svg = String::new();
        let canvas = Canvas::new(&mut svg)?;
        canvas.bold(&self.title, (30.0, 44.0))?;
        canvas.text(&self.subtitle, (30.0, 92.0), Anchor::Left)?;
        for (i, panel) in self.panels.iter().enumerate() {
            let left = LEFT + i as f64 * (width + GUTTER);
            draw(&canvas, panel, (left, width), (&x, &t))?;
        }
        let mut at = LEFT;
        for zone in [Zone::Open, Zone::Compliant, Zone::Locked] {
            let sides = [at, LEGEND - 18.0, at + 60.0, LEGEND + 18.0];
            if let Some(colour) = zone.colour() {
                canvas.fill_box(sides, colour, 1.0)?;
            }
            canvas.line_box(sides, INK, 3)?;
            canvas.text(zone.words(), (at + 78.0, LEGEND), Anchor::Left)?;
            at += 130.0 + 17.0 * zone.words().chars().count() as f64;
        }
        canvas.finish()?;
        Ok(Some(with_sheet(&svg)))
    }
}

fn draw(
    canvas: &Canvas<'_>,
    panel: &Panel,
    (left, width): (f64, f64),
    (x, t): (&Ruler, &Ruler),
) -> Result<(), ReportError> {
    let across = |value: f64| left + width * x.share(value);
    let up = |value: f64| BOTTOM - (BOTTOM - TOP) * t.share(value);
    // A level covers the time halfway to its neighbours.
    let halfway = |a: usize, b: usize| 0.5 * (panel.times[a] + panel.times[b]);
    let last = panel.times.len().saturating_sub(1);
    for (n, pieces) in panel.levels.iter().enumerate() {
        let from = if n == 0 { panel.times[n] } else { halfway(n - 1, n) };
        let to = if n == last { panel.times[n] } else { halfway(n, n + 1) };
        for run in pieces.chunk_by(|a, b| a.2 == b.2) {
            if let (Some(colour), Some(first), Some(end)) =
                (run[0].2.colour(), run.first(), run.last())
            {
                // Without the overlap viewers show the seam.
                let corners = [across(first.0), up(to) - SEAM, across(end.1), up(from)];
                canvas.fill_box(corners, colour, 1.0)?;
            }
        }
    }
    canvas.text(&panel.title, (left + 0.5 * width, TOP - 34.0), Anchor::Centre)?;
    for tick in &x.ticks {
        if let Some(label) = &tick.label {
            let at = across(tick.at);
            canvas.line(&[(at, BOTTOM - 12.0), (at, BOTTOM + 10.0)], INK, 2)?;
            canvas.text(label, (at, BOTTOM + 36.0), Anchor::Centre)?;
        }
    }
    for tick in &t.ticks {
        if let Some(label) = &tick.label {
            let at = up(tick.at);
            canvas.line(&[(left - 10.0, at), (left, at)], INK, 2)?;
            canvas.text(label, (left - 16.0, at), Anchor::Right)?;
        }
    }
    // The area outside Γ3 and the time is not an open zone.
    let ends = panel.levels.iter().flatten().map(|piece| piece.1).fold(0.0, f64::max);
    let (first, last) = (panel.times.first().copied(), panel.times.last().copied());
    if let (Some(first), Some(last)) = (first, last) {
        canvas.line_box([across(0.0), up(last), across(ends), up(first)], INK, 3)?;
    }
    canvas.text("length along Γ3", (left + 0.5 * width, BOTTOM + 86.0), Anchor::Centre)?;
    canvas.text("time t", (left - 106.0, 0.5 * (TOP + BOTTOM)), Anchor::Upwards)
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
        let boxes = |zone| picture(zone).svg().unwrap().unwrap().matches("<polygon").count();
        // Two more are those of the legend.
        assert_eq!([Zone::Locked, Zone::Open, Zone::Compliant].map(boxes), [3, 3, 4]);
        assert_eq!(SpaceTime { panels: Vec::new(), ..picture(Zone::Open) }.svg().unwrap(), None);
    }
}
