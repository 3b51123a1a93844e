//! Corner singularities: the powers s with which displacements r^s leave a corner of an elastic body in plane
//! strain, hence the order in h that loads without a manufactured solution leave there.
//!
//! In a wedge of angle ω the displacement is a sum of terms r^s (log r)^m φ(θ) with Re s > 0, where s is a root of
//! a transcendental equation set by what happens on the two sides (M. L. Williams, J. Appl. Mech. 19 (1952)
//! 526-528). With s the root of smallest real part u ∈ H^{1+t} for t < Re s, and P1 elements on uniform meshes
//! have the order min(Re s, 1) in h there. A load may not excite that term: then the order is better.

use std::f64::consts::{PI, TAU};

use files::digits;
use nalgebra::{Complex, Matrix4};
use scene::{ContactScene, Domain, Face, Side};
use vhi::law::{FourthOrder, Isotropic};

// The corners of a plane domain with what may hold on their sides.

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
    let gap = body.has_gap();
    let both = |side: Side, face: &Face| {
        let ([x, y, _], edge, tangent) = (face.corner, face.edges[0], face.tangents()[0]);
        let normal = [face.normal[0], face.normal[1]];
        let end = |place, along| End { side, place, along, normal };
        let last = [x + edge[0], y + edge[1]];
        [end([x, y], [tangent[0], tangent[1]]), end(last, [-tangent[0], -tangent[1]])]
    };
    let of_side = |side| domain.faces(side).into_iter().flat_map(move |face| both(side, &face));
    let ends: Vec<End> = domain.all_sides().flat_map(of_side).collect();
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
        () if domain.symmetry.contains(&side) => &[WedgeSide::Sliding],
        () if gap && domain.contact.contains(&side) => &[WedgeSide::Free, WedgeSide::Sliding],
        () => &[WedgeSide::Free],
    }
}

// The characteristic determinant of a wedge, and its root of smallest real part.

/// What holds on a side of a wedge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WedgeSide {
    /// u = 0.
    Clamped,
    /// σν = 0: free or loaded sides, open contact, and compliance, whose pressure is smoother than σ.
    Free,
    /// u_ν given, σ_τ = 0: locked frictionless contact, or a plane of symmetry.
    Sliding,
}

impl WedgeSide {
    /// The word in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Clamped => "clamped",
            Self::Free => "free",
            Self::Sliding => "sliding",
        }
    }
}

/// A wedge of an isotropic material in plane strain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wedge {
    /// ω in radians, in (0, 2π].
    pub angle: f64,
    /// The sides θ = 0 and θ = ω.
    pub sides: [WedgeSide; 2],
    /// λ/μ_L > -1; Poisson's number is λ/(2(λ + μ_L)).
    pub lame_ratio: f64,
}

/// The strip in which roots are sought: below 1 a root costs order; 0 and 1 themselves are rigid motions, or come
/// from functions of θ that coincide there.
const STRIP: [f64; 2] = [0.02, 0.999];
/// Roots in the strip have ω |Im s| below this: beyond it sinh² of ω Im s outgrows the rest.
const IMAGINARY: f64 = 8.0;
/// A narrower wedge has no root in the strip, and one of angle 0 a strip without end. There sω is imaginary but for rounding,
/// |sin sω| ≥ |sω|, and Williams's equations hold at s = 1 at most: κ > 1 makes one side of each larger.
const NARROWEST: f64 = 1e-3;

impl Wedge {
    /// Kolosov's number 3 - 4ν = (λ + 3μ_L)/(λ + μ_L).
    pub(crate) fn kolosov(&self) -> f64 {
        (self.lame_ratio + 3.0) / (self.lame_ratio + 1.0)
    }

    /// The determinant of the four conditions on the sides.
    ///
    /// With f = a cos(s+1)θ + b sin(s+1)θ + c cos(s-1)θ + d sin(s-1)θ, Airy's function being r^{s+1} f,
    /// 2μ_L u_r = r^s(-(s+1) f + (1+κ)(c cos(s-1)θ + d sin(s-1)θ)), 2μ_L u_θ = r^s(-f' + (1+κ)(c sin(s-1)θ - d cos(s-1)θ)),
    /// σ_θθ = s(s+1) r^{s-1} f, σ_rθ = -s r^{s-1} f'. Rows are divided by their powers of r and s; the factor s - 1 of
    /// the column d, whose function vanishes at s = 1, stays.
    pub(crate) fn determinant(&self, s: Complex<f64>) -> Complex<f64> {
        let [first, second] = self.sides;
        let rows = [self.conditions(first, s, 0.0), self.conditions(second, s, self.angle)];
        Matrix4::from_row_slice(rows.as_flattened().as_flattened()).determinant()
    }

