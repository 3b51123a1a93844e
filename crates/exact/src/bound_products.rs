//! Products of (x, t) and y at the points of a rule, and the fields that they are.

use std::sync::{Mutex, PoisonError};

use super::constitutive::{Tensor, mandel, stress};
use super::lanes::{Lanes, WIDTH};
use super::parts::Parts;
use super::products::Products;
use super::row_places::{Places, SAME_ABSCISSA, at_points};
use super::rows::{HALVES, Rows};
use fem::space::quadrature::Rule;
use formula::{Bound, Program};

/// Numbers of a tensor in the plane.
pub(super) const TENSOR: usize = 3;

/// Values of a function of one variable in all columns (or rows) of each half, at one place (or point of the rule) after
/// the other.
pub(super) type Values = [Vec<f64>; HALVES];

/// f(x) g_m(y) with m.
pub(super) struct Term {
    pub m: usize,
    pub f: Values,
}

/// A number of a field: the sum of its terms.
pub(super) type Field = Vec<Term>;

/// The fields of a part: ε, σ (Mandel) and u.
pub(super) struct Fields {
    pub strain: [Field; TENSOR],
    pub stress: [Field; TENSOR],
    pub displacement: [Field; 2],
}

/// The f_m of products at the points of a rule of each half in all columns, points of one abscissa once.
pub(super) struct AlongX {
    /// Of each half the abscissae.
    pub places: [Places; HALVES],
    /// The shape functions at the distinct abscissae.
    shapes: Mutex<Bound>,
    /// The place of each among these.
    place: [Vec<u32>; HALVES],
}

impl AlongX {
    /// Binds them to the points of the rules in the columns of `rows`.
    pub(crate) fn new(products: &Products, rows: &Rows, rules: &[Rule; HALVES]) -> Self {
        let places = [0, 1].map(|half| Places::new(&rows.x[half], &rules[half]));
        let x = places.each_ref().map(|places| places.x.clone());
        let (shapes, place) = bound(&products.along_x, &x, |x| [x, 0.0, 0.0]);
        Self { places, shapes: Mutex::new(shapes), place }
    }
}

/// The g_m of products at the points of a rule of each half in all rows.
pub(super) fn along_y(products: &Products, rows: &Rows, rules: &[Rule; HALVES]) -> Vec<Values> {
    let y = [0, 1].map(|half| at_points(&rows.y[half], &rules[half]));
    let (mut along_y, place) = bound(&products.along_y, &y, |y| [0.0, y, 0.0]);
    let mut values = vec![Vec::new(); products.factors];
    along_y.evaluate(0.0, 0.0, &mut values);
    values.iter().map(|values| spread(values, &place)).collect()
}

impl AlongX {
    /// The fields of all parts along x, σ by the law of a region; none if a number is not finite.
    pub(crate) fn fields(
        &self,
        parts: &Parts<'_>,
        region: usize,
        products: &Products,
    ) -> Option<Vec<Fields>> {
        let mut shapes = vec![Vec::new(); products.shapes];
        let lock = || self.shapes.lock().unwrap_or_else(PoisonError::into_inner);
        lock().evaluate(parts.t, 0.0, &mut shapes);
        if !shapes.iter().flatten().all(|v| v.is_finite()) {
            return None;
        }
        let of_part = |terms: &[Vec<(usize, usize)>]| {
            let mut own = Fields {
                strain: Default::default(),
                stress: Default::default(),
                displacement: Default::default(),
            };
            for m in 0..products.factors {
                self.add_factor((parts, region), m, terms, &shapes, &mut own);
            }
            own
        };
        Some(products.terms.chunks(parts.fields()).map(of_part).collect())
    }

    /// Adds the terms with g_m; `terms` are those of all fields of the part.
    fn add_factor(
        &self,
        (parts, region): (&Parts<'_>, usize),
        m: usize,
        terms: &[Vec<(usize, usize)>],
        shapes: &[Vec<f64>],
        own: &mut Fields,
    ) {
        let place = |terms: &Vec<(usize, usize)>| {
            terms.iter().find(|(factor, _)| *factor == m).map(|(_, place)| *place)
        };
        let places: Vec<Option<usize>> = terms.iter().map(place).collect();
        if places.iter().all(Option::is_none) {
            return;
        }
        let abscissae = shapes[0].len();
        let mut numbers = vec![Vec::new(); 2 * TENSOR];
        let mut memory: Vec<Tensor<2, Lanes>> = Vec::new();
        for first in (0..abscissae).step_by(WIDTH) {
            let end = abscissae.min(first + WIDTH);
            let field = |k: usize| match places[k] {
                Some(place) => Lanes::load(&shapes[place][first..end]),
                None => Lanes::from(0.0),
            };
            let strain = parts.exact.tensors(field, &mut memory);
            let sigma = stress(parts.exact.material_in(region), &strain, &memory, f64::INFINITY);
            let both: [[Lanes; TENSOR]; 2] = [mandel(&strain), mandel(&sigma)];
            for (all, lanes) in numbers.iter_mut().zip(both.as_flattened()) {
                all.extend_from_slice(&lanes.0[..end - first]);
            }
        }
        let add = |field: &mut Field, values: &[f64]| {
            if values.iter().any(|value| *value != 0.0) {
                field.push(Term { m, f: spread(values, &self.place) });
            }
        };
        let tensors = own.strain.iter_mut().chain(&mut own.stress);
        tensors.zip(&numbers).for_each(|(field, values)| add(field, values));
        for (field, place) in own.displacement.iter_mut().zip(&places) {
            if let Some(place) = place {
                add(field, &shapes[*place]);
            }
        }
    }
}

/// A program bound to the distinct ones of some coordinates, and the place of each.
fn bound(
    program: &Program,
    all: &Values,
    point: impl Fn(f64) -> [f64; 3],
) -> (Bound, [Vec<u32>; HALVES]) {
    let mut distinct: Vec<f64> = all.iter().flatten().copied().collect();
    distinct.sort_by(f64::total_cmp);
    // Of some that differ by rounding the first stays.
    distinct.dedup_by(|next, own| *next - *own <= SAME_ABSCISSA * next.abs().max(own.abs()));
    let place = |at: &f64| distinct.partition_point(|own| own <= at).saturating_sub(1) as u32;
    let places = all.each_ref().map(|all| all.iter().map(place).collect());
    let points: Vec<[f64; 3]> = distinct.iter().map(|&at| point(at)).collect();
    (program.bind(&points), places)
}

/// The values at all points.
fn spread(values: &[f64], places: &[Vec<u32>; HALVES]) -> Values {
    places.each_ref().map(|places| places.iter().map(|&place| values[place as usize]).collect())
}
