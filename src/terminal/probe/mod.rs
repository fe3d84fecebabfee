//! What a terminal can do: what to ask it, what it said, and what follows.
//!
//! All of it but [`ask`] is values: [`queries`] are bytes that somebody else sends, after the first frame;
//! [`Findings`] collect the replies as they come, however late; [`Capabilities::conclude`] is a
//! function of them, of the [`Environment`] and of what the user insists on ([`Overrides`]). It can
//! be called at any time, before the first reply as after the last.
//!
//! ```
//! use linden_terminal::input::Reply;
//! use linden_terminal::probe::{Capabilities, Environment, Findings, Graphics, Overrides};
//! let environment = Environment::from_pairs([("TERM", "xterm-256color"), ("SSH_TTY", "/dev/pts/3")]);
//! let mut findings = Findings::default();
//! for reply in [Reply::Version("foot(1.16.2)".into()), Reply::Attributes(vec![62, 4, 22])] {
//!     findings.take(&reply);
//! }
//! let found = Capabilities::conclude(&findings, &environment, &Overrides::default());
//! assert_eq!(found.graphics.value, Graphics::Sixel);
//! assert_eq!(found.graphics.why, "the terminal says so (DA1: 4)");
//! ```

mod capabilities;
mod environment;
mod findings;
mod overrides;

pub use crate::system::ask;
pub use capabilities::{Capabilities, Graphics, Told};
pub use environment::{Environment, Multiplexer};
pub use findings::{Findings, queries};
pub use overrides::{OverrideError, Overrides};

#[cfg(test)]
#[path = "situations_tests.rs"]
mod situations;
