//! Contacts beside all that all pairs of features make, and beside what those can press and twist.

mod approaching;
mod every_pair;
mod wrenches;
