//! Whether the tests notice small faults: the program behind `./dev faults`.
//!
//! Each fault of `list.toml` is planted in a tree of its own, the tests that are to notice it are run, and it is taken out again. A fault
//! is caught where a test fails; one that does not build tells nothing of the tests.
//!
//! ```text
//! faults TREE [NAME...]
//! ```

#![allow(clippy::print_stdout, reason = "what it finds is what it prints")]

mod list;

use std::{
    path::{Path, PathBuf},
    process::{Command, ExitCode, Stdio},
};

use list::Fault;

/// What became of a fault.
enum Outcome {
    /// So many tests failed.
    Caught(usize),
    /// None did, of so many.
    Survived(usize),
    /// Why nothing can be said.
    Unknown(String),
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [tree, names @ ..] = &arguments[..] else {
        println!("error: usage: faults TREE [NAME...]");
        return ExitCode::from(2);
    };
    let tree = PathBuf::from(tree);
    let all = match list::read(&tree) {
        Ok(all) => all,
        Err(problem) => {
            println!("error: {problem}");
            return ExitCode::from(2);
        }
    };
    let chosen: Vec<&Fault> =
        all.iter().filter(|f| names.is_empty() || names.iter().any(|name| f.name.contains(name))).collect();
    let (mut caught, mut others) = (0, 0);
    for fault in &chosen {
        let outcome = tried(&tree, fault);
        let words = match &outcome {
            Outcome::Caught(tests) => format!("caught by {tests}"),
            Outcome::Survived(tests) => format!("SURVIVED {tests} tests"),
            Outcome::Unknown(why) => format!("UNKNOWN: {why}"),
        };
        println!("{}: {words}", fault.name);
        if matches!(outcome, Outcome::Caught(_)) { caught += 1 } else { others += 1 }
    }
    println!("{caught} of {} faults are caught", chosen.len());
    if others == 0 { ExitCode::SUCCESS } else { ExitCode::from(1) }
}

fn tried(tree: &Path, fault: &Fault) -> Outcome {
    let path = tree.join(&fault.file);
    let planted = std::fs::read_to_string(&path)
        .map_err(|error| format!("{}: {error}", fault.file))
        .and_then(|text| Ok((fault.planted(&text)?, text)));
    let (planted, text) = match planted {
        Ok(both) => both,
        Err(why) => return Outcome::Unknown(why),
    };
    let outcome = match std::fs::write(&path, planted) {
        Ok(()) => run(tree, &fault.tests),
        Err(error) => Outcome::Unknown(error.to_string()),
    };
    match std::fs::write(&path, text) {
        Ok(()) => outcome,
        Err(error) => Outcome::Unknown(format!("{} could not be put back: {error}", fault.file)),
    }
}

/// Runs tests of a tree.
fn run(tree: &Path, tests: &[String]) -> Outcome {
    let Some((target, filters)) = tests.split_first() else { return Outcome::Unknown("no tests are named".to_owned()) };
    let target = if target == "lib" { vec!["--lib"] } else { vec!["--test", target] };
    let output = Command::new("cargo")
        .current_dir(tree)
        .args(["test", "--quiet"])
        .args(target)
        .arg("--")
        .args(filters)
        .stdin(Stdio::null())
        .output();
    let output = match output {
        Ok(output) => output,
        Err(error) => return Outcome::Unknown(format!("cargo: {error}")),
    };
    let said = String::from_utf8_lossy(&output.stdout);
    // `test result: FAILED. 1 passed; 2 failed; ...`
    let count = |word: &str| -> usize {
        let of_line = |line: &str| {
            line.split([';', '.']).find_map(|part| part.trim().strip_suffix(word)?.trim().parse::<usize>().ok())
        };
        said.lines().filter(|line| line.starts_with("test result:")).filter_map(of_line).sum()
    };
    let (passed, failed) = (count(" passed"), count(" failed"));
    match (passed, failed) {
        (0, 0) => {
            let told = String::from_utf8_lossy(&output.stderr);
            let line = told.lines().find(|line| line.starts_with("error")).unwrap_or("no test ran");
            Outcome::Unknown(line.to_owned())
        }
        (passed, 0) => Outcome::Survived(passed),
        (_, failed) => Outcome::Caught(failed),
    }
}
