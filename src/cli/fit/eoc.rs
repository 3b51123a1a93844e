//! Error tables with orders, as in papers: h, then error and EOC of each norm.

use super::super::CliError;
use files::digits;
use judge::fit::{Direction, Point, Triple, ValueSample, path, plain, same_level, screen};
use judge::table::{Group, Quantity};
use report::{Axis, Chart, Datum, Part, Scale, Series, Slope};

/// The order of a group in a direction, and its interval.
pub(super) type Fitted<'f> = dyn Fn(&Group, Direction) -> Option<[f64; 3]> + 'f;

#[derive(Clone, Copy)]
pub(super) enum Style<'f> {
    Text,
    Markdown,
    /// With the orders that stand below.
    Latex(&'f Fitted<'f>),
}

/// A table for each scene and refined direction; for a grid its longest line.
pub(super) fn tables(groups: &[Group], style: Style<'_>) -> Vec<String> {
    let mut scenes: Vec<&Option<String>> = groups.iter().map(|group| &group.scene).collect();
    scenes.dedup();
    // Norms side by side that fit a terminal of 100 columns.
    let norms = if matches!(style, Style::Text) { 4 } else { usize::MAX };
    let mut texts = Vec::new();
    for scene in scenes {
        for direction in Direction::BOTH {
            let belongs = |group: &&Group| {
                let second = direction == Direction::Time && path(&group.points()).is_some();
                group.scene == *scene && group.refined(direction) && !second
            };
            let shown: Vec<&Group> = groups.iter().filter(belongs).collect();
            if shown.is_empty() {
                continue;
            }
            let comment = if matches!(style, Style::Latex(_)) { "% " } else { "" };
            texts.extend(scene.iter().map(|name| format!("{comment}{name}")));
            texts.extend(shown.chunks(norms).map(|group| table(group, direction, style)));
        }
    }
    texts
}

/// The points of one direction, coarse to fine: along a path all, else the longest line.
pub(super) fn line(group: &Group, direction: Direction) -> Vec<Point> {
    let all = group.points();
    let mut line = match path(&all).is_some() {
        true => all,
        false => group.line(direction).into_iter().map(|(point, _)| point).collect(),
    };
    line.sort_by(|a, b| direction.step(b).total_cmp(&direction.step(a)));
    line
}

/// The local orders at the points of a line: for errors from pairs, for values from triples.
fn orders(quantity: Quantity, line: &[Point], direction: Direction) -> Vec<Option<f64>> {
    let step = |at: usize| direction.step(&line[at]);
    let order = |at: usize| match quantity {
        Quantity::Error if at > 0 => {
            let falls = (line[at - 1].error / line[at].error).ln();
            Some(falls / (step(at - 1) / step(at)).ln())
        }
        Quantity::Value if at > 1 => {
            let sample = |at: usize| ValueSample { step: step(at), value: line[at].error };
            Triple::of([sample(at - 2), sample(at - 1), sample(at)]).order()
        }
        _ => None,
    };
    (0..line.len()).map(|at| order(at).filter(|order| order.is_finite())).collect()
}

