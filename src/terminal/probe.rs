//! What a terminal can do.
