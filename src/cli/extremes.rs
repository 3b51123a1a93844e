//! `sweep extremes`: ladders from ordinary to extreme parameters, each rung against its expectation.

use std::path::PathBuf;

use clap::Args;

use super::machine::Common;
use super::study::show;
use super::{CliError, create_dir, print_text, width, write_file};
use files::counted;
use judge::claim::Claim;
use studies::extremes::{Climbed, Ladder, UnderTest, admit, catalogue, climb, found};

const WIDTH: u16 = 132;

/// `sweep extremes`.
#[derive(Args)]
#[command(
    after_help = "Exit codes: 0 every rung (one value of a ladder's parameter) is as expected; 1 a rung is not; 2 there is no such ladder, or --out cannot be written.\n\nJSON keys with --json: holds, claims (line: the ladder, or KKT; says, n, steps, level, at: the rung, left: what was measured, null without an answer, relation, right, low, difference, accuracy, tightness, standing, holds, note: the refusal, a remark, or why not), ladders (name, parameter, quantity, why), rungs (ladder, at, iterations: per level, seconds).\n\nFiles with --out: extremes-claims.csv (as each rung ends), extremes.json, extremes.svg (the map)."
)]
pub(crate) struct Extremes {
    /// Ladders (one parameter taken to its extreme) to run [default: all]; --list names them
    ladder: Vec<String>,
    /// Also run the largest meshes, which takes some minutes
    #[arg(long)]
    long: bool,
    /// List the ladders and what they expect, without running them
    #[arg(long)]
    list: bool,
    /// Directory for extremes-claims.csv, extremes.json and extremes.svg, which replace those of an earlier run
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    common: Common,
}

impl Extremes {
    pub(super) fn execute(&self) -> Result<u8, CliError> {
        let ladders = self.chosen()?;
        if self.list {
            print_text(&listed(&ladders));
            return Ok(0);
        }
        let under_test = UnderTest::default();
        let limit = self.common.allowance.limit();
        for ladder in &ladders {
            ladder.rungs.iter().try_for_each(|rung| admit(ladder, rung, &under_test, &limit))?;
        }
        let mut climbed = Vec::new();
        self.write(&climbed)?;
        for ladder in &ladders {
            let rungs = counted(ladder.rungs.len(), "rung");
            super::progress::note(&format!("{}: {rungs}", ladder.name));
            for rung in &ladder.rungs {
                climbed.push(climb(ladder, rung, &under_test));
                self.write(&climbed)?;
            }
        }
        show(&found(&ladders, &climbed), self.out.as_deref(), self.common.json)
    }

    /// Writes the claims so far.
    fn write(&self, climbed: &[Climbed]) -> Result<(), CliError> {
        let Some(dir) = &self.out else { return Ok(()) };
        create_dir(dir)?;
        let claims: Vec<Claim> = climbed.iter().flat_map(|rung| rung.claims.clone()).collect();
        let csv = Claim::csv(&claims).map_err(CliError::other)?;
        write_file(&dir.join("extremes-claims.csv"), csv)
    }

    fn chosen(&self) -> Result<Vec<Ladder>, CliError> {
        let all = catalogue(self.long);
        let names: Vec<&str> = all.iter().map(|ladder| ladder.name).collect();
        if let Some(unknown) = self.ladder.iter().find(|name| !names.contains(&name.as_str())) {
            let message = format!("no ladder `{unknown}`; there are {}", names.join(", "));
            return Err(CliError::other(message));
        }
        let named = |ladder: &Ladder| {
            self.ladder.is_empty() || self.ladder.iter().any(|name| name == ladder.name)
        };
        Ok(all.into_iter().filter(named).collect())
    }
}

fn listed(ladders: &[Ladder]) -> String {
    let row = |ladder: &Ladder| {
        let rungs = ladder.rungs.len().to_string();
        [ladder.name, ladder.parameter, &rungs, ladder.quantity, ladder.why].map(str::to_owned)
    };
    let rows: Vec<Vec<String>> = ladders.iter().map(|ladder| row(ladder).into()).collect();
    let heads = ["ladder", "parameter", ">rungs", "measured", "expected because"];
    report::text_table(&heads, &rows, width(WIDTH))
}
