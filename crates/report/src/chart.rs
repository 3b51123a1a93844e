//! A picture of series over two axes.

use crate::canvas::{
    Anchor, Canvas, CanvasPoint, DASHES, EDGE, LINE, MARKER, TEXT, WIDTH, breadth, corners,
    heading, lines,
};
use crate::palette::{Colour, GRID, INK, ink};
use crate::ruler::{Room, Ruler, Scale};

/// x and y.
pub type Datum = (f64, f64);

/// An axis with its label (including units) and scale.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Axis {
    pub label: String,
    pub scale: Scale,
}

/// A part of a series. Points that cannot be placed (not finite, or not positive on a logarithmic axis) are skipped and
/// interrupt lines.
#[derive(Debug, Clone, PartialEq)]
pub enum Part {
    Line(Vec<Datum>),
    /// Dashed.
    Dashed(Vec<Datum>),
    Dotted(Vec<Datum>),
    /// Of strokes and gaps of these lengths.
    Broken((f64, f64), Vec<Datum>),
    Points(Vec<Datum>),
    /// Shown but not counted.
    Hollow(Vec<Datum>),
}

/// One name: one colour, one marker shape, one entry of the legend.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Series {
    /// Its words in the legend; without any it has no entry.
    pub name: String,
    /// More lines below the name.
    pub detail: String,
    pub parts: Vec<Part>,
    /// Grey for what belongs to all series.
    pub grey: bool,
    /// Colour and shape by number, so that a norm has the same ones in every picture; else the next.
    pub ink: Option<usize>,
    /// A triangle of the predicted order near it, if both axes are logarithmic.
    pub slope: Option<Slope>,
}

/// A line across the picture at a value of one axis, with a letter at its end. A value that cannot be placed (an
/// infinite threshold) only has its words in the legend.
#[derive(Debug, Clone, PartialEq)]
pub struct Mark {
    /// The value on the axis.
    pub at: f64,
    /// Words in the legend.
    pub label: String,
}

/// A picture.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Chart {
    /// First line, in bold; empty if a heading above the picture says it.
    pub title: String,
    pub question: String,
    pub x: Axis,
    pub y: Axis,
    /// The legend keeps this order.
    pub series: Vec<Series>,
    pub verticals: Vec<Mark>,
    pub horizontals: Vec<Mark>,
    /// Words beside points; those that would stand on something drawn are left out.
    pub labels: Vec<(Datum, String)>,
    /// Signs that no series explains, with their meaning.
    pub keys: Vec<(Part, String)>,
    pub note: String,
    /// Readable at 240 pixels, with room for a few short names.
    pub small: bool,
}

impl Axis {
    /// An axis.
    pub fn new(label: impl Into<String>, scale: Scale) -> Self {
        Self { label: label.into(), scale }
    }
}

impl Series {
    /// A series of these parts.
    pub fn new(name: impl Into<String>, parts: Vec<Part>) -> Self {
        Self { name: name.into(), parts, ..Self::default() }
    }

    /// Its first line and its markers, filled.
    fn samples(&self) -> Vec<Part> {
        let line = self.parts.iter().find(|part| !part.has_markers());
        let marker = self.parts.iter().find(|part| part.has_markers());
        line.into_iter().chain(marker).cloned().collect()
    }
}

/// Strokes and gaps of dotted lines.
const DOTS: (f64, f64) = (4.0, 9.0);

/// Limit of decades added below to make room for the triangles.
const LONGER: i32 = 3;

impl Part {
    pub(super) fn points(&self) -> &[Datum] {
        match self {
            Part::Line(points)
            | Part::Dashed(points)
            | Part::Dotted(points)
            | Part::Broken(_, points)
            | Part::Points(points)
            | Part::Hollow(points) => points,
        }
    }

    pub(super) fn has_markers(&self) -> bool {
        matches!(self, Part::Points(_) | Part::Hollow(_))
    }

