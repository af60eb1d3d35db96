//! The cost of accuracy in time: every knob that trades one for the other, measured by one command.
//!
//! ```text
//! topic (topics/NAME.rs) ─ makes ─> plain frame, reference, variants ─ run ─> Measurement ─ report ─> .md .json
//!                                                                                         └ plot ──> .svg .png
//! ```
//!
//! A topic says what is drawn and knows nothing of clocks, tables and plots; the rest knows nothing of topics. All
//! variants are drawn in turn in one process ([`ratio`]), each is compared with its reference ([`difference`]), and what
//! nothing else beats in error and time stands on the Pareto front ([`pareto`]).

pub mod difference;
pub mod flip;
pub mod light_by_rays;
pub mod pareto;
pub mod plot;
pub mod quantity;
pub mod ratio;
pub mod report;
pub mod run;
pub mod stage;
pub mod topic;
pub mod topics;

pub use quantity::Quantity;
pub use run::{Measurement, Setup, Step, measure};
pub use topic::{Knob, Shot, Topic, Trial, Value, Variant};
pub use topics::TOPICS;
