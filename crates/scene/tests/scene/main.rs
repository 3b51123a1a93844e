//! Scenes that must be read, and scenes that must be refused.

extern crate gronwall_scene as scene;

mod accepted;
mod good;
mod kinds;
mod laws;
mod malformed;
mod mesh_files;
mod parts;
mod proved;
mod shapes;
mod shipped;
mod unreadable;
