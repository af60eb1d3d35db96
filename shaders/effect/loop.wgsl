//! name = "loop"
//! kind = "epoch"
//! spec = "Tiesel §4.2.2"
//! doc = "From one moment to another, again and again, by the seconds of the scene (`[time] at_s`), whatever is shown below."
//!
//! [[parameter]]
//! name = "begin"
//! type = "moment"
//! required = true
//! doc = "What it begins with."
//!
//! [[parameter]]
//! name = "end"
//! type = "moment"
//! required = true
//! doc = "What it ends before: later than `begin`."
//!
//! [[parameter]]
//! name = "per_second"
//! type = "span"
//! default = "1 s"
//! doc = "How much time goes by in a second, more than none; years are 365.2425 days each, months a twelfth of that."
//!
//! [[parameter]]
//! name = "start_s"
//! type = "number"
//! range = [-1e6, 1e6]
//! default = 0.0
//! unit = "s"
//! doc = "The second of the scene at which it begins; before and after that it goes on."

// Where the scene's clock shows `start_s`. All else is the host's: it counts in 128 bits, and hands over the moment as `set` has it.
fn effect(moment: Moment, p: Parameters) -> Moment {
    return p.begin;
}
