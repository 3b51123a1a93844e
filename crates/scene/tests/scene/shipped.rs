//! Every shipped scene parses, validates, and is what its name says.

use std::path::{Path, PathBuf};

use fem::space::Element;
use scene::{Registry, Scene, SceneError, Source};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../manufactured")
}

pub(super) fn shipped(name: &str) -> Scene {
    let registry = Registry::open(&folder()).unwrap();
    registry.load(name).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn all_are_there_and_valid() {
    let registry = Registry::open(&folder()).unwrap();
    for name in registry.names() {
        let scene = shipped(name);
        assert_eq!(scene.name, name);
        let text = &scene.source.text;
        assert!(
            text.starts_with("# Question: ") && text.contains("\n# Source: "),
            "{name} has no header"
        );
        assert!(
            !scene.judge || !scene.predicts.is_empty(),
            "{name} is judged and predicts nothing"
        );
        assert!(scene.sweep.is_some() || !scene.judge, "{name} is judged and has no grid");
    }
}

#[test]
fn a_path_is_read_whatever_the_name() {
    let registry = Registry::open(&folder()).unwrap();
    let path = folder().join("affine.toml");
    assert_eq!(registry.load(&path.display().to_string()).unwrap().name, "affine");
}

#[test]
fn names_in_the_folder_are_unique_and_match_their_files() {
    let folder = std::env::temp_dir().join(format!("gronwall-registry-{}", std::process::id()));
    std::fs::create_dir_all(folder.join("more")).unwrap();
    let text = shipped("punch").source.text;
    std::fs::write(folder.join("block.toml"), &text).unwrap();
    let error = Registry::open(&folder).unwrap().load("block").unwrap_err().to_string();
    assert!(error.contains("the scene is called `punch`, its file `block.toml`"), "{error}");
    std::fs::write(folder.join("more/block.toml"), &text).unwrap();
    let error = Registry::open(&folder).unwrap_err();
    std::fs::remove_dir_all(&folder).unwrap();
    assert!(matches!(error, SceneError::Duplicate { ref name, .. } if name == "block"), "{error}");
}

#[test]
fn keys_and_hash_lead_back_to_the_text() {
    let scene = shipped("pure-mild");
    assert_eq!(&scene.source.text[scene.span("exact.multiplier")], "\"lambda\"");
    assert_eq!(&scene.source.text[scene.span("sweep.n.2")], "64");
    assert_eq!(&scene.source.text[scene.span("exact.selection")], "[exact]");
    let again = Source::from_text("elsewhere.toml", scene.source.text.clone());
    assert_eq!(again.hash, scene.source.hash);
    assert_eq!(again.hash.len(), 16);
}

/// Docs list it: docs/EXTENDING.md.
#[test]
fn quadratic_elements_have_friction_in_the_plane_alone() {
    assert!(shipped("friction-front").with_element(Element::P2).is_ok());
    let error = shipped("friction-box").with_element(Element::P2).unwrap_err().to_string();
    assert!(error.contains("P2 has no friction in space") && error.contains("take P1"), "{error}");
}
