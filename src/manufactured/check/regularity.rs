//! The regularity that (5.26) asks for, measured by differences under refinement: a difference
//! quotient that settles belongs to a bounded derivative, one that grows does not.

use super::smoothness::{FINE, STRIDES, judge, largest, rounding, second_difference, worst};
use super::{Finding, SideOfRectangle, polygon, times};
use crate::formula::{Point, Program};
use crate::manufactured::Exact;

/// Lines across the direction of differences in time.
const LINES: usize = 12;
/// Lines across the direction of differences in space, and the power by which they gather at the
/// sides: singularities sit at corners and sides, and the nearest lines are 1e-5 away from these.
const GRADED_LINES: usize = 16;
const GRADING: i32 = 5;
/// Points across the direction in which zones move, for the derivatives in time.
const ACROSS_ZONES: usize = 96;

pub(super) fn regularity(exact: &Exact, sides: &[SideOfRectangle]) -> Vec<Finding> {
    let mut findings = time_derivatives(exact).to_vec();
    let [in_space, normal] = space_findings(exact, sides);
    findings.extend(in_space);
    let subject = in_body(exact, "sigma in H1", "(5.18)");
    findings.push(space_derivative(exact, Field::Stress, &subject));
    findings.extend(normal);
    findings.extend(kernels(exact));
    findings
}

/// What Theorem 7 asks for: (5.15), and ℬ in C².
pub fn regularity_in_time(exact: &Exact) -> Vec<Finding> {
    let [second, _] = time_derivatives(exact);
    let mut findings = vec![second];
    findings.extend(kernels(exact));
    findings
}

/// What (5.25) asks for.
pub fn regularity_in_space(exact: &Exact, sides: &[SideOfRectangle]) -> Vec<Finding> {
    space_findings(exact, sides).concat()
}

fn space_findings(exact: &Exact, sides: &[SideOfRectangle]) -> [Vec<Finding>; 2] {
    let traces = match (&exact.data.contact, &exact.data.polygon) {
        (None, _) => Vec::new(),
        (_, Some(polygon)) => polygon::normal_traces(exact, polygon),
        _ => {
            let contact = sides.iter().filter(|side| side.contact);
            contact.map(|side| normal_trace(exact, side)).collect()
        }
    };
    let subject = in_body(exact, "u in H2", "(5.25)");
    [vec![space_derivative(exact, Field::Strain, &subject)], traces]
}

/// `what`(Omega), or on each region.
fn in_body(exact: &Exact, what: &str, equation: &str) -> String {
    match exact.data.regions.is_empty() {
        true => format!("{what}(Omega) {equation}"),
        false => format!("{what} by region {equation}"),
    }
}

/// sup_t ‖ε(u(t+δ) - 2u(t) + u(t-δ))‖/δ², and the norm in L²(Ω) of the pointwise variation
/// Σ |ε(u(t+δ) - 2u(t) + u(t-δ))|/δ, which is what order 2 of the trapezoidal rule needs.
fn time_derivatives(exact: &Exact) -> [Finding; 2] {
    let (points, areas) = match &exact.data.polygon {
        Some(polygon) => polygon::in_time(polygon),
        None => {
            let points = grid(exact, ACROSS_ZONES, LINES / 2);
            let area = cell_area(exact, points.len());
            let count = points.len();
            (points, vec![area; count])
        }
    };
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
                sum += areas[p] * square;
                *bend += square.sqrt() / delta;
            }
            second[level] = worst(second[level], sum.sqrt() / delta.powi(2));
        }
        let squares = bends.iter().zip(&areas).map(|(bend, area)| area * bend * bend);
        variation[level] = squares.sum::<f64>().sqrt();
    }
    let (size, one) = (largest(history.iter().flatten()), exact.data.measure().sqrt());
    let second_rounding = rounding(size, one, step.powi(2));
    let variation_rounding = rounding(size, one * count as f64, step);
    let what = "sup_t |eps(second time difference)|";
    let pointwise = "the pointwise variation of eps(u')";
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
    if let Some(polygon) = &exact.data.polygon {
        let values = |points: &[[f64; 3]], t: f64| field_values(exact, field, points, t);
        return polygon::space_derivative(exact, polygon, values, subject);
    }
    let (mut quotients, mut size) = ([0.0f64; 4], 0.0f64);
    for t in times(exact) {
        for direction in 0..2 {
            let (points, weights) = gathered(exact, direction);
            let values = field_values(exact, field, &points, t);
            let regions = exact.regions_at(&points);
            for (quotient, stride) in quotients.iter_mut().zip(STRIDES) {
                let delta = exact.data.size[direction] * stride as f64 / FINE as f64;
                let mut sum = 0.0;
                for component in &values {
                    size = worst(size, largest(component));
                    let lines = component.chunks(FINE).zip(regions.chunks(FINE));
                    for ((line, own), weight) in lines.zip(&weights) {
                        // Strains jump where the material does: what is asked is H² on each region.
                        let pairs = (0..FINE - stride).filter(|&i| own[i] == own[i + stride]);
                        let squares = pairs.map(|i| ((line[i + stride] - line[i]) / delta).powi(2));
                        sum += weight * squares.sum::<f64>();
                    }
                }
                *quotient = worst(*quotient, sum.sqrt());
            }
        }
    }
    let [width, height] = exact.data.size;
    let floor = rounding(size, (width * height).sqrt(), width.min(height) / FINE as f64);
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
    let size = exact.data.size;
    let program = exact.boundary(&side.normal).program;
    normal_trace_along(exact, &program, side.length(size), |s| side.point(size, s))
}

