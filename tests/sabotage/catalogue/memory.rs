//! Wrong kernels and tensors of the memory term.

use fem::contact::MemoryTerm;
use scene::setup::Setup;
use vhi::law::{Isotropic, MemoryKernel};

use super::{Defect, Term};

/// A kernel through a function of its value and lag; the sum is direct.
struct Changed {
    sound: Box<dyn MemoryKernel>,
    change: fn(f64, f64) -> f64,
}

impl MemoryKernel for Changed {
    fn value(&self, lag: f64) -> f64 {
        (self.change)(self.sound.value(lag), lag)
    }
}

fn kernel(mut setup: Setup, change: fn(f64, f64) -> f64) -> Setup {
    let changed = |MemoryTerm { kernel, tensor }| MemoryTerm {
        kernel: Box::new(Changed { sound: kernel, change }),
        tensor,
    };
    setup.model.memory = setup.model.memory.into_iter().map(changed).collect();
    setup
}

fn tensor(mut setup: Setup, change: fn(Isotropic) -> Isotropic) -> Setup {
    for memory in &mut setup.model.memory {
        memory.tensor = memory.tensor.map(change);
    }
    setup
}

/// A kernel whose recursion has other decay rates than its values.
struct OtherRates {
    sound: Box<dyn MemoryKernel>,
    terms: Vec<(f64, f64)>,
}

impl MemoryKernel for OtherRates {
    fn value(&self, lag: f64) -> f64 {
        self.sound.value(lag)
    }

    fn exponentials(&self) -> Option<&[(f64, f64)]> {
        Some(&self.terms)
    }
}

fn other_rates(mut setup: Setup) -> Setup {
    let changed = |MemoryTerm { kernel, tensor }: MemoryTerm| {
        let terms = kernel
            .exponentials()
            .map(|terms| terms.iter().map(|&(a, c)| (a, 1.02 * c)).collect::<Vec<_>>());
        match terms {
            Some(terms) => {
                MemoryTerm { kernel: Box::new(OtherRates { sound: kernel, terms }), tensor }
            }
            None => MemoryTerm { kernel, tensor },
        }
    };
    setup.model.memory = setup.model.memory.into_iter().map(changed).collect();
    setup
}

pub fn defects() -> Vec<Defect> {
    let of = |name, program| Defect::of(Term::Memory, name, program);
    vec![
        of("ℬ(0) dropped", |setup| kernel(setup, |b, lag| if lag == 0.0 { 0.0 } else { b })),
        of("memory with the other sign", |setup| kernel(setup, |b, _| -b)),
        of("memory twice as strong", |setup| kernel(setup, |b, _| 2.0 * b)),
        of("memory 1 % too strong", |setup| kernel(setup, |b, _| 1.01 * b)),
        of("no memory", |mut setup| {
            setup.model.memory.clear();
            setup
        }),
        of("memory without the trace of its tensor", |setup| {
            tensor(setup, |b| Isotropic { lambda: 0.0, ..b })
        }),
        of("Lamé numbers of the memory exchanged", |setup| {
            tensor(setup, |b| Isotropic { lambda: b.mu, mu: b.lambda })
        }),
        of("recursion with rates 2 % off", other_rates),
    ]
}
