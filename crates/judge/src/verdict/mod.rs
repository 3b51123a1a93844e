//! Predictions of theory compared with measurements: pass, fail or unresolved.

mod baseline;
mod constants;
mod document;
mod fitted_constant;
mod joint;
mod judge;
mod judged;
mod mesh_and_steps;
mod next;
mod prediction;
mod ruling;
mod selection;
mod table;

pub use baseline::{
    Baseline, BaselineError, ComparedRun, Comparison, Deviation, DeviationKind, Owed, Owing,
    Recorded, RecordedCase,
};
pub use constants::{Foreseen, ForeseenConstant, LeadingLine, LeadingPoint};
pub use document::{
    Cause, DocumentError, Earlier, Explanation, Failure, document, failures, read_earlier,
    restore_reasons, write_json,
};
pub use fit::Decision;
pub use fitted_constant::FittedConstant;
pub use judge::{judge, judge_foreseen};
pub use judged::{ConstantClaim, Verdict, exit_code};
pub use mesh_and_steps::MeshAndSteps;
pub use prediction::{FloorSource, Prediction, Variable};
pub use selection::{JudgedPoint, line_keys, line_points, most_frequent};
pub use table::cell_texts;
