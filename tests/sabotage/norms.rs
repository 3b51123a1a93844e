//! The norms of a record against a second integral of the errors of the levels that the scheme shows.

use std::sync::Arc;

use exact::Truth;
use fem::contact::Discretization;
use run::sweep::{CasePlan, run_contact_case};
use scene::Norm;
use scene::setup::{MeshData, Setup};

use crate::again::{Errors, Kept, errors};
use crate::catalogue::Defect;
use crate::shipped::setup;
use crate::suite::{data, fresh};

/// Scenes, meshes and steps: a multiplier and a moving zone; a multiplier, and every norm but one without space error.
const MEASURED: [(&str, u32, u32); 2] = [("signorini", 4, 4), ("affine-locked", 2, 4)];
/// Fronts that cut coarse cells leave a rule 1 % of strain and stress; u and its trace are smooth there.
const SHARE: [f64; 2] = [0.03, 0.005];
/// Squares settle to this. Against 1e-8 it moves strain and stress of `signorini` by 5e-4 at most, u by 6e-6: both far below
/// [`SHARE`], and four times as fast.
const SETTLED: f64 = 1e-4;
/// Below this an error is rounding.
const ROUNDING: f64 = 1e-12;

struct Stage {
    sound: Setup,
    space: Arc<Discretization>,
    truth: Arc<dyn Truth>,
    steps: u32,
}

/// The sound side.
pub struct Norms(Vec<Stage>);

impl Norms {
    pub fn new() -> Self {
        let stage = |(name, n, steps)| {
            let sound = setup(name);
            let data = MeshData::new(&sound, n, None).unwrap_or_else(|error| panic!("{error}"));
            Stage { space: data.space, truth: data.truth, sound, steps }
        };
        Self(MEASURED.map(stage).into())
    }

    /// The first norm of a record that is not the one of the second integral.
    pub fn hear(&self, defect: &Defect) -> Option<String> {
        self.0.iter().find_map(|stage| stage.hear(defect))
    }
}

impl Stage {
    fn hear(&self, defect: &Defect) -> Option<String> {
        let program = (defect.program)(fresh(&self.sound));
        let data = data(defect, &program, &self.sound, &self.space, &self.truth);
        let exact = program.exact.clone()?;
        let (mut levels, mut again) = (Vec::new(), Errors::default());
        let run = program.scheme.march(&program, &data, self.steps, &mut |view| {
            levels.push(Kept::of(view));
            again = again.max(errors(&exact, &data, &levels, SETTLED));
            Ok(())
        });
        // A run without result is not this witness's finding.
        run.ok()?;
        let integrated = [
            (Norm::VMax, again.v),
            (Norm::L2Max, again.l2),
            (Norm::StressL2Max, again.stress),
            (Norm::TraceL2Max, again.trace),
            (Norm::PressureL2Max, again.pressure),
            (Norm::ContactSetMax, again.contact_set),
        ];
        let norms = integrated.iter().map(|(norm, _)| *norm).collect();
        let (n, steps) = (Some(self.space.mesh.n), self.steps);
        let program = (defect.measured)(program);
        let record = run_contact_case(&program, &data, &CasePlan { n, steps, norms });
        let records = (defect.records)(vec![record]);
        let record = records.first()?;
        integrated.into_iter().find_map(|(norm, again)| {
            let written = record.norm(norm.name())?.error?;
            // A sample of a contact set is an eighth of an edge.
            let allowed = match norm {
                Norm::ContactSetMax => 0.125 * self.space.mesh.h() + ROUNDING,
                Norm::VMax | Norm::StressL2Max => SHARE[0] * again + ROUNDING,
                _ => SHARE[1] * again + ROUNDING,
            };
            let wrong = written.is_nan() || (written - again).abs() > allowed;
            let scene = &self.sound.scene.name;
            wrong.then(|| format!("{} {written:.3e}, again {again:.3e} on {scene}", norm.name()))
        })
    }
}
