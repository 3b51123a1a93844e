//! Examples of missing parts and keys, for messages.

/// A line to add, by dotted name without list indices; keys of tables that may be in several places by the last two names.
const LINES: [(&str, &str); 52] = [
    ("scene", "[scene] holds name, question, dimension"),
    ("scene.name", "name = \"punch\""),
    ("scene.question", "question = \"What this scene decides, in one sentence.\""),
    ("scene.dimension", "dimension = 2"),
    ("domain", "[domain] holds shape, size, and the sides: clamped, symmetry, traction, contact"),
    ("domain.shape", "shape = \"rectangle\""),
    ("domain.size", "size = [1.0, 1.0]"),
    ("domain.vertices", "vertices = [[0.0, 0.0], [1.0, 0.0], [0.5, 1.0]]"),
    ("domain.file", "file = \"block.msh\""),
    ("domain.mesh.kind", "kind = \"structured\""),
    ("mesh.amplitude", "amplitude = 0.2"),
    ("mesh.seed", "seed = 1"),
    ("mesh.corner", "corner = [0.0, 0.0]"),
    ("mesh.exponent", "exponent = 2.0"),
    ("time", "[time] holds horizon"),
    ("time.horizon", "horizon = 1.0"),
    ("time.grid.kind", "kind = \"uniform\""),
    ("grid.exponent", "exponent = 2.0"),
    ("grid.seed", "seed = 1"),
    ("rule.exponent", "exponent = 0.5"),
    ("material", "[material] holds lambda and mu_L, or E and nu"),
    ("kernel.amplitude", "amplitude = 0.5"),
    ("kernel.time", "time = 0.5"),
    ("kernel.exponent", "exponent = 0.5"),
    ("material.memory.kernel", "kernel = \"-exp(-t)\""),
    ("material.memory.lambda", "lambda = 0.25"),
    ("material.memory.mu", "mu = 0.25"),
    ("material.projection.mu", "mu = 1.0"),
    ("material.projection.kappa", "kappa = \"0.10 + 0.05*zeta\""),
    ("law.kind", "kind = \"piecewise-linear\""),
    ("law.stiffness", "stiffness = 2.0"),
    ("law.length", "length = 0.05"),
    ("law.coefficient", "coefficient = 2.0"),
    ("law.exponent", "exponent = 1.5"),
    ("law.until", "until = 0.1"),
    ("law.points", "points = [[0.0, 0.0], [0.04, 0.08], [0.10, 0.05]]"),
    ("law.slope_before", "slope_before = 0.0"),
    ("law.slope_after", "slope_after = 0.0"),
    ("bound.points", "points = [[0.0, 0.3], [0.1, 0.28]]"),
    ("bound.coefficient", "coefficient = \"0.3\""),
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
    let ends = plain.rmatch_indices('.').nth(1).map_or("", |(dot, _)| &plain[dot + 1..]);
    let named = |(known, _): &&(&str, &str)| *known == plain || *known == ends;
    LINES.iter().find(named).map(|(_, line)| *line)
}
