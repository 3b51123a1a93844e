//! A report read back: one table and one figure of each kind, from the files alone, against the records and verdicts that
//! it was to show. The records are nearly powers, with another order than the predicted one, of a horizon that is not 1, so that
//! no two of the numbers shown are the same by chance.

use std::path::Path;

use judge::record::{CaseRecord, Key, NormError, Status, V_MAX};
use judge::verdict::{Decision, Prediction, Variable, Verdict, judge};
use report::{SceneSummary, write_all, write_junit};
use serde_json::Value;

use crate::catalogue::{Defect, Shown, through};

const HORIZON: f64 = 3.0;
const FINEST: [u32; 2] = [64, 32];
/// Errors above and below a power in turn, so that intervals are wide enough to be seen on a figure.
const SCATTER: f64 = 0.02;
/// The norm, whose colour is the first, and the variable of the one order in each scene, its true and its predicted value.
const SCENES: [(&str, &str, Variable, [f64; 2]); 3] = [
    ("in-space", V_MAX, Variable::H, [1.12, 1.0]),
    ("in-time", V_MAX, Variable::K, [1.9, 2.0]),
    ("refuted", V_MAX, Variable::H, [1.3, 2.0]),
];

/// What a report is given.
pub fn shown() -> Shown {
    let (mut records, mut verdicts) = (Vec::new(), Vec::new());
    for (name, norm, variable, [order, predicted]) in SCENES {
        let places = (0..4u32).map(|i| match variable {
            Variable::H => [8 << i, FINEST[1]],
            _ => [FINEST[0], 4 << i],
        });
        let of_scene: Vec<CaseRecord> = places
            .map(|[n, steps]| {
                let (h, k) = (1.0 / f64::from(n), HORIZON / f64::from(steps));
                let step = if variable == Variable::H { h } else { k };
                let scatter = if n.ilog2() % 2 == steps.ilog2() % 2 { SCATTER } else { -SCATTER };
                let error = 0.3 * step.powf(order) * (1.0 + scatter);
                let (error, floor) = (Some(error), Some(2e-5));
                CaseRecord {
                    h: Some(h),
                    dofs: u64::from(n * n),
                    status: Status::Converged,
                    errors: vec![NormError { norm: norm.into(), error, floor }],
                    ..CaseRecord::without_work(name, Some(n), steps, k)
                }
            })
            .collect();
        let keys: Vec<Key> = of_scene.iter().map(CaseRecord::key).collect();
        let prediction =
            Prediction { why: "a theorem".into(), ..Prediction::new(norm, variable, predicted) };
        verdicts.push(judge(name, &of_scene, &keys, &prediction, Decision::Pass));
        records.extend(of_scene);
    }
    (records, verdicts)
}

/// What the files of a report of these, through the hands of a defect, show otherwise: each file with the first such thing.
pub fn misread(defect: &Defect) -> Vec<(String, String)> {
    let sound = shown();
    let (process, thread) = (std::process::id(), std::thread::current().id());
    let dir = std::env::temp_dir().join(format!("gronwall-readback-{process}-{thread:?}"));
    let (records, verdicts) = through(&defect.shown, sound.clone());
    let scene = |name: &str| SceneSummary { name: name.into(), ..SceneSummary::default() };
    let scenes = SCENES.map(|(name, ..)| scene(name));
    let nothing = Value::Null;
    write_all(&dir, &scenes, &records, &verdicts, &nothing, None, None).expect("a report");
    write_junit(&dir.join("junit.xml"), &verdicts, &nothing, None).expect("JUnit");
    let read = read_back(&dir, &sound);
    std::fs::remove_dir_all(&dir).expect("the report");
    read
}

