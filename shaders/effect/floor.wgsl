//! name = "floor"
//! kind = "epoch"
//! spec = "Tiesel §4.2.3"
//! doc = "The last full unit that is not after what is shown below."
//!
//! [[parameter]]
//! name = "unit"
//! type = "unit"
//! required = true
//! doc = "The unit: months are counted from the year 0, weeks from Mondays, all else from the start of 1970."
//!
//! [[parameter]]
//! name = "by"
//! type = "span"
//! default = "0 s"
//! doc = "How much later it is asked from."

fn effect(moment: Moment, p: Parameters) -> Moment {
    if moment.hour == TIMELESS_HOUR {
        return moment;
    }
    return floored(shifted(moment, p.by), p.unit);
}
