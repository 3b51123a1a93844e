//! Relaxation and convolution against closed forms.

use super::plain::by_definition;
use super::{EvaluationPoint, Graph, Node, Variable, assert_close, everything, node, value};
use crate::Program;

fn check(text: &str, tolerance: f64, exact: impl Fn(f64, f64) -> f64) {
    let mut graph = Graph::new();
    let f = node(&mut graph, &everything(), text);
    check_node(&mut graph, f, text, tolerance, exact);
}

fn check_node(
    graph: &mut Graph,
    f: Node,
    text: &str,
    tolerance: f64,
    exact: impl Fn(f64, f64) -> f64,
) {
    let abscissae = [0.0, 0.111, 0.5, 0.77, 1.0];
    let points: Vec<[f64; 3]> = abscissae.iter().map(|x| [*x, 0.5, 0.2]).collect();
    let mut bound = Program::compile(graph, &[f], 1.0).bind(&points);
    let mut out = vec![Vec::new()];
    for t in [0.0, 1e-3, 0.25, 0.3337, 0.9, 1.0, 1.7] {
        bound.evaluate(t, 0.0, &mut out);
        for (x, ours) in abscissae.into_iter().zip(&out[0]) {
            let expected = exact(x, t);
            assert_close(*ours, expected, tolerance, &format!("{text} at x={x} t={t}"));
            let at = EvaluationPoint { x, y: 0.5, z: 0.2, t, zeta: 0.0 };
            let plain = by_definition(graph, f, &at);
            assert_close(plain, expected, tolerance, &format!("plain {text} at x={x} t={t}"));
            let alone = graph.evaluate(f, &at);
            assert_close(alone, expected, tolerance, &format!("alone {text} at x={x} t={t}"));
        }
    }
}

/// Integral of exp(-c (t-s)) (s-a) over a < s < t.
fn ramp(c: f64, a: f64, t: f64) -> f64 {
    let u = (t - a).max(0.0);
    u / c - (1.0 - (-c * u).exp()) / (c * c)
}

#[test]
fn relaxation_of_smooth_functions() {
    check("relax(2, 1)", 1e-15, |_, t| (1.0 - (-2.0 * t).exp()) / 2.0);
    check("relax(0, x)", 1e-15, |x, t| x * t);
    check("relax(3, t)", 1e-15, |_, t| ramp(3.0, 0.0, t));
    check("relax(1.5, sin(2*t))", 2e-15, |_, t| {
        let c = 1.5;
        (c * (2.0 * t).sin() - 2.0 * (2.0 * t).cos() + 2.0 * (-c * t).exp()) / (c * c + 4.0)
    });
    check("relax(200, sin(2*t))", 2e-15, |_, t| {
        let c = 200.0;
        (c * (2.0 * t).sin() - 2.0 * (2.0 * t).cos() + 2.0 * (-c * t).exp()) / (c * c + 4.0)
    });
    check("relax(-1, exp(t*x)*exp(-t*x))", 1e-14, |_, t| t.exp_m1());
}

#[test]
fn relaxation_across_kinks_and_jumps() {
    check("relax(1.3, max(t-0.3, 0)*x)", 1e-15, |x, t| x * ramp(1.3, 0.3, t));
    // A kink at s = x^2 and a jump at s = x/2 that move with x.
    check("relax(0.7, max(t-x^2, 0))", 2e-15, |x, t| ramp(0.7, x * x, t));
    let step = |x: f64, t: f64| {
        let u = (t - x / 2.0).max(0.0);
        let all = (1.0 - (-0.9 * t).exp()) / 0.9;
        2.0 * all + (1.0 - (-0.9 * u).exp()) / 0.9
    };
    check("relax(0.9, if(t < x/2, 2, 3))", 3e-14, step);
    check("relax(0.9, if(x/2 <= t, 3, 2))", 3e-14, step);
    check("relax(1, abs(t-x))", 2e-15, |x, t| {
        let at_x = x * (1.0 - (-t).exp()) - (t - 1.0 + (-t).exp());
        at_x + 2.0 * ramp(1.0, x, t)
    });
    // Zero on an interval between two signs.
    check("relax(1, sign(max(t-0.6,0)+min(t-0.31,0)))", 2e-15, |_, t| {
        let tail = |a: f64, b: f64| (b.min(t) - t).exp() - (a.min(t) - t).exp();
        tail(0.6, 9.0) - tail(0.0, 0.31)
    });
}

