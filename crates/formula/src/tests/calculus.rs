//! Derivatives against dual numbers and difference quotients.

use num_dual::{DualNum, second_derivative};
use proptest::prelude::*;

use super::plain::by_definition;
use super::{EvaluationPoint, Graph, Variable, assert_close, everything, node, value};

#[derive(Clone, Debug)]
enum Expr {
    X,
    Y,
    Number(f64),
    Neg(Box<Expr>),
    Add(Box<Expr>, Box<Expr>),
    Sub(Box<Expr>, Box<Expr>),
    Mul(Box<Expr>, Box<Expr>),
    /// a / (1 + b^2)
    Div(Box<Expr>, Box<Expr>),
    Power(Box<Expr>, i32),
    /// (1 + a^2) ^ 1.3
    Pow(Box<Expr>),
    Of(&'static str, Box<Expr>),
}

const FUNCTIONS: [&str; 9] = ["sin", "cos", "tanh", "atan", "exp", "log", "sqrt", "sinh", "cosh"];

impl Expr {
    fn text(&self) -> String {
        match self {
            Self::X => "x".into(),
            Self::Y => "y".into(),
            Self::Number(v) => format!("({v})"),
            Self::Neg(a) => format!("(-{})", a.text()),
            Self::Add(a, b) => format!("({}+{})", a.text(), b.text()),
            Self::Sub(a, b) => format!("({}-{})", a.text(), b.text()),
            Self::Mul(a, b) => format!("({}*{})", a.text(), b.text()),
            Self::Div(a, b) => format!("({}/(1+{}^2))", a.text(), b.text()),
            Self::Power(a, n) => format!("({}^{n})", a.text()),
            Self::Pow(a) => format!("((1+{}^2)^1.3)", a.text()),
            Self::Of(f @ ("log" | "sqrt"), a) => format!("{f}(1+{}^2)", a.text()),
            Self::Of(f @ ("exp" | "sinh" | "cosh"), a) => format!("{f}(sin({}))", a.text()),
            Self::Of(f, a) => format!("{f}({})", a.text()),
        }
    }