    /// Whole lines are drawn first, then broken ones, then markers.
    fn rank(&self) -> usize {
        match self {
            Part::Line(_) => 0,
            Part::Dashed(_) | Part::Dotted(_) | Part::Broken(..) => 1,
            Part::Points(_) | Part::Hollow(_) => 2,
        }
    }

    /// Draws an uninterrupted run of places as this part is drawn, by colour and shape.
    pub(super) fn draw(
        &self,
        canvas: &mut Canvas,
        run: &[CanvasPoint],
        (ink, shape): (Colour, usize),
    ) {
        match self {
            Part::Line(_) => canvas.line(run, ink, 4),
            Part::Dashed(_) => canvas.dashed(run, ink, DASHES),
            Part::Dotted(_) => canvas.dashed(run, ink, DOTS),
            Part::Broken(pattern, _) => canvas.dashed(run, ink, *pattern),
            Part::Points(_) => canvas.markers(run, shape, ink, false),
            Part::Hollow(_) => canvas.markers(run, shape, ink, true),
        }
    }
}

impl Chart {
    /// A chart without series.
    pub fn new(title: &str, question: &str, x: Axis, y: Axis) -> Self {
        Self { title: title.into(), question: question.into(), x, y, ..Self::default() }
    }

    /// The picture as SVG; none if no point has a place.
    pub fn svg(&self) -> Option<String> {
        let (frame, slopes) = self.arranged()?;
        let mut canvas = match self.small {
            true => Canvas::of_size(SMALL, frame.text),
            false => Canvas::new(),
        };
        canvas.heading(&self.title, &heading(&self.question));
        frame.draw(&mut canvas, [&self.x.label, &self.y.label]);
        canvas.line_box(frame.room, INK, 3);
        self.draw_marks(&mut canvas, &frame);
        // Where curves meet, broken lines are seen on whole ones, and markers on both.
        for rank in 0..3 {
            for (series, ink) in self.series.iter().zip(self.inks()) {
                for part in series.parts.iter().filter(|part| part.rank() == rank) {
                    self.runs(&frame, part).iter().for_each(|run| part.draw(&mut canvas, run, ink));
                }
            }
        }
        for placed in &slopes {
            placed.draw(&mut canvas, self.inks()[placed.series].0);
        }
        self.draw_labels(&mut canvas, &frame, &slopes);
        let end = self.draw_legend(&mut canvas, &frame, !slopes.is_empty());
        Some(canvas.finish_at(if self.small { f64::from(SMALL.1) } else { end }))
    }

    /// Words beside their points, where nothing else stands: right of a point or left of it, above or below.
    fn draw_labels(&self, canvas: &mut Canvas, frame: &Frame, slopes: &[Placed]) {
        let mut taken = self.taken(frame);
        taken.extend(slopes.iter().flat_map(Placed::outline));
        let [left, top, right, bottom] = frame.room;
        for (_, mark) in self.marks(true).into_iter().filter(|(upright, _)| !upright) {
            let y = frame.up(mark.at);
            taken.extend(sampled(&[(left, y), (right, y)]));
        }
        for (point, words) in &self.labels {
            let (x, y) = frame.place(*point);
            let width = frame.text * breadth(words);
            let beside = |(right, up, away): (f64, f64, f64)| {
                let from = if right > 0.0 { x + away } else { x - away - width };
                let middle = y + up * (MARKER + HALF_LINE + away);
                [from, middle - HALF_LINE, from + width, middle + HALF_LINE]
            };
            let free = |sides: &[f64; 4]| {
                let [from, above, to, below] = *sides;
                let inside = from > left && to < right && above > top && below < bottom;
                inside && !taken.iter().any(|place| is_near(sides, *place))
            };
            let sides = [4.0, 20.0, 40.0].into_iter().flat_map(|away| {
                [(1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, 0.0), (-1.0, 0.0)]
                    .map(|(right, up)| (right, up, away + MARKER))
            });
            if let Some(sides) = sides.map(beside).find(free) {
                canvas.text(words, (sides[0], 0.5 * (sides[1] + sides[3])), Anchor::Left);
                taken.extend(sampled(&corners(sides)));
            }
        }
    }

