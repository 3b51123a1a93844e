mod finite;
mod horizon;
mod measure;
mod recurrence;
mod rule;
mod stability;

use std::path::Path;

use super::Estimate;
use judge::claim::{Claim, Place};
use scene::Registry;
use scene::setup::{Setup, Subject};

fn violations(run: &Estimate) -> Vec<Claim> {
    let claims = run.envelopes().unwrap().claims(run, &Place::default());
    claims.into_iter().filter(|claim| claim.reason().is_some()).collect()
}

fn setup(name: &str) -> Setup {
    match subject(name) {
        Subject::Contact(setup) => *setup,
        Subject::Abstract(_) => panic!("{name} has no body"),
    }
}

fn subject(name: &str) -> Subject {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../manufactured");
    let scene = Registry::open(&folder).and_then(|registry| registry.load(name));
    Subject::new(scene.unwrap_or_else(|error| panic!("{error}"))).unwrap()
}
