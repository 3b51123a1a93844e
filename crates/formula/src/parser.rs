//! Precedence climbing.

use std::ops::Range;

use super::error::ParseError;
use super::graph::{Graph, Node, Variable};
use super::lexer::{Spanned, Token, tokens};
use super::meaning::{Condition, Meaning, Parsed, condition, number};
use super::scope::Scope;

/// Longest accepted text, in bytes.
const LONGEST: usize = 64 * 1024;
/// Deepest nesting of integrals over the past: with one more a `check` of one formula takes 10 s.
const DEEPEST_PAST: usize = 4;
/// Deepest nesting of parentheses, arguments and prefix operators.
const DEEPEST: usize = 200;

/// Binding strengths of operators, loosest first.
mod binding {
    pub(super) const OR: u8 = 1;
    pub(super) const AND: u8 = 2;
    pub(super) const COMPARISON: u8 = 3;
    pub(super) const SUM: u8 = 4;
    pub(super) const PRODUCT: u8 = 5;
    pub(super) const MINUS: u8 = 6;
    pub(super) const POWER: u8 = 7;
}

pub(super) struct Parser<'a> {
    pub(super) graph: &'a mut Graph,
    pub(super) scope: &'a Scope,
    tokens: Vec<Spanned<'a>>,
    at: usize,
    depth: usize,
}

impl Graph {
    /// Reads a formula.
    ///
    /// # Errors
    /// [`ParseError`] with the bytes at fault.
    pub fn parse(&mut self, text: &str, scope: &Scope) -> Result<Node, ParseError> {
        if text.len() > LONGEST {
            let span = LONGEST..text.len();
            return Err(ParseError::new(span, "the formula is longer than 64 KiB")
                .hinted("name parts of it as separate quantities"));
        }
        if text.trim().is_empty() {
            return Err(ParseError::new(0..text.len(), "the formula is empty"));
        }
        let node = self.read(text, scope)?;
        let depth = self.past_depth(node);
        if depth > DEEPEST_PAST {
            let message = format!(
                "integrals over the past stand within each other {depth} deep, and {DEEPEST_PAST} is the limit: each takes some 20 times as long as the one inside it"
            );
            return Err(ParseError::new(0..text.len(), message).hinted(
                "relax(a, relax(b, f)) with other rates counts once; write inner ones in closed form",
            ));
        }
        Ok(node)
    }

    fn read(&mut self, text: &str, scope: &Scope) -> Result<Node, ParseError> {
        let tokens = tokens(text)?;
        let mut parser = Parser { graph: self, scope, tokens, at: 0, depth: 0 };
        let parsed = parser.expression(0)?;
        parser.end()?;
        number(parsed)
    }

    /// A formula that the program itself writes, in the variables and in named nodes and numbers.
    ///
    /// # Panics
    /// A text that is no formula in these names.
    pub fn written(&mut self, text: &str, nodes: &[(&str, Node)], numbers: &[(&str, f64)]) -> Node {
        let mut scope = Scope::new(&Variable::ALL);
        nodes.iter().for_each(|(name, node)| scope.define(name, *node));
        for (name, number) in numbers {
            scope.define(name, self.constant(*number));
        }
        self.read(text, &scope).unwrap_or_else(|error| panic!("`{text}`: {error}"))
    }
}

