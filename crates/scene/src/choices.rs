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

    /// Refuses a key that another `kind` of the table takes.
    pub(super) fn surplus<T>(
        &self,
        key: &str,
        value: Option<&T>,
        kind: &str,
    ) -> Result<(), SceneError> {
        match value {
            None => Ok(()),
            Some(_) => {
                let name = last(key);
                let hint = format!("remove `{name}`, or choose the kind that takes it");
                Err(self.key_error(key, format!("kind `{kind}` takes no `{name}`"), hint))
            }
        }
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
