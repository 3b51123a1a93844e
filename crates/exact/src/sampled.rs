//! Formulas bound to the points of a quadrature rule on many simplices.

use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use super::symbolic::components;
use fem::contact::LoadError;
use fem::mesh::Mesh;
use fem::space::quadrature::Rule;
use formula::{BoundProgram, Program};
use rustc_hash::FxHashMap;

/// Limit of points whose formulas stay bound between times, some 100 bytes per point. Beyond (24 cells per unit length
/// in space, 250 in the plane) they are bound anew at each time, block by block.
const KEPT: usize = 1 << 21;
/// Points per block.
const BLOCK: usize = 1 << 14;
/// Coordinates that differ by so many units in the last place of the largest are equal.
const ROUNDING: f64 = 4.0 * f64::EPSILON;
/// Limit of points evaluated together, so that fields and registers stay in cache.
const LANES: usize = 128;
/// Simplices that fill vectors.
const WIDTH: usize = 4;

/// The points of a rule on a list of simplices, with formulas bound to them.
pub(super) struct Sampled {
    pub(super) rule: Rule,
    /// Vertices of the simplices, and number of vertices per simplex.
    vertices: Vec<u32>,
    corners: usize,
    bound: Mutex<Option<BoundProgram>>,
    kept: usize,
    block: usize,
}

impl Sampled {
    pub(super) fn new<'a>(simplices: impl Iterator<Item = &'a [u32]>, rule: &Rule) -> Self {
        let corners = rule.points[0].len();
        let vertices = simplices.flatten().copied().collect();
        let (bound, rule) = (Mutex::new(None), rule.clone());
        Self { rule, vertices, corners, bound, kept: KEPT, block: BLOCK }
    }

    fn simplices(&self) -> usize {
        self.vertices.len() / self.corners
    }

    /// Simplices evaluated together: few enough for cache, and enough to fill vectors.
    fn together(&self) -> usize {
        let most = (LANES / self.rule.points.len()).max(1);
        most - if most > WIDTH { most % WIDTH } else { 0 }
    }

    /// The points of some simplices, in groups of [`Self::together`]: within a group, one point of the rule after the
    /// other, each on all its simplices.
    fn points(&self, mesh: &Mesh, simplices: Range<usize>) -> Vec<[f64; 3]> {
        let vertices = &self.vertices[self.corners * simplices.start..self.corners * simplices.end];
        let mut points = Vec::with_capacity(simplices.len() * self.rule.points.len());
        for group in vertices.chunks(self.corners * self.together()) {
            for b in &self.rule.points {
                points.extend(group.chunks(self.corners).map(|simplex| mesh.point(simplex, b)));
            }
        }
        (0..mesh.dimension).for_each(|axis| put_together(&mut points, axis));
        points
    }

    /// Passes the values of all outputs at time t to `visit`, one run of simplices after the other: their numbers, and
    /// the values at their points, with point q on simplex i of a run of m at q m + i. The values of the first fields,
    /// with these `names`, must be finite. The program must always be the same one.
    pub(super) fn each_block(
        &self,
        mesh: &Mesh,
        program: &Program,
        (t, zeta): (f64, f64),
        names: &[String],
        mut visit: impl FnMut(Range<usize>, &[&[f64]]),
    ) -> Result<(), LoadError> {
        let (count, total) = (self.rule.points.len(), self.simplices());
        let mut shown = |bound: &mut BoundProgram, first: usize| {
            bound.evaluate_in_blocks(t, zeta, count * self.together(), |points, values| {
                let run = first + points.start / count..first + points.end / count;
                finite(values, names, t, |p| {
                    let at = run.start + p % run.len();
                    let simplex = &self.vertices[self.corners * at..self.corners * (at + 1)];
                    let place = mesh.point(simplex, &self.rule.points[p / run.len()]);
                    place[..mesh.dimension].to_vec()
                })?;
                visit(run.clone(), values);
                Ok(())
            })
        };
        if count * total <= self.kept {
            let mut bound = self.bound.lock().unwrap_or_else(PoisonError::into_inner);
            let bound = bound.get_or_insert_with(|| program.bind(&self.points(mesh, 0..total)));
            return shown(bound, 0);
        }
        let length = (self.block / count).max(1);
        for start in (0..total).step_by(length) {
            let simplices = start..(start + length).min(total);
            shown(&mut program.bind(&self.points(mesh, simplices)), start)?;
        }
        Ok(())
    }

    /// The values of `outputs` outputs for few simplices: point q on simplex i is at m i + q if the rule has m points.
    pub(super) fn evaluate(
        &self,
        mesh: &Mesh,
        (program, outputs): (&Program, usize),
        t: f64,
        names: &[String],
    ) -> Result<Vec<Vec<f64>>, LoadError> {
        let count = self.rule.points.len();
        let mut all = vec![Vec::with_capacity(count * self.simplices()); outputs];
        self.each_block(mesh, program, (t, 0.0), names, |run, values| {
            for (all, run_values) in all.iter_mut().zip(values) {
                let of = |i: usize| run_values[i..].iter().step_by(run.len());
                (0..run.len()).for_each(|i| all.extend(of(i)));
            }
        })?;
        Ok(all)
    }
}

