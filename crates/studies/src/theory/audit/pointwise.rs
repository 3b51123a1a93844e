//! Tensors of (5.8)-(5.10) at a point, in Mandel notation, apart from the solver's laws.

use formula::{EvaluationPoint, Graph, Node};
use scene::setup::Setup;
use vhi::law::FourthOrder;

/// A symmetric plane tensor (xx, yy, √2 xy).
pub(crate) type Plane = [f64; 3];

/// a:b.
pub(crate) fn dot(a: &Plane, b: &Plane) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn minus(a: &Plane, b: &Plane) -> Plane {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// λ tr(ε) I + 2μ ε.
fn isotropic(lambda: f64, twice_mu: f64, strain: &Plane) -> Plane {
    let volumetric = lambda * (strain[0] + strain[1]);
    [twice_mu * strain[0] + volumetric, twice_mu * strain[1] + volumetric, twice_mu * strain[2]]
}

/// The tensors and functions of a scene's material.
pub(crate) struct PlainMaterial {
    elastic: [f64; 2],
    memory: Option<[f64; 2]>,
    /// μ, 0 without projection.
    mu: f64,
    kappa: Option<Node>,
    kernel: Option<Node>,
    graph: Graph,
}

impl PlainMaterial {
    /// The material of a scene; none unless it is plain: one isotropic tensor, one term of memory at most.
    pub(crate) fn new(setup: &Setup) -> Option<Self> {
        let material = &setup.body.material;
        let FourthOrder::Isotropic(law) = &material.elastic else { return None };
        if !material.is_plain() {
            return None;
        }
        let memory = material.memory.first();
        let projection = material.projection.as_ref().filter(|projection| projection.mu > 0.0);
        Some(Self {
            elastic: [law.lambda, law.mu],
            memory: memory.map(|memory| [memory.lambda, memory.mu]),
            mu: projection.map_or(0.0, |projection| projection.mu),
            kappa: projection.map(|projection| projection.kappa),
            kernel: memory.map(|memory| memory.kernel),
            graph: setup.scene.formulas.clone(),
        })
    }

    /// A of (5.8): 𝒜ε + με.
    pub(crate) fn operator(&self, strain: &Plane) -> Plane {
        let [lambda, mu] = self.elastic;
        isotropic(lambda, 2.0 * mu + self.mu, strain)
    }

    /// θ = ℬ₀ H of a remembered strain H = ∫ b(t-s) ε(u(s)) ds.
    pub(crate) fn remembered(&self, history: &Plane) -> Plane {
        let Some([lambda, mu]) = self.memory else { return [0.0; 3] };
        isotropic(lambda, 2.0 * mu, history)
    }

    /// The tensor ψ with φ(y, u, v) = (ψ, ε(v)) in (5.10): -μ P_κ ε + θ.
    pub(crate) fn coupled(&self, strain: &Plane, theta: &Plane, kappa: f64) -> Plane {
        if self.mu == 0.0 {
            return *theta;
        }
        let mean = 0.5 * (strain[0] + strain[1]);
        let half = 0.5 * (strain[0] - strain[1]);
        let size = (2.0 * half * half + strain[2] * strain[2]).sqrt();
        let factor = if size > kappa { kappa / size } else { 1.0 };
        let projected = [mean + factor * half, mean - factor * half, factor * strain[2]];
        std::array::from_fn(|i| theta[i] - self.mu * projected[i])
    }

    /// θ of a remembered strain, ψ and σ = Aε + ψ.
    pub(crate) fn tensors(&self, strain: &Plane, history: &Plane, kappa: f64) -> [Plane; 3] {
        let theta = self.remembered(history);
        let (psi, applied) = (self.coupled(strain, &theta, kappa), self.operator(strain));
        [theta, psi, std::array::from_fn(|i| applied[i] + psi[i])]
    }

    /// κ(ζ), infinite without projection.
    pub(crate) fn kappa(&self, zeta: f64) -> f64 {
        let at = EvaluationPoint { zeta, ..EvaluationPoint::default() };
        self.kappa.map_or(f64::INFINITY, |kappa| self.graph.evaluate(kappa, &at))
    }

    /// b(lag), 0 without memory.
    pub(crate) fn kernel(&self, lag: f64) -> f64 {
        let at = EvaluationPoint { t: lag, ..EvaluationPoint::default() };
        self.kernel.map_or(0.0, |kernel| self.graph.evaluate(kernel, &at))
    }

    pub(crate) fn remembers(&self) -> bool {
        self.memory.is_some()
    }
}
