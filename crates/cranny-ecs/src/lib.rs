//! One plugin per effect; the one composer of worlds, physics, recordings and pictures.
