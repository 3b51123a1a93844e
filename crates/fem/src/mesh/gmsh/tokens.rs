//! Words of a `.msh` file with their places.

use std::ops::Range;
use std::str::FromStr;

use super::{Fault, GmshError};

/// A word: white space around it, or quotes.
pub(super) type Word<'t> = (Range<usize>, &'t str);

/// The words of a text, one after the other.
pub(super) struct Tokens<'t> {
    text: &'t str,
    next: usize,
}

impl<'t> Tokens<'t> {
    pub(crate) fn new(text: &'t str) -> Self {
        // Some editors mark UTF-8.
        Self { text, next: text.len() - text.trim_start_matches('\u{feff}').len() }
    }

    /// Passes over comments before the file begins.
    pub(crate) fn skip_comments(&mut self) -> Result<(), GmshError> {
        while self.text[self.next..].trim_start().starts_with("$Comments") {
            self.skip_to("$EndComments")?;
        }
        Ok(())
    }

    /// An error at a place.
    pub(crate) fn at(&self, span: Range<usize>, fault: Fault) -> GmshError {
        let line = 1 + self.text.as_bytes()[..span.start].iter().filter(|b| **b == b'\n').count();
        GmshError { line, span, fault }
    }

    /// The next word; a quoted one may hold white space, and its place includes the quotes.
    pub(crate) fn word(&mut self) -> Option<Word<'t>> {
        let rest = &self.text[self.next..];
        let start = self.next + rest.find(|c: char| !c.is_whitespace())?;
        let rest = &self.text[start..];
        if let Some(inside) = rest.strip_prefix('"')
            && let Some(end) = inside.find('"')
        {
            self.next = start + end + 2;
            return Some((start..self.next, &inside[..end]));
        }
        let end = rest.find(char::is_whitespace).unwrap_or(rest.len());
        self.next = start + end;
        Some((start..self.next, &rest[..end]))
    }

    /// The next word, which must be there.
    pub(crate) fn some(&mut self, wanted: &'static str) -> Result<Word<'t>, GmshError> {
        let end = self.text.trim_end().len();
        self.word().ok_or_else(|| self.at(end..end, Fault::Ends { wanted }))
    }

    /// The next word as `read` takes it, with its place.
    fn taken<N>(
        &mut self,
        wanted: &'static str,
        read: impl FnOnce(&str) -> Option<N>,
    ) -> Result<(Range<usize>, N), GmshError> {
        let (span, word) = self.some(wanted)?;
        match read(word) {
            Some(value) => Ok((span, value)),
            None => Err(self.at(span, Fault::Unexpected { found: short(word), wanted })),
        }
    }

    /// The next word as a number with its place.
    pub(crate) fn placed<N: FromStr>(
        &mut self,
        wanted: &'static str,
    ) -> Result<(Range<usize>, N), GmshError> {
        self.taken(wanted, |word| word.parse().ok())
    }

    /// The next word as a number.
    pub(crate) fn number<N: FromStr>(&mut self, wanted: &'static str) -> Result<N, GmshError> {
        self.placed(wanted).map(|(_, value)| value)
    }

    /// The next word as a finite number.
    pub(crate) fn finite(&mut self, wanted: &'static str) -> Result<f64, GmshError> {
        let finite = |word: &str| word.parse().ok().filter(|value: &f64| value.is_finite());
        self.taken(wanted, finite).map(|(_, value)| value)
    }

    /// Passes over `count` numbers.
    pub(crate) fn pass(&mut self, count: u64, wanted: &'static str) -> Result<(), GmshError> {
        (0..count).try_for_each(|_| self.finite(wanted).map(|_| ()))
    }

    /// The next word must be this one.
    pub(crate) fn expect(&mut self, wanted: &'static str) -> Result<(), GmshError> {
        self.taken(wanted, |word| (word == wanted).then_some(())).map(|_| ())
    }

    /// Passes over everything up to the end of an unknown part.
    pub(crate) fn skip_to(&mut self, end: &str) -> Result<(), GmshError> {
        match self.text[self.next..].find(end) {
            Some(at) => {
                self.next += at + end.len();
                Ok(())
            }
            None => {
                let last = self.text.trim_end().len();
                Err(self.at(last..last, Fault::Ends { wanted: "the end of a part" }))
            }
        }
    }
}

/// A word for a message.
pub(super) fn short(word: &str) -> String {
    word.chars().take(24).collect()
}
