use gronwall_algebra::tensor::*;

#[test]
fn mandel_product_is_the_frobenius_product() {
    // [[1,2],[2,5]]: ‖·‖² = 1 + 4 + 4 + 25.
    let tau = [1.0, 5.0, 2.0 * 2f64.sqrt()];
    assert!((contract(&tau, &tau) - 34.0).abs() < 1e-14);
}

#[test]
fn norms_of_tiny_and_huge_tensors_keep_their_digits() {
    for unit in [1e-200, 1e-160, 1.0, 1e160, 1e200] {
        let size = norm(&[3.0 * unit, 0.0, -4.0 * unit]) / unit;
        assert!((size - 5.0).abs() < 1e-14, "{unit}: {size}");
    }
    assert!(norm(&[f64::NAN, 0.0, 1.0]).is_nan() && norm(&[0.0; 3]) == 0.0);
}

#[test]
fn deviators_are_trace_free_in_their_own_dimension() {
    let plane = deviator(&[1.0, 5.0, 0.3]);
    assert!(trace(&plane).abs() < 1e-15 && plane[0] == -2.0);
    let space = deviator(&[1.0, 2.0, 6.0, 0.1, 0.2, 0.3]);
    assert!(trace(&space).abs() < 1e-15 && space[2] == 3.0);
}
