//! Execution of tapes in blocks of lanes.

use super::tape::{Register, Source, Step, Tape};
use super::vocabulary::{Function, power, sign};

/// Lanes of a block: a few dozen registers of this length fit in cache.
pub(super) const BLOCK: usize = 128;

#[derive(Clone, Debug, Default)]
pub(super) struct Registers {
    blocks: Vec<Vec<f64>>,
}

impl Registers {
    pub(super) fn lanes(&self, register: Register, count: usize) -> &[f64] {
        &self.blocks[register][..count]
    }

    /// Runs `tape` on `count` lanes; `fetch` supplies external values.
    pub(super) fn run(&mut self, tape: &Tape, count: usize, fetch: impl FnMut(Source, &mut [f64])) {
        self.make_room(tape.registers, count);
        pulp::Arch::new().dispatch(Run { registers: self, tape, count, fetch });
    }

    fn make_room(&mut self, registers: usize, count: usize) {
        let lanes = count.max(self.blocks.first().map_or(BLOCK, Vec::len));
        if self.blocks.len() < registers || self.blocks.iter().any(|block| block.len() < lanes) {
            self.blocks.resize_with(self.blocks.len().max(registers), Vec::new);
            self.blocks.iter_mut().for_each(|block| block.resize(lanes, 0.0));
        }
    }

    #[inline(always)]
    fn run_steps(&mut self, tape: &Tape, count: usize, mut fetch: impl FnMut(Source, &mut [f64])) {
        for (out, step, equal) in &tape.steps {
            // Taken out, so that operands can be read meanwhile.
            let mut target = std::mem::take(&mut self.blocks[*out]);
            let lanes = if *equal { count.min(1) } else { count };
            match step {
                Step::Fetch(source) => fetch(*source, &mut target[..lanes]),
                step => self.compute(step, &mut target[..lanes]),
            }
            let first = target[0];
            target[lanes..count].fill(first);
            self.blocks[*out] = target;
        }
    }

    #[inline(always)]
    fn compute(&self, step: &Step, out: &mut [f64]) {
        match *step {
            Step::Constant(v) => out.fill(v),
            Step::Fetch(_) => {}
            Step::Neg(a) => self.unary(a, out, |a| -a),
            Step::Scale(v, a) => self.unary(a, out, |a| v * a),
            Step::Shift(v, a) => self.unary(a, out, |a| v + a),
            Step::From(v, a) => self.unary(a, out, |a| v - a),
            Step::Over(a, v) => self.unary(a, out, |a| a / v),
            Step::Add(a, b) => self.binary([a, b], out, |a, b| a + b),
            Step::Sub(a, b) => self.binary([a, b], out, |a, b| a - b),
            Step::Mul(a, b) => self.binary([a, b], out, |a, b| a * b),
            Step::Div(a, b) => self.binary([a, b], out, |a, b| a / b),
            Step::Max(a, b) => self.binary([a, b], out, f64::max),
            Step::Min(a, b) => self.binary([a, b], out, f64::min),
            Step::Pow(a, b) => self.binary([a, b], out, f64::powf),
            Step::Power(a, n) => self.power(a, n, out),
            Step::Apply(function, a) => self.apply(function, a, out),
            Step::Less(four) => self.select(four, out),
        }
    }

    #[inline(always)]
    fn unary(&self, a: Register, out: &mut [f64], f: impl Fn(f64) -> f64) {
        for (out, a) in out.iter_mut().zip(&self.blocks[a]) {
            *out = f(*a);
        }
    }

    #[inline(always)]
    fn binary(&self, [a, b]: [Register; 2], out: &mut [f64], f: impl Fn(f64, f64) -> f64) {
        let operands = self.blocks[a].iter().zip(&self.blocks[b]);
        for (out, (a, b)) in out.iter_mut().zip(operands) {
            *out = f(*a, *b);
        }
    }

