//! The style sheet of pictures: inks on a dark page.
//!
//! Pictures are drawn for white paper and printed so; viewers with a dark page map their inks. The sheet selects by the
//! colours themselves, so that a picture without media queries is the light one.

use super::palette::Colour;

/// Paper; hollow markers are filled with it.
pub(super) const PAPER: Colour = Colour(255, 255, 255);
pub(super) const WORDS: Colour = Colour(30, 30, 30);
/// Words on an area of light colour, which a dark page leaves as it is.
pub(super) const WORDS_ON_TINT: Colour = Colour(31, 31, 31);

/// The rules, for a page that shows several pictures.
pub(super) const RULES: &str = "\
@media (prefers-color-scheme:dark){\
svg [fill=\"#FFFFFF\"]{fill:#14171a}\
svg[fill=\"#1E1E1E\"]{fill:#e6e6e6}\
svg [fill=\"#5A5A5A\"]{fill:#a8adb3}svg [stroke=\"#5A5A5A\"]{stroke:#a8adb3}\
svg [stroke=\"#DEDEDE\"]{stroke:#33393f}\
svg [fill=\"#000000\"]{fill:#f2f2f2}svg [stroke=\"#000000\"]{stroke:#f2f2f2}\
svg [fill=\"#0072B2\"]{fill:#4aa3df}svg [stroke=\"#0072B2\"]{stroke:#4aa3df}\
svg [fill=\"#D55E00\"]{fill:#f0803c}svg [stroke=\"#D55E00\"]{stroke:#f0803c}\
svg [fill=\"#009E73\"]{fill:#2fc59a}svg [stroke=\"#009E73\"]{stroke:#2fc59a}\
svg [fill=\"#CC79A7\"]{fill:#e39cc4}svg [stroke=\"#CC79A7\"]{stroke:#e39cc4}\
svg [fill=\"#56B4E9\"]{fill:#a5dbff}svg [stroke=\"#56B4E9\"]{stroke:#a5dbff}\
}\n";

/// A picture without its rules and its paper.
pub(super) fn without(svg: &str) -> String {
    let svg = svg.replacen(&style(), "", 1);
    let Some((before, rest)) = svg.split_once("\n<rect ") else { return svg };
    let after = rest.split_once("/>").map_or("", |(_, after)| after);
    format!("{before}{after}")
}

/// The rules as an element of a picture.
pub(super) fn style() -> String {
    format!("\n<style>{}</style>", RULES.trim_end())
}

#[cfg(test)]
mod tests {
    use super::super::palette::{COLOURS, GRID, INK};
    use super::*;
    use crate::canvas::Canvas;

    /// Every ink except the light orange has its counterpart, spelt as pictures spell it.
    #[test]
    fn every_ink_has_a_dark_counterpart() {
        let orange = Colour(230, 159, 0);
        let inks = COLOURS.into_iter().filter(|colour| *colour != orange);
        for ink in inks.chain([PAPER, WORDS, GRID, INK]) {
            assert!(RULES.contains(&ink.to_string()), "{ink}");
        }
        assert!(!RULES.contains(&WORDS_ON_TINT.to_string()));
        let svg = Canvas::new().finish();
        assert!(svg.contains("2000/svg\">\n<style>@media") && !without(&svg).contains("style"));
    }
}
