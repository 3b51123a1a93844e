//! Colours the words of verdicts on a terminal.

/// The words and their colours; blue and orange differ for colour-blind readers.
const WORDS: [(&str, &str); 3] =
    [("pass", "\u{1b}[34m"), ("fail", "\u{1b}[1;33m"), ("unresolved", "\u{1b}[33m")];
const PLAIN: &str = "\u{1b}[0m";

/// Head of the coloured column.
const HEAD: &str = "verdict";

/// A table of verdicts, coloured if stdout allows it: not with NO_COLOR (any value) or a dumb terminal.
pub(super) fn shown(table: &str) -> String {
    match console::Term::stdout().features().colors_supported() {
        true => coloured(table),
        false => table.to_owned(),
    }
}

/// Colours the words in the column of verdicts; widths are unchanged.
fn coloured(table: &str) -> String {
    let column = |line: &str| line.find(HEAD).map(|at| line[..at].chars().count());
    let Some(start) = table.lines().find_map(column) else { return table.to_owned() };
    let line = |line: &str| {
        let at = line.char_indices().nth(start).map_or(line.len(), |(at, _)| at);
        let (before, rest) = line.split_at(at);
        let word = rest.split(|c: char| !c.is_alphabetic()).next().unwrap_or("");
        match WORDS.iter().find(|(known, _)| *known == word) {
            Some((_, colour)) => format!("{before}{colour}{word}{PLAIN}{}", &rest[word.len()..]),
            None => line.to_owned(),
        }
    };
    table.lines().map(line).collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_of_the_column_alone_are_coloured() {
        let table = " scene     norm   observed    verdict   why\n pass-it   V_max  ≥ 1 [a, b]  pass      pass\n b         V_max  -           fail, as  why";
        let found = coloured(table);
        assert_eq!(found.matches('\u{1b}').count(), 4, "{found}");
        assert!(found.contains("\u{1b}[34mpass\u{1b}[0m      pass"), "{found}");
        assert!(found.contains("\u{1b}[1;33mfail\u{1b}[0m, as"), "{found}");
        let bare = WORDS.iter().fold(found.replace(PLAIN, ""), |text, (_, c)| text.replace(c, ""));
        assert_eq!(bare, table);
        assert_eq!(coloured("nothing was judged"), "nothing was judged");
    }
}
