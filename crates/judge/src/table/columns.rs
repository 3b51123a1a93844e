//! Positions of the columns, and rows read by them.

use super::cells::Cells;
use super::name::{Measure, Role, is_cells, normal, role, understood};
use super::number::{is_missing, parse};
use super::{Quantity, Row, TableError};
use crate::fit::{Point, deviation, is_step, screen};
use files::counted;

/// How far the ratio of two columns of sizes may differ from row to row: printed with two digits, each is off by half
/// as much.
const SIZES_DIFFER: f64 = 0.1;

/// Deeper levels are not levels of refinement.
const DEEPEST: f64 = 64.0;

/// What a reader has to know beside the text.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Reading {
    /// Dimension of the mesh, if sizes are counts of cells or unknowns.
    pub dimension: Option<u32>,
}

#[derive(Debug, Clone)]
struct Size {
    at: usize,
    name: String,
    measure: Measure,
}

/// A column of errors or values; named if there may be several.
#[derive(Debug, Clone)]
pub(super) struct Measured {
    pub(super) at: usize,
    pub(super) norm: Option<String>,
}

#[derive(Debug)]
pub(super) struct Columns {
    h: Option<Size>,
    k: Option<Size>,
    /// Further columns of the kind of h, or of k.
    beside: Vec<(Size, Size)>,
    dimension: Option<u32>,
    pub(super) measured: Vec<Measured>,
    pub(super) quantity: Quantity,
    floor: Option<usize>,
    sigma: Option<usize>,
    pub(super) scene: Option<usize>,
    pub(super) norm: Option<usize>,
    status: Option<usize>,
    count: usize,
    /// Names not understood, beside known norms.
    pub(super) unknown: Vec<String>,
}

impl Columns {
    pub(super) fn of(header: &Cells, reading: &Reading) -> Result<Self, TableError> {
        let roles: Vec<Role> = header.cells.iter().map(|name| role(name)).collect();
        let fail = |what: String| Err(TableError::at(header.line, what));
        let place = |wanted: Role| roles.iter().position(|role| *role == wanted);
        let unknown: Vec<String> = (header.cells.iter().zip(&roles))
            .filter(|(_, role)| **role == Role::Unknown)
            .map(|(name, _)| format!("`{name}`"))
            .collect();
        let names = match unknown.is_empty() {
            true => format!("; understood are {}", understood()),
            false => {
                format!("; not understood: {}; understood are {}", unknown.join(", "), understood())
            }
        };
        let wide = |(at, name): (usize, &String)| Measured { at, norm: Some(name.clone()) };
        let (measured, quantity) = match (place(Role::Error), place(Role::Value)) {
            (Some(_), Some(_)) => {
                return fail("both `error` and `value`: which of them is judged?".into());
            }
            (Some(at), None) => (vec![Measured { at, norm: None }], Quantity::Error),
            (None, Some(at)) => (vec![Measured { at, norm: None }], Quantity::Value),
            (None, None) => {
                let norms = header.cells.iter().enumerate().zip(&roles);
                let norms =
                    norms.filter(|(_, role)| **role == Role::Wide).map(|(column, _)| wide(column));
                (norms.collect(), Quantity::Error)
            }
        };
        if measured.is_empty() {
            return fail(format!("no column `error` (or `value`), and no norm{names}"));
        }
        twice(header, &roles, &measured)?;
        let sizes = [false, true].map(|time| sizes(header, &roles, time, reading.dimension));
        let beside = sizes.iter().flat_map(|of| of.iter().skip(1).map(|more| (&of[0], more)));
        let beside = beside.map(|(first, more)| (first.clone(), more.clone())).collect();
        let [h, k] = sizes.map(|of| of.into_iter().next());
        if h.is_none() && k.is_none() {
            return fail(match roles.contains(&Role::Space(Measure::Count)) {
                true => "the mesh is known by its cells or unknowns alone: --dimension D says how h follows, h ~ dofs^(-1/D)".into(),
                false => format!("no column `h` and no column `k`{names}"),
            });
        }
        let long = measured.iter().all(|column| column.norm.is_none());
        Ok(Self {
            h,
            k,
            beside,
            dimension: reading.dimension,
            measured,
            quantity,
            floor: place(Role::Floor),
            sigma: place(Role::Sigma),
            scene: place(Role::Scene),
            norm: place(Role::Norm),
            status: place(Role::Status),
            count: header.cells.len(),
            // A table with a column `error` may have any other column, as `cases.csv` does.
            unknown: if long { Vec::new() } else { unknown },
        })
    }

