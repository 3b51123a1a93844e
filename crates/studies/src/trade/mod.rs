//! Speed against accuracy, measured: runs over the knobs that a scene offers, models of error and cost, the cheapest
//! way to an error, and what each knob saves; and the error of a single run from coarser ones.

mod answer;
mod candidates;
mod composition;
mod cost_model;
mod document;
mod error_model;
pub mod estimate;
mod extrapolation;
mod grid;
mod knob;
mod measure;
mod models;
mod optimum;
mod pareto;
mod picture;
mod prices;
mod rival;
mod rounds;
mod study;
mod trial;
mod turned;

pub use answer::Answered;
pub use candidates::{Answer, NoAnswer};
pub(crate) use candidates::{AtSteps, Candidates, MOST};
pub use composition::Composition;
pub(crate) use cost_model::{CostModel, CostSample};
pub(crate) use error_model::{ErrorModel, Term};
pub use grid::{admit_trade, element_meshes, held, scene_grid};
pub use knob::{Knob, Variant, knobs};
pub use measure::Bench;
pub(crate) use models::Models;
pub(crate) use optimum::{Optimum, optimum};
pub use pareto::front;
pub(crate) use prices::Price;
pub(crate) use rival::{Equal, Rival};
pub use run::sweep::NORMS;
pub use study::{Study, TradeError, TradeRuns};
pub use trial::{Outcome, Table, Trial};
