//! Wrong kernels and tensors of the memory term.

use vhi::law::{Isotropic, MemoryKernel};

use super::Defect;
use super::Term::Memory;
use crate::wrong::{self, Kernel};

/// Other kernels, each made of the sound one.
pub(super) fn kernels(
    name: &'static str,
    change: impl Fn(Box<dyn MemoryKernel>) -> Box<dyn MemoryKernel> + Send + Sync + 'static,
) -> Defect {
    Memory.of(name, move |setup| wrong::kernels(&mut setup.model, &change))
}

/// Kernels through a function of value and lag.
fn kernel(name: &'static str, change: fn(f64, f64) -> f64) -> Defect {
    kernels(name, move |sound| Box::new(Kernel::of(move |lag| change(sound.value(lag), lag))))
}

fn tensor(name: &'static str, change: fn(Isotropic) -> Isotropic) -> Defect {
    Memory.of(name, move |setup| {
        for memory in &mut setup.model.memory {
            memory.tensor = memory.tensor.map(change);
        }
    })
}

pub fn defects() -> Vec<Defect> {
    vec![
        kernel("ℬ(0) dropped", |b, lag| if lag == 0.0 { 0.0 } else { b }),
        kernel("memory with the other sign", |b, _| -b),
        kernel("memory twice as strong", |b, _| 2.0 * b),
        kernel("memory 1 % too strong", |b, _| 1.01 * b),
        Memory.of("no memory", |setup| setup.model.memory.clear()),
        tensor("memory without the trace of its tensor", |b| Isotropic { lambda: 0.0, ..b }),
        tensor("Lamé numbers of the memory exchanged", |b| Isotropic {
            lambda: b.mu,
            mu: b.lambda,
        }),
        // Other decay rates than those of its values.
        kernels("recursion with rates 2 % off", |sound| {
            let Some(terms) = sound.exponentials() else { return sound };
            let terms = terms.iter().map(|&(a, c)| (a, 1.02 * c)).collect();
            Box::new(Kernel { value: move |lag| sound.value(lag), exponentials: Some(terms) })
        }),
    ]
}
