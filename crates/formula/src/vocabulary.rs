//! Functions of one argument, and the words of the language beside variables.

/// A function of one argument.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Function {
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Sinh,
    Cosh,
    Tanh,
    Exp,
    /// exp(a) - 1 without cancellation; arises from constant integrands.
    ExpMinusOne,
    Log,
    Sqrt,
    /// |a|, whose derivative is sign(a).
    Abs,
    /// -1, 0 or 1 with the sign of a; its derivative is taken as zero.
    Sign,
}

const UNARY: [(&str, Function); 15] = [
    ("sin", Function::Sin),
    ("cos", Function::Cos),
    ("tan", Function::Tan),
    ("asin", Function::Asin),
    ("acos", Function::Acos),
    ("atan", Function::Atan),
    ("sinh", Function::Sinh),
    ("cosh", Function::Cosh),
    ("tanh", Function::Tanh),
    ("exp", Function::Exp),
    ("log", Function::Log),
    ("ln", Function::Log),
    ("sqrt", Function::Sqrt),
    ("abs", Function::Abs),
    ("sign", Function::Sign),
];

const SPECIAL: [&str; 5] = ["min", "max", "if", "d", "relax"];
const CONNECTIVES: [&str; 3] = ["and", "or", "not"];

impl Function {
    pub(super) fn named(name: &str) -> Option<Self> {
        UNARY.iter().find(|(n, _)| *n == name).map(|(_, f)| *f)
    }

    /// The value; sign(0) = 0.
    #[inline]
    pub(super) fn value(self, a: f64) -> f64 {
        match self {
            Self::Sin => a.sin(),
            Self::Cos => a.cos(),
            Self::Tan => a.tan(),
            Self::Asin => a.asin(),
            Self::Acos => a.acos(),
            Self::Atan => a.atan(),
            Self::Sinh => a.sinh(),
            Self::Cosh => a.cosh(),
            Self::Tanh => a.tanh(),
            Self::Exp => a.exp(),
            Self::ExpMinusOne => a.exp_m1(),
            Self::Log => a.ln(),
            Self::Sqrt => a.sqrt(),
            Self::Abs => a.abs(),
            Self::Sign => sign(a),
        }
    }
}

/// -1, 0 or 1; NaN stays NaN.
#[inline]
pub(super) fn sign(a: f64) -> f64 {
    if a > 0.0 {
        1.0
    } else if a < 0.0 {
        -1.0
    } else {
        // Adds nothing to zeros of either sign and keeps NaN.
        a + 0.0
    }
}

pub(super) fn is_function(name: &str) -> bool {
    SPECIAL.contains(&name) || Function::named(name).is_some()
}

pub(super) fn function_names() -> Vec<&'static str> {
    UNARY.iter().map(|(n, _)| *n).chain(SPECIAL).collect()
}

/// Whether the name is that of a function, a constant or a connective.
pub(super) fn is_word(name: &str) -> bool {
    name == "pi" || is_function(name) || CONNECTIVES.contains(&name)
}

#[inline]
pub(super) fn power(x: f64, n: i32) -> f64 {
    let (mut base, mut rest, mut product) = (x, n.unsigned_abs(), 1.0);
    while rest > 0 {
        if rest & 1 == 1 {
            product *= base;
        }
        rest >>= 1;
        if rest > 0 {
            base *= base;
        }
    }
    if n < 0 { 1.0 / product } else { product }
}
