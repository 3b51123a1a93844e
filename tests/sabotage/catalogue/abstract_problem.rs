//! Wrong parts of the abstract problem in ℝ^m.

use vhi::finite::ComponentLaw;

use super::Defect;
use super::Term::Abstract;
use crate::wrong::OfTimes;

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
    vec![
        Abstract.finite("a_S forgotten", |setup| setup.model.a_s.fill(0.0)),
        Abstract.finite("R transposed", |setup| setup.model.r.transpose_mut()),
        Abstract.finite("q(s, t) in place of q(t, s)", |setup| {
            for term in &mut setup.model.kernels {
                let sound = std::mem::replace(&mut term.kernel, Box::new(OfTimes(|_, _| 0.0)));
                term.kernel = Box::new(OfTimes(move |t, s| sound.at(s, t)));
            }
        }),
        Abstract.finite("operator made symmetric", |setup| {
            let matrix = &setup.model.matrix;
            setup.model.matrix = 0.5 * (matrix + matrix.transpose());
        }),
        Abstract.finite("φ at 0.99 S u", |setup| {
            let force = std::mem::take(&mut setup.model.force);
            setup.model.force =
                force.into_iter().map(|law| Box::new(Scaled(law, 0.99)) as _).collect();
        }),
        Abstract.finite("lower bounds ignored", |setup| {
            for functional in &mut setup.model.functionals {
                functional.lower = f64::NEG_INFINITY;
            }
        }),
    ]
}
