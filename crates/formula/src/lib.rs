//! Formulas: parsed into a graph, differentiated exactly, compiled to tapes and evaluated at many points for a sequence
//! of times.
//!
//! A [`Graph`] holds expressions in x, y, z, t and zeta; equal subexpressions are one node. A [`Program`] is a set of
//! nodes prepared for evaluation, a [`BoundProgram`] a program with its points.

mod block;
mod build;
mod decompose;
mod derivative;
mod enclosure;
mod error;
mod expsum;
mod extreme;
mod graph;
mod guards;
mod hereditary;
mod history;
mod lexer;
mod meaning;
mod nearest;
mod operand;
mod parser;
mod past;
mod program;
mod quadrature;
mod scope;
mod substitute;
mod tape;
mod vocabulary;

pub use enclosure::{Enclosing, Enclosure, Interval, Place};
pub use error::ParseError;
pub use extreme::{Effort, Extreme, Jump, largest};
pub use graph::{Graph, Node, Variable};
pub use program::{BoundProgram, EvaluationPoint, Program};
pub use scope::Scope;
pub use vocabulary::Function;

#[cfg(test)]
mod tests;
