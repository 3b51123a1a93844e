//! What would help an open verdict: one level more, unless it lies in a floor or beyond the reference.

use super::{Decision, Posterior, Ruling, same_level};

/// Steps to run, and the advice in words.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Further {
    pub steps: Vec<f64>,
    pub text: String,
}

const LOWER_FLOOR: &str =
    "lower the floor (tolerance of the solver, quadrature, reference), or add coarser levels";

impl Further {
    fn without_steps(text: &str) -> Self {
        Self { steps: Vec::new(), text: text.to_owned() }
    }

    /// After the steps that serve, coarse to fine: one more in the ratio of the last two, two after a single one. `lost` are
    /// those of errors near their floors, `reference` that of the run that errors are measured against.
    pub fn after(name: &str, serving: &[f64], lost: &[f64], reference: Option<f64>) -> Self {
        let steps = match *serving {
            [.., previous, last] => vec![last * last / previous],
            [only] => vec![only / 2.0, only / 4.0],
            [] => Vec::new(),
        };
        let finest = serving.last().copied().unwrap_or(f64::INFINITY);
        if lost.iter().any(|step| *step < finest) {
            return Self::without_steps(LOWER_FLOOR);
        }
        let not_above =
            |reference: f64, step: f64| step <= reference || same_level(step, reference);
        let beyond = |reference: f64| steps.iter().any(|step| not_above(reference, *step));
        if reference.is_some_and(beyond) {
            return Self::without_steps("add coarser levels, or measure against a finer run");
        }
        let each: Vec<String> =
            steps.iter().map(|step| format!("{name} = {}", plain(*step))).collect();
        let text = match each.is_empty() {
            true => format!("run three values of {name}"),
            false => format!("run {}", each.join(" and ")),
        };
        Self { steps, text }
    }
}

impl Posterior {
    /// What helps a ruling, where `further` is the next level: none unless it is open.
    pub fn help(&self, ruling: &Ruling, further: Further) -> Option<Further> {
        let settled_above = ruling.too_high && ruling.decision == Decision::Unresolved;
        match self.floor_from {
            _ if settled_above && !ruling.unexplained => Some(Further::without_steps(
                "finer levels would not lower it; \"at least\" takes it for a lower bound",
            )),
            _ if !ruling.is_helped() => None,
            Some(_) => Some(Further::without_steps(LOWER_FLOOR)),
            None => Some(further),
        }
    }
}

/// Four digits, but never 0.0000.
pub fn plain(number: f64) -> String {
    let rounded: f64 = format!("{number:.3e}").parse().unwrap_or(number);
    match rounded.abs() {
        size if size == 0.0 || (1e-3..1e5).contains(&size) => rounded.to_string(),
        _ => format!("{rounded:e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_next_level_is_neither_in_a_floor_nor_beyond_a_reference() {
        let after = |lost: &[f64], reference| Further::after("h", &[0.5, 0.25], lost, reference);
        assert_eq!(after(&[], None), Further { steps: vec![0.125], text: "run h = 0.125".into() });
        assert_eq!(after(&[1.0], Some(0.0)).steps, [0.125]);
        for (lost, reference, what) in [
            (&[0.125][..], None, "lower the floor"),
            (&[1.0, 0.2], None, "lower the floor"),
            (&[], Some(0.125), "finer run"),
        ] {
            let found = after(lost, reference);
            assert!(found.steps.is_empty() && found.text.contains(what), "{found:?}");
        }
        assert_eq!(Further::after("k", &[0.5], &[], None).text, "run k = 0.25 and k = 0.125");
        assert_eq!(Further::after("k", &[], &[], None).text, "run three values of k");
    }
}
