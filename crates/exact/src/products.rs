//! Fields in the plane as sums of products of (x, t) and y.

use formula::{Graph, Node, Program, Variable};

/// Longer sums cost more by rows than point by point.
const MOST_FACTORS: usize = 16;

/// Formulas as Σ_m f_m(x, t) g_m(y).
pub struct Products {
    /// How many g_m there are.
    pub factors: usize,
    /// The g_m.
    pub along_y: Program,
    /// The f_m of all formulas.
    pub along_x: Program,
    /// The number of shape functions.
    pub shapes: usize,
    /// Of each formula its terms: m, and the place of f_m.
    pub terms: Vec<Vec<(usize, usize)>>,
}

impl Products {
    /// Separates the formulas; none if one of them does not show a short sum.
    pub(crate) fn of(graph: &Graph, formulas: &[Node], horizon: f64) -> Option<Self> {
        let mut graph = graph.clone();
        if formulas.iter().any(|&f| graph.depends_on(f, Variable::Z)) {
            return None;
        }
        let together = graph.separate_together(Variable::Y, formulas)?;
        if together.factors.len() > MOST_FACTORS {
            return None;
        }
        let mut shapes: Vec<Node> = Vec::new();
        let mut place = |shape: Node| {
            shapes.iter().position(|own| *own == shape).unwrap_or_else(|| {
                shapes.push(shape);
                shapes.len() - 1
            })
        };
        let of = |terms: &Vec<(usize, Node)>| terms.iter().map(|&(m, f)| (m, place(f))).collect();
        let terms = together.shapes.iter().map(of).collect();
        let along_y = Program::compile(&mut graph, &together.factors, horizon);
        let along_x = Program::compile(&mut graph, &shapes, horizon);
        let (factors, shapes) = (together.factors.len(), shapes.len());
        Some(Self { factors, along_y, along_x, shapes, terms })
    }
}
