//! The search: one descent of two trees of clusters, for every question about a pair.
//!
//! `ground` places the two trees; `descent` goes down both at once and hands over pairs of clusters
//! within reach, the nearest first, to a visitor that may shrink its reach or end the descent.
//! `faces` compares the faces of two clusters, eight at a time; of eight pairs of them, `apart`
//! bounds the distances and `crossings` says which cross; `features` finds which of their vertices
//! and ridges may make contacts. A `cut` is where a descent ended, `kept` from query to query where
//! that pays. `closing` bounds how far contacts count that motion has to close. All of this is in
//! single precision and keeps too much, never too little: what is not certain, double precision or
//! exact arithmetic decides.

mod apart;
mod closing;
mod crossings;
mod cut;
mod descent;
mod faces;
mod features;
mod ground;
mod kept;
mod lanes;
mod meeting;
mod nearest;
mod parted;
mod patch_pairs;
mod point;

pub(crate) use self::closing::Closing;
pub(crate) use self::features::{Candidate, Kind, Lasting, Turned, add_candidates};
pub(crate) use self::ground::Ground;
pub(crate) use self::kept::{KeptCut, Reach};
pub(crate) use self::lanes::lanes_of;
pub use self::meeting::common_point;
pub(crate) use self::meeting::{
    Lists, Meets, meeting_faces, meeting_pairs, near_clusters, near_in,
};
pub(crate) use self::nearest::{nearest_faces, nearest_in};
pub(crate) use self::patch_pairs::PatchPairs;
pub(crate) use self::point::Vicinity;

#[cfg(test)]
mod tests;
