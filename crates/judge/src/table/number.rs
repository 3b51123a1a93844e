//! Numbers as programs print them and as papers set them.

/// What the commas of a number are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Comma {
    None,
    Decimal,
    Thousands,
    /// Three digits follow, as in `2,312`: the value is that of 2312.
    Either,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Number {
    pub(super) value: f64,
    pub(super) comma: Comma,
    /// `ms` of `0.5ms`, or nothing.
    pub(super) unit: String,
}

pub(super) fn is_missing(cell: &str) -> bool {
    let missing = ["", "-", "--", "---", "–", "—", "*", "n/a", "na", "none", "missing", "..."];
    missing.iter().any(|word| cell.eq_ignore_ascii_case(word))
}

pub(super) fn number(cell: &str) -> Option<Number> {
    let plain = |value, comma| Some(Number { value, comma, unit: String::new() });
    if let Ok(value) = cell.parse::<f64>() {
        return plain(value, Comma::None);
    }
    // Words are many: nothing but `nan` and `inf` begins with a letter.
    let first = cell.trim_start_matches([' ', '$', '`', '*', '{']).chars().next()?;
    if first.is_alphabetic() && !"nNiI".contains(first) {
        return None;
    }
    let mut text = cell.trim().trim_matches(['$', '`']).replace("\\%", "%");
    text = text.trim_start_matches("**").trim_end_matches("**").replace(['\u{2212}', '–'], "-");
    for command in ["\\num", "\\textbf", "\\mathbf", "\\text", "\\,", "~"] {
        text = text.replace(command, "");
    }
    text.retain(|c| !"{}$_'\u{2009}\u{202f}\u{a0}".contains(c));
    for times in ["×10^", "x10^", "*10^"] {
        text = text.replace(times, "e");
    }
    let text = text.trim();
    if !text.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c)) {
        return text.parse().ok().and_then(|value| plain(value, Comma::None));
    }
    if let Some(percent) = text.strip_suffix('%') {
        return number(percent.trim_end()).map(|n| Number { value: n.value / 100.0, ..n });
    }
    let float = |text: &str| text.trim().parse::<f64>().ok();
    let fortran = text.replace(['d', 'D'], "e");
    if let Some(value) = float(text).or_else(|| float(&fortran)).or_else(|| wide_exponent(text)) {
        return plain(value, Comma::None);
    }
    if let Some((a, b)) = text.split_once('/') {
        return float(a).zip(float(b)).and_then(|(a, b)| plain(a / b, Comma::None));
    }
    if let Some((a, b)) = text.split_once('^') {
        return float(a).zip(float(b)).and_then(|(a, b)| plain(a.powf(b), Comma::None));
    }
    if text.contains(['x', '×']) {
        // `32x32` are 32 along each side.
        let mut sides = text.split(['x', '×']).map(float);
        let first = sides.next().flatten()?;
        return sides.all(|side| side == Some(first)).then(|| plain(first, Comma::None))?;
    }
    if text.contains(',') {
        return commas(text).and_then(|(value, comma)| plain(value, comma));
    }
    let letters = text.trim_end_matches(|c: char| c.is_alphabetic());
    let unit = &text[letters.len()..];
    let value = float(letters).filter(|_| (1..=3).contains(&unit.chars().count()))?;
    // `1e`, `2D` are numbers cut short.
    (!["e", "E", "d", "D"].contains(&unit)).then(|| Number {
        value,
        comma: Comma::None,
        unit: unit.into(),
    })
}

/// Fortran prints 1.5E-103 as `1.5-103`.
fn wide_exponent(text: &str) -> Option<f64> {
    let at = text.rfind(['+', '-']).filter(|&at| at > 0 && text.len() - at == 4)?;
    let (digits, exponent) = text.split_at(at);
    let whole = digits.contains('.') && digits.ends_with(|c: char| c.is_ascii_digit() || c == '.');
    whole.then(|| format!("{digits}e{exponent}").parse().ok())?
}

fn commas(text: &str) -> Option<(f64, Comma)> {
    let joined: f64 = text.replace(',', "").parse().ok()?;
    let (whole, fraction) = text.split_once('.').unwrap_or((text, ""));
    let mut groups = whole.trim_start_matches(['+', '-']).split(',');
    let first = groups.next()?;
    let digits = |group: &str| group.bytes().all(|byte| byte.is_ascii_digit());
    let grouped = (1..=3).contains(&first.len())
        && !first.starts_with('0')
        && digits(first)
        && groups.clone().all(|group| group.len() == 3 && digits(group))
        && !fraction.contains(',');
    match (grouped, groups.count()) {
        (true, 1) if !text.contains('.') => Some((joined, Comma::Either)),
        (true, _) => Some((joined, Comma::Thousands)),
        (false, 1) => Some((text.replace(',', ".").parse().ok()?, Comma::Decimal)),
        _ => None,
    }
}