fn table(groups: &[&Group], direction: Direction, style: Style<'_>) -> String {
    let step = |point: &Point| direction.step(point);
    let lines: Vec<Vec<Point>> = groups.iter().map(|group| line(group, direction)).collect();
    let orders: Vec<Vec<Option<f64>>> = groups
        .iter()
        .zip(&lines)
        .map(|(group, line)| orders(group.quantity, line, direction))
        .collect();
    let mut rows: Vec<Point> = lines.iter().flatten().copied().collect();
    rows.sort_by(|a, b| step(b).total_cmp(&step(a)));
    rows.dedup_by(|a, b| same_level(step(a), step(b)));
    // Along a path both steps change from row to row.
    let along = groups.iter().any(|group| path(&group.points()).is_some());
    let mut head = vec![direction.name().to_owned()];
    head.extend(along.then(|| "k".to_owned()));
    for group in groups {
        let (measured, order) = match group.quantity {
            Quantity::Error => ("error", "EOC"),
            Quantity::Value => ("value", "order"),
        };
        head.extend([group.norm.clone().unwrap_or_else(|| measured.into()), order.into()]);
    }
    let row = |row: &Point| {
        let cells =
            groups.iter().zip(lines.iter().zip(&orders)).flat_map(|(group, (line, orders))| {
                // Lines and rows fall alike.
                let same = |point: &Point| same_level(step(point), step(row));
                let at = line.partition_point(|point| step(point) > step(row) && !same(point));
                let at = line.get(at).filter(|point| same(point)).map(|_| at);
                let number = |at: usize| match group.quantity {
                    Quantity::Error => scientific(line[at].error, style),
                    Quantity::Value => digits(line[at].error, 9),
                };
                let order = at.and_then(|at| orders[at]);
                [
                    at.map_or("-".into(), number),
                    order.map_or("-".into(), |order| format!("{order:.2}")),
                ]
            });
        // A paper has room for 1/64 in full.
        let written = |size: f64| match digits(size, 7) {
            full if matches!(style, Style::Latex(_))
                && !full.contains('e')
                && full.parse::<f64>() == Ok(size) =>
            {
                full
            }
            _ => plain(size),
        };
        let steps = std::iter::once(written(step(row))).chain(along.then(|| written(row.k)));
        steps.chain(cells).collect::<Vec<String>>()
    };
    let rows: Vec<Vec<String>> = rows.iter().map(row).collect();
    match style {
        Style::Text => text(&head, &rows),
        Style::Markdown => markdown(&head, &rows),
        Style::Latex(fitted) => {
            let orders: Vec<_> = groups.iter().map(|group| fitted(group, direction)).collect();
            latex(head, &rows, &orders)
        }
    }
}

fn scientific(error: f64, style: Style<'_>) -> String {
    let text = format!("{error:.3e}");
    match (style, text.split_once('e')) {
        (Style::Latex(_), Some((digits, power))) => format!("${digits} \\cdot 10^{{{power}}}$"),
        _ => text,
    }
}

fn text(head: &[String], rows: &[Vec<String>]) -> String {
    let all = || std::iter::once(head).chain(rows.iter().map(Vec::as_slice));
    let width = |at: usize| all().map(|row| row[at].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..head.len()).map(width).collect();
    // Steps are left-aligned.
    let cell = |(at, (cell, width)): (usize, (&String, &usize))| match at {
        0 => format!("{cell:<width$}"),
        _ => format!("{cell:>width$}"),
    };
    let line =
        |row: &[String]| -> Vec<String> { row.iter().zip(&widths).enumerate().map(cell).collect() };
    all().map(|row| line(row).join("  ")).collect::<Vec<_>>().join("\n")
}

fn markdown(head: &[String], rows: &[Vec<String>]) -> String {
    let line = |cells: &[String]| format!("| {} |", cells.join(" | "));
    let mut lines = vec![line(head), format!("|{}", "---:|".repeat(head.len()))];
    lines.extend(rows.iter().map(|row| line(row)));
    lines.join("\n")
}

/// For `\input`, with the rules of booktabs; the last row has the fitted orders.
fn latex(mut head: Vec<String>, rows: &[Vec<String>], orders: &[Option<[f64; 3]>]) -> String {
    let steps = head.len() - 2 * orders.len();
    head[..steps].iter_mut().for_each(|step| *step = format!("${step}$"));
    for name in head.iter_mut().filter(|name| !name.contains(['$', '\\'])) {
        *name = name.replace('_', "\\_").replace('%', "\\%").replace('&', "\\&");
    }
    let line = |cells: &[String]| format!("{} \\\\", cells.join(" & "));
    let dashed = |cell: &String| if cell == "-" { "--".to_owned() } else { cell.clone() };
    let body = rows.iter().map(|row| line(&row.iter().map(dashed).collect::<Vec<_>>()));
    let mut lines = vec![
        format!("\\begin{{tabular}}{{{}}}", "r".repeat(head.len())),
        "\\toprule".into(),
        line(&head),
        "\\midrule".into(),
    ];
    lines.extend(body);
    if orders.iter().any(Option::is_some) {
        let cell = |order: &Option<[f64; 3]>| {
            let text = order.map_or("--".into(), |[order, low, high]| {
                format!("${order:.2}$ in $[{low:.2}, {high:.2}]$")
            });
            format!("\\multicolumn{{2}}{{r}}{{{text}}}")
        };
        let mut last = vec![String::new(); steps];
        last[0] = "order".into();
        last.extend(orders.iter().map(cell));
        lines.extend(["\\midrule".into(), line(&last)]);
    }
    lines.extend(["\\bottomrule".into(), "\\end{tabular}".into()]);
    lines.join("\n")
}

