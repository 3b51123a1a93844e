//! Tests of the program: commands, input and output, files, resuming, solvers of others; the house. One program: linking is most of what a small test costs.

#![allow(clippy::too_many_lines, reason = "tables of defects and of bad input")]

mod bad_input;
mod baseline_command;
mod bound_command;
mod broken_hypotheses;
mod circles;
mod cli;
mod diagnose_command;
mod documents;
mod equations;
mod estimates;
mod estimators_command;
mod external;
mod figures;
mod fit_tables;
mod gronwall_command;
mod house;
mod inside;
mod json_reference;
mod ladders;
mod merging;
mod next_cases;
mod owed;
#[path = "../program/mod.rs"]
mod program;
mod quadratic_commands;
mod release;
mod report_dir;
mod reproducible;
mod resume;
mod scene_keys;
#[path = "../shipped/mod.rs"]
mod shipped;
mod study_documents;
mod unfinished;
