//! Vectors of space.

pub(crate) fn minus(p: [f64; 3], q: [f64; 3]) -> [f64; 3] {
    [p[0] - q[0], p[1] - q[1], p[2] - q[2]]
}

pub(super) fn dot(p: [f64; 3], q: [f64; 3]) -> f64 {
    p.iter().zip(q).map(|(p, q)| p * q).sum()
}

pub(super) fn cross(p: [f64; 3], q: [f64; 3]) -> [f64; 3] {
    [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]]
}

pub(crate) fn norm(p: [f64; 3]) -> f64 {
    dot(p, p).sqrt()
}

pub(super) fn longest_edge(corners: &[[f64; 3]]) -> f64 {
    let pairs = (0..corners.len()).flat_map(|a| (0..a).map(move |b| (a, b)));
    pairs.map(|(a, b)| norm(minus(corners[a], corners[b]))).fold(0.0, f64::max)
}

/// Length of an edge or area of a triangle of these corners.
pub(super) fn extent(corners: &[[f64; 3]]) -> f64 {
    let edge = |a: usize| minus(corners[a], corners[0]);
    match corners.len() {
        2 => norm(edge(1)),
        _ => 0.5 * norm(cross(edge(1), edge(2))),
    }
}
