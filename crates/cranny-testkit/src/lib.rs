//! Oracles in exact rationals, generators of hard cases, and a corpus of scenes for tests.