impl<'a> Parser<'a> {
    pub(super) fn peek(&self) -> Spanned<'a> {
        // The last token is the end and is never passed.
        self.tokens[self.at.min(self.tokens.len() - 1)].clone()
    }

    pub(super) fn next(&mut self) -> Spanned<'a> {
        let token = self.peek();
        self.at += 1;
        token
    }

    pub(super) fn take(&mut self, symbol: &str) -> Option<Range<usize>> {
        match self.peek() {
            (Token::Symbol(s), span) if s == symbol => {
                self.at += 1;
                Some(span)
            }
            _ => None,
        }
    }

    fn end(&self) -> Result<(), ParseError> {
        let (token, span) = self.peek();
        let error = match token {
            Token::End => return Ok(()),
            Token::Symbol(")") => ParseError::new(span, "this parenthesis was never opened"),
            Token::Symbol(",") => ParseError::new(span, "a comma outside an argument list"),
            Token::Symbol("=") => equals(span),
            _ => ParseError::new(span, "expected an operator here, or the end of the formula")
                .hinted("products are written with `*`"),
        };
        Err(error)
    }

    pub(super) fn nested<T>(
        &mut self,
        span: &Range<usize>,
        inside: impl FnOnce(&mut Self) -> Result<T, ParseError>,
    ) -> Result<T, ParseError> {
        if self.depth >= DEEPEST {
            let message = format!("the formula is nested deeper than {DEEPEST}");
            return Err(ParseError::new(span.clone(), message)
                .hinted("name parts of it as separate quantities"));
        }
        self.depth += 1;
        let result = inside(self);
        self.depth -= 1;
        result
    }

    /// An expression of operators that bind at least as tightly as `least`.
    pub(super) fn expression(&mut self, least: u8) -> Result<Parsed, ParseError> {
        let mut left = self.prefix()?;
        loop {
            let (token, span) = self.peek();
            let Some((operator, strength)) = infix(token) else {
                return Ok(left);
            };
            if strength < least {
                return Ok(left);
            }
            self.at += 1;
            let right = match strength {
                // Right-associative; the exponent may have a sign.
                binding::POWER => self.nested(&span, |p| p.expression(binding::MINUS))?,
                _ => self.expression(strength + 1)?,
            };
            left = self.combine(operator, left, right)?;
            if strength == binding::COMPARISON
                && infix(self.peek().0).is_some_and(|o| o.1 == strength)
            {
                let span = self.peek().1;
                return Err(ParseError::new(span, "comparisons cannot be chained")
                    .hinted("write `a < b and b < c`"));
            }
        }
    }

    fn prefix(&mut self) -> Result<Parsed, ParseError> {
        let (token, span) = self.peek();
        match token {
            Token::Symbol(sign @ ("-" | "+")) => {
                self.at += 1;
                let operand = self.nested(&span, |p| p.expression(binding::MINUS))?;
                let whole = span.start..operand.1.end;
                let value = number(operand)?;
                let value = if sign == "-" { self.graph.neg(value) } else { value };
                Ok((Meaning::Number(value), whole))
            }
            Token::Name("not") => {
                self.at += 1;
                let operand = self.nested(&span, |p| p.expression(binding::COMPARISON))?;
                let whole = span.start..operand.1.end;
                let inner = Box::new(condition(operand)?);
                Ok((Meaning::Condition(Condition::Not(inner)), whole))
            }
            _ => self.operand(),
        }
    }

    fn combine(&mut self, operator: &str, a: Parsed, b: Parsed) -> Result<Parsed, ParseError> {
        let span = a.1.start..b.1.end;
        if let "and" | "or" = operator {
            let (a, b) = (condition(a)?, condition(b)?);
            let chain = match (operator, a) {
                ("and", Condition::All(mut list)) => {
                    list.push(b);
                    Condition::All(list)
                }
                ("and", a) => Condition::All(vec![a, b]),
                (_, Condition::Any(mut list)) => {
                    list.push(b);
                    Condition::Any(list)
                }
                (_, a) => Condition::Any(vec![a, b]),
            };
            return Ok((Meaning::Condition(chain), span));
        }
        let (a, b) = (number(a)?, number(b)?);
        let not = |c| Meaning::Condition(Condition::Not(Box::new(c)));
        let meaning = match operator {
            "+" => Meaning::Number(self.graph.add(a, b)),
            "-" => Meaning::Number(self.graph.sub(a, b)),
            "*" => Meaning::Number(self.graph.mul(a, b)),
            "/" => Meaning::Number(self.graph.div(a, b)),
            "^" => Meaning::Number(self.graph.pow(a, b)),
            "<" => Meaning::Condition(Condition::Less(a, b)),
            ">" => Meaning::Condition(Condition::Less(b, a)),
            "<=" => not(Condition::Less(b, a)),
            _ => not(Condition::Less(a, b)),
        };
        Ok((meaning, span))
    }
}

fn infix(token: Token<'_>) -> Option<(&str, u8)> {
    let (Token::Symbol(word) | Token::Name(word)) = token else {
        return None;
    };
    let strength = match word {
        "or" => binding::OR,
        "and" => binding::AND,
        "<" | "<=" | ">" | ">=" => binding::COMPARISON,
        "+" | "-" => binding::SUM,
        "*" | "/" => binding::PRODUCT,
        "^" => binding::POWER,
        _ => return None,
    };
    Some((word, strength))
}

/// `=` occurs in no formula.
pub(super) fn equals(span: Range<usize>) -> ParseError {
    ParseError::new(span, "`=` has no meaning in a formula")
        .hinted("comparisons are `<`, `<=`, `>` and `>=`")
}
