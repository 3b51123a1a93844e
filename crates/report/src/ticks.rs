//! Numbers at the ticks of an axis.

/// A step as 1/n if possible.
pub(super) fn step_label(step: f64) -> String {
    let inverse = 1.0 / step;
    // 1/n as computed is off by a rounding; a step of a graded grid by far more.
    if inverse > 1.5 && inverse < 1e6 && (inverse - inverse.round()).abs() < 1e-9 * inverse {
        format!("1/{}", inverse.round())
    } else if (1e-3..1e4).contains(&step) {
        format!("{}", (step * 1e4).round() / 1e4)
    } else {
        format!("{step:.1e}")
    }
}

/// digit·10^exponent, as a plain decimal if short.
pub(super) fn decimal(digit: i64, exponent: i64) -> String {
    match exponent {
        -3..0 => format!("{:.*}", -exponent as usize, digit as f64 * 10f64.powi(exponent as i32)),
        0..4 => format!("{}", digit * 10i64.pow(exponent as u32)),
        _ if digit == 1 => power(exponent),
        _ => format!("{digit}·{}", power(exponent)),
    }
}

pub(super) fn power(exponent: i64) -> String {
    format!("10{}", superscript(exponent))
}

/// A multiple of `step`, with as many decimals as the step has.
pub(super) fn with_decimals(value: f64, step: f64) -> String {
    let exponent = (step * (1.0 + 1e-9)).log10().floor() as i32;
    if (-4..5).contains(&exponent) {
        // Avoids -0.
        let value = if value.abs() < 0.5 * step { 0.0 } else { value };
        format!("{value:.*}", (-exponent).max(0) as usize)
    } else {
        format!("{value:.1e}")
    }
}

fn superscript(exponent: i64) -> String {
    let digit = |c: char| "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().nth(c.to_digit(10)? as usize);
    exponent.to_string().chars().map(|c| digit(c).unwrap_or('⁻')).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_as_they_should() {
        assert_eq!(power(-10), "10⁻¹⁰");
        assert_eq!(step_label(1.0 / 49.0), "1/49");
        assert_eq!(step_label(0.3), "0.3");
        assert_eq!(decimal(2, -3), "0.002");
        assert_eq!(decimal(5, 3), "5000");
        assert_eq!(decimal(2, -7), "2·10⁻⁷");
        assert_eq!(with_decimals(0.30000000000000004, 0.1), "0.3");
        assert_eq!(with_decimals(-1e-17, 0.02), "0.00");
        assert_eq!(with_decimals(3e-7, 1e-7), "3.0e-7");
    }
}
