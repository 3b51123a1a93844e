//! Foreign text (of a solver, scene or table) in messages of this program.

use std::borrow::Cow;

/// Disarms a text: characters that control a terminal or the writing direction become their codes, and no line is a
/// command to GitHub Actions, which takes them from any log. Line ends and tabs stay.
pub fn harmless(text: &str) -> Cow<'_, str> {
    let steers = text.chars().any(is_steering);
    let commands = text.contains("::") || text.contains(LEGACY);
    if !steers && !commands {
        return Cow::Borrowed(text);
    }
    let mut result = String::with_capacity(text.len() + 16);
    for character in text.chars() {
        match is_steering(character) {
            true => result.extend(character.escape_unicode()),
            false => result.push(character),
        }
    }
    if !commands {
        return Cow::Owned(result);
    }
    let lines: Vec<String> = result.split('\n').map(no_command).collect();
    Cow::Owned(lines.join("\n"))
}

/// [`harmless`] for JSON, without changing its meaning: such characters occur only in strings, where JSON has codes for
/// them.
pub fn harmless_json(text: &str) -> String {
    let mut result = String::with_capacity(text.len());
    for character in text.chars() {
        match is_steering(character) {
            // All of them have at most four digits.
            true => result += &format!("\\u{:04x}", u32::from(character)),
            false => result.push(character),
        }
    }
    result.replace(LEGACY, "#\\u0023[")
}

/// The beginning of a long text, and how much is omitted.
pub fn shortened(text: &str, most: usize) -> Cow<'_, str> {
    match text.char_indices().nth(most) {
        None => Cow::Borrowed(text),
        Some((end, _)) => {
            Cow::Owned(format!("{} … ({} bytes more)", &text[..end], text.len() - end))
        }
    }
}

/// An older form of a command, recognised anywhere in a line.
const LEGACY: &str = "##[";

/// Terminal controls, and marks that change direction or hide text.
fn is_steering(character: char) -> bool {
    match character {
        '\n' | '\t' => false,
        '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{2069}' => true,
        '\u{feff}' => true,
        other => other.is_control(),
    }
}

/// Disarms a line that begins with two colons, possibly after blanks.
fn no_command(line: &str) -> String {
    let words = line.trim_start();
    let blanks = &line[..line.len() - words.len()];
    let sign = if words.starts_with("::") { "\\" } else { "" };
    format!("{blanks}{sign}{}", words.replace(LEGACY, "#\\#["))
}