fn read_back(dir: &Path, (records, verdicts): &Shown) -> Vec<(String, String)> {
    let mut wrong = Vec::new();
    let mut read = |file: &str, check: &dyn Fn(&str) -> Result<(), String>| {
        let text = std::fs::read_to_string(dir.join(file)).map_err(|error| error.to_string());
        wrong.extend(text.and_then(|text| check(&text)).err().map(|what| (file.to_owned(), what)));
    };
    let json = |text: &str| serde_json::from_str::<Value>(text).map_err(|error| error.to_string());
    read("cases.csv", &|text| cases(text, records));
    read("verdict.json", &|text| answers(&json(text)?, verdicts));
    read("junit.xml", &|text| junit(text, verdicts));
    read("report.md", &|text| tables(&lines(text, '|'), verdicts));
    read("tables.tex", &|text| tables(&lines(text, '&'), verdicts));
    read("index.html", &|text| tables(&of_page(text), verdicts));
    read("report.json", &|text| {
        let mut rows = Vec::new();
        rows_of(&json(text)?, &mut rows);
        tables(&rows, verdicts)
    });
    for verdict in verdicts {
        let step = if verdict.variable == Variable::H { "h" } else { "k" };
        read(&format!("{}-{step}.svg", verdict.scene), &|text| convergence(text, verdict));
    }
    read("forest.svg", &|text| forest(text, verdicts));
    wrong
}

/// Rows of a table in lines, their cells apart by a sign.
fn lines(text: &str, between: char) -> Vec<Vec<String>> {
    let cells = |line: &str| -> Vec<String> {
        let line = line.trim().trim_matches('|').trim_end_matches("\\\\");
        let line = line.replace("{[}", "[").replace("{]}", "]").replace("$\\geq$", "≥");
        line.split(between).map(|cell| cell.replace('\\', "").trim().to_owned()).collect()
    };
    text.lines().map(cells).filter(|row| row.len() > 4).collect()
}

/// Rows of the tables of a page, without its tags.
fn of_page(text: &str) -> Vec<Vec<String>> {
    let words = |cell: &str| -> String {
        cell.split('<').map(|part| part.split_once('>').map_or(part, |(_, words)| words)).collect()
    };
    let cells = |row: &str| -> Vec<String> {
        let row = row.split("</tr>").next().unwrap_or_default();
        row.split("<td").skip(1).map(|cell| words(&format!("<td{cell}"))).collect()
    };
    let columns = |line: &str| -> Vec<String> {
        line.split("  ").map(str::trim).filter(|cell| !cell.is_empty()).map(str::to_owned).collect()
    };
    let evidence = text.split("<pre").skip(1).filter_map(|rest| rest.split("</pre>").next());
    let evidence = evidence.flat_map(|lines| lines.lines().map(columns));
    let rows = text.split("<tr").skip(1).map(cells);
    rows.chain(evidence).filter(|row| row.len() > 4).collect()
}

/// `found` is the number written, to `share` of itself.
fn agree(what: &str, found: f64, wanted: f64, share: f64) -> Result<(), String> {
    let off = (found - wanted).abs();
    match off <= share * wanted.abs() {
        true => Ok(()),
        false => Err(format!("{what} is {found}, recorded {wanted}")),
    }
}

fn number(text: &str) -> Option<f64> {
    let text = text.trim().trim_start_matches('≥').trim();
    if let Some((over, under)) = text.split_once('/') {
        return Some(number(over)? / number(under)?);
    }
    if let Some((digit, power)) =
        text.split_once("10").filter(|(_, power)| power.starts_with(is_raised))
    {
        let exponent: String = power.chars().filter_map(lowered).collect();
        let digit = digit.trim_end_matches('·');
        let digit = if digit.is_empty() { 1.0 } else { digit.parse().ok()? };
        return Some(digit * 10f64.powi(exponent.parse().ok()?));
    }
    text.parse().ok()
}

fn is_raised(c: char) -> bool {
    lowered(c).is_some()
}

fn lowered(c: char) -> Option<char> {
    "⁰¹²³⁴⁵⁶⁷⁸⁹⁻"
        .chars()
        .zip("0123456789-".chars())
        .find(|(raised, _)| *raised == c)
        .map(|(_, c)| c)
}

