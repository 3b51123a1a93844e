//! Converts formulas from ASCII (`E_phi1 <= alpha_phi e^2`) to print (`E_{φ1} ≤ α_φ e²`).

use std::ops::Range;

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
            out += &written(sign, &split(&inside));
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

fn written(sign: char, inside: &str) -> String {
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

/// Words in pieces, each after its sign: a blank, or `_` or `^` for what stands low or high. In a formula that is what
/// follows the sign, in braces or one character. Among words `a_b` is a symbol if one letter, or a bracket, has an index
/// in braces or of one or two characters, or a power of letters, and ends with it: `V_max`, `cases_by_n` and `h^0.99`
/// stay as they are. Γ3 is Γ with a low 3.
pub(crate) fn scripts(words: &str, formula: bool) -> Vec<(char, String)> {
    let characters: Vec<char> = words.chars().collect();
    let (mut pieces, mut plain, mut at) = (Vec::new(), String::new(), 0);
    while at < characters.len() {
        let Some((sign, inside, end)) = script(&characters, at, formula) else {
            plain.push(characters[at]);
            at += 1;
            continue;
        };
        pieces.push((' ', std::mem::take(&mut plain)));
        pieces.push((sign, characters[inside].iter().collect()));
        at = end;
    }
    pieces.push((' ', plain));
    pieces.retain(|(_, text)| !text.is_empty());
    pieces
}

/// The script that begins here, if any: sign, place of its content, end.
fn script(characters: &[char], at: usize, formula: bool) -> Option<(char, Range<usize>, usize)> {
    let before = |back: usize| at.checked_sub(back).map(|i| characters[i]);
    let ends = |c: char| !c.is_alphanumeric() && c != '_' || c == '²';
    let alone = before(2).is_none_or(|c| ends(c) && !"-.".contains(c));
    let is_base = |c: char| "‖|)]".contains(c) || c.is_alphabetic() && alone;
    let (sign, from) = match characters[at] {
        sign @ ('_' | '^') if formula || before(1).is_some_and(is_base) => (sign, at + 1),
        '1'..='4' if before(1) == Some('Γ') => ('_', at),
        _ => return None,
    };
    let rest = &characters[from..];
    if rest.first() == Some(&'{') {
        let to = from + rest.iter().position(|c| *c == '}')?;
        return Some((sign, from + 1..to, to + 1));
    }
    if formula {
        return (!rest.is_empty()).then_some((sign, from..from + 1, from + 1));
    }
    // A power behind an index is not part of it.
    let belongs = |c: &&char| match sign {
        '_' => c.is_alphanumeric() && **c != '²',
        _ => c.is_alphabetic(),
    };
    let length = rest.iter().take_while(belongs).count();
    let ended = rest.get(length).is_none_or(|c| ends(*c));
    ((1..=2).contains(&length) && ended).then_some((sign, from..from + length, from + length))
}

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

/// Escapes words for HTML and SVG.
pub fn escaped(text: &str) -> String {
    replaced(text, |character| {
        Some(match character {
            '&' => "&amp;",
            '<' => "&lt;",
            '>' => "&gt;",
            '"' => "&quot;",
            '\'' => "&#39;",
            _ => return None,
        })
    })
}

/// A formula without braces.
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

    fn set(words: &str, formula: bool) -> String {
        let piece = |(sign, text): (char, String)| match sign {
            ' ' => text,
            _ => format!("{sign}<{text}>"),
        };
        scripts(words, formula).into_iter().map(piece).collect()
    }

    #[test]
    fn symbols_among_words_have_their_index() {
        let set = |words: &str| set(words, false);
        assert_eq!(set("e_n is at t_n, c_j² ≤ 1, u_hν"), "e_<n> is at t_<n>, c_<j>² ≤ 1, u_<hν>");
        assert_eq!(set("exact u(t) in V^h, k ~ h^s"), "exact u(t) in V^<h>, k ~ h^<s>");
        assert_eq!(set("max ‖u_ν−u_hν‖_V on Γ3"), "max ‖u_<ν>−u_<hν>‖_<V> on Γ_<3>");
        assert_eq!(set("E_{φ1}² ≤ σ^D"), "E_<φ1>² ≤ σ^<D>");
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
            "a-b_c",
            "10⁻³",
            "Γ",
            "m0",
        ] {
            assert_eq!(set(name), name);
        }
    }

    #[test]
    fn every_sign_of_a_formula_sets_what_follows() {
        assert_eq!(set("max_n |u_n^{kh}|^{1/2}", true), "max_<n> |u_<n>^<kh>|^<1/2>");
    }
}
