//! `sweep audit --ledger`.

use std::path::Path;

use super::super::{CliError, Scenes, create_dir, print_json, print_text, write_json};
use scene::setup::Setup;
use studies::theory::ledger::{Entry, Finding, LedgerError, ledger};

impl From<LedgerError> for CliError {
    fn from(error: LedgerError) -> Self {
        Self::Other(error.to_string())
    }
}

pub(super) fn execute(scenes: &Scenes, json: bool, out: Option<&Path>) -> Result<u8, CliError> {
    let entries =
        ledger(|name| -> Result<Setup, CliError> { Ok(Setup::new(scenes.scene(name)?)?) })?;
    let document = serde_json::to_value(&entries).map_err(CliError::other)?;
    if let Some(dir) = out {
        create_dir(dir)?;
        write_json(&dir.join("ledger.json"), &document)?;
    }
    if json {
        print_json(&document)?;
    } else {
        for (number, entry) in entries.iter().enumerate() {
            print_text(&paragraph(number + 1, entry));
        }
    }
    Ok(u8::from(!entries.iter().all(|entry| entry.confirmed)))
}

fn paragraph(number: usize, entry: &Entry) -> String {
    let observed =
        entry.observed.map_or("nothing to fit".to_owned(), |value| format!("{value:.3}"));
    let used = entry.used.map_or(String::new(), |used| {
        format!("; at most {:.2} % of the bound is used", 100.0 * used)
    });
    let found = match (entry.confirmed, entry.claimed) {
        (true, Finding::Sharp) => "sharp",
        (true, Finding::Slack) => "slack",
        (false, _) => "NOT CONFIRMED",
    };
    format!(
        "{number}. {}\n   hypotheses  {}\n   measured    {}: proved {}, observed {observed}, {found}{used}\n   scene       {}\n   command     {}",
        entry.claim, entry.hypotheses, entry.quantity, entry.proved, entry.scene, entry.command
    )
}
