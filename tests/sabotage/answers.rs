//! Answers of another solver: the built-in solution as arrays comes back with its errors; an answer that is wrong in one
//! place alone, on Γ1, at a level, on Γ3, is refused or changes an error.

use fem::contact::StepView;
use fem::norms::{StepErrors, step_errors};
use run::external::{Answer, Given, InProcess, Solve};
use scene::setup::{MeshData, NewtonMarch, Scheme, Setup};

use crate::catalogue::Defect;
use crate::shipped::{on_mesh, setup};

const STEPS: u32 = 3;
/// A multiplier on Γ3 in V^h, a moving zone, midpoints, space.
const ANSWERED: [(&str, u32); 4] =
    [("affine-locked", 2), ("signorini", 4), ("quadratic-elastic", 2), ("pure-box", 2)];

struct Stage {
    setup: Setup,
    data: MeshData,
    sound: Answer,
    errors: Vec<StepErrors>,
}

pub struct Answers(Vec<Stage>);

/// A change of one part of an answer, by the levels, the data and the array.
type Wrong = fn(&MeshData, &mut Answer);

fn levels(answer: &Answer) -> usize {
    answer.displacement.len() / (STEPS as usize + 1)
}

/// Where an answer may be wrong alone.
const WRONG: [(&str, Wrong); 5] = [
    ("on Γ1", |data, answer| {
        let (nodes, row) = (&data.space.nodes, levels(answer));
        for &vertex in &nodes.vertex[nodes.free..] {
            answer.displacement[2 * row + nodes.dimension * vertex as usize] += 1e-3;
        }
    }),
    ("as a whole", |data, answer| {
        let d = data.space.mesh.dimension;
        answer.displacement.iter_mut().step_by(d).for_each(|u| *u += 1e-3);
    }),
    ("at the last level", |_, answer| {
        let row = levels(answer);
        let last = answer.displacement.len() - row;
        answer.displacement[last..].iter_mut().for_each(|u| *u *= 1.001);
    }),
    ("at a free vertex", |data, answer| {
        let nodes = &data.space.nodes;
        let at = 2 * levels(answer) + nodes.dimension * nodes.vertex[nodes.free - 1] as usize;
        answer.displacement[at] += 1e-6;
    }),
    ("in the pressure at the last level", |_, answer| {
        let pressure = answer.pressure.as_mut().expect("pressures");
        if let Some(last) = pressure.last_mut() {
            *last += 1e-3;
        }
    }),
];

impl Answers {
    pub fn new() -> Self {
        Self(ANSWERED.map(|(name, n)| Stage::new(name, n)).into())
    }

    /// The first answer that a program with this defect takes for another one.
    pub fn misread(&self, defect: &Defect) -> Option<String> {
        self.0.iter().find_map(|stage| stage.misread(defect))
    }
}

impl Stage {
    fn new(name: &str, n: u32) -> Self {
        let setup = setup(name);
        let data = on_mesh(&setup, n);
        let (mut u, mut pressure) = (Vec::new(), Vec::new());
        let nodes = &data.space.nodes;
        let run = NewtonMarch.march(&setup, &data, STEPS, &mut |view| {
            for &node in &nodes.of_vertex {
                let at = node as usize * nodes.dimension;
                u.extend_from_slice(&view.u[at..at + nodes.dimension]);
            }
            pressure.extend(view.compliance.iter().zip(view.multiplier).map(|(a, b)| a + b));
            Ok(())
        });
        run.unwrap_or_else(|error| panic!("{error}"));
        let sound = Answer { displacement: u, pressure: Some(pressure) };
        let errors = errors(&NewtonMarch, &setup, &data).expect("a run");
        Self { setup, data, sound, errors }
    }

    fn misread(&self, defect: &Defect) -> Option<String> {
        let name = &self.setup.scene.name;
        let judged = |answer: &Answer| {
            let given = Read { answer, read: defect.answer };
            errors(&InProcess(given), &self.setup, &self.data)
        };
        let sound = match judged(&self.sound) {
            Ok(errors) => errors,
            Err(reason) => return Some(format!("{name}: {reason}")),
        };
        // Histories are summed over displacements here, over unknowns or coefficients there.
        let off = |(a, b): (f64, f64)| {
            (a - b).abs().is_nan() || (a - b).abs() > 1e-10 * b.abs().max(1e-6)
        };
        let of = |e: &StepErrors| [e.v, e.l2, e.stress, e.trace, e.pressure];
        let pairs = sound.iter().zip(&self.errors).flat_map(|(a, b)| of(a).into_iter().zip(of(b)));
        if sound.len() != self.errors.len() || pairs.into_iter().any(off) {
            return Some(format!("{name}: another error than that of its run"));
        }
        WRONG.iter().find_map(|(place, change)| {
            let mut answer = self.sound.clone();
            change(&self.data, &mut answer);
            let unseen = answer != self.sound && judged(&answer).is_ok_and(|found| found == sound);
            unseen.then(|| format!("{name}: an answer that is wrong {place} has the same errors"))
        })
    }
}

/// An answer as a program with a defect reads it.
struct Read<'a> {
    answer: &'a Answer,
    read: fn(&MeshData, &mut Answer),
}

impl Solve for Read<'_> {
    fn solve(&self, _: &Given, data: &MeshData) -> Result<Answer, String> {
        let mut answer = self.answer.clone();
        (self.read)(data, &mut answer);
        Ok(answer)
    }
}

fn errors(scheme: &dyn Scheme, setup: &Setup, data: &MeshData) -> Result<Vec<StepErrors>, String> {
    let mut found = Vec::new();
    let run = scheme.march(setup, data, STEPS, &mut |view: &StepView<'_>| {
        let moments = data.truth.moments(view.t)?;
        found.push(step_errors(&data.space, &setup.model, view, &moments));
        Ok(())
    });
    run.map(|_| found).map_err(|error| error.to_string())
}
