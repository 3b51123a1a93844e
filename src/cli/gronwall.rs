//! `sweep gronwall`: truncation errors, envelopes and their effectivities, horizons, perturbations.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::Value;

use super::machine::Allowance;
use super::{CliError, Scenes, create_dir, print_json, print_text, write_file, write_json};
use run::sweep::admit_constants;
use scene::Scene;
use scene::setup::Subject;
use studies::theory::gronwall::{HorizonRow, Plan, StudiedGrid, Study, maximum, study_runs};

/// `sweep gronwall`.
#[derive(Args)]
#[command(
    after_help = "Effectivity = bound / measured error. The chain e <= weighted envelope <= primed envelope <= closed form, primed <= printed envelope <= its closed form is checked at every n of every run; exit code 1 names the first n at which a link fails.\n\nJSON keys with --json: scene, fingerprint (of its text), n, truth, constants (m0, beta_phi, lipschitz = |R||q| or that of S, C1, C2; of a body: yielding = mu L_kappa sqrt|Omega|, memory_norm, c_j_squared_bound; abstract: m_A, alpha_phi, alpha_j, c_j_squared, r_norm, q_norm), grids (steps, k, C2_k, error_end, error_max, truncation_end, truncation_max, floor, effectivity of weighted, primed, closed, limit, printed, printed_closed: each at_end, of_maxima, least), horizons (k, truth, rows: horizon, steps, error, truncation, weighted, primed, closed, printed, printed_closed, c2, growth), perturbations (shape, size, steps, load, difference, growth, weighted, primed, least_effectivity), violations (part, link, n, t, left, right), verdict.\n\nFiles with --out: SCENE-gronwall.csv (every level of every run), SCENE-gronwall.json, SCENE-gronwall-*.svg."
)]
pub struct Gronwall {
    /// Name of a scene, or path of a TOML file
    scene: String,
    /// Cells per unit length, h = 1/n; abstract scenes have none [default: the first of the scene's list]
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=4096))]
    n: Option<u32>,
    /// Numbers N of time steps, k = T/N [default: the scene's list up to 1024]
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(1..=100_000))]
    steps: Option<Vec<u32>>,
    /// Horizons T at the step of the largest N, multiples of it
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    horizons: Vec<f64>,
    #[command(flatten)]
    allowance: Allowance,
    /// Print JSON
    #[arg(long)]
    json: bool,
    /// Directory for SCENE-gronwall.csv, SCENE-gronwall.json and the pictures
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// Of the scene's own list, no more steps than this: the weighted envelope takes O(N²).
const MOST_STEPS: u32 = 1024;

impl Gronwall {
    pub(super) fn execute(&self, scenes: &Scenes) -> Result<u8, CliError> {
        let scene = scenes.scene(&self.scene)?;
        let plan = self.plan(&scene)?;
        if let Some(n) = plan.n.filter(|_| scene.as_contact().is_some()) {
            scene.check_cells(n)?;
        }
        let fingerprint = scene.source.hash.clone();
        admit_constants(&scene, true, &self.allowance.limit())?;
        let subject = Subject::new(scene)?;
        // An abstract problem keeps a few numbers a level.
        if let (Subject::Contact(setup), Some(n)) = (&subject, plan.n) {
            study_runs(setup, n, &plan).admit(&self.allowance.limit())?;
        }
        let study = Study::run(&subject, plan).map_err(CliError::other)?;
        let mut document = study.json();
        document["fingerprint"] = fingerprint.into();
        if let Some(dir) = &self.out {
            write(dir, &study, &document)?;
        }
        if self.json {
            print_json(&document)?;
        } else {
            print(&study);
        }
        Ok(u8::from(!study.violations().is_empty()))
    }

    fn plan(&self, scene: &Scene) -> Result<Plan, CliError> {
        let sweep = scene.sweep.as_ref();
        let own = |list: &[usize]| list.iter().map(|&v| v as u32).collect::<Vec<u32>>();
        let n = self.n.or_else(|| sweep.and_then(|sweep| own(&sweep.n).first().copied()));
        let listed = |list: &[usize]| {
            let mut list = own(list);
            list.retain(|&steps| steps <= MOST_STEPS);
            list
        };
        let steps = self.steps.clone().or_else(|| sweep.map(|sweep| listed(&sweep.steps)));
        let Some(mut steps) = steps.filter(|steps| !steps.is_empty()) else {
            return Err(CliError::other("no numbers of steps: give --steps 16,32,64"));
        };
        steps.sort_unstable();
        steps.dedup();
        Ok(Plan { n, steps, horizons: self.horizons.clone() })
    }
}

