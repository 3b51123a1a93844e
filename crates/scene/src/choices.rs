//! Enumerated words, with suggestions for unknown ones.

use super::diagnostic::Result;
use super::nearest::nearest;
use super::reading::{Reading, last};

impl Reading<'_> {
    /// The value that the word at a key names.
    ///
    /// # Errors
    /// No word, or an unknown one; the message lists the known ones, nearest first.
    pub(super) fn choice<T: Copy>(&self, key: &str, known: &[(&str, T)]) -> Result<T> {
        self.named(key, &self.required::<String>(key)?, known)
    }

    /// The value that the word at a key names, or that without the key.
    ///
    /// # Errors
    /// An unknown word.
    pub(super) fn choice_or<T: Copy>(
        &self,
        key: &str,
        known: &[(&str, T)],
        without: T,
    ) -> Result<T> {
        if self.has(key) { self.choice(key, known) } else { Ok(without) }
    }

    /// The value that a word at a key names.
    ///
    /// # Errors
    /// An unknown word.
    pub(super) fn named<T: Copy>(&self, key: &str, word: &str, known: &[(&str, T)]) -> Result<T> {
        if let Some((_, value)) = known.iter().find(|(name, _)| *name == word) {
            return Ok(*value);
        }
        let names = || known.iter().map(|(name, _)| *name);
        let list = names().collect::<Vec<_>>().join(", ");
        let hint = match nearest(word, names()) {
            Some(meant) => format!("did you mean `{meant}`? known: {list}"),
            None => format!("known: {list}"),
        };
        let subject = last(key);
        Err(self.error(key, format!("unknown value `{word}` of `{subject}`"), hint))
    }
}
