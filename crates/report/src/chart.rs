//! A picture of series over two axes.

use crate::canvas::{Anchor, Canvas, CanvasPoint, DASHES, LINE, SIZE, TEXT};
use crate::palette::{Colour, GRID, INK, colour};
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
    /// Words beside points; those that would stand on others before them are left out.
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
    fn samples(&self) -> Vec<&Part> {
        let line = self.parts.iter().find(|part| !part.has_markers());
        let marker = self.parts.iter().find(|part| part.has_markers());
        line.into_iter().chain(marker).collect()
    }
}

/// Strokes and gaps of dotted lines.
const DOTS: (f64, f64) = (4.0, 9.0);

/// Characters in the width of the picture.
const TITLE_CHARACTERS: usize = 92;

/// Offset of words from their point: above the line that goes on to the right.
const LABEL: (f64, f64) = (10.0, -34.0);
/// Maximal width of a character.
const CHARACTER: f64 = 17.5;

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
        let layout = self.layout();
        let mut canvas = Canvas::of_size(layout.size, layout.text);
        canvas.heading(&self.title, &wrapped(&self.question, TITLE_CHARACTERS, 2));
        frame.draw(&mut canvas, [&self.x.label, &self.y.label]);
        canvas.line_box(layout.room, INK, 3);
        self.draw_marks(&mut canvas, &frame);
        // Lines lie below markers.
        for markers in [false, true] {
            for (series, ink) in self.series.iter().zip(self.inks()) {
                for part in series.parts.iter().filter(|part| part.has_markers() == markers) {
                    self.runs(&frame, part).iter().for_each(|run| part.draw(&mut canvas, run, ink));
                }
            }
        }
        for placed in &slopes {
            placed.draw(&mut canvas, self.inks()[placed.series].0);
        }
        // The ends and heights of the labels that are drawn: none stands on one before it.
        let mut taken: Vec<[f64; 3]> = Vec::new();
        for (point, words) in &self.labels {
            let (x, y) = frame.place(*point);
            let (width, right) = (CHARACTER * words.chars().count() as f64, layout.room[2]);
            let (place, anchor, left) = match x + LABEL.0 + width > right {
                true => (right - LABEL.0, Anchor::Right, right - LABEL.0 - width),
                false => (x + LABEL.0, Anchor::Left, x + LABEL.0),
            };
            let clear = |[from, to, height]: &[f64; 3]| {
                (y - height).abs() >= LINE || *to <= left || left + width <= *from
            };
            if taken.iter().all(clear) {
                canvas.text(words, (place, y + LABEL.1), anchor);
                taken.push([left, left + width, y]);
            }
        }
        self.draw_legend(&mut canvas, &frame, !slopes.is_empty());
        let has_head = self.small || !self.title.is_empty();
        Some(canvas.without_head(if has_head { 0 } else { TITLE_ROOM }))
    }

    pub(super) fn layout(&self) -> &'static Layout {
        if self.small { &SMALL } else { &LARGE }
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
        let mut next = 0;
        let ink = |series: &Series| {
            if series.grey {
                return (INK, 0);
            }
            let at = series.ink.unwrap_or(next);
            next += usize::from(series.ink.is_none());
            (colour(at), at)
        };
        self.series.iter().map(ink).collect()
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

    fn draw_legend(&self, canvas: &mut Canvas, frame: &Frame, triangles: bool) {
        let mut legend = Legend::new(canvas, frame);
        let grey = (INK, 0);
        for (series, ink) in self.series.iter().zip(self.inks()) {
            if !series.name.is_empty() {
                legend.entry(&series.samples(), ink, &series.name);
                series.detail.lines().for_each(|words| legend.entry(&[], grey, words));
                legend.space();
            }
        }
        for (sample, words) in self.mark_entries() {
            legend.entry(&sample.iter().collect::<Vec<_>>(), grey, &words);
        }
        for (sample, words) in &self.keys {
            legend.entry(&[sample], grey, words);
        }
        if triangles {
            legend.entry(&[], grey, "triangle: predicted order");
        }
        legend.space();
        legend.entry(&[], grey, &self.note);
    }
}

// The axes of a picture, with room for a title above and a legend beside.