    pub(super) fn rows(&self, cells: &Cells) -> Result<Vec<Row>, TableError> {
        let line = cells.line;
        if cells.cells.len() != self.count {
            let (found, wanted) = (counted(cells.cells.len(), "field"), self.count);
            let hint = if cells.cells.len() == 2 * wanted {
                "; decimal commas are written as points"
            } else {
                ""
            };
            return Err(TableError::at(line, format!("{found}, the header has {wanted}{hint}")));
        }
        let text =
            |at: Option<usize>| at.and_then(|at| cells.cells.get(at)).filter(|t| !t.is_empty());
        let number = |at: Option<usize>, absent: f64| -> Result<f64, TableError> {
            match text(at) {
                Some(text) if !is_missing(text) => {
                    parse(text).map_err(|what| TableError::at(line, what))
                }
                _ => Ok(absent),
            }
        };
        let step = |size: &Option<Size>| -> Result<f64, TableError> {
            size.as_ref().map_or(Ok(f64::NAN), |size| self.step(cells, size))
        };
        let (h, k) = (step(&self.h)?, step(&self.k)?);
        let floor = number(self.floor, 0.0)?;
        let has_sigma = text(self.sigma).is_some_and(|text| !is_missing(text));
        let sigma = has_sigma.then(|| number(self.sigma, f64::NAN)).transpose()?;
        let status = text(self.status);
        let row = |column: &Measured| {
            let error = number(Some(column.at), f64::NAN)?;
            let point = Point { h, k, error, floor };
            let there = text(Some(column.at)).is_some_and(|text| !is_missing(text));
            let gap = match status {
                Some(status) if status != "converged" => Some(format!("the case is {status}")),
                _ => self.gap(&point, there, sigma),
            };
            Ok(Row { line, point, sigma, gap })
        };
        self.measured.iter().map(row).collect()
    }

    /// The size of a row by a column; NaN if it is missing.
    fn step(&self, cells: &Cells, size: &Size) -> Result<f64, TableError> {
        let Size { at, name, measure, .. } = size;
        let fail = |what: String| Err(TableError::at(cells.line, what));
        let text = cells.cells.get(*at).filter(|text| !text.is_empty() && !is_missing(text));
        let Some(text) = text else { return Ok(f64::NAN) };
        let step = parse(text).map_err(|what| TableError::at(cells.line, what))?;
        if *measure == Measure::Level && step.abs() <= DEEPEST {
            return Ok((-step).exp2());
        }
        if !is_step(step) {
            return fail(format!("{name} = {step} is no step size, which is positive"));
        }
        if *measure == Measure::Level {
            return fail(format!("{name} = {step} is no level of refinement"));
        }
        Ok(match (measure, self.dimension) {
            (Measure::Length | Measure::Level, _) => step,
            (Measure::Count, Some(dimension)) => step.powf(-1.0 / f64::from(dimension)),
            (Measure::Number | Measure::Count, _) => 1.0 / step,
        })
    }

    /// Refuses two columns of sizes whose ratio is not the same in all rows: which of them is the size?
    pub(super) fn sizes_agree(&self, rows: &[Cells]) -> Result<(), TableError> {
        for (first, second) in &self.beside {
            let mut before: Option<(u64, f64, f64)> = None;
            for cells in rows {
                let (a, b) = (self.step(cells, first)?, self.step(cells, second)?);
                if a.is_nan() || b.is_nan() {
                    continue;
                }
                let Some((line, c, d)) = before else {
                    before = Some((cells.line, a, b));
                    continue;
                };
                if ((a / b) / (c / d)).ln().abs() > SIZES_DIFFER {
                    let [one, other] = [&first.name, &second.name];
                    let what = format!(
                        "two columns of sizes disagree: `{one}` and `{other}` give {a:.4e} and {b:.4e}, in line {line} {c:.4e} and {d:.4e}; leave one of them out"
                    );
                    return Err(TableError::at(cells.line, what));
                }
            }
        }
        Ok(())
    }

