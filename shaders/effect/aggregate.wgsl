//! name = "aggregate"
//! kind = "epoch"
//! spec = "Tiesel §4.2.1"
//! doc = "Several moments that show together: what is there at some of them is translucent, as much as their weights say. Operators above map each of them."
//!
//! [[parameter]]
//! name = "at"
//! type = "instants"
//! required = true
//! doc = "The moments; what is a span is so much later, or with a minus earlier, than what is shown below, and `\"0 s\"` is that itself."
//!
//! [[parameter]]
//! name = "weights"
//! type = "weights"
//! without = "all the same"
//! doc = "How much each of them counts, one number for each of `at`; what counts is what share of all of them it is."
//!
//! [[parameter]]
//! name = "show"
//! type = "word"
//! words = ["share", "any"]
//! default = "share"
//! doc = "What is there in some of them alone: as opaque as their weights say (`share`), or whole (`any`)."

fn effect(moment: Moment, p: Parameters) -> Moment {
    shows_any = shows_any || p.show == SHOW_ANY;
    return instant_of(p.at, moment);
}
