//! `[material]`: stresses of given strains, kernels at given times.

use algebra::tensor::Symmetric;
use scene::setup::{Setup, elasticity, memory_tensor};
use vhi::law::{MemoryKernel, TensorField};

use super::{BLOCK, ORIGIN, Tie, near, value, with};

pub const TIES: &[Tie] = &[
    (&["material.lambda", "material.mu_L"], lame),
    (&["material.E", "material.nu"], young),
    (&["material.elasticity.kind", "material.elasticity.mandel"], full),
    (
        &[
            "material.elasticity.normal",
            "material.elasticity.coupling",
            "material.elasticity.shear",
        ],
        orthotropic,
    ),
    (&["material.memory.lambda", "material.memory.mu"], memory),
    (&["material.memory.bulk", "material.memory.shear"], bulk_and_shear),
    (&["material.memory.singular", "material.region.memory.singular"], singular),
    (
        &[
            "material.memory.kernel.kind",
            "material.memory.kernel.amplitude",
            "material.memory.kernel.time",
            "material.memory.kernel.exponent",
            "material.memory.kernel.terms",
        ],
        kernels,
    ),
    (
        &[
            "material.memory.terms.kernel",
            "material.memory.terms.inner",
            "material.memory.terms.lambda",
            "material.memory.terms.mu",
        ],
        terms,
    ),
    (
        &[
            "material.region.memory.terms.kernel",
            "material.region.memory.terms.inner",
            "material.region.memory.terms.lambda",
            "material.region.memory.terms.mu",
        ],
        terms_of_a_region,
    ),
    (&["material.projection.mu", "material.projection.kappa"], projection),
    (
        &[
            "material.region.name",
            "material.region.where",
            "material.region.lambda",
            "material.region.mu_L",
            "material.region.memory.kernel",
            "material.region.memory.lambda",
            "material.region.memory.mu",
        ],
        region,
    ),
    (&["material.region.E", "material.region.nu"], young_of_a_region),
    (&["material.region.memory.bulk", "material.region.memory.shear"], bulk_and_shear_of_a_region),
    (&["material.region.physical"], physical),
    (
        &[
            "material.region.elasticity.kind",
            "material.region.elasticity.mandel",
            "material.region.elasticity.normal",
            "material.region.elasticity.coupling",
            "material.region.elasticity.shear",
        ],
        tensors_of_a_region,
    ),
];

/// ε_xx = 0.1, ε_yy = -0.3, ε_xy = 0.2.
const STRAIN: Symmetric<3> = [0.1, -0.3, 0.2 * std::f64::consts::SQRT_2];
const LAME: &str = "lambda = 1.7\nmu_L = 0.9";

/// σ_xx, σ_yy, σ_xy by both sides: the solver's tensor in a region, and the exact side's numbers there.
#[track_caller]
fn stresses(setup: &Setup, region: usize, exact: [f64; 3]) {
    let found = tensor(setup).on(region).apply::<3>(&STRAIN);
    near(found[0], exact[0]);
    near(found[1], exact[1]);
    near(found[2], std::f64::consts::SQRT_2 * exact[2]);
    let built = &setup.model.elasticity;
    assert_eq!(built.on(region).apply::<3>(&STRAIN), found);
}

fn tensor(setup: &Setup) -> TensorField {
    elasticity(&setup.body.material)
}

fn with_material(text: &str) -> Setup {
    crate::shipped::setup_of(with(BLOCK, &[(LAME, text)]))
}

/// σ = 2 μ ε + λ tr ε I with tr ε = -0.2.
fn isotropic(lambda: f64, mu: f64) -> [f64; 3] {
    [0.2 * mu - 0.2 * lambda, -0.6 * mu - 0.2 * lambda, 0.4 * mu]
}

fn lame() {
    stresses(&with_material(LAME), 0, isotropic(1.7, 0.9));
}

