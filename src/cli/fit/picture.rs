//! The errors of a file on logarithmic axes.

use judge::fit::{Direction, screen};
use judge::table::{Group, Quantity};
use report::{Axis, Chart, Datum, Part, Scale, Series, Slope};

use super::asked::Asked;
use super::eoc;
use crate::cli::CliError;

/// One series per table, in the first refined direction of the file, with triangles of predicted orders.
pub(super) fn svg(groups: &[Group], asked: impl Fn(&Group) -> Asked) -> Result<String, CliError> {
    let errors: Vec<&Group> =
        groups.iter().filter(|group| group.quantity == Quantity::Error).collect();
    let directions = Direction::BOTH;
    let refined = |direction: &Direction| errors.iter().any(|group| group.refined(*direction));
    let nothing = || CliError::other("nothing to draw: no errors at two sizes");
    let direction = directions.into_iter().find(refined).ok_or_else(nothing)?;
    let x = Axis::new(direction.name(), Scale::Steps);
    let chart = Chart::new("", "", x, Axis::new("error", Scale::Log));
    let mut chart = Chart { direct: true, ..chart };
    for group in errors {
        let mut points: Vec<Datum> = eoc::line(group, direction)
            .iter()
            .filter(|point| screen(point).is_ok())
            .map(|point| (direction.step(point), point.error))
            .collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        let name = group.heading().unwrap_or_else(|| "error".into());
        let order = asked(group).order(direction);
        let slope =
            order.map(|order| Slope { order, label: order.to_string(), along: points.clone() });
        let parts = vec![Part::Line(points.clone()), Part::Points(points)];
        chart.series.push(Series { slope, ..Series::new(name, parts) });
    }
    chart.svg().ok_or_else(nothing)
}
