//! Wrong histories of histories, and wrong displacements under a velocity.

use vhi::history::{TimeGrid, Trapezoid};
use vhi::law::HistoryKernel;

use super::Defect;
use super::Term::Abstract;
use super::memory::kernels;
use crate::wrong::{Kernel, OfTimes, Rule};

pub fn defects() -> Vec<Defect> {
    vec![
        Abstract.finite("q before u in place of its history", |setup| {
            setup.model.kernels.iter_mut().for_each(|term| term.inner = None);
        }),
        Abstract.finite("inner and outer kernel exchanged", |setup| {
            for term in &mut setup.model.kernels {
                if let Some(inner) = term.inner.take() {
                    term.inner = Some(std::mem::replace(&mut term.kernel, inner));
                }
            }
        }),
        Abstract.finite("inner history without its last level", |setup| {
            for term in &mut setup.model.kernels {
                let without_end = |r: Box<dyn HistoryKernel + Send + Sync>| {
                    Box::new(OfTimes(move |t, s| if s == t { 0.0 } else { r.at(t, s) })) as _
                };
                term.inner = term.inner.take().map(without_end);
            }
        }),
        Abstract.finite("initial displacement forgotten", |setup| setup.model.start.fill(0.0)),
        // A first weight of a whole step where there is none: the displacement of backward Euler begins with k w_0.
        Abstract.finite("displacement counts the first velocity", |setup| {
            // Other rules have no first weight that is zero.
            if setup.model.time_rule.last_share() == 1.0 {
                let sound = std::mem::replace(&mut setup.model.time_rule, Box::new(Trapezoid));
                let rule = Rule::of(move |grid: &TimeGrid, n, j| match sound.weight(grid, n, j) {
                    0.0 if j < n => grid.step(j + 1),
                    weight => weight,
                });
                setup.model.time_rule = Box::new(Rule { last_share: 1.0, ..rule });
            }
        }),
        kernels("memory of the velocity in place of the displacement", |sound| {
            if sound.nested().is_none() {
                return sound;
            }
            let outer = move |lag| sound.nested().map_or(f64::NAN, |[outer, _]| outer.value(lag));
            Box::new(Kernel::of(outer))
        }),
    ]
}