/// λ = E ν/((1 + ν)(1 - 2 ν)), μ = E/(2 (1 + ν)): 5, 0.25 give 2 and 2.
fn young() {
    stresses(&with_material("E = 5.0\nnu = 0.25"), 0, isotropic(2.0, 2.0));
    stresses(&with_material("E = 3.0\nnu = 0.2"), 0, isotropic(5.0 / 6.0, 1.25));
}

const FULL: &str = "elasticity = { kind = \"full\", mandel = [[4.0, 1.0, 0.3], [1.0, 2.0, 0.2], [0.3, 0.2, 1.6]] }";
const ORTHOTROPIC: &str =
    "elasticity = { kind = \"orthotropic\", normal = [4.0, 2.0], coupling = [1.0], shear = [0.8] }";

/// Rows of the matrix times (0.1, -0.3, 0.2 √2); the third gives √2 σ_xy.
fn full_stress() -> [f64; 3] {
    let root = std::f64::consts::SQRT_2;
    [0.4 - 0.3 + 0.06 * root, 0.1 - 0.6 + 0.04 * root, (0.03 - 0.06 + 0.32 * root) / root]
}

/// σ_xx = 4 ε_xx + ε_yy, σ_yy = ε_xx + 2 ε_yy, σ_xy = 2 · 0.8 ε_xy.
const ORTHOTROPIC_STRESS: [f64; 3] = [0.4 - 0.3, 0.1 - 0.6, 0.32];

fn full() {
    stresses(&with_material(FULL), 0, full_stress());
}

fn orthotropic() {
    stresses(&with_material(ORTHOTROPIC), 0, ORTHOTROPIC_STRESS);
}

/// The block with more lines in [material].
fn more(text: &str) -> Setup {
    with_material(&format!("{LAME}\n{text}"))
}

/// ℬ(t)ε of a region, all terms of the model.
fn remembered(setup: &Setup, region: usize, t: f64) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for (term, written) in setup.model.memory.iter().zip(&setup.body.material.memory) {
        let found = term.tensor.on(region).apply::<3>(&STRAIN);
        assert_eq!(memory_tensor(written).on(region).apply::<3>(&STRAIN), found);
        (0..3).for_each(|i| sum[i] += term.kernel.value(t) * found[i]);
        near(value(&setup.scene, written.kernel, at(t)), term.kernel.value(t));
    }
    sum
}

fn at(t: f64) -> formula::EvaluationPoint {
    formula::EvaluationPoint { t, ..ORIGIN }
}

#[track_caller]
fn all_near(found: [f64; 3], exact: [f64; 3], factor: f64) {
    near(found[0], factor * exact[0]);
    near(found[1], factor * exact[1]);
    near(found[2], factor * std::f64::consts::SQRT_2 * exact[2]);
}

const MEMORY: &str = "[material.memory]\nkernel = \"-exp(-2*t)\"\nlambda = 0.35\nmu = 0.15";

fn memory() {
    let setup = more(MEMORY);
    all_near(remembered(&setup, 0, 0.0), isotropic(0.35, 0.15), -1.0);
    all_near(remembered(&setup, 0, 0.5), isotropic(0.35, 0.15), -(-1.0f64).exp());
}

/// bulk tr ε I + 2 shear ε^D with ε^D = ε - tr ε/2 I = (0.2, -0.2, 0.2).
fn bulk_and_shear() {
    let setup = more("[material.memory]\nbulk = \"-0.5\"\nshear = \"0.1*t\"");
    all_near(remembered(&setup, 0, 2.0), [0.1 + 0.08, 0.1 - 0.08, 0.08], 1.0);
}

