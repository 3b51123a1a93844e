mod horizon;
mod measure;
mod recurrence;
mod stability;

use std::path::Path;

use crate::scene::Registry;
use crate::setup::Setup;

fn setup(name: &str) -> Setup {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("manufactured");
    let scene = Registry::open(&folder).and_then(|registry| registry.load(name));
    Setup::new(scene.unwrap_or_else(|error| panic!("{error}"))).unwrap()
}
