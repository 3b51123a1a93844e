//! What a scene may have beyond the setting of the paper, and commands that leave it out of account.

use super::diagnostic::Result;
use super::validated::{Body, Scene};

/// Beyond the paper's kernels without a pole and contact without friction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extension {
    /// `[contact.friction]`.
    Friction,
    /// Kernels that are infinite at s = t.
    SingularKernel,
}

impl Extension {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Friction, Self::SingularKernel];

    /// The key that asks for it in a scene, its name, and the way out; none where the scene does without.
    fn asked_by(self, scene: &Scene) -> Option<(String, String, &'static str)> {
        let body = scene.as_contact();
        match self {
            Self::Friction => {
                let way_out = "run, gate, verify, check, bound and solve do; for this command take a scene without [contact.friction]";
                body?.friction().map(|_| ("contact.friction".into(), "friction".into(), way_out))
            }
            Self::SingularKernel => {
                let key = match &scene.body {
                    Body::Contact(body) => body.material.singular_key(),
                    Body::Abstract(problem) => problem.singular_key(),
                };
                let name = "kernels that are infinite at s = t".into();
                let way_out = "list, check, run, gate, verify, solve, diagnose and gronwall do; for this command remove `singular`";
                key.map(|key| (key, name, way_out))
            }
        }
    }
}

impl Scene {
    /// Refuses a scene with one of these for a command that leaves them out of account, and says why it does.
    ///
    /// # Errors
    /// At the key that asks for the first of them.
    pub fn without(&self, extensions: &[Extension], command: &str, why: &str) -> Result<()> {
        match extensions.iter().find_map(|extension| extension.asked_by(self)) {
            None => Ok(()),
            Some((key, what, way_out)) => {
                Err(self.error(&key, format!("`{command}` does not treat {what}: {why}"), way_out))
            }
        }
    }
}
