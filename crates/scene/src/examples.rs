//! Examples of missing parts and keys, for messages.

/// A line to add, by dotted name without list indices.
const LINES: [(&str, &str); 30] = [
    ("scene", "[scene] holds name, question, dimension"),
    ("scene.name", "name = \"punch\""),
    ("scene.question", "question = \"What this scene decides, in one sentence.\""),
    ("scene.dimension", "dimension = 2"),
    ("domain", "[domain] holds shape, size, and the sides: clamped, traction, contact"),
    ("domain.shape", "shape = \"rectangle\""),
    ("domain.size", "size = [1.0, 1.0]"),
    ("domain.mesh.kind", "kind = \"structured\""),
    ("time", "[time] holds horizon"),
    ("time.horizon", "horizon = 1.0"),
    ("time.grid.kind", "kind = \"uniform\""),
    ("material", "[material] holds lambda and mu_L, or E and nu"),
    ("material.memory.kernel", "kernel = \"-exp(-t)\""),
    ("material.memory.lambda", "lambda = 0.25"),
    ("material.memory.mu", "mu = 0.25"),
    ("material.projection.mu", "mu = 1.0"),
    ("material.projection.kappa", "kappa = \"0.10 + 0.05*zeta\""),
    ("contact.law.kind", "kind = \"piecewise-linear\""),
    ("loads.body", "body = [\"0\", \"-3*t*x\"]"),
    ("exact.u", "u = [\"0.1*sin(t)*(1-y)\", \"0\"]"),
    ("sweep.n", "n = [8, 16, 32]"),
    ("sweep.steps", "steps = [8, 16, 32]"),
    ("sweep.reference.n", "n = 128"),
    ("sweep.reference.steps", "steps = 64"),
    ("predicts", "write [[predicts]], with double brackets: there may be several"),
    ("predicts.norm", "norm = \"V_max\""),
    ("predicts.variable", "variable = \"h\""),
    ("predicts.order", "order = 1.0"),
    ("predicts.why", "why = \"(5.26)\""),
    ("domain.clamped", "clamped = [\"top\"]"),
];

/// The line to add for a dotted name such as `predicts.0.order`.
pub(super) fn example(name: &str) -> Option<&'static str> {
    let is_index = |part: &&str| part.parse::<usize>().is_err();
    let plain = name.split('.').filter(is_index).collect::<Vec<_>>().join(".");
    LINES.iter().find(|(known, _)| *known == plain).map(|(_, line)| *line)
}
