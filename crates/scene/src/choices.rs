//! Enumerated words, with suggestions for unknown ones.

use super::diagnostic::SceneError;
use super::nearest::nearest;
use super::reading::{Reading, last};

impl Reading<'_> {
    /// The value that a word names.
    ///
    /// # Errors
    /// An unknown word; the message lists the known ones, nearest first.
    pub(super) fn choice<T: Copy>(
        &self,
        key: &str,
        word: &str,
        known: &[(&str, T)],
    ) -> Result<T, SceneError> {
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

    /// One of the known words.
    ///
    /// # Errors
    /// As [`Self::choice`].
    pub(super) fn word<'k>(
        &self,
        key: &str,
        word: &str,
        known: &[&'k str],
    ) -> Result<&'k str, SceneError> {
        self.choice(key, word, &known.iter().map(|&name| (name, name)).collect::<Vec<_>>())
    }

    /// Refuses the first key that this `kind` of a table does not take. Each key comes with whether it is given, and
    /// with the kinds that take it.
    pub(super) fn only(
        &self,
        table: &str,
        kind: &str,
        keys: &[(&str, bool, &[&str])],
    ) -> Result<(), SceneError> {
        let surplus = keys.iter().find(|(_, given, kinds)| *given && !kinds.contains(&kind));
        let Some((name, ..)) = surplus else { return Ok(()) };
        let hint = format!("remove `{name}`, or choose the kind that takes it");
        let message = format!("kind `{kind}` takes no `{name}`");
        Err(self.key_error(&format!("{table}.{name}"), message, hint))
    }

    /// The finite number of a key that this `kind` needs.
    pub(super) fn number(
        &self,
        key: &str,
        value: Option<f64>,
        kind: &str,
        line: &str,
    ) -> Result<f64, SceneError> {
        self.finite(key, self.needed(key, value, kind, line)?)
    }

    /// The value of a key that this `kind` needs.
    pub(super) fn needed<T>(
        &self,
        key: &str,
        value: Option<T>,
        kind: &str,
        line: &str,
    ) -> Result<T, SceneError> {
        value.ok_or_else(|| {
            let name = last(key);
            self.error(
                key,
                format!("kind `{kind}` needs the key `{name}`"),
                format!("for instance: {line}"),
            )
        })
    }
}