/// Size of a picture, height of its words, room for a label of the axis across, and the axes: left, top, right, bottom.
pub(super) struct Layout {
    pub(super) size: (u32, u32),
    pub(super) text: f64,
    label: f64,
    pub(super) room: [f64; 4],
}

pub(super) const LARGE: Layout =
    Layout { size: SIZE, text: TEXT, label: 100.0, room: [170.0, 190.0, 1140.0, 990.0] };
/// Readable at 240 pixels.
pub(super) const SMALL: Layout =
    Layout { size: (480, 404), text: 22.0, label: 80.0, room: [84.0, 16.0, 290.0, 312.0] };

/// Height of title and question, above the letters of marks.
pub(super) const TITLE_ROOM: u32 = 136;

/// Length of an unlabelled tick.
const STROKE: f64 = 12.0;

/// Lengths beside the axes are those of a large picture times `unit`.
pub(super) struct Frame {
    pub(super) x: Ruler,
    pub(super) y: Ruler,
    pub(super) room: [f64; 4],
    pub(super) unit: f64,
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
        let Layout { room, text, label, .. } = chart.layout();
        let [left, top, right, bottom] = *room;
        let unit = text / TEXT;
        // Twice a line of text for labels above another.
        let room_x = Room { length: right - left, label: *label };
        let room_y = Room { length: bottom - top, label: 80.0 * unit };
        let x = Ruler::new(scales.0, data, &beside, room_x)?;
        let y = Ruler::new(scales.1, &ys, &marks(&chart.horizontals), room_y)?;
        Some(Self { x, y, room: *room, unit })
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

    /// Height of a decade of y, if logarithmic.
    pub(super) fn decade(&self) -> Option<f64> {
        let [_, top, _, bottom] = self.room;
        self.y.decade().map(|share| share * (bottom - top))
    }

    /// Grid, ticks, and the names of the axes.
    pub(super) fn draw(&self, canvas: &mut Canvas, [name_x, name_y]: [&str; 2]) {
        let ([left, top, right, bottom], unit) = (self.room, self.unit);
        for tick in &self.x.ticks {
            let x = self.across(tick.at);
            match &tick.label {
                Some(label) => {
                    canvas.line(&[(x, top), (x, bottom)], GRID, 2);
                    canvas.text(label, (x, bottom + 36.0 * unit), Anchor::Centre);
                }
                None => canvas.line(&[(x, bottom), (x, bottom - STROKE)], INK, 2),
            }
        }
        for tick in &self.y.ticks {
            let y = self.up(tick.at);
            match &tick.label {
                Some(label) => {
                    canvas.line(&[(left, y), (right, y)], GRID, 2);
                    canvas.text(label, (left - 16.0 * unit, y), Anchor::Right);
                }
                None => canvas.line(&[(left, y), (left + STROKE, y)], INK, 2),
            }
        }
        let middle = (0.5 * (left + right), 0.5 * (top + bottom));
        canvas.text(name_x, (middle.0, bottom + 96.0 * unit), Anchor::Centre);
        canvas.text(name_y, (left - 140.0 * unit, middle.1), Anchor::Upwards);
    }
}

// Lines across a picture at values of its axes, with letters that the legend explains.

/// Strokes and gaps of the first, second, … line, distinct without colours.
const PATTERNS: [(f64, f64); 4] = [(22.0, 10.0), (6.0, 8.0), (40.0, 10.0), (12.0, 22.0)];

/// Least distance of two letters.
const LETTERS: f64 = 32.0;

/// Length of the stroke from a line to its letter.
const STUB: f64 = 12.0;

impl Chart {
    /// The marks that can be placed, and whether they are upright; their order gives patterns and letters.
    fn placed_marks(&self) -> Vec<(bool, &Mark)> {
        let verticals = self.verticals.iter().map(|mark| (true, mark));
        let all = verticals.chain(self.horizontals.iter().map(|mark| (false, mark)));
        all.filter(|(upright, mark)| self.has_place(*upright, mark)).collect()
    }

    fn has_place(&self, upright: bool, mark: &Mark) -> bool {
        let axis = if upright { &self.x } else { &self.y };
        axis.scale.holds(mark.at)
    }

