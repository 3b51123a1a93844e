//! `sweep audit`: the inequalities of the proofs of Theorems 10 and 11, on real runs.

use std::path::PathBuf;

use clap::Args;

use super::machine::{Common, processors, share_threads};
use super::study::show;
use super::{CliError, Scenes, no_case};
use run::sweep::{Overrides, admit_constants};
use scene::setup::Setup;
use studies::theory::audit::{AuditError, audit, audit_runs};

/// Largest n taken from a scene's list.
const FINEST: u32 = 64;

/// `sweep audit`.
#[derive(Args)]
#[command(
    after_help = "Eight inequalities of the proofs, (2.9), (4.7), (4.9), (4.14), (4.16), (4.17), (4.20) and (5.23), at every level, on the numbers of the solver and of the exact solution, by the boundary rule of the scene; what that rule and the load vector add to (4.9) is E_q. A claim is an inequality in a run, at the level where it is tightest: both sides, what rounding allows, left/right. \
JSON keys with --json: scene, fingerprint (of its text), holds, claims (line, says, n, steps, level, at, left, relation, right, low, difference, accuracy, tightness, standing: \"pass\", \"fail\" or \"unresolved\", holds, note: why not), theorem, rule, constants (m_A, L_A, alpha_phi, beta_phi, alpha_j, c_j_squared, c_j_source, c0, c1, history, m0). Files with --out: SCENE-audit.json, SCENE-audit-claims.csv. \
Exit code 1: an inequality is violated beyond its accuracy or has no defined constant (m0 <= 0)."
)]
pub(crate) struct Audit {
    /// Name of a scene with an exact solution, or path of a TOML file
    scene: String,
    /// Cells per unit length, h = 1/n, in place of the scene's list up to 64
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(1..=512))]
    n: Option<Vec<u32>>,
    /// Numbers N of time steps, k = T/N, in place of the scene's list
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(1..=100_000))]
    steps: Option<Vec<u32>>,
    /// Write SCENE-audit.json and SCENE-audit-claims.csv into this directory
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    common: Common,
}

impl From<AuditError> for CliError {
    fn from(error: AuditError) -> Self {
        Self::Other(error.to_string())
    }
}

impl Audit {
    pub(super) fn execute(&self, scenes: &Scenes) -> Result<u8, CliError> {
        share_threads()?;
        let scene = scenes.scene(&self.scene)?;
        admit_constants(&scene, true, &self.common.allowance.limit())?;
        let setup = Setup::new(scene)?;
        let (ns, steps) = self.grids(&setup)?;
        audit_runs(&setup, &ns, &steps, processors()).admit(&self.common.allowance.limit())?;
        let findings = audit(&setup, &ns, &steps).map_err(CliError::other)?;
        show(&findings, self.out.as_deref(), self.common.json)
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
}
