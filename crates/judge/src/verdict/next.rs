//! The next cases to run for unresolved verdicts.

use super::selection::{JudgedPoint, Selection, inside};
use super::{MeshAndSteps, Prediction, Variable};
use fit::Direction;

/// Cases that would help, with their description. Without such cases the words say what would help.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Next {
    pub(super) cases: Vec<MeshAndSteps>,
    pub(super) text: String,
}

pub(super) fn next_case(
    selection: &Selection,
    direction: Direction,
    prediction: &Prediction,
) -> Next {
    let (name, window) = match direction {
        Direction::Space => ("n", prediction.window_n),
        Direction::Time => ("steps", prediction.window_steps),
    };
    let lost = finest_is_below_floor(selection, direction);
    let left_out = levels(selection.left_out.iter(), direction);
    let is_there = |level: u32| left_out.iter().any(|there| there.0 == level);
    let levels = levels(selection.used.iter(), direction);
    let (wanted, text) = match (&levels[..], lost) {
        ([], true) => (Vec::new(), prediction.floor.remedy().to_owned()),
        ([], false) => (Vec::new(), format!("run three values of {name}")),
        ([first, ..], true) => match coarser(first.0, levels.get(1).map(|level| level.0)) {
            Some(level) if !is_there(level) => {
                (vec![level], format!("run {name} = {level}: finer ones are below the floor"))
            }
            _ => (Vec::new(), prediction.floor.remedy().to_owned()),
        },
        ([.., previous, last], false) => {
            let level = finer(*previous, *last);
            (vec![level], format!("run {name} = {level}"))
        }
        ([only], false) => {
            let [a, b] = [twice(only.0), twice(twice(only.0))];
            (vec![a, b], format!("run {name} = {a} and {name} = {b}"))
        }
    };
    if wanted.iter().any(|level| !inside(Some(*level), window)) {
        return Next { cases: Vec::new(), text: format!("{text}, in a wider window") };
    }
    let cases = wanted.iter().flat_map(|&level| cases(selection, direction, prediction, level));
    Next { cases: cases.collect(), text }
}

/// The cases of a new level: on the line of the prediction, or with all levels of the other
/// direction of a grid.
fn cases(
    selection: &Selection,
    direction: Direction,
    prediction: &Prediction,
    level: u32,
) -> Vec<MeshAndSteps> {
    let keys = selection.used.iter().chain(&selection.left_out).map(|point| point.place);
    let mut found: Vec<MeshAndSteps> = match (direction, prediction.variable) {
        (_, Variable::Path) => {
            let steps = levels(selection.used.iter(), Direction::Time);
            let next = match &steps[..] {
                [.., previous, last] => finer(*previous, *last),
                _ => return Vec::new(),
            };
            vec![MeshAndSteps { n: Some(level), steps: next }]
        }
        (Direction::Space, _) => {
            keys.map(|key| MeshAndSteps { n: Some(level), steps: key.steps }).collect()
        }
        (Direction::Time, _) => keys.map(|key| MeshAndSteps { n: key.n, steps: level }).collect(),
    };
    found.sort_unstable();
    found.dedup();
    found
}

/// Levels n or N of the cases with their steps, coarse to fine.
fn levels<'a>(
    points: impl Iterator<Item = &'a JudgedPoint>,
    direction: Direction,
) -> Vec<(u32, f64)> {
    let level = |place: MeshAndSteps| match direction {
        Direction::Space => place.n,
        Direction::Time => Some(place.steps),
    };
    let mut levels: Vec<(u32, f64)> = points
        .filter_map(|judged| Some((level(judged.place)?, direction.step(&judged.point))))
        .collect();
    levels.sort_by_key(|level| level.0);
    levels.dedup_by_key(|level| level.0);
    levels
}

fn finest_is_below_floor(selection: &Selection, direction: Direction) -> bool {
    let below = |reason: &String| reason.starts_with("below floor");
    let lost = selection.left_out.iter().filter(|point| point.reason.as_ref().is_some_and(below));
    let finest_lost = levels(lost, direction).pop();
    let finest_used = levels(selection.used.iter(), direction).pop();
    finest_lost.is_some_and(|lost| finest_used.is_none_or(|used| lost.0 > used.0))
}

fn twice(level: u32) -> u32 {
    level.saturating_mul(2)
}

/// The next level in the ratio of the last two; plus one if levels count refinements, i.e. steps do not fall like 1/n.
fn finer(previous: (u32, f64), last: (u32, f64)) -> u32 {
    let ratio = f64::from(last.0) / f64::from(previous.0.max(1));
    // Largest steps of graded grids follow 1/N within a few percent only.
    let counts_cells = (previous.1 / last.1 / ratio - 1.0).abs() < 0.1 || previous.1.is_nan();
    if previous.0 == 0 || !counts_cells && last.0 == previous.0 + 1 {
        return last.0.saturating_add(1);
    }
    ((f64::from(last.0) * ratio).round() as u32).max(last.0.saturating_add(1))
}

