//! Source: a gate that has never seen a path says nothing of it.
//! Goal: every way through the program (plan, memory, rule, grid, solver, form, frames, damping, states of the law) is
//!   walked by a case of the main job that has a verdict, and the run itself says which it took; a way without a scene
//!   is named, and the scenes that walk a way on unequal steps are driven off their order by the defects that all
//!   scenes on equal steps let pass.
//! Mesh, data: one small case of each of these scenes, as the main job runs it.

use fem::contact::{CaseInfo, Path, Paths};
use judge::record::Key;
use run::sweep::{Overrides, ScenePlan};
use scene::TimeRule;
use scene::setup::{MeshData, Setup, Subject};

/// Scenes with a case each: n, steps.
const WALKS: &[(&str, u32, u32)] = &[
    ("graded-exponentials", 2, 16),
    ("graded-beyond", 2, 16),
    ("graded-contact", 2, 16),
    ("graded-power", 2, 8),
    ("graded-end", 2, 16),
    ("long-interpolated", 1, 512),
    ("long-interpolated-graded", 1, 512),
    ("left-rule", 2, 32),
    ("left-rule-graded", 2, 32),
    ("gregory-three", 2, 16),
    ("gregory-four", 2, 8),
    ("product-integrated", 2, 16),
    ("product-integrated-graded", 2, 16),
    ("strong-scaled", 4, 8),
    ("strong-corner", 4, 4),
    ("frustum-affine", 1, 16),
    ("yielding-box", 12, 1),
    ("moving-load", 4, 8),
    ("affine", 4, 4),
    ("affine-graded", 4, 16),
    ("l-shape", 2, 1),
    ("v-groove", 4, 4),
    ("in-space", 16, 8),
    ("sourced-box", 3, 4),
    ("law-scaled", 8, 8),
    ("law-jump", 8, 8),
    ("signorini", 8, 16),
    ("compliance", 8, 16),
    ("power-law", 4, 8),
    ("viscoelastic", 8, 16),
    ("broken-body-end", 2, 16),
    ("law-linear", 4, 1),
    ("many-branches", 2, 8),
    ("friction-front", 8, 8),
];

/// What a case of the main job takes.
fn walked(name: &str, n: u32, steps: u32) -> CaseInfo {
    let setup: Setup = crate::shipped::setup(name);
    let scene = setup.scene.clone();
    assert!(scene.judge && !scene.long, "{name} is not judged by the main job");
    let subject = Subject::new(scene).unwrap_or_else(|error| panic!("{name}: {error}"));
    let planned = ScenePlan::new(subject, &Overrides::default()).keys();
    let key = Key { scene: name.into(), n: Some(n), steps };
    assert!(planned.contains(&key), "{name} has no case {key}");
    let data = MeshData::new(&setup, n, None).unwrap_or_else(|error| panic!("{name}: {error}"));
    let run = setup.scheme.march(&setup, &data, steps, &mut |_| Ok(()));
    run.unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// The paths that none of these sets has.
fn without_a_scene(walks: &[Paths]) -> Vec<&'static str> {
    let all = walks.iter().fold(Paths::default(), |all, walked| all.union(*walked));
    let missing = Path::ALL.iter().filter(|&&path| !all.contains(path));
    missing.map(|path| path.name()).collect()
}

#[test]
fn every_path_is_walked_by_a_judged_scene() {
    let mut walks = Vec::new();
    for &(name, n, steps) in WALKS {
        let info = walked(name, n, steps);
        let words: Vec<&str> = info.paths.iter().map(Path::name).collect();
        println!("{name}: {}", words.join("; "));
        walks.push(info.paths);
    }
    let missing = without_a_scene(&walks);
    assert!(missing.is_empty(), "no judged scene walks: {}", missing.join("; "));
}

/// Each rule sums the history of a judged scene on equal and, where it may, on unequal steps, and runs say so: rules that
/// are exchanged would both be walked all the same.
#[test]
fn every_rule_sums_a_history_on_each_kind_of_grid() {
    let mut seen = Vec::new();
    for (name, n, steps, rule, equal) in [
        ("affine", 4, 4, "trapezoidal rule", true),
        ("affine-graded", 4, 16, "trapezoidal rule", false),
        ("left-rule", 2, 32, "left-endpoint rule", true),
        ("left-rule-graded", 2, 32, "left-endpoint rule", false),
        ("gregory-three", 2, 16, "Gregory's rule of order 3", true),
        ("gregory-four", 2, 8, "Gregory's rule of order 4", true),
        ("broken-body-end", 2, 16, "corrected end", true),
        ("graded-end", 2, 16, "corrected end", false),
        ("product-integrated", 2, 16, "product integration", true),
        ("product-integrated-graded", 2, 16, "product integration", false),
    ] {
        let ways = crate::shipped::setup(name).paths_in_words(steps, &walked(name, n, steps));
        let wanted = format!("{rule}, {} steps", if equal { "equal" } else { "unequal" });
        let other = format!(", {} steps", if equal { "unequal" } else { "equal" });
        assert_eq!(ways.last(), Some(&wanted), "{name}");
        assert!(!ways.iter().any(|way| way.ends_with(&other)), "{name}: {ways:?}");
        seen.push((rule, equal));
    }
    assert_eq!(not_summed(&seen), []);
    for left_out in 0..seen.len() {
        let without = [&seen[..left_out], &seen[left_out + 1..]].concat();
        assert_eq!(not_summed(&without), [seen[left_out]], "a walk that nobody misses");
    }
}

/// Rules, and whether steps are equal, that are not among those of runs.
fn not_summed(seen: &[(&str, bool)]) -> Vec<(&'static str, bool)> {
    let both = |rule: &TimeRule| [(rule.name(), true), (rule.name(), rule.needs_equal_steps())];
    let mut all: Vec<_> = TimeRule::EVERY.iter().flat_map(both).collect();
    all.dedup();
    all.retain(|way| !seen.contains(way));
    all
}

/// The list is whole, and a path that only one set has is missed without it.
#[test]
fn a_path_without_a_scene_is_named() {
    let one = |path: &Path| {
        let mut paths = Paths::default();
        paths.insert(*path);
        assert!(paths.contains(*path) && paths.iter().eq([*path]));
        paths
    };
    let mut sets: Vec<Paths> = Path::ALL.iter().map(one).collect();
    assert!(without_a_scene(&sets).is_empty());
    sets.pop();
    let last = Path::ALL[Path::ALL.len() - 1];
    assert_eq!(without_a_scene(&sets), [last.name()]);
}