    fn conditions(&self, side: WedgeSide, s: Complex<f64>, theta: f64) -> [[Complex<f64>; 4]; 2] {
        let (p, q) = (s + 1.0, s - 1.0);
        let [[cp, sp], [cq, sq]] =
            [p, q].map(|factor| [(factor * theta).cos(), (factor * theta).sin()]);
        let f = [cp, sp, cq, sq];
        let slope = [-p * sp, p * cp, -q * sq, q * cq];
        let zero = Complex::new(0.0, 0.0);
        let k = 1.0 + self.kolosov();
        let radial_part = [zero, zero, cq * k, sq * k];
        let around_part = [zero, zero, sq * k, -cq * k];
        let radial = std::array::from_fn(|i| -p * f[i] + radial_part[i]);
        let around = std::array::from_fn(|i| -slope[i] + around_part[i]);
        match side {
            WedgeSide::Clamped => [radial, around],
            WedgeSide::Free => [f, slope],
            WedgeSide::Sliding => [around, slope],
        }
    }

    /// The roots s with 0.02 < Re s < 0.999 and Im s ≥ 0, by real part; those of Im s > 0 stand for a pair. None if
    /// the corner costs no order.
    pub(crate) fn exponents(&self) -> Vec<Complex<f64>> {
        if self.angle < NARROWEST {
            return Vec::new();
        }
        let top = IMAGINARY / self.angle;
        let mut roots = roots_in(STRIP, top, |s| self.determinant(s) / (s * (s - 1.0)));
        roots.sort_by(|a, b| a.re.total_cmp(&b.re).then(a.im.total_cmp(&b.im)));
        roots
    }

    /// min(Re s, 1) of the strongest singularity.
    pub fn order(&self) -> f64 {
        self.exponents().first().map_or(1.0, |s| s.re)
    }
}

// Roots of an analytic function in a strip, by Newton's method from a lattice of starts.

/// Starts along the real and the imaginary direction. Half as many along the real one find the strongest root of all of 2,160
/// wedges; roots near s = 1 that are not the strongest may need more.
const STARTS: [u32; 2] = [24, 16];
/// Imaginary parts below this are rounding: a real root. Roots closer than ten times this are one.
const REAL: f64 = 1e-7;

/// The roots with real part in `strip` and imaginary part in [0, `top`], each once; f(s̄) is the conjugate of f(s).
pub(super) fn roots_in(
    strip: [f64; 2],
    top: f64,
    f: impl Fn(Complex<f64>) -> Complex<f64>,
) -> Vec<Complex<f64>> {
    let [columns, rows] = STARTS.map(f64::from);
    let start = |i: u32, j: u32| {
        let (across, up) = (f64::from(i) / columns, f64::from(j) / rows);
        Complex::new(strip[0] + across * (strip[1] - strip[0]), top * up)
    };
    let starts = (0..=STARTS[0]).flat_map(|i| (0..=STARTS[1]).map(move |j| start(i, j)));
    let mut roots: Vec<Complex<f64>> = Vec::new();
    for mut root in starts.filter_map(|start| newton(start, &f)) {
        root.im = if root.im.abs() < REAL { 0.0 } else { root.im.abs() };
        let inside = root.re > strip[0] && root.re < strip[1] && root.im <= top;
        if inside && roots.iter().all(|known| (known - root).norm() > 10.0 * REAL) {
            roots.push(root);
        }
    }
    roots
}

