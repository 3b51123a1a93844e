//! Proved bounds against values known in closed form, and enclosures against values at random places.

use proptest::prelude::*;

use super::{EvaluationPoint, Graph, Node, Variable, everything, node};
use crate::{Extreme, Interval, Place};

const HALF_LINE: Interval = Interval { low: 0.0, high: f64::INFINITY };

fn parsed(text: &str) -> (Graph, Node) {
    let mut graph = Graph::new();
    let f = node(&mut graph, &everything(), text);
    (graph, f)
}

/// The proved bound of |d/dzeta|.
fn slope(text: &str, over: Interval) -> Extreme<1> {
    let (mut graph, f) = parsed(text);
    let slope = graph.derivative(f, Variable::Zeta);
    graph.largest_modulus(slope, Variable::Zeta, over)
}

/// L_kappa by hand. The fourth to sixth are steep on 4e-3 of [0, 1]: samples at 0.05 apart miss them.
#[test]
fn lipschitz_constants_are_bounded_as_closely_as_stated() {
    let unit = Interval::new(0.0, 1.0);
    let cases = [
        ("0.10 + 0.05*zeta", HALF_LINE, 0.05),
        ("0.1 + 0.05*(1 - exp(-3*zeta))", HALF_LINE, 0.15),
        // Steepest at 1/sqrt(2): sqrt(2) exp(-1/2).
        (
            "0.2 + exp(-zeta^2)",
            Interval::new(0.0, 10.0),
            std::f64::consts::SQRT_2 * (-0.5f64).exp(),
        ),
        ("0.02 + 40*max(0, min(zeta - 0.03, 0.004))", HALF_LINE, 40.0),
        ("0.1 + if(zeta < 0.611, 0, if(zeta < 0.613, 30*(zeta - 0.611), 0.06))", HALF_LINE, 30.0),
        // 1/cosh^2 is 1 at the middle: 0.1*500.
        ("0.3 + 0.1*tanh(500*(zeta - 0.7351))", HALF_LINE, 50.0),
        ("0.02 + 0.4*zeta^2", unit, 0.8),
        // |cos| = 1 at 0; between the extremes at multiples of pi/7.
        ("1 + 0.1*sin(7*zeta)", HALF_LINE, 0.7),
        ("0.05 + 0.2*sqrt(zeta^2 + 0.25)", unit, 0.2 / 1.25f64.sqrt()),
        ("0.4 + 0.1*abs(zeta - 0.3) + 0.2*abs(zeta - 0.8)", unit, 0.3),
        // (zeta^1.5)' = 1.5 zeta^0.5, largest at the right end.
        ("0.1 + zeta^1.5", unit, 1.5),
    ];
    for (text, over, exact) in cases {
        let found = slope(text, over);
        // The bound is proved, and within the tolerance of the search; `exact` has some roundings itself.
        let excess = found.bound / exact - 1.0;
        assert!((-1e-15..=1.1e-7).contains(&excess), "{text}: {found:?}, excess {excess:e}");
    }
}

#[test]
fn what_has_no_bound_is_located() {
    for (text, at) in [("sqrt(zeta)", 0.0), ("abs(zeta - 0.3)^(1/2)", 0.3), ("log(2 - zeta)", 2.0)]
    {
        let found = slope(text, Interval::new(0.0, 2.0));
        assert_eq!(found.bound, f64::INFINITY, "{text}");
        let [Interval { low, high }] = found.part;
        assert!((low..=high).contains(&at) && high - low < 1e-13, "{text}: {low} {high}");
    }
    assert_eq!(slope("zeta^2", HALF_LINE).bound, f64::INFINITY);
    // No multiple of the step of any sampling: the pole counts.
    let (graph, pole) = parsed("1/(t - 0.3)");
    let found = graph.largest_modulus(pole, Variable::T, Interval::new(0.0, 1.0));
    assert!(found.bound.is_infinite() && found.part[0].contains(0.3), "{found:?}");
    // An integral over the past has no enclosure.
    let (graph, past) = parsed("relax(1, t)");
    assert!(graph.largest_modulus(past, Variable::T, Interval::new(0.0, 1.0)).bound.is_infinite());
}

