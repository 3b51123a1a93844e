//! Text to tokens.

use std::ops::Range;

use super::error::ParseError;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Token<'a> {
    Number(f64),
    Name(&'a str),
    Symbol(&'static str),
    End,
}

pub(super) type Spanned<'a> = (Token<'a>, Range<usize>);

/// Longest first, so that `<=` is not read as `<`.
const SYMBOLS: [&str; 13] = ["<=", ">=", "<", ">", "+", "-", "*", "/", "^", "(", ")", ",", "="];

pub(super) fn tokens(text: &str) -> Result<Vec<Spanned<'_>>, ParseError> {
    let mut found = Vec::new();
    let mut at = 0;
    while let Some(first) = text[at..].chars().next() {
        let rest = &text[at..];
        let length = if first.is_whitespace() {
            at += first.len_utf8();
            continue;
        } else if first.is_ascii_digit() || first == '.' {
            number_length(rest)
        } else if first.is_alphabetic() || first == '_' {
            rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len())
        } else {
            0
        };
        if rest.starts_with("**") {
            let error = ParseError::new(at..at + 2, "`**` is no operator".to_owned());
            return Err(error.hinted("powers are written t^2"));
        }
        let span = at..at + length.max(1);
        let token = if length > 0 && (first.is_alphabetic() || first == '_') {
            Token::Name(&rest[..length])
        } else if length > 0 {
            Token::Number(number(&rest[..length], span.clone())?)
        } else if let Some(symbol) = SYMBOLS.iter().find(|s| rest.starts_with(**s)) {
            Token::Symbol(symbol)
        } else {
            return Err(unexpected(first, at));
        };
        let end = match token {
            Token::Symbol(symbol) => at + symbol.len(),
            _ => span.end,
        };
        found.push((token, at..end));
        at = end;
    }
    found.push((Token::End, text.len()..text.len()));
    Ok(found)
}

/// Length of the number at the start: digits, a point, an exponent.
fn number_length(text: &str) -> usize {
    let bytes = text.as_bytes();
    let digits = |mut at: usize| {
        while bytes.get(at).is_some_and(u8::is_ascii_digit) {
            at += 1;
        }
        at
    };
    let mut end = digits(0);
    if bytes.get(end) == Some(&b'.') {
        end = digits(end + 1);
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let signed = matches!(bytes.get(end + 1), Some(b'+' | b'-'));
        let start = end + 1 + usize::from(signed);
        let stop = digits(start);
        // Without digits the letter begins a name, as in `2 e`.
        if stop > start {
            end = stop;
        }
    }
    end
}

fn number(text: &str, span: Range<usize>) -> Result<f64, ParseError> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(_) => Err(ParseError::new(span, format!("the number {text} is too large"))
            .hinted("the largest number is about 1.8e308")),
        Err(_) => Err(ParseError::new(span, format!("`{text}` is not a number"))),
    }
}

fn unexpected(character: char, at: usize) -> ParseError {
    let span = at..at + character.len_utf8();
    let error = ParseError::new(span, format!("`{character}` has no meaning in a formula"));
    match character {
        '&' => error.hinted("write `and`"),
        '|' => error.hinted("write `or`, or `abs(...)`"),
        '!' => error.hinted("write `not`"),
        '[' | '{' => error.hinted("use parentheses"),
        '\u{2212}' => error.hinted("write `-`"),
        _ => error,
    }
}
