//! The style sheet of pictures: inks on a dark page.
//!
//! Pictures are drawn for white paper and printed so; viewers with a dark page map their inks. The sheet selects by the
//! colours themselves, so that a picture without media queries is the light one.

use super::compact::compact;
use plotters::style::RGBColor;

/// Paper; hollow markers are filled with it.
pub(super) const PAPER: RGBColor = RGBColor(255, 255, 255);
pub(super) const WORDS: RGBColor = RGBColor(30, 30, 30);
/// Words on an area of light colour, which a dark page leaves as it is.
pub(super) const WORDS_ON_TINT: RGBColor = RGBColor(31, 31, 31);

/// The rules, for a page that shows several pictures.
pub(super) const RULES: &str = "\
@media (prefers-color-scheme:dark){\
svg [fill=\"#FFFFFF\"]{fill:#14171a}\
svg [fill=\"#1E1E1E\"]{fill:#e6e6e6}\
svg [fill=\"#5A5A5A\"]{fill:#a8adb3}svg [stroke=\"#5A5A5A\"]{stroke:#a8adb3}\
svg [stroke=\"#DEDEDE\"]{stroke:#33393f}\
svg [fill=\"#000000\"]{fill:#f2f2f2}svg [stroke=\"#000000\"]{stroke:#f2f2f2}\
svg [fill=\"#0072B2\"]{fill:#4aa3df}svg [stroke=\"#0072B2\"]{stroke:#4aa3df}\
svg [fill=\"#D55E00\"]{fill:#f0803c}svg [stroke=\"#D55E00\"]{stroke:#f0803c}\
svg [fill=\"#009E73\"]{fill:#2fc59a}svg [stroke=\"#009E73\"]{stroke:#2fc59a}\
svg [fill=\"#CC79A7\"]{fill:#e39cc4}svg [stroke=\"#CC79A7\"]{stroke:#e39cc4}\
svg [fill=\"#56B4E9\"]{fill:#a5dbff}svg [stroke=\"#56B4E9\"]{stroke:#a5dbff}\
}\n";

/// Compresses a drawn picture and inserts the sheet.
pub(super) fn with_sheet(drawn: &str) -> String {
    let svg = compact(drawn);
    match svg.find('>') {
        Some(end) => format!("{}{}{}", &svg[..=end], element(), &svg[end + 1..]),
        None => svg,
    }
}

pub(super) fn without(svg: &str) -> String {
    svg.replacen(&element(), "", 1)
}

fn element() -> String {
    format!("\n<style>{}</style>", RULES.trim_end())
}

#[cfg(test)]
mod tests {
    use super::super::palette::{COLOURS, GRID, INK};
    use super::*;

    /// Every ink except the light orange has its counterpart, spelt as plotters spells it.
    #[test]
    fn every_ink_has_a_dark_counterpart() {
        let orange = RGBColor(230, 159, 0);
        let inks = COLOURS.into_iter().filter(|colour| *colour != orange);
        for RGBColor(r, g, b) in inks.chain([PAPER, WORDS, GRID, INK]) {
            assert!(RULES.contains(&format!("#{r:02X}{g:02X}{b:02X}")), "{r} {g} {b}");
        }
        let RGBColor(r, g, b) = WORDS_ON_TINT;
        assert!(!RULES.contains(&format!("#{r:02X}{g:02X}{b:02X}")));
        let svg = "<svg width=\"1\">\n</svg>";
        assert_eq!(without(&with_sheet(svg)), compact(svg));
        assert!(with_sheet(svg).contains(" width=\"1\">\n<style>@media"));
    }
}
