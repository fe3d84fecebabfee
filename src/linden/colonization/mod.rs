//! Space colonization: crowns, points, growth (RLP07: Runions, Lane & Prusinkiewicz 2007).
