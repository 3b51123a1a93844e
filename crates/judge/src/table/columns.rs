//! The columns of a block: sizes, errors, and what tells tables apart.

use std::collections::{HashMap, HashSet};

use super::cell::{
    Comma, Measure, Number, Role, is_missing, is_rate, likeness, named, normal, number, role,
    says_error, sides,
};
use super::guess::{approach_a_limit, are_orders, by_numbers, confirm, of_errors};
use super::line::{Block, Cells, is_computed, listed};
use super::{Quantity, Reading, TableError};
use crate::fit::is_step;
use files::counted;

/// How far the ratio of two columns of sizes may differ from row to row: printed with two digits, each is off by half
/// as much.
const SIZES_DIFFER: f64 = 0.1;
/// A level by a count of cells may differ so much from one by its number (as logarithms): unknowns grow at the rate of cells in
/// the limit only, and a wrong dimension or the cells of a plane taken for those of a side are off by 0.23 or more.
const LEVELS_DIFFER: f64 = 0.2;
/// Deeper levels are not levels of refinement.
const DEEPEST: f64 = 64.0;

/// More columns are no table of a study.
const MOST_COLUMNS: usize = 1000;

/// A number of a cell; none where it is missing.
pub(super) type Entries = Vec<Option<f64>>;

#[derive(Debug, Clone)]
struct Size {
    at: usize,
    measure: Measure,
    /// NaN where it is missing.
    steps: Vec<f64>,
}

pub(super) struct Measured {
    pub(super) norm: Option<String>,
    pub(super) entries: Entries,
    pub(super) signed: bool,
}

pub(super) struct Columns {
    /// h and k; none where the table has no such column.
    pub(super) steps: [Option<Vec<f64>>; 2],
    pub(super) measured: Vec<Measured>,
    pub(super) quantity: Quantity,
    pub(super) floor: Option<Entries>,
    pub(super) sigma: Option<Entries>,
    pub(super) scene: Option<usize>,
    pub(super) norm: Option<usize>,
    pub(super) status: Option<usize>,
    pub(super) by: Vec<usize>,
    pub(super) runs: bool,
    /// What was read and what was not.
    pub(super) said: String,
}

struct Reader<'a> {
    block: &'a Block,
    reading: &'a Reading,
    roles: Vec<Role>,
    /// Whether a cell of the table has a comma that can be a decimal one alone.
    decimal: bool,
    left_out: Vec<usize>,
    notes: Vec<String>,
}

impl Columns {
    pub(super) fn of(block: &Block, reading: &Reading) -> Result<Self, TableError> {
        let names = &block.names;
        let fail = |what: String| Err(TableError::at(block.line, what));
        if names.is_empty() {
            let what =
                "no header: a line above names the columns, `h,error` or `h,L2,H1` for example";
            return fail(what.into());
        }
        if names.len() > MOST_COLUMNS {
            return fail(format!("{} columns: at most {MOST_COLUMNS} are read", names.len()));
        }
        for row in &block.rows {
            if row.cells.len() != names.len() {
                let found = counted(row.cells.len(), "field");
                let hint = match row.cells.len() == 2 * names.len() {
                    true => "; decimal commas are written as points, or cells parted by `;`",
                    false => "",
                };
                let what = format!("{found}, the header has {}{hint}", names.len());
                return Err(TableError::at(row.line, what));
            }
        }
        let mut reader = Reader::of(block, reading)?;
        let (measured, quantity) = reader.measured()?;
        let runs = reading.runs || reader.roles.contains(&Role::Run);
        let mut sizes = [reader.size(false)?, reader.size(true)?];
        reader.drop_level(&mut sizes);
        if let Some(measured) = measured.iter().find(|m| are_orders(&block.title, &m.entries)) {
            let name = measured.norm.as_deref().unwrap_or("error");
            let title = &block.title;
            return fail(format!(
                "`{name}` seems to hold orders, not errors: `{title}` stands above"
            ));
        }
        let judged = quantity == Quantity::Error;
        if let Some(size) = sizes.iter().flatten().find(|s| judged && reader.counts(s, &measured)) {
            let name = reader.name(size.at);
            return fail(format!(
                "`{name}` is whole and the errors fall where it grows: is it a count? Call it `n` if it counts cells along a side, `steps` if it counts steps"
            ));
        }
        if sizes.iter().all(Option::is_none) && reading.ratio.is_none() {
            return fail(reader.no_size());
        }
        let place = |wanted: Role| reader.roles.iter().position(|role| *role == wanted);
        let [floor, sigma] = [Role::Floor, Role::Sigma].map(place);
        let [scene, norm, status] = [Role::Scene, Role::Norm, Role::Status].map(place);
        let (entries, steps) = (
            |at: Option<usize>| at.map(|at| reader.column(at, false)).transpose(),
            |size: &Option<Size>| size.as_ref().map(|size| size.steps.clone()),
        );
        let mut columns = Self {
            steps: [steps(&sizes[0]), steps(&sizes[1])],
            measured,
            quantity,
            floor: entries(floor)?,
            sigma: entries(sigma)?,
            scene,
            norm,
            status,
            by: Vec::new(),
            runs,
            said: String::new(),
        };
        columns.by = reader.by(&columns, &sizes)?;
        columns.said = reader.said(&columns, &sizes);
        Ok(columns)
    }
}

