//! Scene files, mesh files, robots and generated worlds.

pub mod mesh_file;
pub mod robot;
