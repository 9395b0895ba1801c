//! End-to-end tests of the `cranny` command.
#![allow(clippy::print_stdout, reason = "tests tell what they skipped and how much they saw")]

mod accuracy;
mod bad_input;
mod certificates;
mod compare;
mod corpus;
mod dyadic;
mod harness;
mod inspect_and_check;
mod inspect_concavities;
mod joints;
mod primitives;
mod query;
mod real_meshes;
mod recover;
mod repair;
mod replay;
mod report;
mod rerun;
mod robot;
mod saved_models;
mod settings;
mod stability;
mod touching;
