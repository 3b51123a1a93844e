//! Scenes that must be refused, with the position and content of the message.
//!
//! Each case edits one place of a valid text and names the line and column (from 1) and a phrase.

use super::good::{BOX, EXACT, LOADED, refused};
use scene::{Scene, Source};

/// One edit of a valid text, and its message.
struct Case<'a> {
    from: &'static str,
    to: &'a str,
    line: usize,
    column: usize,
    phrase: &'static str,
}

const fn case<'a>(
    from: &'static str,
    to: &'a str,
    line: usize,
    column: usize,
    phrase: &'static str,
) -> Case<'a> {
    Case { from, to, line, column, phrase }
}

#[track_caller]
fn check(good: &str, cases: &[Case<'_>]) {
    for case in cases {
        assert_eq!(
            good.matches(case.from).count(),
            1,
            "`{}` is not unique in the good text",
            case.from
        );
        let diagnosis = refused(&good.replace(case.from, case.to));
        let shown = diagnosis.to_string();
        assert!(
            shown.contains(case.phrase),
            "`{}` is not said of `{}`:\n{shown}",
            case.phrase,
            case.to
        );
        assert_eq!((diagnosis.line(), diagnosis.column()), (case.line, case.column), "{shown}");
        let place = format!("block.toml:{}:{}", case.line, case.column);
        assert!(shown.contains(&place) && !diagnosis.hint.is_empty(), "{shown}");
    }
}

#[test]
#[rustfmt::skip]
fn grids_without_steps() {
    const TOO_SHORT: &str = "which is not above rounding of the horizon 1e0";
    check(LOADED, &[
        case("horizon = 1.0", "horizon = 5e-324", 14, 11, "a horizon of 5e-324 is too short"),
        case("\"uniform\"", "\"graded\", exponent = 200", 15, 8, TOO_SHORT),
        case("\"uniform\"", "\"graded\", exponent = 13", 35, 13, TOO_SHORT),
        case("body = [\"0\", \"-3*t*x\"]", "body = [\"0\", \"relax(1, t*relax(1, t*relax(1, t*relax(1, t*relax(1, t*x)))))\"]", 31, 15,
            "5 deep, and 4 is the limit"),
    ]);
}

#[test]
#[rustfmt::skip]
fn keys_and_types() {
    check(LOADED, &[
        case("gap = ", "gpa = ", 27, 1, "did you mean `gap`?"),
        case("[material.memory]", "[material.memroy]", 19, 11, "did you mean `memory`?"),
        case("[time]", "[tiem]", 13, 2, "did you mean `time`?"),
        case("slope_after", "slope_aftr", 28, 107, "did you mean `slope_after`?"),
        case("order = 1.0", "ordre = 1.0", 40, 1, "unknown key `ordre` in [[predicts]]"),
        case("horizon = 1.0\n", "", 13, 1, "[time] lacks the key `horizon`"),
        case("horizon = 1.0\n", "horizon = 1.0\nrule = \"lef\"\n", 15, 8, "did you mean `left`?"),
        case("horizon = 1.0\n", "horizon = 1.0\nrule = { kind = \"gregory\", order = 5 }\n", 15, 36, "5 is no order of Gregory's rule"),
        case("horizon = 1.0\n", "horizon = 1.0\nrule = { kind = \"left\", order = 3 }\n", 15, 25, "`order`"),
        case("grid = { kind = \"uniform\" }\n", "grid = { kind = \"random\", seed = 1 }\nrule = \"gregory\"\n", 16, 8, "equal steps"),
        case("why = \"(5.26)\"\n", "", 37, 1, "[[predicts]] lacks the key `why`"),
        case("[time]\nhorizon = 1.0\ngrid = { kind = \"uniform\" }\n", "", 38, 15, "the part [time] is missing"),
        case("size = [1.0, 0.5]", "size = \"1.0\"", 8, 8, "`domain.size`: expected a list in [ ], found the string"),
        case("dimension = 2", "dimension = 2.0", 4, 13, "expected a whole number"),
        case("[[predicts]]", "[predicts]", 37, 1, "double brackets"),
        case("judge = true", "judge = \"no\"", 5, 9, "expected true or false"),
        case("judge = true", "judge = true\njudge = false", 6, 1, "duplicate key `judge`"),
        case("shape = \"rectangle\"", "shape = \"rectangle", 7, 19, "not TOML: invalid basic string"),
        case("horizon = 1.0", "horizon = 1.0.0", 14, 14, "not TOML"),
    ]);
}

#[test]
#[rustfmt::skip]
fn heading_and_domain() {
    check(LOADED, &[
        case("dimension = 2", "dimension = 4", 4, 13, "4 is no dimension of a contact problem"),
        case("dimension = 2", "dimension = 3", 7, 9, "unknown value `rectangle` of `shape`"),
        case("name = \"block\"", "name = \"a block\"", 2, 8, "cannot name a scene"),
        case("judge = true", "expect = \"fails\"", 5, 10, "did you mean `fail`?"),
        case("judge = true", "violates = [\"2.8\"]", 5, 13, "known: 2.9, concave_gap, 5.1, 3.4, 3.17, 5.25"),
        case("judge = true", "window_n = [128, 32]", 5, 12, "[from, to] with from <= to"),
        case("\"rectangle\"", "\"rectangel\"", 7, 9, "did you mean `rectangle`?"),
        case("size = [1.0, 0.5]", "size = [1.0, -0.5]", 8, 14, "not positive"),
        case("size = [1.0, 0.5]", "size = [1.0, inf]", 8, 14, "not finite"),
        case("size = [1.0, 0.5]", "size = [1.0]", 8, 8, "1 entries, but 2 are expected"),
        case("traction = [\"left\", \"right\"]", "traction = [\"left\", \"top\"]", 10, 21, "the side `top` is in `clamped` and in `traction`"),
        case("traction = [\"left\", \"right\"]", "traction = [\"left\"]", 6, 1, "no condition on the side right"),
        case("clamped = [\"top\"]", "clamped = [\"up\"]", 9, 12, "unknown value `up` of `clamped`"),
        case("clamped = [\"top\"]\ntraction = [\"left\", ", "traction = [\"left\", \"top\", ", 6, 1, "no side is clamped"),
        case("clamped = [\"top\"]", "symmetry = [\"top\"]", 9, 12, "can move along its planes of symmetry"),
        case("clamped = [\"top\"]", "clamped = [\"top\"]\nsymmetry = [\"top\"]", 10, 13, "the side `top` is in `clamped` and in `symmetry`"),
        case("mesh = { kind = \"structured\" }", "mesh = { kind = \"perturbed\", amplitude = 0.3, seed = 1 }", 12, 42, "outside [0, 0.25)"),
        case("mesh = { kind = \"structured\" }", "mesh = { kind = \"perturbed\", amplitude = 0.1 }", 12, 8, "needs the key `seed`"),
        case("mesh = { kind = \"structured\" }", "mesh = { kind = \"structured\", seed = 1 }", 12, 31, "takes no `seed`"),
    ]);
}

#[test]
#[rustfmt::skip]
fn time_and_material() {
    check(LOADED, &[
        case("horizon = 1.0", "horizon = 0", 14, 11, "`horizon` = 0 is not positive"),
        case("kind = \"uniform\"", "kind = \"graded\"", 15, 8, "needs the key `exponent`"),
        case("kind = \"uniform\"", "kind = \"graded\", exponent = 0.5", 15, 38, "below 1"),
        case("kind = \"uniform\"", "kind = \"random\", seed = -1", 15, 34, "negative"),
        case("mu_L = 1.0", "mu_L = -1.0", 18, 8, "`mu_L` = -1 is not positive"),
        case("lambda = 1.0", "lambda = -2.0", 17, 10, "2 mu_L + 2 lambda = -2 is not positive"),
        case("mu_L = 1.0", "nu = 0.3", 16, 1, "[material] gives lambda, nu"),
        case("lambda = 1.0\nmu_L = 1.0", "E = 1.0\nnu = 0.5", 18, 6, "outside (-1, 0.5)"),
        case("-exp(-t)", "1/t", 20, 10, "the memory kernel is inf at t = 0"),
        case("-exp(-t)", "t^(-0.5)", 20, 10, "the memory kernel is inf at t = 0"),
        // The pole is no multiple of a step of any sampling.
        case("-exp(-t)", "1/(t - 0.3)", 20, 10, "the memory kernel has no bound near t = 0.300000"),
        case("-exp(-t)", "-exp(-x)", 20, 17, "`x` is not allowed here"),
        case("-exp(-t)", "-exp(-t", 20, 15, "a `)` is missing"),
        case("kappa = \"0.10 + 0.05*zeta\"", "kappa = \"0.10 - 0.05*zeta\"", 25, 9, "a yield bound must be finite and not negative"),
        case("kappa = \"0.10 + 0.05*zeta\"", "kappa = \"0.10 + sqrt(zeta)\"", 25, 9, "violates = [\"5.1\"]"),
        // Between samples at 0.05 apart.
        case("kappa = \"0.10 + 0.05*zeta\"", "kappa = \"0.10 - 9*max(0, 0.02 - abs(zeta - 0.725))\"", 25, 9, "a yield bound must be finite and not negative"),
        case("kappa = \"0.10 + 0.05*zeta\"", "kappa = \"if(zeta < 0.137, 0.1, 0.2)\"", 25, 9, "it jumps between 0.100000 and 0.200000 at zeta = 0.137000"),
        case("kappa = \"0.10 + 0.05*zeta\"", "kappa = \"0.1 + abs(zeta - 0.137)^0.5\"", 25, 9, "its derivative has no bound near zeta = 0.137000"),
        case("mu = 1.0\nkappa", "mu = -1.0\nkappa", 24, 6, "not be monotone"),
    ]);
}

#[test]
#[rustfmt::skip]
fn memory_and_regions() {
    let region = "mu_L = 1.0\n[[material.region]]\nname = \"a\"\nwhere = \"y - 0.25\"\n";
    check(LOADED, &[
        case("lambda = 0.25\n", "", 19, 1, "[material.memory] lacks the key `lambda`"),
        case("lambda = 0.25\n", "bulk = \"-exp(-t)\"\n", 19, 1, "one kernel with its tensor, or the kernels of bulk and shear"),
        case("kernel = \"-exp(-t)\"\nlambda = 0.25\nmu = 0.25\n", "", 19, 1, "one kernel with its tensor, or the kernels of bulk and shear"),
        case("kernel = \"-exp(-t)\"\nlambda = 0.25\nmu = 0.25\n", "bulk = \"-1\"\nshear = \"log(t)\"\n", 21, 9, "the memory kernel is -inf at t = 0"),
        case("\"-exp(-t)\"", "{ kind = \"pronny\" }", 20, 19, "did you mean `prony`?"),
        case("\"-exp(-t)\"", "{ kind = \"prony\" }", 20, 10, "kind `prony` needs the key `terms`"),
        case("\"-exp(-t)\"", "{ kind = \"prony\", terms = [[-1.0, 0.5], [-1.0]] }", 20, 50, "1 entries, but 2 are expected"),
        case("\"-exp(-t)\"", "{ kind = \"prony\", terms = [[-1.0, 0.0]] }", 20, 44, "is not positive"),
        case("\"-exp(-t)\"", "{ kind = \"prony\", terms = [[-1.0, 0.5]], time = 2.0 }", 20, 51, "takes no `time`"),
        case("\"-exp(-t)\"", "{ kind = \"power\", amplitude = -1.0, time = 1.0 }", 20, 10, "needs the key `exponent`"),
        case("\"-exp(-t)\"", "{ kind = \"power\", amplitude = -1.0, time = -1.0, exponent = 0.5 }", 20, 53, "`time` = -1 is not positive"),
        case("mu_L = 1.0\n", "mu_L = 1.0\nelasticity = { kind = \"full\" }\n", 16, 1, "gives lambda, mu_L, elasticity"),
        case("lambda = 1.0\nmu_L = 1.0\n", "elasticity = { kind = \"full\", mandel = [[1.0, 0.0], [0.0, 1.0]] }\n", 17, 40, "2 entries, but 3 are expected"),
        case("lambda = 1.0\nmu_L = 1.0\n", "elasticity = { kind = \"full\", mandel = [[2.0, 0.0, 0.1], [0.0, 2.0, 0.0], [0.0, 0.0, 1.0]] }\n", 17, 40, "entry (1, 3) is 0.1, entry (3, 1) is 0"),
        case("lambda = 1.0\nmu_L = 1.0\n", "elasticity = { kind = \"full\", mandel = [[2.0, 3.0, 0.0], [3.0, 2.0, 0.0], [0.0, 0.0, 1.0]] }\n", 17, 40, "its smallest eigenvalue m_A is -1"),
        case("lambda = 1.0\nmu_L = 1.0\n", "elasticity = { kind = \"orthotropic\", normal = [2.0, 3.0], coupling = [1.0] }\n", 17, 14, "kind `orthotropic` needs the key `shear`"),
        case("lambda = 1.0\nmu_L = 1.0\n", "elasticity = { kind = \"orthotropic\", normal = [2.0, 3.0], coupling = [2.5], shear = [1.0] }\n", 17, 14, "not positive definite"),
        case("mu_L = 1.0\n", &format!("{region}lambda = 2.0\n"), 19, 1, "[[material.region]] gives lambda: elasticity needs exactly one pair"),
        case("mu_L = 1.0\n", &format!("{region}E = 1.0\nnu = 0.3\n{}lambda = 1.0\nmu_L = 1.0\n", &region[11..]), 25, 8, "two regions are called `a`"),
        case("mu_L = 1.0\n", &format!("{}E = 1.0\nnu = 0.3\n", region.replace("y - 0.25", "t - 0.25")), 21, 10, "`t` is not allowed here"),
    ]);
}

#[test]
#[rustfmt::skip]
fn in_space() {
    assert!(Scene::from_source(Source::from_text("box.toml", BOX)).is_ok());
    check(BOX, &[
        case("\"box\"\nsize", "\"rectangle\"\nsize", 7, 9, "unknown value `rectangle` of `shape`"),
        case("[1.0, 0.5, 1.0]", "[1.0, 0.5]", 8, 8, "2 entries, but 3 are expected"),
        case(", \"back\"]", "]", 6, 1, "no condition on the side back"),
        // Saddles bend upward along one diagonal, kinks across one line.
        case("- 0.01*(x + z)^2", "+ 0.2*x*z", 19, 7, "second derivative 0.2"),
        case("- 0.01*(x + z)^2", "+ 0.1*abs(x - z)", 19, 7, "not concave on the side bottom"),
        case("- 0.01*(x + z)^2", "/ z", 19, 7, "`gap` is inf at x = 0, y = 0, z = 0"),
        case("\"vertex\"", "\"exact\"", 20, 14, "cuts edges"),
        case(", \"0\"]\ntraction", "]\ntraction", 22, 8, "2 components in dimension 3"),
        case("x*z\"", "x/z\"", 22, 14, "at x = 0, y = 0, z = 0, t = 0"),
        case("[loads]\nbody = [\"0\", \"-3*t*x*z\", \"0\"]\ntraction = { front = [\"0\", \"0\", \"x*t\"] }", "[exact]\nu = [\"0\", \"0\"]", 22, 5, "2 components in dimension 3"),
        case("[loads]", "[sweep]\nn = [4]\nsteps = [2]\nreference = { n = 6, steps = 4 }\n[loads]", 24, 19, "not a multiple"),
    ]);
}

#[test]
#[rustfmt::skip]
fn contact() {
    check(LOADED, &[
        case("gap = \"0.10\"", "gap = \"0.1 + 0.2*x^2\"", 27, 7, "not concave on the side bottom: second derivative 0.4"),
        case("gap = \"0.10\"", "gap = \"0.1 + 0.2*abs(x - 0.5)\"", 27, 7, "violates = [\"concave_gap\"]"),
        case("gap = \"0.10\"", "gap = \"0.1/x\"", 27, 7, "`gap` is inf at x = 0, y = 0"),
        case("gap = \"0.10\"", "shift = \"0.1*t\"", 27, 14, "`t` is not allowed here"),
        case("gap = \"0.10\"", "gap = \"0.1 + 0.2*t*x^2\"", 27, 7, "at x = 0.00390625, y = 0, t = 0.03125"),
        case("gap = \"0.10\"", "gap = \"0.1/(1 - 2*t)\"", 27, 7, "is inf at x = 0, y = 0, t = 0.5 on the side"),
        case("gap = \"0.10\"", "shift = \"log(x)\"", 27, 9, "`shift` is -inf at x = 0, y = 0"),
        case("[0.04, 0.08]", "[0.0, -0.1]", 28, 58, "(2.8c) then fails for every alpha"),
        case("[0.04, 0.08]", "[-0.04, 0.08]", 28, 58, "must be sorted"),
        case("[0.04, 0.08]", "[0.04, 0.08, 1.0]", 28, 58, "3 entries, but 2 are expected"),
        case("\"piecewise-linear\"", "\"linear\"", 28, 26, "takes no `points`"),
        case("\"piecewise-linear\"", "\"piecewise\"", 28, 16, "did you mean `piecewise-linear`?"),
        case("quadrature = \"vertex\"", "quadrature = \"exactly\"", 29, 14, "did you mean `exact`?"),
        case("[0.04, 0.08], [0.10, 0.05]], slope_before = 0.0, slope_after = 0.0 }\nquadrature = \"vertex\"", "[0.0, 0.08]], slope_before = 0.0, slope_after = 0.0 }\nquadrature = \"exact\"", 29, 14, "use quadrature = \"vertex\""),
        case("[0.04, 0.08], [0.10, 0.05]], slope_before = 0.0, slope_after = 0.0 }\nquadrature = \"vertex\"", "[0.0, 0.08]], slope_before = 0.0, slope_after = 0.0 }\nquadrature = \"gauss\"", 29, 14, "a law with a jump"),
        case("contact = [\"bottom\"]", "", 6, 1, "no condition on the side bottom"),
        case("traction = [\"left\", \"right\"]\ncontact = [\"bottom\"]", "traction = [\"left\", \"right\", \"bottom\"]", 25, 1, "[contact] without a contact side"),
    ]);
}

#[test]
#[rustfmt::skip]
fn loads_sweep_and_predictions() {
    check(LOADED, &[
        case("body = [\"0\", \"-3*t*x\"]", "body = [\"0\"]", 31, 8, "1 components in dimension 2"),
        case("body = [\"0\", \"-3*t*x\"]", "body = [\"0\", \"-3*t*q\"]", 31, 20, "unknown name `q`"),
        case("body = [\"0\", \"-3*t*x\"]", "body = [\"0\", \"1/t\"]", 31, 14, "the load is inf at x = 0, y = 0, t = 0"),
        case("left = [\"0\", \"t\"]", "top = [\"0\", \"t\"]", 32, 14, "not a traction side"),
        case("n = [8, 16]", "n = [8, 3]", 34, 9, "n = 3 does not divide side 0.5 into whole cells"),
        case("n = [8, 16]", "n = [8, 8]", 34, 9, "8 is listed twice"),
        case("steps = [8, 16]", "steps = [8, 0]", 35, 13, "whole number from 1"),
        case("reference = { n = 64, steps = 64 }", "reference = { n = 40, steps = 64 }", 36, 19, "not a multiple of n = 16"),
        case("reference = { n = 64, steps = 64 }", "reference = { n = 16, steps = 16 }", 36, 13, "its error would be 0"),
        case("reference = { n = 64, steps = 64 }", "", 33, 1, "errors cannot be measured"),
        case("norm = \"V_max\"", "norm = \"V_mx\"", 38, 8, "did you mean `V_max`?"),
        case("order = 1.0", "order = 0.0", 40, 9, "not positive"),
        case("variable = \"h\"", "variable = \"joint\"", 37, 1, "order_k = 2.0"),
        case("why = \"(5.26)\"", "why = \" \"", 41, 7, "`why` is empty"),
        case("[loads]", "[exact]\nu = [\"0\", \"0\"]\n[loads]", 32, 1, "both [exact] and [loads]"),
        case("[loads]\nbody = [\"0\", \"-3*t*x\"]\ntraction = { left = [\"0\", \"t\"] }\n", "", 38, 15, "neither [exact] nor [loads]"),
    ]);
}

#[test]
#[rustfmt::skip]
fn exact_solutions() {
    check(EXACT, &[
        case("'-a*(1 - y)'", "'-a*(1 - w)'", 19, 28, "unknown name `w`"),
        case("'-a*(1 - y)'", "'-a*(1 - y)', \"0\"", 19, 5, "3 components in dimension 2"),
        case("gap = \"G\"", "", 20, 1, "needs a finite gap"),
        case("gap = \"G\"", "gap = \"inf\"", 20, 1, "needs a finite gap"),
        case("form = \"strong\"", "selection = \"0\"", 21, 1, "a selection without a law"),
        case("form = \"strong\"", "form = \"week\"", 21, 8, "did you mean `weak`?"),
        case("b = \"A*sin(2*t)\"", "t = \"A*sin(2*t)\"", 26, 1, "`t` is a reserved name"),
        case("b = \"A*sin(2*t)\"", "b = \"a*sin(2*t)\"", 26, 6, "may use only those above it"),
        case("b = \"A*sin(2*t)\"", "A = \"1\"\nb = \"A*sin(2*t)\"", 26, 1, "`A` is a parameter already"),
        case("b = \"A*sin(2*t)\"", "b-1 = \"A*sin(2*t)\"", 26, 1, "cannot be used in a formula"),
        case("A = 0.3", "A = \"x\"", 23, 6, "`x` is not allowed here"),
        case("A = 0.3", "A = inf", 23, 5, "unknown name `inf`"),
    ]);
}

#[test]
fn contact_and_its_sides_come_together() {
    let start = LOADED.find("[contact]").unwrap();
    let end = LOADED.find("[loads]").unwrap();
    let sides_only = LOADED.replace(&LOADED[start..end], "");
    let shown = refused(&sides_only).to_string();
    assert!(shown.contains("block.toml:11:11"), "{shown}");
    assert!(shown.contains("contact sides, but no part [contact]"), "{shown}");
    let none = sides_only.replace("\"right\"]\ncontact = [\"bottom\"]", "\"right\", \"bottom\"]");
    let shown = refused(&none.replace("V_max", "trace_L2_max")).to_string();
    assert!(shown.contains("`trace_L2_max` is measured on Γ3"), "{shown}");
    assert!(Scene::from_source(Source::from_text("block.toml", none)).is_ok());
}

#[test]
#[rustfmt::skip]
fn contact_sides_with_laws_of_their_own() {
    let two = LOADED.replace("[\"left\", \"right\"]", "[\"right\"]").replace("[\"bottom\"]", "[\"bottom\", \"left\"]")
        .replace("traction = { left = [\"0\", \"t\"] }\n", "")
        .replace("[contact]\n", "[[contact]]\nsides = [\"left\"]\nlaw = { kind = \"none\" }\n[[contact]]\nsides = [\"bottom\"]\n");
    check(&two, &[
        case("sides = [\"left\"]\n", "", 26, 1, "lacks the key `sides`"),
        case("sides = [\"left\"]\n", "sides = [\"left\", \"bottom\"]\n", 30, 10, "the contact side `bottom` has two tables"),
        case("sides = [\"left\"]\n", "sides = [\"right\"]\n", 27, 10, "`right` is not a contact side"),
        case("sides = [\"left\"]\n", "sides = [\"lef\"]\n", 27, 10, "did you mean `left`?"),
        case("sides = [\"left\"]\n", "sides = []\n", 27, 9, "the list `sides` is empty"),
        case("quadrature = \"vertex\"", "quadrature = \"gauss\"", 33, 14, "contact sides with different quadratures"),
        case("quadrature = \"vertex\"", "friction = { bound = \"0.1\" }", 33, 12, "friction beside other contact sides"),
    ]);
    check(&two, &[case("[[contact]]\nsides = [\"left\"]\nlaw = { kind = \"none\" }\n", "", 26, 1, "the contact side `left` is in no table [[contact]]")]);
}
