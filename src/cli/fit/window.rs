//! Restricts a table to a window of steps.

use std::str::FromStr;

use judge::fit::Point;
use judge::table::{Row, Tables};

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Window([f64; 2]);

/// Relative tolerance at the ends.
const ROUNDING: f64 = 1e-6;

impl Window {
    /// Removes the rows outside from all tables and returns their points, a list per table. The window is in h, or in k
    /// for a table without h.
    pub(super) fn narrow(self, tables: &mut Tables) -> Vec<Vec<Point>> {
        let narrowed = tables.groups.iter_mut().map(|group| {
            let space = group.rows.iter().any(|row| !row.point.h.is_nan());
            let step = |row: &Row| if space { row.point.h } else { row.point.k };
            let (inside, outside): (Vec<Row>, Vec<Row>) =
                group.rows.drain(..).partition(|row| self.holds(step(row)));
            group.rows = inside;
            outside.into_iter().map(|row| row.point).collect()
        });
        narrowed.collect()
    }

    /// A row without a step stays, as a gap.
    fn holds(self, step: f64) -> bool {
        let Self([lo, hi]) = self;
        step.is_nan() || (lo * (1.0 - ROUNDING)..=hi * (1.0 + ROUNDING)).contains(&step)
    }
}

impl FromStr for Window {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("`{text}` is no window: 0.01,0.1 takes the steps from 0.01 to 0.1");
        let (a, b) = text.split_once([',', ':']).ok_or_else(wrong)?;
        let end = |text: &str| text.trim().parse::<f64>().ok().filter(|step| *step > 0.0);
        let (a, b) = end(a).zip(end(b)).ok_or_else(wrong)?;
        Ok(Self([a.min(b), a.max(b)]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use judge::table::{Reading, read};

    #[test]
    fn a_window_takes_rows_out_of_every_table() {
        let window: Window = "0.3,0.1".parse().unwrap();
        assert_eq!(Ok(window), "0.1:0.3".parse());
        let text = "h,L2,H1\n0.5,1,1\n0.3,0.5,-\n0.2,0.3,0.5\n0.1,0.1,0.3\n0.05,0.1,0.2\n";
        let mut tables = read(text.as_bytes(), &Reading::default()).unwrap();
        let left_out = window.narrow(&mut tables);
        assert_eq!(left_out.iter().map(Vec::len).collect::<Vec<_>>(), [2, 2]);
        let steps = |at: usize| tables.groups[at].points().iter().map(|p| p.h).collect::<Vec<_>>();
        assert_eq!((steps(0), steps(1)), (vec![0.3, 0.2, 0.1], vec![0.2, 0.1]));
        assert!(tables.groups[1].gaps_in_words().is_some(), "a gap inside stays one");
        // Without h the window is in k.
        let mut tables = read(b"k,error\n0.5,1\n0.2,1\n", &Reading::default()).unwrap();
        assert_eq!(window.narrow(&mut tables)[0].len(), 1);
        for wrong in ["", "1", "0,1", "-1,1", "nan,1", "a,b"] {
            assert!(wrong.parse::<Window>().is_err(), "{wrong}");
        }
    }
}