/// Breaks next to a panel edge or to each other are kept: without them the integrals are off by 2e-8 and 1e-8.
#[test]
fn breaks_next_to_an_edge_or_another_are_kept() {
    let edge = 0.5 + 2e-8;
    check("relax(0, if(t < 0.5 + 2e-8, 0, 1))", 1e-13, |_, t| (t - edge).max(0.0));
    let [from, to] = [0.55, 0.55 + 1e-8];
    check("relax(0, if(t < 0.55, 0, if(t < 0.55 + 1e-8, 1, 0)))", 1e-13, |_, t| {
        t.clamp(from, to) - from
    });
    // Three changes of one guard between two of the times at which it is watched.
    let three = "relax(0, if((t-0.5003)*(t-0.5013)*(t-0.5023) < 0, 0, 1))";
    let mut graph = Graph::new();
    let f = node(&mut graph, &everything(), three);
    let found = Program::compile(&graph, &[f], 1.0).values(&[[0.0; 3]], 0.9, 0.0)[0][0];
    assert_close(found, 0.001 + 0.9 - 0.5023, 1e-13, three);
}

#[test]
fn nested_relaxation() {
    // (b, f) then (a, .): the split form, the equal rates and the nearly equal.
    let exact = |a: f64, b: f64, t: f64| {
        ((1.0 - (-b * t).exp()) / b - (1.0 - (-a * t).exp()) / a) / (a - b)
    };
    check("relax(1, relax(0.75, 1))", 1e-14, |_, t| exact(1.0, 0.75, t));
    check("relax(2, relax(0.5, t))", 1e-14, |_, t| (ramp(0.5, 0.0, t) - ramp(2.0, 0.0, t)) / 1.5);
    check("relax(1, relax(1, max(t-x,0)))", 1e-14, |x, t| {
        let u = (t - x).max(0.0);
        u - 2.0 + (u + 2.0) * (-u).exp()
    });
    check("relax(1, t*relax(1, x))", 1e-14, |x, t| {
        x * (t - 1.0 + (-t).exp() - 0.5 * t * t * (-t).exp())
    });
}

fn integrals(graph: &Graph, f: Node) -> Vec<Node> {
    let all = graph.reachable(&[f], |_| true);
    let hereditary = |n: &Node| graph.op(*n).is_integral();
    all.into_iter().filter(hereditary).collect()
}

#[test]
fn still_factors_come_out() {
    let cases = [
        ("relax(1, y*sin(t))", "", 1),
        ("relax(1, -(x*sin(t)/(1+y))*z^2)", "", 1),
        ("relax(1, (x+t)*sin(t))", "", 2),
        ("relax(1, (x*t+y*sin(t))/3)", "", 2),
        ("relax(1, (x*sin(t))^2)", "", 1),
        ("relax(1, y*relax(0.75, sin(x*t)))", "x", 2),
        ("relax(1, y*(1-y)*(-sin(x*t)/3 - relax(0.75, sin(x*t))/12))", "x", 2),
        ("relax(1, if(y<0.5, sin(t), cos(t)))", "", 2),
        ("d(relax(1, y*sin(x*t)), y)", "x", 1),
    ];
    for (text, allowed, count) in cases {
        let mut graph = Graph::new();
        let f = node(&mut graph, &everything(), text);
        let found = integrals(&graph, f);
        assert_eq!(found.len(), count, "{text}");
        for n in found {
            for v in [Variable::X, Variable::Y, Variable::Z] {
                let may = allowed.contains(v.name());
                assert!(may || !graph.depends_on(n, v), "{text}: {}", v.name());
            }
            assert!(graph.depends_on(n, Variable::T));
        }
    }
}

#[test]
fn derivatives_of_integrals() {
    let h = 1e-4;
    for text in ["relax(1.2, sin(x*t))", "relax(0.5, max(t-x, 0)^2*x)"] {
        for (v, step) in [("x", [h, 0.0]), ("t", [0.0, h])] {
            let at = |k: f64| value(text, [0.4 + k * step[0], 0.0, 0.0, 0.9 + k * step[1]]);
            let quotient = (8.0 * (at(1.0) - at(-1.0)) - at(2.0) + at(-2.0)) / (12.0 * h);
            let slope = value(&format!("d({text}, {v})"), [0.4, 0.0, 0.0, 0.9]);
            assert_close(slope, quotient, 1e-10, text);
        }
    }
}

