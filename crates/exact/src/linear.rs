//! Gradients of linear functions on a simplex from edges, independent of the solver's shape gradients.

use fem::mesh::Mesh;

/// ∇f of a linear function from its increments along the edges that leave one corner of a simplex.
pub fn gradient_of<const D: usize>(edges: &[[f64; D]; D], rise: &[f64; D]) -> [f64; D] {
    if D == 2 {
        let (p, q) = (edges[0], edges[1]);
        let determinant = p[0] * q[1] - p[1] * q[0];
        let (a, b) = (rise[0], rise[1]);
        let gradient = [(a * q[1] - b * p[1]) / determinant, (b * p[0] - a * q[0]) / determinant];
        return std::array::from_fn(|i| gradient[i]);
    }
    // By Cramer's rule the gradient is Σ rise_a e_b × e_c / det, (a, b, c) in cyclic order.
    let cross = |a: usize, i: usize| {
        let (e, f) = (edges[(a + 1) % 3], edges[(a + 2) % 3]);
        e[(i + 1) % 3] * f[(i + 2) % 3] - e[(i + 2) % 3] * f[(i + 1) % 3]
    };
    let determinant: f64 = (0..D).map(|i| edges[0][i] * cross(0, i)).sum();
    std::array::from_fn(|i| (0..D).map(|a| rise[a] * cross(a, i)).sum::<f64>() / determinant)
}

/// For each cell the gradients of linear functions that rise by one along one of the edges from its first corner.
pub(crate) fn edge_slopes<const D: usize>(mesh: &Mesh) -> Vec<f64> {
    let mut all = Vec::with_capacity(D * D * mesh.cell_count());
    for c in 0..mesh.cell_count() {
        let cell = mesh.cell(c);
        let from = mesh.vertex(cell[0]);
        let edges: [[f64; D]; D] = std::array::from_fn(|a| {
            let to = mesh.vertex(cell[a + 1]);
            std::array::from_fn(|i| to[i] - from[i])
        });
        for a in 0..D {
            let rise = std::array::from_fn(|b| f64::from(u8::from(a == b)));
            all.extend(gradient_of(&edges, &rise));
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gradients_give_back_the_rises() {
        let edges = [[1.0, 0.2, -0.3], [0.1, 0.8, 0.4], [-0.2, 0.3, 0.9]];
        let slope = [2.0, -1.0, 0.5];
        let rise = edges.map(|e| (0..3).map(|i| e[i] * slope[i]).sum());
        let found = gradient_of(&edges, &rise);
        assert!((0..3).all(|i| (found[i] - slope[i]).abs() < 1e-15), "{found:?}");
        let found = gradient_of(&[[1.0, 0.2], [0.1, 0.8]], &[1.8, -0.6]);
        assert!((found[0] - 2.0).abs() < 1e-15 && (found[1] + 1.0).abs() < 1e-15, "{found:?}");
    }
}
