//! The regularity that (5.26) asks for, measured by differences under refinement: a difference
//! quotient that settles belongs to a bounded derivative, one that grows does not.

use super::{Finding, SideOfRectangle, Status, times};
use crate::formula::{Point, Program};
use crate::manufactured::Exact;

/// Fine intervals along a line; quotients are taken over 8, 4, 2 and 1 of them.
const FINE: usize = 768;
const STRIDES: [usize; 4] = [8, 4, 2, 1];
/// Lines across the direction of differences.
const LINES: usize = 12;
/// Points across the direction in which zones move, for the derivatives in time.
const ACROSS_ZONES: usize = 96;
/// A quotient that grows by more than this at the last halving is unbounded: a jump gives √2 in
/// L² and 2 in L∞, a bounded derivative a factor near 1.
const GROWS: f64 = 1.2;
/// Rounding of a difference, in units of ε·max|f|: 4 for the weights 1, 2, 1 of a second difference,
/// 2 for the Frobenius norm over ε_xx, ε_xy twice, ε_yy, and 8 for the formula behind each sample,
/// whose operations cost half a unit each. Measured on fields linear in t: 0.1 to 2.
const ROUNDING_UNITS: f64 = 64.0;

pub(super) fn regularity(exact: &Exact, sides: &[SideOfRectangle]) -> Vec<Finding> {
    let mut findings = time_derivatives(exact).to_vec();
    findings.push(space_derivative(exact, Field::Strain, "u in H2(Omega) (5.25)"));
    findings.push(space_derivative(exact, Field::Stress, "sigma in H1(Omega) (5.18)"));
    if exact.data.contact.is_some() {
        for side in sides.iter().filter(|side| side.contact) {
            findings.push(normal_trace(exact, side));
        }
    }
    if exact.data.kernel.is_some() {
        findings.push(kernel(exact));
    }
    findings
}

/// What rounding of samples of size at most `largest` leaves in a quotient with the divisor δ or δ²,
/// whose norm gives the constant 1 the value `one`.
fn rounding(largest: f64, one: f64, divisor: f64) -> f64 {
    ROUNDING_UNITS * f64::EPSILON * largest * one / divisor
}

/// Reads quotients over ever finer strides. The last one may hold `rounding`, which grows as the
/// stride falls and says nothing about the field.
fn judge(subject: &str, what: &str, quotients: &[f64], rounding: f64) -> Finding {
    let last = quotients[quotients.len() - 1];
    let before = quotients[quotients.len() - 2];
    // Written so that a NaN is not bounded.
    let bounded = last.is_finite() && last <= GROWS * before + rounding;
    let text = if bounded && last <= rounding {
        format!("{what} is zero to rounding: {last:.1e}, rounding is below {rounding:.1e}")
    } else if bounded {
        format!("{what} settles at {last:.3e}")
    } else {
        format!("{what} grows by {:.2} a halving: not bounded", last / before)
    };
    let status = if bounded { Status::Verified } else { Status::Weak };
    Finding::new(subject, status, last, text)
}

/// The maximum of magnitudes; a NaN counts as infinite.
fn worst(known: f64, value: f64) -> f64 {
    if value.is_nan() { f64::INFINITY } else { known.max(value.abs()) }
}

fn largest<'a>(values: impl IntoIterator<Item = &'a f64>) -> f64 {
    values.into_iter().fold(0.0, |known, value| worst(known, *value))
}

/// sup_t ‖ε(u(t+δ) - 2u(t) + u(t-δ))‖/δ², and the norm in L²(Ω) of the pointwise variation
/// Σ |ε(u(t+δ) - 2u(t) + u(t-δ))|/δ, which is what order 2 of the trapezoidal rule needs.
fn time_derivatives(exact: &Exact) -> [Finding; 2] {
    let points = grid(exact, ACROSS_ZONES, LINES / 2);
    let area = cell_area(exact, points.len());
    let mut bound = exact.interior.bind(&points);
    let mut out = vec![Vec::new(); 5 + exact.memory.len()];
    let count = FINE / 3;
    let step = exact.data.horizon / count as f64;
    let history: Vec<Vec<f64>> = (0..=count)
        .map(|n| {
            bound.evaluate(step * n as f64, 0.0, &mut out);
            out[2..5].concat()
        })
        .collect();
    let (mut second, mut variation) = ([0.0f64; 4], [0.0f64; 4]);
    for (level, stride) in STRIDES.into_iter().enumerate() {
        let delta = step * stride as f64;
        let mut bends = vec![0.0; points.len()];
        for n in (stride..=count - stride).step_by(stride) {
            let [a, b, c] = [n - stride, n, n + stride].map(|i| &history[i]);
            let mut sum = 0.0;
            for (p, bend) in bends.iter_mut().enumerate() {
                let component = |i: usize| {
                    let at = i * points.len() + p;
                    a[at] - 2.0 * b[at] + c[at]
                };
                // Shear counts twice in the Frobenius norm.
                let square =
                    component(0).powi(2) + 2.0 * component(1).powi(2) + component(2).powi(2);
                sum += area * square;
                *bend += square.sqrt() / delta;
            }
            second[level] = worst(second[level], sum.sqrt() / delta.powi(2));
        }
        variation[level] = bends.iter().map(|bend| area * bend * bend).sum::<f64>().sqrt();
    }
    let what = "sup_t |eps(second time difference)|";
    let pointwise = "the pointwise variation of eps(u')";
    let one = (area * points.len() as f64).sqrt();
    let size = largest(history.iter().flatten());
    let second_rounding = rounding(size, one, step.powi(2));
    // One such difference, over δ instead of δ², at each of T/δ times.
    let variation_rounding = second_rounding * exact.data.horizon;
    [
        judge("u in W2,inf(0,T;V) (5.15)", what, &second, second_rounding),
        judge("eps(u') in L2(Omega;BV)", pointwise, &variation, variation_rounding),
    ]
}

