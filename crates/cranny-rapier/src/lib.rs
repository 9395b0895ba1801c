//! Cranny's detector as rapier's narrow phase.
