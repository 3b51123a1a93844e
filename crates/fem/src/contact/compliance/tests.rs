//! Source: (5.14), whose boundary integral is exact.
//! Goal: the exact rule is the integral, for affine, absent and curved shifts, and its tangent the
//!   derivative; a rule that does not cut at kinks is caught; affine laws agree with Gauss points.
//! Mesh: 3 × 3 squares, contact below, the left side clamped, so that one end of Γ3 is fixed.

use std::sync::Arc;

use super::*;
use crate::mesh::{Family, lattice};
use vhi::law::{Curve, Curved, PiecewiseLinear, Potential};

fn space() -> Discretization {
    let mesh = lattice([1.0, 1.0], 3, Family::Structured);
    let (left, bottom) = (mesh.side("left").unwrap(), mesh.side("bottom").unwrap());
    Discretization::new(mesh, &[left], &[bottom])
}

fn law() -> PiecewiseLinear {
    let points = vec![(0.0, 0.0), (0.04, 0.08), (0.10, 0.05)];
    PiecewiseLinear::new(points, 0.3, -0.2).unwrap()
}

type Shift = fn([f64; 3]) -> f64;

/// Absent, affine, and curved so that u_ν - s crosses the first kink twice within an edge.
const SHIFTS: [(&str, Shift); 3] = [
    ("absent", |_| 0.0),
    ("affine", |x| 0.03 - 0.02 * x[0]),
    ("curved", |x| 0.05 * (9.0 * x[0]).sin()),
];

fn boundary(potential: Arc<dyn Potential>, shift: Shift, rule: BoundaryRule) -> Boundary {
    let (gap, shift) = (Box::new(|_: [f64; 3], _: f64| f64::INFINITY), Box::new(shift));
    Boundary { sides: Vec::new(), potential, scale: None, gap, shift, rule }
}

/// A nodal vector with u_ν = 0.16 x - 0.01 + a wave, and 0 at the clamped vertex.
fn nodal(space: &Discretization) -> Vec<f64> {
    let mut u = vec![0.0; space.nodes.len()];
    for point in space.trace.points.iter().filter(|point| !point.clamped) {
        let x = space.mesh.vertex(point.vertex)[0];
        u[point.unknown as usize] = point.sign * (0.16 * x - 0.01 + 0.02 * (5.0 * x).cos());
    }
    u
}

fn compliance<'a>(space: &Discretization, boundary: &'a Boundary) -> FacetCompliance<'a> {
    FacetCompliance::new(space, boundary, |point| point.unknown as usize).unwrap()
}

fn force(space: &Discretization, boundary: &Boundary, u: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; u.len()];
    compliance(space, boundary).add_force(u, &mut out);
    out
}

/// ∫ p(u_ν - s) φ by Simpson's rule on 2^16 intervals an edge: its error at the few intervals with a
/// kink is 2^-32 of slope 2.5 and edges 1/3, hence below 1e-9.
fn simpson(space: &Discretization, law: &dyn Potential, shift: Shift, u: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; u.len()];
    let intervals = 1 << 16;
    for f in 0..space.trace.measure.len() {
        let ends = [0, 1].map(|a| space.trace.facet(f)[a] as usize);
        let vertices = ends.map(|i| space.trace.points[i].vertex);
        for i in 0..=2 * intervals {
            let x = f64::from(i) / f64::from(2 * intervals);
            let weight = match i {
                i if i == 0 || i == 2 * intervals => 1.0,
                i if i % 2 == 1 => 4.0,
                _ => 2.0,
            };
            let weight = weight / f64::from(6 * intervals) * space.trace.measure[f];
            let shape = [1.0 - x, x];
            let normal: f64 = (0..2).map(|a| shape[a] * space.trace.normal(ends[a], u)).sum();
            let pressure =
                law.subdifferential(normal - shift(space.mesh.point(&vertices, &shape))).0;
            for a in 0..2 {
                let point = space.trace.points[ends[a]];
                if !point.clamped {
                    out[point.unknown as usize] += weight * pressure * shape[a] * point.sign;
                }
            }
        }
    }
    out
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn the_force_is_the_integral() {
    let space = space();
    let u = nodal(&space);
    for (name, shift) in SHIFTS {
        let exact = force(&space, &boundary(Arc::new(law()), shift, BoundaryRule::Exact), &u);
        let off = distance(&exact, &simpson(&space, &law(), shift, &u));
        assert!(off < 1e-9, "{name}: {off:e}");
        // The same law without cuts, and Gauss points, are off by some 1e-4.
        let gauss = force(&space, &boundary(Arc::new(law()), shift, BoundaryRule::Gauss), &u);
        assert!(distance(&exact, &gauss) > 1e-6, "{name}");
        let uncut: Arc<dyn Potential> = Arc::new(Silent { law: law(), of_kinks: true });
        let uncut = force(&space, &boundary(uncut, shift, BoundaryRule::Exact), &u);
        assert!(distance(&exact, &uncut) > 1e-6, "{name}");
    }
}

