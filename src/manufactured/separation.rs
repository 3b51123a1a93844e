//! Exact fields as sums of products of time and space.

use std::sync::{Arc, Mutex, PoisonError};

use super::Products;
use super::truth::ByTime;
use crate::formula::{Bound, Graph, Node, Program, Variable};

/// Longer sums are evaluated time by time: a part costs as much as a time.
const MOST_PARTS: usize = 8;

/// Formulas as Σ_m a_m(t) S_m(x): the a_m.
pub struct TimeFactors {
    /// How many parts.
    pub parts: usize,
    bound: Mutex<Bound>,
    known: ByTime<Vec<f64>>,
}

impl TimeFactors {
    /// Separates the formulas; with the a_m the S_m of all formulas, of one part after another. None if a formula does not
    /// show a short sum.
    pub fn of(
        graph: &mut Graph,
        formulas: &[Node],
        horizon: f64,
    ) -> Option<(Self, Vec<Vec<Node>>)> {
        let together = graph.separate_together(Variable::T, formulas)?;
        let parts = together.factors.len();
        if parts > MOST_PARTS {
            return None;
        }
        let zero = graph.constant(0.0);
        let shape = |m: usize, terms: &[(usize, Node)]| {
            terms.iter().find(|(own, _)| *own == m).map_or(zero, |(_, shape)| *shape)
        };
        let of_part = |m: usize| together.shapes.iter().map(|terms| shape(m, terms)).collect();
        let shapes = (0..parts).map(of_part).collect();
        let bound = Program::compile(graph, &together.factors, horizon).bind(&[[0.0; 3]]);
        Some((Self { parts, bound: Mutex::new(bound), known: ByTime::default() }, shapes))
    }

    /// The a_m(t).
    pub fn at(&self, t: f64) -> Arc<Vec<f64>> {
        self.known.always(t, || {
            let mut out = vec![Vec::new(); self.parts];
            self.bound.lock().unwrap_or_else(PoisonError::into_inner).evaluate(t, 0.0, &mut out);
            out.into_iter().flatten().collect()
        })
    }
}

/// [u, ε, H_1, H_2, …] and f0 as Σ_m a_m(t) S_m(x).
pub struct Separation {
    /// The a_m.
    pub factors: TimeFactors,
    /// The S_m of [u, ε, H_1, …], one part after another.
    pub interior: Program,
    /// The S_m of f0.
    pub forces: Program,
    /// The S_m of [u, ε, H_1, …] as products of x and y, where they are.
    pub products: Option<Products>,
    /// Which parts have neither u nor ε: they occur in the memory alone.
    pub remembered_alone: Vec<bool>,
}

impl Separation {
    /// Separates [u, ε], [H_1, …] and f0; none if one of them does not show a short sum.
    pub fn of(
        graph: &Graph,
        [present, memory, forces]: [&[Node]; 3],
        horizon: f64,
    ) -> Option<Self> {
        let mut graph = graph.clone();
        let all = [present, memory, forces].concat();
        let (factors, shapes) = TimeFactors::of(&mut graph, &all, horizon)?;
        let inner = present.len() + memory.len();
        let inside: Vec<Node> = shapes.iter().flat_map(|part| &part[..inner]).copied().collect();
        let outside: Vec<Node> = shapes.iter().flat_map(|part| &part[inner..]).copied().collect();
        let is_zero = |shape: &Node| graph.value_of_constant(*shape) == Some(0.0);
        let remembered_alone =
            shapes.iter().map(|part| part[..present.len()].iter().all(is_zero)).collect();
        let products = Products::of(&graph, &inside, horizon);
        let [interior, forces] =
            [inside, outside].map(|all| Program::compile_once(&mut graph, &all, horizon));
        Some(Self { factors, interior, forces, products, remembered_alone })
    }
}
