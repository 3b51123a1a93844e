//! Proved ranges of formulas: interval arithmetic over the graph, rounded outward.
//!
//! A range contains every value of the formula as the graph states it, in real arithmetic, at every place of a box.
//! Constants are taken as they stand in the graph, so what was rounded when a formula was built stays rounded. A function of
//! the standard library is taken to be within 4 units in the last place.

use super::graph::{Graph, Node, Op, Variable};
use super::vocabulary::Function;

/// Numbers from `low` to `high`; an infinite end means no bound on that side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    pub low: f64,
    pub high: f64,
}

impl Interval {
    pub const ALL: Self = Self { low: f64::NEG_INFINITY, high: f64::INFINITY };

    pub fn new(low: f64, high: f64) -> Self {
        Self { low, high }
    }

    /// One number; no bound at all for NaN.
    pub fn point(value: f64) -> Self {
        if value.is_nan() { Self::ALL } else { Self::new(value, value) }
    }

    pub fn contains(self, value: f64) -> bool {
        self.low <= value && value <= self.high
    }

    pub fn is_finite(self) -> bool {
        self.low.is_finite() && self.high.is_finite()
    }

    /// The largest modulus.
    pub fn size(self) -> f64 {
        self.low.abs().max(self.high.abs())
    }

    /// |a| of all its numbers.
    #[must_use]
    pub fn abs(self) -> Self {
        let least = if self.contains(0.0) { 0.0 } else { self.low.abs().min(self.high.abs()) };
        Self::new(least, self.size())
    }

    /// The shortest interval around both.
    #[must_use]
    pub fn hull(self, other: Self) -> Self {
        Self::new(self.low.min(other.low), self.high.max(other.high))
    }

    /// A number inside, finite, for bisection: the middle, or twice as far out where an end is infinite.
    pub fn middle(self) -> f64 {
        match (self.low.is_finite(), self.high.is_finite()) {
            (true, true) => self.low + 0.5 * (self.high - self.low),
            (true, false) => (2.0 * self.low.abs()).clamp(1.0, f64::MAX),
            (false, true) => (-2.0 * self.high.abs()).clamp(f64::MIN, -1.0),
            (false, false) => 0.0,
        }
    }

    fn widened(low: f64, high: f64) -> Self {
        let outward = |value: f64, sign: f64| match value {
            0.0 => sign * f64::from_bits(4),
            // An overflow: beyond the largest number, and finite.
            _ if value == -sign * f64::INFINITY => -sign * f64::MAX,
            _ => value + sign * (4.0 * f64::EPSILON) * value.abs(),
        };
        Self::new(outward(low, -1.0), outward(high, 1.0))
    }
}

impl std::ops::Neg for Interval {
    type Output = Self;
    fn neg(self) -> Self {
        Self::new(-self.high, -self.low)
    }
}

/// The two neighbours of an exact result, given the rounded one and the sign of what rounding took away: the rounded result
/// itself where it is exact.
fn around(rounded: f64, missing: f64) -> Interval {
    match rounded {
        // An overflow: the exact result is finite, and beyond the largest number.
        f64::INFINITY => Interval::new(f64::MAX, f64::INFINITY),
        f64::NEG_INFINITY => Interval::new(f64::NEG_INFINITY, f64::MIN),
        _ if missing > 0.0 => Interval::new(rounded, rounded.next_up()),
        _ if missing < 0.0 => Interval::new(rounded.next_down(), rounded),
        _ if missing == 0.0 => Interval::point(rounded),
        _ => Interval::new(rounded.next_down(), rounded.next_up()),
    }
}

/// Products and quotients below this may lose bits that the fused operations do not show.
const SMALL: f64 = 1e-280;

fn sum(a: f64, b: f64) -> Interval {
    if !a.is_finite() || !b.is_finite() {
        return Interval::point(a + b);
    }
    let rounded = a + b;
    // Knuth's exact error of a sum.
    let part = rounded - a;
    around(rounded, (a - (rounded - part)) + (b - part))
}

