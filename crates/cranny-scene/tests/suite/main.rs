//! Scene files, meshes and robots as people have them, by the public interfaces.
//!
//! Tests over the corpus say so where `CRANNY_CORPUS` names none, and are skipped.
#![allow(clippy::print_stderr, reason = "a skipped test must say so")]

#[path = "../../../cranny-concavity/tests/suite/concavities/bodies.rs"]
#[allow(dead_code, reason = "the tests that they are shared with use the others")]
mod bodies;
#[path = "../../../cranny-concavity/tests/suite/body.rs"]
mod body;
#[path = "../../../cranny-concavity/tests/suite/concavities/check.rs"]
#[allow(dead_code, reason = "the tests that they are shared with use the others")]
mod check;
mod corpus;
#[path = "../assets/corpus_files.rs"]
mod corpus_files;
#[path = "../../../cranny-concavity/tests/suite/deform/equal.rs"]
#[allow(dead_code, reason = "the tests that they are shared with use the others")]
mod equal;
mod filed_meshes;
mod generator_page;
mod groups;
mod includes;
mod invariants;
#[path = "../assets/meeting.rs"]
mod meeting;
mod mesh_formats;
mod misnamed;
#[path = "../../../cranny-concavity/tests/suite/deform/moves.rs"]
#[allow(dead_code, reason = "the tests that they are shared with use the others")]
mod moves;
mod polygons;
mod primitives;
mod robots;
mod scene_page;
mod scenes;
mod settings;
mod structures;
