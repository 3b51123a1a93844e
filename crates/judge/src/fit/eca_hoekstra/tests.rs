use super::*;

fn values(steps: &[f64], value: impl Fn(f64) -> f64) -> Vec<ValueSample> {
    steps.iter().map(|&step| ValueSample { step, value: value(step) }).collect()
}

const STEPS: [f64; 5] = [0.4, 0.25, 0.2, 0.1, 0.08];

/// Golden section on σ, whose minimum is a corner at zero: p to 1e-9, limits to 1e-8.
#[test]
fn an_exact_power_gives_its_limit_and_the_small_factor() {
    for order in [0.6, 1.0, 1.01, 1.7, 2.0 - 1e-6] {
        let found = eca_hoekstra(&values(&STEPS, |h| 3.0 + 2.0 * h.powf(order))).unwrap();
        let Expansion::Power(p) = found.fit.expansion else { panic!("{found:?}") };
        assert!((p - order).abs() < 1e-7, "{found:?}");
        assert!((found.fit.limit - 3.0).abs() < 1e-7 && found.safety == 1.25, "{found:?}");
        let error = 2.0 * 0.08f64.powf(order);
        assert!((found.uncertainty - 1.25 * error).abs() < 1e-6, "{found:?}");
        let range = (2.0 * 0.4f64.powf(order) - error) / 4.0;
        assert!((found.data_range - range).abs() < 1e-14);
    }
}

/// p = 3 is not trusted: the second-order term is fitted with factor 3.
#[test]
fn orders_beyond_two_fall_back_to_two() {
    let samples = values(&STEPS, |h| 3.0 - h.powi(3));
    let found = eca_hoekstra(&samples).unwrap();
    assert_eq!((found.fit.expansion, found.safety), (Expansion::Second, 3.0));
    assert!((found.observed_order.unwrap() - 3.0).abs() < 1e-7);
    assert!(found.uncertainty > (samples[4].value - 3.0).abs(), "{found:?}");
}

/// p just above 2 keeps the factor 1.25 up to 2.1, with the second-order term.
#[test]
fn the_factor_has_its_margin() {
    for (order, safety) in [(2.05, 1.25), (2.15, 3.0), (0.55, 1.25), (0.45, 3.0)] {
        let found = eca_hoekstra(&values(&STEPS, |h| 1.0 + h.powf(order))).unwrap();
        assert_eq!(found.safety, safety, "{order}: {found:?}");
        assert_eq!(
            matches!(found.fit.expansion, Expansion::Power(_)),
            (0.5..=2.0).contains(&order)
        );
    }
}

/// Below one half all three expansions compete; h + h² takes a root best.
#[test]
fn slow_values_take_the_mixed_expansion() {
    let samples = values(&STEPS, |h| 1.0 + h.powf(0.3));
    let found = eca_hoekstra(&samples).unwrap();
    assert_eq!((found.fit.expansion, found.safety), (Expansion::Mixed, 3.0));
    assert!((found.observed_order.unwrap() - 0.3).abs() < 1e-6);
}

/// By hand: φ = 0, 1, 2, 1 on h = 4, 3, 2, 1 has no optimal p; the linear fit has slope −0.4, value 1.6 at h = 1,
/// residuals (−0.4, 0.2, 0.8, −0.6): σ² = 1.2/2.
#[test]
fn a_linear_fit_by_hand() {
    let samples: Vec<ValueSample> = [(4.0, 0.0), (3.0, 1.0), (2.0, 2.0), (1.0, 1.0)]
        .map(|(step, value)| ValueSample { step, value })
        .to_vec();
    let fit = expansion_fit(&samples, Expansion::First, false).unwrap();
    assert!((fit.deviation - 0.6f64.sqrt()).abs() < 1e-14, "{fit:?}");
    assert!((fit.error + 0.4).abs() < 1e-14 && (fit.limit - 2.0).abs() < 1e-14, "{fit:?}");
    assert!((fit.distance - 0.6).abs() < 1e-14);
}

/// Weights 1/h normalised to mean 1: on h = 2, 1, 1/2, 1/4 they are 4 (½, 1, 2, 4)/7.5. Values 0, 0, 0, 1, by hand.
#[test]
fn weights_are_the_inverse_steps() {
    let steps = [2.0, 1.0, 0.5, 0.25];
    let samples = values(&steps, |h| f64::from(u8::from(h == 0.25)));
    let fit = expansion_fit(&samples, Expansion::First, true).unwrap();
    let weights = steps.map(|h| 4.0 / (7.5 * h));
    let sum = |f: &dyn Fn(f64, f64) -> f64| -> f64 {
        steps.iter().zip(&weights).map(|(h, w)| w * f(*h, f64::from(u8::from(*h == 0.25)))).sum()
    };
    let (s, sh, shh) = (sum(&|_, _| 1.0), sum(&|h, _| h), sum(&|h, _| h * h));
    let (sv, shv) = (sum(&|_, v| v), sum(&|h, v| h * v));
    let slope = (s * shv - sh * sv) / (s * shh - sh * sh);
    let limit = (sv - slope * sh) / s;
    let squares = sum(&|h, v| (limit + slope * h - v).powi(2));
    assert!((s - 4.0).abs() < 1e-14 && (fit.limit - limit).abs() < 1e-13, "{fit:?}");
    assert!((fit.error - slope * 0.25).abs() < 1e-13);
    assert!((fit.deviation - (squares / 2.0).sqrt()).abs() < 1e-13);
}

