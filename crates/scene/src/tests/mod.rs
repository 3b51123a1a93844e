//! Scenes that must be read, and scenes that must be refused.

mod accepted;
mod good;
mod kinds;
mod laws;
mod malformed;
mod mesh_files;
mod proved;
mod shapes;
mod shipped;
mod unreadable;
