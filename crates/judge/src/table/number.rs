//! Numbers as programs print them.

pub(super) fn is_missing(cell: &str) -> bool {
    ["-", "--", "---", "–", "—", "*", "n/a", "none"].contains(&cell.to_lowercase().as_str())
}

/// Parses `1.2e-3`, Fortran's `1.2D-3`, a fraction `1/8`, a power `2^-3`, a typographic minus.
///
/// # Errors
/// What is wrong, and the way out.
pub(super) fn parse(cell: &str) -> Result<f64, String> {
    let text = cell.trim().replace('\u{2212}', "-");
    if let Ok(number) = text.parse::<f64>() {
        return Ok(number);
    }
    let fortran = text.replace(['d', 'D'], "e");
    if text.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c))
        && let Ok(number) = fortran.parse::<f64>()
    {
        return Ok(number);
    }
    let both =
        |a: &str, b: &str| Some((a.trim().parse::<f64>().ok()?, b.trim().parse::<f64>().ok()?));
    if let Some((a, b)) = text.split_once('/').and_then(|(a, b)| both(a, b)) {
        return Ok(a / b);
    }
    if let Some((a, b)) = text.split_once('^').and_then(|(a, b)| both(a, b)) {
        return Ok(a.powf(b));
    }
    let point = text.replacen(',', ".", 1);
    if text.matches(',').count() == 1 && point.parse::<f64>().is_ok() {
        return Err(format!("`{text}` has a decimal comma: write {point}"));
    }
    Err(format!("`{text}` is not a number"))
}