/// t^{-1/2} and t^{-1/4} times the kernels: at t = 4 a half of e^{-8}, at t = 16 a half of bulk and shear.
fn singular() {
    let rule = ("horizon = 1.5", "horizon = 1.5\nrule = \"product-integration\"");
    let memory = "memory = { bulk = \"-0.5\", shear = \"0.1\", singular = 0.25 }";
    let text =
        format!("{LAME}\n{MEMORY}\nsingular = 0.5\n{REGION}lambda = 0.4\nmu_L = 1.3\n{memory}");
    let setup = crate::shipped::setup_of(with(BLOCK, &[rule, (LAME, &text)]));
    all_near(remembered(&setup, 0, 4.0), isotropic(0.35, 0.15), -0.5 * (-8.0f64).exp());
    // -0.5 tr ε I + 2 · 0.1 ε^D = (0.1 + 0.04, 0.1 - 0.04, 0.04).
    all_near(remembered(&setup, 1, 16.0), [0.14, 0.06, 0.04], 0.5);
    let powers: Vec<f64> = setup.model.memory.iter().map(|term| term.kernel.power()).collect();
    assert_eq!(powers, [0.5, 0.25, 0.25]);
    near(setup.model.memory[0].kernel.factor(0.5), -(-1.0f64).exp());
}

const TERMS: &str = "[material.memory]\nterms = [{ kernel = \"-exp(-2*t)\", lambda = 0.35, mu = 0.15 }, { kernel = \"3*t\", inner = \"exp(-t)\", lambda = 0.2, mu = 0.3 }]\n";

/// The q and r of a nested term at a lag.
fn both(kernel: &dyn MemoryKernel, t: f64) -> [f64; 2] {
    kernel.nested().expect("a history of a history").map(|kernel| kernel.value(t))
}

/// The second term is that of q = 3 t before ∫ e^{-(s-τ)} u(τ) dτ.
fn terms() {
    let setup = more(TERMS);
    let [plain, nested] = &setup.model.memory[..] else { panic!("two terms") };
    assert!(plain.kernel.nested().is_none());
    near(plain.kernel.value(0.5), -(-1.0f64).exp());
    all_near(plain.tensor.on(0).apply::<3>(&STRAIN), isotropic(0.35, 0.15), 1.0);
    let [q, r] = both(&*nested.kernel, 0.5);
    near(q, 1.5);
    near(r, (-0.5f64).exp());
    all_near(nested.tensor.on(0).apply::<3>(&STRAIN), isotropic(0.2, 0.3), 1.0);
}

fn terms_of_a_region() {
    let term = "{ kernel = \"2*t\", inner = \"exp(-3*t)\", lambda = 0.55, mu = 0.05 }";
    let region = format!("{REGION}lambda = 0.4\nmu_L = 1.3\nmemory = {{ terms = [{term}] }}");
    let setup = more(&format!("{TERMS}{region}"));
    let nested = &setup.model.memory[2];
    let [q, r] = both(&*nested.kernel, 0.5);
    near(q, 1.0);
    near(r, (-1.5f64).exp());
    all_near(nested.tensor.on(1).apply::<3>(&STRAIN), isotropic(0.55, 0.05), 1.0);
    all_near(nested.tensor.on(0).apply::<3>(&STRAIN), [0.0; 3], 1.0);
}

fn kernels() {
    let kernel = |table: &str| {
        let text = format!("[material.memory]\nkernel = {{ {table} }}\nlambda = 0.35\nmu = 0.15");
        more(&text)
    };
    let of = |setup: &Setup, t: f64| {
        let kernel: &dyn MemoryKernel = &*setup.model.memory[0].kernel;
        kernel.value(t)
    };
    let exponential = kernel("kind = \"exponential\", amplitude = -0.4, time = 0.25");
    near(of(&exponential, 0.5), -0.4 * (-2.0f64).exp());
    let prony = kernel("kind = \"prony\", terms = [[-0.5, 0.25], [-0.3, 2.0]]");
    near(of(&prony, 0.5), -0.5 * (-2.0f64).exp() - 0.3 * (-0.25f64).exp());
    let power = kernel("kind = \"power\", amplitude = -0.4, time = 0.5, exponent = 1.5");
    near(of(&power, 1.5), -0.4 * 4f64.powf(-1.5));
}

