//! Vectors of space.

pub(super) fn minus(p: [f64; 3], q: [f64; 3]) -> [f64; 3] {
    [p[0] - q[0], p[1] - q[1], p[2] - q[2]]
}

pub(super) fn dot(p: [f64; 3], q: [f64; 3]) -> f64 {
    p.iter().zip(q).map(|(p, q)| p * q).sum()
}

pub(super) fn cross(p: [f64; 3], q: [f64; 3]) -> [f64; 3] {
    [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]]
}

pub(super) fn norm(p: [f64; 3]) -> f64 {
    dot(p, p).sqrt()
}

/// Length of an edge or area of a triangle of these corners.
pub(super) fn extent(corners: &[[f64; 3]]) -> f64 {
    let edge = |a: usize| minus(corners[a], corners[0]);
    match corners.len() {
        2 => norm(edge(1)),
        _ => 0.5 * norm(cross(edge(1), edge(2))),
    }
}
