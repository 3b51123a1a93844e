//! `sweep bound`: the step-size bound (3.4) in four numbers, with every constant behind it.

use std::path::PathBuf;

use clap::Args;
use serde_json::{Value, json};

use super::machine::Allowance;
use super::{CliError, Scenes, create_dir, print_json, print_text, write_file, write_json};
use scene::setup::Subject;
use studies::theory::bound::Bound;
use studies::theory::bound::contact::study_runs;
use studies::theory::bound::ladder::{Outcome, Rung};
use studies::theory::bound::threshold::Crossing;

/// `sweep bound`.
#[derive(Args)]
#[command(
    after_help = "JSON keys with --json: scene, fingerprint (of its text), n, steps, constants (name, value, uncertainty, how, safe, note), samples (what, declared, needed, samples, holds), thresholds (paper_norm, theorem, sharpened, solvable, norm_one, radius_one, loss, loss_reason, loss_eigenvalue, loss_tensors, loss_mesh, not_followed: why norm_one, radius_one and loss are null and rungs is empty, where m0 <= 0), ratio, attained, worst, levels, meshes (mesh, level, t, k, norm, radius, sharpened), starts (same, distinct, failed), rungs (k, norm, radius, rightmost, distinct, finite_worst, finite_random, sharpened, theorem, paper_norm, newton, fixed_point, at_solution), violations (k, what, left, right). Exit code 1: an inequality or a declared constant does not hold."
)]
pub struct BoundCommand {
    /// Name of a scene, or path of a TOML file
    scene: String,
    /// Cells per unit length of the mesh on which the factors are measured, h = 1/n [default: 16]
    #[arg(long, value_parser = clap::value_parser!(u32).range(2..=128))]
    n: Option<u32>,
    /// Number N of time steps of the run whose worst level is studied [default: the scene's smallest]
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    steps: Option<u32>,
    #[command(flatten)]
    allowance: Allowance,
    /// Print JSON
    #[arg(long)]
    json: bool,
    /// Write SCENE-bound.json and SCENE-bound.svg into this directory
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// The mesh of the factors, where none is named.
const MESH: u32 = 16;

impl BoundCommand {
    pub(super) fn execute(&self, scenes: &Scenes) -> Result<u8, CliError> {
        let subject = scenes.subject(&self.scene, &self.allowance.limit())?;
        let scene = subject.scene();
        let own = scene.sweep.as_ref().and_then(|sweep| sweep.steps.iter().min().copied());
        let steps = self.steps.unwrap_or(own.unwrap_or(8) as u32);
        let bound = match &subject {
            Subject::Contact(setup) => {
                let n = self.n.unwrap_or(MESH);
                scene.check_cells(n)?;
                study_runs(setup, n, steps).admit(&self.allowance.limit())?;
                Bound::new(setup, n, steps)
            }
            // An abstract problem keeps a few numbers a level.
            Subject::Abstract(setup) => {
                super::abstract_problem::no_mesh(scene, self.n)?;
                Bound::of_abstract(setup, steps)
            }
        }
        .map_err(|error| CliError::about(&scene.name, error))?;
        let mut document = document(&bound);
        document["fingerprint"] = json!(scene.source.hash);
        if let Some(dir) = &self.out {
            write(dir, &bound, &document)?;
        }
        if self.json {
            print_json(&document)?;
        } else {
            print(&bound);
        }
        Ok(u8::from(!bound.holds()))
    }
}

fn write(dir: &std::path::Path, bound: &Bound, document: &Value) -> Result<(), CliError> {
    create_dir(dir)?;
    write_json(&dir.join(format!("{}-bound.json", bound.scene)), document)?;
    if let Some(svg) = bound.svg()? {
        write_file(&dir.join(format!("{}-bound.svg", bound.scene)), svg)?;
    }
    Ok(())
}

fn document(bound: &Bound) -> Value {
    let (limits, study) = (&bound.limits, &bound.study);
    let thresholds = &study.thresholds;
    json!({
        "scene": bound.scene,
        "n": bound.n,
        "steps": bound.steps,
        "constants": bound.constants,
        "samples": bound.samples,
        "thresholds": {
            "paper_norm": finite(limits.paper_limit()),
            "theorem": finite(limits.limit()),
            "sharpened": finite(limits.sharpened_limit()),
            "solvable": finite(limits.solvable_limit()),
            "norm_one": thresholds.norm.map(crossing),
            "radius_one": thresholds.radius.map(crossing),
            "loss": thresholds.loss.as_ref().map(|loss| [loss.bracket.0, loss.bracket.1]),
            "loss_reason": thresholds.loss.as_ref().map(|loss| loss.reason.to_string()),
            "loss_eigenvalue": thresholds.loss.as_ref().map(|loss| loss.rightmost),
            "not_followed": study.not_followed,
            "loss_tensors": study.linear.and_then(|loss| finite(loss.tensors)),
            "loss_mesh": study.linear.and_then(|loss| finite(loss.mesh)),
        },
        "ratio": bound.ratio().and_then(finite),
        "attained": bound.attained(),
        "worst": study.worst,
        "levels": study.levels,
        "meshes": study.meshes,
        "starts": { "same": study.starts.same, "distinct": study.starts.distinct, "failed": study.starts.failed },
        "rungs": study.rungs.iter().map(rung).collect::<Vec<_>>(),
        "violations": bound.violations,
    })
}

/// JSON has no infinity: it becomes null.
fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

fn crossing(crossing: Crossing) -> Value {
    json!([finite(crossing.lower()), finite(crossing.upper())])
}

fn rung(rung: &Rung) -> Value {
    let outcome = |outcome: &Outcome| match outcome {
        Outcome::Solved(iterations) => json!(iterations),
        Outcome::Failed(error) => json!(error.to_string()),
    };
    json!({
        "k": rung.k,
        "norm": rung.norm,
        "radius": rung.radius,
        "rightmost": rung.rightmost,
        "distinct": rung.starts.distinct,
        "finite_worst": rung.finite_worst,
        "finite_random": rung.finite_random,
        "sharpened": rung.sharpened,
        "theorem": rung.theorem,
        "paper_norm": rung.paper,
        "newton": outcome(&rung.newton),
        "fixed_point": outcome(&rung.fixed_point),
        "at_solution": rung.at_solution,
    })
}

fn print(bound: &Bound) {
    print_text(&format!("{}: constants", bound.scene));
    for c in &bound.constants {
        let digits = match c.uncertainty {
            Some(off) => format!("{:.10} ± {off:.1e}", c.value),
            None => format!("{:.10}", c.value),
        };
        let side = if c.safe { "safe side" } else { "no bound" };
        let how = format!("{}, {side}", c.how.name());
        print_text(&format!("  {:<36} {digits:<25} {how:<23} {}", c.name, c.note));
    }
    print_text("samples (declared against needed)");
    for s in &bound.samples {
        let verdict = if s.holds { "holds" } else { "FAILS" };
        print_text(&format!(
            "  {:<36} {:>14.8} {:>14.8}  {verdict}  {} samples",
            s.what, s.declared, s.needed, s.samples
        ));
    }
    print_ladder(bound);
    print_thresholds(bound);
    for violation in &bound.violations {
        let at = violation.k.map_or(String::new(), |k| format!("k = {k:.6}: "));
        print_text(&format!(
            "FAILS: {at}{}: {:.10} against {:.10}",
            violation.what, violation.left, violation.right
        ));
    }
}

fn print_ladder(bound: &Bound) {
    let (study, worst) = (&bound.study, &bound.study.worst);
    print_text(&format!(
        "contraction factor of Lambda, {}, at the level with the largest: {} (t = {:.4})",
        bound.grids(),
        worst.level,
        worst.t
    ));
    for at in &study.meshes {
        let mesh = at.mesh.map_or(String::new(), |n| n.to_string());
        print_text(&format!(
            "  n = {mesh:<4} k = {:.6}  |DLambda| = {:.10}  spectral radius = {:.10}  sharpened = {}",
            at.k,
            at.norm,
            at.radius,
            bounded(at.sharpened)
        ));
    }
    print_text(&format!(
        "  {} random starts at k = {:.6}: {} at the same solution, {} elsewhere, {} nowhere",
        study.starts.same + study.starts.distinct + study.starts.failed,
        worst.k,
        study.starts.same,
        study.starts.distinct,
        study.starts.failed
    ));
    if let Some(reason) = &study.not_followed {
        return print_text(&format!("a last step of size k after the same past: none, {reason}"));
    }
    print_text("a last step of size k after the same past");
    print_text(&format!(
        "  {:>11} {:>11} {:>11} {:>11} {:>11} {:>11} {:>11} {:>11}  {:<9} {:<9} {}",
        "k",
        "radius",
        "|DLambda|",
        "finite",
        "sharpened",
        "(3.15)",
        "paper norm",
        "random",
        "Newton",
        "Lambda",
        "others"
    ));
    for r in &study.rungs {
        let text = |outcome: &Outcome| match outcome {
            Outcome::Solved(iterations) => format!("{iterations} it."),
            Outcome::Failed(_) => "fails".into(),
        };
        print_text(&format!(
            "  {:>11.6} {:>11.7} {:>11.7} {:>11.7} {:>11.7} {:>11.6} {:>11.6} {:>11.7}  {:<9} {:<9} {}",
            r.k,
            r.radius,
            r.norm,
            r.finite_worst,
            r.sharpened,
            r.theorem,
            r.paper,
            r.finite_random,
            text(&r.newton),
            text(&r.fixed_point),
            r.starts.distinct
        ));
    }
}

/// A bound of a factor.
fn bounded(bound: f64) -> String {
    if bound.is_finite() { format!("{bound:.10}") } else { "none".into() }
}

fn print_thresholds(bound: &Bound) {
    let (limits, study) = (&bound.limits, &bound.study);
    let line = |what: &str, value: String| print_text(&format!("  {what:<58} {value}"));
    let number = |k: f64| match k {
        k if k.is_infinite() => "every k".into(),
        k if k > 0.0 => format!("{k:.8}"),
        _ => format!("no k: m0 = {:.6}", limits.m0),
    };
    let crossing = |crossing: Option<Crossing>| match crossing {
        None => "every k: Lambda does not depend on eta".to_string(),
        Some(Crossing::Between(low, high)) => {
            format!("{:.8} ± {:.0e}", 0.5 * (low + high), 0.5 * (high - low).max(1e-15 * high))
        }
        Some(Crossing::Beyond(k)) => format!("beyond {k:.4}"),
        Some(Crossing::Before(k)) => format!("before {k:.4}"),
    };
    print_text("thresholds: k below");
    line("1  (3.4), the paper's norm of B", number(limits.paper_limit()));
    line("1  (3.4), operator norm", number(limits.limit()));
    line("2  sharpened: half weight, terms apart", number(limits.sharpened_limit()));
    if let Some(reason) = &study.not_followed {
        line("3  measured: |DLambda| = 1", format!("not followed: {reason}"));
    } else {
        line("3  measured: |DLambda| = 1", crossing(study.thresholds.norm));
        line("3  measured: spectral radius of DLambda = 1", crossing(study.thresholds.radius));
    }
    line("4  one solution guaranteed, by monotonicity", number(limits.solvable_limit()));
    if let Some(loss) = study.linear {
        line("4  linear: A + (k/2)B(0) singular on S^d", number(loss.tensors));
        line("4  linear: A + (k/2)B(0) singular on the mesh", number(loss.mesh));
    }
    match &study.thresholds.loss {
        _ if study.not_followed.is_some() => {}
        Some(loss) => {
            let (low, high) = loss.bracket;
            line(
                "4  the solution followed in k ends",
                format!("{high:.8} ± {:.0e}: {}", high - low, loss.reason),
            );
            line("   largest real eigenvalue of DLambda there", format!("{:.6}", loss.rightmost));
        }
        None => {
            let last = study.rungs.last().map_or(0.0, |rung| rung.k);
            line("4  the solution followed in k", format!("does not end up to {last:.4}"));
        }
    }
    if let Some(ratio) = bound.ratio() {
        line("measured threshold of Lambda over (3.4), the paper's norm", format!("{ratio:.3}"));
    }
    let attained = if bound.attained() { "yes" } else { "no" };
    line("sharpened bound attained (within 1e-6)", attained.into());
}