/// 0 times an end without bound is 0: no number in the interval is infinite.
fn product(a: f64, b: f64) -> Interval {
    if a == 0.0 || b == 0.0 {
        return Interval::point(0.0);
    }
    if !a.is_finite() || !b.is_finite() {
        return Interval::point(a * b);
    }
    let rounded = a * b;
    let missing = if rounded.abs() > SMALL { a.mul_add(b, -rounded) } else { f64::NAN };
    around(rounded, missing)
}

/// b is not zero.
fn quotient(a: f64, b: f64) -> Interval {
    if a == 0.0 || b.is_infinite() {
        return Interval::point(0.0);
    }
    if a.is_infinite() {
        return Interval::point(a / b);
    }
    let rounded = a / b;
    let missing = if rounded.abs() > SMALL && a.abs() > SMALL {
        (-rounded).mul_add(b, a) * b.signum()
    } else {
        f64::NAN
    };
    around(rounded, missing)
}

impl std::ops::Add for Interval {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::new(sum(self.low, other.low).low, sum(self.high, other.high).high)
    }
}

impl std::ops::Mul for Interval {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let ends = [
            product(self.low, other.low),
            product(self.low, other.high),
            product(self.high, other.low),
            product(self.high, other.high),
        ];
        ends.into_iter().reduce(Self::hull).unwrap_or(Self::ALL)
    }
}

/// What is known of a formula on a box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Enclosure {
    /// Contains every value.
    pub range: Interval,
    /// The formula may have no value somewhere in the box: the root of a negative number, 0/0.
    pub undefined: bool,
    /// A condition of `if`, or the sign of `sign`, changes in the box, as far as known: it may have jumps.
    pub branches: bool,
}

impl Enclosure {
    fn of(range: Interval) -> Self {
        Self { range, undefined: false, branches: false }
    }
}

/// A box in the space of all variables; those not mentioned are zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place([Interval; 5]);

impl Place {
    /// All variables zero.
    pub fn origin() -> Self {
        Self([Interval::point(0.0); 5])
    }

    /// With this range of a variable.
    #[must_use]
    pub fn with(mut self, v: Variable, range: Interval) -> Self {
        self.0[v as usize] = range;
        self
    }
}

/// A formula prepared for enclosures on many boxes.
#[derive(Clone, Debug)]
pub struct Enclosing<'a> {
    graph: &'a Graph,
    root: Node,
    order: Vec<Node>,
    values: Vec<Enclosure>,
}

impl Graph {
    /// `f` for enclosures. Hereditary integrals in it have no bound.
    pub fn enclosing(&self, f: Node) -> Enclosing<'_> {
        let order = self.reachable(&[f], |n| !self.op(n).is_integral());
        let values = vec![Enclosure::of(Interval::ALL); f.index() + 1];
        Enclosing { graph: self, root: f, order, values }
    }
}

