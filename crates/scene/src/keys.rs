//! The keys of all tables of a scene file. Unknown ones are refused before values are read: a misspelt key is why another
//! is missing.

use super::diagnostic::Result;
use super::domain::MESHES;
use super::elastic::TENSORS;
use super::friction::BOUNDS;
use super::heading::SceneKind;
use super::kernel::KERNELS;
use super::law::LAWS;
use super::reading::Reading;
use super::time::{GRIDS, TimeRule};
use super::values::{Kinds, of_any};

/// Tables with their keys; `*` is each entry of a list.
type Tables = &'static [(&'static str, &'static str)];

const OF_ALL: Tables = &[
    ("scene", "name question kind dimension judge expect long window_n window_steps violates"),
    ("time", "horizon grid rule"),
    (
        "predicts.*",
        "norm variable order order_k at_least exact constant constant_within constant_why why window_n window_steps",
    ),
];

const OF_BODIES: Tables = &[
    ("", "scene domain time material contact discretization loads exact sweep predicts"),
    (
        "domain",
        "shape size vertices sides points triangles file clamped symmetry traction contact rest mesh",
    ),
    ("material", "lambda mu_L E nu elasticity memory projection region"),
    ("material.memory", MEMORY),
    ("material.projection", "mu kappa"),
    ("material.region.*", "name where physical lambda mu_L E nu elasticity memory"),
    ("material.region.*.memory", MEMORY),
    ("contact", "gap shift law quadrature friction"),
    ("contact.friction", "bound"),
    ("discretization", "element"),
    ("loads", "body traction"),
    ("exact", "u multiplier selection friction interpolated form parameters define"),
    ("sweep", "n steps pairs reference norms by_state"),
    ("sweep.reference", "n steps"),
];

const MEMORY: &str = "kernel lambda mu bulk shear singular";

const OF_ABSTRACT: Tables = &[
    ("", "scene time space operator history phi trace exact sweep predicts"),
    ("space", "inner_product"),
    ("operator", "matrix nonlinear"),
    ("phi", "force"),
    ("history", "kernels R a_S"),
    ("history.kernels.*", "q singular matrix"),
    ("trace.*", "functional weight law upper lower"),
    ("exact", "u multiplier selection parameters define"),
    ("sweep", "steps"),
];

/// Tables whose keys depend on their kind.
const WITH_KINDS: &[(&str, Kinds)] = &[
    ("time.grid", &GRIDS),
    ("domain.mesh", &MESHES),
    ("material.elasticity", &TENSORS),
    ("material.memory.kernel", &KERNELS),
    ("material.memory.bulk", &KERNELS),
    ("material.memory.shear", &KERNELS),
    ("material.region.*.elasticity", &TENSORS),
    ("material.region.*.memory.kernel", &KERNELS),
    ("material.region.*.memory.bulk", &KERNELS),
    ("material.region.*.memory.shear", &KERNELS),
    ("contact.law", &LAWS),
    ("contact.friction.bound", &BOUNDS),
    ("trace.*.law", &LAWS),
];

/// Refuses a key that no table of its name has.
pub(super) fn refuse_unknown(reading: &Reading, kind: SceneKind) -> Result<()> {
    let of_kind = match kind {
        SceneKind::Contact => OF_BODIES,
        SceneKind::Abstract => OF_ABSTRACT,
    };
    for (name, keys) in of_kind.iter().chain(OF_ALL) {
        for table in tables(reading, name)? {
            reading.keys(&table, keys)?;
        }
    }
    let rules = ("time.rule", &TimeRule::kinds()[..]);
    for (name, kinds) in WITH_KINDS.iter().copied().chain([rules]) {
        for table in tables(reading, name)?.iter().filter(|table| reading.has_parts(table)) {
            reading.keys(table, &of_any(kinds))?;
        }
    }
    Ok(())
}

fn tables(reading: &Reading, name: &str) -> Result<Vec<String>> {
    let Some((list, rest)) = name.split_once(".*") else { return Ok(vec![name.to_string()]) };
    let of_entry = |i| tables(reading, &format!("{list}.{i}{rest}"));
    Ok(reading.entries(list)?.map(of_entry).collect::<Result<Vec<_>, _>>()?.concat())
}
