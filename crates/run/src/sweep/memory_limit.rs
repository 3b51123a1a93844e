//! Memory limit: what the user allows, or what the machine has available.

use std::fs;
use std::path::Path;
use std::str::FromStr;

/// The predicted bytes that cases may take together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MemoryLimit {
    /// ∞ if unknown.
    bytes: f64,
    /// Given by the user.
    given: bool,
}

/// A case is predicted to exceed the limit.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error(
    "{} {} of memory predicted, above the limit of {} ({source_of_limit}): not started; take a smaller n or fewer steps, or raise --memory-limit",
    if *.at_least { "at least" } else { "about" }, in_words(*.bytes), in_words(*.limit)
)]
pub struct TooLarge {
    pub bytes: f64,
    /// `bytes` is a lower bound from a coarser mesh; the mesh itself would not fit.
    pub at_least: bool,
    pub limit: f64,
    /// The origin of the limit, in words.
    pub source_of_limit: &'static str,
}

impl MemoryLimit {
    /// No limit.
    pub const NONE: Self = Self { bytes: f64::INFINITY, given: false };

    /// A limit as a user gives it.
    pub fn of_bytes(bytes: f64) -> Self {
        Self { bytes, given: true }
    }

    /// Available memory, respecting control groups; none if unknown.
    pub fn of_machine() -> Self {
        available(Path::new("/")).map_or(Self::NONE, |bytes| Self { bytes, given: false })
    }

    /// The limit in bytes.
    pub fn bytes(&self) -> f64 {
        self.bytes
    }

    /// Refuses more than the limit; NaN exceeds any limit.
    ///
    /// # Errors
    /// [`TooLarge`].
    pub fn admit(&self, bytes: f64, at_least: bool) -> Result<(), TooLarge> {
        if bytes <= self.bytes {
            return Ok(());
        }
        let source_of_limit = match self.given {
            true => "--memory-limit",
            false => "what this machine has available",
        };
        Err(TooLarge { bytes, at_least, limit: self.bytes, source_of_limit })
    }
}

impl FromStr for MemoryLimit {
    type Err = String;

    /// Bytes, with K, M, G or T for powers of 1024: `512M`, `8G`, `1.5G`.
    fn from_str(text: &str) -> Result<Self, String> {
        const UNITS: [(char, f64); 4] =
            [('K', 1024.0), ('M', 1_048_576.0), ('G', 1_073_741_824.0), ('T', 1_099_511_627_776.0)];
        let unit =
            UNITS.iter().find(|(name, _)| text.ends_with([*name, name.to_ascii_lowercase()]));
        let number = if unit.is_some() { &text[..text.len() - 1] } else { text };
        let plain = !number.is_empty() && number.chars().all(|c| c.is_ascii_digit() || c == '.');
        match number.parse::<f64>() {
            Ok(value) if plain && value > 0.0 => {
                Ok(Self::of_bytes(value * unit.map_or(1.0, |(_, factor)| *factor)))
            }
            _ => Err(format!("`{text}` is no amount of memory; 512M and 8G are")),
        }
    }
}

/// Bytes in powers of 1024, three digits.
fn in_words(bytes: f64) -> String {
    let (mut value, mut unit) = (bytes / 1024.0, "KiB");
    for larger in ["MiB", "GiB", "TiB"] {
        if value < 1024.0 {
            break;
        }
        (value, unit) = (value / 1024.0, larger);
    }
    let digits = if value < 10.0 { 2 } else { usize::from(value < 100.0) };
    format!("{value:.digits$} {unit}")
}

/// Available bytes of the system below `root`: MemAvailable, limited by the control groups of this process.
fn available(root: &Path) -> Option<f64> {
    let memory = fs::read_to_string(root.join("proc/meminfo")).ok()?;
    let line = memory.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kibibytes: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some((1024.0 * kibibytes).min(left_to_groups(root)))
}

