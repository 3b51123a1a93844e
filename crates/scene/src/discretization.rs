//! `[discretization]`: the element of displacements.

use fem::space::Element;

use super::contact::Contact;
use super::data::Data;
use super::diagnostic::SceneError;
use super::reading::Reading;
use super::sweep::Sweep;
use super::validated::{Body, Scene};
use crate::ContactQuadrature;

/// The parts of a scene that restrict the choice of the element.
pub(super) struct Parts<'a> {
    pub dimension: usize,
    pub contact: Option<&'a Contact>,
    pub data: &'a Data,
    pub sweep: Option<&'a Sweep>,
}

pub(super) const KEY: &str = "discretization.element";

/// The element of a scene; P1 by default.
///
/// # Errors
/// An unknown element, or one incompatible with a part of the scene.
pub(super) fn element(reading: &Reading, parts: &Parts<'_>) -> Result<Element, SceneError> {
    let known = Element::ALL.map(|known| (known.name(), known));
    let element = reading.choice_or(KEY, &known, Element::P1)?;
    match refusal(element, parts) {
        Some([message, hint]) => Err(reading.error(KEY, message, hint)),
        None => Ok(element),
    }
}

/// Why a scene with these parts cannot have an element, and the way out.
fn refusal(element: Element, parts: &Parts<'_>) -> Option<[&'static str; 2]> {
    if element == Element::P1 {
        return None;
    }
    if parts.contact.is_some_and(|contact| contact.quadrature != ContactQuadrature::Vertex) {
        let message = "P2 integrates the contact law by Simpson's rule on edges, by the midpoints on triangles; CR by barycentres of facets";
        return Some([message, "say quadrature = \"vertex\" in [contact], or take P1"]);
    }
    let rubs = |contact: &Contact| contact.friction.is_some();
    if parts.dimension == 3 && parts.contact.is_some_and(rubs) {
        let message = "friction on facets in space is known for P1 alone";
        return Some([message, "remove [contact.friction], or take P1"]);
    }
    if element.is_conforming() { None } else { not_conforming(parts) }
}

/// Further restrictions of nonconforming elements.
fn not_conforming(parts: &Parts<'_>) -> Option<[&'static str; 2]> {
    if parts.data.is_interpolated() {
        let message =
            "interpolated = true takes an interpolant of u in V, and V^h of CR is not in V";
        return Some([message, "remove `interpolated`, or take P1 or P2"]);
    }
    if parts.sweep.is_some_and(|sweep| sweep.reference.is_some() || sweep.by_state) {
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
            let parts = Parts {
                dimension: self.dimension,
                contact: body.contact.as_ref(),
                data: &body.data,
                sweep: self.sweep.as_ref(),
            };
            if let Some([message, hint]) = refusal(element, &parts) {
                return Err(self.error(KEY, message, hint));
            }
            body.element = element;
        }
        Ok(scene)
    }
}
