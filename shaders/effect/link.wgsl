//! name = "link"
//! kind = "epoch"
//! spec = "Tiesel §4.2.3"
//! doc = "What another lens makes of the moment that is shown below, and so much later: lenses that are linked show one time, or keep a delay."
//!
//! [[parameter]]
//! name = "to"
//! type = "text"
//! required = true
//! doc = "The name of the other lens."
//!
//! [[parameter]]
//! name = "by"
//! type = "span"
//! default = "0 s"
//! doc = "How much later than that lens, or with a minus earlier."

// The host puts the operators of the other lens in its place, and then a shift.
fn effect(moment: Moment, p: Parameters) -> Moment {
    return moment;
}
