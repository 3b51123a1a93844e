//! The characteristic determinant of a wedge, and its root of smallest real part.

use nalgebra::{Complex, Matrix4};

use super::roots::roots_in;

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
        let mut roots = roots_in(STRIP, top, &|s| self.determinant(s) / (s * (s - 1.0)));
        roots.sort_by(|a, b| a.re.total_cmp(&b.re).then(a.im.total_cmp(&b.im)));
        roots
    }

    /// min(Re s, 1) of the strongest singularity.
    pub fn order(&self) -> f64 {
        self.exponents().first().map_or(1.0, |s| s.re)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
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
                for (sides, factor) in [([Free, Free], 1.0), ([Clamped, Clamped], kappa * kappa)] {
                    let s = strongest(degrees, sides, lame_ratio);
                    let (left, right) = sines(s.re);
                    assert!(s.im == 0.0 && (factor * left - right).abs() < 1e-9, "{sides:?} {s}");
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
        let block = bisected(0.6, 0.9, |s| 8.0 * (0.5 * PI * s).sin().powi(2) - 9.0 + 4.0 * s * s);
        assert!((strongest(90.0, [Clamped, Free], 1.0).re - block).abs() < 1e-9);
        assert!((block - 0.745).abs() < 5e-4);
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
        for sides in [[Free, Free], [Clamped, Clamped], [Sliding, Sliding], [Clamped, Sliding]] {
            assert_eq!(wedge(90.0, sides, 1.0).order(), 1.0, "{sides:?}");
        }
        assert_eq!(wedge(60.0, [Free, Sliding], 1.0).order(), 1.0);
        // Narrow to flat: none is sought for long.
        for degrees in [1.0, 0.06, 0.05, 0.0] {
            for sides in [[Free, Free], [Clamped, Clamped], [Clamped, Free], [Clamped, Sliding]] {
                assert_eq!(wedge(degrees, sides, 1.0).order(), 1.0, "{degrees} {sides:?}");
            }
        }
        // A seeded defect: Kolosov's number of plane stress instead of plane strain moves the exponent.
        let stress = wedge(90.0, [Clamped, Free], 2.0 / 3.0).order();
        assert!((stress - wedge(90.0, [Clamped, Free], 1.0).order()).abs() > 5e-3);
    }

    #[test]
    fn the_determinant_is_the_closed_one_up_to_a_factor() {
        // Between free sides: det = const · (sin²(sω) - s² sin²ω) · g(s) with g free of zeros in the strip.
        let w = wedge(270.0, [Free, Free], 1.0);
        let closed = |s: f64| (1.5 * PI * s).sin().powi(2) - (s * (1.5 * PI).sin()).powi(2);
        let ratio = |s: f64| w.determinant(Complex::new(s, 0.0)).re / closed(s);
        assert!([0.2, 0.4, 0.6, 0.8].windows(2).all(|p| ratio(p[0]) * ratio(p[1]) > 0.0));
    }
}
