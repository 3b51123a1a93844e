//! Tests of the library: schemes, histories, laws, loads, norms, orders, constants and studies against values from outside. One program: linking is most of what a small test costs.

#![allow(clippy::too_many_lines, reason = "tables of defects and of bad input")]

mod abstract_problem;
#[path = "../again/mod.rs"]
mod again;
mod audit;
mod bound;
mod boundary_rules;
mod broken_effects;
mod constants;
mod contact_states;
mod coulomb;
mod coverage;
mod diagnose;
mod differences;
mod estimate;
mod estimators;
mod exact_boxes;
mod extremes;
mod fixtures_affine;
mod fixtures_punch;
mod fixtures_pure_strong;
mod floors;
mod friction;
mod friction_bounds;
mod friction_independent;
mod friction_space;
mod gronwall;
mod histories;
mod judged;
mod keys;
mod laws;
mod load_totals;
mod loads;
mod materials;
mod nested;
mod newton;
mod oblique;
mod plans;
#[path = "../program/mod.rs"]
mod program;
mod quadratic;
mod quadratic_studies;
mod samples;
mod second_integral;
mod separate_evaluation;
#[path = "../shipped/mod.rs"]
mod shipped;
mod side_laws;
mod singular;
mod static_friction;
mod step_size;
mod symmetry;
mod tangent;
mod trace_constants;
mod trade;
#[path = "../turned/mod.rs"]
mod turned;
#[path = "../wrong/mod.rs"]
mod wrong;
