//! Source: the contract of the program towards the machine it runs on.
//! Goal: memory is predicted before it is taken, and within a limit; the longest case begins first; reports say what made
//!   them; nothing is written but under --out; pipes stay pipes; foreign text does nothing; results that were lost are no
//!   success;
//!   every dependency has a licence that is allowed.
//! Data: small shipped scenes, and the manifests of the dependencies.

#[allow(dead_code)] // Its main is cargo's.
#[path = "../../build.rs"]
mod build;
#[cfg(target_os = "linux")] // /dev/full
mod delivered;
mod foreign;
mod licences;
mod memory;
#[cfg(unix)]
mod pipes;
mod privileges;
#[path = "../program/mod.rs"]
mod program;
mod provenance;
mod schedule;
#[path = "../shipped/mod.rs"]
mod shipped;