/// The same along a straight line of the given length, whose points `at` gives by their fraction of it.
pub(super) fn normal_trace_along(
    exact: &Exact,
    program: &Program,
    length: f64,
    at: impl Fn(f64) -> [f64; 3],
) -> Finding {
    let points: Vec<[f64; 3]> = (0..=FINE).map(|i| at(i as f64 / FINE as f64)).collect();
    let mut bound = program.bind(&points);
    let mut out = vec![Vec::new(); 5];
    let (mut quotients, mut extent) = ([0.0f64; 4], 0.0f64);
    for t in times(exact) {
        bound.evaluate(t, 0.0, &mut out);
        let u_nu = &out[0];
        extent = worst(extent, largest(u_nu));
        for (quotient, stride) in quotients.iter_mut().zip(STRIDES) {
            let delta = length * stride as f64 / FINE as f64;
            let second =
                |i: usize| (u_nu[i - stride] - 2.0 * u_nu[i] + u_nu[i + stride]) / delta.powi(2);
            let sum: f64 = (stride..=FINE - stride).map(|i| second(i).powi(2)).sum();
            let mean = length / FINE as f64;
            *quotient = worst(*quotient, (mean * sum).sqrt());
        }
    }
    let floor = rounding(extent, length.sqrt(), (length / FINE as f64).powi(2));
    judge("u_nu in H2(Gamma3) (5.25)", "the second difference quotient in L2", &quotients, floor)
}

/// max |b''| by second differences, of each term of the memory.
fn kernels(exact: &Exact) -> impl Iterator<Item = Finding> {
    exact.data.kernels.iter().map(|&node| {
        let value = |t: f64| exact.data.graph.evaluate(node, &Point { t, ..Point::default() });
        second_difference("B in C2[0,T]", "the kernel", exact.data.horizon, value)
    })
}

/// Points along lines in a direction, [`FINE`] midpoints a line, and the area that stands for each
/// point of a line; the lines gather at the sides.
fn gathered(exact: &Exact, direction: usize) -> (Vec<[f64; 3]>, Vec<f64>) {
    let size = exact.data.size;
    let place = |i: usize| {
        let x = 2.0 * i as f64 / GRADED_LINES as f64;
        let half = |x: f64| 0.5 * x.powi(GRADING);
        if x <= 1.0 { half(x) } else { 1.0 - half(2.0 - x) }
    };
    let (mut points, mut weights) = (Vec::new(), Vec::new());
    for line in 0..GRADED_LINES {
        let (from, to) = (place(line), place(line + 1));
        weights.push((to - from) * size[0] * size[1] / FINE as f64);
        points.extend((0..FINE).map(|i| {
            let along = size[direction] * (i as f64 + 0.5) / FINE as f64;
            let across = size[1 - direction] * 0.5 * (from + to);
            if direction == 0 { [along, across, 0.0] } else { [across, along, 0.0] }
        }));
    }
    (points, weights)
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