/// μ(ε - P ε): beyond the limit the deviator's excess. With |ε^D| = √(2 · 0.04 + 2 · 0.04) = 0.4 the limit κ leaves the
/// share κ/0.4 of it.
fn projection() {
    let setup = more("[material.projection]\nmu = 0.6\nkappa = \"0.10 + 0.05*zeta\"");
    near(setup.projection_mu(), 0.6);
    let written = setup.body.material.projection.as_ref().expect("a projection");
    near(written.mu, 0.6);
    let at = formula::EvaluationPoint { zeta: 2.0, ..ORIGIN };
    near(value(&setup.scene, written.kappa, at), 0.2);
    near(written.lipschitz, 0.05);
}

const REGION: &str = "[[material.region]]\nname = \"upper\"\nwhere = \"y - 0.25\"\n";

/// Region 1 has numbers beside those of the body, which region 0 has.
fn region() {
    let memory = "memory = { kernel = \"-exp(-2*t)\", lambda = 0.55, mu = 0.05 }";
    let setup = more(&format!("{MEMORY}\n{REGION}lambda = 0.4\nmu_L = 1.3\n{memory}"));
    assert_eq!(setup.body.material.regions[0].name, "upper");
    stresses(&setup, 0, isotropic(1.7, 0.9));
    stresses(&setup, 1, isotropic(0.4, 1.3));
    all_near(remembered(&setup, 0, 0.5), isotropic(0.35, 0.15), -(-1.0f64).exp());
    all_near(remembered(&setup, 1, 0.5), isotropic(0.55, 0.05), -(-1.0f64).exp());
    // Of the cells of squares of 1/4 those of the upper row are in it.
    let space = setup.space(4).unwrap_or_else(|error| panic!("{error}"));
    for cell in 0..space.mesh.cell_count() {
        let [_, y, _] = space.mesh.point(space.mesh.cell(cell), &[1.0 / 3.0; 3]);
        assert_eq!(space.regions[cell], u8::from(y > 0.25));
    }
}

fn young_of_a_region() {
    let setup = more(&format!("{REGION}E = 3.0\nnu = 0.2"));
    stresses(&setup, 1, isotropic(5.0 / 6.0, 1.25));
}

fn bulk_and_shear_of_a_region() {
    let memory = "memory = { bulk = \"-0.5\", shear = \"0.1*t\" }";
    let setup = more(&format!("{REGION}lambda = 0.4\nmu_L = 1.3\n{memory}"));
    assert_eq!(remembered(&setup, 0, 2.0), [0.0; 3]);
    all_near(remembered(&setup, 1, 2.0), [0.18, 0.02, 0.08], 1.0);
}

/// layers-2.2.msh is cut at y = 1/2 into the groups `lower` and `upper`.
fn physical() {
    let shape = "shape = \"rectangle\"\nsize = [1.0, 1.0]";
    let file = "shape = \"mesh\"\nfile = \"../tests/fixtures/layers-2.2.msh\"";
    let edits = [(shape, file), ("where = \"y - 0.5\"", "physical = \"upper\"")];
    let setup = crate::shipped::setup_of(with(&crate::shipped::text("layered"), &edits));
    let space = setup.space(2).unwrap_or_else(|error| panic!("{error}"));
    for cell in 0..space.mesh.cell_count() {
        let [_, y, _] = space.mesh.point(space.mesh.cell(cell), &[1.0 / 3.0; 3]);
        assert_eq!(space.regions[cell], u8::from(y > 0.5), "{y}");
    }
}

fn tensors_of_a_region() {
    stresses(&more(&format!("{REGION}{FULL}")), 1, full_stress());
    stresses(&more(&format!("{REGION}{ORTHOTROPIC}")), 1, ORTHOTROPIC_STRESS);
}
