// Objects that move: each is drawn once for each moment at which some of it may show, and of what is drawn for a moment stays what is where that
// moment shows (`lib/lifetime.wgsl` says where the moments lie).

const MOVING_MOMENTS: u32 = 19u;

// For which moment a surface is drawn, from 1; 0: for all.
fn turn_of(surface: u32) -> u32 {
    if (surface & SECTION) != 0u {
        return 0u;
    }
    let object = textureLoad(surfaces, vec2u(surface % SURFACES_PER_ROW, surface / SURFACES_PER_ROW), 0).x;
    return select(object >> OBJECT_BITS, 0u, object == NO_OBJECT);
}

fn moment_of_turn(turn: u32) -> Moment {
    return moment_in(object_values[MOVING_MOMENTS] + 2u * (turn - 1u));
}
