//! The von Mises projection term μ(ε - P_{M(κ)} ε) of (5.1), M(κ) = {τ : ‖τ^D‖ ≤ κ}.

use algebra::tensor::{Symmetric, deviator, dimension, norm};

/// Stress, generalized derivative and derivative in κ at one strain.
#[derive(Debug, Clone, Copy)]
pub struct Response<const S: usize> {
    /// μ(ε - P ε).
    pub stress: Symmetric<S>,
    /// An element of the generalized Jacobian in ε.
    pub tangent: [[f64; S]; S],
    /// d stress / dκ.
    pub by_limit: Symmetric<S>,
}

/// The yield limit κ(ζ) ≥ 0 (a strain) as a function of the accumulated strain ζ.
pub trait YieldLimit: Send + Sync {
    fn value(&self, zeta: f64) -> f64;
    /// κ'(ζ), one-sided at a kink.
    fn slope(&self, zeta: f64) -> f64;
}

impl YieldLimit for Box<dyn YieldLimit> {
    fn value(&self, zeta: f64) -> f64 {
        (**self).value(zeta)
    }

    fn slope(&self, zeta: f64) -> f64 {
        (**self).slope(zeta)
    }
}

/// The extra stress of strains beyond the yield limit.
pub trait Projection: Send + Sync {
    /// The stress at `strain` for the limit `kappa`; None below the limit, where it vanishes.
    fn stress<const S: usize>(&self, strain: &Symmetric<S>, kappa: f64) -> Option<Symmetric<S>>;

    /// Stress and derivatives; None below the limit, where all vanish.
    fn response<const S: usize>(&self, strain: &Symmetric<S>, kappa: f64) -> Option<Response<S>>;

    /// κ as a function of ζ; None without projection.
    fn limit(&self) -> Option<&dyn YieldLimit>;
}

/// A projection of any type behind one pointer: what holds it is compiled once, whatever projection there is.
pub struct AnyProjection(Box<dyn InPlaneAndSpace>);

impl AnyProjection {
    pub fn new(projection: impl Projection + 'static) -> Self {
        Self(Box::new(projection))
    }

    /// [`VonMises`]. [`Self::new`] is compiled where it is called; this is compiled here, in a crate that is optimised.
    pub fn von_mises(mu: f64, limit: Box<dyn YieldLimit>) -> Self {
        Self::new(VonMises { mu, limit })
    }
}

/// [`Projection`] with its dimensions written out, as a trait object needs them.
trait InPlaneAndSpace: Send + Sync {
    fn stress_in_plane(&self, strain: &Symmetric<3>, kappa: f64) -> Option<Symmetric<3>>;
    fn stress_in_space(&self, strain: &Symmetric<6>, kappa: f64) -> Option<Symmetric<6>>;
    fn response_in_plane(&self, strain: &Symmetric<3>, kappa: f64) -> Option<Response<3>>;
    fn response_in_space(&self, strain: &Symmetric<6>, kappa: f64) -> Option<Response<6>>;
    fn yield_limit(&self) -> Option<&dyn YieldLimit>;
}

impl<Q: Projection> InPlaneAndSpace for Q {
    fn stress_in_plane(&self, strain: &Symmetric<3>, kappa: f64) -> Option<Symmetric<3>> {
        self.stress(strain, kappa)
    }

    fn stress_in_space(&self, strain: &Symmetric<6>, kappa: f64) -> Option<Symmetric<6>> {
        self.stress(strain, kappa)
    }

    fn response_in_plane(&self, strain: &Symmetric<3>, kappa: f64) -> Option<Response<3>> {
        self.response(strain, kappa)
    }

    fn response_in_space(&self, strain: &Symmetric<6>, kappa: f64) -> Option<Response<6>> {
        self.response(strain, kappa)
    }

    fn yield_limit(&self) -> Option<&dyn YieldLimit> {
        self.limit()
    }
}

