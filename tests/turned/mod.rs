//! Whole scenes, written once in coordinates X, Y along and across the contact side, and turned by an angle: scene file,
//! validation, meshes, truth, march, records.
//!
//! Mesh: the trapezium (0, 0), (1, 0), (1.1, 0.9), (-0.1, 1), refined, clamped above; contact below, or below and right.

use std::sync::Arc;

use fem::contact::{CaseError, CaseInfo, Discretization, Observer, march};
use judge::record::{CaseRecord, Status};
use run::sweep::{Machine, OutputDirectory, Overrides, ScenePlan, run_sweep};
use scene::setup::{MeshData, Scheme, Setup, Subject, TruthLoad, side_numbers};
use scene::{Scene, Source};
use vhi::Newton;

use crate::program::Folder;

/// What a scene is about.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kind {
    /// Exact, weak loads, all terms, a concave gap that is reached.
    Weak,
    /// The same with strong loads, without projection, Gauss points on Γ3.
    Strong,
    /// Exact in V^h, compliance integrated exactly.
    Interpolated,
    /// Loads, contact on two sides that meet, a reference run.
    Loaded,
    /// Exact on meshes that gather at a corner.
    Graded,
}

impl Kind {
    pub const ALL: [Kind; 5] =
        [Kind::Weak, Kind::Strong, Kind::Interpolated, Kind::Loaded, Kind::Graded];
}

/// The scene turned by `angle` about the origin, then moved.
pub fn text(kind: Kind, angle: f64) -> String {
    let (s, c) = angle.sin_cos();
    let turn = |[x, y]: [f64; 2]| [c * x - s * y, s * x + c * y];
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.1, 0.9], [-0.1, 1.0]].map(turn);
    let loaded = kind == Kind::Loaded;
    let [contact, traction] = match loaded {
        true => ["\"foot\", \"right\"", "\"left\""],
        false => ["\"foot\"", "\"left\", \"right\""],
    };
    let mesh = match kind {
        Kind::Graded => {
            let [x, y] = corners[2];
            format!("mesh = {{ kind = \"graded\", corner = [{x:?}, {y:?}], exponent = 1.7 }}")
        }
        _ => String::new(),
    };
    let projection = match kind {
        Kind::Strong => String::new(),
        _ => "[material.projection]\nmu = 0.8\nkappa = \"0.04 + 0.05*zeta\"".to_string(),
    };
    let quadrature = match kind {
        Kind::Strong => "gauss",
        Kind::Interpolated => "exact",
        _ => "vertex",
    };
    // X and Y in the coordinates of the scene.
    let (along, across) = (format!("({c:?}*x + ({s:?})*y)"), format!("({c:?}*y - ({s:?})*x)"));
    let gap = match kind {
        Kind::Loaded => "0.03".to_string(),
        _ => format!("0.12 + 0.02*{along}*(1 - {along})"),
    };
    let data = match loaded {
        true => {
            // (0.2 t, -1.5 t (1 + X)) in the body, (0.1 t, 0) on the left.
            let [fx, fy] = ["0.2*t".to_string(), format!("-1.5*t*(1 + {along})")];
            format!(
                "[loads]\nbody = [\"{c:?}*{fx} - ({s:?})*({fy})\", \"{s:?}*{fx} + ({c:?})*({fy})\"]\n\
                 traction = {{ left = [\"{:?}*t\", \"{:?}*t\"] }}",
                0.1 * c,
                0.1 * s
            )
        }
        false => {
            let form = match kind {
                Kind::Strong => "form = \"strong\"",
                Kind::Interpolated => "interpolated = true",
                _ => "",
            };
            // The clamped side is Y = 1 - (X + 0.1)/12.
            format!(
                "[exact]\n{form}\nu = [\"{c:?}*U - ({s:?})*V\", \"{s:?}*U + ({c:?})*V\"]\n\
                 [exact.define]\nX = \"{along}\"\nY = \"{across}\"\n\
                 top = \"1 - (X + 0.1)/12 - Y\"\n\
                 U = \"0.1*sin(2*t)*top*(1 + 0.3*sin(2*X))\"\n\
                 V = \"-0.1*t*(2 - t)*top*cos(0.5*X)\""
            )
        }
    };
    let reference = if loaded { "reference = { n = 12, steps = 4 }" } else { "" };
    let vertices: Vec<String> = corners.iter().map(|[x, y]| format!("[{x:?}, {y:?}]")).collect();
    format!(
        "[scene]\nname = \"turned\"\nquestion = \"Does the angle matter?\"\ndimension = 2\njudge = false\n\
         violates = [\"2.9\"]\n\
         [domain]\nshape = \"polygon\"\nvertices = [{}]\nsides = [\"foot\", \"right\", \"top\", \"left\"]\n\
         clamped = [\"top\"]\ncontact = [{contact}]\ntraction = [{traction}]\n{mesh}\n\
         [time]\nhorizon = 1.0\n\
         [material]\nlambda = 1.3\nmu_L = 0.9\n\
         [material.memory]\nkernel = \"-exp(-t)\"\nlambda = 0.25\nmu = 0.2\n{projection}\n\
         [contact]\ngap = \"{gap}\"\nquadrature = \"{quadrature}\"\n\
         law = {{ kind = \"piecewise-linear\", points = [[0.0, 0.0], [0.04, 0.08], [0.10, 0.05]], \
         slope_before = 0.0, slope_after = 0.0 }}\n\
         {data}\n[sweep]\nn = [3, 6]\nsteps = [4]\n{reference}\n",
        vertices.join(", ")
    )
}

