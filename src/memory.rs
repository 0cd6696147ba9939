//! How much memory a simulation takes, and whether the machine has it: asked before any is taken, because a failed allocation
//! would end the program that has loaded this library.

use crate::error::Error;
use crate::parameters::Parameters;

/// What is taken to be free where the operating system does not say \[bytes\].
const ASSUMED: f64 = 4e9;

/// Most that a simulation takes \[bytes\], from above: nearly all of it are the factors of the tangent. Nested dissection leaves a number
/// of entries an element that grows with the logarithm of the rows; both constants are measured. Two bodies are eliminated as one strip
/// of twice the rows. Equal bodies are solved as one and its mirror image, and as two where friction pulls them apart.
pub fn needed(parameters: &Parameters) -> f64 {
    let [columns, rows] = parameters.elements().map(f64::from);
    let strip = |rows: f64| columns * rows * (9e3 + 3.5e3 * rows.log2().max(0.0));
    let mirrored = if parameters.equal_bodies() { strip(rows) } else { 0.0 };
    WORKING + mirrored + strip(2.0 * rows)
}

/// What is needed beside the factors [bytes]: vectors, histories, and the linear algebra's own room, which goes with the processor's
/// caches. A block of this size never changes how the host's allocator works, as one below 32 MiB would in glibc.
const WORKING: f64 = 64e6;

/// Sees before a solution that what it takes can be had, by taking as much and giving it back untouched: an importer may have
/// used what was free when the instance was made. `made` says whether there is room for the factors already.
///
/// # Errors
/// [`Error::Memory`] with the number.
pub fn reserve(parameters: &Parameters, made: bool) -> Result<(), Error> {
    let all = needed(parameters);
    take(if made { WORKING + 0.25 * (all - WORKING) } else { all }, "a solution")
}

/// The same for calls that keep copies, and for making an instance: what they take is small, but a failed allocation of any size ends
/// the host.
///
/// # Errors
/// [`Error::Memory`] with the number.
pub fn reserve_little() -> Result<(), Error> {
    take(WORKING, "an instance or a copy of its state")
}

fn take(bytes: f64, what: &str) -> Result<(), Error> {
    let mut room: Vec<u8> = Vec::new();
    room.try_reserve_exact(bytes as usize).map_err(|_| {
        let megabytes = 1e-6 * bytes;
        Error::Memory(format!(
            "{megabytes:.0} MB of memory are needed for {what} and cannot be had; free some, or take fewer elements"
        ))
    })
}

/// What this process may still take \[bytes\], as far as the operating system says: of the machine, of its container, and of its
/// own address space.
fn available() -> Option<f64> {
    let read = |path: &str| std::fs::read_to_string(path).ok();
    let number = |path: &str| read(path)?.trim().parse::<f64>().ok();
    // A line such as `MemAvailable:   123 kB`.
    let kilobytes = |path: &str, name: &str| {
        let text = read(path)?;
        let line = text.lines().find_map(|line| line.strip_prefix(name))?;
        Some(1024.0 * line.trim().trim_end_matches("kB").trim().parse::<f64>().ok()?)
    };
    let group = |limit: &str, used: &str| Some(number(limit)? - number(used)?);
    let address_space = || {
        let text = read("/proc/self/limits")?;
        let line = text.lines().find_map(|line| line.strip_prefix("Max address space"))?;
        Some(line.split_whitespace().next()?.parse::<f64>().ok()? - kilobytes("/proc/self/status", "VmSize:")?)
    };
    let limits = [
        kilobytes("/proc/meminfo", "MemAvailable:"),
        group("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory.current"),
        group("/sys/fs/cgroup/memory/memory.limit_in_bytes", "/sys/fs/cgroup/memory/memory.usage_in_bytes"),
        address_space(),
    ];
    limits.into_iter().flatten().reduce(f64::min)
}

/// Refuses a mesh for which the memory does not suffice, in so many simulations at once.
///
/// # Errors
/// [`Error::Value`] with what is needed and what there is.
pub fn check(parameters: &Parameters, simulations: usize) -> Result<(), Error> {
    let (needed, available) = (needed(parameters) * simulations as f64, available().unwrap_or(ASSUMED));
    if needed <= available {
        return Ok(());
    }
    let size = |bytes: f64| {
        let bytes = bytes.max(0.0);
        if bytes < 1e9 { format!("{:.0} MB", 1e-6 * bytes) } else { format!("{:.1} GB", 1e-9 * bytes) }
    };
    let many = if simulations > 1 { format!(" on {simulations} threads") } else { String::new() };
    Err(Error::value(
        "mesh.columns",
        parameters.mesh.columns,
        format!(
            "with mesh.rows = {} up to {} of memory are needed{many}, and {} are free; take fewer columns or rows",
            parameters.mesh.rows,
            size(needed),
            size(available)
        ),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_does_not_fit_is_refused_with_the_numbers() {
        let mut parameters = Parameters::default();
        check(&parameters, 1).unwrap();
        (parameters.mesh.columns, parameters.mesh.rows) = (2000, 200);
        let message = check(&parameters, 1000).unwrap_err().to_string();
        assert!(message.contains("mesh.rows = 200 up to 4") && message.contains("GB are free"), "{message}");
    }

    #[test]
    fn what_a_solution_takes_is_asked_for() {
        let mut parameters = Parameters::default();
        reserve(&parameters, false).unwrap();
        // More than an address space has.
        (parameters.mesh.columns, parameters.mesh.rows) = (i32::MAX, i32::MAX);
        let message = reserve(&parameters, true).unwrap_err().to_string();
        assert!(message.contains("MB of memory are needed for a solution and cannot be had"), "{message}");
    }
}
