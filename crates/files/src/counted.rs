//! Counts and sizes in messages.

/// A number with its noun, in the plural unless the number is 1: `1 case`, `2 cases`.
pub fn counted(number: usize, noun: &str) -> String {
    format!("{number} {noun}{}", if number == 1 { "" } else { "s" })
}

/// A text by which others that differ in their numbers alone are the same.
pub fn without_digits(text: &str) -> String {
    text.replace(|c: char| c.is_ascii_digit(), "")
}

/// Bytes in MiB.
pub fn megabytes(bytes: f64) -> String {
    format!("{:.0} MiB", bytes / (1024.0 * 1024.0))
}

/// A quantity in units that are not known: at most so many significant digits, however small or large it is, without
/// trailing zeros.
pub fn digits(value: f64, significant: usize) -> String {
    match value {
        0.0 => return "0".into(),
        value if value.is_nan() => return "–".into(),
        value if value.is_infinite() => return value.to_string(),
        _ => {}
    }
    let exponent = value.abs().log10().floor();
    if !(-3.0..significant as f64).contains(&exponent) {
        let mantissa = significant.max(1) - 1;
        return format!("{value:.mantissa$e}");
    }
    let text = format!("{value:.*}", (significant as f64 - 1.0 - exponent).max(0.0) as usize);
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

#[cfg(test)]
mod tests {
    use super::{counted, digits};

    #[test]
    fn no_quantity_is_rounded_to_zero() {
        let printed = |value: f64| digits(value, 5);
        let wanted = [
            (0.0, "0"),
            (2.0, "2"),
            (-0.25, "-0.25"),
            (0.001, "0.001"),
            (3.2e-8, "3.2000e-8"),
            (123_456.0, "1.2346e5"),
            (5e-324, "4.9407e-324"),
            (f64::INFINITY, "inf"),
            (f64::NAN, "–"),
        ];
        for (value, text) in wanted {
            assert_eq!(printed(value), text, "{value:e}");
        }
    }

    #[test]
    fn one_is_singular() {
        assert_eq!([0, 1, 2].map(|n| counted(n, "case")), ["0 cases", "1 case", "2 cases"]);
    }
}
