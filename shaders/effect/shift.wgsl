//! name = "shift"
//! kind = "epoch"
//! spec = "Tiesel §4.2.1"
//! doc = "So much later than what is shown below, or earlier."
//!
//! [[parameter]]
//! name = "by"
//! type = "span"
//! required = true
//! doc = "How much later, months before all else; with a minus how much earlier."

fn effect(moment: Moment, p: Parameters) -> Moment {
    if moment.hour == TIMELESS_HOUR {
        return moment;
    }
    return shifted(moment, p.by);
}