/// Every number of cases.csv, by the names of its columns.
fn cases(text: &str, records: &[CaseRecord]) -> Result<(), String> {
    let mut lines = text.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let head = lines.next().ok_or("cases.csv is empty")?;
    let at = |name: &str| head.iter().position(|column| *column == name).expect("a column");
    let lines: Vec<Vec<&str>> = lines.collect();
    if lines.len() != records.len() {
        return Err(format!("cases.csv has {} cases of {}", lines.len(), records.len()));
    }
    for record in records {
        let [n, steps] = [record.n.unwrap_or(0), record.steps].map(|count| count.to_string());
        let places = [("scene", &*record.scene), ("n", &*n), ("steps", &*steps)];
        let of_case =
            |line: &&Vec<&str>| places.iter().all(|(name, value)| line[at(name)] == *value);
        let line = lines.iter().find(of_case).ok_or_else(|| format!("no {places:?}"))?;
        let entry = &record.errors[0];
        for (name, value) in
            [("h", record.h), ("k", Some(record.k)), ("error", entry.error), ("floor", entry.floor)]
        {
            let found = line[at(name)].parse().unwrap_or(f64::NAN);
            agree(&format!("cases.csv: {name}"), found, value.expect("a number"), 0.0)?;
        }
        if line[at("norm")] != entry.norm {
            return Err(format!("cases.csv: {} for {}", line[at("norm")], entry.norm));
        }
    }
    Ok(())
}

fn answers(document: &Value, verdicts: &[Verdict]) -> Result<(), String> {
    let written = document["verdicts"].as_array().ok_or("verdict.json: no verdicts")?;
    for verdict in verdicts {
        let found = written.iter().find(|found| found["scene"] == *verdict.scene);
        let found = found.ok_or_else(|| format!("verdict.json: no {}", verdict.scene))?;
        let number = |value: &Value| value.as_f64().unwrap_or(f64::NAN);
        let [low, high] = verdict.interval.expect("an interval");
        for (name, found, wanted) in [
            ("predicted", &found["predicted"], verdict.predicted),
            ("observed", &found["observed"], verdict.observed.expect("an order")),
            ("interval", &found["interval"][0], low),
            ("interval", &found["interval"][1], high),
        ] {
            agree(&format!("verdict.json: {name}"), number(found), wanted, 1e-15)?;
        }
        if found["verdict"] != verdict.decision.name() || found["norm"] != *verdict.norm {
            return Err(format!("verdict.json: {} in {}", found["verdict"], found["norm"]));
        }
        for (i, used) in verdict.points_used.iter().enumerate() {
            let point = &found["points_used"][i];
            for (name, value) in
                [("h", used.point.h), ("k", used.point.k), ("error", used.point.error)]
            {
                agree(&format!("verdict.json: {name}"), number(&point[name]), value, 1e-15)?;
            }
        }
    }
    Ok(())
}

/// One test a verdict, which fails unless the verdict is as expected.
fn junit(text: &str, verdicts: &[Verdict]) -> Result<(), String> {
    for verdict in verdicts {
        let case = text
            .split("<testcase")
            .skip(1)
            .find(|case| case.contains(&format!("classname=\"{}\"", verdict.scene)));
        let case = case.ok_or_else(|| format!("junit.xml: no {}", verdict.scene))?;
        let failed = case.split("</testcase>").next().is_some_and(|case| case.contains("<failure"));
        let name = format!("\"{} in {}\"", verdict.norm, verdict.variable.name());
        if failed == verdict.as_expected() || !case.contains(&name) {
            return Err(format!(
                "junit.xml: {name} of {} with failure: {failed}: {case}",
                verdict.scene
            ));
        }
        let said = format!("observed {:.2}", verdict.observed.expect("an order"));
        if failed && !case.contains(&said) {
            return Err(format!("junit.xml: {} without {said}", verdict.scene));
        }
    }
    Ok(())
}

/// Every row of a document: lists of cells with a text each.
fn rows_of(value: &Value, rows: &mut Vec<Vec<String>>) {
    match value {
        Value::Array(list) => {
            let cell = |cell: &Value| cell["text"].as_str().map(str::to_owned);
            let cells: Option<Vec<String>> = list.iter().map(cell).collect();
            rows.extend(cells.filter(|cells| cells.len() > 4));
            list.iter().for_each(|value| rows_of(value, rows));
        }
        Value::Object(map) => map.values().for_each(|value| rows_of(value, rows)),
        _ => {}
    }
}