/// What the control groups leave, ∞ without any: version 2, then version 1.
fn left_to_groups(root: &Path) -> f64 {
    let groups = fs::read_to_string(root.join("proc/self/cgroup")).unwrap_or_default();
    let mut left = f64::INFINITY;
    for line in groups.lines() {
        let mut fields = line.splitn(3, ':').skip(1);
        let (Some(controllers), Some(group)) = (fields.next(), fields.next()) else { continue };
        let (folder, names) = match controllers {
            "" => ("sys/fs/cgroup", ["memory.max", "memory.current", "inactive_file "]),
            _ if controllers.split(',').any(|controller| controller == "memory") => (
                "sys/fs/cgroup/memory",
                ["memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file "],
            ),
            _ => continue,
        };
        let top = root.join(folder);
        // A group is bound by those above it as well.
        for ancestor in Path::new(group.trim_start_matches('/')).ancestors() {
            left = left.min(left_to_group(&top.join(ancestor), names));
        }
    }
    left
}

/// The limit of a group less its use; reclaimable file cache does not count.
fn left_to_group(folder: &Path, [limit, used, forgettable]: [&str; 3]) -> f64 {
    let number = |name: &str| -> Option<f64> {
        fs::read_to_string(folder.join(name)).ok()?.trim().parse().ok()
    };
    // Version 2 writes `max` for no limit, version 1 a number beyond any memory.
    let Some(limit) = number(limit) else { return f64::INFINITY };
    let statistics = fs::read_to_string(folder.join("memory.stat")).unwrap_or_default();
    let files = statistics.lines().find_map(|line| line.strip_prefix(forgettable)?.parse().ok());
    let used = number(used).unwrap_or(0.0) - files.unwrap_or(0.0);
    (limit - used.max(0.0)).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn amounts_are_read_and_nothing_else_is() {
        let bytes = |text: &str| text.parse::<MemoryLimit>().map(|limit| limit.bytes());
        assert_eq!(bytes("1000"), Ok(1000.0));
        assert_eq!(bytes("512M"), Ok(536_870_912.0));
        assert_eq!(bytes("1.5g"), Ok(1_610_612_736.0));
        for text in ["", "M", "-1G", "0", "nan", "inf", "1e9", "8GB", "8 G", "1..5"] {
            assert!(bytes(text).is_err(), "{text}");
        }
    }

    #[test]
    fn a_refusal_has_its_numbers_and_the_way_out() {
        let limit: MemoryLimit = "512M".parse().unwrap();
        assert_eq!(limit.admit(536_870_912.0, false), Ok(()));
        let said = limit.admit(5e9, false).unwrap_err().to_string();
        for part in ["about 4.66 GiB", "512 MiB", "--memory-limit", "smaller n"] {
            assert!(said.contains(part), "{said}");
        }
        assert!(limit.admit(5e9, true).unwrap_err().to_string().contains("at least 4.66 GiB"));
        assert!(limit.admit(f64::NAN, false).is_err());
        assert_eq!(MemoryLimit::NONE.admit(1e300, false), Ok(()));
    }

    #[test]
    fn control_groups_and_the_machine_are_both_limits() {
        let root = std::env::temp_dir().join(format!("gronwall-memory-{}", std::process::id()));
        let write = |name: &str, text: &str| {
            let path = root.join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        };
        assert_eq!(available(&root), None);
        write("proc/meminfo", "MemTotal:  9000 kB\nMemAvailable:    8000 kB\n");
        assert_eq!(available(&root), Some(8_192_000.0));
        // Version 2: the group above binds, and its file cache does not count.
        write("proc/self/cgroup", "0::/outer/inner\n");
        write("sys/fs/cgroup/outer/inner/memory.max", "max\n");
        write("sys/fs/cgroup/outer/memory.max", "5000000\n");
        write("sys/fs/cgroup/outer/memory.current", "2000000\n");
        write("sys/fs/cgroup/outer/memory.stat", "anon 1500000\ninactive_file 500000\n");
        assert_eq!(available(&root), Some(3_500_000.0));
        write("proc/self/cgroup", "4:cpu:/\n7:memory,other:/job\n");
        write("sys/fs/cgroup/memory/job/memory.limit_in_bytes", "3000000\n");
        write("sys/fs/cgroup/memory/job/memory.usage_in_bytes", "1000000\n");
        assert_eq!(available(&root), Some(2_000_000.0));
        fs::remove_dir_all(&root).unwrap();
    }
}
