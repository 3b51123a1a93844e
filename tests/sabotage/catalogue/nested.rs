//! Wrong histories of histories, and wrong displacements under a velocity.

use fem::contact::MemoryTerm;
use scene::setup::{AbstractSetup, Setup};
use vhi::history::{TimeGrid, TimeRule};
use vhi::law::{HistoryKernel, MemoryKernel};

use super::{Defect, Term};

/// r without its value at τ = s.
struct NothingAtEnd(Box<dyn HistoryKernel + Send + Sync>);

impl HistoryKernel for NothingAtEnd {
    fn at(&self, t: f64, s: f64) -> f64 {
        if s == t { 0.0 } else { self.0.at(t, s) }
    }
}

/// A history of a history as one of the strain.
struct Outer(Box<dyn MemoryKernel>);

impl MemoryKernel for Outer {
    fn value(&self, lag: f64) -> f64 {
        self.0.nested().map_or_else(|| self.0.value(lag), |[outer, _]| outer.value(lag))
    }
}

/// The rule with a first weight of a whole step where it has none: the displacement of backward Euler begins with k w_0.
struct FirstToo(Box<dyn TimeRule>);

impl TimeRule for FirstToo {
    fn weight(&self, grid: &TimeGrid, n: usize, j: usize) -> f64 {
        match self.0.weight(grid, n, j) {
            0.0 if j < n => grid.step(j + 1),
            weight => weight,
        }
    }

    fn last_share(&self) -> f64 {
        self.0.last_share()
    }
}

fn without_inner(mut setup: Setup) -> Setup {
    let outer = |MemoryTerm { kernel, tensor }: MemoryTerm| match kernel.nested() {
        Some(_) => MemoryTerm { kernel: Box::new(Outer(kernel)), tensor },
        None => MemoryTerm { kernel, tensor },
    };
    setup.model.memory = setup.model.memory.into_iter().map(outer).collect();
    setup
}

pub fn defects() -> Vec<Defect> {
    let of = |name, abstract_program: fn(AbstractSetup) -> AbstractSetup| Defect {
        abstract_program,
        ..Defect::none(Term::Abstract, name)
    };
    vec![
        of("q before u in place of its history", |mut setup| {
            setup.model.kernels.iter_mut().for_each(|term| term.inner = None);
            setup
        }),
        of("inner and outer kernel exchanged", |mut setup| {
            for term in &mut setup.model.kernels {
                if let Some(inner) = term.inner.take() {
                    term.inner = Some(std::mem::replace(&mut term.kernel, inner));
                }
            }
            setup
        }),
        of("inner history without its last level", |mut setup| {
            for term in &mut setup.model.kernels {
                term.inner = term.inner.take().map(|r| Box::new(NothingAtEnd(r)) as _);
            }
            setup
        }),
        of("initial displacement forgotten", |mut setup| {
            setup.model.start.fill(0.0);
            setup
        }),
        of("displacement counts the first velocity", |mut setup| {
            let sound = std::mem::replace(&mut setup.model.time_rule, Box::new(vhi::history::Left));
            // Other rules have no first weight that is zero.
            let right = sound.last_share() == 1.0;
            setup.model.time_rule = if right { Box::new(FirstToo(sound)) } else { sound };
            setup
        }),
        Defect::of(
            Term::Memory,
            "memory of the velocity in place of the displacement",
            without_inner,
        ),
    ]
}