/// The table of verdicts and the tables of their points.
fn tables(rows: &[Vec<String>], verdicts: &[Verdict]) -> Result<(), String> {
    for verdict in verdicts {
        let is_of = |row: &&Vec<String>| {
            row[0].trim_start_matches('[').starts_with(&verdict.scene) && row.len() >= 6
        };
        let row = rows.iter().find(is_of).ok_or_else(|| format!("no row of {}", verdict.scene))?;
        let predicted = number(&row[3]).unwrap_or(f64::NAN);
        agree("the predicted order", predicted, verdict.predicted, 1e-12)?;
        let numbers = row[4].replace(['[', ']', ','], " ");
        let numbers: Vec<f64> = numbers.split_whitespace().filter_map(number).collect();
        let [low, high] = verdict.interval.expect("an interval");
        for (i, wanted) in [verdict.observed.expect("an order"), low, high].into_iter().enumerate()
        {
            // Two decimals.
            let found = numbers.get(i).copied().unwrap_or(f64::NAN);
            if (found - wanted).abs().is_nan() || (found - wanted).abs() > 0.005 + 1e-12 {
                return Err(format!("{} shows {found} for {wanted}", verdict.scene));
            }
        }
        if row[1] != verdict.norm || !row[5].contains(verdict.decision.name()) {
            return Err(format!("{}: {} is {}", verdict.scene, row[1], row[5]));
        }
        for used in &verdict.points_used {
            let counts =
                [used.place.n.unwrap_or(0), used.place.steps].map(|count| count.to_string());
            let error = used.point.error;
            let near = |text: &str, wanted: f64| {
                number(text).is_some_and(|found| (found - wanted).abs() <= 6e-4 * wanted)
            };
            let of_point = |row: &&Vec<String>| {
                row.len() == 8 && row[..2] == counts && near(&row[4], error) && row[7] == "used"
            };
            let row = rows.iter().find(of_point);
            let row = row.ok_or_else(|| format!("no point {counts:?} with the error {error:e}"))?;
            // Steps to four digits, errors and floors to four.
            if !(near(&row[2], used.point.h) && near(&row[3], used.point.k)) {
                return Err(format!("{counts:?} with h = {}, k = {}", row[2], row[3]));
            }
            if !near(&row[6], used.point.floor) {
                return Err(format!("{counts:?} with the floor {}", row[6]));
            }
        }
    }
    Ok(())
}

type Place = (f64, f64);

fn attribute<'a>(line: &'a str, name: &str) -> Option<&'a str> {
    let from = line.find(&format!(" {name}=\""))? + name.len() + 3;
    line[from..].split('"').next()
}

fn coordinates(text: &str) -> Vec<Place> {
    let numbers = text.split([' ', ',']).filter_map(|n| n.parse().ok()).collect::<Vec<f64>>();
    numbers.chunks_exact(2).map(|pair| (pair[0], pair[1])).collect()
}

/// The places of each piece of a path: M, and differences by l, h, v, a; z ends it.
fn pieces(data: &str) -> Vec<Vec<Place>> {
    let mut pieces: Vec<Vec<Place>> = Vec::new();
    let spelt = data.replace('-', " -");
    let starts: Vec<usize> =
        spelt.match_indices(char::is_alphabetic).map(|(at, _)| at).chain([spelt.len()]).collect();
    for ends in starts.windows(2) {
        let (letter, rest) = spelt[ends[0]..ends[1]].split_at(1);
        let numbers: Vec<f64> = rest.split_whitespace().filter_map(|n| n.parse().ok()).collect();
        let (x, y) = pieces.last().and_then(|piece| piece.last()).copied().unwrap_or_default();
        match (letter, &numbers[..]) {
            ("M", [x, y]) => pieces.push(vec![(*x, *y)]),
            ("h", [dx]) => pieces.last_mut().expect("M comes first").push((x + dx, y)),
            ("v", [dy]) => pieces.last_mut().expect("M comes first").push((x, y + dy)),
            ("l", [dx, dy]) | ("a", [.., dx, dy]) => {
                pieces.last_mut().expect("M comes first").push((x + dx, y + dy));
            }
            ("z", []) => {}
            _ => panic!("a path with {letter}{rest}: {data}"),
        }
    }
    pieces
}

/// Elements of a picture, a line each.
struct Picture<'a>(Vec<&'a str>);

impl<'a> Picture<'a> {
    fn of(svg: &'a str) -> Self {
        Self(svg.lines().collect())
    }

