use gronwall_algebra::linalg::*;

#[test]
fn norms_lose_nothing_where_squares_leave_the_range() {
    for e in [-300, -200, -160, -100, 0, 100, 160, 200, 300] {
        let unit = 2f64.powi(e * 10 / 3);
        let found = norm(&[3.0 * unit, -4.0 * unit]);
        assert!((found / (5.0 * unit) - 1.0).abs() < 1e-15, "{e}: {found:e}");
        // Plain squares do not have that.
        let plain = dot(&[3.0 * unit], &[3.0 * unit]).sqrt() / (3.0 * unit);
        assert!(e.abs() < 200 || plain == 0.0 || plain == f64::INFINITY, "{e}: {plain}");
    }
    assert_eq!((norm(&[]), norm(&[0.0, 0.0])), (0.0, 0.0));
    assert!(norm(&[f64::NAN, 1.0]).is_nan() && norm(&[f64::INFINITY]) == f64::INFINITY);
}

#[test]
fn the_largest_entry_is_found_at_every_place_and_a_nan_is_not_forgotten() {
    assert_eq!(largest(&[]), 0.0);
    for length in 1..=25 {
        for place in 0..length {
            let mut a: Vec<f64> = (0..length).map(|i| (i as f64).sin()).collect();
            for (value, expected) in [(-7.5, 7.5), (f64::NEG_INFINITY, f64::INFINITY)] {
                a[place] = value;
                assert_eq!(largest(&a), expected, "{place} of {length}");
            }
            a[place] = f64::NAN;
            assert!(largest(&a).is_nan(), "{place} of {length}");
        }
    }
}