#[test]
fn jumps_are_found_and_kinks_are_none() {
    let over = Interval::new(0.0, 10.0);
    let jump = |text: &str| {
        let (graph, f) = parsed(text);
        graph.jump(f, Variable::Zeta, over).expect("few branches")
    };
    for (text, at, low, high) in [
        ("if(zeta < 0.137, 0.1, 0.2)", 0.137, 0.1, 0.2),
        ("1 + 0.25*sign(zeta - 3)", 3.0, 0.75, 1.25),
        ("if(zeta < 2, zeta, if(zeta < 5, 2, 3))", 5.0, 2.0, 3.0),
    ] {
        let found = jump(text).expect("a jump");
        assert!(found.at.contains(at) && found.at.high - found.at.low < 1e-13, "{text}: {found:?}");
        assert!((found.values.low - low).abs() < 1e-9 && (found.values.high - high).abs() < 1e-9);
    }
    for text in [
        "if(zeta < 0.137, 0.1, 0.1 + 3*(zeta - 0.137))",
        "max(0, min(zeta - 0.03, 0.004))",
        "sign(zeta - 3)*(zeta - 3)",
        "if(zeta < 2, 1, if(zeta < 1, 7, 1))",
    ] {
        assert_eq!(jump(text), None, "{text}");
    }
}

/// Formulas with every operation, as functions of x and y.
const FORMULAS: [&str; 14] = [
    "sin(3*x) - cos(y)*x",
    "tan(x/3) + asin(x/5)*acos(y/5)",
    "sinh(x) - cosh(y) + tanh(x*y)",
    "exp(-x^2) + log(3 + x*y/9)",
    "sqrt(2 + x/2) / (4 + y)",
    "(x + y)^3 - x^2*y^-2",
    "(3 + x)^(0.3*y) - (5 + y)^1.7",
    "abs(x - y) + sign(x)*y",
    "min(x, y^2) - max(x*y, 1)",
    "if(x*y < 0.5, x - y, x + y^2)",
    "atan(10*x) - 1/(x - 0.1)",
    "x/(y*y) + y/x",
    "1e-200*x*1e-150*y - x*1e200*y*1e200",
    OVERFLOWS,
];
const OVERFLOWS: &str = "exp(300*x) - exp(-300*y)";

proptest! {
    /// A value in plain arithmetic lies in the range of each box around it, but for the rounding of plain arithmetic.
    #[test]
    fn values_lie_in_their_enclosures(
        formula in 0..FORMULAS.len(),
        [x, y] in prop::array::uniform2(-2.9f64..2.9),
        sides in prop::array::uniform4(prop_oneof![Just(0.0), 0.0f64..1e-6, 0.0f64..3.0]),
    ) {
        let (graph, f) = parsed(FORMULAS[formula]);
        let value = graph.evaluate(f, &EvaluationPoint { x, y, ..EvaluationPoint::default() });
        let place = Place::origin()
            .with(Variable::X, Interval::new(x - sides[0], x + sides[1]))
            .with(Variable::Y, Interval::new(y - sides[2], y + sides[3]));
        let found = graph.enclosing(f).over(&place);
        // Two overflows less each other are no number in plain arithmetic, and one without a known bound in real arithmetic.
        let overflow = FORMULAS[formula] == OVERFLOWS && found.range == Interval::ALL;
        prop_assert!(found.undefined || overflow || !value.is_nan());
        let slack = 1e-12 * value.abs().max(1.0);
        let inside = found.range.low <= value + slack && value - slack <= found.range.high;
        prop_assert!(!value.is_finite() || inside, "{}: {value} {found:?}", FORMULAS[formula]);
    }
}

/// Where a formula has no value somewhere in a box, its enclosure says so; where it has one throughout, it does not.
#[test]
fn boxes_without_a_value_are_known() {
    let unit = Interval::new(-1.0, 1.0);
    let positive = Interval::new(0.5, 1.0);
    for (text, beside) in [
        ("x/y", positive),
        ("(x - 0.7)/y", positive),
        ("(y - 0.7)/(x*x)", positive),
        ("sqrt(x)", positive),
        ("log(x)", positive),
        ("asin(2*x)", Interval::new(-0.5, 0.5)),
        ("acos(2*x)", Interval::new(-0.5, 0.5)),
        ("x^0.3", positive),
        ("x^y", positive),
    ] {
        let (graph, f) = parsed(text);
        let mut enclosing = graph.enclosing(f);
        let mut undefined = |x: Interval, y: Interval| {
            let place = Place::origin().with(Variable::X, x).with(Variable::Y, y);
            enclosing.over(&place).undefined
        };
        assert!(undefined(unit, unit), "{text}");
        assert!(!undefined(beside, positive), "{text}");
    }
}
