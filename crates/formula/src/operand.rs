//! Operands of formulas: numbers, names, parentheses and function calls.

use std::ops::Range;

use super::error::ParseError;
use super::graph::{Node, Variable};
use super::lexer::Token;
use super::meaning::{Meaning, Parsed, condition, number};
use super::nearest::suggestion;
use super::parser::{Parser, equals};
use super::vocabulary::{Function, function_names, is_function};

impl Parser<'_> {
    pub(super) fn operand(&mut self) -> Result<Parsed, ParseError> {
        let (token, span) = self.next();
        match token {
            Token::Number(value) => {
                let node = self.graph.constant(value);
                Ok((Meaning::Number(node), span))
            }
            Token::Name(name) => match self.take("(") {
                Some(open) => self.call(name, span, &open),
                None => {
                    let node = self.name(name, &span)?;
                    Ok((Meaning::Number(node), span))
                }
            },
            Token::Symbol("(") => {
                let (meaning, _) = self.nested(&span, |p| p.expression(0))?;
                let end = self.close(&span)?;
                Ok((meaning, span.start..end))
            }
            Token::Symbol("=") => Err(equals(span)),
            Token::Symbol(symbol) => {
                let message = format!("expected a number, a name or `(` before `{symbol}`");
                Err(ParseError::new(span, message))
            }
            Token::End => Err(ParseError::new(span, "the formula ends too early")
                .hinted("expected a number, a name or `(`")),
        }
    }

    /// Closes the parenthesis `open`; returns its last byte.
    fn close(&mut self, open: &Range<usize>) -> Result<usize, ParseError> {
        if let Some(span) = self.take(")") {
            return Ok(span.end);
        }
        match self.peek() {
            (Token::End, _) => Err(ParseError::new(
                open.clone(),
                "this parenthesis is never closed: a `)` is missing",
            )),
            (Token::Symbol("="), span) => Err(equals(span)),
            (_, span) => Err(ParseError::new(span, "expected an operator or `)` here")
                .hinted("products are written with `*`")),
        }
    }

    fn name(&mut self, name: &str, span: &Range<usize>) -> Result<Node, ParseError> {
        if let Some(variable) = Variable::named(name) {
            return self.variable(variable, span);
        }
        if name == "pi" {
            return Ok(self.graph.constant(std::f64::consts::PI));
        }
        if is_function(name) {
            let message = format!("the function `{name}` needs arguments");
            return Err(
                ParseError::new(span.clone(), message).hinted(format!("write `{name}(...)`"))
            );
        }
        let Some(node) = self.scope.get(name) else {
            let message = format!("unknown name `{name}`");
            let hint = suggestion(name, &self.scope.allowed_names());
            return Err(ParseError::new(span.clone(), message).hinted(hint));
        };
        Ok(node)
    }

    fn variable(&mut self, variable: Variable, span: &Range<usize>) -> Result<Node, ParseError> {
        if self.scope.allows(variable) {
            return Ok(self.graph.variable(variable));
        }
        let message = format!("the variable `{}` is not allowed here", variable.name());
        let hint = format!("allowed: {}", self.scope.allowed_names().join(", "));
        Err(ParseError::new(span.clone(), message).hinted(hint))
    }

    fn call(
        &mut self,
        name: &str,
        span: Range<usize>,
        open: &Range<usize>,
    ) -> Result<Parsed, ParseError> {
        if !is_function(name) {
            return Err(self.not_a_function(name, span));
        }
        let arguments = self.arguments(open)?;
        let end = self.close(open)?;
        let whole = span.start..end;
        let node = match name {
            "max" | "min" => {
                self.count(name, &arguments, 2..=usize::MAX, &whole)?;
                self.extremum(name, arguments)?
            }
            "if" => self.branch(self.exactly(name, arguments, &whole)?)?,
            "d" => self.differentiate(self.exactly(name, arguments, &whole)?)?,
            "relax" => self.relaxation(self.exactly(name, arguments, &whole)?, &span)?,
            _ => {
                let [argument] = self.exactly(name, arguments, &whole)?;
                let argument = number(argument)?;
                match Function::named(name) {
                    Some(function) => self.graph.apply(function, argument),
                    None => return Err(self.not_a_function(name, span)),
                }
            }
        };
        Ok((Meaning::Number(node), whole))
    }

    fn arguments(&mut self, open: &Range<usize>) -> Result<Vec<Parsed>, ParseError> {
        let mut list = Vec::new();
        if let (Token::Symbol(")"), _) = self.peek() {
            return Ok(list);
        }
        loop {
            list.push(self.nested(open, |p| p.expression(0))?);
            if self.take(",").is_none() {
                return Ok(list);
            }
        }
    }

    fn exactly<const N: usize>(
        &self,
        name: &str,
        arguments: Vec<Parsed>,
        whole: &Range<usize>,
    ) -> Result<[Parsed; N], ParseError> {
        self.count(name, &arguments, N..=N, whole)?;
        arguments
            .try_into()
            .map_err(|_| ParseError::new(whole.clone(), "wrong number of arguments"))
    }

    fn count(
        &self,
        name: &str,
        arguments: &[Parsed],
        allowed: std::ops::RangeInclusive<usize>,
        whole: &Range<usize>,
    ) -> Result<(), ParseError> {
        if allowed.contains(&arguments.len()) {
            return Ok(());
        }
        let usage = match name {
            "if" => "if(condition, a, b)".to_owned(),
            "d" => "d(f, x)".to_owned(),
            "relax" => "relax(c, f)".to_owned(),
            "max" | "min" => format!("{name}(a, b, ...)"),
            _ => format!("{name}(a)"),
        };
        let least = if allowed.start() == allowed.end() { "" } else { "at least " };
        let message = format!(
            "`{name}` takes {least}{} argument(s), not {}",
            allowed.start(),
            arguments.len()
        );
        Err(ParseError::new(whole.clone(), message).hinted(format!("write `{usage}`")))
    }

    fn extremum(&mut self, name: &str, arguments: Vec<Parsed>) -> Result<Node, ParseError> {
        let mut numbers = Vec::with_capacity(arguments.len());
        for argument in arguments {
            numbers.push(number(argument)?);
        }
        let mut list = numbers.into_iter();
        let mut value = list.next().unwrap_or_else(|| self.graph.constant(f64::NAN));
        for other in list {
            value = match name {
                "max" => self.graph.max(value, other),
                _ => self.graph.min(value, other),
            };
        }
        Ok(value)
    }

    fn branch(&mut self, [c, a, b]: [Parsed; 3]) -> Result<Node, ParseError> {
        let (c, a, b) = (condition(c)?, number(a)?, number(b)?);
        Ok(self.graph.select(&c, a, b))
    }

    fn differentiate(&mut self, [f, v]: [Parsed; 2]) -> Result<Node, ParseError> {
        let f = number(f)?;
        let span = v.1.clone();
        let node = number(v)?;
        let variables = [Variable::X, Variable::Y, Variable::Z, Variable::T];
        match variables.into_iter().find(|v| self.graph.variable(*v) == node) {
            Some(variable) => Ok(self.graph.derivative(f, variable)),
            None => Err(ParseError::new(span, "`d` differentiates with respect to a variable")
                .hinted("one of x, y, z, t")),
        }
    }

    fn relaxation(&mut self, [c, f]: [Parsed; 2], span: &Range<usize>) -> Result<Node, ParseError> {
        if !self.scope.allows(Variable::T) {
            return Err(ParseError::new(
                span.clone(),
                "`relax` integrates over time, which is not allowed here",
            ));
        }
        let bytes = c.1.clone();
        let rate = number(c)?;
        match self.graph.value_of_constant(rate) {
            Some(rate) if rate.is_finite() => {
                let f = number(f)?;
                Ok(self.graph.relax(rate, f))
            }
            _ => Err(ParseError::new(bytes, "the rate of `relax` must be a finite constant")
                .hinted("relax(c, f) is the integral of exp(-c (t-s)) f(s) over 0 < s < t")),
        }
    }

    fn not_a_function(&self, name: &str, span: Range<usize>) -> ParseError {
        let defined = self.scope.get(name).is_some();
        if defined || name == "pi" || Variable::named(name).is_some() {
            return ParseError::new(span, format!("`{name}` is not a function"))
                .hinted(format!("a product is written `{name}*(...)`"));
        }
        let hint = suggestion(name, &function_names());
        ParseError::new(span, format!("unknown function `{name}`")).hinted(hint)
    }
}
