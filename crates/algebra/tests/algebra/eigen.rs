use gronwall_algebra::linalg::*;
use nalgebra::DMatrix;

struct Dense {
    map: DMatrix<f64>,
    weights: Vec<f64>,
}

impl LinearMap for Dense {
    fn apply(&mut self, x: &[f64], out: &mut [f64]) -> Result<(), FactorError> {
        for (i, value) in out.iter_mut().enumerate() {
            *value = self.map.row(i).iter().zip(x).map(|(a, x)| a * x).sum();
        }
        Ok(())
    }
    fn gram(&mut self, x: &[f64], out: &mut [f64]) {
        for ((value, x), w) in out.iter_mut().zip(x).zip(&self.weights) {
            *value = w * x;
        }
    }
}

/// T = G⁻¹S with S the second difference matrix: self-adjoint in G = 2I, eigenvalues 1 - cos(jπ/(m+1)), crowded at
/// the top.
fn second_differences(m: usize) -> Dense {
    let map = DMatrix::from_fn(m, m, |i, j| match i.abs_diff(j) {
        0 => 1.0,
        1 => -0.5,
        _ => 0.0,
    });
    Dense { map, weights: vec![2.0; m] }
}

fn start(m: usize) -> Vec<f64> {
    let mut seed = 3;
    (0..m).map(|_| gronwall_algebra::linalg::signed_unit(&mut seed)).collect()
}

#[test]
fn a_crowded_spectrum_is_resolved() {
    for m in [8, 200] {
        let found = largest_eigenvalue(&mut second_differences(m), &start(m)).unwrap();
        let exact = 1.0 - (m as f64 * std::f64::consts::PI / (m as f64 + 1.0)).cos();
        assert!((found.value - exact).abs() < 1e-12, "{} {exact}", found.value);
        let mut out = vec![0.0; m];
        second_differences(m).apply(&found.vector, &mut out).unwrap();
        let off = out.iter().zip(&found.vector).map(|(y, x)| (y - exact * x).abs());
        assert!(off.fold(0.0, f64::max) < 1e-5);
    }
}

/// Maps and inner products of the size of any unit.
#[test]
fn units_do_not_matter() {
    for (scale, weight) in [(1e-150, 1e100), (1e150, 1e-100)] {
        for m in [8, 200] {
            let mut plain = second_differences(m);
            let wanted = largest_eigenvalue(&mut plain, &start(m)).unwrap().value;
            plain.map *= scale;
            plain.weights.fill(weight);
            let turned: Vec<f64> = start(m).iter().map(|x| x * scale).collect();
            let found = largest_eigenvalue(&mut plain, &turned).unwrap();
            assert!((found.value / scale - wanted).abs() < 1e-12, "{}", found.value);
            let outer = spectrum(&mut plain, &turned).unwrap();
            assert!((outer.radius / scale - wanted).abs() < 1e-9, "{outer:?}");
        }
    }
}

#[test]
fn multiples_of_the_identity_and_zero_end_at_once() {
    for (factor, m) in [(0.0, 5), (0.25, 5), (0.0, 200), (0.3, 200)] {
        let map = DMatrix::from_diagonal_element(m, m, factor);
        let weights = (0..m).map(|i| 1.0 + i as f64).collect();
        let mut dense = Dense { map, weights };
        let found = largest_eigenvalue(&mut dense, &start(m)).unwrap();
        assert!((found.value - factor).abs() < 1e-15 && found.iterations <= 2);
        let outer = spectrum(&mut dense, &start(m)).unwrap();
        assert!((outer.radius - factor).abs() < 1e-15, "{outer:?}");
        assert!((outer.rightmost - factor).abs() < 1e-15, "{outer:?}");
    }
}

/// Blocks of one map on 4 or 400 numbers: a rotation scaled by ½ and a nilpotent part. The radius is ½, whatever the
/// norm.
#[test]
fn the_radius_is_not_the_norm() {
    let block = DMatrix::from_row_slice(
        4,
        4,
        &[0., -0.5, 0., 9., 0.5, 0., 0., 0., 0., 0., 0.1, 7., 0., 0., 0., 0.1],
    );
    for blocks in [1, 50] {
        let m = 4 * blocks;
        let map = DMatrix::from_fn(m, m, |i, j| match i / 4 == j / 4 {
            true => block[(i % 4, j % 4)] / (1 + i / 4) as f64,
            false => 0.0,
        });
        let mut dense = Dense { map, weights: vec![1.0; m] };
        let found = spectrum(&mut dense, &start(m)).unwrap();
        // Eigenvalues ±i/2 and 0.1 twice in a Jordan block, which halves the digits; and those over 2, 3, ….
        assert!((found.radius - 0.5).abs() < 1e-8, "{found:?}");
        assert!((found.rightmost - 0.1).abs() < 1e-5, "{found:?}");
    }
}

/// A map that is exactly zero on all coordinates but a few, which the basis spans soon.
#[test]
fn a_map_of_low_rank_ends() {
    for rank in [2, 9] {
        let value = |i: usize| if i < rank { 1.0 / (1.0 + i as f64) } else { 0.0 };
        let map = DMatrix::from_fn(90, 90, |i, j| if i == j { value(i) } else { 0.0 });
        let mut dense = Dense { map, weights: vec![1.0; 90] };
        let start: Vec<f64> = (0..90).map(|i| if i < rank { 1.0 } else { 0.0 }).collect();
        let found = largest_eigenvalue(&mut dense, &start).unwrap();
        assert!((found.value - 1.0).abs() < 1e-14, "{}", found.value);
    }
}

#[test]
fn a_map_that_is_not_a_number_is_an_error() {
    for m in [4, 200] {
        let mut dense = second_differences(m);
        dense.map[(1, 1)] = f64::NAN;
        assert!(largest_eigenvalue(&mut dense, &start(m)).is_err());
        assert!(spectrum(&mut dense, &start(m)).is_err());
    }
}
