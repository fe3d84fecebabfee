//! L-systems: grammar, forecast, derivation, turtle (ABOP: Prusinkiewicz & Lindenmayer 1990).
