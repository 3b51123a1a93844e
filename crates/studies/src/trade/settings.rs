//! What a scene file may say otherwise about how the same problem is discretised.

use fem::space::Element;
use scene::setup::Setup;
use scene::{Body, Change, ContactQuadrature, ContactScene, Data, LoadForm};

/// A change of the body of a scene.
fn of_body(words: &str, change: impl Fn(&mut ContactScene) + Send + Sync + 'static) -> Change {
    Change::new(words, move |mut scene| {
        if let Body::Contact(body) = &mut scene.body {
            change(body);
        }
        Ok(scene)
    })
}

/// The settings that a scene offers beside h, k and the element.
pub(super) fn settings(setup: &Setup) -> Vec<Change> {
    let mut found = Vec::new();
    if let Data::Exact { interpolated: false, form: written, .. } = setup.body.data {
        let (words, other) = match written {
            LoadForm::Weak => ("strong loads", LoadForm::Strong),
            LoadForm::Strong => ("weak loads", LoadForm::Weak),
        };
        found.push(of_body(words, move |body| {
            if let Data::Exact { form, .. } = &mut body.data {
                *form = other;
            }
        }));
    }
    // A jump has no value at a point that is held there; edges are cut in the plane alone.
    let law = setup.body.law().filter(|law| !law.is_set_valued());
    for (words, rule) in [
        ("contact by vertices", ContactQuadrature::Vertex),
        ("contact by Gauss points", ContactQuadrature::Gauss),
        ("contact exact", ContactQuadrature::Exact),
    ] {
        let cut = rule == ContactQuadrature::Exact && setup.scene.dimension > 2;
        if law.is_some() && rule != setup.rule() && rule.serves(setup.body.element) && !cut {
            found.push(of_body(words, move |body| {
                body.contact.iter_mut().for_each(|contact| contact.quadrature = rule);
            }));
        }
    }
    found
}

/// The other elements that a scene may have.
pub(super) fn elements(setup: &Setup) -> Vec<(Element, Change)> {
    let others = Element::ALL.into_iter().filter(|&other| other != setup.body.element);
    let admitted = others.filter(|&other| setup.scene.with_element(other).is_ok());
    let change = |element: Element| {
        let words = format!("element {}", element.name());
        (element, Change::new(words, move |scene| scene.with_element(element)))
    };
    admitted.map(change).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::Scene;

    fn offered(name: &str) -> String {
        let path = format!("{}/../../manufactured/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        let setup = Setup::new(Scene::read(path.as_ref()).expect("a scene")).expect("a setup");
        let elements = elements(&setup).into_iter().map(|(_, change)| change);
        let all: Vec<Change> = settings(&setup).into_iter().chain(elements).collect();
        for change in &all {
            let changed = change.of(&setup.scene).expect("a scene that may be so");
            assert!(Setup::new(changed).is_ok(), "{name}: {change:?}");
        }
        all.iter().map(Change::words).collect::<Vec<_>>().join(", ")
    }

    #[test]
    fn a_scene_offers_what_its_file_may_say() {
        for (name, words) in [
            ("pure-mild", "strong loads, contact by Gauss points, contact exact, element P2"),
            // Quadratic elements have one rule on Γ3; without a law there is none.
            ("quadratic-compliance", "strong loads, element P1"),
            ("signorini", "strong loads, element P2"),
            // Given loads are what they are, and nothing is integrated where u lives in V^h.
            ("linear-punch", "element P2"),
            ("in-space", "contact by Gauss points, contact exact, element P2"),
            // The plane alone cuts edges.
            ("pure-box", "strong loads, contact by Gauss points, element P2"),
        ] {
            assert_eq!(offered(name), words, "{name}");
        }
    }
}
