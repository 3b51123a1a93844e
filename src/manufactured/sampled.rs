//! Formulas bound to the points of a quadrature rule on many simplices.

use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use super::symbolic::components;
use crate::contact::LoadError;
use crate::formula::{Bound, Program};
use crate::mesh::Mesh;
use crate::space::quadrature::Rule;

/// Up to so many points keep what formulas have stored for them from one time to the next, some 200 bytes a
/// point. Beyond, which is 24 cells a unit length in space and 250 in the plane, they are bound anew at each time, block
/// by block.
const KEPT: usize = 1 << 21;
/// Points of a block.
const BLOCK: usize = 1 << 14;

/// The points of a rule on a list of simplices, with formulas bound to them.
pub(super) struct Sampled {
    pub(super) rule: Rule,
    /// Vertices of the simplices, and how many each has.
    vertices: Vec<u32>,
    corners: usize,
    bound: Mutex<Option<Bound>>,
    kept: usize,
    block: usize,
}

impl Sampled {
    /// The points of `rule` on each of the simplices.
    pub(super) fn new<'a>(simplices: impl Iterator<Item = &'a [u32]>, rule: &Rule) -> Self {
        let corners = rule.points[0].len();
        let vertices = simplices.flatten().copied().collect();
        let (bound, rule) = (Mutex::new(None), rule.clone());
        Self { rule, vertices, corners, bound, kept: KEPT, block: BLOCK }
    }

    fn simplices(&self) -> usize {
        self.vertices.len() / self.corners
    }

    fn points(&self, mesh: &Mesh, simplices: Range<usize>) -> Vec<[f64; 3]> {
        let own = &self.vertices[self.corners * simplices.start..self.corners * simplices.end];
        let on = |simplex| self.rule.points.iter().map(move |b| mesh.point(simplex, b));
        own.chunks_exact(self.corners).flat_map(on).collect()
    }

    /// Shows the values of all outputs at time t, for one run of simplices after the other: their numbers, and the
    /// values at their points. Those of the first fields must be finite; `names` are theirs. What is to be evaluated
    /// `again` is one program, always the same.
    pub(super) fn each_block(
        &self,
        mesh: &Mesh,
        (program, outputs): (&Program, usize),
        (t, zeta): (f64, f64),
        again: bool,
        names: &[String],
        mut visit: impl FnMut(Range<usize>, &[Vec<f64>]),
    ) -> Result<(), LoadError> {
        let (count, total) = (self.rule.points.len(), self.simplices());
        let mut out = vec![Vec::new(); outputs];
        let mut shown = |simplices: Range<usize>, out: &[Vec<f64>]| {
            finite(out, names, t, |p| {
                let at = simplices.start + p / count;
                let simplex = &self.vertices[self.corners * at..self.corners * (at + 1)];
                mesh.point(simplex, &self.rule.points[p % count])[..mesh.dimension].to_vec()
            })?;
            visit(simplices, out);
            Ok(())
        };
        if again && count * total <= self.kept {
            let mut bound = self.bound.lock().unwrap_or_else(PoisonError::into_inner);
            let bound = bound.get_or_insert_with(|| program.bind(&self.points(mesh, 0..total)));
            bound.evaluate(t, zeta, &mut out);
            return shown(0..total, &out);
        }
        let length = (self.block / count).max(1);
        for start in (0..total).step_by(length) {
            let simplices = start..(start + length).min(total);
            program.bind(&self.points(mesh, simplices.clone())).evaluate(t, zeta, &mut out);
            shown(simplices, &out)?;
        }
        Ok(())
    }

    /// The same in one piece, for few simplices.
    pub(super) fn evaluate(
        &self,
        mesh: &Mesh,
        program: (&Program, usize),
        t: f64,
        names: &[String],
    ) -> Result<Vec<Vec<f64>>, LoadError> {
        let mut all = vec![Vec::new(); program.1];
        self.each_block(mesh, program, (t, 0.0), true, names, |_, values| {
            all.iter_mut().zip(values).for_each(|(all, own)| all.extend_from_slice(own));
        })?;
        Ok(all)
    }
}

/// Refuses values that are not finite, naming the place.
fn finite(
    values: &[Vec<f64>],
    names: &[String],
    t: f64,
    place: impl Fn(usize) -> Vec<f64>,
) -> Result<(), LoadError> {
    for (field, name) in values.iter().zip(names) {
        if let Some(p) = field.iter().position(|v| !v.is_finite()) {
            let (what, value) = (name.clone(), field[p]);
            return Err(LoadError::NotFinite { what, value, place: place(p), t });
        }
    }
    Ok(())
}

const AXIS_NAMES: [&str; 3] = ["x", "y", "z"];

/// u_x, u_y, …, in dimension d.
pub(super) fn vector_names(symbol: &str, d: usize) -> Vec<String> {
    AXIS_NAMES[..d].iter().map(|axis| format!("{symbol}_{axis}")).collect()
}

/// ε_xx, ε_xy, …, in dimension d.
pub(super) fn tensor_names(symbol: &str, d: usize) -> Vec<String> {
    let name = |(i, j): (usize, usize)| format!("{symbol}_{}{}", AXIS_NAMES[i], AXIS_NAMES[j]);
    components(d).into_iter().map(name).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formula::{Graph, Scope, Variable};
    use crate::mesh::{Family, rectangle};
    use crate::space::quadrature::triangle_degree_4;

    #[test]
    fn blocks_give_the_values_of_the_whole_and_name_the_place() {
        let mesh = rectangle([1.0, 1.0], 4, Family::Structured);
        let mut graph = Graph::new();
        let scope = Scope::new(&[Variable::X, Variable::Y, Variable::T]);
        let text = |graph: &mut Graph, text| graph.parse(text, &scope).expect("a formula");
        let nodes = [text(&mut graph, "x*exp(t*y)"), text(&mut graph, "1/max(x - 0.9, 0)")];
        let program = Program::compile(&mut graph, &nodes, 1.0);
        let sampled = |kept: usize, block: usize| {
            let cells = (0..mesh.cell_count()).map(|c| mesh.cell(c));
            Sampled { kept, block, ..Sampled::new(cells, &triangle_degree_4()) }
        };
        let names = [String::from("f"), String::from("g")];
        let whole = sampled(KEPT, 1).evaluate(&mesh, (&program, 2), 0.7, &names[..1]);
        let whole = whole.expect("a finite first field");
        // 192 points: in blocks of 5 simplices, of one simplex.
        for block in [30, 1] {
            let pieces = sampled(0, block).evaluate(&mesh, (&program, 2), 0.7, &names[..1]);
            assert_eq!(pieces.expect("the same values"), whole);
            let refused = sampled(0, block).evaluate(&mesh, (&program, 2), 0.7, &names);
            let message = refused.expect_err("1/0").to_string();
            assert!(message.starts_with("g is inf at (0."), "{message}");
        }
    }
}
