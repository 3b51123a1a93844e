//! The meaning of a part of a formula: a number, or a condition of `if`.

use std::ops::Range;

use super::error::ParseError;
use super::graph::{Graph, Node};

#[derive(Clone, Debug)]
pub(super) enum Condition {
    Less(Node, Node),
    Not(Box<Condition>),
    /// Flat, so that long chains are not deep.
    All(Vec<Condition>),
    Any(Vec<Condition>),
}

#[derive(Clone, Debug)]
pub(super) enum Meaning {
    Number(Node),
    Condition(Condition),
}

pub(super) type Parsed = (Meaning, Range<usize>);

impl Graph {
    pub(super) fn select(&mut self, c: &Condition, then: Node, otherwise: Node) -> Node {
        match c {
            Condition::Less(a, b) => self.select_less(*a, *b, then, otherwise),
            Condition::Not(c) => self.select(c, otherwise, then),
            Condition::All(list) => {
                list.iter().rev().fold(then, |inner, c| self.select(c, inner, otherwise))
            }
            Condition::Any(list) => {
                list.iter().rev().fold(otherwise, |inner, c| self.select(c, then, inner))
            }
        }
    }
}

pub(super) fn number((meaning, span): Parsed) -> Result<Node, ParseError> {
    match meaning {
        Meaning::Number(node) => Ok(node),
        Meaning::Condition(_) => Err(ParseError::new(span, "a condition where a number is needed")
            .hinted("conditions belong in `if(condition, a, b)`")),
    }
}

/// The condition; an error for a number.
pub(super) fn condition((meaning, span): Parsed) -> Result<Condition, ParseError> {
    match meaning {
        Meaning::Condition(condition) => Ok(condition),
        Meaning::Number(_) => Err(ParseError::new(span, "a number where a condition is needed")
            .hinted("write a comparison, such as `x < 0.5`")),
    }
}
