//! Formulas that files spell in ASCII (`E_phi1 <= alpha_phi e^2`), as a reader writes them (`E_{φ1} ≤ α_φ e²`).

/// Names of letters and signs, as ASCII spells them.
const LETTERS: [(&str, &str); 18] = [
    ("alpha", "α"),
    ("beta", "β"),
    ("gamma", "γ"),
    ("delta", "δ"),
    ("epsilon", "ε"),
    ("zeta", "ζ"),
    ("theta", "θ"),
    ("kappa", "κ"),
    ("lambda", "λ"),
    ("mu", "μ"),
    ("nu", "ν"),
    ("xi", "ξ"),
    ("sigma", "σ"),
    ("phi", "φ"),
    ("Omega", "Ω"),
    ("Gamma", "Γ"),
    ("Lambda", "Λ"),
    ("sqrt", "√"),
];

/// A formula with its letters and signs; `_` and `^` are before what stands low and high, in braces where that is more than
/// one sign.
pub fn symbols(ascii: &str) -> String {
    let signs = [("<=", "≤"), (">=", "≥"), (" - ", " − "), (" -> ", " → ")];
    let signed = signs.iter().fold(ascii.to_owned(), |text, (from, to)| text.replace(from, to));
    let characters: Vec<char> = signed.chars().collect();
    let (mut out, mut at) = (String::new(), 0);
    while at < characters.len() {
        let rest = &characters[at..];
        let sign = rest[0];
        if sign.is_ascii_alphanumeric() {
            let end = rest.iter().take_while(|c| c.is_ascii_alphanumeric()).count();
            out += &letters(&rest[..end].iter().collect::<String>());
            at += end;
        } else if "_^".contains(sign) && at > 0 {
            let end = 1 + rest[1..].iter().take_while(|c| c.is_ascii_alphanumeric()).count();
            // `u_h,nu` has two indices.
            let second: String = rest[end..].iter().take(3).collect();
            let end = if second == ",nu" { end + 3 } else { end };
            let inside: String = rest[1..end].iter().filter(|c| **c != ',').collect();
            out += &script(sign, &split(&inside));
            at += end;
        } else {
            out.push(match sign {
                '<' => '⟨',
                '>' => '⟩',
                other => other,
            });
            at += 1;
        }
    }
    out.replace("E_j~", "Ẽ_j")
}

/// The indices `hnu` are h and ν.
fn split(inside: &str) -> String {
    match inside.strip_suffix("nu").filter(|first| first.len() == 1) {
        Some(first) => format!("{first}ν"),
        None => letters(inside),
    }
}

fn script(sign: char, inside: &str) -> String {
    match (sign, inside) {
        ('^', "2") => "²".into(),
        _ if inside.chars().count() == 1 => format!("{sign}{inside}"),
        _ => format!("{sign}{{{inside}}}"),
    }
}

/// A word as a letter, where it is the name of one, with a number behind it or without.
fn letters(word: &str) -> String {
    let named = LETTERS.iter().find_map(|(name, letter)| {
        let number = word.strip_prefix(name)?;
        number.chars().all(|c| c.is_ascii_digit()).then(|| format!("{letter}{number}"))
    });
    named.unwrap_or_else(|| word.to_owned())
}

/// A formula where nothing can stand low or high: without the braces.
pub(crate) fn in_line(formula: &str) -> String {
    formula.replace(['{', '}'], "")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_formula_is_written_with_its_letters() {
        for (ascii, written) in [
            ("E_phi1 <= alpha_phi e^2 + beta_phi Y e", "E_{φ1} ≤ α_φ e² + β_φ Y e"),
            ("m_A e^2 <= <Au - Au_h, u - u_h>", "m_A e² ≤ ⟨Au − Au_h, u − u_h⟩"),
            ("|u_nu - u_h,nu|^2 <= c_j^2 e^2", "|u_ν − u_{hν}|² ≤ c_j² e²"),
            ("(|xi + lambda| + c0) delta", "(|ξ + λ| + c0) δ"),
            ("E_j~ <= sqrt(delta)", "Ẽ_j ≤ √(δ)"),
            ("v^h, the number of numbers", "v^h, the number of numbers"),
            ("sqrt|Omega|", "√|Ω|"),
            ("energy constant, n = 8", "energy constant, n = 8"),
        ] {
            assert_eq!(symbols(ascii), written);
        }
        assert_eq!(in_line("E_{φ1} ≤ α_φ"), "E_φ1 ≤ α_φ");
    }
}
