//! Scene files, mesh files, robots and generated worlds.
