//! Colours for colour-blind readers, after Okabe and Ito (2008), each with a marker for prints without colours.

use std::fmt;

use plotters::style::Color;
use plotters_backend::BackendColor;

/// Red, green and blue.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Colour(pub(super) u8, pub(super) u8, pub(super) u8);

impl fmt::Display for Colour {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "#{:02X}{:02X}{:02X}", self.0, self.1, self.2)
    }
}

impl Color for Colour {
    fn to_backend_color(&self) -> BackendColor {
        BackendColor { alpha: 1.0, rgb: (self.0, self.1, self.2) }
    }
}

pub(super) const COLOURS: [Colour; 7] = [
    Colour(0, 114, 178),
    Colour(213, 94, 0),
    Colour(0, 158, 115),
    Colour(204, 121, 167),
    Colour(230, 159, 0),
    Colour(86, 180, 233),
    Colour(0, 0, 0),
];

/// Lines of the grid.
pub(super) const GRID: Colour = Colour(222, 222, 222);

/// Axes, triangles and floors.
pub(super) const INK: Colour = Colour(90, 90, 90);

/// Colour of the i-th curve.
pub(super) fn colour(index: usize) -> Colour {
    COLOURS[index % COLOURS.len()]
}

/// Colour and marker of the i-th curve: those of 49 curves all differ, and so do both of the first seven.
pub(super) fn ink(index: usize) -> (Colour, usize) {
    (colour(index), index + index / COLOURS.len())
}

/// The colour at a part of the way between two, by their numbers.
pub(super) fn mixed(from: [f64; 3], to: [f64; 3], part: f64) -> Colour {
    let [r, g, b] = [0, 1, 2].map(|i| (from[i] + part * (to[i] - from[i])) as u8);
    Colour(r, g, b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use judge::record::NORMS;

    /// Norms that meet in a picture differ in colour and in marker, and all have a symbol of their own.
    #[test]
    fn norms_differ_in_all_that_is_drawn() {
        let inks: Vec<(Colour, usize)> =
            (0..NORMS.len()).map(|i| (ink(i).0, ink(i).1 % 7)).collect();
        for (i, (colour, shape)) in inks.iter().enumerate() {
            for (j, other) in inks[..i].iter().enumerate() {
                assert_ne!((*colour, *shape), *other, "{:?} {:?}", NORMS[i], NORMS[j]);
                assert!(i >= 7 || *colour != other.0 && *shape != other.1, "{i} {j}");
                assert_ne!(NORMS[i].symbol, NORMS[j].symbol);
            }
        }
    }
}
