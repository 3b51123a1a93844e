//! `sweep audit`: the proofs of Theorems 10 and 11 line by line, on real runs.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::machine::{Common, processors, share_threads};
use super::study::deliver;
use super::{CliError, Scenes, create_dir, no_case, write_file};
use fem::contact::BoundaryRule;
use fem::space::Element;
use run::sweep::{Overrides, admit_constants};
use scene::setup::Setup;
use studies::theory::audit::{AuditError, SceneAudit, audit_runs};
use studies::theory::ledger::{document, ledger};

/// Largest n taken from a scene's list: a level costs some 60 evaluations of the exact solution per cell.
const FINEST: u32 = 64;

/// `sweep audit`.
#[derive(Args)]
#[command(
    after_help = "Runs use the paper's boundary integral (5.14), rule exact, unless --rule says otherwise; laws with a jump and quadratic elements keep the vertex rule, whose error is a part of E_q. Rows are sorted by tightness. Columns: left and right where the line is tightest over all levels and runs, left - right there (of an identity its magnitude), the accuracy (what rounding and quadrature allow), the tightness (left/right; of an identity difference over accuracy; - where both sides are below the accuracy), fitted powers of h (at the smallest k) and of k (at the smallest h) of left and right. \
JSON keys with --json: scene, fingerprint (of its text), theorem, rule, holds, constants (m_A, L_A, alpha_phi, beta_phi, alpha_j, c_j_squared, c_j_source, c0, c1, c_phi, history, m0), lines (line, says, relation, left, right, ratio, tightness, difference, accuracy, power_h, power_k, holds, defined), cases (n, steps, h, k, lines), violations, undefined (lines without a defined constant). Files with --out: SCENE-audit.csv, SCENE-audit.json. \
With --ledger: a list of claim, hypotheses, quantity, proved, observed, used, claimed, confirmed, scene, command; file ledger.json. \
Exit code 1: a line is violated beyond its accuracy or has no defined constant (m0 <= 0), or a claim is not confirmed."
)]
pub(crate) struct Audit {
    /// Name of a scene with an exact solution, or path of a TOML file
    #[arg(required_unless_present = "ledger")]
    scene: Option<String>,
    /// What runs say of the paper's claims: sharp or slack, each with the command that shows it
    // Its runs are fixed in the program, with at most a few thousand unknowns.
    #[arg(long, conflicts_with_all = ["scene", "n", "steps", "rule", "memory_limit"])]
    ledger: bool,
    /// Cells per unit length, h = 1/n, in place of the scene's list up to 64
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(1..=512))]
    n: Option<Vec<u32>>,
    /// Numbers N of time steps, k = T/N, in place of the scene's list
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(1..=100_000))]
    steps: Option<Vec<u32>>,
    /// Boundary rule of the runs
    #[arg(long, value_enum)]
    rule: Option<Rule>,
    #[command(flatten)]
    common: Common,
    /// Write SCENE-audit.csv and SCENE-audit.json into this directory
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

impl From<AuditError> for CliError {
    fn from(error: AuditError) -> Self {
        Self::Other(error.to_string())
    }
}

#[derive(Clone, Copy, ValueEnum)]
enum Rule {
    Vertex,
    Gauss,
    Exact,
}

impl Audit {
    pub(super) fn execute(&self, scenes: &Scenes) -> Result<u8, CliError> {
        let Some(scene) = self.scene.as_ref().filter(|_| !self.ledger) else {
            return self.ledger(scenes);
        };
        share_threads()?;
        let scene = scenes.scene(scene)?;
        admit_constants(&scene, true, &self.common.allowance.limit())?;
        let mut setup = Setup::new(scene)?;
        let (ns, steps) = self.grids(&setup)?;
        self.choose_rule(&mut setup)?;
        audit_runs(&setup, &ns, &steps, processors()).admit(&self.common.allowance.limit())?;
        let audit = SceneAudit::new(&setup, &ns, &steps).map_err(CliError::other)?;
        if let Some(dir) = &self.out {
            create_dir(dir)?;
            let rows = audit.csv().map_err(CliError::other)?;
            write_file(&dir.join(format!("{}-audit.csv", audit.scene)), rows)?;
        }
        let json = audit.json().map_err(CliError::other)?;
        deliver(&json, &audit.document(), self.out.as_deref(), self.common.json)?;
        Ok(u8::from(!audit.holds()))
    }

    fn ledger(&self, scenes: &Scenes) -> Result<u8, CliError> {
        let found =
            ledger(|name| -> Result<Setup, CliError> { Ok(Setup::new(scenes.scene(name)?)?) })?;
        deliver(&found, &document(&found), self.out.as_deref(), self.common.json)?;
        Ok(u8::from(!found.iter().all(|entry| entry.confirmed)))
    }

    fn grids(&self, setup: &Setup) -> Result<(Vec<u32>, Vec<u32>), CliError> {
        let scene = &setup.scene;
        Overrides { n: self.n.clone(), steps: self.steps.clone() }.check(scene)?;
        let mut own = scene.sweep.clone().unwrap_or_default();
        own.n.retain(|n| *n <= FINEST);
        let ns = self.n.clone().unwrap_or(own.n);
        let steps = self.steps.clone().unwrap_or(own.steps);
        if ns.is_empty() || steps.is_empty() {
            return Err(no_case(scene, "audit"));
        }
        Ok((ns, steps))
    }

    fn choose_rule(&self, setup: &mut Setup) -> Result<(), CliError> {
        let Some(boundary) = &mut setup.model.boundary else { return Ok(()) };
        let jumps = !boundary.potential.jumps().is_empty();
        let element = setup.body.element;
        boundary.rule = match self.rule {
            None if jumps || element != Element::P1 => BoundaryRule::Vertex,
            None | Some(Rule::Exact) => BoundaryRule::Exact,
            Some(Rule::Gauss) => BoundaryRule::Gauss,
            Some(Rule::Vertex) => BoundaryRule::Vertex,
        };
        let integrated = boundary.rule != BoundaryRule::Vertex;
        let message = format!(
            "{} has its law at the nodes of Γ3, and --rule asks for facet integrals",
            element.name()
        );
        let (key, hint) = ("discretization.element", "leave --rule out, or say --rule vertex");
        setup.scene.refuse_if(element != Element::P1 && integrated, key, message, hint)?;
        let message = "the law has a jump, and --rule asks for facet integrals";
        let hint = "leave --rule out, or say --rule vertex: one pressure per vertex";
        Ok(setup.scene.refuse_if(jumps && integrated, "contact.law", message, hint)?)
    }
}