    /// Places of markers, and points along lines.
    fn taken(&self, frame: &Frame) -> Vec<CanvasPoint> {
        let parts = self.series.iter().flat_map(|series| &series.parts);
        let runs =
            parts.flat_map(|part| self.runs(frame, part).into_iter().map(move |run| (part, run)));
        let points = |(part, run): (&Part, Vec<CanvasPoint>)| match part.has_markers() {
            true => run,
            false => sampled(&run),
        };
        runs.flat_map(points).collect()
    }

    /// The axes, extended until every triangle has a place; failing that, the triangle is omitted.
    fn arranged(&self) -> Option<(Frame, Vec<Placed>)> {
        let mut frame = Frame::new(self, &[])?;
        let wanted = self.series.iter().filter(|series| series.slope.is_some()).count();
        let mut slopes = place(self, &frame);
        let heights = self.series.iter().flat_map(|s| &s.parts).flat_map(|p| p.points());
        let lowest = heights.map(|p| p.1).filter(|y| self.y.scale.holds(*y));
        let lowest = lowest.fold(f64::INFINITY, f64::min);
        for decades in 1..=LONGER {
            if slopes.len() == wanted {
                break;
            }
            let longer = Frame::new(self, &[lowest * 10f64.powi(-decades)])?;
            let found = place(self, &longer);
            if found.len() > slopes.len() {
                (frame, slopes) = (longer, found);
            }
        }
        Some((frame, slopes))
    }

    /// Colour and shape of each series.
    pub(super) fn inks(&self) -> Vec<(Colour, usize)> {
        let mut next = 0..;
        let of = |series: &Series| match (series.grey, series.ink) {
            (true, _) => (INK, 0),
            (false, own) => ink(own.or_else(|| next.next()).unwrap_or(0)),
        };
        self.series.iter().map(of).collect()
    }

    /// The places of a part, cut at points without a place.
    pub(super) fn runs(&self, frame: &Frame, part: &Part) -> Vec<Vec<CanvasPoint>> {
        let holds = |p: &Datum| self.x.scale.holds(p.0) && self.y.scale.holds(p.1);
        let pieces = part.points().split(|point| !holds(point));
        pieces
            .filter(|piece| !piece.is_empty())
            .map(|piece| piece.iter().map(|point| frame.place(*point)).collect())
            .collect()
    }

    /// The entries of curves that are drawn, of marks and of signs.
    fn entries(&self, frame: &Frame, triangles: bool) -> Vec<Entry> {
        let grey = (INK, 0);
        let seen = |series: &Series| series.parts.iter().any(|p| !self.runs(frame, p).is_empty());
        let mut entries = Vec::new();
        for (series, ink) in self.series.iter().zip(self.inks()) {
            if !series.name.is_empty() && seen(series) {
                let lines = series.name.lines().chain(series.detail.lines());
                let lines = lines.map(str::to_owned).collect();
                entries.push(Entry { samples: series.samples(), ink, lines });
            }
        }
        let of = |(samples, words)| Entry { samples, ink: grey, lines: vec![words] };
        entries.extend(self.mark_entries().into_iter().map(of));
        entries.extend(self.keys.iter().cloned().map(|(sign, words)| of((vec![sign], words))));
        if triangles {
            entries.push(of((Vec::new(), "triangle: predicted order".into())));
        }
        entries
    }