    /// Small powers have loops that compile to plain products.
    #[inline(always)]
    fn power(&self, a: Register, n: i32, out: &mut [f64]) {
        match n {
            -1 => self.unary(a, out, |a| power(a, -1)),
            2 => self.unary(a, out, |a| power(a, 2)),
            3 => self.unary(a, out, |a| power(a, 3)),
            4 => self.unary(a, out, |a| power(a, 4)),
            5 => self.unary(a, out, |a| power(a, 5)),
            6 => self.unary(a, out, |a| power(a, 6)),
            7 => self.unary(a, out, |a| power(a, 7)),
            8 => self.unary(a, out, |a| power(a, 8)),
            _ => self.unary(a, out, |a| power(a, n)),
        }
    }

    #[inline(always)]
    fn apply(&self, function: Function, a: Register, out: &mut [f64]) {
        match function {
            Function::Sqrt => self.unary(a, out, f64::sqrt),
            Function::Abs => self.unary(a, out, f64::abs),
            Function::Sign => self.unary(a, out, sign),
            _ => self.unary(a, out, |a| function.value(a)),
        }
    }

    #[inline(always)]
    fn select(&self, [a, b, p, q]: [Register; 4], out: &mut [f64]) {
        let n = out.len();
        let [a, b, p, q] = [a, b, p, q].map(|r| &self.blocks[r][..n]);
        for i in 0..n {
            // Both are read, so that the choice is a blend and not a jump.
            let (then, otherwise) = (p[i], q[i]);
            out[i] = if a[i] < b[i] { then } else { otherwise };
        }
    }
}

struct Run<'a, F> {
    registers: &'a mut Registers,
    tape: &'a Tape,
    count: usize,
    fetch: F,
}

impl<F: FnMut(Source, &mut [f64])> pulp::WithSimd for Run<'_, F> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        self.registers.run_steps(self.tape, self.count, self.fetch);
    }
}

#[cfg(test)]
mod tests {
    use super::super::graph::{Graph, Variable};
    use super::super::scope::Scope;
    use super::*;

    const COUNT: usize = 101;

    /// The result is bit-identical to scalar code; a fused multiply-add would give other bits on these lanes.
    #[test]
    fn wide_vectors_give_the_bits_of_single_operations() {
        let mut graph = Graph::new();
        let scope = Scope::new(&[Variable::T]);
        let texts = [
            "0.3*t + 1/7",
            "(t + 0.1)*(t - 0.7) - t/3",
            "sqrt(abs(t))^3/(1 + t^2)",
            "if(t < 0.5, sin(t)*exp(t), max(t, 1/3) - min(t^2, 0.9))",
        ];
        let roots = texts.map(|text| graph.parse(text, &scope).expect("a formula"));
        let tape = Tape::compile(&graph, &roots, &Default::default(), false);
        let times: Vec<f64> = (0..COUNT).map(|k| (0.1 + k as f64).sqrt() - 3.0).collect();
        let fetch = |_: Source, out: &mut [f64]| out.copy_from_slice(&times);
        let (mut wide, mut plain) = (Registers::default(), Registers::default());
        wide.run(&tape, COUNT, fetch);
        plain.make_room(tape.registers, COUNT);
        plain.run_steps(&tape, COUNT, fetch);
        let bits = |registers: &Registers, result: Register| -> Vec<u64> {
            registers.lanes(result, COUNT).iter().map(|value| value.to_bits()).collect()
        };
        for (&result, text) in tape.results.iter().zip(texts) {
            assert_eq!(bits(&wide, result), bits(&plain, result), "{text}");
        }
        let fused = |(t, bits): (&f64, u64)| 0.3f64.mul_add(*t, 1.0 / 7.0).to_bits() != bits;
        let first = bits(&plain, tape.results[0]);
        assert!(times.iter().zip(first).filter(|pair| fused(*pair)).count() > COUNT / 10);
    }
}
