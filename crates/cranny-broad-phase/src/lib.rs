//! Which bodies' boxes overlap, kept from frame to frame.
