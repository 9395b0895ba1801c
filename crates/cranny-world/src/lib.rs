//! Bodies, pairs, demands and events; neutral descriptions of scenes.

pub mod description;
