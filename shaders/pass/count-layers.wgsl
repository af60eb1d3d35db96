// How many layers the pixel has that has most, for opacity rules that ask for it: the longest list.

@group(0) @binding(0) var<storage, read_write> heads: array<atomic<u32>>;
@group(0) @binding(1) var<storage, read_write> nodes: array<u32>;

const MOST_LAYERS: u32 = 1u;
const FIRST_HEAD: u32 = 272u;
override WORDS: u32 = 3u;           // of a node

@compute @workgroup_size(64)
fn count(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = FIRST_HEAD + id.y * groups.x * 64u + id.x;
    if i >= arrayLength(&heads) {
        return;
    }
    var layers = 0u;
    var next = atomicLoad(&heads[i]);
    while next != 0u {
        layers += 1u;
        next = nodes[link_place(arrayLength(&nodes) / WORDS, next - 1u)];
        if next == 0u {
            break;
        }
    }
    atomicMax(&heads[MOST_LAYERS], layers);
}
