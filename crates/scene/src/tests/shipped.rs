//! Every shipped scene parses, validates, and is what its name says.

use std::path::{Path, PathBuf};

use crate::{Data, Registry, Scene, SceneError, Source};
use fem::space::Element;
use vhi::law::Isotropic;

const NAMES: [&str; 15] = [
    "affine",
    "affine-locked",
    "compliance",
    "elastic-punch",
    "in-space",
    "linear-punch",
    "memory-minus-identity",
    "memory-plus-identity",
    "punch",
    "pure-mild",
    "pure-strong",
    "signorini",
    "sourced",
    "steady",
    "viscoelastic",
];

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
    for name in NAMES {
        assert!(registry.names().any(|known| known == name), "{name} is not shipped");
    }
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
fn the_punch_is_the_common_benchmark() {
    let scene = shipped("punch");
    let memory = scene.as_contact().unwrap().material.memory[0].clone();
    let elastic = scene.as_contact().unwrap().material.elastic;
    assert_eq!(elastic, Isotropic { lambda: 1.0, mu: 1.0 }.into());
    assert_eq!((memory.lambda, memory.mu), (0.25, 0.25));
    assert_eq!(memory.exponentials, Some(vec![(-1.0, 1.0)]));
    let projection = scene.as_contact().unwrap().material.projection.clone().unwrap();
    assert!((projection.lipschitz - 0.05).abs() < 1e-15);
    let contact = scene.as_contact().unwrap().contact[0].clone();
    assert_eq!(contact.gap.and_then(|gap| scene.formulas.value_of_constant(gap)), Some(0.10));
    assert!((contact.law.unwrap().alpha() - 0.5).abs() < 1e-12);
    let reference = scene.sweep.clone().unwrap().reference.unwrap();
    assert_eq!((reference.n, reference.steps), (128, 64));
    assert!(
        matches!(scene.as_contact().unwrap().data, Data::Loads { ref traction, .. } if traction.is_empty())
    );
}

#[test]
fn absent_terms_are_absent() {
    let linear = shipped("linear-punch");
    let contact = linear.as_contact().unwrap().contact[0].clone();
    assert!(
        contact.gap.is_none()
            && contact.law.is_none()
            && linear.as_contact().unwrap().material.projection.is_none()
    );
    assert!(shipped("viscoelastic").as_contact().unwrap().contact.is_empty());
    assert!(shipped("steady").as_contact().unwrap().material.memory.is_empty());
    assert!(shipped("signorini").as_contact().unwrap().contact[0].clone().law.is_none());
}

#[test]
fn a_path_is_read_whatever_the_name() {
    let registry = Registry::open(&folder()).unwrap();
    let path = folder().join("affine.toml");
    assert_eq!(registry.load(&path.display().to_string()).unwrap().name, "affine");
}

#[test]
fn an_unknown_name_is_answered_with_the_nearest() {
    let registry = Registry::open(&folder()).unwrap();
    let message = registry.load("pure-mld").unwrap_err().to_string();
    assert!(
        message.contains("no scene is called `pure-mld`") && message.contains("`pure-mild`"),
        "{message}"
    );
    let message = registry.load("zzzzzz").unwrap_err().to_string();
    assert!(message.contains("known: abstract-bilateral, "), "{message}");
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
