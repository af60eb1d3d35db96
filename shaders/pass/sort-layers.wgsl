// One step of sorting long lists of layers: runs of `WIDTH` nodes that are in order become runs of twice as many. For lists of more
// nodes than `pass/composite.wgsl` looks through again and again; software adapters end loops after 65535 rounds in all.

@group(0) @binding(0) var<storage, read_write> heads: array<atomic<u32>>;
@group(0) @binding(1) var<storage, read_write> nodes: array<u32>;

const LONGEST: u32 = 2u;
const FIRST_HEAD: u32 = 272u;
override WORDS: u32 = 3u;           // of a node
override WIDTH: u32 = 1u;

fn room() -> u32 {
    return arrayLength(&nodes) / WORDS;
}

fn next_of(number: u32) -> u32 {
    return nodes[link_place(room(), number - 1u)];
}

// As in `pass/composite.wgsl`, of the numbers of two nodes.
fn comes_before(a: u32, b: u32) -> bool {
    let place = vec2u(key_place(a - 1u), key_place(b - 1u));
    let depth = vec2u(nodes[place.x], nodes[place.y]);
    let code = vec2u(nodes[place.x + 1u], nodes[place.y + 1u]);
    var is_before = depth.x > depth.y || (depth.x == depth.y && code.x < code.y);
    var is_alike = all(vec2u(depth.x, code.x) == vec2u(depth.y, code.y));
    // A normal and a colour, as many as there are.
    for (var word = 3u; word < WORDS; word += 1u) {
        let first = nodes[word * room() + a - 1u];
        let second = nodes[word * room() + b - 1u];
        is_before = is_before || (is_alike && first < second);
        is_alike = is_alike && first == second;
    }
    return is_before;
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
                takes_left = !comes_before(right, left);
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
                nodes[link_place(room(), last - 1u)] = taken;
            }
            last = taken;
            count += 1u;
        }
        rest = right;
    }
    if last != 0u {
        nodes[link_place(room(), last - 1u)] = 0u;
    }
    atomicMax(&heads[LONGEST], count);
}