    /// The legend: below the picture in two columns, or beside a small one; the height at which it ends.
    fn draw_legend(&self, canvas: &mut Canvas, frame: &Frame, triangles: bool) -> f64 {
        let [_, top, right, bottom] = frame.room;
        let unit = frame.text / TEXT;
        let (left, top, width) = match self.small {
            true => (right + 0.3 * TEXT, top + HALF_LINE, f64::from(SMALL.0) - right),
            false => {
                let below = frame.under(&self.x.label).len() as f64;
                (EDGE, bottom + NAME + LINE * (below + 0.7), 0.5 * WIDTH - EDGE)
            }
        };
        let mut entries = self.entries(frame, triangles);
        for entry in &mut entries {
            let room = (width - SAMPLE * unit) / frame.text;
            entry.lines = entry.lines.iter().flat_map(|line| lines(line, room)).collect();
        }
        let count = |part: &[Entry]| part.iter().map(|e| e.lines.len() as f64 + BETWEEN).sum();
        let height = |split: &usize| {
            let (first, second) = entries.split_at(*split);
            f64::max(count(first), count(second))
        };
        let least = if self.small { entries.len() } else { 0 };
        let splits = least..=entries.len();
        let split = splits.min_by(|a, b| height(a).total_cmp(&height(b))).unwrap_or(0);
        let end = top + LINE * unit * height(&split);
        let (first, second) = entries.split_at(split);
        for (column, entries) in [(left, first), (left + width, second)] {
            let mut y = top;
            for entry in entries {
                entry.draw(canvas, (column, y), unit);
                y += LINE * unit * (entry.lines.len() as f64 + BETWEEN);
            }
        }
        let note = heading(&self.note);
        canvas.lines(&note, (left, end), LINE, Anchor::Left);
        end + LINE * note.len() as f64
    }
}

// The axes of a picture, with room for a title above, and a legend below or beside.

/// Size of a picture that is readable at 240 pixels, and height of its words.
const SMALL: (u32, u32) = (480, 404);
const SMALL_TEXT: f64 = 22.0;

/// Height of the axes of a large picture.
const TALL: f64 = 640.0;
/// From the axis to the middle of the words at its ticks, and of those below them; to the end of these.
const TICKS: f64 = 36.0;
const NAME: f64 = 64.0;

/// Length of an unlabelled tick.
const STROKE: f64 = 12.0;

/// Lengths beside the axes are those of a large picture times text/[`TEXT`].
pub(super) struct Frame {
    pub(super) x: Ruler,
    pub(super) y: Ruler,
    pub(super) room: [f64; 4],
    pub(super) text: f64,
}

impl Frame {
    /// Axes for the data and marks of a chart, and for `more` heights; None without data.
    pub(super) fn new(chart: &Chart, more: &[f64]) -> Option<Self> {
        let scales = (chart.x.scale, chart.y.scale);
        let shown = |(x, y): &&(f64, f64)| scales.0.holds(*x) && scales.1.holds(*y);
        let parts = || chart.series.iter().flat_map(|series| &series.parts);
        let all = parts().flat_map(|part| part.points()).filter(shown);
        let (xs, mut ys): (Vec<f64>, Vec<f64>) = all.copied().unzip();
        if xs.is_empty() {
            return None;
        }
        ys.extend(more);
        let marks = |marks: &[Mark]| marks.iter().map(|mark| mark.at).collect::<Vec<_>>();
        // Steps are those of the markers, not the corners of lines.
        let markers = parts().filter(|part| part.has_markers()).flat_map(|part| part.points());
        let levels: Vec<f64> = markers.filter(shown).map(|point| point.0).collect();
        let (data, beside) = if levels.is_empty() { (&xs, &levels) } else { (&levels, &xs) };
        let beside = [&beside[..], &marks(&chart.verticals)].concat();
        let (text, top, bottom) = match chart.small {
            true => (SMALL_TEXT, 16.0, 312.0),
            false => {
                let titles =
                    if chart.title.is_empty() { 0 } else { 1 + heading(&chart.question).len() };
                let letters = if chart.verticals.is_empty() { 1.0 } else { 1.6 };
                let top = LINE * (titles as f64 + letters);
                (TEXT, top, top + TALL)
            }
        };
        // Twice a line of text for labels above another.
        let room_y = Room { length: bottom - top, label: 80.0 * text / TEXT };
        let y = Ruler::new(scales.1, &ys, &marks(&chart.horizontals), room_y)?;
        let left = beside_axis(&y, text) + text * if chart.y.label.is_empty() { 0.2 } else { 1.5 };
        let right = match chart.small {
            true => {
                let names = chart.series.iter().map(|series| breadth(&series.name));
                let widest = names.fold(0.0, f64::max);
                let legend = if widest > 0.0 { SAMPLE * text / TEXT + text * widest } else { 0.0 };
                f64::from(SMALL.0) - 0.6 * TEXT - legend
            }
            false => WIDTH - 2.0 * EDGE,
        };
        let label = if chart.small { 80.0 } else { 100.0 };
        let x = Ruler::new(scales.0, data, &beside, Room { length: right - left, label })?;
        Some(Self { x, y, room: [left, top, right, bottom], text })
    }

