//! name = "ghost"
//! kind = "epoch"
//! spec = "Tiesel §4.2.2"
//! doc = "The moment that is shown below, with what was there not long before, which fades away, and in outline what will be there not long after."
//!
//! [[parameter]]
//! name = "past"
//! type = "span"
//! default = "0 s"
//! doc = "How long what is gone still shows: at first half opaque, then less and less."
//!
//! [[parameter]]
//! name = "future"
//! type = "span"
//! default = "0 s"
//! doc = "How long before it comes the edges of what will be there are drawn."

fn effect(moment: Moment, p: Parameters) -> Moment {
    ghost_past = p.past;
    ghost_future = p.future;
    return moment;
}