    fn texts(&self) -> impl Iterator<Item = (Place, &'a str)> {
        // Letters hang below the line that they are written for.
        let height = self.0.first().and_then(|head| attribute(head, "font-size")?.parse().ok());
        let below = (0.26 * height.unwrap_or(0.0f64)).round();
        self.0.iter().filter(|line| line.starts_with("<text")).filter_map(move |line| {
            let [x, y]: [f64; 2] =
                [attribute(line, "x")?.parse().ok()?, attribute(line, "y")?.parse().ok()?];
            let place = (x, y - below);
            Some((place, line.split('>').nth(1)?.trim_end_matches("</text")))
        })
    }

    /// Strokes of a colour, a width and dashes or none, filled with an ink or not, each as its places.
    fn paths(&self, colour: &str, width: &str, fill: &str, dashed: bool) -> Vec<Vec<Place>> {
        let drawn = self.0.iter().filter(|line| {
            line.starts_with("<path")
                && attribute(line, "stroke") == Some(colour)
                && attribute(line, "stroke-width").unwrap_or("4") == width
                && attribute(line, "fill") == Some(fill)
                && attribute(line, "stroke-dasharray").is_some() == dashed
        });
        drawn.filter_map(|line| attribute(line, "d")).flat_map(pieces).collect()
    }

    fn strokes(&self, colour: &str, width: &str) -> Vec<Vec<Place>> {
        self.paths(colour, width, "none", false)
    }
}

/// An axis from the words at its ticks: the place of a value, by its first and last label.
fn axis(ticks: &[(f64, f64)]) -> Result<impl Fn(f64) -> f64 + use<>, String> {
    let (first, last) = (ticks.first().ok_or("no tick")?, ticks.last().ok_or("no tick")?);
    let (a, b) = ((first.0, first.1.log10()), (last.0, last.1.log10()));
    let place = move |value: f64| a.0 + (value.log10() - a.1) / (b.1 - a.1) * (b.0 - a.0);
    match ticks.iter().find(|(at, value)| (place(*value) - at).abs() > 1.5) {
        Some((_, value)) => Err(format!("the tick {value} is out of place")),
        None => Ok(place),
    }
}

/// Pixels that a rounded place may be off.
const PIXEL: f64 = 1.5;
const BLUE: &str = "#0072B2";

/// Markers at the errors, the line through them, the floor, and the triangle of the predicted order.
fn convergence(svg: &str, verdict: &Verdict) -> Result<(), String> {
    let picture = Picture::of(svg);
    let lines = picture.strokes("#DEDEDE", "2");
    let upright = |x: f64| lines.iter().any(|line| line.iter().all(|place| place.0 == x));
    let level = |y: f64| lines.iter().any(|line| line.iter().all(|place| place.1 == y));
    let (mut along, mut up) = (Vec::new(), Vec::new());
    for ((x, y), words) in picture.texts() {
        let Some(value) = number(words) else { continue };
        if upright(x) {
            along.push((x, value));
        } else if level(y) {
            up.push((y, value));
        }
    }
    let (across, height) = (axis(&along)?, axis(&up)?);
    let step = |point: &judge::fit::Point| match verdict.variable {
        Variable::H => point.h,
        _ => point.k,
    };
    // Below the frame is the legend.
    let bottom = lines.iter().flatten().map(|place| place.1).fold(0.0, f64::max);
    let discs = picture.paths(BLUE, "22", "none", false);
    let markers: Vec<Place> =
        discs.iter().map(|disc| disc[0]).filter(|place| place.1 < bottom).collect();
    if markers.len() != verdict.points_used.len() {
        return Err(format!("{} markers of {} points", markers.len(), verdict.points_used.len()));
    }
    let mut floors = Vec::new();
    for used in &verdict.points_used {
        let place = (across(step(&used.point)), height(used.point.error));
        floors.push(height(used.point.floor));
        let there = |marker: &Place| {
            (marker.0 - place.0).abs() <= PIXEL && (marker.1 - place.1).abs() <= PIXEL
        };
        if !markers.iter().any(there) {
            return Err(format!("no marker at {place:?} of {:?}: {markers:?}", used.point));
        }
    }
    // Pixels per decade, and the slope of two places.
    let decade = [across(10.0) - across(1.0), height(10.0) - height(1.0)];
    let slope = |a: Place, b: Place| (b.1 - a.1) / decade[1] / ((b.0 - a.0) / decade[0]);
    let allowed =
        |a: Place, b: Place| 2.0 * PIXEL / decade[1].abs() / ((b.0 - a.0) / decade[0]).abs();
    let strokes = picture.strokes(BLUE, "4");
    let inside = |line: &&Vec<Place>| line.iter().all(|place| place.1 < bottom);
    let line = strokes.iter().filter(inside).find(|line| line.len() == verdict.points_used.len());
    let line = line.ok_or("no line through the points")?;
    let near = |a: &Place, b: &Place| (a.0 - b.0).abs() <= PIXEL && (a.1 - b.1).abs() <= PIXEL;
    if let Some(corner) = line.iter().find(|corner| !markers.iter().any(|at| near(corner, at))) {
        return Err(format!("the line has a corner at {corner:?}, no marker"));
    }
    let dashed = picture.paths(BLUE, "4", "none", true);
    let level: Vec<f64> = dashed.iter().filter(inside).flatten().map(|place| place.1).collect();
    let off = |y: &f64| floors.iter().all(|floor| (floor - y).abs() > PIXEL);
    if level.is_empty() || level.iter().any(off) {
        return Err(format!("the floor lies at {level:?} for {floors:?}"));
    }
    let triangles = picture.strokes(BLUE, "3");
    let triangle = triangles.iter().find(|line| line.len() == 4).ok_or("no triangle")?;
    let [fine, _, coarse, _] = triangle[..] else { return Err("no triangle".into()) };
    if (slope(fine, coarse) - verdict.predicted).abs() > allowed(fine, coarse) {
        return Err(format!("the triangle has the slope {:.3}", slope(fine, coarse)));
    }
    Ok(())
}

