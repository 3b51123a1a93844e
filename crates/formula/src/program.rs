//! Expressions prepared for evaluation, and bound to points.
//!
//! All outputs are one tape over blocks of points. Hereditary integrals are computed before, at the distinct values of
//! the coordinates that they depend on: a structured set of n² points has n distinct x.

use std::convert::Infallible;
use std::ops::Range;
use std::sync::Arc;

use rustc_hash::FxHashMap;

use super::block::{BLOCK, Registers};
use super::graph::{Graph, Node, Op};
use super::history::{Group, Plan};
use super::past::{Around, Past};
use super::tape::{Integrals, Source, Tape};
use super::vocabulary::power;

/// Expressions prepared for evaluation; bind to points to evaluate.
#[derive(Clone, Debug)]
pub struct Program {
    plan: Arc<Plan>,
}

impl Program {
    /// Prepares the outputs for times from 0 to about `horizon`. Later times are allowed; the panels of hereditary
    /// integrals are horizon/4 wide, narrower for fast relaxation and where an integrand has kinks.
    pub fn compile(graph: &Graph, outputs: &[Node], horizon: f64) -> Self {
        let mut integrals = Integrals::default();
        let groups = Group::all(graph, outputs, horizon, &mut integrals);
        let outputs = Tape::compile(graph, outputs, &integrals, true);
        Self { plan: Arc::new(Plan { outputs, groups, adds_remainders: graph.adds_remainders }) }
    }

    /// Approximate bytes for `points` of a structured set in dimension `d`, evaluated up to time `t`; the number of
    /// distinct places is taken as a power of that of the points.
    pub fn bytes(&self, points: f64, d: usize, t: f64) -> f64 {
        let of_group = |group: &Group| {
            let places = points.powf((f64::from(group.mask.count_ones()) / d as f64).min(1.0));
            let panels = if group.general { 0 } else { group.panel(t) };
            4.0 * points + (24 + 8 * group.members.len() * (panels + 2)) as f64 * places
        };
        24.0 * points + self.plan.groups.iter().map(of_group).sum::<f64>()
    }

    /// Binds the program to points.
    pub fn bind(&self, points: &[[f64; 3]]) -> BoundProgram {
        let groups = &self.plan.groups;
        let places: Vec<Places> = groups.iter().map(|g| Places::new(points, g.mask)).collect();
        let past = |(group, places_of_group): (&Group, &Places)| {
            let of = |inner: usize| {
                places_of_group.first.iter().map(|&p| places[inner].of_point[p as usize]).collect()
            };
            let inner = group.nested().into_iter().map(|inner| (inner, of(inner))).collect();
            let points = places_of_group.first.iter().map(|&p| points[p as usize]).collect();
            Past::new(group, points, inner)
        };
        BoundProgram {
            pasts: groups.iter().zip(&places).map(past).collect(),
            places: places.into_iter().map(|places| places.of_point).collect(),
            coordinates: [0, 1, 2].map(|axis| points.iter().map(|point| point[axis]).collect()),
            now: vec![Vec::new(); groups.len()],
            plan: Arc::clone(&self.plan),
            registers: Registers::default(),
            evaluated_at: None,
            zeta: 0,
        }
    }

    /// All outputs at these points at t alone.
    pub fn values(&self, points: &[[f64; 3]], t: f64, zeta: f64) -> Vec<Vec<f64>> {
        self.bind(points).values_at(t, zeta)
    }
}

/// A program bound to points, with the past of its hereditary integrals.
///
/// Values at (t, zeta) are independent of earlier evaluations and of the other points, to the last bit.
#[derive(Clone, Debug)]
pub struct BoundProgram {
    plan: Arc<Plan>,
    coordinates: [Vec<f64>; 3],
    /// For each group the place of each point.
    places: Vec<Vec<u32>>,
    pasts: Vec<Past>,
    /// The integrals of each group at its places, as far as outputs read them, and their time and zeta.
    now: Vec<Vec<f64>>,
    evaluated_at: Option<[u64; 2]>,
    /// The zeta for which pasts are valid.
    zeta: u64,
    registers: Registers,
}

