//! Scene files: TOML, the scene as validated, and messages that name the way out.
//!
//! A file becomes a [`Scene`] part by part, or a [`SceneError`] that points at the text: `values` gives the keys of a
//! part, and refuses unknown ones with the nearest known one; each part makes of them numbers and compiled formulas that
//! satisfy every hypothesis that can be checked without a mesh or a solve.
//!
//! Conditions that need a mesh, such as (2.9), are checked later and point at the same text by `Scene::span`.

mod abstract_scene;
mod change;
mod choices;
mod contact;
mod curve;
mod data;
mod definitions;
mod diagnostic;
mod discretization;
mod domain;
mod elastic;
mod examples;
mod extension;
mod friction;
mod gap;
mod heading;
mod kernel;
mod keys;
mod law;
mod material;
mod memory;
mod nearest;
mod prediction;
mod projection;
mod reading;
mod region_place;
mod registry;
mod scale;
pub mod setup;
mod singular;
mod source;
mod spans;
mod sweep;
mod time;
mod validated;
mod values;
mod wording;

pub use abstract_scene::{AbstractKernel, AbstractScene, AbstractTrace};
pub use change::Change;
pub use contact::Contact;
pub use data::Data;
pub use diagnostic::{Result, SceneError, TextFault};
pub use domain::{Domain, Face, Shape, Side};
pub use exact::{FrictionBound, LoadForm};
pub use extension::Extension;
pub use fem::contact::BoundaryRule as ContactQuadrature;
pub use fem::mesh::Family as MeshFamily;
pub use friction::Friction;
pub use heading::{Expectation, Hypothesis};
pub use law::Law;
pub use material::{Material, Region};
pub use memory::{RelaxationTerm, SingularParts};
pub use nearest::nearest;
pub use prediction::{Direction, Norm, Prediction};
pub use projection::Projection;
pub use region_place::Place;
pub use registry::Registry;
pub use scale::Scale;
pub use source::{Inside, Source};
pub use spans::Spans;
pub use sweep::{Reference, Sweep};
pub use time::{Time, TimeGrid, TimeRule};
pub use validated::{Body, ContactScene, Scene};
pub use vhi::law::Curve;

#[cfg(test)]
mod tests;
