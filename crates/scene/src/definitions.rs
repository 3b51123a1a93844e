//! Named constants and quantities: `[exact.parameters]` and `[exact.define]`, in file order.

use std::collections::BTreeMap;

use formula::{Graph, Node, Scope};

use super::reading::{Formula, Reading, join, placed};
use super::source::{Result, SceneError};

/// The named constants; each may use earlier ones.
pub(super) fn parameters(reading: &mut Reading) -> Result<Vec<(String, Node)>> {
    let mut parameters = Vec::new();
    defined(reading, "exact.parameters", Scope::new(&[]), |reading, key, name, node| {
        let constant = reading.formulas.value_of_constant(node).is_some_and(f64::is_finite);
        let message = format!("the parameter `{name}` is not a finite constant");
        let hint = "move a formula in x, y, t to [exact.define]";
        reading.refuse_if(!constant, key, message, hint)?;
        parameters.push((name.to_owned(), node));
        Ok(())
    })?;
    Ok(parameters)
}

/// A scope with the named quantities; each of these may use earlier ones.
pub(super) fn definitions(reading: &mut Reading, scope: Scope) -> Result<Scope> {
    defined(reading, "exact.define", scope, |reading, key, name, _| {
        if reading.parameters.iter().any(|(parameter, _)| parameter == name) {
            let message = format!("`{name}` is a parameter already");
            return Err(reading.key_error(key, message, "choose another name"));
        }
        Ok(())
    })
}

/// The scope with the names of a table, each checked with its key and its formula.
fn defined(
    reading: &mut Reading,
    table: &str,
    mut scope: Scope,
    mut check: impl FnMut(&Reading, &str, &str, Node) -> Result<()>,
) -> Result<Scope> {
    let written: BTreeMap<String, Formula> = reading.optional(table)?.unwrap_or_default();
    let keyed = written.into_iter().map(|(name, formula)| (join(table, &name), name, formula));
    let mut ordered: Vec<_> = keyed.collect();
    ordered.sort_by_key(|(key, ..)| placed(reading.table, key).key.start);
    for (key, name, formula) in &ordered {
        free_name(reading, key, name)?;
        let node = reading.compiled(key, formula, &scope).map_err(|mut error| {
            if let SceneError::Text(fault) = &mut error {
                let word = &fault.text[fault.span.clone()];
                let later =
                    scope.get(word).is_none() && ordered.iter().any(|(_, name, _)| name == word);
                let note =
                    "is defined here or further down: a definition may use only those above it";
                fault.notes.extend(later.then(|| format!("`{word}` {note}")));
            }
            error
        })?;
        check(reading, key, name, node)?;
        scope.define(name, node);
    }
    Ok(scope)
}

/// Checks that a name is valid in formulas and not taken.
fn free_name(reading: &Reading, key: &str, name: &str) -> Result<()> {
    if Graph::is_reserved(name) {
        let hint = "variables, functions and pi keep their meaning: choose another name";
        return Err(reading.key_error(key, format!("`{name}` is a reserved name"), hint));
    }
    let mut letters = name.chars();
    let starts = letters.next().is_some_and(|c| c.is_ascii_alphabetic() || c == '_');
    if starts && letters.all(|c| c.is_ascii_alphanumeric() || c == '_') {
        return Ok(());
    }
    let hint = "a name begins with a letter and has letters, digits and _";
    Err(reading.key_error(key, format!("`{name}` cannot be used in a formula"), hint))
}
