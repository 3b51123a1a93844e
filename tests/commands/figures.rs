//! Figures as a reader has them: in print their words are large enough, and words stand neither on other words nor on
//! curves.

use std::path::{Path, PathBuf};

use report::{Axis, Chart, Datum, Part, Scale, Series};

/// A column of a paper, in points.
const COLUMN: f64 = 84.0 / 25.4 * 72.0;
/// Smaller words are not read in print. Indices are smaller than their words, as in any typesetting.
const LEAST: f64 = 7.0;

struct Words {
    text: String,
    size: f64,
    sides: [f64; 4],
}

/// A curve, or markers: points that are no farther than a unit from each other along lines, and half of the width.
struct Stroke {
    points: Vec<(f64, f64)>,
    half: f64,
}

struct Figure {
    size: [f64; 2],
    words: Vec<Words>,
    strokes: Vec<Stroke>,
}

fn attribute<'a>(element: &'a str, name: &str) -> Option<&'a str> {
    let head = element.split('>').next()?;
    let at = head.find(&format!(" {name}=\""))? + name.len() + 3;
    head[at..].split('"').next()
}

fn number(element: &str, name: &str) -> Option<f64> {
    attribute(element, name)?.parse().ok()
}

/// Width in text heights: that of DejaVu Sans by classes of letters.
fn advance(letter: char) -> f64 {
    match letter {
        'i' | 'j' | 'l' | 'I' | '.' | ',' | ':' | '\'' | '|' | ' ' => 0.3,
        'f' | 't' | 'r' | '(' | ')' | '[' | ']' | '-' | '⁻' | '²' | '¹' | '³' | '⁰'..='⁹' => {
            0.39
        }
        'm' | 'M' | 'W' => 0.9,
        _ => 0.61,
    }
}

/// The words of a text element and their width in units.
fn spelt(element: &str, size: f64) -> (String, f64) {
    let (mut text, mut width) = (String::new(), 0.0);
    let inside = element.split_once('>').map_or("", |(_, rest)| rest);
    for piece in inside.split("<tspan").flat_map(|piece| piece.split("</tspan>")) {
        let is_span = piece.starts_with(" dy=");
        let letters =
            if is_span { piece.split_once('>').map_or("", |(_, rest)| rest) } else { piece };
        let letters = letters.replace("</text>", "").replace("&lt;", "<").replace("&amp;", "&");
        let size = if is_span { number(piece, "font-size").unwrap_or(size) } else { size };
        width += size * letters.chars().map(advance).sum::<f64>();
        text += &letters;
    }
    (text, width)
}

fn words(element: &str, usual: f64) -> Words {
    let size = number(element, "font-size").unwrap_or(usual);
    let (x, y) = (number(element, "x").unwrap(), number(element, "y").unwrap());
    let (text, width) = spelt(element, size);
    let begin = match attribute(element, "text-anchor") {
        Some("middle") => -0.5 * width,
        Some("end") => -width,
        _ => 0.0,
    };
    let (above, below) = (-0.73 * size, 0.2 * size);
    let sides = match attribute(element, "transform") {
        // Read upwards.
        Some(_) => [x + above, y - begin - width, x + below, y - begin],
        None => [x + begin, y + above, x + begin + width, y + below],
    };
    Words { text, size, sides }
}

/// The places along the data of a path.
fn places(data: &str) -> Vec<(f64, f64)> {
    let (mut all, mut at, mut start) = (Vec::new(), (0.0, 0.0), (0.0, 0.0));
    let commands: Vec<usize> =
        data.char_indices().filter(|(_, c)| c.is_alphabetic()).map(|(i, _)| i).collect();
    for (i, &from) in commands.iter().enumerate() {
        let to = commands.get(i + 1).copied().unwrap_or(data.len());
        let spaced = data[from + 1..to].replace('-', " -");
        let n: Vec<f64> = spaced.split([' ', ',']).filter_map(|word| word.parse().ok()).collect();
        let (before, command) = (at, &data[from..=from]);
        at = match command {
            "M" | "L" => (n[0], n[1]),
            "l" => (at.0 + n[0], at.1 + n[1]),
            "h" => (at.0 + n[0], at.1),
            "v" => (at.0, at.1 + n[0]),
            // Half of a disc.
            "a" => (at.0 + n[5], at.1 + n[6]),
            "z" | "Z" => start,
            other => panic!("{other} in {data}"),
        };
        if command == "M" {
            start = at;
            all.push(at);
            continue;
        }
        let steps = (at.0 - before.0).hypot(at.1 - before.1).ceil().max(1.0);
        let along = |i: u32| f64::from(i) / steps;
        let between = (1..=steps as u32).map(along);
        all.extend(
            between.map(|s| (before.0 + s * (at.0 - before.0), before.1 + s * (at.1 - before.1))),
        );
    }
    all
}

