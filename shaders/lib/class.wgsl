// Classes: inside of a lens, in front of it, behind it, and the rest. A point has one bit per class and lens; the bits of several
// volumes of one lens are ORed: inside any of them is inside the lens, in front only before the first, behind only after the last.
// What is inside may have the bit of the side that is nearer, too.

const MISSED: u32 = 0u;
const INSIDE: u32 = 1u;
const FRONT: u32 = 2u;
const BEHIND: u32 = 4u;

fn is_inside(classes: u32) -> bool {
    return (classes & INSIDE) != 0u;
}

fn is_in_front(classes: u32) -> bool {
    return classes == FRONT;
}

fn is_behind(classes: u32) -> bool {
    return classes == BEHIND;
}

// Missed, or between two volumes.
fn is_rest(classes: u32) -> bool {
    return classes == MISSED || classes == (FRONT | BEHIND);
}