    /// Letters keep the order of their lines, and a distance.
    fn draw_marks(&self, canvas: &mut Canvas, frame: &Frame) {
        let [left, top, right, bottom] = frame.room;
        let mut marks: Vec<(bool, f64, usize)> = Vec::new();
        for (index, (upright, mark)) in self.placed_marks().into_iter().enumerate() {
            let at = if upright { frame.across(mark.at) } else { frame.up(mark.at) };
            marks.push((upright, at, index));
        }
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
    fn mark_entries(&self) -> Vec<(Option<Part>, String)> {
        let drawn = self.placed_marks().into_iter().enumerate().map(|(index, (_, mark))| {
            let sample = Part::Broken(PATTERNS[index % PATTERNS.len()], Vec::new());
            (Some(sample), format!("{}: {}", letter(index), mark.label))
        });
        let lost = |upright| move |mark: &&Mark| !self.has_place(upright, mark);
        let verticals = self.verticals.iter().filter(lost(true));
        let lost = verticals.chain(self.horizontals.iter().filter(lost(false)));
        drawn.chain(lost.map(|mark| (None, mark.label.clone()))).collect()
    }
}

fn letter(index: usize) -> String {
    char::from(b'a' + (index % 26) as u8).into()
}

// The words beside a picture.

/// Characters in the width of the legend.
const LEGEND_CHARACTERS: usize = 28;

struct Legend<'a> {
    canvas: &'a mut Canvas,
    left: f64,
    y: f64,
    /// As of [`Frame`].
    unit: f64,
}

impl<'a> Legend<'a> {
    fn new(canvas: &'a mut Canvas, frame: &Frame) -> Self {
        let ([_, top, right, _], unit) = (frame.room, frame.unit);
        Self { canvas, left: right + 50.0 * unit, y: top + 22.0 * unit, unit }
    }

    /// An entry: a sample of each part, and its words in at most six lines. What does not fit is left to the table.
    fn entry(&mut self, parts: &[&Part], ink: (Colour, usize), words: &str) {
        let (left, right, y) = (self.left, self.left + 64.0 * self.unit, self.y);
        if y > self.canvas.height() - LINE * self.unit {
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
            self.canvas.text(&text, (right + 18.0 * self.unit, self.y), Anchor::Left);
            self.y += LINE * self.unit;
        }
    }

    fn space(&mut self) {
        self.y += 0.35 * LINE * self.unit;
    }
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
    corners: [CanvasPoint; 3],
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
    let Some(decade) = frame.decade() else {
        return Vec::new();
    };
    let parts = chart.series.iter().flat_map(|series| &series.parts);
    let runs =
        parts.flat_map(|part| chart.runs(frame, part).into_iter().map(move |run| (part, run)));
    let mut taken: Vec<CanvasPoint> =
        runs.flat_map(|(part, run)| if part.has_markers() { run } else { sampled(&run) }).collect();
    let mut placed = Vec::new();
    for (series, slope) in
        chart.series.iter().enumerate().filter_map(|(i, series)| Some((i, series.slope.as_ref()?)))
    {
        if let Some(corners) = free_place(slope, frame, decade, &taken) {
            taken.extend(sampled(&[&corners[..], &corners[..1]].concat()));
            let [left, top, right, bottom] = label_box(&corners, &slope.label);
            taken.extend(sampled(&[(left, top), (right, top), (right, bottom), (left, bottom)]));
            placed.push(Placed { series, corners, label: slope.label.clone() });
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
                beside && y > high - above && y < low + CLEAR
                    || x > label[0] - 0.5 * CLEAR
                        && x < label[2] + 0.5 * CLEAR
                        && y > label[1] - 0.5 * CLEAR
                        && y < label[3] + 0.5 * CLEAR
            };
            let inside = corners[0].1.max(top) < bottom - MOVE && label[2] < right_end;
            (inside && !taken.iter().any(near)).then_some(corners)
        })
    })
}

/// The sides of the label, right of the upright side.
fn label_box(corners: &[CanvasPoint; 3], label: &str) -> [f64; 4] {
    let (left, middle) = (corners[1].0 + MOVE, 0.5 * (corners[1].1 + corners[2].1));
    let right = left + CHARACTER * label.chars().count() as f64;
    [left, middle - HALF_LINE, right, middle + HALF_LINE]
}

impl Placed {
    #[cfg(test)]
    pub(super) fn corners(&self) -> [CanvasPoint; 3] {
        self.corners
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
