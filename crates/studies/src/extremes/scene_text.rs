//! The text of a body in contact, from its parts.

/// Parts of a scene file; what a ladder does not change stays at the unit square of unit material.
#[derive(Debug, Clone)]
pub(super) struct SceneText {
    pub(super) dimension: i32,
    /// `[domain]` without its heading.
    pub(super) domain: String,
    /// T.
    pub(super) horizon: f64,
    /// λ and μ_L.
    pub(super) lame: [f64; 2],
    /// Everything after `[material]`: memory, projection, contact, and `[exact]` or `[loads]`.
    pub(super) rest: String,
}

/// The unit square, clamped at the top.
const SQUARE: &str = "shape = \"rectangle\"\nsize = [1.0, 1.0]\nclamped = [\"top\"]\n";

impl SceneText {
    /// The unit square under tractions on all sides but the clamped one.
    pub(super) fn free(rest: impl Into<String>) -> Self {
        let domain = format!("{SQUARE}traction = [\"left\", \"right\", \"bottom\"]\n");
        Self { dimension: 2, domain, horizon: 1.0, lame: [1.0, 1.0], rest: rest.into() }
    }

    /// The unit square with contact at the bottom.
    pub(super) fn in_contact(rest: impl Into<String>) -> Self {
        let domain = format!("{SQUARE}traction = [\"left\", \"right\"]\ncontact = [\"bottom\"]\n");
        Self { domain, ..Self::free(rest) }
    }

    /// The domain of a parallelogram with the sides (1, 0) and `side`, free but for its clamped top.
    pub(super) fn parallelogram([x, y]: [f64; 2]) -> String {
        format!(
            "shape = \"polygon\"\nvertices = [[0.0, 0.0], [1.0, 0.0], [{:?}, {y:?}], [{x:?}, {y:?}]]\nsides = [\"bottom\", \"right\", \"top\", \"left\"]\nclamped = [\"top\"]\ntraction = [\"left\", \"right\", \"bottom\"]\n",
            1.0 + x
        )
    }

    pub(super) fn text(&self) -> String {
        let [lambda, mu] = self.lame;
        format!(
            "[scene]\nname = \"extreme\"\nquestion = \"Does it work at the extreme?\"\ndimension = {}\njudge = false\n[domain]\n{}[time]\nhorizon = {:?}\n[material]\nlambda = {lambda:?}\nmu_L = {mu:?}\n{}",
            self.dimension, self.domain, self.horizon, self.rest
        )
    }
}

/// The block of the scene `punch`, every term active, with the given gap and factor of the load.
pub(super) fn punch(gap: &str, load: f64) -> String {
    SceneText::in_contact(format!(
        "[material.memory]\nkernel = \"-exp(-t)\"\nlambda = 0.25\nmu = 0.25\n[material.projection]\nmu = 1.0\nkappa = \"0.10 + 0.05*zeta\"\n[contact]\ngap = \"{gap}\"\nlaw = {{ kind = \"piecewise-linear\", points = [[0.0, 0.0], [0.04, 0.08], [0.10, 0.05]], slope_before = 0.0, slope_after = 0.0 }}\n[loads]\nbody = [\"0\", \"{:?}*t*x\"]\n",
        -3.0 * load
    ))
    .text()
}