/// Newton's method for f/f', whose roots are simple whatever those of f are, by central differences.
fn newton(mut s: Complex<f64>, f: impl Fn(Complex<f64>) -> Complex<f64>) -> Option<Complex<f64>> {
    const STEP: f64 = 1e-4;
    for _ in 0..40 {
        let [before, here, after] = [s - STEP, s, s + STEP].map(&f);
        let (slope, bend) =
            ((after - before) / (2.0 * STEP), (after + before - here * 2.0) / (STEP * STEP));
        let change = here * slope / (slope * slope - here * bend);
        s -= change;
        // A multiple root is known to the root of rounding; what leaps has no root nearby.
        match change.norm() {
            size if size < REAL => return Some(s),
            size if size > 1.0 => break,
            _ => {}
        }
    }
    None
}

#[cfg(test)]
mod tests {
    mod of_scene {
        use super::super::*;

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

    mod wedge {
        use super::super::*;
        use std::f64::consts::PI;

        use WedgeSide::{Clamped, Free, Sliding};

        fn wedge(degrees: f64, sides: [WedgeSide; 2], lame_ratio: f64) -> Wedge {
            Wedge { angle: degrees * PI / 180.0, sides, lame_ratio }
        }

        fn strongest(degrees: f64, sides: [WedgeSide; 2], lame_ratio: f64) -> Complex<f64> {
            let found = wedge(degrees, sides, lame_ratio).exponents();
            *found.first().unwrap_or_else(|| panic!("{degrees} {sides:?}: no root below 1"))
        }

        /// A root of a real function by bisection.
        fn bisected(mut lo: f64, mut hi: f64, f: impl Fn(f64) -> f64) -> f64 {
            assert!(f(lo) * f(hi) < 0.0, "no change of sign");
            for _ in 0..80 {
                let middle = 0.5 * (lo + hi);
                if f(lo) * f(middle) <= 0.0 { hi = middle } else { lo = middle }
            }
            0.5 * (lo + hi)
        }

        /// Williams's equations in closed form: sin²(sω) = s² sin²ω between free sides, κ² sin²(sω) = s² sin²ω between
        /// clamped ones, 4κ sin²(sω) = (κ+1)² - 4 s² sin²ω between one of each.
        #[test]
        fn roots_are_those_of_the_closed_equations() {
            for lame_ratio in [0.5, 1.0, 4.0] {
                for degrees in [200.0, 240.0, 270.0, 300.0, 340.0] {
                    let omega: f64 = degrees * PI / 180.0;
                    let kappa = wedge(degrees, [Free, Free], lame_ratio).kolosov();
                    let sines = |s: f64| ((s * omega).sin().powi(2), (s * omega.sin()).powi(2));
                    for (sides, factor) in
                        [([Free, Free], 1.0), ([Clamped, Clamped], kappa * kappa)]
                    {
                        let s = strongest(degrees, sides, lame_ratio);
                        let (left, right) = sines(s.re);
                        assert!(
                            s.im == 0.0 && (factor * left - right).abs() < 1e-9,
                            "{sides:?} {s}"
                        );
                    }
                    let mixed = wedge(degrees, [Clamped, Free], lame_ratio).exponents();
                    assert!(!mixed.is_empty());
                    for s in mixed {
                        let left = (s * omega).sin().powi(2) * 4.0 * kappa;
                        let right = s * s * (4.0 * omega.sin().powi(2));
                        let rest = left + right - Complex::new((kappa + 1.0).powi(2), 0.0);
                        assert!(rest.norm() < 1e-8, "{degrees} {s}: {rest}");
                    }
                }
            }
        }