/// Makes coordinates equal that differ by rounding, as in the columns of a mesh: what depends on them alone is then
/// evaluated once.
fn put_together(points: &mut [[f64; 3]], axis: usize) {
    // Only the few bitwise distinct coordinates are sorted.
    let mut shared: FxHashMap<u64, f64> = FxHashMap::default();
    shared.extend(points.iter().map(|point| (point[axis].to_bits(), point[axis])));
    let mut known: Vec<f64> = shared.values().copied().collect();
    known.sort_unstable_by(f64::total_cmp);
    let largest = known.first().zip(known.last()).map_or(0.0, |(a, b)| a.abs().max(b.abs()));
    let apart = ROUNDING * largest;
    known.dedup_by(|next, kept| *next - *kept <= apart);
    for value in shared.values_mut() {
        *value = known[known.partition_point(|coordinate| coordinate <= value).saturating_sub(1)];
    }
    for point in points {
        point[axis] = shared[&point[axis].to_bits()];
    }
}

/// Refuses values that are not finite, naming the place.
fn finite(
    values: &[&[f64]],
    names: &[String],
    t: f64,
    place: impl Fn(usize) -> Vec<f64>,
) -> Result<(), LoadError> {
    for (field, name) in values.iter().zip(names) {
        // Branch-free.
        if field.iter().fold(true, |all, value| all & value.is_finite()) {
            continue;
        }
        if let Some(p) = field.iter().position(|value| !value.is_finite()) {
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
    use fem::mesh::{Family, lattice};
    use fem::space::quadrature::triangle_degree_4;
    use formula::{Graph, Scope, Variable};

    #[test]
    fn blocks_give_the_values_of_the_whole_and_name_the_place() {
        let mesh = lattice([1.0, 1.0], 4, Family::Structured);
        let mut graph = Graph::new();
        let scope = Scope::new(&[Variable::X, Variable::Y, Variable::T]);
        let text = |graph: &mut Graph, text| graph.parse(text, &scope).expect("a formula");
        let nodes = [text(&mut graph, "x*exp(t*y)"), text(&mut graph, "1/max(x - 0.9, 0)")];
        let program = Program::compile(&graph, &nodes, 1.0);
        let sampled = |kept: usize, block: usize| {
            let cells = (0..mesh.cell_count()).map(|c| mesh.cell(c));
            Sampled { kept, block, ..Sampled::new(cells, &triangle_degree_4()) }
        };
        let names = [String::from("f"), String::from("g")];
        let whole = sampled(KEPT, 1).evaluate(&mesh, (&program, 2), 0.7, &names[..1]);
        let whole = whole.expect("a finite first field");
        let rule = triangle_degree_4();
        for (c, values) in whole[0].chunks_exact(rule.points.len()).enumerate() {
            for (b, value) in rule.points.iter().zip(values) {
                let [x, y, _] = mesh.point(mesh.cell(c), b);
                // Coordinates up to one are merged within four units in the last place.
                assert!((value - x * (0.7 * y).exp()).abs() < 3e-15, "cell {c}");
            }
        }
        // The last run of cells is shorter than the others.
        assert!(!mesh.cell_count().is_multiple_of(sampled(KEPT, 1).together()));
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
