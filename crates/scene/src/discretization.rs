//! `[discretization]`: the element of displacements.

use fem::space::Element;

use super::diagnostic::SceneError;
use super::reading::Reading;
use super::sweep::Sweep;
use super::validated::{Body, ContactScene, Scene};
use crate::ContactQuadrature;

pub(super) const KEY: &str = "discretization.element";

/// The element of a scene of linear elements so far; P1 by default.
///
/// # Errors
/// An unknown element, or one incompatible with a part of the scene.
pub(super) fn element(
    reading: &Reading,
    body: &ContactScene,
    sweep: Option<&Sweep>,
) -> Result<Element, SceneError> {
    let known = Element::ALL.map(|known| (known.name(), known));
    let element = reading.choice_or(KEY, &known, Element::P1)?;
    match refusal(element, body, sweep) {
        Some([message, hint]) => Err(reading.error(KEY, message, hint)),
        None => Ok(element),
    }
}

/// Why a body with this sweep cannot have an element, and the way out.
fn refusal(
    element: Element,
    body: &ContactScene,
    sweep: Option<&Sweep>,
) -> Option<[&'static str; 2]> {
    if element == Element::P1 {
        return None;
    }
    let quadrature = body.contact.as_ref().map(|contact| contact.quadrature);
    if quadrature.is_some_and(|rule| rule != ContactQuadrature::Vertex) {
        let message = "P2 integrates the contact law by Simpson's rule on edges, by the midpoints on triangles; CR by barycentres of facets";
        return Some([message, "say quadrature = \"vertex\" in [contact], or take P1"]);
    }
    if body.domain.dimension() == 3 && body.friction().is_some() {
        let message = "friction on facets in space is known for P1 alone";
        return Some([message, "remove [contact.friction], or take P1"]);
    }
    if element.is_conforming() {
        return None;
    }
    if body.data.is_interpolated() {
        let message =
            "interpolated = true takes an interpolant of u in V, and V^h of CR is not in V";
        return Some([message, "remove `interpolated`, or take P1 or P2"]);
    }
    if sweep.is_some_and(|sweep| sweep.reference.is_some() || sweep.by_state) {
        let message =
            "a finer run, and errors by contact state, are known for continuous functions alone";
        return Some([message, "remove `reference` and `by_state`, or take P1"]);
    }
    None
}

impl Scene {
    /// The scene with another element.
    ///
    /// # Errors
    /// At `discretization.element`, as if the file named the element.
    pub fn with_element(&self, element: Element) -> Result<Self, SceneError> {
        let mut scene = self.clone();
        if let Body::Contact(body) = &mut scene.body {
            if let Some([message, hint]) = refusal(element, body, self.sweep.as_ref()) {
                return Err(self.error(KEY, message, hint));
            }
            body.element = element;
        }
        Ok(scene)
    }
}