// The errors of a file on logarithmic axes.

/// One series per table, in the first refined direction of the file, with triangles of predicted orders.
pub(super) fn svg(
    groups: &[Group],
    predicted: impl Fn(&Group, Direction) -> Option<f64>,
) -> Result<String, CliError> {
    let errors: Vec<&Group> =
        groups.iter().filter(|group| group.quantity == Quantity::Error).collect();
    let directions = Direction::BOTH;
    let refined = |direction: &Direction| errors.iter().any(|group| group.refined(*direction));
    let nothing = || CliError::other("nothing to draw: no errors at two sizes");
    let direction = directions.into_iter().find(refined).ok_or_else(nothing)?;
    let x = Axis::new(direction.name(), Scale::Steps);
    let mut chart = Chart::new("", "", x, Axis::new("error", Scale::Log));
    for group in errors {
        let mut points: Vec<Datum> = line(group, direction)
            .iter()
            .filter(|point| screen(point).is_ok())
            .map(|point| (direction.step(point), point.error))
            .collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        let name = group.heading().unwrap_or_else(|| "error".into());
        let order = predicted(group, direction);
        let slope =
            order.map(|order| Slope { order, label: order.to_string(), along: points.clone() });
        let parts = vec![Part::Line(points.clone()), Part::Points(points)];
        chart.series.push(Series { slope, ..Series::new(name, parts) });
    }
    chart.svg().ok_or_else(nothing)
}

#[cfg(test)]
mod tests {
    use super::*;
    use judge::table::{Reading, read};

    const WIDE: &str = "h,L2,e_u\n0.5,0.1,1\n0.25,0.025,0.5\n0.0001,-,2e-4\n";

    #[test]
    fn orders_stand_beside_their_errors() {
        let groups = read(WIDE.as_bytes(), &Reading::default()).unwrap().groups;
        let markdown = tables(&groups, Style::Markdown).join("\n");
        let rows: Vec<&str> = markdown.lines().collect();
        assert_eq!(rows[0], "| h | L2 | EOC | e_u | EOC |");
        assert_eq!(rows[2], "| 0.5 | 1.000e-1 | - | 1.000e0 | - |");
        assert_eq!(rows[3], "| 0.25 | 2.500e-2 | 2.00 | 5.000e-1 | 1.00 |");
        assert_eq!(rows[4], "| 1e-4 | - | - | 2.000e-4 | 1.00 |");
        let latex = tables(&groups, Style::Latex(&|_, _| Some([2.0, 1.9, 2.125]))).join("\n");
        assert!(latex.contains("$h$ & L2 & EOC & e\\_u & EOC \\\\"), "{latex}");
        let last = "order & \\multicolumn{2}{r}{$2.00$ in $[1.90, 2.12]$} & ";
        assert!(latex.contains(last) && latex.contains("\\bottomrule"), "{latex}");
        assert!(latex.contains("0.25 & $2.500 \\cdot 10^{-2}$ & 2.00"), "{latex}");
        let plain = tables(&groups, Style::Text).join("\n");
        assert_eq!(plain.lines().nth(2), Some("0.25  2.500e-2  2.00  5.000e-1  1.00"), "{plain}");
        // The output can be read as input.
        for text in [plain, markdown, latex] {
            let again = read(text.as_bytes(), &Reading::default()).unwrap().groups;
            assert_eq!(again[0].points()[1].error, 0.025, "{text}");
        }
    }

    /// Values have orders of triples; paths show both steps.
    #[test]
    fn values_and_paths_have_tables_too() {
        let text = |text: &str| {
            let groups = read(text.as_bytes(), &Reading::default()).unwrap().groups;
            tables(&groups, Style::Text).join("\n")
        };
        let values = text("h,value\n0.4,1.16\n0.2,1.04\n0.1,1.01\n");
        assert_eq!(values.lines().last(), Some("0.1   1.01   2.00"), "{values}");
        let along = text("h,k,error\n0.4,0.4,4\n0.2,0.2,2\n0.1,0.1,1\n");
        assert_eq!(along.lines().last(), Some("0.1  0.1  1.000e0  1.00"), "{along}");
    }

    #[test]
    fn no_size_is_printed_as_zero() {
        let texts = [0.25, 0.0001, 1e-9, 0.333333333, 1234.6].map(plain);
        assert_eq!(texts, ["0.25", "1e-4", "1e-9", "0.3333", "1235"]);
    }
}
