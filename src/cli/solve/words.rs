//! The output of a solve on the terminal: the answer in a sentence, then each quantity with its unit.

use crate::cli::width;
use files::digits;
use serde_json::Value;

/// A unit in the scene's units of length and stress, in the plane and in space; forces and energies of a plane body are
/// per unit depth.
type Unit = [&'static str; 2];

/// Of a count, or a ratio.
const NONE: Unit = [""; 2];
const LENGTH: Unit = ["length"; 2];
const STRESS: Unit = ["stress"; 2];
const FORCE: Unit = ["stress · length", "stress · length²"];
const ENERGY: Unit = ["stress · length²", "stress · length³"];
/// Of the norm of a strain in L²(Ω).
const STRAIN: Unit = ["length", "length^(3/2)"];
/// Of a strain accumulated over time.
const ACCUMULATED: Unit = ["length · time", "length^(3/2) · time"];
const SECONDS: Unit = ["s"; 2];
/// Of bytes.
const MEBIBYTES: Unit = ["MiB"; 2];

/// A group of quantities: key of the JSON document, words, unit.
type Quantities = &'static [(&'static str, &'static str, Unit)];

const GROUPS: [(&str, Quantities); 4] = [
    (
        "contact at t = T",
        &[
            ("contact_force", "force ∫(ξ+λ) on Γ3", FORCE),
            ("compliance_force", "  of the law, ∫ξ", FORCE),
            ("multiplier_force", "  of the obstacle, ∫λ", FORCE),
            ("peak_pressure", "largest pressure ξ+λ", STRESS),
            ("contact_half_width", "half of the length under pressure", LENGTH),
            ("pressure_spread", "spread of the pressure", LENGTH),
            ("locked_vertices", "vertices at the obstacle, u_ν = g", NONE),
            ("jump_vertices", "vertices at a jump of the law", NONE),
            ("friction_force", "friction ∫(−σ_τ) on Γ3", FORCE),
            ("stick_vertices", "vertices that stick", NONE),
            ("slip_vertices", "vertices that slip", NONE),
            ("max_normal_displacement", "largest u_ν", LENGTH),
            ("min_normal_gap", "smallest distance g − u_ν", LENGTH),
        ],
    ),
    (
        "body at t = T",
        &[
            ("strain_norm", "strain ‖ε(u)‖", STRAIN),
            ("zeta", "accumulated strain ζ", ACCUMULATED),
            ("elastic_energy", "elastic energy ½(𝒜ε, ε)", ENERGY),
            ("yielding_elements", "cells that yield", NONE),
            ("min_uy", "smallest u_y", LENGTH),
            ("min_uy_vertex", "  at the vertex", LENGTH),
        ],
    ),
    (
        "inequality at t = T",
        &[
            ("norm", "‖u‖ in X", NONE),
            ("V_max", "largest error over the steps, in X", NONE),
            ("u", "u", NONE),
            ("history", "history Su", NONE),
            ("pressure", "multipliers", NONE),
        ],
    ),
    (
        "solver, all levels",
        &[
            ("element", "element of displacements", NONE),
            ("dofs", "unknowns of a level", NONE),
            ("newton_iterations", "Newton iterations", NONE),
            ("fixed_point_iterations", "applications of Λ", NONE),
            ("convex_problems", "convex problems", NONE),
            ("contraction", "largest quotient of changes", NONE),
            ("contraction_bound", "  its bound, (α_ν c_j² + α_τ c_τ²)/m", NONE),
            ("factorizations", "factorizations", NONE),
            ("linear_solves", "linear solves", NONE),
            ("kkt_residual", "residual of the system, relative", NONE),
            ("seconds", "time of this run", SECONDS),
            ("peak_resident_bytes", "memory of this process", MEBIBYTES),
        ],
    ),
];

/// Keys omitted if zero: another solver, a law without jumps, no friction.
const ZERO_IS_NOTHING: [&str; 7] = [
    "friction_force",
    "stick_vertices",
    "slip_vertices",
    "fixed_point_iterations",
    "convex_problems",
    "jump_vertices",
    "yielding_elements",
];

/// The document of a run in words; `case` is its scene and grid. Quantities without a value are omitted.
pub(in crate::cli) fn in_words(case: &str, document: &Value, dimension: usize) -> String {
    let wide = width(u16::MAX);
    let mut lines = vec![report::beside("", 0, &format!("{case}: {}", answer(document)), wide)];
    for (title, quantities) in GROUPS {
        let rows: Vec<(&str, String, &str)> = quantities
            .iter()
            .filter_map(|&(key, words, unit)| {
                let value = shown(key, &document[key], unit)?;
                Some((words, value, unit[usize::from(dimension == 3)]))
            })
            .collect();
        // A scene without Γ3 has zeros for its contact.
        let contact = title.starts_with("contact") && !has_contact(document);
        if rows.is_empty() || contact {
            continue;
        }
        lines.push(format!("\n{title}"));
        lines.extend(rows.iter().map(|(words, value, unit)| {
            let gap = " ".repeat(WORDS.saturating_sub(words.chars().count()));
            let label = format!("  {words}{gap}");
            match value.chars().count() > VALUE {
                true => report::beside(&label, WORDS + 2, &format!("{value} {unit}"), wide),
                false => format!("{label}{value:<VALUE$} {unit}").trim_end().to_owned(),
            }
        }));
    }
    lines.join("\n")
}

/// Width of the words before a value, and of a value.
const WORDS: usize = 36;
const VALUE: usize = 12;

fn has_contact(document: &Value) -> bool {
    document["normal_displacement"].as_array().is_some_and(|rows| !rows.is_empty())
}

/// The first sentence.
fn answer(document: &Value) -> String {
    let number = |key: &str| document[key].as_f64().map_or_else(|| "–".into(), |v| digits(v, 4));
    let sure = format!("solved to a residual of {}", number("kkt_residual"));
    if !document["norm"].is_null() {
        return format!(
            "‖u‖ = {} with an error of at most {}; {sure}.",
            number("norm"),
            number("V_max")
        );
    }
    if !has_contact(document) {
        return format!("‖ε(u)‖ = {}, no contact side; {sure}.", number("strain_norm"));
    }
    let of = document["normal_displacement"].as_array().map_or(0, Vec::len);
    let (force, locked) = (number("contact_force"), document["locked_vertices"].as_u64());
    let locked = locked.unwrap_or(0);
    format!(
        "the contact force is {force}, and {locked} of {of} contact vertices are at the obstacle; {sure}."
    )
}

/// A printed value; None if the scene has none.
fn shown(key: &str, value: &Value, unit: Unit) -> Option<String> {
    let number = |value: f64| match unit {
        MEBIBYTES => format!("{:.0}", value / (1024.0 * 1024.0)),
        SECONDS => digits(value, 3),
        _ => digits(value, 7),
    };
    if ZERO_IS_NOTHING.contains(&key) && is_zero(value) {
        return None;
    }
    match value {
        Value::Null => None,
        Value::String(text) => Some(text.clone()),
        Value::Array(items) => {
            let part = |item: &Value| {
                item.as_f64().map_or_else(|| item.as_str().unwrap_or("–").into(), number)
            };
            let parts: Vec<String> = items.iter().map(part).collect();
            (!parts.is_empty()).then(|| parts.join(", "))
        }
        other => Some(match other.as_u64() {
            Some(count) if unit != MEBIBYTES => count.to_string(),
            _ => other.as_f64().map_or_else(|| "–".into(), number),
        }),
    }
}

fn is_zero(value: &Value) -> bool {
    match value {
        Value::Array(items) => items.iter().all(is_zero),
        other => other.as_f64() == Some(0.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn what_a_scene_lacks_is_not_said() {
        let rows = json!([[0.0, 0.0, 0.1], [0.5, 0.0, 0.2]]);
        let pressed = json!({
            "contact_force": 0.25, "locked_vertices": 1, "normal_displacement": rows,
            "strain_norm": 0.5, "min_normal_gap": null, "jump_vertices": 0, "kkt_residual": 1e-16,
            "friction_force": [0.0, 0.0], "stick_vertices": 0,
            "seconds": 0.5, "peak_resident_bytes": 1_048_576,
        });
        let text = in_words("punch, n = 2, N = 1", &pressed, 2);
        let first = text.lines().next().expect("a line");
        assert!(first.contains("force is 0.25") && first.contains("1 of 2 contact"), "{first}");
        assert!(text.contains("0.25         stress · length\n"), "{text}");
        assert!(!text.contains("null") && !text.contains("jump") && !text.contains("distance"));
        assert!(!text.contains("friction") && !text.contains("stick"), "{text}");
        assert!(in_words("box", &pressed, 3).contains("stress · length²"));
        // Zeros without Γ3 are not a contact.
        let free = json!({ "contact_force": 0.0, "normal_displacement": [], "strain_norm": 0.5 });
        let text = in_words("free", &free, 2);
        assert!(text.starts_with("free: ‖ε(u)‖ = 0.5, no contact side") && !text.contains("force"));
    }

    /// Keys without words: lists of vertices.
    const LISTS: [&str; 2] = ["normal_displacement", "compliance_pressure"];

    /// The keys of the reference (tested elsewhere to be complete) all have words.
    #[test]
    fn every_key_of_a_body_has_words() {
        let page = include_str!("../../../docs/JSON.md");
        let section = page.split("\n## solve\n").nth(1).and_then(|rest| rest.split("\n## ").next());
        let rows = section.expect("a section").lines().filter_map(|row| row.strip_prefix("| `"));
        let keys: Vec<&str> = rows.filter_map(|row| row.split('`').next()).collect();
        let known: Vec<&str> =
            GROUPS.iter().flat_map(|group| group.1).map(|entry| entry.0).collect();
        let without: Vec<&&str> =
            keys.iter().filter(|key| !known.contains(key) && !LISTS.contains(key)).collect();
        assert!(keys.len() > 25 && without.is_empty(), "{without:?} of {keys:?}");
    }

    #[test]
    fn no_quantity_is_named_twice() {
        let mut keys: Vec<&str> = GROUPS.iter().flat_map(|g| g.1).map(|entry| entry.0).collect();
        let count = keys.len();
        keys.sort_unstable();
        keys.dedup();
        assert_eq!(keys.len(), count);
        assert!(ZERO_IS_NOTHING.iter().all(|key| keys.contains(key)));
    }
}
