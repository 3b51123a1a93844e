//! What a scene may have beyond the setting of the paper, and commands that leave it out of account.

use super::diagnostic::SceneError;
use super::discretization;
use super::validated::{Body, Scene};

/// Beyond the paper's linear elements, kernels without a pole and contact without friction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extension {
    /// `[contact.friction]`.
    Friction,
    /// An element whose functions jump: V^h is not in V.
    Nonconforming,
    /// Kernels that are infinite at s = t.
    SingularKernel,
}

impl Extension {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Friction, Self::Nonconforming, Self::SingularKernel];

    /// The key that asks for it in a scene, and its name; none where the scene does without.
    fn asked_by(self, scene: &Scene) -> Option<(String, String)> {
        let body = scene.as_contact();
        match self {
            Self::Friction => {
                let contact = body?.contact.as_ref()?;
                contact.friction.as_ref().map(|_| ("contact.friction".into(), "friction".into()))
            }
            Self::Nonconforming => {
                let element = body?.element;
                let name = format!("{} elements", element.name());
                (!element.is_conforming()).then(|| (discretization::KEY.into(), name))
            }
            Self::SingularKernel => {
                let name = "kernels that are infinite at s = t".into();
                let key = match &scene.body {
                    Body::Contact(body) => body.material.singular_key(),
                    Body::Abstract(problem) => problem.singular_key(),
                };
                key.map(|key| (key, name))
            }
        }
    }

    fn way_out(self) -> &'static str {
        match self {
            Self::Friction => {
                "run, gate, verify, check, bound and solve do; for this command take a scene without [contact.friction]"
            }
            Self::Nonconforming => {
                "list, check, explain, run, gate, verify, solve, trade and gronwall do; for this command take P1 or P2"
            }
            Self::SingularKernel => {
                "list, check, explain, run, gate, verify, solve, diagnose and gronwall do; for this command remove `singular`"
            }
        }
    }
}

impl Scene {
    /// Refuses a scene with one of these for a command that leaves them out of account, and says why it does.
    ///
    /// # Errors
    /// At the key that asks for the first of them.
    pub fn without(
        &self,
        extensions: &[Extension],
        command: &str,
        why: &str,
    ) -> Result<(), SceneError> {
        let asked = |extension: &Extension| Some((extension.way_out(), extension.asked_by(self)?));
        match extensions.iter().find_map(asked) {
            None => Ok(()),
            Some((way_out, (key, what))) => {
                Err(self.error(&key, format!("`{command}` does not treat {what}: {why}"), way_out))
            }
        }
    }
}
