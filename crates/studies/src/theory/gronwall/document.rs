//! A study of Gronwall's inequality in words and tables.

use super::estimate::Effectivity;
use super::horizon::HorizonRow;
use super::stability::Perturbation;
use super::study::{StudiedGrid, Study};
use report::{Chapter, Row, Run, StudyDocument, digits, number, precise, sides};

impl Study {
    /// The study as a document.
    pub fn document(&self) -> StudyDocument {
        let title = format!("Envelopes: {}", self.scene);
        let mut document =
            StudyDocument::new(Chapter::Gronwall, title).of_scene(&self.scene, &self.fingerprint);
        self.say_verdict(&mut document);
        if let Some(finest) = self.grids.iter().max_by_key(|grid| grid.steps) {
            document.words(answer(finest));
        }
        let mesh = self.n.map_or_else(String::new, |n| format!("n = {n}; "));
        document.words(format!("{mesh}the truth is: {}.", self.truth));
        document.table(
            "Bound over error at t = T for N steps; e and g at T.",
            self.grids.iter().map(grid),
        );
        if let Some(horizons) = &self.horizons {
            document.table(
                format!(
                    "Long times at k = {}; maxima over [0, T]; the truth is: {}. Growth is d(log error)/dT, to compare with C₂.",
                    digits(horizons.k, 5),
                    horizons.truth
                ),
                horizons.rows.iter().map(|row| horizon(row, horizons.k)),
            );
        }
        document.table(
            "Two loads f and f + δf at the largest N; growth is m0 max‖u − v‖/max‖δf‖, then the least bound over difference, and the largest primed bound over the largest difference.",
            self.perturbations.iter().map(perturbed),
        );
        document.table("Constants of the inequality.", self.constants());
        for (stem, shows, chart) in self.pictures() {
            document.figure(stem, shows, chart.svg());
        }
        document
    }

    fn say_verdict(&self, document: &mut StudyDocument) {
        let failures = self.violations.iter().map(|failed| {
            let v = &failed.violation;
            let sides = sides(v.left, v.right);
            format!("{}: {} at n = {} (t = {}): {sides}", failed.part, v.link, v.n, v.t)
        });
        let all = match self
            .grids
            .first()
            .is_none_or(|grid| grid.judged.estimate.weights.are_the_papers())
        {
            true => {
                "The chain error ≤ weighted ≤ primed ≤ closed, primed ≤ printed ≤ its closed form holds at every n of every run."
            }
            false => {
                "The chain error ≤ weighted ≤ primed ≤ closed, with the weights of the rule, holds at every n of every run."
            }
        };
        let holds = self.violations.is_empty() && !self.grids.is_empty();
        document.verdict(holds, all, failures.collect());
    }

    fn constants(&self) -> impl Iterator<Item = Row<'static, 2>> {
        let c = &self.constants;
        let named = [
            ("C₁", c.c1),
            ("C₂", c.c2),
            ("m0", c.m0),
            ("β_φ", c.beta),
            ("Lipschitz constant of S", c.lipschitz),
        ];
        let details = c.details.iter().map(|(name, value)| (written(name), *value));
        let row = |(name, value): (&str, f64)| {
            [("constant", Run::formula(name)), (">value", precise(value, 7))]
        };
        named.into_iter().chain(details).map(row)
    }
}

/// A constant as a reader writes it, by its key in files.
fn written(key: &'static str) -> &'static str {
    match key {
        "yielding" => "μ L_κ √|Ω|",
        "memory_norm" => "‖ℬ‖",
        "c_j_squared_bound" => "c_j², upper bound",
        "c_j_squared" => "c_j²",
        "r_norm" => "‖R‖",
        "q_norm" => "‖q‖",
        other => other,
    }
}

/// How far each bound is above the error at the end of the finest run.
fn answer(finest: &StudiedGrid) -> String {
    let e = &finest.effectivity;
    let times = |of: &Effectivity| digits(of.at_end.unwrap_or(f64::NAN), 3);
    format!(
        "At t = T and N = {} the weighted envelope is {} times the measured error, the envelope with {} {} times, its closed form {} times.",
        finest.steps,
        times(&e.weighted),
        if finest.judged.estimate.weights.are_the_papers() {
            "halved ends"
        } else {
            "one β_φ for all"
        },
        times(&e.primed),
        times(&e.closed)
    )
}

fn grid(grid: &StudiedGrid) -> Row<'static, 10> {
    let e = &grid.effectivity;
    let at_end = |ratio: &Effectivity| precise(ratio.at_end, 7);
    let missing = if grid.c2_k < 1.0 { "–" } else { "C₂k ≥ 1" };
    let printed =
        |ratio: &Option<Effectivity>| ratio.as_ref().map_or_else(|| Run::plain(missing), at_end);
    [
        (">N", Run::plain(grid.steps.to_string())),
        (">C₂k", precise(grid.c2_k, 6)),
        (">e_N", number(grid.error_end)),
        (">g_N", number(grid.truncation_end)),
        (">weighted", at_end(&e.weighted)),
        (">primed", at_end(&e.primed)),
        (">closed", at_end(&e.closed)),
        (">k → 0", at_end(&e.limit)),
        (">printed", printed(&e.printed)),
        (">(3.24)", printed(&e.printed_closed)),
    ]
}

fn horizon(row: &HorizonRow, k: f64) -> Row<'static, 8> {
    let missing = if row.c2 * k < 1.0 { "–" } else { "C₂k ≥ 1" };
    [
        (">T", number(row.horizon)),
        (">error", number(row.error)),
        (">weighted", number(row.bounds.weighted)),
        (">primed", number(row.bounds.primed)),
        (">closed", number(row.bounds.closed)),
        (">(3.24)", row.bounds.printed_closed.map_or_else(|| Run::plain(missing), number)),
        (">growth", number(row.growth)),
        (">C₂", number(row.c2)),
    ]
}

fn perturbed(perturbation: &Perturbation) -> Row<'static, 7> {
    [
        ("shape", Run::plain(perturbation.shape.name())),
        (">size", number(perturbation.size)),
        (">max ‖δf‖", number(perturbation.load)),
        (">max ‖u − v‖", number(perturbation.difference)),
        (">growth", number(perturbation.growth)),
        (">least", number(perturbation.least_effectivity)),
        (">primed", number(perturbation.primed / perturbation.difference)),
    ]
}
