//! Source: (2.4), (2.9): c_j² and c_τ² of domains with corners, small clamped parts and a slot.
//! Goal: the one computation says what they are to the uncertainty that it states, and (2.9) is verified, refused or unknown
//! accordingly.
//! Data: tests/independent/trace_constants.py: cubics on geometric meshes beside quadratics on adaptive ones (scikit-fem).

use fem::contact::TracePart;
use scene::setup::{Constants, Setup, SetupError, Smallness, check_step_sizes, constants};
use scene::setup::{Subject, weighted_trace_constant};
use scene::{Scene, Source};
use studies::theory::bound::BoundStudy;
use vhi::law::TensorField;

/// Vertices, the clamped edge and that in contact, numbered from 1; c_j² and c_τ² by the independent program, each with half
/// of the distance between its two methods.
type Known = (&'static str, &'static str, [u32; 2], [[f64; 2]; 2]);

const KNOWN: [Known; 7] = [
    ("wide", "[-1,0],[2,0],[1,1],[0,1]", [3, 1], [[14.694_242, 8e-6], [16.347_776, 8e-6]]),
    (
        "small-clamp",
        "[0,0],[1,0],[1,1],[0.05,1],[0,1]",
        [4, 1],
        [[842.587_1, 2.3e-3], [2_724.097_7, 7.3e-3]],
    ),
    (
        "slot",
        "[0,0],[2,0],[2,0.4],[0.5,0.4],[0.5,0.6],[2,0.6],[2,1],[0,1]",
        [7, 1],
        [[218.902_49, 1.9e-4], [52.556_64, 2.9e-5]],
    ),
    (
        "l",
        "[0,0],[2,0],[2,1],[1,1],[1,2],[0,2]",
        [5, 2],
        [[19.167_407_9, 2.1e-7], [48.656_808_6, 6.1e-6]],
    ),
    ("bar", "[0,0],[4,0],[4,1],[0,1]", [4, 1], [[263.262_949_5, 3.9e-6], [26.250_807_7, 3.2e-7]]),
    (
        "kite",
        "[0,0],[1,0],[1.5,2],[0.25,0.5]",
        [2, 4],
        [[2.502_035_2, 4.2e-7], [3.266_453_4, 7.2e-7]],
    ),
    ("wedge", "[0,0],[1,0],[0,0.25]", [3, 1], [[222.368_49, 2.8e-4], [11.280_637, 7.3e-6]]),
];

/// A body with λ = μ_L = 1, m_𝒜 = 2, under a law that falls by `alpha`.
fn body((name, vertices, [clamped, contact], _): &Known, alpha: f64) -> Result<Setup, SetupError> {
    let edges = vertices.split("],").count() as u32;
    let free = (1..=edges).filter(|edge| edge != clamped && edge != contact);
    let free: Vec<String> = free.map(|edge| format!("\"s{edge}\"")).collect();
    let law = match alpha {
        0.0 => "{ kind = \"linear\", stiffness = 1.0 }\nfriction = { bound = \"0.1\" }".to_string(),
        _ => format!(
            "{{ kind = \"piecewise-linear\", points = [[0.0, 0.0], [0.0, {alpha}], [1.0, 0.0]], slope_before = 0.0, slope_after = 0.0 }}"
        ),
    };
    let text = format!(
        r#"[scene]
name = "{name}"
question = "What are its constants?"
dimension = 2
judge = false
[domain]
shape = "polygon"
vertices = [{vertices}]
clamped = ["s{clamped}"]
traction = [{}]
contact = ["s{contact}"]
[time]
horizon = 1.0
[material]
lambda = 1.0
mu_L = 1.0
[contact]
law = {law}
[loads]
body = ["0", "-0.1*t"]
"#,
        free.join(", ")
    );
    Setup::new(Scene::from_source(Source::from_text("domain.toml", text)).expect("a scene"))
}

fn sound(known: &Known) -> (Setup, Constants) {
    let setup = body(known, 0.0).unwrap_or_else(|error| panic!("{}: {error}", known.0));
    let found = constants(&setup).expect("constants");
    (setup, found)
}

/// Within the stated uncertainty, which is small, and above every value of a conforming space.
#[test]
fn trace_constants_are_those_of_an_independent_computation() {
    for known in &KNOWN {
        let (setup, found) = sound(known);
        for (part, [exact, off]) in [TracePart::Normal, TracePart::Tangential].iter().zip(known.3) {
            let constant =
                weighted_trace_constant(&setup.body.domain, &TensorField::identity(), *part, &[]);
            let constant = constant.expect("a constant");
            let [value, uncertainty] = [constant.value, constant.uncertainty];
            println!(
                "{:12} {part:?}: {value:.6} ± {uncertainty:.1e}, {:.1e} off, {:?}",
                known.0,
                value - exact,
                constant.values
            );
            assert!((value - exact).abs() <= uncertainty + off, "{}: {value} {exact}", known.0);
            assert!(uncertainty > 0.0 && uncertainty < 2e-3 * exact, "{}: {uncertainty}", known.0);
            assert!(constant.values.iter().all(|(_, value)| *value < exact + off), "{}", known.0);
            let said = match part {
                TracePart::Normal => (found.c_j_squared, found.c_j_range),
                TracePart::Tangential => (found.c_tau_squared, found.c_tau_range),
            };
            assert_eq!(said, (value, constant.range()), "{}", known.0);
        }
    }
}

/// m0 = 2 - α c_j².
#[test]
fn smallness_is_verified_refused_or_unknown() {
    let [wide, small] = [&KNOWN[0], &KNOWN[1]];
    let holds = body(wide, 0.13).expect("m0 = 0.0897");
    let found = constants(&holds).expect("constants");
    assert_eq!(found.smallness(), Smallness::Holds);
    assert!((found.m0 - (2.0 - 0.13 * 14.694_242)).abs() < 1e-3, "{}", found.m0);
    // The limit in `bound` is the same number.
    let bound = BoundStudy::new(&holds, 2, 2).expect("a study");
    let limit = bound.constants.iter().find(|row| row.name == "c_j^2, limit").expect("a row");
    assert_eq!(limit.value, found.c_j_squared);
    let m0 = bound.constants.iter().find(|row| row.name == "m0").expect("a row");
    assert_eq!(m0.value, found.m0);
    let refused = body(small, 0.003).err().expect("m0 = -0.53").to_string();
    assert!(refused.contains("(2.9) fails"), "{refused}");
    // α = m_𝒜/c_j², to the last digit: either sign lies within the uncertainty.
    for known in [wide, small] {
        let alpha = 2.0 / sound(known).1.c_j_squared;
        let setup = body(known, alpha).expect("neither verified nor refused");
        assert_eq!(constants(&setup).expect("constants").smallness(), Smallness::Unknown);
        let remark = check_step_sizes(&Subject::Contact(Box::new(setup)), &[4]).expect("a run");
        let text = remark.map_or(String::new(), |remark| remark.text);
        assert!(text.contains("not known whether (2.9) holds"), "{text}");
    }
}
