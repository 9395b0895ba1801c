//! The search: one descent of two trees of clusters, for every question about a pair.
//!
//! `ground` places the two trees, `descent` goes down both at once and hands over pairs of clusters within reach, the nearest
//! first; a visitor looks at them and may shrink its reach or end the descent. `faces` compares the faces of two clusters,
//! eight at a time. A `cut` is where a descent ended, `kept` from query to query where that pays. All of this is single precision that keeps too much, never too little; what it keeps is decided in double
//! precision or exactly.

mod cut;
mod descent;
mod faces;
mod ground;
mod kept;
mod lanes;
mod meeting;
mod nearest;
mod parted;

pub(crate) use self::descent::Pending;
pub(crate) use self::ground::Ground;
pub(crate) use self::kept::{KeptCut, Reach};
pub(crate) use self::meeting::{first_meeting, meeting_faces, meeting_pairs, meetings_in};
pub(crate) use self::nearest::{nearest_faces, nearest_in};

#[cfg(test)]
mod tests;
