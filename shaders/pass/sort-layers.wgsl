// One step of sorting long lists of layers: runs of `WIDTH` notes that are in order become runs of twice as many. For lists of more
// notes than `pass/composite.wgsl` looks through again and again; software adapters end loops after 65535 rounds in all.

@group(0) @binding(0) var<storage, read_write> heads: array<atomic<u32>>;
@group(0) @binding(1) var<storage, read_write> notes: array<u32>;

const LONGEST: u32 = 2u;
const FIRST_HEAD: u32 = 272u;
override WORDS: u32 = 3u;           // of a note
override WIDTH: u32 = 1u;

fn next_of(number: u32) -> u32 {
    return notes[(number - 1u) * WORDS];
}

// As in `pass/composite.wgsl`, of the numbers of two notes.
fn precedes(a: u32, b: u32) -> bool {
    let place = (vec2u(a, b) - 1u) * WORDS;
    let depth = vec2u(notes[place.x + 1u], notes[place.y + 1u]);
    let code = vec2u(notes[place.x + 2u], notes[place.y + 2u]);
    return depth.x > depth.y
        || (depth.x == depth.y && (code.x < code.y || (code.x == code.y && a < b)));
}

@compute @workgroup_size(64)
fn sort(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let place = FIRST_HEAD + id.y * groups.x * 64u + id.x;
    if place >= arrayLength(&heads) {
        return;
    }
    var count = 0u;
    var rest = atomicLoad(&heads[place]);
    var last = 0u;                  // of what is in order so far
    while rest != 0u {
        // Two runs, and what comes after them.
        var left = rest;
        var right = left;
        for (var i = 0u; i < WIDTH && right != 0u; i += 1u) {
            right = next_of(right);
        }
        var lefts = WIDTH;
        var rights = WIDTH;
        while (lefts > 0u && left != 0u) || (rights > 0u && right != 0u) {
            let has_left = lefts > 0u && left != 0u;
            let has_right = rights > 0u && right != 0u;
            var takes_left = has_left;
            if has_left && has_right {
                takes_left = !precedes(right, left);
            }
            let taken = select(right, left, takes_left);
            if takes_left {
                left = next_of(left);
                lefts -= 1u;
            } else {
                right = next_of(right);
                rights -= 1u;
            }
            if last == 0u {
                atomicStore(&heads[place], taken);
            } else {
                notes[(last - 1u) * WORDS] = taken;
            }
            last = taken;
            count += 1u;
        }
        rest = right;
    }
    if last != 0u {
        notes[(last - 1u) * WORDS] = 0u;
    }
    atomicMax(&heads[LONGEST], count);
}
