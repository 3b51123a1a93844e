//! `sweep extremes`: ladders from ordinary to extreme parameters, each rung against its expectation.

use std::path::PathBuf;

use clap::Args;

use super::machine::Common;
use super::study::deliver;
use super::{CliError, create_dir, print_text, width, write_file};
use files::counted;
use studies::extremes::{Climbed, Ladder, RungRow, UnderTest, admit, catalogue, csv, judge};

const WIDTH: u16 = 132;

/// `sweep extremes`.
#[derive(Args)]
#[command(
    after_help = "Exit code: 0 every rung as expected; 1 a rung is not; 2 no such ladder, or --out cannot be written.\n\nJSON keys with --json: ladders (name, parameter, quantity, why), rungs (ladder, at, quantity, expected, measured: null without an answer, digits_lost, iterations: per level, kkt, standing: \"as-expected\", \"refused-as-expected\", \"not-as-expected\" or \"failed\", note, seconds).\n\nFiles with --out: extremes.csv (a row as each rung ends), extremes.json, extremes.svg (the map)."
)]
pub(crate) struct Extremes {
    /// Ladders to climb [default: all]; --list names them
    ladder: Vec<String>,
    /// Climb to the largest meshes as well: some minutes
    #[arg(long)]
    long: bool,
    /// List the ladders with what they expect, and run nothing
    #[arg(long)]
    list: bool,
    #[command(flatten)]
    common: Common,
    /// Directory for extremes.csv, extremes.json and extremes.svg
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
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
        let mut rows = Vec::new();
        self.write(&rows)?;
        for ladder in &ladders {
            let rungs = counted(ladder.rungs.len(), "rung");
            super::progress::note(&format!("{}: {rungs}", ladder.name));
            for rung in &ladder.rungs {
                rows.push(judge(ladder, rung, &under_test));
                self.write(&rows)?;
            }
        }
        let climbed = Climbed { ladders, rungs: rows };
        deliver(&climbed, &climbed.document(), self.out.as_deref(), self.common.json)?;
        Ok(u8::from(!climbed.holds()))
    }

    /// Writes the rows so far.
    fn write(&self, rows: &[RungRow]) -> Result<(), CliError> {
        let Some(dir) = &self.out else { return Ok(()) };
        create_dir(dir)?;
        write_file(&dir.join("extremes.csv"), csv(rows).map_err(CliError::other)?)
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
