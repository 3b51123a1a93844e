//! `sweep case`: some cases of a plan in this process.

use std::path::PathBuf;

use clap::Args;

use super::interrupt::on_interrupt;
use super::machine::Allowance;
use super::{CliError, print_text};
use files::{counted, quoted};
use run::distributed::{CaseRow, PartRun, SweepPlan, failed_in_words, run_part};
use run::sweep::Machine;

/// `sweep case`.
#[derive(Args)]
#[command(
    after_help = "The scenes are those whose texts the plan keeps; a file of them that has changed since, another version of the program, an id or job that the plan does not have are refused. DIR gets provenance.json, verdict.json where a case failed (the reasons), and at last cases.csv, each in one step: if the process is killed before, DIR has no records, and the same command goes on with the cases that were not finished. Complete records of the same plan in DIR are kept.\n\nExit codes: 0 the records are written (a case whose solver gave up is recorded as failed, and `sweep merge` answers 2), 2 bad input, or more memory predicted than there is.\n\nExamples:\n  sweep case pure-mild:n16:N4 affine:n2:N8 --plan big --out part\n  sweep case --job 17 --plan big --out big/parts/17"
)]
pub(crate) struct CaseCommand {
    /// Ids of cases, from plan.csv
    #[arg(value_name = "ID", required_unless_present = "job")]
    ids: Vec<String>,
    /// All cases of these jobs
    #[arg(long, value_name = "JOB", value_delimiter = ',')]
    job: Vec<usize>,
    /// Directory that `sweep plan` wrote
    #[arg(long, value_name = "DIR")]
    plan: PathBuf,
    /// Directory for the records
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    #[command(flatten)]
    allowance: Allowance,
}

impl CaseCommand {
    pub(super) fn execute(&self) -> Result<u8, CliError> {
        let plan = SweepPlan::read(&self.plan).map_err(CliError::other)?;
        let rows = plan.rows(&self.plan, &self.ids, &self.job).map_err(CliError::other)?;
        on_interrupt(&self.out, &self.again())?;
        let progress = super::progress::Display::new();
        let (memory, options) = (self.allowance.limit(), self.options(&rows));
        let machine = Machine { jobs: 1, memory, build: super::BUILD, options };
        let run = run_part(&plan, &self.plan, &rows, &self.out, &machine, &progress);
        let PartRun { records, known } = run.map_err(CliError::other)?;
        if let Some(failed) = failed_in_words(&records) {
            super::progress::note(&format!("warning: {failed}"));
        }
        let out = self.out.display();
        print_text(&match known {
            true => format!("{} in {out}, recorded before", counted(records.len(), "case")),
            false => format!("{} in {out}", counted(records.len(), "case")),
        });
        Ok(0)
    }

    /// Options for the provenance: jobs by number, of cases only their count.
    fn options(&self, rows: &[CaseRow]) -> String {
        let jobs: Vec<String> = self.job.iter().map(usize::to_string).collect();
        match jobs.is_empty() {
            true => format!("case: {}", counted(rows.len(), "id")),
            false => format!("case --job {}", jobs.join(",")),
        }
    }

    /// The command line that runs these cases again.
    fn again(&self) -> String {
        let jobs: Vec<String> = self.job.iter().map(usize::to_string).collect();
        let mut words = vec!["sweep case".to_owned()];
        words.extend(self.ids.iter().map(|id| quoted(id)));
        words.extend((!jobs.is_empty()).then(|| format!("--job {}", jobs.join(","))));
        for (name, path) in [("--plan", &self.plan), ("--out", &self.out)] {
            words.push(format!("{name} {}", quoted(&path.display().to_string())));
        }
        words.join(" ")
    }
}