impl Enclosing<'_> {
    /// What is known of the formula in a box.
    pub fn over(&mut self, place: &Place) -> Enclosure {
        for k in 0..self.order.len() {
            let node = self.order[k];
            self.values[node.index()] = self.one(node, place);
        }
        self.values[self.root.index()]
    }

    fn one(&self, node: Node, place: &Place) -> Enclosure {
        let of = |n: Node| self.values[n.index()];
        let range = |n: Node| of(n).range;
        let op = self.graph.op(node);
        let new = match op {
            Op::Constant(bits) => {
                let value = f64::from_bits(bits);
                Enclosure { undefined: value.is_nan(), ..Enclosure::of(Interval::point(value)) }
            }
            Op::Variable(v) => Enclosure::of(place.0[v as usize]),
            Op::Neg(a) => Enclosure::of(-range(a)),
            Op::Add(a, b) => Enclosure::of(range(a) + range(b)),
            Op::Sub(a, b) => Enclosure::of(range(a) + -range(b)),
            Op::Mul(a, b) => Enclosure::of(range(a) * range(b)),
            Op::Div(a, b) => divided(range(a), range(b)),
            Op::Power(a, n) => whole_power(range(a), n),
            Op::Pow(a, b) => real_power(range(a), range(b)),
            Op::Apply(function, a) => applied(function, range(a)),
            Op::Max(a, b) => {
                let (a, b) = (range(a), range(b));
                Enclosure::of(Interval::new(a.low.max(b.low), a.high.max(b.high)))
            }
            Op::Min(a, b) => {
                let (a, b) = (range(a), range(b));
                Enclosure::of(Interval::new(a.low.min(b.low), a.high.min(b.high)))
            }
            Op::Less([a, b, then, otherwise]) => {
                let condition = of(a).undefined || of(b).undefined;
                let mut taken = if range(a).high < range(b).low {
                    of(then)
                } else if range(a).low >= range(b).high {
                    of(otherwise)
                } else {
                    let (then, otherwise) = (of(then), of(otherwise));
                    Enclosure {
                        range: then.range.hull(otherwise.range),
                        undefined: then.undefined || otherwise.undefined,
                        branches: true,
                    }
                };
                taken.undefined |= condition;
                return taken;
            }
            Op::Relax(..) | Op::Convolve(..) => {
                return Enclosure { undefined: true, ..Enclosure::of(Interval::ALL) };
            }
        };
        op.operands().map(of).fold(new, |new, operand| Enclosure {
            undefined: new.undefined || operand.undefined,
            branches: new.branches || operand.branches,
            ..new
        })
    }
}

fn divided(a: Interval, b: Interval) -> Enclosure {
    if b.low > 0.0 || b.high < 0.0 {
        let ends = [
            quotient(a.low, b.low),
            quotient(a.low, b.high),
            quotient(a.high, b.low),
            quotient(a.high, b.high),
        ];
        return Enclosure::of(ends.into_iter().reduce(Interval::hull).unwrap_or(Interval::ALL));
    }
    let undefined = a.contains(0.0);
    let range = match (b.low == 0.0, b.high == 0.0) {
        (true, false) => a * Interval::new(quotient(1.0, b.high).low, f64::INFINITY),
        (false, true) => a * Interval::new(f64::NEG_INFINITY, quotient(1.0, b.low).high),
        _ => Interval::ALL,
    };
    Enclosure { undefined, ..Enclosure::of(if undefined { Interval::ALL } else { range }) }
}

fn whole_power(a: Interval, n: i32) -> Enclosure {
    let of = |value: f64| {
        let (mut base, mut rest) = (Interval::point(value), n.unsigned_abs());
        let mut power = Interval::point(1.0);
        while rest > 0 {
            if rest & 1 == 1 {
                power = power * base;
            }
            rest >>= 1;
            if rest > 0 {
                base = base * base;
            }
        }
        power
    };
    // An even power depends on |a|, and both kinds grow with what they depend on.
    let argument = if n % 2 == 0 { a.abs() } else { a };
    let power = Interval::new(of(argument.low).low, of(argument.high).high);
    if n < 0 { divided(Interval::point(1.0), power) } else { Enclosure::of(power) }
}

fn real_power(a: Interval, b: Interval) -> Enclosure {
    let undefined = a.low < 0.0;
    let base = Interval::new(a.low.max(0.0), a.high.max(0.0));
    // log(a^b) = b log(a) is bilinear in b and log(a): its extremes are at corners.
    let corners = [(base.low, b.low), (base.low, b.high), (base.high, b.low), (base.high, b.high)];
    let values = corners.map(|(a, b)| a.powf(b));
    let unbounded = values.iter().any(|value| value.is_nan()) || !b.is_finite();
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let most = values.iter().copied().fold(0.0, f64::max);
    let range = match unbounded {
        true => Interval::new(0.0, f64::INFINITY),
        false => Interval::widened(least, most),
    };
    Enclosure { undefined, ..Enclosure::of(Interval::new(range.low.max(0.0), range.high)) }
}