fn figure(svg: &str) -> Figure {
    let root = svg.lines().next().unwrap();
    let usual = number(root, "font-size").unwrap();
    let view: Vec<f64> =
        attribute(root, "viewBox").unwrap().split(' ').map(|n| n.parse().unwrap()).collect();
    let (mut of_words, mut strokes) = (Vec::new(), Vec::new());
    for element in svg.lines() {
        if element.starts_with("<text ") {
            of_words.push(words(element, usual));
        }
        let width = number(element, "stroke-width").unwrap_or(4.0);
        // The grid and thin lines of a mesh may pass below words.
        let is_drawn = width > 2.0 && attribute(element, "stroke") != Some("#DEDEDE");
        if element.starts_with("<path fill=") && is_drawn && !element.contains("url(") {
            let (mut points, half) = (places(attribute(element, "d").unwrap()), 0.5 * width);
            // A line ends at its last point, whatever its width.
            if let (&[first, .., last], None) = (&points[..], attribute(element, "stroke-linecap"))
            {
                let far = |(x, y): (f64, f64), at: (f64, f64)| (x - at.0).hypot(y - at.1) >= half;
                points.retain(|&place| far(place, first) && far(place, last));
            }
            strokes.push(Stroke { points, half });
        }
    }
    Figure { size: [view[2], view[3]], words: of_words, strokes }
}

impl Figure {
    /// What a reader cannot read: words on words, on a curve, or outside of the picture.
    fn faults(&self) -> Vec<String> {
        let mut faults = Vec::new();
        for (i, Words { text, sides, .. }) in self.words.iter().enumerate() {
            let [left, top, right, bottom] = *sides;
            for other in &self.words[..i] {
                let [from, above, to, below] = other.sides;
                if left < to && from < right && top < below && above < bottom {
                    faults.push(format!("{text:?} on {:?}", other.text));
                }
            }
            let on = |Stroke { points, half }: &Stroke| {
                points.iter().any(|&(x, y)| {
                    x > left - half && x < right + half && y > top - half && y < bottom + half
                })
            };
            if self.strokes.iter().any(on) {
                faults.push(format!("{text:?} on a curve"));
            }
            // Letters are narrower in most faces: a little beyond the edge is within it.
            if left < -2.0 || right > self.size[0] + 2.0 || top < 0.0 || bottom > self.size[1] {
                faults.push(format!("{text:?} beyond the edge"));
            }
        }
        faults
    }

    /// Points of the smallest words where the picture is so many columns wide.
    fn printed(&self, columns: f64) -> f64 {
        let smallest = self.words.iter().map(|words| words.size).fold(f64::INFINITY, f64::min);
        smallest / self.size[0] * COLUMN * columns
    }
}

/// Every picture of the repository.
fn shipped() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut found = vec![root.join("docs/extremes.svg")];
    for folder in ["docs/scenes", "reports/reference"] {
        let entries = std::fs::read_dir(root.join(folder)).expect(folder);
        found.extend(entries.map(|entry| entry.unwrap().path()));
    }
    found.retain(|path| path.extension().is_some_and(|end| end == "svg"));
    found.sort();
    found
}

