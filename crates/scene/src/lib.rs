//! Scene files: TOML, the scene as validated, and messages that name the way out.
//!
//! A file becomes a [`Scene`] part by part, or a [`SceneError`] that points at the text: `reading` gives the keys of a
//! part, and refuses unknown ones with the nearest known one; each part makes of them numbers and compiled formulas that
//! satisfy every hypothesis that can be checked without a mesh or a solve.
//!
//! Conditions that need a mesh, such as (2.9), are checked later and point at the same text by `Scene::span`.

mod abstract_scene;
mod contact;
mod data;
mod definitions;
mod domain;
mod friction;
mod gap;
mod keys;
mod law;
mod material;
mod memory;
mod reading;
pub mod setup;
mod source;
mod sweep;
mod time;
mod validated;

pub use abstract_scene::{AbstractKernel, AbstractScene, AbstractTrace};
pub use contact::Contact;
pub use data::Data;
pub use domain::{Domain, Shape, Side};
pub use exact::{FrictionBound, LoadForm};
pub use fem::contact::BoundaryRule as ContactQuadrature;
pub use fem::mesh::{Face, Family as MeshFamily};
pub use friction::Friction;
pub use law::{Law, Scale};
pub use material::{Material, Place, Projection, Region};
pub use memory::{RelaxationTerm, SingularParts};
pub use reading::nearest;
pub use source::{Inside, Registry, Result, SceneError, Source, TextFault};
pub use sweep::{Direction, Norm, Prediction, Reference, Sweep};
pub use time::{Time, TimeGrid, TimeRule};
pub use validated::{Body, Change, ContactScene, Expectation, Extension, Hypothesis, Scene};
pub use vhi::law::Curve;
