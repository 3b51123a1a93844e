//! `[scene]`, `[time]`, `[loads]`, `[exact]`, `[sweep]` and `[[predicts]]`.

use formula::EvaluationPoint;
use judge::record::{Key, V_MAX};
use judge::verdict::Foreseen;
use run::sweep::{Overrides, ScenePlan, foresee_plan};
use scene::setup::{Setup, Subject};
use scene::{Data, Direction, Expectation, Hypothesis, LoadForm, Norm, Reference, Scene, TimeRule};

use super::{ORIGIN, Tie, block, near, scene, value, with};

pub const TIES: &[Tie] = &[
    (&["scene.name", "scene.question", "scene.kind", "scene.dimension"], heading),
    (&["scene.judge", "scene.expect", "scene.long", "scene.violates"], judging),
    (&["scene.window_n", "scene.window_steps"], windows),
    (&["time.horizon", "time.grid.kind", "time.grid.exponent", "time.grid.seed"], grids),
    (&["time.rule.kind", "time.rule.exponent", "time.rule.order"], rules),
    (&["loads.body", "loads.traction"], loads),
    (
        &[
            "exact.u",
            "exact.multiplier",
            "exact.selection",
            "exact.friction",
            "exact.interpolated",
            "exact.form",
            "exact.parameters",
            "exact.define",
        ],
        exact,
    ),
    (
        &["sweep.n", "sweep.steps", "sweep.reference.n", "sweep.reference.steps", "sweep.norms"],
        sweep,
    ),
    (&["sweep.pairs", "sweep.by_state"], paths),
    (
        &[
            "predicts.norm",
            "predicts.variable",
            "predicts.order",
            "predicts.order_k",
            "predicts.at_least",
            "predicts.exact",
            "predicts.why",
            "predicts.window_n",
            "predicts.window_steps",
        ],
        predictions,
    ),
    (&["predicts.tends_to_zero"], to_zero),
    (&["predicts.constant", "predicts.constant_within", "predicts.constant_why"], constants),
];

fn to_zero() {
    let read = block(&[("order = 1.0", "tends_to_zero = true")]);
    let first = &read.predicts[0];
    assert_eq!((first.order, first.at_least, first.constant), (0.0, true, false));
}

fn heading() {
    let read = block(&[("question = \"Which number is read as which?\"", "question = \"Why?\"")]);
    assert_eq!((&*read.name, &*read.question, read.dimension), ("block", "Why?", 2));
    assert!(read.as_contact().is_some());
    let finite = scene(&crate::shipped::text("broken-m0-beyond"));
    assert!(finite.as_contact().is_none() && finite.dimension == 1);
}

fn headed(lines: &str) -> Scene {
    block(&[("dimension = 2", &format!("dimension = 2\n{lines}"))])
}

fn judging() {
    let plain = headed("");
    assert!(plain.judge && !plain.long && plain.violates.is_empty());
    assert_eq!(plain.expect, Expectation::Pass);
    assert!(!headed("judge = false").judge);
    assert!(headed("long = true").long);
    assert_eq!(headed("expect = \"fail\"").expect, Expectation::Fail);
    assert_eq!(headed("expect = \"unresolved\"").expect, Expectation::Unresolved);
    assert_eq!(headed("violates = [\"2.9\"]").violates, [Hypothesis::Smallness]);
}

fn windows() {
    let read = headed("window_n = [4, 8]\nwindow_steps = [16, 32]");
    assert_eq!((read.window_n, read.window_steps), (Some([4, 8]), Some([16, 32])));
}

/// T = 1.5 in four steps; to the square; random ones by their seed.
fn grids() {
    let times = |grid: &str| {
        let read = block(&[("horizon = 1.5", &format!("horizon = 1.5\n{grid}"))]);
        read.time.grid(4).unwrap().times().to_vec()
    };
    for plain in [times(""), times("grid = { kind = \"uniform\" }")] {
        plain.iter().zip([0.0, 0.375, 0.75, 1.125, 1.5]).for_each(|(t, exact)| near(*t, exact));
    }
    let graded = times("grid = { kind = \"graded\", exponent = 2.0 }");
    let squares = [0.0, 1.5 / 16.0, 6.0 / 16.0, 13.5 / 16.0, 1.5];
    graded.iter().zip(squares).for_each(|(t, exact)| near(*t, exact));
    let [first, second, again] =
        [1, 2, 1].map(|seed| times(&format!("grid = {{ kind = \"random\", seed = {seed} }}")));
    assert!(first != second && first == again);
    assert_eq!((first[0], first[4]), (0.0, 1.5));
}

