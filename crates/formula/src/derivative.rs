//! Exact derivatives.

use super::graph::{Graph, Node, Op, Variable};
use super::vocabulary::Function;

impl Graph {
    /// The derivative of `f` with respect to `v`.
    ///
    /// max, min and `if` differentiate the branch taken, |a|' = sign(a) a' and sign' = 0: valid off the kinks. For
    /// hereditary integrals d/dx goes inside, and d/dt relax(c,f) = f - c relax(c,f), d/dt (b * f) = b(0) f + b' * f.
    pub fn derivative(&mut self, f: Node, v: Variable) -> Node {
        // Nodes without v have derivative zero; those below a finished node are not needed.
        let order = self
            .reachable(&[f], |n| self.depends_on(n, v) && !self.derivatives.contains_key(&(n, v)));
        for node in order {
            if !self.derivatives.contains_key(&(node, v)) {
                let slope = self.one_derivative(node, v);
                self.derivatives.insert((node, v), slope);
            }
        }
        self.slope(f, v)
    }

    fn slope(&mut self, f: Node, v: Variable) -> Node {
        match self.derivatives.get(&(f, v)) {
            Some(&slope) => slope,
            None => self.constant(0.0),
        }
    }

    fn one_derivative(&mut self, f: Node, v: Variable) -> Node {
        if !self.depends_on(f, v) {
            return self.constant(0.0);
        }
        let op = self.op(f);
        let names = [["a", "da"], ["b", "db"], ["p", "dp"], ["q", "dq"]];
        let mut nodes = vec![("f", f)];
        for ([name, of_slope], node) in names.into_iter().zip(op.operands()) {
            nodes.extend([(name, node), (of_slope, self.slope(node, v))]);
        }
        let (mut rule, mut numbers) = ("1", Vec::new());
        let of_function;
        match op {
            Op::Constant(_) | Op::Variable(_) => {}
            Op::Neg(_) => rule = "-da",
            Op::Add(..) => rule = "da + db",
            Op::Sub(..) => rule = "da - db",
            Op::Mul(..) => rule = "da*b + a*db",
            Op::Div(..) => rule = "(da - f*db)/b",
            Op::Power(_, n) => {
                rule = "n*a^(n - 1)*da";
                numbers.push(("n", f64::from(n)));
            }
            Op::Pow(..) => rule = "b*a^(b - 1)*da + f*log(a)*db",
            Op::Apply(function, _) => {
                of_function = format!("({})*da", slope(function));
                rule = &of_function;
            }
            Op::Max(..) => rule = "if(a < b, db, da)",
            Op::Min(..) => rule = "if(a < b, da, db)",
            Op::Less(_) => rule = "if(a < b, dp, dq)",
            Op::Relax(c, a) if v != Variable::T => {
                let da = self.slope(a, v);
                return self.relax(f64::from_bits(c), da);
            }
            Op::Relax(c, _) => {
                rule = "a - c*f";
                numbers.push(("c", f64::from_bits(c)));
            }
            Op::Convolve(kernel, a) if v != Variable::T => {
                let da = self.slope(a, v);
                return self.convolve(kernel, da);
            }
            // (∫₀ᵗ b(t − s) a(s) ds)' = b(0) a + ∫₀ᵗ b'(t − s) a(s) ds; b is independent of space.
            Op::Convolve(kernel, a) => {
                let (zero, change) = (self.constant(0.0), self.slope(kernel, v));
                let initial = self.substitute(kernel, Variable::T, zero);
                nodes = vec![("b", initial), ("a", a), ("past", self.convolve(change, a))];
                rule = "b*a + past";
            }
        }
        self.written(rule, &nodes, &numbers)
    }
}

/// The derivative of a function f of a.
fn slope(function: Function) -> &'static str {
    match function {
        Function::Sin => "cos(a)",
        Function::Cos => "-sin(a)",
        Function::Tan => "1 + f^2",
        Function::Asin => "1/sqrt(1 - a^2)",
        Function::Acos => "-(1/sqrt(1 - a^2))",
        Function::Atan => "1/(1 + a^2)",
        Function::Sinh => "cosh(a)",
        Function::Cosh => "sinh(a)",
        Function::Tanh => "1 - f^2",
        Function::Exp => "f",
        Function::ExpMinusOne => "exp(a)",
        Function::Log => "1/a",
        Function::Sqrt => "0.5/f",
        Function::Abs => "sign(a)",
        Function::Sign => "0",
    }
}
