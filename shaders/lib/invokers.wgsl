// ==== the invoker table

struct Invoker {
    handler: u32,               // its number
    scope: u32,                 // 0 everywhere, 1 inside, 2 in front, 3 behind, 4 rest
    first_volume: u32,          // of its lens
    volumes: u32,
    parameters: u32,            // its first slot
    blend: u32,                 // 0 replaces
    weight: u32,                // slot of its weight, if blended
    kind: u32,                  // 1 = a style for surfaces alone, 2 = an opacity rule
    number: u32,                // of a lens: its bit in the masks
    border: u32,                // of a lens that fades: the slot after that of its border; 0 else
}

// One as it is kept: a software adapter takes long for each word that it reads.
struct PackedInvoker {
    place: u32,                 // scope: 3 bits, first_volume: 11, volumes: 11
    call: u32,                  // handler: 13 bits, parameters: 13, blend: 3, kind: 3
    slots: u32,                 // weight, border: 16 bits each
    number: u32,
}

struct InvokerTable {
    ranges: vec4u,              // from up to (not included): what hides; what lines go through
    tiles: vec4u,               // x: tiles of the picture in a row; y, z: contents of lenses, from up to; w: 1 where there are layers
    epochs: vec4u,              // x: of time operators by the bits of lenses, y: how many bits there are
}

// A uniform, as it always was: with none at this place Mesa 22.3 takes others for each other, and crashes.
@group(2) @binding(5) var<uniform> table: InvokerTable;
@group(2) @binding(9) var<storage, read> invokers: array<PackedInvoker>;

fn unpacked_invoker(kept: PackedInvoker) -> Invoker {
    return Invoker(
        kept.call & 8191u, kept.place & 7u, (kept.place >> 3u) & 2047u, kept.place >> 14u, (kept.call >> 13u) & 8191u,
        (kept.call >> 26u) & 7u, kept.slots & 65535u, kept.call >> 29u, kept.number, kept.slots >> 16u);
}

fn invoker(i: u32) -> Invoker {
    return unpacked_invoker(invokers[i]);
}
