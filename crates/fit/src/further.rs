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
    /// What somebody may know of the errors, where they look like it.
    fn known_better(&self) -> String {
        // Slopes against a finer run rise ever faster.
        let reference = self.may_have_a_reference()
            && matches!(self.slopes[..], [.., a, b, c] if b > a && c - b > b - a);
        let floor = self.may_have_a_floor();
        [
            (reference, ", or state the step of the finer run that these are differences from"),
            (floor, ", or state the floor"),
        ]
        .into_iter()
        .filter_map(|(may, text)| may.then_some(text))
        .collect()
    }

    /// What helps a ruling, where `further` is the next level: none unless it is open.
    pub fn help(&self, ruling: &Ruling, further: Further) -> Option<Further> {
        let settled_above = ruling.too_high && ruling.decision == Decision::Unresolved;
        match self.floor_from {
            _ if settled_above && !ruling.unexplained => Some(Further::without_steps(
                "finer levels lower it only if the slopes still fall; \"at least\" takes it for a lower bound",
            )),
            _ if !ruling.is_helped() => None,
            Some(_) => Some(Further::without_steps(LOWER_FLOOR)),
            None => {
                let text = format!("{}{}", further.text, self.known_better());
                Some(Further { text, ..further })
            }
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

    /// Order one against a run of h = 1/128, and a forward difference that meets its rounding.
    #[test]
    fn slopes_of_differences_from_a_run_and_of_a_floor_ask_for_what_somebody_knows() {
        let advice = |table: &[(f64, f64)]| {
            let found = crate::order(table).expect("an order");
            let ruling = found.decide(&crate::Claim::new(1.0).expect("a claim"));
            found.help(&ruling, Further::without_steps("run it")).expect("advice").text
        };
        let table: Vec<(f64, f64)> =
            (3..7).map(|i| (0.5f64.powi(i), 0.5f64.powi(i) - 0.5f64.powi(7))).collect();
        let said = advice(&table);
        assert!(said.starts_with("run it, or state the step of the finer run"), "{said}");
        // (sin(1 + h) − sin 1)/h − cos 1 in doubles.
        let met = |i: i32| {
            let h = 0.1f64.powi(i);
            (h, ((1.0 + h).sin() - 1f64.sin()) / h - 1f64.cos())
        };
        let met: Vec<(f64, f64)> = (1..9).map(met).map(|(h, error)| (h, error.abs())).collect();
        assert!(advice(&met).ends_with(", or state the floor"), "{}", advice(&met));
    }
}
