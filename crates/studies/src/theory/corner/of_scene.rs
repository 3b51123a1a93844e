//! The corners of a plane domain with what may hold on their sides.

use std::f64::consts::{PI, TAU};

use super::{Wedge, WedgeSide};
use files::digits;
use scene::{ContactScene, Domain, Face, Side};
use vhi::law::{FourthOrder, Isotropic};

/// A corner of a scene, or a point of a straight side where the condition changes.
#[derive(Debug, Clone)]
pub struct Corner {
    /// Where it is.
    pub place: [f64; 2],
    /// The names of its two sides.
    pub sides: [String; 2],
    /// What holds there: one possibility, or several where a side is in contact (open or compliant; locked).
    pub wedges: Vec<Wedge>,
}

/// Angles closer than this to π are straight.
const ROUNDING: f64 = 1e-9;
/// Ends of segments closer than this part of the domain are one point: they are sums of two coordinates, and a flat domain
/// has others that are nearly as close.
const SAME: f64 = 1e-13;

impl Corner {
    /// The least order in h among the possibilities.
    pub fn order(&self) -> f64 {
        self.wedges.iter().map(Wedge::order).fold(1.0, f64::min)
    }

    /// One line: sides, angle, then each possibility with its exponent.
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
        let [a, b] = &self.sides;
        let degrees = self.wedges.first().map_or(0.0, |wedge| wedge.angle.to_degrees());
        let [x, y] = self.place;
        let (x, y) = (digits(x, 5), digits(y, 5));
        format!("({x}, {y}) {a} {b}, {degrees:.0} degrees: {}", list.join("; "))
    }
}

/// An end of a plane piece of the boundary.
struct End {
    side: Side,
    place: [f64; 2],
    /// From the end along the piece, a unit vector.
    along: [f64; 2],
    normal: [f64; 2],
}

impl End {
    fn both(side: Side, face: &Face) -> [Self; 2] {
        let ([x, y, _], edge, tangent) = (face.corner, face.edges[0], face.tangents()[0]);
        let normal = [face.normal[0], face.normal[1]];
        let end = |place, along| Self { side, place, along, normal };
        let [first, last] = [[x, y], [x + edge[0], y + edge[1]]];
        [end(first, [tangent[0], tangent[1]]), end(last, [-tangent[0], -tangent[1]])]
    }

    /// The angle of the domain between this piece and another that leaves the same point.
    fn angle(&self, other: &Self) -> f64 {
        let dot = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
        let cosine = dot(self.along, other.along);
        let sine = self.along[0] * other.along[1] - self.along[1] * other.along[0];
        let between = sine.abs().atan2(cosine);
        // Convex where the other piece lies behind this one's outward normal.
        if dot(other.along, self.normal) > ROUNDING { TAU - between } else { between }
    }
}

/// The corners of a plane body of one isotropic material; empty in space, and where the material is another: an
/// interface that meets the boundary is another kind of singular point. Memory and projection are left out:
/// where the memory tensor is no multiple of the elasticity the exponents belong to the instantaneous response.
pub fn corners(body: &ContactScene) -> Vec<Corner> {
    let domain = &body.domain;
    if domain.dimension() != 2 {
        return Vec::new();
    }
    let FourthOrder::Isotropic(Isotropic { lambda, mu }) = body.material.elastic else {
        return Vec::new();
    };
    if !body.material.regions.is_empty() {
        return Vec::new();
    }
    let lame_ratio = lambda / mu;
    let gap = body.contact.as_ref().is_some_and(|contact| contact.gap.is_some());
    let faces = |side| domain.faces(side).into_iter().map(move |face| (side, face));
    let ends: Vec<End> = domain
        .all_sides()
        .flat_map(faces)
        .flat_map(|(side, face)| End::both(side, &face))
        .collect();
    let size = domain.size.iter().copied().fold(0.0, f64::max);
    let together =
        |a: &End, b: &End| (a.place[0] - b.place[0]).hypot(a.place[1] - b.place[1]) <= SAME * size;
    let mut found = Vec::new();
    for (i, a) in ends.iter().enumerate() {
        for b in ends[i + 1..].iter().filter(|b| together(a, b)) {
            let angle = a.angle(b);
            let [first, second] = [a, b].map(|end| conditions(domain, end.side, gap));
            if (angle - PI).abs() < ROUNDING && first == second {
                continue;
            }
            let pairs = first.iter().flat_map(|&p| second.iter().map(move |&q| [p, q]));
            let wedges = pairs.map(|sides| Wedge { angle, sides, lame_ratio }).collect();
            let sides = [a, b].map(|end| domain.name(end.side).to_owned());
            found.push(Corner { place: a.place, sides, wedges });
        }
    }
    found
}

fn conditions(domain: &Domain, side: Side, gap: bool) -> &'static [WedgeSide] {
    match () {
        () if domain.clamped.contains(&side) => &[WedgeSide::Clamped],
        () if gap && domain.contact.contains(&side) => &[WedgeSide::Free, WedgeSide::Sliding],
        () => &[WedgeSide::Free],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A segment of the boundary of an L with its reentrant corner at the origin, the quadrant x, y > 0 cut out.
    fn end(along: [f64; 2], normal: [f64; 2]) -> End {
        End { side: Side(0), place: [0.0, 0.0], along, normal }
    }

    #[test]
    fn angles_are_those_of_the_domain() {
        let convex = [end([1.0, 0.0], [0.0, -1.0]), end([0.0, 1.0], [-1.0, 0.0])];
        let reentrant = [end([1.0, 0.0], [0.0, 1.0]), end([0.0, 1.0], [1.0, 0.0])];
        for ([a, b], degrees) in [(&convex, 90.0), (&reentrant, 270.0)] {
            assert!((a.angle(b).to_degrees() - degrees).abs() < 1e-12);
            assert!((b.angle(a).to_degrees() - degrees).abs() < 1e-12);
        }
        let straight = [end([1.0, 0.0], [0.0, -1.0]), end([-1.0, 0.0], [0.0, -1.0])];
        assert!((straight[0].angle(&straight[1]) - PI).abs() < 1e-12);
    }
}