fn coarser(first: u32, second: Option<u32>) -> Option<u32> {
    let ratio = second.map_or(2.0, |second| f64::from(second) / f64::from(first.max(1)));
    let level = (f64::from(first) / ratio).round() as u32;
    (1..first).contains(&level).then_some(level)
}

#[cfg(test)]
mod tests {
    use super::*;
    use fit::Point;

    #[test]
    fn levels_continue_as_they_went() {
        assert_eq!(finer((64, 1.0 / 64.0), (128, 1.0 / 128.0)), 256);
        assert_eq!(finer((8, 1.0 / 8.0), (12, 1.0 / 12.0)), 18);
        // Levels count refinements if steps halve from one to the next, cells if steps fall like 1/n.
        assert_eq!(finer((2, 0.25), (3, 0.125)), 4);
        assert_eq!(finer((2, 0.5), (3, 1.0 / 3.0)), 5);
        assert_eq!(finer((2, 0.5), (3, 1.05 / 3.0)), 5);
        assert_eq!(finer((0, 1.0), (1, 0.5)), 2);
        assert_eq!(finer((10, f64::NAN), (20, f64::NAN)), 40);
        assert_eq!(coarser(8, Some(16)), Some(4));
        assert_eq!(coarser(1, Some(2)), None);
    }

    fn judged(&(n, steps): &(u32, u32), reason: Option<&str>) -> JudgedPoint {
        let (h, k) = (1.0 / f64::from(n), 1.0 / f64::from(steps));
        let place = MeshAndSteps { n: Some(n), steps };
        let point = Point { h, k, error: h + k, floor: 0.0 };
        JudgedPoint { point, place, reason: reason.map(str::to_owned) }
    }

    fn selection(used: &[(u32, u32)], below_floor: &[(u32, u32)]) -> Selection {
        let lost = below_floor.iter().map(|place| judged(place, Some("below floor 1e-12")));
        Selection {
            used: used.iter().map(|place| judged(place, None)).collect(),
            left_out: lost.collect(),
            screened_out: Vec::new(),
            gaps: Vec::new(),
        }
    }

    fn predict(variable: Variable) -> Prediction {
        Prediction::new("V_max", variable, 1.0)
    }

    fn pairs(next: &Next) -> Vec<(Option<u32>, u32)> {
        next.cases.iter().map(|case| (case.n, case.steps)).collect()
    }

    #[test]
    fn next_cases_lie_on_the_line_the_path_or_the_grid() {
        let along = |variable, used: &[(u32, u32)]| {
            next_case(&selection(used, &[]), Direction::Space, &predict(variable))
        };
        assert_eq!(pairs(&along(Variable::H, &[(8, 4), (16, 4)])), [(Some(32), 4)]);
        assert_eq!(pairs(&along(Variable::H, &[(8, 4)])), [(Some(16), 4), (Some(32), 4)]);
        let path = along(Variable::Path, &[(4, 2), (16, 4), (64, 8)]);
        assert_eq!(pairs(&path), [(Some(256), 16)]);
        assert_eq!(pairs(&along(Variable::Path, &[(4, 2)])), []);
        let grid = selection(&[(8, 4), (16, 4), (8, 8), (16, 8)], &[]);
        let joint = predict(Variable::Joint);
        let wider = next_case(&grid, Direction::Time, &joint);
        assert_eq!(pairs(&wider), [(Some(8), 16), (Some(16), 16)]);
        let far = Prediction { window_steps: Some([4, 8]), ..joint };
        let outside = next_case(&grid, Direction::Time, &far);
        assert!(outside.cases.is_empty() && outside.text.ends_with("in a wider window"));
    }

    /// A level is lost to the floor if all of its cases are.
    #[test]
    fn the_floor_ends_a_level_where_nothing_of_it_is_left() {
        let line = predict(Variable::H);
        let text = |used: &[(u32, u32)], lost: &[(u32, u32)]| {
            next_case(&selection(used, lost), Direction::Space, &line).text
        };
        let part = text(&[(8, 4), (16, 4)], &[(16, 8)]);
        assert_eq!(part, "run n = 32");
        let whole = text(&[(8, 4), (16, 4)], &[(32, 4)]);
        assert_eq!(whole, "run n = 4: finer ones are below the floor");
        assert_eq!(text(&[(1, 4), (2, 4)], &[(4, 4)]), predict(Variable::H).floor.remedy());
        assert_eq!(text(&[(10, 4)], &[(5, 4), (20, 4)]), predict(Variable::H).floor.remedy());
        assert_eq!(text(&[], &[]), "run three values of n");
    }
}