/// Squares at observed minus predicted order, with their intervals, beside the order predicted.
fn forest(svg: &str, verdicts: &[Verdict]) -> Result<(), String> {
    let picture = Picture::of(svg);
    let texts: Vec<(Place, &str)> = picture.texts().collect();
    for verdict in verdicts {
        let named = texts.iter().find(|(_, words)| *words == verdict.scene);
        let &((left, y), _) = named.ok_or_else(|| format!("no row of {}", verdict.scene))?;
        let in_column = |x: f64| x >= left && x < left + 850.0 - 4.0;
        let tick = |label: &str| {
            let ticks =
                texts.iter().filter(|((x, at), words)| *words == label && in_column(*x) && *at < y);
            ticks.map(|((x, _), _)| *x).next().ok_or_else(|| format!("no tick {label}"))
        };
        let (zero, one) = (tick("0")?, tick("+1")?);
        let place = |apart: f64| zero + apart.clamp(-1.25, 1.0) * (one - zero);
        let beside = texts.iter().filter(|((x, at), _)| *at == y && *x > one);
        let written = beside.filter_map(|(_, words)| number(words)).next();
        agree("the order beside a row", written.unwrap_or(f64::NAN), verdict.predicted, 1e-12)?;
        let boxes = picture.0.iter().filter(|line| line.starts_with("<polygon"));
        let centre = |line: &str| -> Option<Place> {
            let corners = coordinates(attribute(line, "points")?);
            let [a, b] = [corners.first()?, corners.get(2)?];
            (corners.len() == 4).then_some((0.5 * (a.0 + b.0), 0.5 * (a.1 + b.1)))
        };
        let of_row = |place: &Place| (place.1 - y).abs() <= 1.0 && in_column(place.0);
        let found = boxes.filter_map(|line| centre(line)).find(of_row).ok_or("no square")?;
        let apart = verdict.observed.ok_or("no order")? - verdict.predicted;
        if (found.0 - place(apart)).abs() > PIXEL {
            let shown = (found.0 - zero) / (one - zero);
            return Err(format!("{} is shown at {shown:+.2}, {apart:+.2} found", verdict.scene));
        }
        let strokes = [BLUE, "#D55E00"].map(|ink| picture.strokes(ink, "3")).concat();
        let bar = strokes.iter().find(|line| line.len() == 2 && line.iter().all(of_row));
        let bar = bar.ok_or("no interval")?;
        for (end, found) in verdict.interval.ok_or("no interval")?.into_iter().zip(bar) {
            if (found.0 - place(end - verdict.predicted)).abs() > PIXEL {
                return Err(format!("{}: an interval ends at {}", verdict.scene, found.0));
            }
        }
    }
    Ok(())
}