fn write(dir: &Path, study: &Study, document: &Value) -> Result<(), CliError> {
    create_dir(dir)?;
    let file = |name: &str, bytes: &[u8]| write_file(&dir.join(name), bytes);
    file(&format!("{}-gronwall.csv", study.scene), &study.csv().map_err(CliError::other)?)?;
    write_json(&dir.join(format!("{}-gronwall.json", study.scene)), document)?;
    for (stem, svg) in study.pictures()? {
        file(&format!("{}-{stem}.svg", study.scene), svg.as_bytes())?;
    }
    Ok(())
}

fn print(study: &Study) {
    let c = &study.constants;
    let mesh = study.plan.n.map_or_else(String::new, |n| format!(", n = {n}"));
    print_text(&format!("{}{mesh}; truth: {}", study.scene, study.truth));
    let details = c.details.iter().map(|(name, value)| format!(", {name} = {value:.6}"));
    print_text(&format!(
        "m0 = {:.6}, beta_phi = {:.6}{}",
        c.m0,
        c.beta,
        details.collect::<String>()
    ));
    print_text(&format!("C1 = {:.6}, C2 = {:.6}, lipschitz = {:.6}", c.c1(), c.c2(), c.lipschitz));
    print_text("\nbound / error at t = T:");
    print_text(&format!(
        "{:>6} {:>10} {:>11} {:>11} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9}",
        "N", "C2 k", "e_N", "g_N", "weighted", "primed", "closed", "k -> 0", "printed", "closed"
    ));
    study.grids.iter().for_each(|own| print_text(&grid(own)));
    if let Some(horizons) = &study.horizons {
        print_text(&format!("\nhorizons, k = {}; truth: {}", horizons.k, horizons.truth));
        print_text("maxima over [0, T]; growth = d(log error)/dT, to compare with C2:");
        print_text(&format!(
            "{:>8} {:>11} {:>11} {:>11} {:>11} {:>11} {:>9} {:>9}",
            "T", "error", "weighted", "primed", "closed", "printed c.", "growth", "C2"
        ));
        horizons.rows.iter().for_each(|row| print_text(&horizon(row)));
    }
    print_text("\nperturbed loads at the largest N; growth = m0 max|u - v| / max|df|_*:");
    print_text(&format!(
        "{:>8} {:>8} {:>11} {:>11} {:>9} {:>12} {:>12}",
        "shape", "size", "max|df|_*", "max|u - v|", "growth", "least eff.", "primed bound"
    ));
    for own in &study.perturbations {
        let difference = maximum(&own.estimate.error);
        print_text(&format!(
            "{:>8} {:>8.0e} {:>11.4e} {:>11.4e} {:>9.4} {:>12} {:>12.4}",
            own.shape.name(),
            own.size,
            own.load,
            difference,
            own.growth(),
            ratio(own.least_effectivity()),
            maximum(&own.envelopes.primed) / difference
        ));
    }
    let violations = study.violations();
    if violations.is_empty() {
        print_text(
            "\nthe chain holds at every n: e <= weighted <= primed <= closed, primed <= printed",
        );
    }
    for (part, v) in violations {
        print_text(&format!(
            "VIOLATED {part}: {} at n = {} (t = {}): {:.6e} against {:.6e}",
            v.link, v.n, v.t, v.left, v.right
        ));
    }
}

fn grid(own: &StudiedGrid) -> String {
    let (estimate, envelopes) = (&own.run.estimate, &own.envelopes);
    let at_end = |bound: &[f64]| ratio(own.effectivity(bound).at_end);
    let printed = |bound: &Option<Vec<f64>>| bound.as_deref().map_or("C2 k >= 1".into(), at_end);
    let k = estimate.grid.largest_step();
    let last = |values: &[f64]| values.last().copied().unwrap_or(f64::NAN);
    format!(
        "{:>6} {:>10.6} {:>11.4e} {:>11.4e} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9}",
        own.run.steps,
        estimate.c2() * k,
        last(&estimate.error),
        last(&own.run.truncation()),
        at_end(&envelopes.weighted),
        at_end(&envelopes.primed),
        at_end(&envelopes.closed),
        at_end(&envelopes.limit),
        printed(&envelopes.printed),
        printed(&envelopes.printed_closed)
    )
}

fn horizon(row: &HorizonRow) -> String {
    let printed = row.printed_closed.map_or("C2 k >= 1".into(), |value| format!("{value:.4e}"));
    let growth = row.growth.map_or("-".into(), |value| format!("{value:.4}"));
    format!(
        "{:>8} {:>11.4e} {:>11.4e} {:>11.4e} {:>11.4e} {printed:>11} {growth:>9} {:>9.4}",
        row.horizon, row.error, row.weighted, row.primed, row.closed, row.c2
    )
}

fn ratio(value: Option<f64>) -> String {
    value.map_or("-".into(), |value| format!("{value:.4}"))
}
