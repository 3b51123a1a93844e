//! Source: the kinds of tables, beside what reads them, and the table of keys.
//! Goal: a table has just the keys that its kinds have, or one would be accepted and never read.
//! Data: all kinds.

use std::collections::BTreeSet;

use crate::keys::{Part, SceneKind};
use crate::{TimeRule, domain, friction, law, material, memory, time};

#[test]
fn tables_have_the_keys_of_their_kinds() {
    let rules = TimeRule::kinds();
    let all: [(&str, &[(&str, &str)]); 7] = [
        ("[time.grid]", &time::GRIDS),
        ("[time.rule]", &rules),
        ("[domain.mesh]", &domain::MESHES),
        ("[material.elasticity]", &material::TENSORS),
        ("[material.memory.kernel]", &memory::KERNELS),
        ("[contact.law]", &law::LAWS),
        ("[contact.friction.bound]", &friction::BOUNDS),
    ];
    for part in Part::every().iter().filter(|part| part.has_kinds()) {
        let heading = part.heading();
        let (_, kinds) = all.iter().find(|(name, _)| *name == heading).expect(&heading);
        let of_kinds = kinds.iter().flat_map(|(_, keys)| keys.split_whitespace());
        let of_kinds: BTreeSet<&str> = of_kinds.chain(["kind"]).collect();
        let keys: BTreeSet<&str> = part.keys(SceneKind::Contact).into_iter().collect();
        assert_eq!(keys, of_kinds, "{heading}");
    }
}
