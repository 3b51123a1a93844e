//! Converts formulas from ASCII (`E_phi1 <= alpha_phi e^2`) to print (`E_{φ1} ≤ α_φ e²`).

/// ASCII names of letters and signs.
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

/// A formula with its letters and signs; `_` and `^` precede low and high signs, in braces if several.
pub fn symbols(ascii: &str) -> String {
    let signs = [("<=", "≤"), (">=", "≥"), (" - ", " − "), (" -> ", " → ")];
    let signed = signs.iter().fold(ascii.to_owned(), |text, (from, to)| text.replace(from, to));
    let characters: Vec<char> = signed.chars().collect();
    // Between blanks `<` compares; otherwise it opens a product.
    let compares =
        |at: usize| at > 0 && characters[at - 1] == ' ' && characters.get(at + 1) == Some(&' ');
    let (mut out, mut at) = (String::new(), 0);
    while at < characters.len() {
        let rest = &characters[at..];
        let sign = rest[0];
        if sign.is_ascii_alphanumeric() {
            let end = rest.iter().take_while(|c| c.is_ascii_alphanumeric()).count();
            out += &letters(&rest[..end].iter().collect::<String>());
            at += end;
        } else if "_^".contains(sign) && at > 0 && rest.get(1).is_some_and(|c| c.is_alphanumeric())
        {
            // A power behind an index is not part of it.
            let belongs = |c: &&char| c.is_alphanumeric() && **c != '²';
            let end = 1 + rest[1..].iter().take_while(belongs).count();
            // `u_h,nu` has two indices.
            let second: String = rest[end..].iter().take(3).collect();
            let end = if second == ",nu" { end + 3 } else { end };
            let inside: String = rest[1..end].iter().filter(|c| **c != ',').collect();
            out += &script(sign, &split(&inside));
            at += end;
        } else {
            out.push(match sign {
                '<' if !compares(at) => '⟨',
                '>' if !compares(at) => '⟩',
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

/// A named letter, with or without a number behind it.
fn letters(word: &str) -> String {
    let named = LETTERS.iter().find_map(|(name, letter)| {
        let number = word.strip_prefix(name)?;
        number.chars().all(|c| c.is_ascii_digit()).then(|| format!("{letter}{number}"))
    });
    named.unwrap_or_else(|| word.to_owned())
}

/// Words with low and high signs: `a_b` and `a^b` are symbols if one letter has an index of one or two signs (or a
/// numeric power, as `h^0.99`) and ends with it, so that `V_max` and `cases_by_n` stay names.
pub(crate) fn indexed(words: &str, set: impl Fn(char, &str) -> String) -> String {
    let characters: Vec<char> = words.chars().collect();
    let ends = |c: Option<&char>| c.is_none_or(|c| !c.is_alphanumeric() && *c != '_' || *c == '²');
    let (mut out, mut at) = (String::new(), 0);
    while at < characters.len() {
        let base = characters[at].is_alphabetic() && (at == 0 || ends(characters.get(at - 1)));
        out.push(characters[at]);
        at += 1;
        let Some(sign) = characters.get(at).filter(|c| base && "_^".contains(**c)) else {
            continue;
        };
        let belongs = |c: &&char| match sign {
            '_' => c.is_alphanumeric() && **c != '²',
            _ => c.is_alphabetic(),
        };
        let end = at + 1 + characters[at + 1..].iter().take_while(belongs).count();
        if (at + 2..=at + 3).contains(&end) && ends(characters.get(end)) {
            out += &set(*sign, &characters[at + 1..end].iter().collect::<String>());
            at = end;
        }
    }
    out
}

/// A formula without scripts and braces.
/// The text without control characters, each sign as `set` has it for a format.
pub(crate) fn replaced(text: &str, set: impl Fn(char) -> Option<&'static str>) -> String {
    let mut result = String::with_capacity(text.len());
    for character in files::harmless(text).chars() {
        match set(character) {
            Some(sign) => result.push_str(sign),
            None => result.push(character),
        }
    }
    result
}

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
            ("(2.9) asks alpha_j < 0.1", "(2.9) asks α_j < 0.1"),
            ("h^(1/2)", "h^(1/2)"),
            ("β_φ and c_j², with m0", "β_φ and c_j², with m0"),
            ("energy constant, n = 8", "energy constant, n = 8"),
        ] {
            assert_eq!(symbols(ascii), written);
        }
        assert_eq!(in_line("E_{φ1} ≤ α_φ"), "E_φ1 ≤ α_φ");
    }

    #[test]
    fn symbols_among_words_have_their_index() {
        let set = |words: &str| indexed(words, |sign, index| format!("{sign}<{index}>"));
        assert_eq!(set("e_n is at t_n, c_j² ≤ 1, u_hν"), "e_<n> is at t_<n>, c_<j>² ≤ 1, u_<hν>");
        assert_eq!(set("exact u(t) in V^h, k ~ h^s"), "exact u(t) in V^<h>, k ~ h^<s>");
        for name in [
            "V_max in k",
            "cases_by_n",
            "L2_max",
            "a_",
            "_a",
            "m_A_b",
            "",
            "x_abc",
            "h^0.99",
            "E^-1.5",
            "h^(1/2)",
        ] {
            assert_eq!(set(name), name);
        }
    }
}
