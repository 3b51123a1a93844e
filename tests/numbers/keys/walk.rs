//! The keys that a scene accepts, from what the reader says of one that it does not know.

use std::collections::BTreeSet;

use scene::{Scene, Source};

/// Every part of a scene of a body; what does not go together is refused after the keys.
const BODY: &str = r#"
[scene]
name = "all"
question = "?"
dimension = 2
[domain]
shape = "rectangle"
[domain.mesh]
kind = "structured"
[time]
horizon = 1.0
[time.grid]
kind = "uniform"
[time.rule]
kind = "trapezoid"
[material]
lambda = 1.0
[material.elasticity]
kind = "full"
[material.memory]
lambda = 1.0
[material.memory.kernel]
kind = "prony"
[[material.memory.terms]]
lambda = 1.0
[material.projection]
mu = 1.0
kappa = "1"
[[material.region]]
name = "part"
[material.region.elasticity]
kind = "full"
[material.region.memory]
lambda = 1.0
[[material.region.memory.terms]]
lambda = 1.0
[contact]
quadrature = "vertex"
[contact.law]
kind = "none"
[contact.friction]
[contact.friction.bound]
kind = "slip"
[discretization]
element = "P1"
[loads]
body = []
[exact]
u = []
[sweep]
n = []
[sweep.reference]
n = 1
steps = 1
[[predicts]]
norm = "V_max"
variable = "h"
order = 1.0
why = "?"
"#;

/// An abstract scene with every key.
const ABSTRACT: &str = r#"
[scene]
name = "all"
kind = "abstract"
question = "?"
dimension = 1
[time]
horizon = 1.0
[space]
inner_product = []
[operator]
matrix = []
[history]
[[history.kernels]]
q = "1"
[phi]
force = []
[[trace]]
functional = []
[exact]
u = []
[sweep]
steps = []
"#;

/// Parts of an abstract scene that it shares with a body, by name and by type.
const SHARED: [&str; 3] = ["scene", "time", "predicts"];

/// Dotted names without numbers, those of abstract scenes after `abstract`.
pub fn keys() -> BTreeSet<String> {
    let mut found = parts(BODY, "");
    let unshared =
        |key: &String| !SHARED.iter().any(|part| in_part(key, &format!("abstract.{part}")));
    found.extend(parts(ABSTRACT, "abstract.").into_iter().filter(unshared));
    found
}

fn in_part(key: &str, part: &str) -> bool {
    key == part || key.strip_prefix(part).is_some_and(|rest| rest.starts_with('.'))
}

/// The keys of all parts of a text; a part is none of them.
fn parts(text: &str, prefix: &str) -> BTreeSet<String> {
    let headers: Vec<&str> = text.lines().filter(|line| line.starts_with('[')).collect();
    let names: Vec<&str> =
        headers.iter().map(|header| header.trim_matches(|c| c == '[' || c == ']')).collect();
    let mut found = BTreeSet::new();
    let top = known(&format!("{text}\n[zzz]\nzzz = 1\n"));
    for part in &top {
        let tied_elsewhere = names.contains(&part.as_str()) || SHARED.contains(&part.as_str());
        assert!(tied_elsewhere, "the part [{part}] is not walked");
    }
    for (header, name) in headers.iter().zip(&names) {
        let at = format!("{header}\n");
        assert_eq!(text.matches(&at).count(), 1, "{header}");
        for key in known(&text.replace(&at, &format!("{header}\nzzz = 1\n"))) {
            let key = format!("{name}.{key}");
            if !names.contains(&key.as_str()) {
                found.insert(format!("{prefix}{key}"));
            }
        }
    }
    found
}

/// The names that the reader knows where it meets one that it does not.
fn known(text: &str) -> Vec<String> {
    let refused = Scene::from_source(Source::from_text("manufactured/edited.toml", text));
    let said = refused.expect_err("an unknown key").to_string();
    let (_, list) = said.split_once("known here: ").unwrap_or_else(|| panic!("{said}"));
    list.lines().next().unwrap_or_default().split(", ").map(|key| key.trim().to_owned()).collect()
}
