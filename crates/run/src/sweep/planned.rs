//! The planned cases of a directory of records, by its provenance.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::plan::{CasePlan, Overrides, ScenePlan, norms, scene_cases};
use super::provenance::Provenance;
use judge::record::{CaseRecord, Key, Status};
use scene::{Norm, Scene};

/// Cases of a scene off its default grid: every n with every number of steps.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Block {
    /// Cells per unit length; empty in an abstract scene.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub n: Vec<u32>,
    pub steps: Vec<u32>,
    /// Names of the norms, unless they are those of the scene.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub norms: Option<Vec<String>>,
}

/// A mesh, and the names of its norms unless they are those of the scene.
type Measured = (Option<u32>, Option<Vec<String>>);

/// The cases of a plan; None if they are the scene's default grid.
pub fn blocks(plan: &ScenePlan) -> Option<Vec<Block>> {
    if plan.cases == scene_cases(plan.scene(), &Overrides::default()) {
        return None;
    }
    // By mesh; meshes with equal steps and norms together.
    let mut of_mesh: BTreeMap<Measured, Vec<u32>> = BTreeMap::new();
    for case in &plan.cases {
        let names = || case.norms.iter().map(|norm| norm.name().to_owned()).collect();
        let usual = case.norms == norms(plan.scene(), case.n);
        of_mesh.entry((case.n, (!usual).then(names))).or_default().push(case.steps);
    }
    let mut blocks: Vec<Block> = Vec::new();
    for ((n, norms), steps) in of_mesh {
        let same = |block: &&mut Block| {
            block.steps == steps && block.norms == norms && n.is_some() != block.n.is_empty()
        };
        match blocks.iter_mut().find(same) {
            Some(block) => block.n.extend(n),
            None => blocks.push(Block { n: n.into_iter().collect(), steps, norms }),
        }
    }
    Some(blocks)
}

/// The cases of a scene by its provenance: its default grid or the stored blocks.
pub fn planned(scene: &Scene, known: &Provenance) -> Vec<CasePlan> {
    match known.cases.get(&scene.name) {
        None => scene_cases(scene, &Overrides::default()),
        Some(blocks) => blocks.iter().flat_map(|block| of_block(scene, block)).collect(),
    }
}

fn of_block(scene: &Scene, block: &Block) -> Vec<CasePlan> {
    let ns: Vec<Option<u32>> = match block.n.is_empty() {
        true => vec![None],
        false => block.n.iter().copied().map(Some).collect(),
    };
    let named = |n: Option<u32>| match &block.norms {
        None => norms(scene, n),
        Some(names) => {
            let listed = |norm: &Norm| names.iter().any(|name| name == norm.name());
            Norm::all().filter(listed).collect()
        }
    };
    let of_mesh = |&n: &Option<u32>| {
        block.steps.iter().map(move |&steps| CasePlan { n, steps, norms: named(n) })
    };
    ns.iter().flat_map(of_mesh).collect()
}

/// Whether a record is complete: the case was run (possibly failed), and no row is lost.
pub(crate) fn is_complete(record: &CaseRecord, norms: &[Norm]) -> bool {
    record.status != Status::Skipped && norms.iter().all(|norm| record.norm(norm.name()).is_some())
}

/// The planned cases of a scene without a complete record.
pub fn missing_cases(scene: &str, planned: &[CasePlan], records: &[CaseRecord]) -> Vec<Key> {
    let of_scene = records.iter().filter(|record| record.scene == scene);
    let known: BTreeMap<(Option<u32>, u32), &CaseRecord> =
        of_scene.map(|record| ((record.n, record.steps), record)).collect();
    let open = |case: &&CasePlan| {
        let record = known.get(&(case.n, case.steps));
        !record.is_some_and(|record| is_complete(record, &case.norms))
    };
    planned.iter().filter(open).map(|case| case.place().key(scene)).collect()
}
