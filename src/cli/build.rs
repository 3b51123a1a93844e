//! The build of this program.

use std::borrow::Cow;

use ::run::sweep::Build;

/// Set by build.rs.
pub(super) const BUILD: Build = Build {
    commit: Cow::Borrowed(env!("GRONWALL_COMMIT")),
    compiler: Cow::Borrowed(env!("GRONWALL_COMPILER")),
    target: Cow::Borrowed(env!("GRONWALL_TARGET")),
    optimisation: Cow::Borrowed(env!("GRONWALL_OPTIMISATION")),
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_build_knows_its_compiler() {
        assert!(BUILD.compiler.starts_with("rustc 1."), "{BUILD:?}");
        let named = ["unknown", "development build"].contains(&&*BUILD.commit);
        let known = named || BUILD.commit.chars().all(|c| c.is_ascii_hexdigit());
        assert!(known && BUILD.target.contains('-'), "{BUILD:?}");
    }
}
