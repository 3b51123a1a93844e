use gronwall_algebra::linalg::*;

#[test]
fn a_full_matrix_is_solved_and_an_indefinite_one_refused() {
    // A = 4 I + v vᵀ with v = (1, …, 5).
    let entry =
        |i: usize, j: usize| (if i == j { 4.0 } else { 0.0 }) + (i + 1) as f64 * (j + 1) as f64;
    let fill = |values: &mut [f64], shift: f64| {
        for j in 0..5 {
            for i in j..5 {
                values[5 * j + i] = entry(i, j) + if i == j && i == 3 { shift } else { 0.0 };
            }
        }
    };
    let mut dense = DenseCholesky::new(5);
    dense.factorize(|values| fill(values, 0.0)).unwrap();
    let exact = [1.0, -2.0, 0.5, 3.0, -1.0];
    let mut x: [f64; 5] = std::array::from_fn(|i| (0..5).map(|j| entry(i, j) * exact[j]).sum());
    dense.solve(&mut x);
    assert!(x.iter().zip(exact).all(|(a, b)| (a - b).abs() < 1e-13));
    let refused = dense.factorize(|values| fill(values, -30.0));
    assert_eq!(refused, Err(FactorError::NotPositiveDefinite { dof: 3 }));
    let refused = dense.factorize(|values| fill(values, f64::NAN));
    assert_eq!(refused, Err(FactorError::NotFinite));
}
