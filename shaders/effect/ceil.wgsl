//! name = "ceil"
//! kind = "epoch"
//! spec = "Tiesel §4.2.3"
//! doc = "The first full unit that is not before what is shown below: one that is full stays."
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
    return ceiled(shifted(moment, p.by), p.unit);
}
