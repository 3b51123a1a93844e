//! Distinct abscissae of a set of points.
//!
//! A structured set of n^2 points has n distinct x. For every set of space variables in use, the distinct tuples of
//! those coordinates are numbered, by bit pattern, in order of appearance.

use rustc_hash::FxHashMap;

/// Sets of space variables: bit 0 for x, 1 for y, 2 for z.
pub(super) const MASKS: usize = 8;

/// Limit of a table of all combinations, in lengths of the list of points.
const WIDEST: usize = 4;

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
        let needed = masks.iter().map(|mask| mask & varying).filter(|part| *part != varying);
        let needed = needed.fold(0, |all, part| all | part);
        let places =
            [0, 1, 2].map(|axis| (needed >> axis & 1 == 1).then(|| numbered(points, axis)));
        for &mask in masks {
            stages.tuples[mask as usize].get_or_insert_with(|| match mask & varying {
                part if part == varying => Tuples::one_a_point(points.len()),
                0 => Tuples::one(points.len()),
                part => Tuples::new(points.len(), part, &places),
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

    /// Numbers the tuples over the axes of `mask`; `places` has for each axis the numbered coordinate of each point and
    /// their count.
    fn new(points: usize, mask: u8, places: &[Option<(Vec<u32>, usize)>; 3]) -> Self {
        let axes: Vec<&(Vec<u32>, usize)> = (0..3)
            .filter(|axis| mask >> axis & 1 == 1)
            .filter_map(|k| places[k].as_ref())
            .collect();
        let numbers = |p: usize| {
            axes.iter().fold(0, |number, (place, count)| number * count + place[p] as usize)
        };
        let all = axes.iter().map(|(_, count)| count).product();
        if all <= WIDEST * points {
            let mut known = vec![u32::MAX; all];
            return Self::in_order(points, |p, next| {
                let number = &mut known[numbers(p)];
                *number = next.min(*number);
                *number
            });
        }
        let mut known: FxHashMap<usize, u32> = FxHashMap::default();
        Self::in_order(points, |p, next| *known.entry(numbers(p)).or_insert(next))
    }

    /// Numbers the tuples as they appear; `known` returns the number of a point's tuple, given that of a new one.
    fn in_order(points: usize, mut known: impl FnMut(usize, u32) -> u32) -> Self {
        let mut tuples = Self { of_point: Vec::with_capacity(points), first: Vec::new() };
        for p in 0..points {
            let tuple = known(p, tuples.first.len() as u32);
            if tuple as usize == tuples.first.len() {
                tuples.first.push(p as u32);
            }
            tuples.of_point.push(tuple);
        }
        tuples
    }
}

/// Numbers the distinct coordinates along an axis by bit pattern, in order of appearance.
fn numbered(points: &[[f64; 3]], axis: usize) -> (Vec<u32>, usize) {
    let mut known: FxHashMap<u64, u32> = FxHashMap::default();
    let mut numbers: Vec<u32> = Vec::with_capacity(points.len());
    let mut last = None;
    for point in points {
        let bits = point[axis].to_bits();
        let number = match last {
            // Points come in rows.
            Some((previous, number)) if previous == bits => number,
            _ => {
                let next = known.len() as u32;
                *known.entry(bits).or_insert(next)
            }
        };
        last = Some((bits, number));
        numbers.push(number);
    }
    (numbers, known.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    const X: u8 = 1;
    const Y: u8 = 2;

    type Place = fn(usize) -> [usize; 3];

    /// Against a search of all points; numbering by table and by hash: 12 of 12 combinations occur, or 50 of 31 · 29.
    #[test]
    fn tuples_are_numbered_in_order_of_appearance() {
        let on_a_grid: Place = |k| [k % 4, k / 4 % 3, k];
        let scattered: Place = |k| [k % 50 * 7 % 31, k % 50 * 11 % 29, k];
        let few = |count: usize, points: usize| count <= WIDEST * points;
        assert!(few(4 * 3, 60) && !few(31 * 29, 60));
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
