//! name = "set"
//! kind = "epoch"
//! spec = "Tiesel §4.2.1"
//! doc = "A moment, whatever is shown below."
//!
//! [[parameter]]
//! name = "at"
//! type = "moment"
//! required = true
//! doc = "The moment."

fn effect(moment: Moment, p: Parameters) -> Moment {
    return p.at;
}
