//! The columns of a block: sizes, errors, and what tells tables apart.

use std::collections::{HashMap, HashSet};

use super::cell::{
    Comma, Measure, Number, Role, is_missing, is_missing_or_zero, is_of_solution, is_rate,
    likeness, named, number, role, says_error,
};
use super::guess::{
    approach_a_limit, are_orders, by_deviation, by_numbers, by_powers, by_values, confirm,
    hardly_changes, is_rounding, of_errors, rates_of_norms,
};
use super::line::{Block, Cells, evenly, is_computed, listed};
use super::{Quantity, Reading, TableError};
use files::counted;

/// More columns are no table of a study.
const MOST_COLUMNS: usize = 1000;

/// Words of a column that marks rows.
const FLAGS: &str = "true false yes no pass passed fail failed ok";

/// A number of a cell; none where it is missing.
pub(super) type Entries = Vec<Option<f64>>;

#[derive(Debug, Clone)]
pub(super) struct Size {
    pub(super) at: usize,
    pub(super) measure: Measure,
    /// NaN where it is missing.
    pub(super) steps: Vec<f64>,
}

pub(super) struct Measured {
    pub(super) at: usize,
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
    /// Rows that stand above already, with the same sizes and errors.
    pub(super) again: HashSet<usize>,
    pub(super) runs: bool,
    pub(super) ratio: Option<f64>,
    /// What was read and what was not.
    pub(super) said: String,
}

