//! How much memory work may hold: what the user says, else half of what the machine, or the container
//! that this runs in, has.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use linden::knob::excerpt;

/// The variable that says it where no flag does.
pub const VARIABLE: &str = "LINDEN_MEMORY";

/// What the user may write.
pub const TAKES: &str = "auto, or bytes like 4G, 1.5G or 800M (powers of 1024)";

/// Less holds no tree, and is a mistaken unit.
const LEAST_BYTES: u64 = 16 << 20;

static LIMIT: OnceLock<u64> = OnceLock::new();

/// Sets the limit for all work from now on; the first call counts. `None`: half of what there is.
pub fn set_limit(chosen: Option<u64>) {
    LIMIT.get_or_init(|| chosen.unwrap_or_else(half));
}

/// Bytes that work may hold at once.
pub fn limit() -> u64 {
    *LIMIT.get_or_init(half)
}

/// Half of the memory; no limit where it is not known how much there is.
fn half() -> u64 {
    [machine(), cgroup(Path::new("/"))].into_iter().flatten().min().map_or(u64::MAX, |bytes| bytes / 2)
}

/// An amount as the user writes it; `None`: automatic.
///
/// # Errors
/// What was expected instead.
pub fn parse(text: &str) -> Result<Option<u64>, String> {
    let text = text.trim();
    if text == "auto" {
        return Ok(None);
    }
    let fault = || format!("'{}' is no amount of memory: expected {TAKES}", excerpt(text));
    let upper = text.to_ascii_uppercase();
    let plain = upper.strip_suffix("IB").or(upper.strip_suffix('B')).unwrap_or(&upper);
    let (digits, shift) = match plain.char_indices().last() {
        Some((at, unit)) if !unit.is_ascii_digit() => {
            let power = "KMGT".find(unit).ok_or_else(fault)?;
            (&plain[..at], 10 * (power + 1))
        }
        _ => (plain, 0),
    };
    let amount: f64 = digits.trim().parse().map_err(|_| fault())?;
    let bytes = amount * (1_u64 << shift) as f64;
    if !(bytes >= LEAST_BYTES as f64) || !bytes.is_finite() {
        return Err(format!("'{}' is less than 16M or no number: expected {TAKES}", excerpt(text)));
    }
    Ok(Some(bytes as u64))
}

/// What the machine has, bytes.
fn machine() -> Option<u64> {
    let kind = sysinfo::RefreshKind::nothing().with_memory(sysinfo::MemoryRefreshKind::nothing().with_ram());
    let system = sysinfo::System::new_with_specifics(kind).ok()?;
    Some(system.total_memory()).filter(|bytes| *bytes > 0)
}

/// What the control groups of this process allow, bytes: the least of its group and all above it, of
/// either version. `root` is where `proc` and `sys` are.
fn cgroup(root: &Path) -> Option<u64> {
    let groups = std::fs::read_to_string(root.join("proc/self/cgroup")).ok()?;
    let files = groups.lines().filter_map(|line| {
        // `4:memory:/a/b` of version 1, `0::/a/b` of version 2.
        let (controllers, path) = line.split_once(':')?.1.split_once(':')?;
        let (base, file) = match controllers {
            "" => ("sys/fs/cgroup", "memory.max"),
            controllers if controllers.split(',').any(|controllers| controllers == "memory") => {
                ("sys/fs/cgroup/memory", "memory.limit_in_bytes")
            }
            _ => return None,
        };
        Some((root.join(base), path.trim_start_matches('/').to_owned(), file))
    });
    files.flat_map(|(base, path, file)| limits(&base, &path, file)).min()
}

/// The limits of a group and of those above it. A container may not see the upper part of its path:
/// what is not there limits nothing.
fn limits(base: &Path, path: &str, file: &str) -> Vec<u64> {
    let group_path = PathBuf::from(path);
    let groups = group_path.ancestors().map(|group| base.join(group).join(file));
    groups.filter_map(|file| std::fs::read_to_string(file).ok()?.trim().parse().ok()).collect()
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn amounts_are_read_as_people_write_them() {
        for (text, bytes) in [
            ("4G", 4_u64 << 30),
            ("4 GiB", 4 << 30),
            ("1.5g", 3 << 29),
            ("800M", 800 << 20),
            ("2t", 2 << 40),
            ("16777216", 16 << 20),
            ("65536k", 64 << 20),
            ("64MB", 64 << 20),
        ] {
            assert_eq!(parse(text), Ok(Some(bytes)), "{text}");
        }
        assert_eq!(parse("auto"), Ok(None));
        for text in ["", "G", "4X", "-4G", "nan", "inf", "4", "1M", "4GG", "é", "4é", "\u{1b}[2J"] {
            let problem = parse(text).unwrap_err();
            assert!(problem.contains("like 4G") && !problem.contains('\u{1b}'), "{text}: {problem}");
        }
    }

    /// A file system with some files.
    fn root(files: &[(&str, &str)]) -> tempfile::TempDir {
        let dir = tempfile::tempdir().unwrap();
        for (path, text) in files {
            let path = dir.path().join(path);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
        dir
    }

    #[test]
    fn the_tightest_control_group_counts() {
        let second = root(&[
            ("proc/self/cgroup", "0::/user.slice/session\n"),
            ("sys/fs/cgroup/user.slice/memory.max", "1000\n"),
            ("sys/fs/cgroup/user.slice/session/memory.max", "max\n"),
        ]);
        assert_eq!(cgroup(second.path()), Some(1000));
        let first = root(&[
            ("proc/self/cgroup", "5:cpu,cpuacct:/a\n4:memory:/a/b\n"),
            ("sys/fs/cgroup/memory/memory.limit_in_bytes", "9223372036854771712\n"),
            ("sys/fs/cgroup/memory/a/b/memory.limit_in_bytes", "2000\n"),
        ]);
        assert_eq!(cgroup(first.path()), Some(2000));
        // A container sees its group as the root, under a path that it cannot see.
        let inside =
            root(&[("proc/self/cgroup", "0::/docker/abc\n"), ("sys/fs/cgroup/memory.max", "3000\n")]);
        assert_eq!(cgroup(inside.path()), Some(3000));
        assert_eq!(cgroup(root(&[]).path()), None);
    }

    #[test]
    fn this_machine_has_memory() {
        assert!(machine().unwrap() > LEAST_BYTES);
        assert!(half() < u64::MAX);
    }
}
