//! Frames to and from MCAP.