/// Curved laws on positive u_ν, where nothing but the kink of the power law limits Simpson's rule: the
/// remainder of the exact rule is rounding; without the resolution of the law it is not.
#[test]
fn curved_laws_are_integrated_to_rounding() {
    let space = space();
    let mut u = nodal(&space);
    for point in space.trace.points.iter().filter(|point| !point.clamped) {
        u[point.unknown as usize] += 0.03 * point.sign;
    }
    let zero = || PiecewiseLinear::new(vec![(0.0, 0.0)], 0.0, 0.0).unwrap();
    for (curve, allowed, unresolved) in [
        (Curve::Rational { stiffness: 2.0, length: 0.004 }, 1e-14, 1e-8),
        (Curve::Exponential { stiffness: 2.0, length: 0.002 }, 1e-14, 1e-8),
        // A jump of the second derivative in one interval of 2^-16 of an edge. The points of one piece integrate cubics.
        (Curve::Power { coefficient: 10.0, exponent: 3.0, until: 0.1 }, 1e-13, -1.0),
    ] {
        let law = || Curved::new(zero(), curve);
        let shift: Shift = |_| 0.0;
        // On the clamped vertex u_ν = 0, where the laws begin.
        let expected = simpson(&space, &law(), shift, &u);
        let exact = force(&space, &boundary(Arc::new(law()), shift, BoundaryRule::Exact), &u);
        let off = distance(&exact, &expected);
        assert!(off < allowed, "{curve:?}: {off:e}");
        let coarse: Arc<dyn Potential> = Arc::new(Silent { law: law(), of_kinks: false });
        let coarse = force(&space, &boundary(coarse, shift, BoundaryRule::Exact), &u);
        assert!(distance(&coarse, &expected) > unresolved, "{curve:?}");
    }
}

/// A factor c(x) in every rule on facets, and its tangent.
#[test]
fn a_factor_multiplies_the_law_at_every_point() {
    let space = space();
    let u = nodal(&space);
    for rule in [BoundaryRule::Exact, BoundaryRule::Gauss] {
        let with = |scale: Option<Shift>| {
            let plain = boundary(Arc::new(law()), |_| 0.0, rule);
            Boundary {
                scale: scale.map(|scale| Box::new(scale) as crate::contact::OnContact),
                ..plain
            }
        };
        let [plain, double, affine, whole] = [
            None,
            Some((|_| 2.0) as Shift),
            Some(|x: [f64; 3]| x[0]),
            Some(|x: [f64; 3]| 1.0 - x[0]),
        ]
        .map(|scale| force(&space, &with(scale), &u));
        let doubled: Vec<f64> = plain.iter().map(|f| 2.0 * f).collect();
        assert!(distance(&double, &doubled) < 1e-15);
        // x and 1 - x add up to one; both are there.
        let sum: Vec<f64> = affine.iter().zip(&whole).map(|(a, b)| a + b).collect();
        assert!(distance(&sum, &plain) < 1e-15 && distance(&affine, &whole) > 1e-4);
        let descent = compliance(&space, &with(Some(|_| 2.0))).descent();
        // Twice the steepest descent ½, a quotient of the points.
        assert!((descent - 1.0).abs() < 1e-14);
    }
}

/// The seeded defects: a curved law that passes for a piecewise linear one, and a law that does not name its kinks, so that
/// no edge is cut.
struct Silent<P> {
    law: P,
    of_kinks: bool,
}

impl<P: Potential> Potential for Silent<P> {
    fn subdifferential(&self, r: f64) -> (f64, f64) {
        self.law.subdifferential(r)
    }
    fn value_and_slope(&self, r: f64) -> (f64, f64) {
        self.law.value_and_slope(r)
    }
    fn jumps(&self) -> &[f64] {
        if self.of_kinks { &[] } else { self.law.jumps() }
    }
    fn kinks(&self) -> &[f64] {
        if self.of_kinks { &[] } else { self.law.kinks() }
    }
    fn alpha(&self) -> f64 {
        self.law.alpha()
    }
    fn growth(&self) -> (f64, f64) {
        self.law.growth()
    }
}

#[test]
fn affine_laws_agree_with_gauss_points() {
    let space = space();
    let u = nodal(&space);
    let affine = || Arc::new(PiecewiseLinear::new(vec![(0.0, 0.1)], 1.7, 1.7).unwrap());
    for (name, shift) in &SHIFTS[..2] {
        let [a, b] = [BoundaryRule::Exact, BoundaryRule::Gauss]
            .map(|rule| force(&space, &boundary(affine(), *shift, rule), &u));
        let size = a.iter().fold(0.0f64, |size, f| size.max(f.abs()));
        // Both integrate quadratics exactly: fourteen digits.
        assert!(distance(&a, &b) < 1e-14 * size, "{name}: {:e}", distance(&a, &b));
    }
}

#[test]
fn the_tangent_is_the_derivative() {
    let space = space();
    let u = nodal(&space);
    let step = 1e-6;
    for (name, shift) in SHIFTS {
        let boundary = boundary(Arc::new(law()), shift, BoundaryRule::Exact);
        let mut tangent = vec![0.0; space.pattern.entries()];
        let add = |at, value| space.pattern.add(at, value, &mut tangent);
        compliance(&space, &boundary).each_tangent(&u, add);
        let mut d = vec![0.0; u.len()];
        for (i, point) in space.trace.points.iter().enumerate().filter(|(_, p)| !p.clamped) {
            d[point.unknown as usize] = point.sign * (1.0 + 0.5 * (i as f64).sin());
        }
        let moved = |sign: f64| -> Vec<f64> {
            let u: Vec<f64> = u.iter().zip(&d).map(|(u, d)| u + sign * step * d).collect();
            force(&space, &boundary, &u)
        };
        let (plus, minus) = (moved(1.0), moved(-1.0));
        let mut product = vec![0.0; space.dofs()];
        space.pattern.multiply(&tangent, &d[..space.dofs()], &mut product);
        for (i, value) in product.iter().enumerate() {
            let difference = (plus[i] - minus[i]) / (2.0 * step);
            // The force is piecewise cubic in the step: truncation s² times slopes over u_ν' is
            // 1e-11, rounding 1e-17/s = 1e-11.
            assert!((difference - value).abs() < 1e-9, "{name} {i}: {difference} {value}");
        }
    }
}
