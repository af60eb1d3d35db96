//! name = "time-of-day"
//! kind = "epoch"
//! spec = "Tiesel §4.2.3"
//! doc = "The same day, at a time of it."
//!
//! [[parameter]]
//! name = "time"
//! type = "clock"
//! required = true
//! doc = "The time of day."

fn effect(moment: Moment, p: Parameters) -> Moment {
    if moment.hour == TIMELESS_HOUR {
        return moment;
    }
    return at_time_of_day(moment, p.time);
}
