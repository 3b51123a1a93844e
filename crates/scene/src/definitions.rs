//! Named constants and quantities: `[exact.parameters]` and `[exact.define]`, in file order.

use std::collections::BTreeMap;

use formula::{Graph, Node, Scope, Variable};

use super::data::AXES;
use super::diagnostic::SceneError;
use super::reading::Reading;
use super::written::Formula;

const PARAMETERS: &str = "exact.parameters";
const DEFINE: &str = "exact.define";

/// The named constants; each may use earlier ones.
pub(super) fn parameters(
    reading: &mut Reading,
    written: &BTreeMap<String, Formula>,
) -> Result<Vec<(String, Node)>, SceneError> {
    let mut scope = Scope::new(&[]);
    let mut parameters = Vec::new();
    for (key, name, formula) in in_file_order(reading, PARAMETERS, written) {
        free_name(reading, &key, name)?;
        let node = reading.formula(&key, formula, &scope)?;
        if !reading.formulas.value_of_constant(node).is_some_and(f64::is_finite) {
            let message = format!("the parameter `{name}` is not a finite constant");
            return Err(reading.error(
                &key,
                message,
                "move a formula in x, y, t to [exact.define]",
            ));
        }
        scope.define(name, node);
        parameters.push((name.to_string(), node));
    }
    Ok(parameters)
}

/// The scope of the exact solution: space variables, t, parameters and named quantities; each of these may use earlier
/// ones.
pub(super) fn definitions(
    reading: &mut Reading,
    written: &BTreeMap<String, Formula>,
    dimension: usize,
) -> Result<Scope, SceneError> {
    let mut variables = AXES[..dimension].to_vec();
    variables.push(Variable::T);
    definitions_in(reading, written, &variables)
}

/// The scope of named quantities in the given variables.
pub(super) fn definitions_in(
    reading: &mut Reading,
    written: &BTreeMap<String, Formula>,
    variables: &[Variable],
) -> Result<Scope, SceneError> {
    let mut scope = reading.scope(variables);
    let ordered = in_file_order(reading, DEFINE, written);
    for (key, name, formula) in &ordered {
        free_name(reading, key, name)?;
        if reading.parameters.iter().any(|(parameter, _)| parameter == name) {
            return Err(reading.key_error(
                key,
                format!("`{name}` is a parameter already"),
                "choose another name",
            ));
        }
        let node = reading.formula(key, formula, &scope).map_err(|error| {
            let later: Vec<&str> = ordered
                .iter()
                .map(|(_, name, _)| *name)
                .filter(|name| scope.get(name).is_none())
                .collect();
            used_too_early(error, &later)
        })?;
        scope.define(name, node);
    }
    Ok(scope)
}

/// Adds a note if a formula names something defined further down.
fn used_too_early(error: SceneError, later: &[&str]) -> SceneError {
    let SceneError::Text(diagnosis) = &error else {
        return error;
    };
    let word = &diagnosis.text[diagnosis.span.clone()];
    if !later.contains(&word) {
        return error;
    }
    let note = format!(
        "`{word}` is defined here or further down: a definition may use only those above it"
    );
    error.with_note(note)
}

/// (dotted key, name, formula), sorted by position in the file.
fn in_file_order<'w>(
    reading: &Reading,
    table: &str,
    written: &'w BTreeMap<String, Formula>,
) -> Vec<(String, &'w str, &'w Formula)> {
    let mut entries: Vec<_> = written
        .iter()
        .map(|(name, formula)| (format!("{table}.{name}"), name.as_str(), formula))
        .collect();
    entries.sort_by_key(|(key, _, _)| reading.spans.key(key).start);
    entries
}

/// Checks that a name is valid in formulas and not taken.
fn free_name(reading: &Reading, key: &str, name: &str) -> Result<(), SceneError> {
    if Graph::is_reserved(name) {
        let hint = "variables, functions and pi keep their meaning: choose another name";
        return Err(reading.key_error(key, format!("`{name}` is a reserved name"), hint));
    }
    let mut letters = name.chars();
    let starts = letters.next().is_some_and(|c| c.is_ascii_alphabetic() || c == '_');
    if starts && letters.all(|c| c.is_ascii_alphanumeric() || c == '_') {
        return Ok(());
    }
    Err(reading.key_error(
        key,
        format!("`{name}` cannot be used in a formula"),
        "a name begins with a letter and has letters, digits and _",
    ))
}
