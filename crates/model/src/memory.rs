//! How much memory a run may take.
//!
//! A small file can ask for much: a thousand leaves at one place are behind each
//! other in every pixel, an image of a kilobyte has a billion texels. So what is
//! large is reckoned from counts that are known before it is made, and what does
//! not fit is refused. The reckoning is the same on every run: it does not ask how
//! much is taken at the moment, nor by how many threads.

use std::fmt;
use std::fs;
use std::path::Path;
use std::str::FromStr;
use std::sync::OnceLock;

/// How much memory a run may take. Spelled `auto`, or as a number of bytes with K, M,
/// G or T behind it for powers of 1024, such as `800M`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Memory {
    /// Half of what the machine has, or of what its control groups or its limits
    /// (`ulimit -v`, `ulimit -d`) let this process have if that is less; 4 GiB where
    /// the system does not tell.
    #[default]
    Auto,
    /// This number of bytes.
    Bytes(u64),
}

/// What [`Memory::Auto`] is where the system does not tell how much there is.
const UNKNOWN: u64 = 4 << 30;

impl Memory {
    /// The budget in bytes. It is the same whenever it is asked for.
    pub fn bytes(self) -> u64 {
        static AUTO: OnceLock<u64> = OnceLock::new();
        match self {
            Self::Auto => *AUTO.get_or_init(|| machine().map_or(UNKNOWN, |bytes| bytes / 2)),
            Self::Bytes(bytes) => bytes,
        }
    }
}

impl FromStr for Memory {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "auto" {
            return Ok(Self::Auto);
        }
        let wrong = || "write auto, or a size above 0 such as 2G or 800M".to_owned();
        let upper = text.to_ascii_uppercase();
        let units = [("K", 10), ("M", 20), ("G", 30), ("T", 40)];
        let with_unit = units.iter().find_map(|(unit, bits)| {
            let endings = [format!("{unit}IB"), format!("{unit}B"), (*unit).to_owned()];
            let number = endings.iter().find_map(|end| upper.strip_suffix(end))?;
            Some((number, *bits))
        });
        let (number, bits) = with_unit.unwrap_or((&upper, 0));
        let number: f64 = number.trim_end().parse().map_err(|_| wrong())?;
        let bytes = number * (1u64 << bits) as f64;
        match (1.0..u64::MAX as f64).contains(&bytes) {
            true => Ok(Self::Bytes(bytes as u64)),
            false => Err(wrong()),
        }
    }
}

impl fmt::Display for Memory {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self::Bytes(bytes) = self else {
            return f.write_str("auto");
        };
        for (unit, bits) in [("T", 40), ("G", 30), ("M", 20), ("K", 10)] {
            if bytes.trailing_zeros() >= bits && *bytes > 0 {
                return write!(f, "{}{unit}", bytes >> bits);
            }
        }
        write!(f, "{bytes}")
    }
}

/// Something that would take more memory than there may be.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "{what} would take {} of memory, and of what is allowed {} are left: {remedy}",
    size(*.bytes),
    size(*.left)
)]
pub struct OverMemory {
    /// What would, in words.
    pub what: String,
    /// How much it would take, as far as that is known.
    pub bytes: u64,
    /// How much it may take.
    pub left: u64,
    /// What would do instead.
    pub remedy: Remedy,
}

/// What would do where the memory that is allowed is too little, beside allowing more.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Remedy {
    /// A file with less in it.
    SmallerFile,
    /// Textures of fewer texels.
    SmallerImages,
    /// Less of the plant taken for foliage.
    LessFoliage,
    /// Fewer pixels in fewer views.
    FewerPixels,
    /// Leaves that grow less, or fewer pixels in fewer views.
    LessGrowth,
    /// Sizes of leaves that are not fitted at the end.
    NoFit,
}

