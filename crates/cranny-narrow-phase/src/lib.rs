//! The exact pair query: verdicts, distances, contact curves and regions.
