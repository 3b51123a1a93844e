//! Bounded reading, atomic replacement, and disarmed foreign text.

mod atomic;
mod bounded;
mod counted;
mod error;
mod foreign;
mod hash;
mod listed;
mod quoted;

pub use atomic::{
    Replacement, make_directory, remove_if_there, replace_file, same_file, write_named,
};
pub use bounded::{open_file, read_at_most, read_file, read_file_up_to, read_text, up_to};
pub use counted::{counted, digits, megabytes, without_digits};
pub use error::{FileError, if_there};
pub use foreign::{harmless, harmless_json, shortened};
pub use hash::fnv_1a;
pub use listed::{ListError, remove_listed, write_listed};
pub use quoted::quoted;
