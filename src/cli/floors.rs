//! `sweep floors`: measures the part of a scene's errors that is not the discretisation.

use std::cmp::Reverse;
use std::path::PathBuf;

use clap::Args;

use super::chosen::Grid;
use super::machine::Common;
use super::{
    CliError, Scenes, TABLE_WIDTH, create_dir, no_case, print_json, print_text, subject, width,
    write_json,
};
use run::sweep::{CasePlan, Cost, FloorRow, ScenePlan, admit_plan, floors_beside};

/// `sweep floors`.
#[derive(Args)]
#[command(
    after_help = "To measure a floor, one thing other than the discretisation is done better: solver (residual to 1/100 of the tolerance, or to rounding), history (direct sum in place of the recursion), load and error quadrature (the next rule), reference (a run with 16 N steps; for reference scenes a reference of half the cells and steps, its floor estimated likewise). Cases are the finest n with the fewest steps and the coarsest n with the most, unless --n and --steps name them.\n\nJSON keys with --json, one object per row: scene, n (null without mesh), steps, norm, part, error, measured, estimated (what the floor column of cases.csv holds for it), ratio (estimated over measured, null if nothing was measured). --out writes the same to floors.json."
)]
pub(crate) struct FloorsCommand {
    /// Name of a scene, or path of a TOML file
    scene: String,
    #[command(flatten)]
    grid: Grid,
    #[command(flatten)]
    common: Common,
    /// Directory for floors.json
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// A floor with its case.
type Measured<'a> = (&'a CasePlan, FloorRow);

impl FloorsCommand {
    pub(super) fn execute(&self, scenes: &Scenes) -> Result<u8, CliError> {
        let scene = scenes.scene(&self.scene)?;
        self.grid.check(&scene)?;
        let limit = self.common.allowance.limit();
        let mut plan = ScenePlan::new(subject(scene, &limit)?, &self.grid.overrides());
        if plan.cases.is_empty() {
            return Err(no_case(plan.scene(), "run"));
        }
        self.choose(&mut plan.cases);
        let beside = |cases: &[(&CasePlan, &Cost)]| floors_beside(plan.scene().dimension, cases);
        admit_plan(&plan, 1, &limit, beside)?;
        let measured = measure(&plan)?;
        let document = document(&plan.scene().name, &measured);
        if let Some(out) = &self.out {
            create_dir(out)?;
            write_json(&out.join("floors.json"), &document)?;
        }
        if self.common.json {
            print_json(&document)?;
        } else {
            print_text(&table(&measured));
        }
        Ok(0)
    }

    /// By default two of the scene's cases are measured.
    fn choose(&self, cases: &mut Vec<CasePlan>) {
        let largest = cases.iter().max_by_key(|case| (case.n, Reverse(case.steps)));
        let longest = cases.iter().max_by_key(|case| (case.steps, Reverse(case.n)));
        let chosen: Vec<CasePlan> = [largest, longest].into_iter().flatten().cloned().collect();
        if self.grid.is_own() {
            cases.retain(|case| chosen.contains(case));
        }
    }
}

fn measure(plan: &ScenePlan) -> Result<Vec<Measured<'_>>, CliError> {
    let mut measured = Vec::new();
    for case in &plan.cases {
        let rows = plan.floors(case).map_err(CliError::other)?;
        measured.extend(rows.into_iter().map(|row| (case, row)));
    }
    Ok(measured)
}

fn document(scene: &str, measured: &[Measured<'_>]) -> serde_json::Value {
    let row = |(case, row): &Measured<'_>| {
        serde_json::json!({
            "scene": scene,
            "n": case.n,
            "steps": case.steps,
            "norm": row.norm.name(),
            "part": row.part.name(),
            "error": row.error,
            "measured": row.measured,
            "estimated": row.estimated,
            "ratio": row.estimated / row.measured,
        })
    };
    measured.iter().map(row).collect()
}

fn table(measured: &[Measured<'_>]) -> String {
    let rows = measured.iter().map(|(case, row)| {
        let n = case.n.map_or("-".into(), |n| n.to_string());
        let words = [n, case.steps.to_string(), row.norm.name().into(), row.part.name().into()];
        let numbers = [row.error, row.measured, row.estimated, row.estimated / row.measured];
        words.into_iter().chain(numbers.map(|value| format!("{value:.1e}"))).collect()
    });
    let heads = [">n", ">N", "norm", "part", ">error", ">measured", ">estimated", ">ratio"];
    report::text_table(&heads, &rows.collect::<Vec<Vec<String>>>(), width(TABLE_WIDTH))
}
