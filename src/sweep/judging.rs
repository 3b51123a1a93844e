//! From a scene's predictions to verdicts on records.

use crate::record::{CaseRecord, Key};
use crate::report::SceneSummary;
use crate::scene::{Direction, Expectation, Prediction, Scene};
use crate::verdict::{self, Expect, Variable, Verdict};

/// The verdicts of a scene; none if it is not judged.
pub fn judge_scene(scene: &Scene, records: &[CaseRecord], expected: &[Key]) -> Vec<Verdict> {
    if !scene.judge {
        return Vec::new();
    }
    let expect = match scene.expect {
        Expectation::Pass => Expect::Pass,
        Expectation::Fail => Expect::Fail,
        Expectation::Unresolved => Expect::Unresolved,
    };
    scene
        .predicts
        .iter()
        .map(|p| verdict::judge(&scene.name, records, expected, &prediction(scene, p), expect))
        .collect()
}

/// What a report says of a scene.
pub fn scene_summary(scene: &Scene) -> SceneSummary {
    SceneSummary { name: scene.name.clone(), question: scene.question.clone() }
}

fn prediction(scene: &Scene, written: &Prediction) -> verdict::Prediction {
    let pair = |window: Option<[usize; 2]>| window.map(|w| w.map(|v| v as u32));
    verdict::Prediction {
        norm: written.norm.name().into(),
        variable: match written.variable {
            Direction::H => Variable::H,
            Direction::K => Variable::K,
            Direction::Joint => Variable::Joint,
            Direction::Path => Variable::Path,
        },
        order: written.order,
        order_k: written.order_k,
        at_least: written.at_least,
        exact: written.exact,
        why: written.why.clone(),
        window_n: pair(written.window_n.or(scene.window_n)),
        window_steps: pair(written.window_steps.or(scene.window_steps)),
    }
}
