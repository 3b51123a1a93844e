//! Charts: axes, marks, gaps, and triangles that stand clear.

use super::*;

fn chart(x: Scale, y: Scale) -> Chart {
    Chart::new("a < b", "Is it?", Axis::new("k", x), Axis::new("factor", y))
}

fn svg(chart: &Chart) -> String {
    let svg = chart.svg().unwrap();
    assert_eq!(svg, chart.svg().unwrap());
    svg
}

/// Envelopes over t_n with a floor of zero at the start, and factors over k with thresholds.
fn envelope() -> Chart {
    let times = || (0..=16).map(|n| f64::from(n) / 16.0);
    let line = |f: fn(f64) -> f64| times().map(|t| (t, f(t))).collect::<Vec<Datum>>();
    let mut chart = chart(Scale::Linear, Scale::Log);
    chart.series = vec![
        Series::new("closed form", vec![Part::Dashed(line(|t| 3e-3 * (2.0 * t).exp()))]),
        Series::new("envelope", vec![Part::Line(line(|t| 1e-3 * t.exp() * t))]),
        Series::new("measured", vec![Part::Points(line(|t| 1e-4 * t * t))]),
    ];
    chart.verticals = vec![mark(0.4, "threshold of Λ"), mark(0.41, "(3.4)")];
    chart.horizontals = vec![mark(1e-2, "the target"), mark(f64::INFINITY, "no bound")];
    chart.note = "n ≥ 1: e_0 = 0".into();
    chart
}

fn mark(at: f64, label: &str) -> Mark {
    Mark { at, label: label.into() }
}

#[test]
fn words_and_letters_are_there() {
    let svg = svg(&envelope());
    for words in ["a &lt; b", "closed form", "a: threshold of Λ", "b: (3.4)", "c: the target"] {
        assert!(svg.contains(words), "{words}");
    }
    // A threshold without a place has only its words.
    assert!(svg.contains("no bound") && !svg.contains("d: no bound"));
}

#[test]
fn letters_of_near_marks_stand_apart() {
    let chart = envelope();
    let frame = Frame::new(&chart, &[]).unwrap();
    let near = (frame.across(0.4) - frame.across(0.41)).abs();
    assert!(near < 15.0, "{near}");
    // Letters are separate text elements: their x are in the SVG.
    let svg = svg(&chart);
    let x = |letter: &str| -> f64 {
        let at = svg.find(&format!(">{letter}</text>")).expect(letter);
        let start = svg[..at].rfind(" x=\"").unwrap() + 4;
        svg[start..].split('"').next().unwrap().parse().unwrap()
    };
    assert!(x("b") - x("a") >= 30.0, "{} {}", x("a"), x("b"));
}

#[test]
fn a_line_is_interrupted_where_a_point_has_no_place() {
    let runs = |y: f64, scale: Scale| {
        let mut chart = chart(Scale::Linear, scale);
        let part = Part::Line(vec![(0.0, 1.0), (1.0, 2.0), (2.0, y), (3.0, 4.0)]);
        chart.series = vec![Series::new("", vec![part.clone()])];
        let frame = Frame::new(&chart, &[]).unwrap();
        chart.runs(&frame, &part).iter().map(Vec::len).collect::<Vec<_>>()
    };
    assert_eq!(runs(3.0, Scale::Log), [4]);
    assert_eq!(runs(f64::NAN, Scale::Log), [2, 1]);
    assert_eq!(runs(0.0, Scale::Log), [2, 1]);
    assert_eq!(runs(0.0, Scale::Linear), [4]);
}

/// The centre of a fitted line is not a step.
#[test]
fn steps_are_those_of_the_markers() {
    let mut chart = chart(Scale::Steps, Scale::Log);
    let line = Part::Line(vec![(0.125, 1.0), (0.2, 2.0), (0.5, 3.0)]);
    let points = Part::Points(vec![(0.125, 1.0), (0.5, 3.0)]);
    chart.series = vec![Series::new("fitted", vec![line.clone(), points])];
    assert!(!svg(&chart).contains("1/5") && svg(&chart).contains("1/8"));
    chart.series[0].parts = vec![line];
    assert!(svg(&chart).contains("1/5"));
}

#[test]
fn nothing_with_a_place_is_no_picture() {
    let mut chart = chart(Scale::Log, Scale::Log);
    chart.verticals = vec![mark(0.5, "alone")];
    assert!(chart.svg().is_none());
    let part = Part::Points(vec![(0.0, 1.0), (1.0, 0.0), (f64::NAN, 1.0), (1.0, f64::INFINITY)]);
    chart.series = vec![Series::new("nowhere", vec![part])];
    assert!(chart.svg().is_none());
}

/// Seven parallel lines of order 2, near each other, each with its triangle.
fn packed() -> Chart {
    let steps: Vec<f64> = (3..9).rev().map(|m| 0.5f64.powi(m)).collect();
    let mut chart = chart(Scale::Steps, Scale::Log);
    for i in 0..7 {
        let along: Vec<Datum> = steps.iter().map(|k| (*k, 0.6f64.powi(i) * k * k)).collect();
        let parts = vec![Part::Line(along.clone()), Part::Points(along.clone())];
        let slope = Some(Slope { order: 2.0, label: "2".into(), along });
        chart.series.push(Series { slope, ..Series::new(format!("{i}"), parts) });
    }
    chart
}

/// Points of the lines of a chart inside a triangle, by coordinates.
fn hits(chart: &Chart, frame: &Frame, [fine, corner, coarse]: [CanvasPoint; 3]) -> usize {
    let lines = chart.series.iter().flat_map(|series| chart.runs(frame, &series.parts[0]));
    let samples = lines.flat_map(|line| {
        let pairs: Vec<[CanvasPoint; 2]> = line.windows(2).map(|pair| [pair[0], pair[1]]).collect();
        pairs.into_iter().flat_map(|[a, b]| {
            (0..=100).map(move |i| {
                let s = f64::from(i) / 100.0;
                (a.0 + s * (b.0 - a.0), a.1 + s * (b.1 - a.1))
            })
        })
    });
    samples
        .filter(|(x, y)| {
            let share = (x - fine.0) / (corner.0 - fine.0);
            let edge = fine.1 + share * (coarse.1 - fine.1);
            (0.0..=1.0).contains(&share) && (edge..=corner.1).contains(y)
        })
        .count()
}

#[test]
fn triangles_stand_clear_of_every_line() {
    let chart = packed();
    let (frame, placed) = chart.arranged().unwrap();
    assert_eq!(placed.len(), 7);
    for slope in &placed {
        assert_eq!(hits(&chart, &frame, slope.corners), 0);
    }
    // The count detects a triangle directly below its line, which meets the next line.
    let [fine, coarse] = [(0.5f64.powi(8), 0.7), (0.5f64.powi(7), 0.7)]
        .map(|(k, below)| frame.place((k, below * k * k)));
    assert!(hits(&chart, &frame, [fine, (coarse.0, fine.1), coarse]) > 0);
}

#[test]
fn a_linear_axis_has_no_triangle() {
    let mut chart = packed();
    chart.y.scale = Scale::Linear;
    assert!(chart.arranged().unwrap().1.is_empty());
    assert!(!svg(&chart).contains("triangle"));
}