impl fmt::Display for Remedy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::SmallerFile => "allow more, or make the file smaller",
            Self::SmallerImages => "allow more, or make the images smaller",
            Self::LessFoliage => "allow more, or choose less of the plant",
            Self::FewerPixels => "allow more, or take fewer pixels or fewer views",
            Self::LessGrowth => {
                "allow more, let leaves grow less, or take fewer pixels or fewer views"
            }
            Self::NoFit => "allow more, or do not fit sizes",
        })
    }
}

/// What is left of the memory that a run may take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Budget {
    left: u64,
}

impl Budget {
    /// The whole of what a run may take.
    pub fn new(memory: Memory) -> Self {
        Self {
            left: memory.bytes(),
        }
    }

    /// As much as there can be.
    pub fn unlimited() -> Self {
        Self { left: u64::MAX }
    }

    /// Bytes that are left.
    pub fn left(&self) -> u64 {
        self.left
    }

    /// What is left, to be given on.
    pub fn memory(&self) -> Memory {
        Memory::Bytes(self.left)
    }

    /// Takes bytes for something that is about to be made.
    ///
    /// # Errors
    /// [`OverMemory`] with `what` and `remedy` if fewer than `bytes` are left.
    pub fn take(
        &mut self,
        bytes: u64,
        what: impl FnOnce() -> String,
        remedy: Remedy,
    ) -> Result<(), OverMemory> {
        match self.left.checked_sub(bytes) {
            Some(left) => {
                self.left = left;
                Ok(())
            }
            None => Err(OverMemory {
                what: what(),
                bytes,
                left: self.left,
                remedy,
            }),
        }
    }
}

/// A number of bytes, for reading.
fn size(bytes: u64) -> String {
    let units = [("GiB", 30), ("MiB", 20), ("KiB", 10)];
    match units.iter().find(|(_, bits)| bytes >= 1 << bits) {
        Some((unit, bits)) => format!("{:.1} {unit}", bytes as f64 / f64::from(1u32 << bits)),
        None => format!("{bytes} bytes"),
    }
}

/// What this process could have at most.
fn machine() -> Option<u64> {
    let all = fs::read_to_string("/proc/meminfo").ok();
    let all = all.as_deref().and_then(total_of_meminfo);
    let groups = fs::read_to_string("/proc/self/cgroup").unwrap_or_default();
    let of_groups = limit_of_groups(&groups, Path::new("/sys/fs/cgroup"));
    let limits = fs::read_to_string("/proc/self/limits").unwrap_or_default();
    let of_process = limit_of_process(&limits);
    [all, of_groups, of_process].into_iter().flatten().min()
}

/// The least of a process's limits on its addresses and its data; `limits` is its
/// `/proc/self/limits`, whose lines have a name, the limit in force, the highest that may be set,
/// and the unit.
fn limit_of_process(limits: &str) -> Option<u64> {
    let names = ["Max address space", "Max data size"];
    let of = |name| {
        limits
            .lines()
            .find_map(|line: &str| line.strip_prefix(name))
    };
    let in_force = names.into_iter().filter_map(of);
    // No limit is `unlimited`.
    in_force
        .filter_map(|fields| fields.split_whitespace().next()?.parse().ok())
        .min()
}

fn total_of_meminfo(text: &str) -> Option<u64> {
    let line = text.lines().find(|line| line.starts_with("MemTotal:"))?;
    let kibibytes: u64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kibibytes * 1024)
}