/// The first T numbers of a tensor with S; both are the same number where this is used.
fn resized<const S: usize, const T: usize>(tensor: &Symmetric<S>) -> Symmetric<T> {
    std::array::from_fn(|i| tensor[i])
}

fn resized_response<const S: usize, const T: usize>(response: &Response<S>) -> Response<T> {
    Response {
        stress: resized(&response.stress),
        tangent: std::array::from_fn(|i| resized(&response.tangent[i])),
        by_limit: resized(&response.by_limit),
    }
}

impl Projection for AnyProjection {
    fn stress<const S: usize>(&self, strain: &Symmetric<S>, kappa: f64) -> Option<Symmetric<S>> {
        match dimension::<S>() {
            2 => self.0.stress_in_plane(&resized(strain), kappa).as_ref().map(resized),
            _ => self.0.stress_in_space(&resized(strain), kappa).as_ref().map(resized),
        }
    }

    fn response<const S: usize>(&self, strain: &Symmetric<S>, kappa: f64) -> Option<Response<S>> {
        match dimension::<S>() {
            2 => self.0.response_in_plane(&resized(strain), kappa).as_ref().map(resized_response),
            _ => self.0.response_in_space(&resized(strain), kappa).as_ref().map(resized_response),
        }
    }

    fn limit(&self) -> Option<&dyn YieldLimit> {
        self.0.yield_limit()
    }
}

impl<Q: Projection> Projection for Option<Q> {
    #[inline]
    fn stress<const S: usize>(&self, strain: &Symmetric<S>, kappa: f64) -> Option<Symmetric<S>> {
        self.as_ref()?.stress(strain, kappa)
    }

    #[inline]
    fn response<const S: usize>(&self, strain: &Symmetric<S>, kappa: f64) -> Option<Response<S>> {
        self.as_ref()?.response(strain, kappa)
    }

    fn limit(&self) -> Option<&dyn YieldLimit> {
        self.as_ref()?.limit()
    }
}

/// Projection onto the von Mises ball of radius κ(ζ).
pub struct VonMises<L> {
    /// μ > 0 (a stress).
    pub mu: f64,
    pub limit: L,
}

impl<L: YieldLimit> Projection for VonMises<L> {
    #[inline]
    fn stress<const S: usize>(&self, strain: &Symmetric<S>, kappa: f64) -> Option<Symmetric<S>> {
        let e = deviator(strain);
        let size = norm(&e);
        (size > kappa).then(|| {
            let factor = self.mu * (1.0 - kappa / size);
            e.map(|value| factor * value)
        })
    }

    /// μ[(1 - κ/‖e‖) I_dev + (κ/‖e‖³) e⊗e] with e = ε^D, and -μ e/‖e‖ in κ.
    #[inline]
    fn response<const S: usize>(&self, strain: &Symmetric<S>, kappa: f64) -> Option<Response<S>> {
        let e = deviator(strain);
        let size = norm(&e);
        if size <= kappa {
            return None;
        }
        let factor = self.mu * (1.0 - kappa / size);
        let direction = e.map(|value| value / size);
        let along = self.mu * kappa / size;
        let d = dimension::<S>();
        let mut tangent = [[0.0; S]; S];
        for (i, row) in tangent.iter_mut().enumerate() {
            for (j, value) in row.iter_mut().enumerate() {
                *value = along * direction[i] * direction[j];
            }
            row[i] += factor;
            if i < d {
                for value in &mut row[..d] {
                    *value -= factor / d as f64;
                }
            }
        }
        Some(Response {
            stress: e.map(|value| factor * value),
            tangent,
            by_limit: direction.map(|value| -self.mu * value),
        })
    }