impl BoundProgram {
    pub fn points(&self) -> usize {
        self.coordinates[0].len()
    }

    /// Evaluates all outputs: `out[i][p]` becomes output i at point p. Vectors are resized to the number of points;
    /// entries of `out` beyond the outputs are left alone.
    pub fn evaluate(&mut self, t: f64, zeta: f64, out: &mut [Vec<f64>]) {
        out.iter_mut().take(self.plan.outputs.results.len()).for_each(Vec::clear);
        let Ok(()) = self.evaluate_in_blocks(t, zeta, BLOCK, |_, values| {
            out.iter_mut().zip(values).for_each(|(out, values)| out.extend_from_slice(values));
            Ok::<(), Infallible>(())
        });
    }

    /// All outputs at t, as [`Self::evaluate`] has them.
    pub fn values_at(&mut self, t: f64, zeta: f64) -> Vec<Vec<f64>> {
        let mut out = vec![Vec::new(); self.plan.outputs.results.len()];
        self.evaluate(t, zeta, &mut out);
        out
    }

    /// Evaluates all outputs block by block, a few hundred points that stay in cache. `visit` gets the range of points
    /// and the values of each output there.
    ///
    /// # Errors
    /// The error of `visit`, which is not called again.
    pub fn evaluate_in_blocks<E>(
        &mut self,
        t: f64,
        zeta: f64,
        length: usize,
        mut visit: impl FnMut(Range<usize>, &[&[f64]]) -> Result<(), E>,
    ) -> Result<(), E> {
        self.recall(t, zeta);
        let total = self.points();
        let Self { plan, coordinates, places, now, registers, .. } = self;
        let tape = &plan.outputs;
        for start in (0..total).step_by(length.max(1)) {
            let lanes = start..total.min(start + length.max(1));
            registers.run(tape, lanes.len(), |source, out| {
                // What is equal at all points is asked for once.
                let lanes = start..start + out.len();
                match source {
                    Source::Time => out.fill(t),
                    Source::Zeta => out.fill(zeta),
                    Source::Axis(axis) => out.copy_from_slice(&coordinates[axis][lanes]),
                    Source::Integral(group, member) => {
                        let stride = plan.groups[group].members.len();
                        let places = &places[group][lanes];
                        let values = out.iter_mut().zip(places);
                        values
                            .for_each(|(out, &p)| *out = now[group][stride * p as usize + member]);
                    }
                }
            });
            let result = |&result: &usize| registers.lanes(result, lanes.len());
            let values: Vec<&[f64]> = tape.results.iter().map(result).collect();
            visit(lanes, &values)?;
        }
        Ok(())
    }

    /// The integrals that outputs read.
    fn recall(&mut self, t: f64, zeta: f64) {
        let at = Some([t.to_bits(), zeta.to_bits()]);
        if self.evaluated_at == at || self.points() == 0 {
            return;
        }
        self.evaluated_at = at;
        let Self { plan, pasts, now, .. } = self;
        if self.zeta != zeta.to_bits() {
            self.zeta = zeta.to_bits();
            let changed = pasts.iter_mut().zip(&plan.groups).filter(|(_, group)| group.on_zeta);
            changed.for_each(|(past, _)| past.reset());
        }
        for (group, now) in now.iter_mut().enumerate() {
            if plan.outputs.reads(group) {
                let (below, rest) = pasts.split_at_mut(group);
                let places: Vec<u32> = (0..rest[0].places() as u32).collect();
                let times = vec![t; places.len()];
                *now = rest[0].values(below, Around { plan, group, zeta }, &places, &times);
            }
        }
    }
}

/// Values of all variables.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EvaluationPoint {
    pub x: f64,
    pub y: f64,
    pub z: f64,
    pub t: f64,
    pub zeta: f64,
}

impl From<[f64; 3]> for EvaluationPoint {
    /// A place; t = ζ = 0.
    fn from([x, y, z]: [f64; 3]) -> Self {
        Self { x, y, z, t: 0.0, zeta: 0.0 }
    }
}

