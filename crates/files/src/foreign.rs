//! Text of others, a solver's, a scene's or a table's, in messages of this program.

use std::borrow::Cow;

/// A text that says what it says and does nothing: characters that steer a terminal or turn the direction of writing
/// stand as their codes, and no line of it is a command to GitHub Actions, which takes them from any log. Ends of lines
/// and tabs stay.
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

/// [`harmless`] for JSON, whose meaning stays: such characters stand within strings alone, where JSON has codes for them.
pub fn harmless_json(text: &str) -> String {
    let mut result = String::with_capacity(text.len());
    for character in text.chars() {
        match is_steering(character) {
            // All of them have four digits at most.
            true => result += &format!("\\u{:04x}", u32::from(character)),
            false => result.push(character),
        }
    }
    result.replace(LEGACY, "#\\u0023[")
}

/// The beginning of a text that is too long to be shown, and how much more there is.
pub fn shortened(text: &str, most: usize) -> Cow<'_, str> {
    match text.char_indices().nth(most) {
        None => Cow::Borrowed(text),
        Some((end, _)) => {
            Cow::Owned(format!("{} … ({} bytes more)", &text[..end], text.len() - end))
        }
    }
}

/// An older form of a command, which is one anywhere in a line.
const LEGACY: &str = "##[";

/// Controls of terminals, and marks that turn or hide what stands behind them.
fn is_steering(character: char) -> bool {
    match character {
        '\n' | '\t' => false,
        '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{2069}' => true,
        '\u{feff}' => true,
        other => other.is_control(),
    }
}

/// A line that begins with two colons, blanks before them or not, is a command.
fn no_command(line: &str) -> String {
    let words = line.trim_start();
    let blanks = &line[..line.len() - words.len()];
    let sign = if words.starts_with("::") { "\\" } else { "" };
    format!("{blanks}{sign}{}", words.replace(LEGACY, "#\\#["))
}