    pub(super) fn place(&self, (x, y): (f64, f64)) -> CanvasPoint {
        (self.across(x), self.up(y))
    }

    pub(super) fn across(&self, x: f64) -> f64 {
        let [left, _, right, _] = self.room;
        left + self.x.share(x) * (right - left)
    }

    /// Clamped to the frame.
    pub(super) fn up(&self, y: f64) -> f64 {
        let [_, top, _, bottom] = self.room;
        bottom - self.y.share(y).clamp(0.0, 1.0) * (bottom - top)
    }

    /// The name of the axis across, broken to its length and a little more.
    fn under(&self, name: &str) -> Vec<String> {
        let [left, _, right, _] = self.room;
        lines(name, (right - left + 2.0 * EDGE) / self.text)
    }

    /// Grid, ticks, and the names of the axes.
    pub(super) fn draw(&self, canvas: &mut Canvas, [name_x, name_y]: [&str; 2]) {
        let ([left, top, right, bottom], unit) = (self.room, self.text / TEXT);
        for tick in &self.x.ticks {
            let x = self.across(tick.at);
            match &tick.label {
                Some(label) => {
                    canvas.line(&[(x, top), (x, bottom)], GRID, 2);
                    canvas.text(label, (x, bottom + TICKS * unit), Anchor::Centre);
                }
                None => canvas.line(&[(x, bottom), (x, bottom - STROKE)], INK, 2),
            }
        }
        for tick in &self.y.ticks {
            let y = self.up(tick.at);
            match &tick.label {
                Some(label) => {
                    canvas.line(&[(left, y), (right, y)], GRID, 2);
                    canvas.text(label, (left - 0.4 * self.text, y), Anchor::Right);
                }
                None => canvas.line(&[(left, y), (left + STROKE, y)], INK, 2),
            }
        }
        let middle = (0.5 * (left + right), 0.5 * (top + bottom));
        let below = (middle.0, bottom + unit * (NAME + 0.4 * LINE));
        canvas.lines(&self.under(name_x), below, LINE * unit, Anchor::Centre);
        let beside = left - beside_axis(&self.y, self.text) - 0.8 * self.text;
        canvas.text(name_y, (beside, middle.1), Anchor::Upwards);
    }
}

/// Room for the labels of an axis upwards, with the distance to it.
pub(super) fn beside_axis(y: &Ruler, text: f64) -> f64 {
    let labels = y.ticks.iter().filter_map(|tick| tick.label.as_deref());
    text * (0.4 + labels.map(breadth).fold(0.0, f64::max))
}

// Lines across a picture at values of its axes, with letters that the legend explains.

/// Strokes and gaps of the first, second, … line, distinct without colours.
const PATTERNS: [(f64, f64); 4] = [(22.0, 10.0), (6.0, 8.0), (40.0, 10.0), (12.0, 22.0)];

/// Least distance of two letters.
const LETTERS: f64 = 32.0;

/// Length of the stroke from a line to its letter.
const STUB: f64 = 12.0;

impl Chart {
    /// The marks that can be placed, or cannot, and whether they are upright; their order gives patterns and letters.
    fn marks(&self, placed: bool) -> Vec<(bool, &Mark)> {
        let verticals = self.verticals.iter().map(|mark| (true, mark));
        let all = verticals.chain(self.horizontals.iter().map(|mark| (false, mark)));
        let axis = |upright: bool| if upright { &self.x } else { &self.y };
        all.filter(|(upright, mark)| axis(*upright).scale.holds(mark.at) == placed).collect()
    }