pub(super) struct Reader<'a> {
    pub(super) block: &'a Block,
    reading: &'a Reading,
    /// As the caller or the table says.
    pub(super) dimension: Option<u32>,
    pub(super) ratio: Option<f64>,
    pub(super) roles: Vec<Role>,
    /// Whether a cell of the table has a comma that can be a decimal one alone.
    decimal: bool,
    pub(super) left_out: Vec<usize>,
    pub(super) notes: Vec<String>,
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
                let whole = row.cells.iter().all(|cell| !cell.contains('.'));
                let hint = match whole && row.cells.len() == 2 * names.len() {
                    true => "; decimal commas are written as points, or cells parted by `;`",
                    false => ": name each column, or take out what is no row",
                };
                let what = format!("{found}, the header has {}{hint}", names.len());
                return Err(TableError::at(row.line, what));
            }
        }
        let mut reader = Reader::of(block, reading)?;
        let (measured, quantity) = reader.measured()?;
        if quantity == Quantity::Error {
            reader.imply(&measured);
        }
        let runs = reading.runs || reader.roles.contains(&Role::Run);
        let mut sizes = [reader.size(false)?, reader.size(true)?];
        reader.drop_level(&mut sizes);
        reader.drop_steps(&mut sizes);
        if let Some(measured) = measured.iter().find(|m| are_orders(&block.title, &m.entries)) {
            let name = measured.norm.as_deref().unwrap_or("error");
            let title = &block.title;
            return fail(format!(
                "`{name}` seems to hold orders, not errors: `{title}` stands above"
            ));
        }
        for size in sizes.iter_mut().flatten() {
            reader.count_cells(size);
            let from_the_finest = size.measure == Measure::Level
                && size.steps.len() > 2
                && size.steps.windows(2).all(|pair| pair[1] > pair[0])
                && measured.iter().all(|m| m.entries.windows(2).all(|pair| pair[1] < pair[0]));
            if from_the_finest {
                let name = &names[size.at];
                return fail(format!(
                    "the errors fall where the level `{name}` falls: does it count from the finest mesh? Write h, or levels of refinement"
                ));
            }
            if quantity != Quantity::Error || !reader.counts(size, &measured) {
                continue;
            }
            let name = &names[size.at];
            // 1, 2, 3 may be row numbers, levels or degrees; a count has no point.
            let pointed = block.rows.iter().any(|row| row.cells[size.at].contains('.'));
            if pointed || evenly(&size.steps) {
                return fail(format!(
                    "`{name}` is whole and the errors fall where it grows: is it a count? Call it `n` if it counts cells along a side, `steps` if it counts steps"
                ));
            }
            reader.notes.push(format!("`{name}` counts: the errors fall where it grows"));
            size.steps.iter_mut().for_each(|step| *step = step.recip());
        }
        if let ([Some(size), None] | [None, Some(size)], Quantity::Error) = (&sizes, quantity) {
            reader.compare_rates(&measured, size);
        }
        if sizes.iter().all(Option::is_none) && reader.ratio.is_none() {
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
            again: HashSet::new(),
            runs,
            ratio: reader.ratio,
            said: String::new(),
        };
        if !runs {
            columns.again = reader.again(&columns, &sizes);
        }
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
        if reading.ratio.is_none() {
            by_values(block, &mut roles, &mut notes);
        }
        by_deviation(block, &mut roles, &mut notes);
        let counted = by_numbers(block, reading, &mut roles, &mut notes);
        // What a rate follows is an error, whatever its name; of several such the caller may name some. What is computed from another
        // column is a rate, whatever its name.
        for at in 1..roles.len() {
            let open =
                |from: &usize| matches!(roles[*from], Role::Unknown | Role::Wide | Role::Error);
            // A rate behind an error is that of no other column.
            let behind = is_rate(names[at]) && matches!(roles[at - 1], Role::Wide | Role::Error);
            let open = |from: &usize| open(from) && !(behind && roles[*from] == Role::Unknown);
            let computed =
                (0..at).rev().filter(open).find(|&from| is_computed(&block.rows, at, from));
            let begins = is_missing_or_zero(&block.rows[0].cells[at]);
            let sized = |of: usize| roles[of].size().is_some();
            // Of `N`, `h` and its rate `h` is the height of water.
            let field = match roles[at - 1] {
                Role::Space(Measure::Length) | Role::Time(Measure::Length) | Role::Sigma => {
                    begins && (0..at - 1).any(sized)
                }
                Role::Unknown => true,
                _ => false,
            };
            let named = is_rate(names[at]) && field;
            let Some(from) = computed.or(named.then_some(at - 1)) else { continue };
            if (roles[from] == Role::Unknown || named && from == at - 1 && field)
                && reading.errors.is_empty()
            {
                roles[from] = Role::Wide;
            }
            if computed.is_some()
                && matches!(roles[at], Role::Unknown | Role::Wide | Role::Parameter)
            {
                roles[at] = Role::Ignored;
            }
        }
        if reading.errors.is_empty() {
            rates_of_norms(block, &mut roles);
        }
        // `Error (scheme)` and `Error (other scheme)` are two.
        let errors = |roles: &[Role]| {
            (0..names.len()).filter(|&at| roles[at] == Role::Error).collect::<Vec<_>>()
        };
        let several = errors(&roles);
        let distinct = |&at: &usize| {
            names[at].contains('(')
                && several.iter().filter(|&&other| names[other] == names[at]).count() == 1
        };
        if several.len() > 1 && several.iter().all(distinct) {
            several.iter().for_each(|&at| roles[at] = Role::Wide);
        }
        // Beside a size that no name says they would be guesses upon a guess.
        let named = roles.iter().any(|role| measures.contains(role));
        if reading.errors.is_empty() && (counted.is_none() || named) {
            by_powers(block, named, &mut roles, &mut notes);
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
        let sized = |role: &&Role| role.size().is_some();
        let alone = roles.iter().filter(sized).count() == 1;
        for (at, role) in roles.iter_mut().enumerate() {
            let words =
                |row: &Cells| is_missing(&row.cells[at]) || number(&row.cells[at]).is_none();
            let number_wanted = matches!(
                role,
                Role::Wide | Role::Unknown | Role::Ignored | Role::Space(_) | Role::Time(_)
            );
            // `T/10` is a step that is not read.
            let step = matches!(role, Role::Space(Measure::Length) | Role::Time(Measure::Length));
            let digits = |row: &Cells| row.cells[at].contains(|c: char| c.is_ascii_digit());
            let unread = step && alone && block.rows.iter().any(digits);
            if number_wanted && !unread && block.rows.iter().all(words) {
                let any = block.rows.iter().any(|row| !is_missing(&row.cells[at]));
                *role = if any { Role::Parameter } else { Role::Ignored };
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
        let Reading { dimension, ratio, .. } = *reading;
        let left_out = Vec::new();
        Ok(Self { block, reading, dimension, ratio, roles, decimal, left_out, notes })
    }

    pub(super) fn name(&self, at: usize) -> &str {
        self.block.name(at)
    }

    /// The numbers of a column; `whole` are counts, in which `2,312` can be no fraction.
    pub(super) fn column(&self, at: usize, whole: bool) -> Result<Entries, TableError> {
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
                .map(|at| self.block.names[at].as_str())
                // What ends with a colon is prose above the rows, and `r` is a rate.
                .filter(|name| !name.is_empty() && !name.ends_with(':') && *name != "r")
                .collect();
            let repeated = self.block.repeated.first();
            return fail(match (columns.first(), repeated) {
                (_, Some(name)) => format!(
                    "`{name}` comes several times between two sizes: which of them is the error of the level?"
                ),
                (Some(first), _) => {
                    let falls = columns[1..].iter().find(|name| self.falls(name));
                    let first = falls.unwrap_or(first);
                    if first.to_lowercase().starts_with("log") {
                        return fail(format!("`{first}` holds logarithms: give the errors"));
                    }
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
            // A signed difference is as large an error as it is off zero.
            let mut signs = entries.iter().flatten();
            let (below, above) =
                (signs.clone().any(|error| *error < 0.0), signs.any(|error| *error > 0.0));
            let signed = below && !own && quantity == Quantity::Error;
            if signed {
                let signs = if above { "has both signs" } else { "is negative" };
                let note = format!("`{}` {signs} and is read by magnitude", self.name(at));
                self.notes.push(note);
            }
            let norm = (!one).then(|| self.name(at).to_owned());
            measured.push(Measured { at, norm, entries, signed });
        }
        Ok((measured, quantity))
    }

    /// Of columns of errors by their names, those whose numbers are no values of a quantity that converges: a largest
    /// stress may be a value or an error.
    fn no_values(&self, wide: &[usize]) -> Result<Vec<usize>, TableError> {
        let asked = |name: &str| self.reading.errors.iter().any(|asked| likeness(asked, name) > 0);
        // Beside errors an energy that hardly changes is a value.
        let beside = wide.iter().any(|&at| says_error(self.name(at)));
        let is_value = |at: &usize| {
            let name = self.name(*at);
            let entries =
                || self.column(*at, false).ok()?.into_iter().collect::<Option<Vec<f64>>>();
            // So is a norm of no difference that is rounding throughout.
            let bare = name.contains('|') && !name.contains(['-', '\u{2212}']);
            let value = || !says_error(name) || is_of_solution(name);
            entries().filter(|_| !asked(name)).is_some_and(|e| {
                value() && (approach_a_limit(&e) || beside && hardly_changes(&e))
                    || beside && bare && is_rounding(&e)
            })
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
                let (one, other, a, b) = (self.name(before), self.name(at), before + 1, at + 1);
                let what = format!(
                    "a column stands twice: `{one}` is column {a}, `{other}` column {b}; leave one of them out, or give it another name"
                );
                return Err(TableError::at(self.block.line, what));
            }
        }
        Ok(())
    }

    /// Rows that stand twice: their sizes, errors, words and parameters are those of a row above.
    fn again(&self, columns: &Columns, sizes: &[Option<Size>; 2]) -> HashSet<usize> {
        let read = |at: &usize| {
            sizes.iter().flatten().any(|size| size.at == *at)
                || columns.measured.iter().any(|measured| measured.at == *at)
                || matches!(
                    self.roles[*at],
                    Role::Scene | Role::Norm | Role::Parameter | Role::Status
                )
                || self.block.rows.iter().all(|row| number(&row.cells[*at]).is_none())
        };
        let places: Vec<usize> = (0..self.roles.len()).filter(read).collect();
        let mut seen = HashSet::new();
        let again = |row: &usize| {
            let cells = |at: &usize| self.block.rows[*row].cells[*at].as_str();
            let sized = columns.steps.iter().flatten().any(|steps| steps[*row].is_finite());
            !seen.insert(places.iter().map(cells).collect::<Vec<_>>()) && sized
        };
        (0..self.block.rows.len()).filter(again).collect()
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
            let flags = |at: usize| {
                let flag =
                    |row: &Cells| FLAGS.split(' ').any(|f| row.cells[at].eq_ignore_ascii_case(f));
                rows.iter().all(flag)
            };
            let apart = |&at: &usize| {
                self.roles[at] == Role::Parameter
                    && !flags(at)
                    && (words(at) || !self.left_out.contains(&at))
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
                !columns.again.contains(row) && columns.steps.iter().flatten().any(there)
            };
            (0..rows.len()).filter(sized).find_map(|row| {
                let cells: Vec<&str> = fixed.iter().map(|&at| cell(row, at)).collect();
                let before = seen.insert((step(0, row), step(1, row), cells), row)?;
                Some((before, row))
            })
        };
        // Sizes in one direction that turn back are those of several ladders.
        let turns = |by: &[usize]| {
            let ([Some(steps), None] | [None, Some(steps)]) = &columns.steps else { return false };
            let mut ladders: HashMap<Vec<&str>, Vec<f64>> = HashMap::new();
            for row in (0..rows.len()).filter(|row| !columns.again.contains(row)) {
                let cells = by.iter().map(|&at| cell(row, at)).collect();
                ladders.entry(cells).or_default().push(steps[row]);
            }
            let back = |three: &[f64]| (three[1] - three[0]) * (three[2] - three[1]) < 0.0;
            ladders.values().any(|steps| steps.windows(3).any(back))
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
        if !columns.runs && self.reading.by.is_empty() && turns(&by) {
            let long = |at: usize| parts(at) && values(at).values().all(|&count| count > 2);
            let more = candidates.iter().filter(|&&at| long(at) && !by.contains(&at));
            let mut with = more.map(|&at| [by.clone(), vec![at]].concat());
            let found = with.find(|by| again(by).is_none() && !turns(by));
            by = found.unwrap_or(by);
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
            let how = if self.reading.ratio.is_some() { "--ratio" } else { "a factor of" };
            read.push(format!("{direction} by {how} {}", self.ratio.unwrap_or(2.0)));
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
        if let Some(first) = columns.again.iter().min() {
            let (count, line) = (counted(columns.again.len(), "row"), self.block.rows[*first].line);
            parts.push(format!("{count} from line {line} as above, read once"));
        }
        parts.extend(self.block.notes.iter().chain(&self.notes).cloned());
        let unread = |at: &usize| !columns.by.contains(at) && !self.block.names[*at].is_empty();
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
            out.push(match self.block.left_out.len() {
                1 => format!("line {first}"),
                more => format!("{more} lines from line {first}"),
            });
        }
        if !out.is_empty() {
            parts.push(format!("left out: {}", out.join(", ")));
        }
        parts.join("; ")
    }
}
