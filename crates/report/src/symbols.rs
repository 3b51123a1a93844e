//! Converts formulas from ASCII (`E_phi1 <= alpha_phi e^2`) to print (`E_φ1 ≤ α_φ e²`).

use std::ops::Range;

/// ASCII names of letters and signs, each before its sign.
const LETTERS: &str = "alpha α beta β gamma γ delta δ epsilon ε zeta ζ theta θ kappa κ lambda λ mu μ nu ν xi ξ sigma σ phi φ \
    Omega Ω Gamma Γ Lambda Λ sqrt √";

/// Pairs of words that stand behind each other.
fn pairs(words: &'static str) -> impl Iterator<Item = (&'static str, &'static str)> {
    let mut words = words.split_whitespace();
    std::iter::from_fn(move || words.next().zip(words.next()))
}

/// A formula with its letters and signs; `_` and `^` precede low and high signs.
pub fn symbols(ascii: &str) -> String {
    // `u_h,nu` has two indices.
    let signs = [
        ("_h,nu", "_hν"),
        ("E_j~", "Ẽ_j"),
        ("<=", "≤"),
        (">=", "≥"),
        (" - ", " − "),
        (" -> ", " → "),
    ];
    let signed = signs.iter().fold(ascii.to_owned(), |text, (from, to)| text.replace(from, to));
    // Between blanks `<` compares; otherwise it opens a product.
    let bracketed = |text: &str, compares: &str, sign: &str, bracket: &str| {
        text.split(compares)
            .map(|part| part.replace(sign, bracket))
            .collect::<Vec<_>>()
            .join(compares)
    };
    let signed = bracketed(&bracketed(&signed, " < ", "<", "⟨"), " > ", ">", "⟩");
    let characters: Vec<char> = signed.chars().collect();
    let words = characters.chunk_by(|a, b| a.is_ascii_alphanumeric() == b.is_ascii_alphanumeric());
    let mut out = String::new();
    for word in words {
        match (word, out.strip_suffix('^')) {
            (['2'], Some(base)) => out = format!("{base}²"),
            _ => out += &letters(&word.iter().collect::<String>()),
        }
    }
    out
}

/// A named letter, with or without a number behind it.
fn letters(word: &str) -> String {
    let named = pairs(LETTERS).find_map(|(name, letter)| {
        let number = word.strip_prefix(name)?;
        number.chars().all(|c| c.is_ascii_digit()).then(|| format!("{letter}{number}"))
    });
    named.unwrap_or_else(|| word.to_owned())
}

/// Words in pieces, each after its sign: a blank, or `_` or `^` for what stands low or high. In a formula that is what
/// follows the sign, in braces or letters and digits. Among words `a_b` is a symbol if one letter, or a bracket, has an index
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
    // A power behind an index is not part of it.
    let belongs = |c: &&char| match sign {
        '^' if !formula => c.is_alphabetic(),
        _ => c.is_alphanumeric() && **c != '²',
    };
    let length = rest.iter().take_while(belongs).count();
    let ended = formula || length <= 2 && rest.get(length).is_none_or(|c| ends(*c));
    (length > 0 && ended).then_some((sign, from..from + length, from + length))
}

/// The text without control characters; `signs` has each sign to be replaced before what stands for it.
pub(crate) fn replaced(text: &str, signs: &'static str) -> String {
    let mut result = String::with_capacity(text.len());
    for character in files::harmless(text).chars() {
        let is_sign = |sign: &str| sign.chars().eq([character]);
        match character.is_ascii_alphanumeric() {
            true => result.push(character),
            false => match pairs(signs).find(|(sign, _)| is_sign(sign)) {
                Some((_, spelt)) => result.push_str(spelt),
                None => result.push(character),
            },
        }
    }
    result
}

/// Escapes words for HTML and SVG.
pub fn escaped(text: &str) -> String {
    replaced(text, "& &amp; < &lt; > &gt; \" &quot; ' &#39;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_formula_is_written_with_its_letters() {
        for (ascii, written) in [
            ("E_phi1 <= alpha_phi e^2 + beta_phi Y e", "E_φ1 ≤ α_φ e² + β_φ Y e"),
            ("m_A e^2 <= <Au - Au_h, u - u_h>", "m_A e² ≤ ⟨Au − Au_h, u − u_h⟩"),
            ("|u_nu - u_h,nu|^2 <= c_j^2 e^2", "|u_ν − u_hν|² ≤ c_j² e²"),
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
        assert_eq!(set("max_n |u_hν^{kh}|^{1/2} c_j²", true), "max_<n> |u_<hν>^<kh>|^<1/2> c_<j>²");
    }
}
