//! The build of this program.

use ::run::sweep::Build;

/// Set by build.rs.
pub(super) const BUILD: Build = Build {
    commit: env!("GRONWALL_COMMIT"),
    compiler: env!("GRONWALL_COMPILER"),
    target: env!("GRONWALL_TARGET"),
    optimisation: env!("GRONWALL_OPTIMISATION"),
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_build_knows_its_compiler() {
        assert!(BUILD.compiler.starts_with("rustc 1."), "{BUILD:?}");
        let named = ["unknown", "development build"].contains(&BUILD.commit);
        let known = named || BUILD.commit.chars().all(|c| c.is_ascii_hexdigit());
        assert!(known && BUILD.target.contains('-'), "{BUILD:?}");
    }
}