#[derive(Clone, Copy)]
enum Field {
    Strain,
    Stress,
}

/// ‖f(· + δe) - f‖/δ in L², in both directions, at three times.
fn space_derivative(exact: &Exact, field: Field, subject: &str) -> Finding {
    let (mut quotients, mut floor) = ([0.0f64; 4], 0.0);
    for t in times(exact) {
        for direction in 0..2 {
            let counts = if direction == 0 { [FINE, LINES] } else { [LINES, FINE] };
            let points = grid(exact, counts[0], counts[1]);
            let values = field_values(exact, field, &points, t);
            let at = |along: usize, across: usize| {
                if direction == 0 { along * counts[1] + across } else { across * counts[1] + along }
            };
            let area = cell_area(exact, points.len());
            let step = exact.data.size[direction] / FINE as f64;
            let one = (area * points.len() as f64).sqrt();
            floor = worst(floor, rounding(largest(values.iter().flatten()), one, step));
            for (quotient, stride) in quotients.iter_mut().zip(STRIDES) {
                let delta = step * stride as f64;
                let mut sum = 0.0;
                for component in &values {
                    for along in 0..FINE - stride {
                        for across in 0..LINES {
                            let difference = component[at(along + stride, across)]
                                - component[at(along, across)];
                            sum += area * (difference / delta).powi(2);
                        }
                    }
                }
                *quotient = worst(*quotient, sum.sqrt());
            }
        }
    }
    judge(subject, "the difference quotient in L2", &quotients, floor)
}

fn field_values(exact: &Exact, field: Field, points: &[[f64; 3]], t: f64) -> Vec<Vec<f64>> {
    let mut graph = exact.data.graph.clone();
    let nodes = match field {
        Field::Strain => &exact.strain,
        Field::Stress => &exact.stress,
    };
    let zeta = match field {
        Field::Strain => 0.0,
        Field::Stress => exact.zeta.at(t),
    };
    let mut out = vec![Vec::new(); nodes.len()];
    Program::compile(&mut graph, nodes, exact.data.horizon)
        .bind(points)
        .evaluate(t, zeta, &mut out);
    out
}

/// ‖second difference of u_ν along Γ3‖/δ² in L².
fn normal_trace(exact: &Exact, side: &SideOfRectangle) -> Finding {
    let formulas = exact.boundary(&side.normal);
    let size = exact.data.size;
    let points: Vec<[f64; 3]> =
        (0..=FINE).map(|i| side.point(size, i as f64 / FINE as f64)).collect();
    let mut bound = formulas.program.bind(&points);
    let mut out = vec![Vec::new(); 5];
    let (mut quotients, mut floor) = ([0.0f64; 4], 0.0);
    let step = side.length(size) / FINE as f64;
    for t in times(exact) {
        bound.evaluate(t, 0.0, &mut out);
        let u_nu = &out[0];
        floor = worst(floor, rounding(largest(u_nu), side.length(size).sqrt(), step.powi(2)));
        for (quotient, stride) in quotients.iter_mut().zip(STRIDES) {
            let delta = step * stride as f64;
            let second =
                |i: usize| (u_nu[i - stride] - 2.0 * u_nu[i] + u_nu[i + stride]) / delta.powi(2);
            let sum: f64 = (stride..=FINE - stride).map(|i| second(i).powi(2)).sum();
            *quotient = worst(*quotient, (step * sum).sqrt());
        }
    }
    judge("u_nu in H2(Gamma3) (5.25)", "the second difference quotient in L2", &quotients, floor)
}

/// max |b''| by second differences.
fn kernel(exact: &Exact) -> Finding {
    let Some(node) = exact.data.kernel else {
        return Finding::new("B in C2", Status::Fact, 0.0, "no memory".into());
    };
    let step = exact.data.horizon / FINE as f64;
    let values: Vec<f64> = (0..=FINE)
        .map(|n| exact.data.graph.evaluate(node, &Point { t: step * n as f64, ..Point::default() }))
        .collect();
    let quotients = STRIDES.map(|stride| {
        let delta = step * stride as f64;
        let second =
            |i: usize| (values[i - stride] - 2.0 * values[i] + values[i + stride]) / delta.powi(2);
        (stride..=FINE - stride).map(|i| second(i).abs()).fold(0.0, worst)
    });
    let floor = rounding(largest(&values), 1.0, step.powi(2));
    judge("B in C2[0,T]", "the second difference quotient of the kernel", &quotients, floor)
}

/// Midpoints of nx × ny equal cells of the rectangle.
fn grid(exact: &Exact, nx: usize, ny: usize) -> Vec<[f64; 3]> {
    let [width, height] = exact.data.size;
    let middle = |i: usize, n: usize| (i as f64 + 0.5) / n as f64;
    (0..nx)
        .flat_map(|i| (0..ny).map(move |j| [width * middle(i, nx), height * middle(j, ny), 0.0]))
        .collect()
}

fn cell_area(exact: &Exact, cells: usize) -> f64 {
    exact.data.size[0] * exact.data.size[1] / cells as f64
}

#[cfg(test)]
mod tests;
