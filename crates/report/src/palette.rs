//! Colours for colour-blind readers, after Okabe and Ito (2008), each with a marker for prints without colours.

use plotters::style::RGBColor;

pub(super) const COLOURS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(0, 0, 0),
];

/// Lines of the grid.
pub(super) const GRID: RGBColor = RGBColor(222, 222, 222);

/// Axes, triangles and floors.
pub(super) const INK: RGBColor = RGBColor(90, 90, 90);

/// Colour of the i-th curve. With four markers, 28 curves differ.
pub(super) fn colour(index: usize) -> RGBColor {
    COLOURS[index % COLOURS.len()]
}

/// The colour at a part of the way between two, by their numbers.
pub(super) fn mixed(from: [f64; 3], to: [f64; 3], part: f64) -> RGBColor {
    let [r, g, b] = [0, 1, 2].map(|i| (from[i] + part * (to[i] - from[i])) as u8);
    RGBColor(r, g, b)
}
