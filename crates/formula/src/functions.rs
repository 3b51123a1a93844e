//! Construction of functions of one argument.

use super::graph::{Graph, Node};
use super::vocabulary::Function;

macro_rules! unary {
    ($($name:ident $function:ident $text:literal;)*) => {
        impl Graph {
            $(
                #[doc = $text]
                pub fn $name(&mut self, a: Node) -> Node {
                    self.apply(Function::$function, a)
                }
            )*
        }
    };
}

unary! {
    sin Sin "sin(a).";
    cos Cos "cos(a).";
    tan Tan "tan(a).";
    asin Asin "asin(a).";
    acos Acos "acos(a).";
    atan Atan "atan(a).";
    sinh Sinh "sinh(a).";
    cosh Cosh "cosh(a).";
    tanh Tanh "tanh(a).";
    exp Exp "exp(a).";
    log Log "The natural logarithm of a.";
    sqrt Sqrt "The square root of a.";
    abs Abs "|a|, whose derivative is sign(a).";
    sign Sign "-1, 0 or 1 with the sign of a; its derivative is taken as zero.";
}

impl Graph {
    pub(super) fn exp_minus_one(&mut self, a: Node) -> Node {
        self.apply(Function::ExpMinusOne, a)
    }
}