#[test]
fn shipped_figures_can_be_read_in_print() {
    let all = shipped();
    assert!(all.len() > 150, "{}", all.len());
    let mut faults = Vec::new();
    for path in all {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let figure = figure(&std::fs::read_to_string(&path).unwrap());
        // The forest plot has two columns, of a page.
        let printed = figure.printed(if name == "forest.svg" { 2.0 } else { 1.0 });
        if printed < LEAST {
            faults.push(format!("{name}: {printed:.1} pt"));
        }
        faults.extend(figure.faults().iter().map(|fault| format!("{name}: {fault}")));
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// Runs that lie close together, as in a trade: those of one mesh have one error, and those of the front cost alike.
fn crowded() -> Chart {
    let (x, y) = (Axis::new("CPU time in seconds", Scale::Log), Axis::new("error", Scale::Log));
    let runs = |error: f64, seconds: &[f64]| seconds.iter().map(|s| (*s, error)).collect();
    let front: Vec<Datum> = vec![
        (0.0037, 0.0155),
        (0.0105, 0.0058),
        (0.031, 0.00575),
        (0.035, 0.00185),
        (0.126, 0.00123),
        (0.222, 0.00084),
        (0.37, 0.0008),
        (0.38, 0.00079),
    ];
    let label =
        |(i, at): (usize, &Datum)| (*at, format!("n = {}, N = {}", 4 << (i / 2), 4 << (i % 2)));
    let labels = front.iter().enumerate().map(label).collect();
    let series = vec![
        Series::new("as written", vec![Part::Points(runs(0.0064, &[0.13, 0.25, 0.33]))]),
        Series::new("element P2", vec![Part::Points(front.clone())]),
        Series::new("others", vec![Part::Points(runs(0.0022, &[0.046, 0.08]))]),
        Series { grey: true, ..Series::new("Pareto front", vec![Part::Dashed(front)]) },
    ];
    let target = report::Mark { at: 0.0024, label: "target 0.0024".into() };
    let question =
        "The error reached in a given CPU time, in runs from few cells and steps to many.";
    Chart {
        series,
        labels,
        horizontals: vec![target],
        ..Chart::new("crowded: speed against accuracy", question, x, y)
    }
}

#[test]
fn labels_of_crowded_runs_stand_clear() {
    let chart = crowded();
    let svg = chart.svg().unwrap();
    let figure = figure(&svg);
    assert_eq!(figure.faults(), Vec::<String>::new());
    assert!(figure.printed(1.0) >= LEAST);
    let drawn = figure.words.iter().filter(|words| words.text.starts_with("n = ")).count();
    assert!((4..=chart.labels.len()).contains(&drawn), "{drawn}");
}

/// A curve that coincides with another, and one without any value.
#[test]
fn a_legend_names_what_is_drawn() {
    let line = |f: fn(f64) -> f64| (1..9).map(|k| (f64::from(k), f(f64::from(k)))).collect();
    let axis = |name: &str| Axis::new(name, Scale::Log);
    let mut chart = Chart::new("", "", axis("k"), axis("factor"));
    chart.series = vec![
        Series::new("dotted", vec![Part::Dotted(line(|k| k))]),
        Series::new("whole", vec![Part::Line(line(|k| k))]),
        Series::new("nowhere", vec![Part::Line(line(|_| f64::NAN))]),
    ];
    let svg = chart.svg().unwrap();
    assert!(!svg.contains("nowhere"));
    let at = |dashed: bool| {
        let curve = |line: &&str| {
            line.starts_with("<path")
                && line.contains("dasharray=\"4") == dashed
                && line.contains("#0072B2") == dashed
                && line.contains(if dashed { "#0072B2" } else { "#D55E00" })
        };
        svg.lines().position(|line| curve(&line)).expect("a curve")
    };
    assert!(at(false) < at(true), "the dotted line is seen on the whole one");
}

/// What the checks find: words on a curve, on words, beyond the edge, and small print.
#[test]
fn faults_of_figures_are_seen() {
    let svg = "<svg font-size=\"20\" viewBox=\"0 0 1000 100\">\n\
        <path fill=\"none\" stroke=\"#0072B2\" d=\"M0 50l1000 10\"/>\n\
        <text x=\"10\" y=\"55\">0.505</text>\n<text x=\"500\" y=\"30\">n = 8</text>\n\
        <text x=\"530\" y=\"35\">n = 16</text>\n<text x=\"980\" y=\"95\">outside</text>\n</svg>\n";
    let figure = figure(svg);
    let faults = ["\"0.505\" on a curve", "\"n = 16\" on \"n = 8\"", "\"outside\" beyond the edge"];
    assert_eq!(figure.faults(), faults);
    assert!(figure.printed(1.0) < LEAST);
}
