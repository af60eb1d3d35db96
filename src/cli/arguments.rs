//! Options that every command takes.

use clap::Args;
use std::path::PathBuf;

use crate::cli::memory;

/// Options that every command takes.
#[derive(Args, Clone, Debug, Default)]
pub struct GlobalArguments {
    /// Say more on stderr; twice: even more
    #[arg(short, long, global = true, action = clap::ArgAction::Count, conflicts_with = "quiet", display_order = 100)]
    pub verbose: u8,
    /// Say nothing on stderr but errors
    #[arg(short, long, global = true, display_order = 100)]
    pub quiet: bool,
    /// Follow paths in models and scenes that leave the folders named on the command line
    #[arg(long, global = true, display_order = 100)]
    pub allow_outside: bool,
    /// Add the effects in this folder (*.wgsl, docs/effects.md); repeatable
    #[arg(long, global = true, value_name = "DIR", display_order = 100)]
    pub effects: Vec<PathBuf>,
    /// End with a message where more memory than this is taken (4G, 800M); else three quarters of what is free
    #[arg(long, global = true, value_name = "SIZE", value_parser = memory::parse, display_order = 100)]
    pub memory: Option<u64>,
}
