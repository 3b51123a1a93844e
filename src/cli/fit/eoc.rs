//! Tables of errors with their orders, as papers print them: h, and error and EOC of each norm.

use judge::fit::{Direction, Point, same_level};
use judge::table::{Group, Quantity};

use super::{line_points, step_name};

/// How a table is set.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Style {
    Markdown,
    Latex,
}

/// A size or a value in four digits, never as 0.0000.
pub(super) fn plain(number: f64) -> String {
    let rounded: f64 = format!("{number:.3e}").parse().unwrap_or(number);
    match rounded.abs() {
        size if size == 0.0 || (1e-3..1e5).contains(&size) => rounded.to_string(),
        _ => format!("{rounded:e}"),
    }
}

/// A table for each scene and direction that is refined; of a grid the longest line.
pub(super) fn tables(groups: &[Group], style: Style) -> Vec<String> {
    let mut scenes: Vec<&Option<String>> = groups.iter().map(|group| &group.scene).collect();
    scenes.dedup();
    let mut texts = Vec::new();
    for scene in scenes {
        for direction in [Direction::Space, Direction::Time] {
            let own = |group: &&Group| {
                group.scene == *scene
                    && group.quantity == Quantity::Error
                    && group.refined(direction)
            };
            let own: Vec<&Group> = groups.iter().filter(own).collect();
            if own.is_empty() {
                continue;
            }
            texts.extend(scene.clone());
            texts.push(table(&own, direction, style));
        }
    }
    texts
}

fn table(groups: &[&Group], direction: Direction, style: Style) -> String {
    let step = |point: &Point| direction.step(point);
    let mut lines: Vec<Vec<Point>> =
        groups.iter().map(|group| line_points(group, direction)).collect();
    lines.iter_mut().for_each(|line| line.sort_by(|a, b| step(b).total_cmp(&step(a))));
    let mut steps: Vec<f64> = lines.iter().flatten().map(step).collect();
    steps.sort_by(|a, b| b.total_cmp(a));
    steps.dedup_by(|a, b| same_level(*a, *b));
    let mut head = vec![step_name(direction).to_owned()];
    for group in groups {
        head.extend([group.norm.clone().unwrap_or_else(|| "error".into()), "EOC".into()]);
    }
    let row = |size: &f64| {
        let cells = lines.iter().flat_map(|line| {
            let at = line.iter().position(|point| same_level(step(point), *size));
            let error = at.map(|at| line[at].error);
            let slope = at.filter(|&at| at > 0).map(|at| {
                let (coarse, fine) = (line[at - 1], line[at]);
                (coarse.error / fine.error).ln() / (step(&coarse) / step(&fine)).ln()
            });
            let order = slope.filter(|slope| slope.is_finite());
            [
                error.map_or("-".into(), |error| scientific(error, style)),
                order.map_or("-".into(), |order| format!("{order:.2}")),
            ]
        });
        std::iter::once(plain(*size)).chain(cells).collect::<Vec<String>>()
    };
    set(&head, &steps.iter().map(row).collect::<Vec<_>>(), style)
}

fn scientific(error: f64, style: Style) -> String {
    let text = format!("{error:.3e}");
    match (style, text.split_once('e')) {
        (Style::Latex, Some((digits, power))) => format!("${digits} \\cdot 10^{{{power}}}$"),
        _ => text,
    }
}

fn set(head: &[String], rows: &[Vec<String>], style: Style) -> String {
    let mut lines = Vec::new();
    match style {
        Style::Markdown => {
            lines.push(format!("| {} |", head.join(" | ")));
            lines.push(format!("|{}", "---:|".repeat(head.len())));
            lines.extend(rows.iter().map(|row| format!("| {} |", row.join(" | "))));
        }
        Style::Latex => {
            let set = |name: &String| match name.contains(['$', '\\']) {
                true => name.clone(),
                false => name.replace('_', "\\_").replace('%', "\\%").replace('&', "\\&"),
            };
            let names: Vec<String> = head.iter().map(set).collect();
            lines.push(format!("\\begin{{tabular}}{{{}}}", "r".repeat(head.len())));
            lines.push("\\hline".into());
            lines.push(format!("{} \\\\", names.join(" & ")));
            lines.push("\\hline".into());
            lines.extend(rows.iter().map(|row| format!("{} \\\\", row.join(" & "))));
            lines.extend(["\\hline".into(), "\\end{tabular}".into()]);
        }
    }
    lines.join("\n")
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
        let latex = tables(&groups, Style::Latex).join("\n");
        assert!(latex.contains("h & L2 & EOC & e\\_u & EOC \\\\"), "{latex}");
        assert!(latex.contains("0.25 & $2.500 \\cdot 10^{-2}$ & 2.00"), "{latex}");
        // What is printed can be read again.
        for text in [markdown, latex] {
            let again = read(text.as_bytes(), &Reading::default()).unwrap().groups;
            assert_eq!(again[0].points()[1].error, 0.025, "{text}");
        }
    }

    #[test]
    fn no_size_is_printed_as_zero() {
        let texts = [0.25, 0.0001, 1e-9, 0.333333333, 1234.6].map(plain);
        assert_eq!(texts, ["0.25", "1e-4", "1e-9", "0.3333", "1235"]);
    }
}