    fn dual<D: DualNum<Primitive = f64>>(&self, x: &D, y: f64) -> D {
        let one = || D::from(1.0);
        let square = |a: &Self| one() + a.dual(x, y).powi(2);
        match self {
            Self::X => x.clone(),
            Self::Y => D::from(y),
            Self::Number(v) => D::from(*v),
            Self::Neg(a) => -a.dual(x, y),
            Self::Add(a, b) => a.dual(x, y) + b.dual(x, y),
            Self::Sub(a, b) => a.dual(x, y) - b.dual(x, y),
            Self::Mul(a, b) => a.dual(x, y) * b.dual(x, y),
            Self::Div(a, b) => a.dual(x, y) / square(b),
            Self::Power(a, n) => a.dual(x, y).powi(*n),
            Self::Pow(a) => square(a).powf(1.3),
            Self::Of(f, a) => match *f {
                "sin" => a.dual(x, y).sin(),
                "cos" => a.dual(x, y).cos(),
                "tanh" => a.dual(x, y).tanh(),
                "atan" => a.dual(x, y).atan(),
                "exp" => a.dual(x, y).sin().exp(),
                "sinh" => a.dual(x, y).sin().sinh(),
                "cosh" => a.dual(x, y).sin().cosh(),
                "log" => square(a).ln(),
                _ => square(a).sqrt(),
            },
        }
    }
}

fn expressions() -> impl Strategy<Value = Expr> {
    let number = (-20i32..20).prop_map(|v| Expr::Number(f64::from(v) / 8.0));
    let leaf = prop_oneof![3 => Just(Expr::X), 2 => Just(Expr::Y), 1 => number];
    leaf.prop_recursive(5, 24, 2, |inner| {
        let two = || (inner.clone(), inner.clone()).prop_map(|(a, b)| (Box::new(a), Box::new(b)));
        let one = || inner.clone().prop_map(Box::new);
        prop_oneof![
            one().prop_map(Expr::Neg),
            two().prop_map(|(a, b)| Expr::Add(a, b)),
            two().prop_map(|(a, b)| Expr::Sub(a, b)),
            two().prop_map(|(a, b)| Expr::Mul(a, b)),
            two().prop_map(|(a, b)| Expr::Div(a, b)),
            (one(), 2i32..4).prop_map(|(a, n)| Expr::Power(a, n)),
            one().prop_map(Expr::Pow),
            (0..FUNCTIONS.len(), one()).prop_map(|(k, a)| Expr::Of(FUNCTIONS[k], a)),
        ]
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn derivatives_agree_with_dual_numbers(
        expr in expressions(), x in -1.0..1.0f64, y in -1.0..1.0f64,
    ) {
        let text = expr.text();
        let (f, slope, curvature) = second_derivative(|x| expr.dual(&x, y), x);
        // Beyond, rounding is amplified more than a fixed tolerance allows.
        prop_assume!(f.abs() < 1e4 && slope.abs() < 1e5 && curvature.abs() < 1e6);
        let mut graph = Graph::new();
        let g = node(&mut graph, &everything(), &text);
        let dg = graph.derivative(g, Variable::X);
        let ddg = graph.derivative(dg, Variable::X);
        let at = EvaluationPoint { x, y, ..EvaluationPoint::default() };
        let size = 1.0 + f.abs() + slope.abs() + curvature.abs();
        for (ours, theirs) in [(g, f), (dg, slope), (ddg, curvature)] {
            let ours = by_definition(&graph, ours, &at);
            prop_assert!((ours - theirs).abs() < 1e-9 * size, "{}: {} {}", text, ours, theirs);
        }
        let h = 1e-5;
        let dy = graph.derivative(g, Variable::Y);
        let at_y = |y: f64| by_definition(&graph, g, &EvaluationPoint { x, y, ..EvaluationPoint::default() });
        let quotient = (at_y(y + h) - at_y(y - h)) / (2.0 * h);
        let exact = by_definition(&graph, dy, &at);
        prop_assume!(exact.abs() < 1e2);
        let dyyy = {
            let second = graph.derivative(dy, Variable::Y);
            graph.derivative(second, Variable::Y)
        };
        let remainder = by_definition(&graph, dyyy, &at).abs() * h * h;
        prop_assume!(remainder < 1e-3);
        prop_assert!((quotient - exact).abs() < 2.0 * remainder + 1e-9 * size.max(1.0) + 1e-6,
            "{}: {} {}", text, quotient, exact);
    }
}

#[test]
fn branches_and_special_functions_by_differences() {
    let cases = [
        "max(x, y)*x",
        "min(x^2, y)",
        "abs(x*y)",
        "if(x*y<0.2, sin(x), x^3)",
        "tan(x)",
        "asin(x/2)",
        "acos(x/2)",
        "log(2+x)",
        "x^y",
        "2^x",
        "(1+x)^(2*x)",
        "1/x",
        "sign(x)*x",
        "(-x)^5",
        "x^-2",
        "sqrt(1+x)",
    ];
    for text in cases {
        for x in [0.17, 0.62, 0.93] {
            let h = 1e-5;
            let slope = value(&format!("d({text}, x)"), [x, 0.37, 0.0, 0.0]);
            let f = |x| value(text, [x, 0.37, 0.0, 0.0]);
            let quotient = (f(x + h) - f(x - h)) / (2.0 * h);
            assert_close(slope, quotient, 1e-7 * (1.0 + slope.abs()), text);
        }
    }
    assert_close(value("(x-2)^3", [0.5, 0.0, 0.0, 0.0]), -3.375, 0.0, "negative base");
    assert_close(value("d((x-2)^3, x)", [0.5, 0.0, 0.0, 0.0]), 6.75, 0.0, "negative base");
}

#[test]
fn simplification_and_substitution() {
    let mut graph = Graph::new();
    let scope = everything();
    let mut same = |a: &str, b: &str| {
        let (a_node, b_node) = (node(&mut graph, &scope, a), node(&mut graph, &scope, b));
        assert_eq!(a_node, b_node, "{a} and {b}");
    };
    same("x+0", "x");
    same("1*x", "x");
    same("0*x", "0");
    same("x*y-y*x", "0");
    same("x*x*x", "x^3");
    same("(x^2)^3", "x^6");
    same("x+y", "y+x");
    same("2*(3*x)", "6*x");
    same("-(-x)", "x");
    same("d(y, x)", "0");
    let f = node(&mut graph, &scope, "sin(x)*t + relax(1, t*y)");
    let half = graph.constant(0.5);
    let g = graph.substitute(f, Variable::X, half);
    let expected = node(&mut graph, &scope, "sin(0.5)*t + relax(1, t*y)");
    assert_eq!(g, expected);
    let zero = graph.constant(0.0);
    let start = graph.substitute(f, Variable::T, zero);
    assert_eq!(graph.value_of_constant(start), Some(0.0));
    let t = graph.variable(Variable::T);
    let h = node(&mut graph, &scope, "relax(1, sin(x*t))");
    let moving = graph.substitute(h, Variable::X, t);
    assert!(graph.value_of_constant(moving).is_some_and(f64::is_nan));
}