fn applied(function: Function, a: Interval) -> Enclosure {
    const ALL: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];
    let cut = |end: f64, [low, high]: [f64; 2]| end.clamp(low, high);
    // A function that grows: where it has values, what these lie between, and where one of them is without rounding.
    let growing = |a: Interval, domain: [f64; 2], values: [f64; 2], exact: f64| {
        let [low, high] = [a.low, a.high].map(|end| {
            let (end, value) = (cut(end, domain), function.value(cut(end, domain)));
            if end == exact { Interval::point(value) } else { Interval::widened(value, value) }
        });
        let range = Interval::new(cut(low.low, values), cut(high.high, values));
        Enclosure { undefined: a.low < domain[0] || a.high > domain[1], ..Enclosure::of(range) }
    };
    let wave = |shift: f64| {
        // The places π/2 + nπ where the function is ±1, with room for the rounding of π and of the ends.
        let quarter = std::f64::consts::FRAC_PI_2;
        let near = 1e-12 * (1.0 + a.size());
        let first = ((a.low - near + shift) / quarter).ceil();
        let last = ((a.high + near + shift) / quarter).floor();
        let hit = |remainder: f64| {
            (0..4).any(|i| {
                let place = first + f64::from(i);
                place <= last && place.rem_euclid(4.0) == remainder
            })
        };
        (hit(1.0), hit(3.0))
    };
    // Beyond this a multiple of π is not known well enough.
    let far = !a.is_finite() || a.size() > 1e6;
    let periodic = |shift: f64| {
        let unit = Interval::new(-1.0, 1.0);
        if far {
            return unit;
        }
        let values = [function.value(a.low), function.value(a.high)];
        let inner = Interval::widened(values[0].min(values[1]), values[0].max(values[1]));
        let (top, bottom) = wave(shift);
        Interval::new(
            if bottom { -1.0 } else { inner.low.max(-1.0) },
            if top { 1.0 } else { inner.high.min(1.0) },
        )
    };
    let point = a.low == a.high;
    match function {
        Function::Sin | Function::Cos if point && a.low == 0.0 => {
            Enclosure::of(Interval::point(function.value(0.0)))
        }
        Function::Sin => Enclosure::of(periodic(0.0)),
        Function::Cos => Enclosure::of(periodic(std::f64::consts::FRAC_PI_2)),
        Function::Tan => {
            let (up, down) = wave(0.0);
            let pole = far || up || down;
            if pole { Enclosure::of(Interval::ALL) } else { growing(a, ALL, ALL, 0.0) }
        }
        Function::Asin => growing(a, [-1.0, 1.0], ALL, 0.0),
        Function::Cosh => growing(a.abs(), ALL, [1.0, f64::INFINITY], 0.0),
        Function::Tanh => growing(a, ALL, [-1.0, 1.0], 0.0),
        Function::Exp => growing(a, ALL, [0.0, f64::INFINITY], 0.0),
        Function::Atan | Function::Sinh | Function::ExpMinusOne => growing(a, ALL, ALL, 0.0),
        Function::Log => growing(a, [0.0, f64::INFINITY], ALL, 1.0),
        Function::Acos => {
            let at = |end: f64| {
                let value = cut(end, [-1.0, 1.0]).acos();
                Interval::widened(value, value)
            };
            let range = Interval::new(at(a.high).low.max(0.0), at(a.low).high);
            Enclosure { undefined: a.low < -1.0 || a.high > 1.0, ..Enclosure::of(range) }
        }
        Function::Sqrt => {
            let at = |end: f64| {
                let root = end.max(0.0).sqrt();
                let exact = end.is_infinite() || (end > SMALL && root.mul_add(root, -end) == 0.0);
                if root == 0.0 || exact { Interval::point(root) } else { around(root, f64::NAN) }
            };
            let range = Interval::new(at(a.low).low, at(a.high).high);
            Enclosure { undefined: a.low < 0.0, ..Enclosure::of(range) }
        }
        Function::Abs => Enclosure::of(a.abs()),
        Function::Sign => {
            let sign = |end: f64| f64::from(i8::from(end > 0.0) - i8::from(end < 0.0));
            let range = Interval::new(sign(a.low), sign(a.high));
            Enclosure { branches: range.low != range.high, ..Enclosure::of(range) }
        }
    }
}