/// The least limit of the control groups that a process is in and of those above
/// them: `groups` is its `/proc/self/cgroup`, `mount` where the groups are. Both
/// versions are known (Linux: admin-guide/cgroup-v2, cgroup-v1/memory).
fn limit_of_groups(groups: &str, mount: &Path) -> Option<u64> {
    let mut least: Option<u64> = None;
    for line in groups.lines() {
        let mut fields = line.splitn(3, ':').skip(1);
        let (Some(controllers), Some(path)) = (fields.next(), fields.next()) else {
            continue;
        };
        let (root, file) = if controllers.is_empty() {
            (mount.to_owned(), "memory.max")
        } else if controllers.split(',').any(|name| name == "memory") {
            (mount.join("memory"), "memory.limit_in_bytes")
        } else {
            continue;
        };
        // Within a container the path may be the one outside of it: what is there of
        // it counts.
        for above in Path::new(path.trim_start_matches('/')).ancestors() {
            let text = fs::read_to_string(root.join(above).join(file)).unwrap_or_default();
            // No limit is `max`, or, in the first version, a number beyond all memory.
            if let Ok(limit) = text.trim().parse::<u64>() {
                least = Some(least.map_or(limit, |least| least.min(limit)));
            }
        }
    }
    least
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_have_units() {
        let bytes = |text: &str| text.parse::<Memory>().map(Memory::bytes);
        assert_eq!(bytes("800M"), Ok(800 << 20));
        assert_eq!(bytes("2G"), Ok(2 << 30));
        assert_eq!(bytes("1.5GiB"), Ok(3 << 29));
        assert_eq!(bytes("64 kb"), Ok(64 << 10));
        assert_eq!(bytes("1000"), Ok(1000));
        for wrong in ["", "0", "-1G", "G", "many", "1e30", "NaN", "inf", "2X"] {
            assert!(wrong.parse::<Memory>().is_err(), "{wrong}");
        }
        for text in ["auto", "2G", "800M", "1000", "64K"] {
            assert_eq!(text.parse::<Memory>().unwrap().to_string(), text);
        }
        assert!(Memory::Auto.bytes() > 0);
    }

    #[test]
    fn what_is_taken_is_not_left() {
        let mut budget = Budget::new(Memory::Bytes(3 << 20));
        let mut take = |bytes| budget.take(bytes, || "this".to_owned(), Remedy::SmallerFile);
        take(1 << 20).unwrap();
        assert_eq!(
            take(5 << 30).unwrap_err().to_string(),
            "this would take 5.0 GiB of memory, and of what is allowed 2.0 MiB are left: allow more, or make the file smaller"
        );
        take(2 << 20).unwrap();
        assert_eq!(take(1).unwrap_err().left, 0);
    }

    #[test]
    fn the_least_limit_of_all_groups_counts() {
        let mount = tempfile::tempdir().unwrap();
        let put = |path: &str, text: &str| {
            let path = mount.path().join(path);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        };
        let limit = |groups| limit_of_groups(groups, mount.path());
        assert_eq!(limit("0::/a/b\n"), None);
        put("a/b/memory.max", "max\n");
        put("a/memory.max", "5000\n");
        put("memory.max", "9000\n");
        assert_eq!(limit("0::/a/b\n"), Some(5000));
        assert_eq!(limit("0::/elsewhere\n"), Some(9000));
        put("memory/c/memory.limit_in_bytes", "700\n");
        put("memory/memory.limit_in_bytes", "9223372036854771712\n");
        let first = "3:cpu:/x\n2:memory:/c/d\n";
        assert_eq!(limit(first), Some(700));
        assert_eq!(
            total_of_meminfo("MemTotal:  4 kB\nMemFree: 1 kB\n"),
            Some(4096)
        );
    }

    #[test]
    fn limits_of_the_process_count() {
        let limits = |data: &str, addresses: &str| {
            format!(
                "Limit                     Soft Limit           Hard Limit           Units     \n\
                 Max data size             {data}            unlimited            bytes     \n\
                 Max stack size            8388608              unlimited            bytes     \n\
                 Max address space         {addresses}           unlimited            bytes     \n"
            )
        };
        assert_eq!(limit_of_process(&limits("unlimited", "unlimited")), None);
        assert_eq!(
            limit_of_process(&limits("unlimited", "2147483648")),
            Some(2 << 30)
        );
        assert_eq!(limit_of_process(&limits("4096", "2147483648")), Some(4096));
        assert_eq!(limit_of_process(""), None);
    }
}
