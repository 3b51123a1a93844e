//! The corners of a rectangle with what may hold on their sides.

use std::f64::consts::FRAC_PI_2;

use super::{Wedge, WedgeSide};
use crate::scene::{ContactScene, Domain, Side};

/// A corner of a scene.
#[derive(Debug, Clone)]
pub struct Corner {
    /// Its two sides.
    pub sides: [Side; 2],
    /// What holds there: one possibility, or two where a side is in contact (open or compliant; locked).
    pub wedges: Vec<Wedge>,
}

impl Corner {
    /// The least order in h among the possibilities.
    pub fn order(&self) -> f64 {
        self.wedges.iter().map(Wedge::order).fold(1.0, f64::min)
    }

    /// One line: sides, then each possibility with its exponent.
    pub fn in_words(&self) -> String {
        let one = |wedge: &Wedge| {
            let [a, b] = wedge.sides.map(WedgeSide::name);
            match wedge.exponents().first() {
                None => format!("{a}/{b}: no singularity below r^1"),
                Some(s) if s.im == 0.0 => format!("{a}/{b}: r^{:.4}", s.re),
                Some(s) => format!("{a}/{b}: r^({:.4} ± {:.4}i)", s.re, s.im),
            }
        };
        let list: Vec<String> = self.wedges.iter().map(one).collect();
        let [a, b] = self.sides.map(Side::name);
        format!("{a} {b}: {}", list.join("; "))
    }
}

/// The corners of a plane rectangle; empty for boxes. Memory and projection are left out: where the memory tensor is
/// no multiple of the elasticity the exponents belong to the instantaneous response.
pub fn corners(body: &ContactScene) -> Vec<Corner> {
    if body.domain.size.len() != 2 {
        return Vec::new();
    }
    let lame_ratio = body.material.lambda / body.material.mu;
    let gap = body.contact.as_ref().is_some_and(|contact| contact.gap.is_some());
    let vertical = [Side::Left, Side::Right];
    let all = vertical.into_iter().flat_map(|side| [[side, Side::Bottom], [side, Side::Top]]);
    all.map(|sides| {
        let [first, second] = sides.map(|side| conditions(&body.domain, side, gap));
        let wedges = first.iter().flat_map(|&a| second.iter().map(move |&b| [a, b]));
        let wedge = |sides| Wedge { angle: FRAC_PI_2, sides, lame_ratio };
        Corner { sides, wedges: wedges.map(wedge).collect() }
    })
    .collect()
}

fn conditions(domain: &Domain, side: Side, gap: bool) -> &'static [WedgeSide] {
    match () {
        () if domain.clamped.contains(&side) => &[WedgeSide::Clamped],
        () if gap && domain.contact.contains(&side) => &[WedgeSide::Free, WedgeSide::Sliding],
        () => &[WedgeSide::Free],
    }
}
