//! The manufactured side's stress (5.1) and its derivatives.

use num_dual::Dual64;

use super::cells::{Mandel, dimension};
use algebra::in_dimension;
use exact::MaterialNumbers;
use exact::constitutive::{Tensor, from_mandel, mandel, stress};
use exact::lanes::Number;

/// σ of strain and memory integrals, one per term, by [`stress`].
pub(super) fn stress_of<const S: usize, T: Number>(
    material: &MaterialNumbers,
    strain: &[T; S],
    memory: &[[T; S]],
    kappa: T,
) -> [T; S] {
    in_dimension!(dimension(S), D => {
        let memory: Vec<Tensor<D, T>> = memory.iter().map(|tensor| from_mandel(tensor)).collect();
        mandel(&stress(material, &from_mandel(strain), &memory, kappa))
    })
}

/// The derivative of σ in a direction: each argument is given with its part of the direction.
pub(super) fn stress_along<const S: usize>(
    material: &MaterialNumbers,
    strain: [Mandel<S>; 2],
    memory: impl Iterator<Item = [Mandel<S>; 2]>,
    kappa: [f64; 2],
) -> Mandel<S> {
    let dual = |[at, along]: [Mandel<S>; 2]| -> [Dual64; S] {
        std::array::from_fn(|i| Dual64::new(at[i], along[i]))
    };
    let memory: Vec<_> = memory.map(dual).collect();
    stress_of(material, &dual(strain), &memory, Dual64::new(kappa[0], kappa[1])).map(|s| s.eps)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Central differences of the stress itself, inside the ball and beyond it.
    fn against_differences<const S: usize>(strain: Mandel<S>) {
        let material = MaterialNumbers {
            lambda: 0.7,
            mu_l: 1.3,
            full: None,
            memory: vec![(0.25, 0.4)],
            projection: Some(0.9),
        };
        let memory = strain.map(|e| 0.3 - e);
        // A direction in each of strain, memory and κ.
        let unit = |j: usize| std::array::from_fn(|i| f64::from(u8::from(i == j)));
        for direction in (0..=2 * S).map(|j| (unit(j), unit(j.wrapping_sub(S)), j / (2 * S))) {
            for kappa in [0.05, 0.1, 0.5] {
                let (by_strain, by_memory, by_kappa) = direction;
                let by_kappa = by_kappa as f64;
                let at = |d: f64| -> Mandel<S> {
                    let moved = |tensor: Mandel<S>, by: Mandel<S>| -> Mandel<S> {
                        std::array::from_fn(|i| tensor[i] + d * by[i])
                    };
                    let memory = [moved(memory, by_memory)];
                    stress_of(&material, &moved(strain, by_strain), &memory, kappa + d * by_kappa)
                };
                let (up, down) = (at(1e-6), at(-1e-6));
                let memory = [[memory, by_memory]];
                let kappa = [kappa, by_kappa];
                let slope = stress_along(&material, [strain, by_strain], memory.into_iter(), kappa);
                for i in 0..S {
                    // Truncation (1e-6/0.1)², rounding 1e-16/1e-6.
                    assert!(((up[i] - down[i]) / 2e-6 - slope[i]).abs() < 1e-8, "{direction:?}");
                }
            }
        }
    }

    #[test]
    fn derivatives_agree_with_differences_of_the_stress() {
        against_differences([0.11, -0.06, 0.08]);
        against_differences([0.11, -0.06, 0.03, 0.08, -0.05, 0.04]);
    }
}
