//! Distinct abscissae of a set of points.
//!
//! A structured set of n^2 points has n distinct x. For every set of space variables in use, the distinct tuples of
//! those coordinates are numbered, by bit pattern, in order of appearance.

use rustc_hash::FxHashMap;

/// Sets of space variables: bit 0 for x, 1 for y, 2 for z.
pub(super) const MASKS: usize = 8;

#[derive(Clone, Debug, Default)]
struct Tuples {
    of_point: Vec<u32>,
    first: Vec<u32>,
}

#[derive(Clone, Debug)]
pub(super) struct Stages {
    tuples: [Option<Tuples>; MASKS],
    /// `maps[m][k]`: for each tuple of m the tuple of its part k.
    maps: [[Option<Vec<u32>>; MASKS]; MASKS],
}

impl Stages {
    /// Numbers the tuples of the sets in `masks`, and maps each pair of a set and its subset.
    pub(super) fn new(points: &[[f64; 3]], masks: &[u8], pairs: &[(u8, u8)]) -> Self {
        let mut stages = Self { tuples: Default::default(), maps: Default::default() };
        let varying = varying(points);
        for &mask in masks {
            stages.tuples[mask as usize].get_or_insert_with(|| match mask & varying {
                part if part == varying => Tuples::one_a_point(points.len()),
                0 => Tuples::one(points.len()),
                part => Tuples::new(points, part),
            });
        }
        for &(mask, part) in pairs {
            if let (Some(whole), Some(parts)) =
                (&stages.tuples[mask as usize], &stages.tuples[part as usize])
            {
                let of = |&p: &u32| parts.of_point[p as usize];
                let map = whole.first.iter().map(of).collect();
                stages.maps[mask as usize][part as usize] = Some(map);
            }
        }
        stages
    }

    pub(super) fn count(&self, mask: u8) -> usize {
        self.tuples[mask as usize].as_ref().map_or(0, |t| t.first.len())
    }

    pub(super) fn first_points(&self, mask: u8) -> &[u32] {
        self.tuples[mask as usize].as_ref().map_or(&[], |t| &t.first)
    }

    pub(super) fn of_points(&self, mask: u8) -> &[u32] {
        self.tuples[mask as usize].as_ref().map_or(&[], |t| &t.of_point)
    }

    pub(super) fn map(&self, mask: u8, part: u8) -> &[u32] {
        self.maps[mask as usize][part as usize].as_deref().unwrap_or(&[])
    }
}

/// The axes along which the points differ.
fn varying(points: &[[f64; 3]]) -> u8 {
    let differs =
        |axis: usize| points.iter().any(|p| p[axis].to_bits() != points[0][axis].to_bits());
    (0..3).map(|axis| u8::from(differs(axis)) << axis).sum()
}

impl Tuples {
    /// All axes: quadrature points are distinct, and a repeated one may be computed twice.
    fn one_a_point(points: usize) -> Self {
        let all: Vec<u32> = (0..points as u32).collect();
        Self { of_point: all.clone(), first: all }
    }

    /// No axes: one tuple, of all points.
    fn one(points: usize) -> Self {
        Self { of_point: vec![0; points], first: vec![0; points.min(1)] }
    }

    /// Numbers the tuples over the axes of `mask`.
    fn new(points: &[[f64; 3]], mask: u8) -> Self {
        let mut axes = (0..3).filter(|axis| mask >> axis & 1 == 1);
        let along = |axis: usize| Self::numbered(points.iter().map(|point| point[axis].to_bits()));
        let first = axes.next().map_or_else(|| Self::one(points.len()), along);
        axes.map(along).fold(first, |tuples, next| {
            let pairs = tuples.of_point.iter().zip(&next.of_point);
            Self::numbered(pairs.map(|(&a, &b)| u64::from(a) << 32 | u64::from(b)))
        })
    }

    /// Numbers the keys of all points in order of appearance.
    fn numbered(keys: impl ExactSizeIterator<Item = u64>) -> Self {
        let mut known: FxHashMap<u64, u32> = FxHashMap::default();
        let mut tuples = Self { of_point: Vec::with_capacity(keys.len()), first: Vec::new() };
        let mut last = None;
        for (p, key) in keys.enumerate() {
            let number = match last {
                // Points come in rows.
                Some((previous, number)) if previous == key => number,
                _ => *known.entry(key).or_insert(tuples.first.len() as u32),
            };
            if number as usize == tuples.first.len() {
                tuples.first.push(p as u32);
            }
            last = Some((key, number));
            tuples.of_point.push(number);
        }
        tuples
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const X: u8 = 1;
    const Y: u8 = 2;

    type Place = fn(usize) -> [usize; 3];

    /// Against a search of all points; 12 of 12 combinations occur, or 50 of 31 · 29.
    #[test]
    fn tuples_are_numbered_in_order_of_appearance() {
        let on_a_grid: Place = |k| [k % 4, k / 4 % 3, k];
        let scattered: Place = |k| [k % 50 * 7 % 31, k % 50 * 11 % 29, k];
        for (place, distinct) in [(on_a_grid, 12), (scattered, 50)] {
            let points: Vec<[f64; 3]> = (0..60).map(|k| place(k).map(|i| i as f64)).collect();
            let stages = Stages::new(&points, &[X, Y, X | Y], &[(X | Y, X), (X | Y, Y)]);
            assert_eq!(stages.count(X | Y), distinct);
            let mut first: Vec<u32> = Vec::new();
            for (p, point) in points.iter().enumerate() {
                let same = |&q: &u32| points[q as usize][..2] == point[..2];
                let tuple = first.iter().position(same).unwrap_or_else(|| {
                    first.push(p as u32);
                    first.len() - 1
                });
                assert_eq!(stages.of_points(X | Y)[p] as usize, tuple, "{point:?}");
                for part in [X, Y] {
                    let tuple_of_part = stages.map(X | Y, part)[tuple];
                    assert_eq!(tuple_of_part, stages.of_points(part)[p], "{point:?}");
                }
            }
            assert_eq!(stages.first_points(X | Y), first);
        }
    }
}