/// Scatter beyond the data range takes the other formula of the uncertainty.
#[test]
fn scatter_is_not_believed() {
    let samples = values(&[0.4, 0.3, 0.2, 0.1], |h| if h == 0.3 || h == 0.1 { 1.0 } else { -1.0 });
    let found = eca_hoekstra(&samples).unwrap();
    assert!(found.fit.deviation > found.data_range && found.safety == 3.0, "{found:?}");
    assert!(found.uncertainty > 2.0, "{found:?}");
}

#[test]
fn an_order_beyond_reach_is_none() {
    let found = eca_hoekstra(&values(&STEPS, |h| 1.0 + (h / 0.08).powi(9))).unwrap();
    assert_eq!((found.observed_order, found.safety), (None, 3.0));
}

#[test]
fn three_grids_and_constant_values() {
    assert_eq!(eca_hoekstra(&values(&STEPS[..2], |h| h)), None);
    let exact = eca_hoekstra(&values(&STEPS[..3], |h| 1.0 + h.powf(1.5))).unwrap();
    let error = STEPS[2].powf(1.5);
    // Golden section finds the order to the root of rounding.
    assert!((exact.fit.limit - 1.0).abs() < 1e-6 && exact.fit.deviation < 1e-7, "{exact:?}");
    assert!((exact.uncertainty / (1.25 * error) - 1.0).abs() < 1e-4, "{exact:?}");
    let still = eca_hoekstra(&values(&STEPS, |_| 5.0)).unwrap();
    assert_eq!((still.fit.limit, still.uncertainty, still.data_range), (5.0, 0.0, 0.0));
}

/// Values on h = 1.6, 0.8, 0.4, 0.2, 0.1 with the results of a separate NumPy program (least squares and bounded scalar
/// minimisation of σ(p)), to ten digits: [limit, σ, Δφ, uncertainty].
#[test]
fn every_branch_has_the_numbers_of_another_program() {
    use Expansion::{Mixed, Power, Second};
    let p = 1.081538429;
    let cases = [
        (
            [1.81, 1.38, 1.215, 1.09, 1.062],
            (Power(p), true, 1.25, Some(p)),
            [1.019788702, 0.01620941687, 0.187, 0.06823749331],
        ),
        (
            [1.8222, 1.1004, 1.0143, 1.0006, 1.0007],
            (Second, true, 3.0, Some(3.028035735)),
            [0.9859608602, 0.03272647805, 0.2054, 0.0536406716],
        ),
        (
            [1.811, 2.35, 2.2895, 2.171, 2.0935],
            (Mixed, true, 3.0, None),
            [2.000711584, 0.001507313605, 0.13475, 0.2795161217],
        ),
        (
            [1.0, -1.0, 1.0, -1.0, 1.2],
            (Second, false, 3.0, None),
            [0.05964912281, 1.268303559, 0.55, 16.66311816],
        ),
    ];
    for (values, (expansion, weighted, safety, order), numbers) in cases {
        let steps = [1.6, 0.8, 0.4, 0.2, 0.1];
        let samples = steps.iter().zip(values).map(|(&step, value)| ValueSample { step, value });
        let found = eca_hoekstra(&samples.collect::<Vec<_>>()).expect("five grids");
        match (found.fit.expansion, expansion) {
            // A flat optimum: σ to ten digits is p to five.
            (Power(fitted), Power(other)) => assert!((fitted - other).abs() < 1e-5, "{found:?}"),
            (fitted, other) => assert_eq!(fitted, other),
        }
        assert_eq!((found.fit.weighted, found.safety), (weighted, safety));
        if let (Some(fitted), Some(other)) = (found.observed_order, order) {
            assert!((fitted - other).abs() < 1e-5, "{found:?}");
        }
        let numbers_found =
            [found.fit.limit, found.fit.deviation, found.data_range, found.uncertainty];
        for (fitted, other) in numbers_found.iter().zip(numbers) {
            // σ and the rest change with the square and the first power of the error in p.
            assert!((fitted - other).abs() < 1e-6 * other.abs(), "{found:?}");
        }
    }
}
