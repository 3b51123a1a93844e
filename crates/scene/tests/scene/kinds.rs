//! Source: the kinds of tables, beside what reads them, and the table of keys.
//! Goal: each key of a table with kinds is one of another kind somewhere, or it would be accepted and never read.
//! Data: all keys of src/keys.toml, each in a table of every kind.

use super::good::{LOADED, refused};

/// A valid text up to the table, and what follows it.
fn around(table: &str) -> (String, String) {
    let elasticity = "lambda = 1.0\nmu_L = 1.0\n[material.memory]";
    let (from, before, after) = match table {
        "time.grid" => ("grid = { kind = \"uniform\" }", "grid = ", ""),
        "time.rule" => ("grid = { kind = \"uniform\" }", "rule = ", ""),
        "domain.mesh" => ("mesh = { kind = \"structured\" }", "mesh = ", ""),
        "material.elasticity" => (elasticity, "elasticity = ", "\n[material.memory]"),
        "material.memory.kernel" => ("kernel = \"-exp(-t)\"", "kernel = ", ""),
        "contact.law" => ("gap = \"0.10\"\nlaw = ", "law = ", "\n#"),
        "contact.friction.bound" => {
            ("quadrature = \"vertex\"", "friction = { bound = ", " }\nquadrature = \"vertex\"")
        }
        other => panic!("no scene with [{other}]"),
    };
    let (start, end) = LOADED.split_once(from).expect(from);
    (format!("{start}{before}"), format!("{after}{end}"))
}

#[test]
fn tables_have_the_keys_of_their_kinds() {
    let keys: toml::Table = include_str!("../../src/keys.toml").parse().unwrap();
    let words = |value: &toml::Value| value.as_str().unwrap().to_owned();
    let mut tables = 0;
    for part in keys["part"].as_array().unwrap() {
        let rows = part["rows"].as_array().unwrap().iter();
        let keys =
            rows.flat_map(|row| words(&row[0]).split(' ').map(str::to_owned).collect::<Vec<_>>());
        let mut keys = keys.peekable();
        if keys.next_if(|first| first == "kind").is_none() {
            continue;
        }
        tables += 1;
        let (start, end) = around(&words(&part["tables"][0]));
        let said = |table: &str| refused(&format!("{start}{table}{end}"));
        let unknown = said("{ kind = \"?\" }").hint;
        let kinds: Vec<&str> = unknown.strip_prefix("known: ").unwrap().split(", ").collect();
        for key in keys {
            let refuses = |kind: &&str| {
                let said = said(&format!("{{ kind = \"{kind}\", {key} = 1 }}"));
                said.message == format!("kind `{kind}` takes no `{key}`")
            };
            assert!(kinds.iter().any(refuses), "{key} of {kinds:?}");
        }
    }
    assert_eq!(tables, 7);
}
