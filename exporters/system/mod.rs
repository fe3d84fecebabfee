//! What differs between systems: files without a name, permissions, which file is which, pipes, names that
//! no file may have, and how plug-ins are ended.
//!
//! | file | is for |
//! |---|---|
//! | `unix` | Linux, macOS, the BSDs |
//! | `portable` | everything else, Windows first: what the standard library knows |
//!
//! Both have the same names and signatures; the rest of the crate asks for no system.
//! `--cfg linden_portable` builds `portable` on Unix too, as in `linden_terminal`.

#[cfg(all(unix, not(linden_portable)))]
#[path = "unix/mod.rs"]
mod desk;
#[cfg(not(all(unix, not(linden_portable))))]
#[path = "portable.rs"]
mod desk;

pub(crate) use desk::{
    DENIED, Guard, HOW_TO_ALLOW_WRITING, PIECE, REPLACES_OPEN_FILES, TELLS_FILES_APART, ask_to_end,
    change_of, compared, create_unnamed, exchange, has_no_reader, is_mine, is_null_device, is_program,
    is_ready, is_same_file, leads_in_a_circle, link_unnamed, mode_of, name_from, open_folder, opens_at_once,
    opens_no_link, read_at, refused, rename, set_mode, stdout, with_mode, with_process_group,
};