impl Graph {
    /// The value of `f` at a point, for few values.
    pub fn evaluate(&self, f: Node, at: &EvaluationPoint) -> f64 {
        let order = self.reachable(&[f], |node| !self.op(node).is_integral());
        let mut values = Vec::with_capacity(order.len());
        for &node in &order {
            let of =
                |n: Node| order.binary_search_by_key(&n.0, |n| n.0).map_or(f64::NAN, |k| values[k]);
            values.push(match self.op(node) {
                Op::Constant(bits) => f64::from_bits(bits),
                Op::Variable(v) => [at.x, at.y, at.z, at.t, at.zeta][v as usize],
                Op::Neg(a) => -of(a),
                Op::Add(a, b) => of(a) + of(b),
                Op::Sub(a, b) => of(a) - of(b),
                Op::Mul(a, b) => of(a) * of(b),
                Op::Div(a, b) => of(a) / of(b),
                Op::Power(a, n) => power(of(a), n),
                Op::Pow(a, b) => of(a).powf(of(b)),
                Op::Apply(function, a) => function.value(of(a)),
                Op::Max(a, b) => of(a).max(of(b)),
                Op::Min(a, b) => of(a).min(of(b)),
                Op::Less([a, b, then, otherwise]) => {
                    of(if of(a) < of(b) { then } else { otherwise })
                }
                Op::Relax(..) | Op::Convolve(..) => {
                    let program = Program::compile(self, &[node], at.t);
                    program.values(&[[at.x, at.y, at.z]], at.t, at.zeta)[0][0]
                }
            });
        }
        values[values.len() - 1]
    }
}

/// The distinct values of some coordinates of points, in order of appearance, by bit pattern.
struct Places {
    of_point: Vec<u32>,
    /// The first point of each place.
    first: Vec<u32>,
}

impl Places {
    /// Those of the coordinates in `mask`: bit 0 for x, 1 for y, 2 for z.
    fn new(points: &[[f64; 3]], mask: u8) -> Self {
        let differs =
            |axis: usize| points.iter().any(|p| p[axis].to_bits() != points[0][axis].to_bits());
        let varying: Vec<usize> = (0..3).filter(|&axis| differs(axis)).collect();
        let axes: Vec<usize> =
            varying.iter().copied().filter(|axis| mask >> axis & 1 == 1).collect();
        if axes == varying && !axes.is_empty() {
            // Quadrature points are distinct, and a repeated one may be computed twice.
            let all: Vec<u32> = (0..points.len() as u32).collect();
            return Self { of_point: all.clone(), first: all };
        }
        let mut known: FxHashMap<[u64; 3], u32> = FxHashMap::default();
        let mut places = Self { of_point: Vec::with_capacity(points.len()), first: Vec::new() };
        let mut last = None;
        for (p, point) in points.iter().enumerate() {
            let mut key = [0; 3];
            axes.iter().for_each(|&axis| key[axis] = point[axis].to_bits());
            let number = match last {
                // Points come in rows.
                Some((previous, number)) if previous == key => number,
                _ => *known.entry(key).or_insert(places.first.len() as u32),
            };
            if number as usize == places.first.len() {
                places.first.push(p as u32);
            }
            last = Some((key, number));
            places.of_point.push(number);
        }
        places
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against a search of all points; 12 of 12 combinations occur, or 50 of 31 · 29.
    #[test]
    fn places_are_numbered_in_order_of_appearance() {
        let place = |on_a_grid: bool, k: usize| match on_a_grid {
            true => [k % 4, k / 4 % 3, k],
            false => [k % 50 * 7 % 31, k % 50 * 11 % 29, k],
        };
        for (on_a_grid, distinct) in [(true, 12), (false, 50)] {
            let points: Vec<[f64; 3]> =
                (0..60).map(|k| place(on_a_grid, k).map(|i| i as f64)).collect();
            let places = Places::new(&points, 0b11);
            assert_eq!(places.first.len(), distinct);
            for (p, point) in points.iter().enumerate() {
                let first = points.iter().position(|other| other[..2] == point[..2]);
                assert_eq!(Some(places.first[places.of_point[p] as usize] as usize), first);
            }
            assert!(places.first.is_sorted());
        }
    }
}
