//! Conformance of the pair query: every answer is judged by something that does not share its
//! method: rationals, brute force, closed forms, or a motion that must part the bodies.

mod agreement;
mod coherence;
mod combs;
mod contacts;
mod crossing_edges;
mod demands;
mod depth;
mod distances;
mod gaps;
mod heat;
mod needles;
mod pockets;
mod regions;
mod rounded;
mod smooth;
mod solids;
mod tracks;
mod verdict;
