//! Constants that are proved bounds, against values by hand: L_κ on the ζ that a run can reach, bounds on the step size by
//! region, and what the memory of an abstract problem can take from a step.

use super::good::LOADED;
use fem::contact::CaseError;
use scene::setup::{AbstractSetup, MeshData, Setup, StepRemark, Subject, ZetaFrom};
use scene::setup::{check_step_sizes, step_bounds};
use scene::{Scene, Source};

fn scene(text: &str) -> Scene {
    match Scene::from_source(Source::from_text("block.toml", text.to_string())) {
        Ok(scene) => scene,
        Err(error) => panic!("{error}"),
    }
}

fn setup(text: &str) -> Setup {
    match Setup::new(scene(text)) {
        Ok(setup) => setup,
        Err(error) => panic!("{error}"),
    }
}

fn with_kappa(kappa: &str) -> String {
    LOADED.replace("0.10 + 0.05*zeta", kappa).replace("horizon = 1.0", "horizon = 2.0")
}

/// A slope of 40 on 0.004: samples 0.05 T apart miss it. m0 = 2 - 0.5·0.5: the falling branch of the law, at depth 1/2.
#[test]
fn a_steep_part_between_samples_counts() {
    let setup = setup(&with_kappa("0.02 + 40*max(0, min(zeta - 0.03, 0.004))"));
    assert_eq!((setup.kappa.lipschitz, setup.kappa.from), (40.0, ZetaFrom::Everywhere));
    let bounds = step_bounds(&setup).expect("constants");
    // |Ω| = 1/2, ‖ℬ‖ = 1: beta_phi = 40/√2, (3.4) by m0/(2 beta_phi).
    let beta = 40.0 / 2f64.sqrt();
    assert!((bounds.limit() / (bounds.m0 / (2.0 * beta)) - 1.0).abs() < 1e-12, "{bounds:?}");
    assert!((bounds.solvable_limit() / (2.0 * bounds.m0 / (beta + 1.0)) - 1.0).abs() < 1e-12);
}

/// κ' = 0.8 ζ has no bound for all ζ; what no run reaches does not count. N = 16 makes k = 1/8.
#[test]
fn the_slope_counts_where_a_run_can_be() {
    let setup = setup(&with_kappa("0.02 + 0.4*zeta^2"));
    let kappa = setup.kappa;
    assert_eq!(kappa.from, ZetaFrom::Loads);
    assert!((kappa.lipschitz / (0.8 * kappa.zeta) - 1.0).abs() < 2e-7, "{kappa:?}");
    let zeta_of = |n, steps| {
        let data = MeshData::new(&setup, n, None).expect("a mesh");
        let mut zeta = 0.0;
        let mut last = |view: &fem::contact::StepView<'_>| {
            zeta = view.zeta;
            Ok(())
        };
        let solved = data.march(&setup, steps, &vhi::Newton::default(), &mut last);
        assert!(solved.is_ok(), "{solved:?}");
        zeta
    };
    // That of n = 8, N = 64 is doubled, which leaves room for other meshes.
    assert!((2.0 * zeta_of(8, 64) / kappa.zeta - 1.0).abs() < 1e-12, "{kappa:?}");
    let zeta = zeta_of(4, 16);
    assert!(zeta > 0.25 * kappa.zeta && zeta < 0.75 * kappa.zeta, "{zeta} {kappa:?}");
    // A run that passes the bound is no run.
    let data = MeshData::new(&setup, 4, None).expect("a mesh");
    let mut short = setup;
    short.kappa.zeta = 0.9 * zeta;
    let beyond = data.march(&short, 16, &vhi::Newton::default(), &mut |_| Ok(()));
    assert!(matches!(beyond, Err(CaseError::BeyondZeta { .. })), "{beyond:?}");
}

