//! Distinct abscissae of a set of points.
//!
//! A structured set of n^2 points has n distinct x.  For every set of space
//! variables an expression may depend on, the distinct tuples of those
//! coordinates are numbered, by bit pattern and in order of appearance.

use std::collections::hash_map::Entry;

use rustc_hash::FxHashMap;

/// Sets of space variables: bit 0 for x, 1 for y, 2 for z.
pub(super) const MASKS: usize = 8;

/// The tuples of one set of variables.
#[derive(Clone, Debug, Default)]
struct Tuples {
    /// The tuple each point belongs to.
    of_point: Vec<u32>,
    /// The first point of each tuple.
    first: Vec<u32>,
}

/// The numbered tuples of all sets of variables in use.
#[derive(Clone, Debug)]
pub(super) struct Stages {
    tuples: [Option<Tuples>; MASKS],
    /// `maps[m][k]`: for each tuple of m the tuple of its part k.
    maps: [[Option<Vec<u32>>; MASKS]; MASKS],
}

impl Stages {
    /// Numbers the tuples of the sets in `masks`, and maps those in `pairs`
    /// from the first set to its subset, the second.
    pub(super) fn new(points: &[[f64; 3]], masks: &[u8], pairs: &[(u8, u8)]) -> Self {
        let mut stages = Self { tuples: Default::default(), maps: Default::default() };
        let varying = varying(points);
        for &mask in masks {
            stages.tuples[mask as usize].get_or_insert_with(|| match mask & varying {
                part if part == varying => Tuples::one_a_point(points.len()),
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

    /// How many tuples the set has.
    pub(super) fn count(&self, mask: u8) -> usize {
        self.tuples[mask as usize].as_ref().map_or(0, |t| t.first.len())
    }

    /// The first point of each tuple.
    pub(super) fn first_points(&self, mask: u8) -> &[u32] {
        self.tuples[mask as usize].as_ref().map_or(&[], |t| &t.first)
    }

    /// The tuple of each point.
    pub(super) fn of_points(&self, mask: u8) -> &[u32] {
        self.tuples[mask as usize].as_ref().map_or(&[], |t| &t.of_point)
    }

    /// For each tuple of `mask` the tuple of its part `part`.
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
    /// All axes: points of quadrature are distinct, and one that occurs twice is computed twice.
    fn one_a_point(points: usize) -> Self {
        let all: Vec<u32> = (0..points as u32).collect();
        Self { of_point: all.clone(), first: all }
    }

    fn new(points: &[[f64; 3]], mask: u8) -> Self {
        let mut known: FxHashMap<[u64; 3], u32> = FxHashMap::default();
        let mut tuples = Self::default();
        tuples.of_point.reserve(points.len());
        for (p, point) in points.iter().enumerate() {
            let mut key = [0; 3];
            for (axis, bits) in key.iter_mut().enumerate() {
                if mask >> axis & 1 == 1 {
                    *bits = point[axis].to_bits();
                }
            }
            let next = tuples.first.len() as u32;
            let tuple = match known.entry(key) {
                Entry::Occupied(entry) => *entry.get(),
                Entry::Vacant(entry) => {
                    tuples.first.push(p as u32);
                    *entry.insert(next)
                }
            };
            tuples.of_point.push(tuple);
        }
        tuples
    }
}
