//! Wrong parts of the abstract problem in ℝ^m.

use scene::setup::AbstractSetup;
use vhi::finite::ComponentLaw;
use vhi::law::HistoryKernel;

use super::{Defect, Term};

/// q with its arguments exchanged.
struct Exchanged(Box<dyn HistoryKernel + Send + Sync>);

impl HistoryKernel for Exchanged {
    fn at(&self, t: f64, s: f64) -> f64 {
        self.0.at(s, t)
    }
}

/// N_i at y times a factor.
struct Scaled(Box<dyn ComponentLaw>, f64);

impl ComponentLaw for Scaled {
    fn value(&self, y: f64, r: f64) -> f64 {
        self.0.value(self.1 * y, r)
    }
    fn by_y(&self, y: f64, r: f64) -> f64 {
        self.1 * self.0.by_y(self.1 * y, r)
    }
    fn by_r(&self, y: f64, r: f64) -> f64 {
        self.0.by_r(self.1 * y, r)
    }
}

pub fn defects() -> Vec<Defect> {
    let of = |name, abstract_program: fn(AbstractSetup) -> AbstractSetup| Defect {
        abstract_program,
        ..Defect::none(Term::Abstract, name)
    };
    vec![
        of("a_S forgotten", |mut setup| {
            setup.model.a_s.fill(0.0);
            setup
        }),
        of("R transposed", |mut setup| {
            setup.model.r = setup.model.r.transpose();
            setup
        }),
        of("q(s, t) in place of q(t, s)", |mut setup| {
            for term in &mut setup.model.kernels {
                let sound = std::mem::replace(&mut term.kernel, Box::new(Nothing));
                term.kernel = Box::new(Exchanged(sound));
            }
            setup
        }),
        of("operator made symmetric", |mut setup| {
            let matrix = &setup.model.matrix;
            setup.model.matrix = 0.5 * (matrix + matrix.transpose());
            setup
        }),
        of("φ at 0.99 S u", |mut setup| {
            let force = std::mem::take(&mut setup.model.force);
            setup.model.force =
                force.into_iter().map(|law| Box::new(Scaled(law, 0.99)) as _).collect();
            setup
        }),
        of("lower bounds ignored", |mut setup| {
            for functional in &mut setup.model.functionals {
                functional.lower = f64::NEG_INFINITY;
            }
            setup
        }),
    ]
}

struct Nothing;

impl HistoryKernel for Nothing {
    fn at(&self, _: f64, _: f64) -> f64 {
        0.0
    }
}
