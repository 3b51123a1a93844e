//! Exact fields as sums of products of time and space.

use std::sync::{Arc, Mutex, PoisonError};

use super::Products;
use super::truth::ByTime;
use crate::formula::{Bound, Graph, Node, Program, Variable};

/// Longer sums are evaluated time by time: a part costs as much as a time.
const MOST_PARTS: usize = 8;

/// [u, ε, H_1, H_2, …] and f0 as Σ_m a_m(t) S_m(x).
pub struct Separation {
    /// How many parts.
    pub parts: usize,
    /// The S_m of [u, ε, H_1, …], one part after another.
    pub interior: Program,
    /// The S_m of f0.
    pub forces: Program,
    /// The S_m of [u, ε, H_1, …] as products of x and y, where they are.
    pub products: Option<Products>,
    factors: Mutex<Bound>,
    known: ByTime<Vec<f64>>,
}

impl Separation {
    /// Separates the formulas; none if one of them does not show a short sum.
    pub fn of(graph: &Graph, interior: &[Node], forces: &[Node], horizon: f64) -> Option<Self> {
        let mut graph = graph.clone();
        let together = graph.separate_together(Variable::T, &[interior, forces].concat())?;
        let parts = together.factors.len();
        if parts > MOST_PARTS {
            return None;
        }
        let zero = graph.constant(0.0);
        let shapes = |formulas: &[Vec<(usize, Node)>]| -> Vec<Node> {
            let shape = |m: usize, terms: &[(usize, Node)]| {
                terms.iter().find(|(own, _)| *own == m).map_or(zero, |(_, shape)| *shape)
            };
            (0..parts).flat_map(|m| formulas.iter().map(move |terms| shape(m, terms))).collect()
        };
        let (inside, outside) = together.shapes.split_at(interior.len());
        let (inside, outside) = (shapes(inside), shapes(outside));
        let products = Products::of(&graph, &inside, horizon);
        let [interior, forces] =
            [inside, outside].map(|all| Program::compile(&mut graph, &all, horizon));
        let factors = Program::compile(&mut graph, &together.factors, horizon).bind(&[[0.0; 3]]);
        Some(Self {
            parts,
            interior,
            forces,
            products,
            factors: Mutex::new(factors),
            known: ByTime::default(),
        })
    }

    /// The a_m(t).
    pub fn factors_at(&self, t: f64) -> Arc<Vec<f64>> {
        self.known.always(t, || {
            let mut out = vec![Vec::new(); self.parts];
            self.factors.lock().unwrap_or_else(PoisonError::into_inner).evaluate(t, 0.0, &mut out);
            out.into_iter().flatten().collect()
        })
    }
}