impl<'a> Reader<'a> {
    fn of(block: &'a Block, reading: &'a Reading) -> Result<Self, TableError> {
        let names: Vec<&str> = block.names.iter().map(String::as_str).collect();
        let mut roles: Vec<Role> = names.iter().map(|name| role(name)).collect();
        let missing = |what: String| TableError::at(block.line, what);
        // Beside errors an energy that hardly changes is a value: an error that is refined twice changes by more than a tenth.
        let errors = names.iter().any(|name| normal(name).contains("err"));
        for at in (0..roles.len()).filter(|&at| errors && normal(names[at]) == "energy") {
            let sizes =
                block.rows.iter().filter_map(|row| Some(number(&row.cells[at])?.value.abs()));
            let sizes: Vec<f64> = sizes.collect();
            let [least, most] =
                [f64::min, f64::max].map(|of| sizes.iter().copied().reduce(of).unwrap_or(f64::NAN));
            if sizes.len() > 2 && most < 1.1 * least {
                roles[at] = Role::Unknown;
            }
        }
        for asked in &reading.errors {
            // Of a table with a column `norm` it is the name of one.
            if let Ok(at) = named(asked, &names)
                && matches!(roles[at], Role::Unknown | Role::Ignored | Role::Parameter | Role::Run)
            {
                roles[at] = Role::Wide;
            }
        }
        for asked in &reading.by {
            let at = named(asked, &names).map_err(|what| missing(format!("--by: {what}")))?;
            roles[at] = Role::Parameter;
        }
        let mut notes = Vec::new();
        let measures = [Role::Error, Role::Value, Role::Wide];
        let counted = by_numbers(block, reading, &mut roles, &mut notes);
        // What a rate follows is an error, whatever its name; of several such the caller may name some.
        for at in 1..roles.len() {
            if roles[at - 1] == Role::Unknown && is_rate(names[at]) && reading.errors.is_empty() {
                roles[at - 1] = Role::Wide;
            }
        }
        // Below a title that speaks of errors they are what has no other name.
        let sized = roles.iter().any(|role| matches!(role, Role::Space(_) | Role::Time(_)));
        if sized
            && names.iter().all(|name| number(name).is_none())
            && of_errors(&block.title)
            && !roles.iter().any(|role| measures.contains(role))
        {
            for role in roles.iter_mut().filter(|role| **role == Role::Unknown) {
                *role = Role::Wide;
                notes = vec![format!("errors because `{}` stands above", block.title)];
            }
        }
        // A column of words alone tells tables apart, whatever it is called.
        for (at, role) in roles.iter_mut().enumerate() {
            let words =
                |row: &Cells| is_missing(&row.cells[at]) || number(&row.cells[at]).is_none();
            let number_wanted = matches!(
                role,
                Role::Wide | Role::Unknown | Role::Ignored | Role::Space(_) | Role::Time(_)
            );
            if number_wanted && block.rows.iter().all(words) {
                let any = block.rows.iter().any(|row| !is_missing(&row.cells[at]));
                *role = if any { Role::Parameter } else { Role::Ignored };
            }
        }
        // What is computed from errors is a rate, whatever its name.
        for at in 1..roles.len() {
            let computed = |from| roles[from] == Role::Wide && is_computed(&block.rows, at, from);
            if roles[at] == Role::Wide && (0..at).any(computed) {
                roles[at] = Role::Ignored;
            }
        }
        // Sizes that are printed again before each error are read once.
        for at in 1..roles.len() {
            let same = |before: usize| {
                names[before] == names[at]
                    && block.rows.iter().all(|row| row.cells[before] == row.cells[at])
            };
            if matches!(roles[at], Role::Space(_) | Role::Time(_)) && (0..at).any(same) {
                roles[at] = Role::Ignored;
            }
        }
        // `norm` of numbers is an error.
        let errors = roles.iter().any(|role| matches!(role, Role::Error | Role::Value));
        if let Some(at) = roles.iter().position(|role| *role == Role::Norm && !errors) {
            roles[at] = Role::Wide;
        }
        confirm(block, counted, &mut roles, &mut notes);
        let cells = block.rows.iter().flat_map(|row| &row.cells);
        let mut commas = cells.filter(|cell| cell.contains(','));
        let decimal = commas.any(|cell| number(cell).is_some_and(|n| n.comma == Comma::Decimal));
        Ok(Self { block, reading, roles, decimal, left_out: Vec::new(), notes })
    }