    fn limit(&self) -> Option<&dyn YieldLimit> {
        Some(&self.limit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use algebra::tensor::contract;

    struct Constant;
    impl YieldLimit for Constant {
        fn value(&self, _: f64) -> f64 {
            0.1
        }
        fn slope(&self, _: f64) -> f64 {
            0.0
        }
    }

    fn differences<const S: usize>(strain: Symmetric<S>) {
        let law = VonMises { mu: 1.7, limit: Constant };
        let kappa = 0.1;
        let response = law.response(&strain, kappa).expect("beyond the limit");
        assert_eq!(Some(response.stress), law.stress(&strain, kappa));
        // Central differences with step 1e-6: truncation 1e-12·third derivative, rounding 1e-10.
        let step = 1e-6;
        for j in 0..S {
            let shifted = |sign: f64| {
                let mut moved = strain;
                moved[j] += sign * step;
                law.stress(&moved, kappa).expect("beyond the limit")
            };
            let (plus, minus) = (shifted(1.0), shifted(-1.0));
            for i in 0..S {
                let difference = (plus[i] - minus[i]) / (2.0 * step);
                assert!((difference - response.tangent[i][j]).abs() < 1e-8, "{i}{j}");
            }
        }
        let by = |k: f64| law.stress(&strain, k).expect("beyond the limit");
        let (plus, minus) = (by(kappa + step), by(kappa - step));
        for i in 0..S {
            let difference = (plus[i] - minus[i]) / (2.0 * step);
            assert!((difference - response.by_limit[i]).abs() < 1e-8);
        }
    }

    #[test]
    fn tangents_agree_with_differences() {
        differences([0.3, -0.2, 0.17]);
        differences([0.3, -0.2, 0.17, 0.05, -0.3, 0.2]);
    }

    #[test]
    fn nothing_below_the_limit_and_nonexpansive_above() {
        let law = VonMises { mu: 1.0, limit: Constant };
        assert!(law.stress(&[0.2, 0.2, 0.05], 0.1).is_none());
        // ε - Pε is firmly nonexpansive: (s1 - s2):(e1 - e2) ≥ ‖s1 - s2‖².
        let (a, b) = ([0.4, -0.1, 0.3], [-0.2, 0.5, 0.1]);
        let (sa, sb) = (law.stress(&a, 0.1).unwrap(), law.stress(&b, 0.1).unwrap());
        let ds: [f64; 3] = std::array::from_fn(|i| sa[i] - sb[i]);
        let de: [f64; 3] = std::array::from_fn(|i| a[i] - b[i]);
        assert!(contract(&ds, &de) >= contract(&ds, &ds) - 1e-15);
    }

    /// ‖ε^D‖ = κ is still below; exact in floating point for a shear of ½.
    #[test]
    fn the_yield_surface_itself_belongs_to_the_elastic_range() {
        let law = VonMises { mu: 1.0, limit: Constant };
        let strain = [0.3, 0.3, 0.5];
        assert!(law.stress(&strain, 0.5).is_none() && law.response(&strain, 0.5).is_none());
        assert!(law.stress(&strain, 0.4).is_some() && law.response(&strain, 0.4).is_some());
    }

    #[test]
    fn what_is_absent_answers_nothing_and_what_is_there_answers_for_itself() {
        let strain = [0.3, -0.2, 0.17];
        let none: Option<AnyProjection> = None;
        assert!(none.limit().is_none() && none.stress(&strain, 0.1).is_none());
        assert!(none.response(&strain, 0.1).is_none());
        fn same<const S: usize>(strain: &Symmetric<S>) {
            let law = || VonMises { mu: 1.7, limit: Constant };
            let (law, held) = (law(), Some(AnyProjection::new(law())));
            assert_eq!(law.stress(strain, 0.1), held.stress(strain, 0.1));
            let numbers = |r: Response<S>| (r.stress, r.tangent, r.by_limit);
            let response = law.response(strain, 0.1).map(numbers);
            assert!(response.is_some() && response == held.response(strain, 0.1).map(numbers));
            assert_eq!(held.limit().map(|limit| limit.value(0.0)), Some(0.1));
        }
        same(&strain);
        same(&[0.3, -0.2, 0.1, 0.17, -0.4, 0.05]);
    }
}