fn rules() {
    let rule =
        |text: &str| block(&[("horizon = 1.5", &format!("horizon = 1.5\n{text}"))]).time.rule;
    assert_eq!(rule(""), TimeRule::Trapezoid);
    assert_eq!(rule("rule = { kind = \"trapezoid\" }"), TimeRule::Trapezoid);
    for left in ["rule = \"left\"", "rule = { kind = \"left\" }"] {
        assert_eq!(rule(left), TimeRule::Left);
    }
    assert_eq!(rule("rule = \"right\""), TimeRule::Right);
    assert_eq!(rule("rule = \"gregory\""), TimeRule::Gregory { order: 3 });
    let four = rule("rule = { kind = \"gregory\", order = 4 }");
    assert_eq!(four, TimeRule::Gregory { order: 4 });
    assert_eq!(rule("rule = { kind = \"product-integration\" }"), TimeRule::ProductIntegration);
    let corrected = rule("rule = { kind = \"corrected-end\", exponent = 0.5 }");
    assert_eq!(corrected, TimeRule::CorrectedEnd { exponent: 0.5 });
}

/// f0 = (x, -t), f2 = (y, 2 t) on the right side alone: components, sides and variables.
fn loads() {
    let read = block(&[(
        "body = [\"0\", \"-1\"]",
        "body = [\"x\", \"-t\"]\ntraction = { right = [\"y\", \"2*t\"] }",
    )]);
    let body = read.as_contact().expect("a body");
    let Data::Loads { body: force, traction } = &body.data else { panic!("given loads") };
    let at = EvaluationPoint { x: 0.3, y: 0.2, t: 0.7, ..ORIGIN };
    near(value(&read, force[0], at), 0.3);
    near(value(&read, force[1], at), -0.7);
    assert_eq!((traction.len(), body.domain.name(traction[0].0)), (1, "right"));
    near(value(&read, traction[0].1[0], at), 0.2);
    near(value(&read, traction[0].1[1], at), 1.4);
}

/// u_ν = -u_y = a on the bottom: at the gap with λ = 2 t, and ξ in the jump of the law there.
const EXACT: &str = r#"[exact]
u = ["0", "-a*(0.5 - y)/0.5"]
multiplier = "b*t"
selection = "0.03"
friction = "0.028"
interpolated = true
form = "strong"
[exact.parameters]
b = 2.0
[exact.define]
a = "0.1"
"#;
const LAW: &str = "[contact]\ngap = \"0.1\"\nlaw = { kind = \"piecewise-linear\", points = [[0.1, 0.0], [0.1, 0.05]], slope_before = 0.0, slope_after = 0.0 }\n[contact.friction]\nbound = 0.3";

fn exact() {
    let loads = "[loads]\nbody = [\"0\", \"-1\"]\n";
    let without = ("reference = { n = 8, steps = 12 }\n", "");
    let read = block(&[(loads, EXACT), ("[contact]", LAW), without]);
    let body = read.as_contact().expect("a body");
    let Data::Exact { u, multiplier, selection, friction, interpolated, form } = &body.data else {
        panic!("an exact solution")
    };
    let at = EvaluationPoint { x: 0.3, y: 0.25, t: 0.7, ..ORIGIN };
    near(value(&read, u[0], at), 0.0);
    near(value(&read, u[1], at), -0.05);
    near(value(&read, multiplier.first().expect("a multiplier").1, at), 1.4);
    near(value(&read, selection.first().expect("a selection").1, at), 0.03);
    near(value(&read, friction.as_ref().expect("a friction stress")[0], at), 0.028);
    assert!(*interpolated && *form == LoadForm::Strong);
    let weak = EXACT.replace("interpolated = true\nform = \"strong\"", "form = \"weak\"");
    let read = block(&[(loads, &weak), ("[contact]", LAW), without]);
    let Data::Exact { interpolated, form, .. } = &read.as_contact().expect("a body").data else {
        panic!("an exact solution")
    };
    assert!(!interpolated && *form == LoadForm::Weak);
}

fn keys(read: Scene) -> Vec<(Option<u32>, u32)> {
    let subject = Subject::new(read).unwrap_or_else(|error| panic!("{error}"));
    let mut keys: Vec<_> = ScenePlan::new(subject, &Overrides::default())
        .keys()
        .into_iter()
        .map(|Key { n, steps, .. }| (n, steps))
        .collect();
    keys.sort_unstable();
    keys
}

