//! Roots of an analytic function in a strip, counted by the argument principle and closed in by bisection.

use nalgebra::Complex;

/// Rectangles with one root are handed to Newton's method at this size, those with several at the next: these
/// hold a multiple root.
const SMALL: f64 = 2e-2;
const TINY: f64 = 1e-5;
/// A side of a rectangle is divided until the argument turns by less than this between neighbours.
const TURN: f64 = 0.7;
/// Divisions of a side.
const DEEPEST: u32 = 24;
/// Below the real axis, so that real roots lie inside: no simple fraction of anything.
const BELOW: f64 = 0.061_803_398_874_989_5;
/// Imaginary parts below this are rounding: a real root.
const REAL: f64 = 1e-7;

type Function<'a> = &'a dyn Fn(Complex<f64>) -> Complex<f64>;

/// The roots with real part in `strip` and imaginary part in [0, `top`], each once; f(s̄) is the conjugate of f(s).
pub(super) fn roots_in(strip: [f64; 2], top: f64, f: Function<'_>) -> Vec<Complex<f64>> {
    let mut found = Vec::new();
    close_in([strip[0], strip[1], -BELOW, top], f, &mut found);
    let mut roots: Vec<Complex<f64>> = Vec::new();
    for mut root in found {
        if root.im.abs() < REAL {
            root.im = 0.0;
        }
        root.im = root.im.abs();
        let inside = root.re > strip[0] && root.re < strip[1];
        if inside && roots.iter().all(|known| (known - root).norm() > 10.0 * REAL) {
            roots.push(root);
        }
    }
    roots
}

/// Adds the roots in [x0, x1] + i [y0, y1].
fn close_in([x0, x1, y0, y1]: [f64; 4], f: Function<'_>, found: &mut Vec<Complex<f64>>) {
    let count = winding([x0, x1, y0, y1], f);
    if count == 0 {
        return;
    }
    let (width, height) = (x1 - x0, y1 - y0);
    if width.max(height) < if count == 1 { SMALL } else { TINY } {
        let middle = Complex::new(0.5 * (x0 + x1), 0.5 * (y0 + y1));
        found.extend(newton(middle, count, f));
        return;
    }
    // Off the middle, so that no division runs through the roots of symmetric wedges.
    let cut = 0.481_966_011_250_105;
    let (x, y) = (x0 + cut * width, y0 + cut * height);
    let halves = match width > height {
        true => [[x0, x, y0, y1], [x, x1, y0, y1]],
        false => [[x0, x1, y0, y], [x0, x1, y, y1]],
    };
    for half in halves {
        close_in(half, f, found);
    }
}

/// The number of roots inside, with multiplicity: how often f turns around 0 along the boundary.
fn winding([x0, x1, y0, y1]: [f64; 4], f: Function<'_>) -> i64 {
    let corners = [[x0, y0], [x1, y0], [x1, y1], [x0, y1], [x0, y0]];
    let corners = corners.map(|[x, y]| Complex::new(x, y));
    let values = corners.map(f);
    let turn: f64 = (0..4)
        .map(|i| turned([corners[i], corners[i + 1]], [values[i], values[i + 1]], f, 0))
        .sum();
    (turn / std::f64::consts::TAU).round() as i64
}

/// By how much the argument of f turns from one end of a line to the other.
fn turned(ends: [Complex<f64>; 2], values: [Complex<f64>; 2], f: Function<'_>, depth: u32) -> f64 {
    let direct = (values[1] / values[0]).arg();
    let middle = (ends[0] + ends[1]) * 0.5;
    let value = f(middle);
    let [first, second] = [(value / values[0]).arg(), (values[1] / value).arg()];
    let settled = first.abs().max(second.abs()) < TURN && (first + second - direct).abs() < 1e-6;
    if depth >= DEEPEST || (settled && depth >= 3) {
        return first + second;
    }
    turned([ends[0], middle], [values[0], value], f, depth + 1)
        + turned([middle, ends[1]], [value, values[1]], f, depth + 1)
}

/// Newton's method for a root of the given multiplicity, with a central difference for f'.
fn newton(start: Complex<f64>, multiplicity: i64, f: Function<'_>) -> Option<Complex<f64>> {
    let (mut s, step) = (start, Complex::new(1e-6, 0.0));
    for _ in 0..60 {
        let slope = (f(s + step) - f(s - step)) / (step * 2.0);
        let change = f(s) / slope * multiplicity as f64;
        if !change.norm().is_finite() {
            return (change.norm().is_nan() && f(s).norm() == 0.0).then_some(s);
        }
        s -= change;
        if change.norm() < 1e-13 {
            break;
        }
    }
    ((s - start).norm() < 2.0 * SMALL).then_some(s)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_of_a_polynomial_are_found_once() {
        // (s - 0.3)(s - 0.7)²((s - 0.5)² + 0.04): real, double, and a pair.
        let f = |s: Complex<f64>| {
            let at = |x: f64| s - Complex::new(x, 0.0);
            at(0.3) * at(0.7) * at(0.7) * (at(0.5) * at(0.5) + Complex::new(0.04, 0.0))
        };
        let mut roots = roots_in([0.02, 0.999], 3.0, &f);
        roots.sort_by(|a, b| a.re.total_cmp(&b.re));
        assert_eq!(roots.len(), 3, "{roots:?}");
        for (found, expected) in roots.iter().zip([[0.3, 0.0], [0.5, 0.2], [0.7, 0.0]]) {
            assert!((found - Complex::new(expected[0], expected[1])).norm() < 1e-6, "{found}");
        }
        // Nothing inside: nothing found.
        assert!(roots_in([0.02, 0.25], 3.0, &f).is_empty());
    }
}
