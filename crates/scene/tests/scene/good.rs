//! Valid texts, from which the malformed ones are made.

use scene::{Scene, SceneError, Source, TextFault};

/// A valid scene with loads; tests count its lines.
pub(super) const LOADED: &str = r#"[scene]
name = "block"
question = "Is this text refused where it should be?"
dimension = 2
judge = true
[domain]
shape = "rectangle"
size = [1.0, 0.5]
clamped = ["top"]
traction = ["left", "right"]
contact = ["bottom"]
mesh = { kind = "structured" }
[time]
horizon = 1.0
grid = { kind = "uniform" }
[material]
lambda = 1.0
mu_L = 1.0
[material.memory]
kernel = "-exp(-t)"
lambda = 0.25
mu = 0.25
[material.projection]
mu = 1.0
kappa = "0.10 + 0.05*zeta"
[contact]
gap = "0.10"
law = { kind = "piecewise-linear", points = [[0.0, 0.0], [0.04, 0.08], [0.10, 0.05]], slope_before = 0.0, slope_after = 0.0 }
quadrature = "vertex"
[loads]
body = ["0", "-3*t*x"]
traction = { left = ["0", "t"] }
[sweep]
n = [8, 16]
steps = [8, 16]
reference = { n = 64, steps = 64 }
[[predicts]]
norm = "V_max"
variable = "h"
order = 1.0
why = "(5.26)"
"#;

/// A valid scene in space; tests count its lines.
pub(super) const BOX: &str = r#"[scene]
name = "box"
question = "Is this text refused where it should be?"
dimension = 3
judge = false
[domain]
shape = "box"
size = [1.0, 0.5, 1.0]
clamped = ["top"]
traction = ["left", "right", "front", "back"]
contact = ["bottom"]
[time]
horizon = 1.0
grid = { kind = "uniform" }
[material]
lambda = 1.0
mu_L = 1.0
[contact]
gap = "0.10 - 0.01*(x + z)^2"
quadrature = "vertex"
[loads]
body = ["0", "-3*t*x*z", "0"]
traction = { front = ["0", "0", "x*t"] }
"#;

/// A valid scene with an exact solution; tests count its lines.
pub(super) const EXACT: &str = r#"[scene]
name = "exact"
question = "Is this text refused where it should be?"
dimension = 2
[domain]
shape = "rectangle"
size = [1.0, 1.0]
clamped = ["top"]
traction = ["left", "right"]
contact = ["bottom"]
[time]
horizon = 1.0
[material]
E = 2.5
nu = 0.25
[contact]
gap = "G"
[exact]
u = ["b*(1 - y)", '-a*(1 - y)']
multiplier = "0"
form = "strong"
[exact.parameters]
A = 0.3
G = "A/3"
[exact.define]
b = "A*sin(2*t)"
a = "0.08*t*(2 - t)"
[sweep]
n = [4]
steps = [4, 8]
[[predicts]]
norm = "V_max"
variable = "k"
order = 2.0
why = "(5.26)"
"#;

pub(super) fn refused(text: &str) -> TextFault {
    match Scene::from_source(Source::from_text("block.toml", text)) {
        Ok(_) => panic!("accepted:\n{text}"),
        Err(SceneError::Text(diagnosis)) => *diagnosis,
        Err(other) => panic!("no place in the text: {other}"),
    }
}

#[test]
fn the_good_texts_are_good() {
    for text in [LOADED, EXACT] {
        if let Err(error) = Scene::from_source(Source::from_text("block.toml", text)) {
            panic!("{error}");
        }
    }
}