    /// Letters keep the order of their lines, and a distance.
    fn draw_marks(&self, canvas: &mut Canvas, frame: &Frame) {
        let [left, top, right, bottom] = frame.room;
        let at = |(index, (upright, mark)): (usize, (bool, &Mark))| {
            (upright, if upright { frame.across(mark.at) } else { frame.up(mark.at) }, index)
        };
        let mut marks: Vec<_> = self.marks(true).into_iter().enumerate().map(at).collect();
        marks.sort_by(|a, b| b.0.cmp(&a.0).then(a.1.total_cmp(&b.1)));
        for alike in marks.chunk_by(|a, b| a.0 == b.0) {
            let mut tag = f64::NEG_INFINITY;
            for &(upright, at, index) in alike {
                tag = at.max(tag + LETTERS);
                let pattern = PATTERNS[index % PATTERNS.len()];
                if upright {
                    canvas.dashed(&[(at, top), (at, bottom)], INK, pattern);
                    canvas.line(&[(at, top), (tag, top - STUB)], INK, 2);
                    canvas.text(&letter(index), (tag, top - STUB - 18.0), Anchor::Centre);
                } else {
                    canvas.dashed(&[(left, at), (right, at)], INK, pattern);
                    canvas.line(&[(right, at), (right + STUB, tag)], INK, 2);
                    canvas.text(&letter(index), (right + STUB + 3.0, tag), Anchor::Left);
                }
            }
        }
    }

    /// Legend entries; marks without a place come last, without a letter.
    fn mark_entries(&self) -> Vec<(Vec<Part>, String)> {
        let drawn = self.marks(true).into_iter().enumerate().map(|(index, (_, mark))| {
            let sample = Part::Broken(PATTERNS[index % PATTERNS.len()], Vec::new());
            (vec![sample], format!("{}: {}", letter(index), mark.label))
        });
        let lost = self.marks(false).into_iter();
        drawn.chain(lost.map(|(_, mark)| (Vec::new(), mark.label.clone()))).collect()
    }
}

fn letter(index: usize) -> String {
    char::from(b'a' + (index % 26) as u8).into()
}

// The words below a picture, or beside a small one.

/// Width of a sample, with the distance to its words, and free lines between entries.
const SAMPLE: f64 = 82.0;
const BETWEEN: f64 = 0.2;

/// A sample of each part, and the words beside it.
struct Entry {
    samples: Vec<Part>,
    ink: (Colour, usize),
    lines: Vec<String>,
}

impl Entry {
    fn draw(&self, canvas: &mut Canvas, (left, y): CanvasPoint, unit: f64) {
        let right = left + 64.0 * unit;
        for part in &self.samples {
            let sample = match part.has_markers() {
                true => vec![(0.5 * (left + right), y)],
                false => vec![(left, y), (right, y)],
            };
            part.draw(canvas, &sample, self.ink);
        }
        canvas.lines(&self.lines, (left + SAMPLE * unit, y), LINE * unit, Anchor::Left);
    }
}

// Triangles of a predicted order, placed in free space.

/// A predicted order along points of a series.
#[derive(Debug, Clone, PartialEq)]
pub struct Slope {
    /// y grows like x to this power.
    pub order: f64,
    pub label: String,
    /// The points, along rising x: the triangle stands between two neighbours.
    pub along: Vec<Datum>,
}

/// A placed triangle: fine end, corner, coarse end.
pub(super) struct Placed {
    pub(super) series: usize,
    pub(super) corners: [CanvasPoint; 3],
    label: String,
}

/// Distance to everything drawn: half a marker and a little more.
const CLEAR: f64 = 22.0;

/// Step by which a triangle is moved from its line.
const MOVE: f64 = 12.0;

/// Half of the line height.
const HALF_LINE: f64 = 18.0;

