//! Precedence, and faults with their places.

use super::plain::by_definition;
use super::{Graph, Scope, Variable, assert_close, everything, value};
use crate::ParseError;

const AT: [f64; 4] = [0.3, -0.7, 1.1, 0.9];

#[test]
fn operators_bind_as_in_mathematics() {
    let [x, y, z, t] = AT;
    let cases = [
        ("1+2*3", 7.0),
        ("2*3^2", 18.0),
        ("-2^2", -4.0),
        ("(-2)^2", 4.0),
        ("2^3^2", 512.0),
        ("2^-2", 0.25),
        ("2^-x^2", (2f64).powf(-x * x)),
        ("8/4/2", 1.0),
        ("7-4-2", 1.0),
        ("-x*-y", x * y),
        ("+x - -y", x + y),
        ("1e-3*1.5E2 + .5", 0.65),
        ("ln(2)+log(3)", 6f64.ln()),
        ("cos(pi)", -1.0),
        ("y^3", y * y * y),
        ("y^-3", 1.0 / (y * y * y)),
        ("z^1.5", z.powf(1.5)),
        ("x^t", x.powf(t)),
        ("max(x,y,z)+min(x,y,z)", z + y),
        ("sign(y)+abs(y)+sign(0*x)", -1.0 - y),
        ("if(x<0.5, 1, 2)", 1.0),
        ("if(x<=0.3, 1, 2)", 1.0),
        ("if(x<0.3, 1, 2)", 2.0),
        ("if(x>=0.3 and not y>0, 1, 2)", 1.0),
        ("if(x>1 and y<0 or z>1, 1, 2)", 1.0),
        ("if(x>1 and (y<0 or z>1), 1, 2)", 2.0),
        ("if(not (x<1 or y<1), 1, 2)", 2.0),
        ("d(x^2*y, x)+d(x*t, t)", 2.0 * x * y + x),
        ("tan(x)+asin(x)+acos(x)+atan(x)", x.tan() + x.asin() + x.acos() + x.atan()),
        ("sinh(x)+cosh(x)+tanh(x)+sqrt(z)", x.sinh() + x.cosh() + x.tanh() + z.sqrt()),
    ];
    for (text, expected) in cases {
        assert_close(value(text, AT), expected, 1e-14, text);
    }
}

fn fault(text: &str) -> ParseError {
    let mut graph = Graph::new();
    let mut scope = Scope::new(&[Variable::X, Variable::T]);
    let one = graph.constant(1.0);
    scope.define("theta", one);
    scope.define("Q0", one);
    match graph.parse(text, &scope) {
        Ok(_) => panic!("`{text}` should not be a formula"),
        Err(error) => error,
    }
}

#[test]
fn faults_are_located() {
    let cases = [
        ("sin(pi*x", "(", "missing"),
        ("foo(x)+1", "foo", "unknown function"),
        ("if(x<0.5,1)", "if(x<0.5,1)", "takes 3"),
        ("x*Q", "Q", "unknown name"),
        ("x*y", "y", "not allowed"),
        ("1+1e999", "1e999", "too large"),
        ("x x", "x", "expected an operator"),
        ("2x", "x", "expected an operator"),
        ("x)", ")", "never opened"),
        ("x,1", ",", "comma"),
        ("x = 1", "=", "no meaning"),
        ("x & 1", "&", "no meaning"),
        ("1+*x", "*", "expected a number"),
        ("sin + 1", "sin", "needs arguments"),
        ("theta(x)", "theta", "not a function"),
        ("max(x)", "max(x)", "at least 2"),
        ("x<1", "x<1", "condition"),
        ("if(x, 1, 2)", "x", "condition"),
        ("if(0<x<1, 1, 2)", "<", "chained"),
        ("relax(x, t)", "x", "constant"),
        ("d(x, theta)", "theta", "respect"),
        ("d(x, y)", "y", "not allowed"),
        ("(x 2)", "2", "expected"),
        ("x é", "é", "expected an operator"),
        ("x \u{2212} 1", "\u{2212}", "no meaning"),
    ];
    for (text, part, message) in cases {
        let error = fault(text);
        assert_eq!(&text[error.span.clone()], part, "{text}: {error}");
        assert!(error.message.contains(message), "{text}: {error}");
    }
    // The second x, not the first.
    assert_eq!(fault("x x").span, 2..3);
    assert_eq!(fault("").span, 0..0);
    assert_eq!(fault("1+").span, 2..2);
    assert!(fault("thetta").hint.is_some_and(|h| h.starts_with("did you mean `theta`")));
    assert!(fault("sinn(x)").hint.is_some_and(|h| h.starts_with("did you mean `sin`")));
    assert!(fault("Q").hint.is_some_and(|h| h.contains("theta") && h.contains("pi")));
}

#[test]
fn sizes_are_limited() {
    for open in ["(", "-", "sin(", "2^", "not ", "max(1,"] {
        let error = fault(&open.repeat(300));
        assert!(error.message.contains("nested"), "{open}: {error}");
    }
    let error = fault(&"x+".repeat(40_000));
    assert!(error.message.contains("64 KiB"), "{error}");
    // Long and flat text is accepted, and nesting up to the limit.
    let long = format!("{}x", "x*t+".repeat(16_000));
    let mut graph = Graph::new();
    let f = graph.parse(&long, &everything()).expect("a long sum");
    let slope = graph.derivative(f, Variable::X);
    let at = super::EvaluationPoint { x: 1.0, t: 0.5, ..Default::default() };
    assert_close(by_definition(&graph, slope, &at), 8001.0, 1e-9, "slope of a long sum");
    let deep = format!("{}x{}", "(".repeat(199), ")".repeat(199));
    assert_close(value(&deep, AT), 0.3, 0.0, "deep");
    let conditions = format!("if({}x<0, 1, 2)", "x<0 or ".repeat(8000));
    assert_close(value(&conditions, AT), 2.0, 0.0, "many conditions");
}

#[test]
fn reserved_names() {
    for name in ["sin", "if", "relax", "d", "pi", "x", "zeta", "and", "ln"] {
        assert!(Graph::is_reserved(name), "{name}");
    }
    for name in ["e", "theta", "X", "sinus"] {
        assert!(!Graph::is_reserved(name), "{name}");
    }
}