#[test]
fn convolution() {
    // Integral of s / (1 + t - s): (1+t) log(1+t) - t.
    let mut graph = Graph::new();
    let scope = everything();
    let kernel = node(&mut graph, &scope, "1/(1+t)");
    let f = node(&mut graph, &scope, "x*t");
    let smooth = graph.convolve(kernel, f);
    assert!(integrals(&graph, smooth).iter().all(|n| !graph.depends_on(*n, Variable::X)));
    let exact = |u: f64| (1.0 + u) * u.ln_1p() - u;
    check_node(&mut graph, smooth, "b * xt", 1e-14, |x, t| x * exact(t));
    let f = node(&mut graph, &scope, "max(t-x/3, 0)");
    let kinked = graph.convolve(kernel, f);
    check_node(&mut graph, kinked, "b * kink", 1e-14, |x, t| exact((t - x / 3.0).max(0.0)));
    // d/dt gives b(0) f + b' * f = log(1 + t - x/3).
    let slope = graph.derivative(kinked, Variable::T);
    check_node(&mut graph, slope, "(b * kink)'", 2e-14, |x, t| (t - x / 3.0).max(0.0).ln_1p());
    let kernel = node(&mut graph, &scope, "1-exp(-2*t)");
    let f = node(&mut graph, &scope, "sin(x*t)");
    let ours = graph.convolve(kernel, f);
    let expected = node(&mut graph, &scope, "relax(0, sin(x*t)) - relax(2, sin(x*t))");
    assert_eq!(ours, expected);
}

/// ∫_0^t (t-s)^a s^m ds = B(a+1, m+1) t^{a+m+1}: a kernel with a root at lag zero, with t on an edge of a panel, just
/// after one and far from any.
#[test]
fn convolution_with_a_root_at_zero_lag() {
    let mut graph = Graph::new();
    for (power, beta) in [(0.5, [2.0 / 3.0, 4.0 / 15.0]), (0.3, [1.0 / 1.3, 1.0 / (1.3 * 2.3)])] {
        for (text, m) in [("1 + 0*x", 0), ("t", 1)] {
            let kernel = node(&mut graph, &everything(), &format!("t^{power}"));
            let f = node(&mut graph, &everything(), text);
            let past = graph.convolve(kernel, f);
            let mut bound = Program::compile(&graph, &[past], 1.0).bind(&[[0.5; 3]]);
            let mut out = vec![Vec::new()];
            for t in [0.0, 1e-3, 1.0 / 64.0, 0.25, 0.25 + 1e-7, 0.3337, 1.0] {
                bound.evaluate(t, 0.0, &mut out);
                let exact = beta[m] * t.powf(power + 1.0 + m as f64);
                // 1e-8 without the weights near the end.
                assert_close(out[0][0], exact, 1e-12, &format!("{power} {text} at {t}"));
            }
        }
    }
}

/// A kernel and a displacement that are both singular: ∫_0^t (t-s)^-0.4 s^0.6 ds = B(0.6, 1.6) t^1.2.
#[test]
fn powers_at_both_ends_are_integrated_to_rounding() {
    let mut graph = Graph::new();
    let [kernel, f] = ["t^(-0.4)", "t^0.6"].map(|text| node(&mut graph, &everything(), text));
    let past = graph.convolve(kernel, f);
    let mut bound = Program::compile(&graph, &[past], 1.0).bind(&[[0.5; 3]]);
    // Γ(0.6) Γ(1.6)/Γ(2.2).
    let beta = 1.489_192_248_812_817 * 0.893_515_349_287_690_3 / 1.101_802_490_879_712_8;
    for t in [1e-3, 0.25, 0.25 + 1e-7, 0.3337, 1.0] {
        let exact = beta * f64::powf(t, 1.2);
        assert_close(bound.values_at(t, 0.0)[0][0], exact, 2e-15, &format!("at {t}"));
    }
}

#[test]
fn an_instant_leaves_the_past_out() {
    let mut graph = Graph::new();
    let f = node(&mut graph, &everything(), "x*t^2 + relax(2, x*t) + max(t, relax(1, t) - 1)");
    let frozen = graph.instant(f, 0.5);
    assert!(!graph.depends_on(frozen, Variable::T));
    for t in [0.0, 0.3, 2.0] {
        let at = EvaluationPoint { x: 3.0, t, ..EvaluationPoint::default() };
        assert_eq!(by_definition(&graph, frozen, &at), 3.0 * 0.25 + 0.5);
    }
}

/// A spike of width 0.02, of which one panel of a sixteenth misses 1e-7.
#[test]
fn panels_are_halved_where_an_integrand_is_not_resolved() {
    let mut graph = Graph::new();
    let f = node(&mut graph, &everything(), "relax(0, 1/(1 + ((t-0.4)/0.02)^2))");
    let mut bound = Program::compile(&graph, &[f], 1.0).bind(&[[0.0; 3]]);
    let mut out = [Vec::new()];
    for t in [0.25, 0.4, 0.41, 1.0] {
        bound.evaluate(t, 0.0, &mut out);
        let exact = 0.02 * (((t - 0.4) / 0.02).atan() + 20f64.atan());
        assert_close(out[0][0], exact, 1e-14, &format!("t={t}"));
    }
}
