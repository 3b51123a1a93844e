//! The sizes of the rows, by the columns that hold them, and what rates and counts say of sizes that no column holds.

use super::TableError;
use super::cell::{Measure, Role, is_missing, is_rate, normal, sides};
use super::columns::{Measured, Reader, Size};
use super::line::{Cells, evenly};
use fit::is_step;

/// How far the ratio of two columns of sizes may differ from row to row: printed with two digits, each is off by half
/// as much.
const SIZES_DIFFER: f64 = 0.1;
/// A level by a count of cells may differ so much from one by its number (as logarithms): unknowns grow at the rate of cells in
/// the limit only, and a wrong dimension or the cells of a plane taken for those of a side are off by 0.23 or more.
const LEVELS_DIFFER: f64 = 0.2;
/// Deeper levels are not levels of refinement.
const DEEPEST: f64 = 64.0;
/// Factors by which people refine. The nearest two give rates that differ by a quarter.
const FACTORS: [f64; 6] = [2.0, std::f64::consts::SQRT_2, 4.0, 3.0, 10.0, 1.5];
/// How far a printed rate may be from that of errors of two digits.
const RATE_OFF: f64 = 0.08;
/// Lower rates do not tell the factors apart.
const LEAST_RATE: f64 = 0.5;
/// By so much of the larger one a printed rate and that of the sizes differ where they are of different sizes.
const CONTRADICTS: f64 = 0.3;
/// Unknowns grow like a power of the cells along a side in the limit: so near to it (as levels) at first, and at last.
const FIRST_GROWTH: f64 = 0.5;
const LAST_GROWTH: f64 = 0.15;

/// A row with a printed rate, and by how much the error falls from the row before, as a logarithm.
struct Rated {
    row: usize,
    fall: f64,
    rate: f64,
}

/// The factor by which each row refines.
fn factor(pairs: &[Rated]) -> Option<f64> {
    FACTORS.into_iter().find(|factor| {
        let off = |pair: &Rated| (pair.fall / factor.ln() - pair.rate).abs();
        pairs.iter().all(|pair| off(pair) < RATE_OFF.max(0.02 * pair.rate.abs()))
    })
}