fn sweep() {
    let read = block(&[]);
    let sweep = read.sweep.as_ref().expect("a sweep");
    assert_eq!(sweep.reference, Some(Reference { n: 8, steps: 12 }));
    assert_eq!(sweep.norms.as_deref(), Some(&[Norm::VMax, Norm::L2Max][..]));
    let cases = [(2, 3), (2, 6), (4, 3), (4, 6)].map(|(n, steps)| (Some(n), steps));
    assert_eq!(keys(read), cases);
}

fn paths() {
    let text = crate::shipped::edited(
        &crate::shipped::text("compliance"),
        "n = [8, 16, 32, 64]\nsteps = [16]",
        "pairs = [[4, 16], [8, 64], [16, 256]]\nby_state = true",
    );
    let text = text.replace("variable = \"h\"", "variable = \"path\"");
    let read = scene(&text);
    assert!(read.sweep.as_ref().expect("a sweep").by_state);
    assert_eq!(keys(read), [(Some(4), 16), (Some(8), 64), (Some(16), 256)]);
}

fn predictions() {
    let joint = "[[predicts]]\nnorm = \"L2_max\"\nvariable = \"joint\"\norder = 1.25\norder_k = 1.75\nat_least = true\nwhy = \"first\"\nwindow_n = [2, 4]\nwindow_steps = [3, 6]\n";
    let sharp = "[[predicts]]\nnorm = \"V_max\"\nvariable = \"k\"\norder = 1.5\nexact = true\nwhy = \"second\"\n";
    let written =
        "[[predicts]]\nnorm = \"V_max\"\nvariable = \"h\"\norder = 1.0\nwhy = \"the block\"\n";
    let read = block(&[(written, &format!("{joint}{sharp}"))]);
    let [first, second] = &read.predicts[..] else { panic!("two predictions") };
    assert_eq!((first.norm, first.variable), (Norm::L2Max, Direction::Joint));
    assert_eq!((first.order, first.order_k), (1.25, Some(1.75)));
    assert!(first.at_least && !first.exact && first.why == "first");
    assert_eq!((first.window_n, first.window_steps), (Some([2, 4]), Some([3, 6])));
    assert_eq!((second.norm.name(), second.variable, second.order), (V_MAX, Direction::K, 1.5));
    assert!(second.exact && !second.at_least && second.order_k.is_none());
}

/// What is known beforehand of the one constant of affine: its tolerance, or nothing.
fn foreseen(line: &str) -> Foreseen {
    let why = "why = \"Theorem 7, (3.17)\"";
    let text = with(&crate::shipped::text("affine"), &[(why, &format!("{why}\n{line}"))]);
    let setup = Setup::new(scene(&text)).unwrap_or_else(|error| panic!("{error}"));
    let subject = Subject::Contact(Box::new(setup));
    let plan = ScenePlan::new(subject, &Overrides { n: Some(vec![2]), steps: Some(vec![4, 8]) });
    foresee_plan(&plan)[0].foreseen.clone()
}

fn constants() {
    let tolerance = |line: &str| match foreseen(line) {
        Foreseen::Leading(line) => Some(line.tolerance),
        Foreseen::Nothing { .. } => None,
    };
    assert_eq!(tolerance("constant_within = 0.07\nconstant_why = \"coarse\""), Some(0.07));
    assert_eq!(tolerance("constant = false"), None);
    assert_eq!(tolerance("constant = true"), tolerance(""));
    assert!(tolerance("").is_some_and(|usual| usual < 1e-3));
    let refused = |line: &str| {
        let why = "why = \"Theorem 7, (3.17)\"";
        let text = with(&crate::shipped::text("affine"), &[(why, &format!("{why}\n{line}"))]);
        crate::shipped::refusal(text)
    };
    for (line, said) in [
        ("constant_within = 0.07", "lacks the key `constant_why`"),
        ("constant_within = 0.07\nconstant_why = \" \"", "`constant_why` is empty"),
        ("constant_why = \"coarse\"", "has no `constant_within` to explain"),
        (
            "constant = false\nconstant_within = 0.07\nconstant_why = \"coarse\"",
            "nothing is compared",
        ),
        ("constant_within = 1.5\nconstant_why = \"coarse\"", "not between 0 and 1"),
        ("constant_within = 0.0\nconstant_why = \"coarse\"", "not between 0 and 1"),
        ("constant_within = nan\nconstant_why = \"coarse\"", "not between 0 and 1"),
    ] {
        assert!(refused(line).contains(said), "{line}: {}", refused(line));
    }
}