/// The records of a scene; `scheme` takes the place of the solver.
pub fn records(text: &str, scheme: Option<Arc<dyn Scheme>>) -> Vec<CaseRecord> {
    let scene = Scene::from_source(Source::from_text("turned.toml", text));
    let scene = scene.unwrap_or_else(|error| panic!("{error}\n{text}"));
    let mut subject = Subject::new(scene).unwrap_or_else(|error| panic!("{error}"));
    if let (Subject::Contact(setup), Some(scheme)) = (&mut subject, scheme) {
        setup.scheme = scheme;
    }
    let plan = ScenePlan::new(subject, &Overrides::default());
    let folder = Folder::new("turned");
    let out = OutputDirectory::take(&folder.at("run")).unwrap_or_else(|error| panic!("{error}"));
    let records = run_sweep(&[plan], &out, &Machine::with_jobs(1), false, &())
        .unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(records.len(), 2);
    assert!(records.iter().all(|record| record.status == Status::Converged), "{records:?}");
    records
}

/// The largest difference of errors, relative to the error of the first in that norm, and its norm. The distance of contact
/// sets is relative to the side, which is 1.
pub fn difference(a: &[CaseRecord], b: &[CaseRecord]) -> (f64, String) {
    let mut worst = (0.0, String::new());
    for (a, b) in a.iter().zip(b) {
        assert_eq!((a.n, a.steps, a.dofs, a.elements), (b.n, b.steps, b.dofs, b.elements));
        assert!(((a.h.unwrap() - b.h.unwrap()) / b.h.unwrap()).abs() < 1e-14);
        assert_eq!(a.errors.len(), b.errors.len());
        assert!(a.errors.len() >= 5);
        for (p, q) in a.errors.iter().zip(&b.errors) {
            assert_eq!(p.norm, q.norm);
            let name = format!("{} of n = {:?}: {:?}, {:?}", p.norm, a.n, p.error, q.error);
            let (p, q, scale) = match (p.error, q.error) {
                (Some(x), Some(y)) if p.norm == "contact_set_max" => (x, y, 1.0),
                (Some(x), Some(y)) => (x, y, x),
                found => panic!("{}: {found:?}", p.norm),
            };
            let off = if p == q { 0.0 } else { (p - q).abs() / scale };
            if off.is_nan() || off > worst.0 {
                worst = (off, name);
            }
        }
    }
    worst
}

/// The solver on a mesh whose contact normals are wrong.
pub struct Normals(pub fn([f64; 2]) -> [f64; 2]);

impl Scheme for Normals {
    fn march(
        &self,
        setup: &Setup,
        data: &MeshData,
        steps: u32,
        observe: &mut Observer<'_>,
    ) -> Result<CaseInfo, CaseError> {
        let domain = &setup.body.domain;
        let [clamped, contact] = [&domain.clamped, &domain.contact].map(|s| side_numbers(s));
        let mut mesh = data.space.mesh.clone();
        let facets: Vec<usize> = mesh.facets_on(&contact).collect();
        for f in facets {
            let [x, y, _] = mesh.normal(f);
            mesh.facet_normal[2 * f..2 * f + 2].copy_from_slice(&(self.0)([x, y]));
        }
        let space = Discretization::new(mesh, &clamped, &contact);
        let mut load = TruthLoad(&*data.truth);
        march(&space, &setup.model, &setup.grid(steps), &mut load, &Newton::default(), observe)
    }
}