impl Reader<'_> {
    /// What the caller has not said of sizes and the table shows: by how much rows without sizes refine, from the rates beside their
    /// errors, and the dimension of a mesh that is known by counts, from those rates or from how the counts grow.
    pub(super) fn imply(&mut self, measured: &[Measured]) {
        let counted = |at: &usize| {
            matches!(self.roles[*at], Role::Space(Measure::Cells | Measure::Unknowns))
                && !self.has_sides(*at)
        };
        let places = || 0..self.roles.len();
        let sized = |at: usize| matches!(self.roles[at], Role::Space(_) | Role::Time(_));
        let counts = places()
            .filter(counted)
            .min_by_key(|&at| self.roles[at] == Role::Space(Measure::Unknowns));
        if places().any(|at| sized(at) && !counted(&at)) {
            return;
        }
        let rated = measured.iter().find_map(|measured| self.rated(measured));
        match counts {
            None if self.ratio.is_none() => {
                let factor = rated.and_then(|(rates, pairs)| Some((rates, factor(&pairs)?)));
                let Some((rates, factor)) = factor else { return };
                let (name, of) = (self.name(rates), files::digits(factor, 4));
                self.notes.push(format!("each row refines by {of}, as `{name}` says"));
                self.ratio = Some(factor);
            }
            Some(at) if self.dimension.is_none() => {
                let Ok(counts) = self.column(at, true) else { return };
                let by_rates = rated.and_then(|(rates, pairs)| {
                    let of = |pair: &Rated| {
                        let grown = counts[pair.row]? / counts[pair.row - 1]?;
                        Some((pair.rate * grown.ln() / pair.fall).abs())
                    };
                    let found: Vec<f64> = pairs.iter().map(of).collect::<Option<_>>()?;
                    let dimension = found.iter().sum::<f64>() / found.len() as f64;
                    let near = |d: &f64| (d - dimension.round()).abs() < 2.0 * LAST_GROWTH;
                    let why = format!("as `{}` says", self.name(rates));
                    found.iter().all(near).then_some((dimension.round(), why))
                });
                let grown = || Some((self.power(at)?, "as it grows".into()));
                let name = self.name(at);
                let found = by_rates.or_else(grown).filter(|(d, _)| (1.0..=3.0).contains(d));
                if let Some((dimension, why)) = found {
                    let power = if dimension > 1.0 { format!("1/{dimension}") } else { "1".into() };
                    self.notes.push(format!("h ~ {name}^(-{power}), {why}"));
                    self.dimension = Some(dimension as u32);
                }
            }
            _ => {}
        }
    }

    /// The rates behind a column of errors, and of each row that has one how the error falls; those that are large enough to tell
    /// factors apart.
    fn rated(&self, of: &Measured) -> Option<(usize, Vec<Rated>)> {
        let behind = of.at + 1..self.roles.len();
        let rates = behind
            .take_while(|&at| self.roles[at] == Role::Ignored)
            .find(|&at| is_rate(self.name(at)) || is_missing(&self.block.rows[0].cells[at]))?;
        let entries = self.column(rates, false).ok()?;
        let pair = |row: usize| {
            let fall = (of.entries[row - 1]? / of.entries[row]?).ln();
            let rate = entries[row].filter(|rate| rate.abs() > LEAST_RATE && fall.is_finite())?;
            Some(Rated { row, fall, rate })
        };
        let pairs: Vec<Rated> = (1..entries.len()).filter_map(pair).collect();
        // Where the column may hold plain ratios, it says nothing.
        let ratio = |pair: &Rated| (pair.fall.exp() / pair.rate - 1.0).abs() < RATE_OFF;
        (pairs.len() > 1 && !pairs.iter().all(ratio)).then_some((rates, pairs))
    }

    /// The dimension in which a count is the power of a number along a side, or grows like one in the limit.
    fn power(&self, at: usize) -> Option<f64> {
        let counts: Vec<f64> = self.column(at, true).ok()?.into_iter().collect::<Option<_>>()?;
        let (first, exact) = (*counts.first()?, self.roles[at] == Role::Space(Measure::Cells));
        let whole = |root: f64, of: f64, power: i32| root.round().powi(power) == of;
        let squares = counts.iter().all(|count| whole((count * first).sqrt(), count * first, 2));
        let cubes = counts
            .iter()
            .all(|count| whole((count * first * first).cbrt(), count * first * first, 3));
        let level = |pair: &[f64]| (pair[1] / pair[0]).log2().abs();
        let levels: Vec<f64> = counts.windows(2).map(level).filter(|level| *level > 0.0).collect();
        let (first, last) = match exact {
            true => (1e-9, 1e-9),
            false => (FIRST_GROWTH, LAST_GROWTH),
        };
        let near = |power: &f64| {
            let off = |level: &f64| (level - power).abs();
            // Rows may go from fine to coarse.
            let ends = [levels[0], levels[levels.len() - 1]];
            levels.iter().all(|level| off(level) < first)
                && ends.iter().any(|level| off(level) < last)
        };
        match (squares, cubes) {
            _ if levels.len() < 2 => None,
            (true, false) => Some(2.0),
            (false, true) => Some(3.0),
            (true, true) => None,
            // Meshes that are bisected double their unknowns, too.
            _ => [1.0, 2.0, 3.0].into_iter().find(near).filter(|power| exact || *power > 1.0),
        }
    }

    /// The column of sizes in one direction: the first of the measures that is there, which cells and unknowns are with the
    /// dimension. Columns that contradict it are refused.
    pub(super) fn size(&mut self, time: bool) -> Result<Option<Size>, TableError> {
        let (mut found, mut refused) = (Vec::new(), Vec::new());
        for at in 0..self.roles.len() {
            let own = self.roles[at].size().filter(|(_, in_time)| *in_time == time);
            let Some((measure, _)) = own else { continue };
            let open = match measure {
                Measure::Cells | Measure::Unknowns => !self.has_sides(at),
                // Beside cells `n` may be a counter, as in `n cells`: the dimension decides, or cells that are its power.
                Measure::Number => {
                    let cells = self.roles.iter().position(|r| *r == Role::Space(Measure::Cells));
                    normal(self.name(at)) == "n"
                        && cells.is_some_and(|cells| !self.is_power(cells, at))
                }
                _ => false,
            };
            // Of h and hmax, the one called h.
            let key = (measure, normal(self.name(at)).len());
            match self.steps(at, measure) {
                _ if open && self.dimension.is_none() => self.left_out.push(at),
                Ok(steps) => found.push((key, Size { at, measure, steps })),
                Err(error) => {
                    refused.push((key, error));
                    self.left_out.push(at);
                }
            }
        }
        found.sort_by_key(|(key, _)| *key);
        let best = found.first().map(|(key, _)| *key);
        refused.sort_by_key(|(key, _)| *key);
        if let Some((key, error)) = refused.into_iter().next()
            && best.is_none_or(|best| key < best)
        {
            return Err(error);
        }
        let mut found: Vec<Size> = found.into_iter().map(|(_, size)| size).collect();
        // A size that is the same in all rows beside one that is not is a degree, or of another mesh. With --ratio the rows would be
        // taken for levels against what they say.
        let refined = |size: &Size| {
            size.measure == Measure::Length || size.steps.iter().any(|step| *step != size.steps[0])
        };
        let alone = self.block.rows.len() > 2 && self.ratio.is_none();
        if alone || found.iter().any(refined) {
            self.left_out.extend(found.iter().filter(|size| !refined(size)).map(|size| size.at));
            found.retain(refined);
        }
        self.drop_counters(&mut found, time)?;
        let mut found = found.into_iter();
        let Some(first) = found.next() else { return Ok(None) };
        for other in found {
            self.agree(&first, &other)?;
            self.left_out.push(other.at);
        }
        Ok(Some(first))
    }

    /// Beside a mesh that is refined in each row a time step that stays and falls by turns is one of the runs, and no size; one that
    /// grows is a time.
    pub(super) fn drop_steps(&mut self, sizes: &mut [Option<Size>; 2]) {
        let [Some(mesh), Some(time)] = &*sizes else { return };
        let refined = mesh.steps.windows(2).all(|pair| pair[1] < pair[0]);
        let falls = time.steps.windows(2).filter(|pair| pair[1] < pair[0]).count();
        let stays = time.steps.windows(2).filter(|pair| pair[1] == pair[0]).count();
        let mut both = mesh.steps.windows(2).zip(time.steps.windows(2));
        let against = time.measure == Measure::Length
            && time.steps.iter().any(|step| step.fract() != 0.0)
            && both.all(|(mesh, time)| (mesh[1] - mesh[0]) * (time[1] - time[0]) < 0.0);
        let by_turns = falls > 0 && stays > 0 && falls + stays + 1 == time.steps.len();
        if refined && by_turns || against && time.steps.len() > 2 {
            self.left_out.push(time.at);
            sizes[1] = None;
        }
    }

    /// Beside a time step that changes with it a level counts the rows.
    pub(super) fn drop_level(&mut self, sizes: &mut [Option<Size>; 2]) {
        let [Some(level), Some(time)] = &*sizes else { return };
        let name = normal(self.name(level.at));
        let both = level.steps.windows(2).zip(time.steps.windows(2));
        if level.measure == Measure::Level
            && ["level", "levels", "lvl"].contains(&name.as_str())
            && both.into_iter().all(|(level, time)| level[0] != level[1] && time[0] != time[1])
        {
            self.left_out.push(level.at);
            sizes[0] = None;
        }
    }

    /// `k` or `n` that counts 1, 2, 3 is no size: whole numbers in k beside h are a degree.
    fn drop_counters(&mut self, found: &mut Vec<Size>, time: bool) -> Result<(), TableError> {
        let mut kept = Vec::new();
        for size in found.drain(..) {
            let name = normal(self.name(size.at));
            if !["k", "n", "grid", "mesh"].contains(&name.as_str()) {
                kept.push(size);
                continue;
            }
            let numbers = self.column(size.at, size.measure != Measure::Length)?;
            let mut distinct: Vec<f64> = Vec::new();
            for value in numbers.iter().flatten() {
                if !distinct.contains(value) && distinct.len() < 64 {
                    distinct.push(*value);
                }
            }
            let whole = distinct.iter().all(|value| value.fract() == 0.0);
            let counts = distinct.len() > 2
                && whole
                && evenly(&distinct)
                && (distinct[1] - distinct[0]).abs() == 1.0;
            let other = (0..self.roles.len()).any(|at| {
                at != size.at && matches!(self.roles[at], Role::Space(_) | Role::Time(_))
            });
            let grows = distinct.len() > 1 && distinct[1] > distinct[0];
            let degree = time && name == "k" && whole && (grows || distinct.len() == 1);
            // `eps` of 1/N says that `N` counts.
            let inverse = (0..self.roles.len())
                .any(|of| self.roles[of] == Role::Unknown && self.is_inverse(size.at, of));
            match ((counts || degree) && !inverse, other) {
                (true, true) => {
                    self.roles[size.at] = Role::Parameter;
                    self.left_out.push(size.at);
                }
                (true, false) => {
                    let (name, line) = (self.name(size.at), self.block.line);
                    let list: Vec<String> = distinct.iter().take(3).map(f64::to_string).collect();
                    let what = format!(
                        "`{name}` is {}, ...: is it a counter? Call it `level` if each level halves the step, or `steps` if it counts steps",
                        list.join(", ")
                    );
                    return Err(TableError::at(line, what));
                }
                _ => kept.push(size),
            }
        }
        *found = kept;
        Ok(())
    }

    /// The numbers of two columns, row by row.
    fn pairs(&self, one: usize, other: usize) -> Option<Vec<(f64, f64)>> {
        let (one, other) = (self.column(one, true).ok()?, self.column(other, true).ok()?);
        one.into_iter().zip(other).map(|(one, other)| one.zip(other)).collect()
    }

    /// Whether the numbers of two columns have one product.
    fn is_inverse(&self, one: usize, other: usize) -> bool {
        let off = |a: (f64, f64), b: (f64, f64)| (a.0 * a.1 / (b.0 * b.1) - 1.0).abs();
        self.pairs(one, other).is_some_and(|all| all.iter().all(|pair| off(*pair, all[0]) < 1e-3))
    }

    /// Whether cells are as the square or the cube of a number.
    fn is_power(&self, cells: usize, number: usize) -> bool {
        let pairs = self.pairs(cells, number).filter(|pairs| pairs.len() > 2);
        let Some(pairs) = pairs else { return false };
        [2, 3].into_iter().any(|power| {
            let each = |&(cells, side): &(f64, f64)| cells / side.powi(power);
            // Counts are whole and exact.
            pairs.iter().all(|pair| (each(pair) / each(&pairs[0]) - 1.0).abs() < 1e-12)
        })
    }

    /// Whole sizes that grow where all errors fall are counts: an error that grew by refinement at such an order is none of a study.
    pub(super) fn counts(&self, size: &Size, measured: &[Measured]) -> bool {
        let falls = |measured: &Measured| {
            let entries = measured.entries.iter().map(|entry| entry.unwrap_or(f64::NAN));
            let mut levels: Vec<(f64, f64)> = size.steps.iter().copied().zip(entries).collect();
            levels.sort_by(|(a, _), (b, _)| a.total_cmp(b));
            let steep = |pair: &[(f64, f64)]| {
                let [(fine, a), (coarse, b)] = [pair[0], pair[1]];
                fine < coarse && b / a < (fine / coarse).sqrt()
            };
            levels.len() > 2 && levels.windows(2).all(steep)
        };
        size.measure == Measure::Length
            && size.steps.iter().all(|step| step.fract() == 0.0)
            && measured.iter().all(falls)
    }

    /// Numbers 11, 21, 41 along a side are points, and 9, 19, 39 inner ones, if those of the cells between them, 10, 20, 40, grow by one
    /// factor and they do not.
    pub(super) fn count_cells(&mut self, size: &mut Size) {
        let mut numbers: Vec<f64> = size.steps.iter().map(|step| step.recip().round()).collect();
        numbers.sort_by(f64::total_cmp);
        numbers.dedup();
        let by_one_factor = |more: f64| {
            let three = |n: &[f64]| (n[1] + more).powi(2) == (n[0] + more) * (n[2] + more);
            numbers.windows(3).all(three)
        };
        let name = self.name(size.at);
        let of_cells = ["cell", "elem", "interval"].iter().any(|of| normal(name).contains(of));
        let counts = self.roles[size.at] == Role::Space(Measure::Number)
            && !of_cells
            && numbers.len() > 2
            && numbers[0] > 2.0
            && !by_one_factor(0.0);
        let points =
            [(-1.0, "points, one more than cells"), (1.0, "inner points, one less than cells")];
        if let Some((more, what)) =
            points.into_iter().find(|(more, _)| counts && by_one_factor(*more))
        {
            self.notes.push(format!("`{name}` counts {what}"));
            size.steps.iter_mut().for_each(|step| *step = (step.recip() + more).recip());
        }
    }

    /// Says so where all printed rates of an error are others than those by the sizes: they may be rates in something else.
    pub(super) fn compare_rates(&mut self, measured: &[Measured], size: &Size) {
        let known = |at: usize| measured.iter().any(|measured| measured.at == at);
        let said = measured.iter().find_map(|measured| {
            // Of rates behind several errors each is of one of them.
            let (rates, pairs) = self.rated(measured)?;
            let plain =
                ["ratio", "reduction"].iter().any(|of| normal(self.name(rates)).contains(of));
            let own =
                !plain && rates == measured.at + 1 && (measured.at == 0 || !known(measured.at - 1));
            let steps = |pair: &Rated| size.steps[pair.row - 1] / size.steps[pair.row];
            let slope = |pair: &Rated| (pair.fall / steps(pair).ln()).abs();
            let off = |pair: &Rated| {
                let (by_sizes, rate) = (slope(pair), pair.rate.abs());
                by_sizes.is_finite() && (by_sizes - rate).abs() > CONTRADICTS * by_sizes.max(rate)
            };
            let pair = pairs.last().filter(|_| own && pairs.iter().all(off))?;
            let [rate, by_sizes] = [pair.rate, slope(pair)].map(|rate| files::digits(rate, 3));
            let (name, of) = (self.name(rates), self.name(size.at));
            Some(format!("`{name}` says {rate} where `{of}` gives {by_sizes}"))
        });
        self.notes.extend(said);
    }

    fn has_sides(&self, at: usize) -> bool {
        sides(self.block.rows.iter().map(|row| row.cells[at].as_str())).is_some()
    }

    /// The sizes of the rows by a column; NaN where one is missing.
    fn steps(&self, at: usize, measure: Measure) -> Result<Vec<f64>, TableError> {
        let name = self.name(at);
        let counts = measure != Measure::Length;
        let cells = || self.block.rows.iter().map(|row| row.cells[at].as_str());
        let (numbers, measure) = match sides(cells()).filter(|_| counts) {
            Some(sides) => (sides.into_iter().map(Some).collect(), Measure::Number),
            None => (self.column(at, counts)?, measure),
        };
        let ratio = self.ratio.unwrap_or(2.0);
        let dimension = f64::from(self.dimension.unwrap_or(1));
        let mut before = f64::INFINITY;
        let step = |(number, row): (Option<f64>, &Cells)| {
            let Some(number) = number else { return Ok(f64::NAN) };
            let odd = number.is_nan() && row.cells[at].contains('x');
            let level = (0.0..=DEEPEST).contains(&number) && number <= before + 4.0;
            before = number;
            let why = match measure {
                Measure::Level if !level || number.fract() != 0.0 => {
                    "no level of refinement: call the column n if it counts cells along a side"
                }
                Measure::Level => return Ok(ratio.powf(-number)),
                _ if odd => "no mesh of the shape of the others",
                _ if !is_step(number) => "no step size, which is positive",
                _ if counts && number.fract() != 0.0 => {
                    "no whole number, which a count is: call it h or k if it is a step"
                }
                Measure::Cells | Measure::Unknowns => return Ok(number.powf(-1.0 / dimension)),
                Measure::Number => return Ok(1.0 / number),
                Measure::Length => return Ok(number),
            };
            let cell = if odd { row.cells[at].clone() } else { number.to_string() };
            Err(TableError::at(row.line, format!("{name} = {cell} is {why}")))
        };
        numbers.into_iter().zip(&self.block.rows).map(step).collect()
    }

    /// Refuses a second column of sizes that says otherwise.
    fn agree(&self, first: &Size, second: &Size) -> Result<(), TableError> {
        let counted = |size: &Size| matches!(size.measure, Measure::Cells | Measure::Unknowns);
        let allowed = match (first.measure == second.measure, second.measure) {
            // Unknowns of different kinds grow at one rate in the limit only.
            (true, Measure::Unknowns) => return Ok(()),
            (true, _) => Some(SIZES_DIFFER),
            (_, Measure::Level) if self.ratio.is_none() => Some(LEVELS_DIFFER),
            // A number beside a length may count all cells: it has to refine where the length does.
            _ => None,
        };
        let [one, other] = [first, second].map(|size| self.name(size.at));
        let mut before: Option<(u64, f64, f64)> = None;
        for (row, (&a, &b)) in self.block.rows.iter().zip(first.steps.iter().zip(&second.steps)) {
            if a.is_nan() || b.is_nan() {
                continue;
            }
            let Some((line, c, d)) = before else {
                before = Some((row.line, a, b));
                continue;
            };
            let (by_one, by_other) = ((a / c).ln(), (b / d).ln());
            let levels = if second.measure == Measure::Level {
                (by_other / 2f64.ln()).abs().max(1.0)
            } else {
                1.0
            };
            let wrong = match allowed {
                Some(allowed) => (by_one - by_other).abs() > allowed * levels,
                None => by_one * by_other < 0.0 && !counted(second),
            };
            if wrong {
                let what = format!(
                    "two columns of sizes disagree: `{one}` and `{other}` give {a:.4e} and {b:.4e}, in line {line} {c:.4e} and {d:.4e}; leave one of them out"
                );
                return Err(TableError::at(row.line, what));
            }
        }
        Ok(())
    }

    pub(super) fn no_size(&self) -> String {
        let count = |role: &Role| matches!(role, Role::Space(Measure::Cells | Measure::Unknowns));
        if let Some(at) = self.roles.iter().position(count) {
            let name = self.name(at);
            return format!(
                "the mesh is known by `{name}` alone: --dimension D says how h follows, h ~ {name}^(-1/D)"
            );
        }
        "no column of sizes: --ratio 2 if each row halves the step, or a column h, k, n, level or steps".into()
    }
}