    fn name(&self, at: usize) -> &str {
        &self.block.names[at]
    }

    /// The numbers of a column; `whole` are counts, in which `2,312` can be no fraction.
    fn column(&self, at: usize, whole: bool) -> Result<Entries, TableError> {
        let rows = &self.block.rows;
        let cell = |row: &'a Cells| -> Result<_, TableError> {
            let text = row.cells[at].as_str();
            if is_missing(text) {
                return Ok(None);
            }
            let read = number(text).ok_or_else(|| {
                TableError::at(row.line, format!("{} = `{text}` is not a number", self.name(at)))
            })?;
            Ok(Some((row.line, text, read)))
        };
        let cells = rows.iter().map(cell).collect::<Result<Vec<_>, _>>()?;
        let mut unit: Option<&str> = None;
        let grouped = cells.iter().flatten().any(|(.., n)| n.comma == Comma::Thousands);
        let pointed = cells.iter().flatten().any(|(_, text, _)| text.contains('.'));
        let entry = |(line, text, read): &(u64, &'a str, Number)| {
            let refuse = |what: String| Err(TableError::at(*line, what));
            match read.comma {
                Comma::Decimal if grouped || pointed => refuse(format!(
                    "`{text}` has a decimal comma, other numbers of {} a point: write points",
                    self.name(at)
                )),
                Comma::Either if whole || grouped => Ok(read.value),
                Comma::Either if self.decimal && !pointed => Ok(read.value / 1000.0),
                Comma::Either => {
                    let plain = text.replace(',', "");
                    let point = text.replace(',', ".");
                    refuse(format!("`{text}` may be {plain} or {point}: write one of them"))
                }
                _ => Ok(read.value),
            }
        };
        for (line, text, read) in cells.iter().flatten() {
            let known = *unit.get_or_insert(&read.unit);
            if known != read.unit && read.value != 0.0 {
                let what = format!("`{text}`: {} has numbers of two units", self.name(at));
                return Err(TableError::at(*line, what));
            }
        }
        cells.iter().map(|cell| cell.as_ref().map(entry).transpose()).collect()
    }

    fn measured(&mut self) -> Result<(Vec<Measured>, Quantity), TableError> {
        let fail = |what: String| Err(TableError::at(self.block.line, what));
        let all = |wanted: Role| -> Vec<usize> {
            (0..self.roles.len()).filter(|&at| self.roles[at] == wanted).collect()
        };
        let (errors, values) = (all(Role::Error), all(Role::Value));
        let asked = |at: &usize| {
            let like = |asked: &String| likeness(asked, self.name(*at)) > 0;
            self.reading.errors.iter().any(like)
        };
        let wide = all(Role::Wide);
        let (places, quantity) = match (errors.first(), values.first()) {
            (Some(_), _) => {
                let named = wide.iter().copied().filter(asked);
                (errors.iter().copied().chain(named).collect(), Quantity::Error)
            }
            (None, Some(_)) => (values.clone(), Quantity::Value),
            (None, None) => (self.no_values(&wide)?, Quantity::Error),
        };
        let places: Vec<usize> = places;
        self.refuse_twice(&places)?;
        if places.is_empty() {
            let columns: Vec<&str> = (0..self.roles.len())
                .filter(|&at| matches!(self.roles[at], Role::Unknown | Role::Parameter))
                .map(|at| self.name(at))
                // What ends with a colon is prose above the rows.
                .filter(|name| !name.is_empty() && !name.ends_with(':'))
                .collect();
            let repeated = self.block.repeated.first();
            return fail(match (columns.first(), repeated) {
                (_, Some(name)) => format!(
                    "`{name}` comes several times between two sizes: which of them is the error of the level?"
                ),
                (Some(first), _) => {
                    let falls = columns[1..].iter().find(|name| self.falls(name));
                    let first = falls.unwrap_or(first);
                    format!(
                        "no column of errors among {}: --p {first}=2 makes `{first}` one",
                        listed(&columns)
                    )
                }
                _ => "no column of errors: call one `error`, or by its norm, `L2`, or `value` if none is known".into(),
            });
        }
        self.left_out = (0..self.roles.len())
            .filter(|at| {
                matches!(self.roles[*at], Role::Unknown | Role::Ignored | Role::Wide | Role::Value)
                    && !places.contains(at)
            })
            .collect();
        // A sweep's own file has no signs: a negative error there is broken.
        let own = self.roles.contains(&Role::Status);
        let one = places.len() == 1 && quantity == Quantity::Value
            || errors.len() == 1 && places.len() == 1;
        let mut measured = Vec::new();
        for at in places {
            let entries = self.column(at, false)?;
            // An error that changes its sign among others is broken, as a lone minus is.
            let mut signs = entries.iter().flatten();
            let (below, above) =
                (signs.clone().any(|error| *error < 0.0), signs.any(|error| *error > 0.0));
            let negative = below && !above;
            if below && above && !own && quantity == Quantity::Error {
                let name = self.name(at);
                self.notes.push(format!("`{name}` has both signs: what is negative is no error"));
            }
            let signed = negative && !own && quantity == Quantity::Error;
            if signed {
                self.notes.push(format!("`{}` is negative and read by magnitude", self.name(at)));
            }
            let norm = (!one).then(|| self.name(at).to_owned());
            measured.push(Measured { norm, entries, signed });
        }
        Ok((measured, quantity))
    }

    /// Of columns of errors by their names, those whose numbers are no values of a quantity that converges: a largest
    /// stress may be a value or an error.
    fn no_values(&self, wide: &[usize]) -> Result<Vec<usize>, TableError> {
        let asked = |name: &str| self.reading.errors.iter().any(|asked| likeness(asked, name) > 0);
        let is_value = |at: &usize| {
            let name = self.name(*at);
            let entries =
                || self.column(*at, false).ok()?.into_iter().collect::<Option<Vec<f64>>>();
            !says_error(name) && !asked(name) && entries().is_some_and(|e| approach_a_limit(&e))
        };
        let (values, errors): (Vec<usize>, Vec<usize>) = wide.iter().partition(|at| is_value(at));
        match (values.first(), errors.is_empty()) {
            (Some(&at), true) => {
                let name = self.name(at);
                let what = format!(
                    "`{name}` seems to hold values, not errors: it approaches a limit that is not 0. Call the column `value`, or --p '{name}=2' if these are errors"
                );
                Err(TableError::at(self.block.line, what))
            }
            _ => Ok(errors),
        }
    }

    /// Whether the numbers of a column fall from row to row.
    fn falls(&self, name: &str) -> bool {
        let at = self.block.names.iter().position(|other| other == name);
        let entries = at.and_then(|at| self.column(at, false).ok());
        let entries: Option<Vec<f64>> = entries.and_then(|entries| entries.into_iter().collect());
        entries.is_some_and(|e| e.windows(2).all(|pair| pair[1].abs() < pair[0].abs()))
    }

    /// Refuses a column that stands twice: which of them is read?
    fn refuse_twice(&self, measured: &[usize]) -> Result<(), TableError> {
        let mut seen: HashMap<(String, bool), usize> = HashMap::new();
        for (at, role) in self.roles.iter().enumerate() {
            let key = match role {
                Role::Ignored | Role::Unknown | Role::Parameter | Role::Run => continue,
                Role::Wide if !measured.contains(&at) => continue,
                Role::Space(_) | Role::Time(_) | Role::Wide => (self.name(at).to_owned(), true),
                _ => (format!("{role:?}"), false),
            };
            if let Some(before) = seen.insert(key, at) {
                let what = format!(
                    "a column stands twice: `{}` is column {}, `{}` column {}; leave one of them out, or give it another name",
                    self.name(before),
                    before + 1,
                    self.name(at),
                    at + 1
                );
                return Err(TableError::at(self.block.line, what));
            }
        }
        Ok(())
    }

    /// The column of sizes in one direction: the first of the measures that is there, which cells and unknowns are with the
    /// dimension. Columns that contradict it are refused.
    fn size(&mut self, time: bool) -> Result<Option<Size>, TableError> {
        let (mut found, mut refused) = (Vec::new(), Vec::new());
        for at in 0..self.roles.len() {
            let measure = match (self.roles[at], time) {
                (Role::Space(measure), false) | (Role::Time(measure), true) => measure,
                _ => continue,
            };
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
                _ if open && self.reading.dimension.is_none() => self.left_out.push(at),
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
        let alone = self.block.rows.len() > 2 && self.reading.ratio.is_none();
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

    /// Beside a time step that changes with it a level counts the rows.
    fn drop_level(&mut self, sizes: &mut [Option<Size>; 2]) {
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
                && (distinct[0] == 0.0 || distinct[0] == 1.0)
                && distinct.windows(2).all(|pair| pair[1] == pair[0] + 1.0);
            let other = (0..self.roles.len()).any(|at| {
                at != size.at && matches!(self.roles[at], Role::Space(_) | Role::Time(_))
            });
            let grows = distinct.len() > 1 && distinct[1] > distinct[0];
            let degree = time && name == "k" && whole && grows;
            match (counts || degree, other) {
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

    /// Whether cells are as the square or the cube of a number.
    fn is_power(&self, cells: usize, number: usize) -> bool {
        let (Ok(cells), Ok(sides)) = (self.column(cells, true), self.column(number, true)) else {
            return false;
        };
        let pairs: Option<Vec<(f64, f64)>> =
            cells.into_iter().zip(sides).map(|(cells, side)| cells.zip(side)).collect();
        let Some(pairs) = pairs.filter(|pairs| pairs.len() > 2) else { return false };
        [2, 3].into_iter().any(|power| {
            let each = |&(cells, side): &(f64, f64)| cells / side.powi(power);
            // Counts are whole and exact.
            pairs.iter().all(|pair| (each(pair) / each(&pairs[0]) - 1.0).abs() < 1e-12)
        })
    }

    /// Whole sizes that grow where all errors fall are counts: an error that grew by refinement at such an order is none of a study.
    fn counts(&self, size: &Size, measured: &[Measured]) -> bool {
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
        let ratio = self.reading.ratio.unwrap_or(2.0);
        let dimension = f64::from(self.reading.dimension.unwrap_or(1));
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
            (_, Measure::Level) if self.reading.ratio.is_none() => Some(LEVELS_DIFFER),
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

    fn no_size(&self) -> String {
        let count = |role: &Role| matches!(role, Role::Space(Measure::Cells | Measure::Unknowns));
        if let Some(at) = self.roles.iter().position(count) {
            return format!(
                "the mesh is known by `{}` alone: --dimension D says how h follows, h ~ {}^(-1/D)",
                self.name(at),
                self.name(at)
            );
        }
        "no column of sizes: --ratio 2 if each row halves the step, or a column h, k, n, level or steps".into()
    }

    /// The columns that tell tables apart: those asked for, those of words, and what explains a level that comes again.
    fn by(
        &mut self,
        columns: &Columns,
        sizes: &[Option<Size>; 2],
    ) -> Result<Vec<usize>, TableError> {
        let rows = &self.block.rows;
        let used: HashSet<usize> = sizes.iter().flatten().map(|size| size.at).collect();
        let cell = |row: usize, at: usize| rows[row].cells[at].as_str();
        let values = |at: usize| -> HashMap<&str, usize> {
            let mut found = HashMap::new();
            (0..rows.len()).for_each(|row| *found.entry(cell(row, at)).or_insert(0) += 1);
            found
        };
        // Each value has a table of its own.
        let parts = |at: usize| {
            let values = values(at);
            values.len() > 1 && values.values().all(|&count| count > 1) && !values.contains_key("")
        };
        let candidates: Vec<usize> = (0..self.roles.len())
            .filter(|at| !used.contains(at))
            .filter(|&at| match self.roles[at] {
                Role::Parameter => true,
                Role::Unknown => true,
                // A column called order may be that of the scheme: it is known for each row, a rate is not.
                Role::Ignored => is_rate(self.name(at)),
                _ => false,
            })
            .collect();
        let mut by: Vec<usize> = Vec::new();
        for asked in &self.reading.by {
            let names: Vec<&str> = self.block.names.iter().map(String::as_str).collect();
            by.extend(named(asked, &names).ok());
        }
        if by.is_empty() && !self.reading.runs {
            let words = |at: usize| rows.iter().all(|row| number(&row.cells[at]).is_none());
            let apart = |&at: &usize| {
                self.roles[at] == Role::Parameter && (words(at) || !self.left_out.contains(&at))
            };
            by = candidates.iter().copied().filter(apart).filter(|&at| parts(at)).collect();
        }
        let again = |by: &[usize]| -> Option<(usize, usize)> {
            let mut seen = HashMap::new();
            let step = |direction: usize, row: usize| {
                columns.steps[direction].as_ref().map_or(0, |steps| steps[row].to_bits())
            };
            let fixed: Vec<usize> =
                columns.scene.into_iter().chain(columns.norm).chain(by.iter().copied()).collect();
            let sized = |row: &usize| {
                let there = |steps: &Vec<f64>| !steps[*row].is_nan();
                columns.steps.iter().flatten().any(there)
            };
            (0..rows.len()).filter(sized).find_map(|row| {
                let cells: Vec<&str> = fixed.iter().map(|&at| cell(row, at)).collect();
                let before = seen.insert((step(0, row), step(1, row), cells), row)?;
                Some((before, row))
            })
        };
        if !columns.runs && again(&by).is_some() {
            let more = candidates.iter().copied().filter(|&at| parts(at) && !by.contains(&at));
            let more: Vec<usize> = more.collect();
            let with = |extra: &[usize]| [by.clone(), extra.to_vec()].concat();
            let one = more.iter().map(|&at| with(&[at])).find(|by| again(by).is_none());
            let two = || {
                let pairs = more.iter().flat_map(|&a| more.iter().map(move |&b| [a, b]));
                pairs.map(|pair| with(&pair)).find(|by| again(by).is_none())
            };
            match one.or_else(two) {
                Some(found) => by = found,
                None => {
                    let (first, second) = again(&by).unwrap_or_default();
                    let what = format!(
                        "the level of line {} comes again: --runs if these are runs of one level, --by COLUMN if a column tells tables apart",
                        rows[first].line
                    );
                    return Err(TableError::at(rows[second].line, what));
                }
            }
        }
        Ok(by)
    }

    fn said(&self, columns: &Columns, sizes: &[Option<Size>; 2]) -> String {
        let mut read = Vec::new();
        for (size, direction) in sizes.iter().zip(["h", "k"]) {
            read.extend(
                size.as_ref().map(|size| format!("{direction} from `{}`", self.name(size.at))),
            );
        }
        if read.is_empty() {
            let direction = if self.reading.in_time { "k" } else { "h" };
            read.push(format!("{direction} by --ratio {}", self.reading.ratio.unwrap_or(2.0)));
        }
        let what = if columns.quantity == Quantity::Value { "values" } else { "errors" };
        let names = columns.measured.iter().map(|m| m.norm.as_deref());
        let place = |role| self.roles.iter().position(|known| *known == role);
        let single = place(Role::Error).or(place(Role::Value));
        let single = single.map_or("error", |at| self.name(at));
        read.push(format!("{what} {}", listed(names.map(|name| name.unwrap_or(single)))));
        let mut parts =
            vec![format!("read {}: {}", counted(self.block.rows.len(), "row"), read.join(", "))];
        if !columns.by.is_empty() {
            let names = columns.by.iter().map(|&at| self.name(at));
            parts.push(format!("a table for each {}", listed(names)));
        }
        if columns.runs {
            parts.push("rows of one level are runs".into());
        }
        if !self.block.filled.is_empty() {
            parts.push(format!("empty cells of {} as those above", listed(&self.block.filled)));
        }
        parts.extend(self.notes.iter().cloned());
        let unread = |at: &usize| !columns.by.contains(at) && !self.name(*at).is_empty();
        let mut left: Vec<usize> = self.left_out.iter().copied().filter(unread).collect();
        let parameter = |at: &usize| matches!(self.roles[*at], Role::Parameter | Role::Run);
        left.extend((0..self.roles.len()).filter(parameter).filter(unread));
        left.sort_unstable();
        left.dedup();
        let mut left: Vec<String> = left.iter().map(|&at| self.name(at).to_owned()).collect();
        left.extend(self.block.repeated.clone());
        let mut out = Vec::new();
        if !left.is_empty() {
            out.push(listed(left));
        }
        if let Some(first) = self.block.left_out.first() {
            let more = self.block.left_out.len();
            out.push(if more > 1 {
                format!("{more} lines from line {first}")
            } else {
                format!("line {first}")
            });
        }
        if !out.is_empty() {
            parts.push(format!("left out: {}", out.join(", ")));
        }
        parts.join("; ")
    }
}