/// A soft half without memory (m = 1) on a stiff one (m = 100) with ℬ(0) = -20: the last slot takes w·20 of 100, and Λ contracts
/// by w·20/√(1·100) at most. With the least stiffness against the largest memory both would end at k = 0.1.
#[test]
fn regions_are_compared_each_with_its_own_stiffness() {
    let layered = LOADED
        .replace("lambda = 1.0\nmu_L = 1.0\n", "lambda = 0.0\nmu_L = 0.5\n")
        .replace("[material.memory]\nkernel = \"-exp(-t)\"\nlambda = 0.25\nmu = 0.25\n", "")
        .replace("[material.projection]\nmu = 1.0\nkappa = \"0.10 + 0.05*zeta\"\n", "")
        .replace(
            "[contact]\n",
            "[[material.region]]\nname = \"stiff\"\nwhere = \"y - 0.25\"\nlambda = 0.0\nmu_L = 50.0\n[material.region.memory]\nkernel = \"-exp(-t)\"\nlambda = 0.0\nmu = 10.0\n[contact]\n",
        );
    let start = layered.find("law = ").expect("a law");
    let end = layered[start..].find('\n').expect("a line") + start;
    let layered =
        layered.replace(&layered[start..end], "law = { kind = \"linear\", stiffness = 1.0 }");
    let bounds = step_bounds(&setup(&layered)).expect("constants");
    assert_eq!((bounds.m0, bounds.lipschitz), (1.0, 21.0));
    let close =
        |found: f64, by_hand: f64| assert!((found / by_hand - 1.0).abs() < 1e-12, "{found}");
    close(bounds.sharpened_limit(), 1.0);
    close(bounds.solvable_limit(), 10.0);
}

/// Memory that is positive or skew takes nothing from a step; of an indefinite one only the negative part counts.
#[test]
fn memory_that_cannot_take_restricts_no_step() {
    let solvable = |q: &str, matrix: &str| {
        let text = format!(
            "[scene]\nname = \"plane\"\nquestion = \"?\"\nkind = \"abstract\"\ndimension = 2\njudge = false\n[time]\nhorizon = 2.0\n[operator]\nmatrix = [[3.0, 0.0], [0.0, 3.0]]\n[history]\nkernels = [{{ q = \"{q}\", matrix = {matrix} }}]\n[exact]\nu = [\"t\", \"t\"]\n"
        );
        let setup = AbstractSetup::new(scene(&text)).map_err(|error| error.to_string())?;
        let bounds = setup.constants.step_bounds(setup.model.time_rule.as_ref());
        let remark = check_step_sizes(&Subject::Abstract(Box::new(setup)), &[1]);
        Ok::<_, String>((bounds, remark.map_err(|error| error.to_string())))
    };
    for (q, matrix, norm, limit) in [
        ("exp(s - t)", "[[5.0, 0.0], [0.0, 0.0]]", 5.0, f64::INFINITY),
        ("1 + t*s", "[[0.0, 5.0], [-5.0, 0.0]]", 25.0, f64::INFINITY),
        // Between t = 0 and t = 2 the kernel at s = t falls to -1.
        ("1 - t", "[[4.0, 0.0], [0.0, 2.0]]", 4.0, 2.0 * 3.0 / 4.0),
        ("exp(s - t)", "[[5.0, 0.0], [0.0, -1.0]]", 5.0, 2.0 * 3.0),
    ] {
        let (bounds, remark) = solvable(q, matrix).expect("a scene");
        let near =
            |found: f64, by_hand: f64| found == by_hand || (found / by_hand - 1.0).abs() < 2e-7;
        assert!(near(bounds.lipschitz, norm), "{q}: {bounds:?}");
        assert!(near(bounds.solvable_limit(), limit), "{q}: {bounds:?}");
        // k = 2 is beyond (3.4) each time.
        let runs = matches!(&remark, Ok(Some(StepRemark { warning: true, .. })));
        assert_eq!(runs, limit > 2.0, "{q}: {remark:?}");
    }
    let pole = solvable("1/(t - 0.3*s - 0.29)", "[[1.0, 0.0], [0.0, 1.0]]");
    assert!(pole.is_err_and(|error| error.contains("q(t, s) has no bound near t = ")));
}