/// The triangles that find a place, as close below their lines as possible, between the finest points that allow it.
/// None on linear axes.
pub(super) fn place(chart: &Chart, frame: &Frame) -> Vec<Placed> {
    let Some(decade) = frame.y.decade() else { return Vec::new() };
    let [_, top, _, bottom] = frame.room;
    let decade = decade * (bottom - top);
    let mut taken = chart.taken(frame);
    let mut placed = Vec::new();
    for (series, slope) in
        chart.series.iter().enumerate().filter_map(|(i, series)| Some((i, series.slope.as_ref()?)))
    {
        if let Some(corners) = free_place(slope, frame, decade, &taken) {
            let triangle = Placed { series, corners, label: slope.label.clone() };
            taken.extend(triangle.outline());
            placed.push(triangle);
        }
    }
    placed
}

/// Points along a path, closer to each other than a triangle is to a line.
fn sampled(path: &[CanvasPoint]) -> Vec<CanvasPoint> {
    let between = |pair: &[CanvasPoint]| {
        let (from, to) = (pair[0], pair[1]);
        let count = ((to.0 - from.0).hypot(to.1 - from.1) / (0.5 * CLEAR)).ceil().max(1.0);
        let at = move |from: f64, to: f64, i: i32| from + (to - from) * f64::from(i) / count;
        (0..=count as i32).map(move |i| (at(from.0, to.0, i), at(from.1, to.1, i)))
    };
    path.windows(2).flat_map(between).collect()
}

/// Fine end, corner and coarse end of a triangle that no point taken enters or comes near, nor its label.
fn free_place(
    slope: &Slope,
    frame: &Frame,
    decade: f64,
    taken: &[CanvasPoint],
) -> Option<[CanvasPoint; 3]> {
    let [_, top, right_end, bottom] = frame.room;
    let steps = ((bottom - top) / MOVE) as usize;
    (0..steps).find_map(|step| {
        slope.along.windows(2).find_map(|pair| {
            let (fine, coarse) = (pair[0], pair[1]);
            let height = decade * slope.order * (coarse.0 / fine.0).log10();
            let top = frame.up(coarse.1) + CLEAR + MOVE * step as f64;
            let (left, right) = (frame.across(fine.0), frame.across(coarse.0));
            let corners = [(left, top + height), (right, top + height), (right, top)];
            let steep = height / (right - left);
            let above = CLEAR * steep.hypot(1.0);
            let label = label_box(&corners, &slope.label);
            let near = |&(x, y): &CanvasPoint| {
                let edge = top + steep * (right - x.clamp(left, right));
                let beside = x > left - CLEAR && x < right + CLEAR;
                let (high, low) = (edge.min(top + height), edge.max(top + height));
                beside && y > high - above && y < low + CLEAR || is_near(&label, (x, y))
            };
            let inside = corners[0].1.max(top) < bottom - MOVE && label[2] < right_end;
            (inside && !taken.iter().any(near)).then_some(corners)
        })
    })
}

/// Whether a place is in a box or near it.
fn is_near([left, top, right, bottom]: &[f64; 4], (x, y): CanvasPoint) -> bool {
    let room = 0.5 * CLEAR;
    x > left - room && x < right + room && y > top - room && y < bottom + room
}

/// The sides of the label, right of the upright side.
fn label_box(corners: &[CanvasPoint; 3], label: &str) -> [f64; 4] {
    let (left, middle) = (corners[1].0 + MOVE, 0.5 * (corners[1].1 + corners[2].1));
    let right = left + TEXT * breadth(label);
    [left, middle - HALF_LINE, right, middle + HALF_LINE]
}

impl Placed {
    /// Points along its sides, and around its label.
    fn outline(&self) -> Vec<CanvasPoint> {
        let sides = [&self.corners[..], &self.corners[..1]].concat();
        [sampled(&sides), sampled(&corners(label_box(&self.corners, &self.label)))].concat()
    }

    pub(super) fn draw(&self, canvas: &mut Canvas, ink: Colour) {
        let [fine, corner, coarse] = self.corners;
        canvas.line(&[fine, corner, coarse, fine], ink, 3);
        let middle = (corner.0 + MOVE, 0.5 * (corner.1 + coarse.1));
        canvas.text(&self.label, middle, Anchor::Left);
    }
}

#[cfg(test)]
mod tests;
