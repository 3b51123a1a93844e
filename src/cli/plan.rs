//! `sweep plan`: a sweep as jobs for many processes.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::chosen::Chosen;
use super::machine::{processors, seconds};
use super::{CliError, Scenes, print_json, print_text};
use files::{counted, quoted};
use run::distributed::{Engine, PlannedCases, Planning};
use run::sweep::{MemoryLimit, Overrides, ScenePlan};
use scene::Scene;

/// What runs the jobs.
#[derive(Clone, Copy, ValueEnum)]
enum Format {
    /// A Snakefile, for one machine, Slurm, Kubernetes or a cloud by Snakemake's executors
    Snakemake,
    /// Job arrays of Slurm: submit.sh and array.sh
    Slurm,
    /// The tables alone
    Csv,
}

/// `sweep plan`.
#[derive(Args)]
#[command(
    after_help = "Written into DIR: plan.json (version, arguments, the scenes with their texts and hashes), plan.csv (id, scene, n, steps, seconds, bytes, job; the longest job first, and in it the longest case), jobs.csv (job, cases, seconds, bytes, mem_mb, runtime in minutes), and the files of the format. Seconds are CPU seconds and bytes peak memory as `sweep explain` predicts them; mem_mb and runtime are these with a margin.\n\nJSON keys with --json: cases, jobs, scenes, seconds, longest_seconds, largest_bytes.\n\nExamples:\n  sweep plan --all --out big --format snakemake && cd big && snakemake --cores 8\n  sweep plan pure-mild --n 8,16,32,64 --steps 4,8,16 --out big --format slurm && big/submit.sh\n  sweep plan punch --out big && sweep case --job 0 --plan big --out big/parts/0\n\nThen: sweep merge DIR/parts --plan DIR --out DIR/merged"
)]
pub(crate) struct PlanCommand {
    #[command(flatten)]
    chosen: Chosen,
    /// Directory for the plan
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// What runs the jobs
    #[arg(long, value_enum, default_value = "csv")]
    format: Format,
    /// Cases share a job up to this many predicted CPU seconds, since an engine takes seconds to start one. A longer case
    /// is a job by itself
    #[arg(long, value_name = "S", default_value_t = 60.0, value_parser = seconds)]
    seconds: f64,
    /// Print the size of the plan as JSON
    #[arg(long)]
    json: bool,
}

impl PlanCommand {
    pub(super) fn execute(&self, scenes: &Scenes) -> Result<u8, CliError> {
        let grid = &self.chosen.grid;
        let overrides = Overrides { n: once(&grid.n), steps: once(&grid.steps) };
        let limit = MemoryLimit::of_machine();
        let selected = scenes.select(&self.chosen.scenes)?;
        different_names(&selected)?;
        // Only predictions are kept.
        let planned = |plan: ScenePlan| Ok(PlannedCases::new(&plan)?);
        let planned = self.chosen.plans(selected, &overrides, &limit, planned)?;
        if planned.is_empty() {
            return Err(Chosen::none(scenes, "plan"));
        }
        let planning = Planning::new(planned, overrides, self.seconds);
        let engine = match self.format {
            Format::Snakemake => Engine::Snakemake,
            Format::Slurm => Engine::Slurm,
            Format::Csv => Engine::Tables,
        };
        planning.write(&self.out, engine).map_err(CliError::other)?;
        self.print(&planning)?;
        Ok(0)
    }

    fn print(&self, planning: &Planning) -> Result<(), CliError> {
        let jobs = &planning.jobs;
        let seconds: f64 = jobs.iter().map(|job| job.seconds).sum();
        let longest = jobs.iter().map(|job| job.seconds).fold(0.0, f64::max);
        let bytes = jobs.iter().map(|job| job.bytes).fold(0.0, f64::max);
        let plan = &planning.plan;
        if self.json {
            return print_json(&serde_json::json!({
                "cases": plan.cases, "jobs": plan.jobs, "scenes": plan.scenes.len(),
                "seconds": seconds, "longest_seconds": longest, "largest_bytes": bytes,
            }));
        }
        print_text(&format!(
            "{} of {} in {}; predicted: {seconds:.0} CPU seconds in all, {longest:.1} in the longest job, {:.0} MB in the largest",
            counted(plan.cases, "case"),
            counted(plan.scenes.len(), "scene"),
            counted(plan.jobs, "job"),
            bytes / 1e6
        ));
        print_text(&self.next());
        Ok(())
    }

    /// The next steps for the user.
    fn next(&self) -> String {
        let dir = quoted(&self.out.display().to_string());
        let run = match self.format {
            Format::Snakemake => format!("cd {dir} && snakemake --cores {}", processors()),
            Format::Slurm => format!("{dir}/submit.sh"),
            Format::Csv => {
                format!("sweep case --job 0 --plan {dir} --out {dir}/parts/0   (and so on)")
            }
        };
        format!("run: {run}\nthen: sweep merge {dir}/parts --plan {dir} --out {dir}/merged")
    }
}

/// Removes repetitions, keeping the order.
fn once(list: &Option<Vec<u32>>) -> Option<Vec<u32>> {
    let mut seen = std::collections::BTreeSet::new();
    list.as_ref().map(|list| list.iter().copied().filter(|&value| seen.insert(value)).collect())
}

/// Refuses scenes of equal names, since records identify scenes by name.
fn different_names(scenes: &[Scene]) -> Result<(), CliError> {
    let mut seen = std::collections::BTreeSet::new();
    let Some(twice) = scenes.iter().find(|scene| !seen.insert(&scene.name)) else { return Ok(()) };
    let message = "two scenes of this name are to be planned";
    let hint = "name each scene once; a plan holds one text of it";
    Err(twice.error("scene.name", message, hint).into())
}
