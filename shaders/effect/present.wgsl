//! name = "present"
//! kind = "epoch"
//! spec = "Tiesel §4"
//! doc = "The moment that the scene shows."

fn effect(moment: f32) -> f32 {
    return moment;
}