        #[test]
        fn published_exponents() {
            // The reentrant corner of an L: sin(1.5π s) = -s sin(1.5π), s = 0.54448…, for every Poisson number.
            let l = bisected(0.4, 0.7, |s| (1.5 * PI * s).sin() - s);
            assert!((l - 0.544_483_736_782_464).abs() < 1e-12);
            for ratio in [0.0, 1.0, 10.0] {
                let s = strongest(270.0, [Free, Free], ratio);
                assert!((s.re - l).abs() < 1e-9 && s.im == 0.0, "{s}");
            }
            // The crack: s = 1/2, twice.
            assert!((strongest(360.0, [Free, Free], 1.0).re - 0.5).abs() < 1e-6);
            // Clamped to free on a straight side: s = 1/2 ± i ln(κ)/(2π).
            let s = strongest(180.0, [Clamped, Free], 1.0);
            assert!((s - Complex::new(0.5, 2f64.ln() / (2.0 * PI))).norm() < 1e-9, "{s}");
            // Free to sliding on a straight side: half of the crack in symmetric load.
            assert!((strongest(180.0, [Free, Sliding], 1.0).re - 0.5).abs() < 1e-9);
            // The corner of a clamped block at λ = μ_L: 8 sin²(sπ/2) = 9 - 4 s².
            let block =
                bisected(0.6, 0.9, |s| 8.0 * (0.5 * PI * s).sin().powi(2) - 9.0 + 4.0 * s * s);
            assert!((strongest(90.0, [Clamped, Free], 1.0).re - block).abs() < 1e-9);
            assert!((block - 0.745).abs() < 5e-4);
            // Clamped to sliding, half of a clamped wedge that is hardly reentrant: κ sin(2ωs) = s sin(2ω), κ = 3, is weak.
            let omega = 189.26 * PI / 180.0;
            let weak = bisected(0.9, 0.999, |s| 3.0 * (omega * s).sin() - s * omega.sin());
            let s = strongest(0.5 * 189.26, [Clamped, Sliding], 0.0);
            assert!((s.re - weak).abs() < 1e-9 && s.im == 0.0, "{s} {weak}");
        }

        /// A sliding side is a plane of symmetry: the wedge has the symmetric half of the roots of the doubled one.
        #[test]
        fn a_sliding_side_is_half_of_a_doubled_wedge() {
            for degrees in [100.0, 120.0, 150.0, 170.0] {
                for side in [Free, Clamped] {
                    let half = wedge(degrees, [side, Sliding], 1.0).exponents();
                    let whole = wedge(2.0 * degrees, [side, side], 1.0).exponents();
                    assert!(!half.is_empty(), "{degrees} {side:?}");
                    for s in half {
                        let nearest =
                            whole.iter().map(|w| (w - s).norm()).fold(f64::INFINITY, f64::min);
                        assert!(nearest < 1e-7, "{degrees} {side:?}: {s} of {whole:?}");
                    }
                }
            }
        }

        #[test]
        fn convex_corners_without_a_change_of_condition_cost_nothing() {
            for sides in [[Free, Free], [Clamped, Clamped], [Sliding, Sliding], [Clamped, Sliding]]
            {
                assert_eq!(wedge(90.0, sides, 1.0).order(), 1.0, "{sides:?}");
            }
            assert_eq!(wedge(60.0, [Free, Sliding], 1.0).order(), 1.0);
            // Narrow to flat: none is sought for long.
            for degrees in [1.0, 0.06, 0.05, 0.0] {
                for sides in [[Free, Free], [Clamped, Clamped], [Clamped, Free], [Clamped, Sliding]]
                {
                    assert_eq!(wedge(degrees, sides, 1.0).order(), 1.0, "{degrees} {sides:?}");
                }
            }
            // A seeded defect: Kolosov's number of plane stress instead of plane strain moves the exponent.
            let stress = wedge(90.0, [Clamped, Free], 2.0 / 3.0).order();
            assert!((stress - wedge(90.0, [Clamped, Free], 1.0).order()).abs() > 5e-3);
        }
    }

    mod roots {
        use super::super::*;

        #[test]
        fn roots_of_a_polynomial_are_found_once() {
            // (s - 0.3)(s - 0.7)²((s - 0.5)² + 0.04): real, double, and a pair.
            let f = |s: Complex<f64>| {
                let at = |x: f64| s - Complex::new(x, 0.0);
                at(0.3) * at(0.7) * at(0.7) * (at(0.5) * at(0.5) + Complex::new(0.04, 0.0))
            };
            let mut roots = roots_in([0.02, 0.999], 3.0, f);
            roots.sort_by(|a, b| a.re.total_cmp(&b.re));
            assert_eq!(roots.len(), 3, "{roots:?}");
            for (found, expected) in roots.iter().zip([[0.3, 0.0], [0.5, 0.2], [0.7, 0.0]]) {
                assert!((found - Complex::new(expected[0], expected[1])).norm() < 1e-6, "{found}");
            }
            // Nothing inside: nothing found.
            assert!(roots_in([0.02, 0.25], 3.0, f).is_empty());
        }
    }
}
