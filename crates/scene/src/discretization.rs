//! `[discretization]`: the element of displacements.

use fem::space::Element;

use super::diagnostic::Result;
use super::reading::Reading;
use super::validated::{Body, ContactScene, Scene};
use crate::ContactQuadrature;

pub(super) const KEY: &str = "discretization.element";

/// The element of a scene of linear elements so far; P1 by default.
///
/// # Errors
/// An unknown element, or one incompatible with a part of the scene.
pub(super) fn element(reading: &Reading, body: &ContactScene) -> Result<Element> {
    let known = Element::ALL.map(|known| (known.name(), known));
    let element = reading.choice_or(KEY, &known, Element::P1)?;
    match refusal(element, body) {
        Some([message, hint]) => Err(reading.error(KEY, message, hint)),
        None => Ok(element),
    }
}

/// Why a body cannot have an element, and the way out.
fn refusal(element: Element, body: &ContactScene) -> Option<[&'static str; 2]> {
    if element == Element::P1 {
        return None;
    }
    let quadrature = body.contact.as_ref().map(|contact| contact.quadrature);
    if quadrature.is_some_and(|rule| rule != ContactQuadrature::Vertex) {
        let message = "P2 integrates the contact law by Simpson's rule on edges, by the midpoints on triangles";
        return Some([message, "say quadrature = \"vertex\" in [contact], or take P1"]);
    }
    if body.domain.dimension() == 3 && body.friction().is_some() {
        let message = "P2 has no friction in space, where its contact is at midpoints alone";
        return Some([message, "remove [contact.friction], or take P1"]);
    }
    None
}

impl Scene {
    /// The scene with another element.
    ///
    /// # Errors
    /// At `discretization.element`, as if the file named the element.
    pub fn with_element(&self, element: Element) -> Result<Self> {
        let mut scene = self.clone();
        if let Body::Contact(body) = &mut scene.body {
            if let Some([message, hint]) = refusal(element, body) {
                return Err(self.error(KEY, message, hint));
            }
            body.element = element;
        }
        Ok(scene)
    }
}
