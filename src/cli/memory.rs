//! How much memory the program may take: it ends with a message before the machine is brought to its knees.
//!
//! What a file or a scene will take is bounded where it is read; what all of it takes together, in memory of the driver too, is seen only
//! while it is taken. A thread of its own looks, often enough that no allocation gets far beyond.

use std::{sync::atomic::Ordering::Relaxed, time::Duration};

use crate::figure::file::remove_parts;

/// How often is looked.
const PAUSE: Duration = Duration::from_millis(10);
/// The part of what is free that is taken where nothing is said.
const DEFAULT_PART: f64 = 0.75;
/// Less than this is never a bound: the program itself and a software driver take about as much.
pub const LEAST_BYTES: u64 = 128 << 20;

/// A number of bytes as people write it: `4G`, `1.5GiB`, `800M`, `900000000`; units are powers of 1024.
///
/// # Errors
/// What would be right.
pub fn parse(text: &str) -> Result<u64, String> {
    let wrong = || format!("{text:?} is no amount of memory; \"4G\", \"1.5G\" or \"800M\" would be right");
    let end = text.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(text.len());
    let (number, unit) = text.split_at(end);
    let shift = match unit.trim().to_ascii_uppercase().trim_end_matches("IB").trim_end_matches('B') {
        "" => 0,
        "K" => 10,
        "M" => 20,
        "G" => 30,
        "T" => 40,
        _ => return Err(wrong()),
    };
    let bytes = number.parse::<f64>().map_err(|_| wrong())? * f64::from(shift).exp2();
    match bytes as u64 {
        bytes if bytes < LEAST_BYTES => {
            Err(format!("{text} is less than the program itself takes; \"256M\" is little"))
        }
        bytes => Ok(bytes),
    }
}

/// Ends the program with a message, without half-written files, where it takes more than this; `None`: more than a part of what is free now.
#[expect(clippy::disallowed_methods, reason = "whoever takes too much is not asked; what is half written is removed")]
pub fn watch(most: Option<u64>) {
    let bound = most.or_else(|| free_bytes().map(|free| (DEFAULT_PART * free as f64) as u64));
    // Where the system does not tell, it takes what it takes.
    let Some(bound) = bound.map(|bound| bound.max(LEAST_BYTES)).filter(|_| taken_bytes().is_some()) else { return };
    let look = move || {
        loop {
            std::thread::sleep(PAUSE);
            let Some(taken) = taken_bytes().filter(|taken| *taken > bound) else { continue };
            let whose =
                if most.is_some() { "--memory allows" } else { "may be taken: three quarters of what was free" };
            log::error!(
                "{} MiB of memory are taken, more than {whose}, {} MiB; a smaller picture, less of the city or a larger --memory would be right",
                taken >> 20,
                bound >> 20
            );
            remove_parts();
            std::process::exit(1);
        }
    };
    if let Err(error) = std::thread::Builder::new().name("memory".into()).spawn(look) {
        log::debug!("no thread looks after memory: {error}");
    }
}

/// What of the memory of this process is its own, bytes: files that it maps do not count.
fn taken_bytes() -> Option<u64> {
    use std::sync::atomic::AtomicU64;
    static PAGE: AtomicU64 = AtomicU64::new(0);
    if PAGE.load(Relaxed) == 0 {
        PAGE.store(page_bytes()?, Relaxed);
    }
    let sizes = std::fs::read_to_string("/proc/self/statm").ok()?;
    let mut pages = sizes.split_whitespace().skip(1).map_while(|word| word.parse::<u64>().ok());
    let (resident, shared) = (pages.next()?, pages.next()?);
    Some(resident.saturating_sub(shared) * PAGE.load(Relaxed))
}

/// Bytes of a page, from two ways in which the system tells the same.
fn page_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let sizes = std::fs::read_to_string("/proc/self/statm").ok()?;
    let kibibytes = status.lines().find_map(|line| line.strip_prefix("VmSize:"))?.split_whitespace().next()?;
    let (bytes, pages) =
        (kibibytes.parse::<f64>().ok()? * 1024.0, sizes.split_whitespace().next()?.parse::<f64>().ok()?);
    // Both grow from one look to the next; pages are powers of two.
    Some((bytes / pages.max(1.0)).log2().round().exp2() as u64)
}

/// What is free on the machine, or in the group of processes that this one is in, bytes.
fn free_bytes() -> Option<u64> {
    let info = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = info.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let machine = line.split_whitespace().next()?.parse::<u64>().ok()? << 10;
    let number = |file: &str| std::fs::read_to_string(file).ok()?.trim().parse::<u64>().ok();
    let group = number("/sys/fs/cgroup/memory.max").zip(number("/sys/fs/cgroup/memory.current"));
    Some(group.map_or(machine, |(most, taken)| machine.min(most.saturating_sub(taken))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn amounts_are_read_as_people_write_them() {
        for (text, bytes) in [
            ("4G", 4 << 30),
            ("4g", 4 << 30),
            ("4GiB", 4 << 30),
            ("1.5 GB", 3 << 29),
            ("800M", 800 << 20),
            ("268435456", 1 << 28),
        ] {
            assert_eq!(parse(text), Ok(bytes), "{text}");
        }
        for text in ["", "G", "much", "4X", "-1G", "1..5G", "100M", "0"] {
            assert!(parse(text).is_err(), "{text}");
        }
    }

    #[test]
    fn the_system_tells_what_is_taken() {
        assert!(page_bytes().is_some_and(|bytes| (4096..=65536).contains(&bytes)));
        assert!(taken_bytes().is_some_and(|bytes| bytes > 1 << 20));
        assert!(free_bytes().is_some_and(|free| free > 1 << 20));
    }
}