    fn gap(&self, point: &Point, there: bool, sigma: Option<f64>) -> Option<String> {
        let none = |sigma: f64| format!("sigma {sigma:?} is no standard deviation");
        match (self.quantity, sigma) {
            (_, Some(sigma)) if !is_step(sigma) => return Some(none(sigma)),
            (Quantity::Error, Some(sigma)) if screen(point).is_ok() => {
                if let Err(why) = deviation(sigma / point.error) {
                    return Some(why.to_string());
                }
            }
            _ => {}
        }
        match self.quantity {
            Quantity::Error if !there => Some("no error".into()),
            Quantity::Value if !there => Some("no value".into()),
            Quantity::Error => {
                screen(point).err().filter(|why| why.is_broken()).map(|why| why.to_string())
            }
            Quantity::Value if point.error.is_finite() => None,
            Quantity::Value => Some(format!("the value {} is no number", point.error)),
        }
    }
}

/// Refuses a column that stands twice: which of them is read?
fn twice(header: &Cells, roles: &[Role], measured: &[Measured]) -> Result<(), TableError> {
    let same = |a: usize, b: usize| match roles[a] {
        Role::Ignored | Role::Unknown => false,
        Role::Space(_) | Role::Time(_) => header.cells[a] == header.cells[b],
        Role::Wide => {
            let read = |at: usize| measured.iter().any(|column| column.at == at);
            read(a) && read(b) && header.cells[a] == header.cells[b]
        }
        role => role == roles[b],
    };
    let mut pairs = (0..roles.len()).flat_map(|b| (0..b).map(move |a| (a, b)));
    let Some((a, b)) = pairs.find(|&(a, b)| same(a, b)) else { return Ok(()) };
    let (one, other) = (&header.cells[a], &header.cells[b]);
    let what = format!(
        "a column stands twice: `{one}` is column {}, `{other}` column {}; leave one of them out, or give it another name",
        a + 1,
        b + 1
    );
    Err(TableError::at(header.line, what))
}

/// The column of sizes in one direction, and those of the same kind. Preference: a length, a number along the side, a
/// count (which needs the dimension). With a dimension given, `n` is a counter.
fn sizes(header: &Cells, roles: &[Role], time: bool, dimension: Option<u32>) -> Vec<Size> {
    let counted = header.cells.iter().any(|name| is_cells(name));
    let found = header.cells.iter().enumerate().zip(roles).filter_map(|((at, name), role)| {
        let measure = match (role, time) {
            (Role::Space(measure), false) | (Role::Time(measure), true) => *measure,
            _ => return None,
        };
        let rank = match measure {
            Measure::Length => 0,
            Measure::Count if dimension.is_none() => return None,
            Measure::Count if is_cells(name) => 1,
            Measure::Count => UNKNOWNS,
            // Beside cells `n` may be a counter, as in `n cells`: the dimension decides.
            Measure::Number if dimension.is_none() && normal(name) == "n" && counted => {
                return None;
            }
            Measure::Number => 3,
            Measure::Level => 4,
        };
        // Of h and hmax, the one called h.
        let plain = normal(name).len();
        Some((rank, plain, Size { at, name: name.clone(), measure }))
    });
    let mut found: Vec<(usize, usize, Size)> = found.collect();
    found.sort_by_key(|(rank, plain, _)| (*rank, *plain));
    let best = found.first().map(|(rank, ..)| *rank);
    // Unknowns of different kinds grow at one rate in the limit only.
    let kept = if best == Some(UNKNOWNS) { 1 } else { found.len() };
    found.retain(|(rank, ..)| Some(*rank) == best);
    found.into_iter().take(kept).map(|(.., size)| size).collect()
}

/// Rank of a count that is not of cells.
const UNKNOWNS: usize = 2;
