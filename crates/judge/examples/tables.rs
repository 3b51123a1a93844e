//! Reads tables, a JSON object with `text` and what a caller says of it in each line of standard input, and prints what each says as
//! a line of JSON: `tests/fuzz/tables.py` compares it with a reader of its own.

use std::io::{BufRead, Write};
use std::time::Instant;

use gronwall_judge::table::{Group, Reading, Row, read};
use serde_json::{Value, json};

fn said(asked: &Value) -> Value {
    let list = |key: &str| {
        let all = asked[key].as_array().into_iter().flatten();
        all.filter_map(Value::as_str).map(str::to_owned).collect()
    };
    let reading = Reading {
        dimension: asked["dimension"].as_u64().and_then(|d| u32::try_from(d).ok()),
        ratio: asked["ratio"].as_f64(),
        in_time: asked["in_time"] == true,
        runs: asked["runs"] == true,
        by: list("by"),
        errors: list("errors"),
    };
    let began = Instant::now();
    let found = read(asked["text"].as_str().unwrap_or_default().as_bytes(), &reading);
    let row = |row: &Row| json!([row.line, row.point.h, row.point.k, row.point.error, row.gap]);
    let table = |group: &Group| {
        let rows: Vec<Value> = group.rows.iter().map(row).collect();
        json!({"scene": group.scene, "norm": group.norm, "rows": rows})
    };
    let mut answer = match found {
        Ok(tables) => {
            let groups: Vec<Value> = tables.groups.iter().map(table).collect();
            json!({"said": tables.said, "tables": groups})
        }
        Err(why) => json!({"refused": why.to_string()}),
    };
    answer["seconds"] = began.elapsed().as_secs_f64().into();
    answer
}

fn main() -> std::io::Result<()> {
    let mut out = std::io::BufWriter::new(std::io::stdout());
    for line in std::io::stdin().lock().lines() {
        writeln!(out, "{}", said(&serde_json::from_str(&line?)?))?;
    }
    out.flush()
}
