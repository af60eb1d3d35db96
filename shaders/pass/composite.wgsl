// Translucent layers of a pixel, as `pass/layers.wgsl` noted them: sorted by their full depth, each shaded as what is opaque
// is, with its own place in the lenses, and laid one over the other in f32, nearest first.
//
// The nearest nodes are found several at a time, in one walk through the list; that goes on from the last of them until all are
// laid or nothing more would be seen. A walk takes a few nodes at a time, puts them in order by a sorting network and merges them
// into the nearest so far, with no more branches than the walk itself. What is not done after MOST_ROUNDS is told; the host has
// lists sorted then (`pass/sort-layers.wgsl`). Equal depths are told apart by the number of the surface, and by what else a node
// has, so the order in which the city is drawn does not matter.

@group(3) @binding(0) var<storage, read_write> heads: array<atomic<u32>>;
@group(3) @binding(1) var<storage, read> nodes: array<vec2u>;

const FIRST_HEAD: u32 = 272u;
const NODE_CODE: u32 = 0x07ffffffu;
override SORTED: bool = false;  // whether lists are in order
// Words of a record that methods keep of each pixel behind the heads, as `lib/slots.wgsl` has it; 0: none. One says how many layers
// there are; with more of them lists go on where others ended.
override RECORD: u32 = 0u;
// Whether what found no place in the lists is one layer behind them, as `lib/tail.wgsl` makes it.
override TAIL: bool = false;
@group(3) @binding(2) var tail_sums: texture_2d<f32>;
@group(3) @binding(3) var tail_through: texture_2d<f32>;
const RECORD_COLOR: u32 = 3u;
const RECORD_THROUGH: u32 = 6u;
const RECORD_LAID: u32 = 7u;
const RECORD_SHOWN: u32 = 8u;
const RECORD_SHOWN_DEPTH: u32 = 10u;
const RECORD_BEFORE: u32 = 11u;     // bits of the depth of the last layer
// Mesa's software driver ends the loops of a shader after 65535 rounds in all.
const MOST_ROUNDS: u32 = 50000u;
// Whether one layer is told, with its opacity below 0, in place of all: what is composited elsewhere.
override PICKS: bool = false;
const PICKED: u32 = 3u;         // the word of `heads` that has its number
const LONGEST: u32 = 2u;        // the word of `heads` that has the length of the longest list that was not done
const MOST_LAYERS: u32 = 1u;    // the word of `heads` that has the largest number of layers of a pixel
// Less light let through than this is not seen, whatever its colour.
const NOTHING_SEEN: f32 = 5.9604645e-8;     // 2^-24

//@kept
const NO_NODE = FragmentNode(vec4u(0u), 0u);
// Where lists begin: before all nodes, and no node.
const BEFORE_ALL = FragmentNode(vec4u(0xffffffffu, 0u, 0u, 0u), 0u);

// How many layers the pixel of the picture has that has most.
fn most_layers() -> u32 {
    return atomicLoad(&heads[MOST_LAYERS]);
}

// The answer of a rule as an opacity, 0 to 1; 0 where it is no number.
fn contained_opacity(opacity: f32) -> f32 {
    return select(0.0, min(opacity, 1.0), opacity > 0.0);
}

//@opacity

// Whether a node comes before another: it is nearer, or stands in the plane of the other and is put before it.
fn precedes(first: FragmentNode, second: FragmentNode) -> bool {
    let a = first.key;
    let b = second.key;
    var is_before = a.x > b.x || (a.x == b.x && a.y < b.y);
    if SMOOTH || TEXTURED {
        let is_alike = all(a.xy == b.xy);
        is_before = is_before || (is_alike && (a.z < b.z || (a.z == b.z && a.w < b.w)));
    }
    if TEXELS_EMIT {
        is_before = is_before || (all(a == b) && first.light < second.light);
    }
    return is_before;
}

fn are_alike(a: FragmentNode, b: FragmentNode) -> bool {
    return all(a.key == b.key) && a.light == b.light;
}

// What a node of this picture has.
fn node_of(node: FragmentNode) -> FragmentNode {
    let rest = select(vec2u(0u), node.key.zw, vec2<bool>(SMOOTH, TEXTURED));
    return FragmentNode(vec4u(node.key.xy, rest), select(0u, node.light, TEXELS_EMIT));
}

fn chosen(a: FragmentNode, b: FragmentNode, is_second: bool) -> FragmentNode {
    return FragmentNode(select(a.key, b.key, is_second), select(a.light, b.light, is_second));
}

// How many nodes there is room for.
fn room() -> u32 {
    return 2u * arrayLength(&nodes) / words_of_node();
}

fn word_at(place: u32) -> u32 {
    return nodes[place >> 1u][place & 1u];
}

fn link_of(number: u32) -> u32 {
    return word_at(link_place(room(), number - 1u));
}

fn node_at(number: u32) -> FragmentNode {
    var normal = 0u;
    var color = 0u;
    var light = 0u;
    if SMOOTH {
        normal = word_at(rest_place(room(), number - 1u, normal_word()));
    }
    if TEXTURED {
        color = word_at(rest_place(room(), number - 1u, color_word()));
    }
    if TEXELS_EMIT {
        light = word_at(rest_place(room(), number - 1u, light_word()));
    }
    return FragmentNode(vec4u(nodes[number - 1u], normal, color), light);
}

// Puts the nearer one first.
fn order(first: ptr<function, FragmentNode>, second: ptr<function, FragmentNode>) {
    let is_wrong = precedes(*second, *first);
    let nearer = chosen(*first, *second, is_wrong);
    *second = chosen(*second, *first, is_wrong);
    *first = nearer;
}

fn nearer_of(a: FragmentNode, b: FragmentNode) -> FragmentNode {
    return chosen(a, b, precedes(b, a));
}

// A walk through a list.
struct Walk {
    next: u32,
    count: u32,                 // nodes so far
    twins: u32,                 // of them that are alike with the last that was laid
}

// The next node of a list, if it comes after `last`, of which `laid` that are alike were laid; otherwise, and at the end, none.
fn take_node(walk: ptr<function, Walk>, last: FragmentNode, laid: u32) -> FragmentNode {
    let is_there = (*walk).next != 0u;
    // A software adapter goes through both sides of a branch: the end of a list reads the first of all nodes.
    let number = max((*walk).next, 1u);
    let node = node_at(number);
    let is_twin = is_there && are_alike(node, last);
    (*walk).twins += select(0u, 1u, is_twin);
    (*walk).count += select(0u, 1u, is_there);
    (*walk).next = select(0u, link_of(number), is_there);
    return chosen(NO_NODE, node, is_there && (precedes(last, node) || (is_twin && (*walk).twins > laid)));
}

struct Composite {
    @location(0) transparency: vec4f,   // colours times opacity; a: what is let through
    @location(1) shown: vec2u,  // number and normal of the layer that is the shown surface, as the geometry target has them; 0: none
    @location(2) depth: f32,    // its stored depth
}

@fragment
fn transparency(in: Corner) -> @location(0) vec4f {
    return composite(in).transparency;
}

@fragment
fn transparency_and_shown(in: Corner) -> Composite {
    return composite(in);
}

// A number of a record.
fn recorded(word: u32) -> f32 {
    return bitcast<f32>(atomicLoad(&heads[word]));
}

fn composite(in: Corner) -> Composite {
    take(in);
    let pixel = vec2i(in.clip.xy);
    let head = atomicLoad(&heads[FIRST_HEAD + u32(pixel.y) * u32(view.size.x) + u32(pixel.x)]);
    var color = vec3f(0.0);
    var through = 1.0;
    var city_through = 1.0;     // of it what the city's layers let through: fields are not among what AOVs tell of
    var shown = vec2u(0u);
    var shown_depth = 0.0;
    var laid = 0u;
    var last = BEFORE_ALL;
    var twins = 0u;             // layers that were laid alike with the last
    var count = 0u;
    var rounds = 0u;            // of walks
    var picked = vec4f(0.0, 0.0, 0.0, 1.0);
    begin_fields(pixel, in.clip.xy, in.part.x);
    let least_seen = select(NOTHING_SEEN, 0.0, PICKS);
    var listed = head;          // of a list in order: the next node
    var is_left = head != 0u;
    if SORTED {
        for (var next = head; next != 0u; next = link_of(next)) {
            count += 1u;
        }
    }
    let size = vec2u(view.size);
    let record = FIRST_HEAD + size.x * size.y + (u32(pixel.y) * size.x + u32(pixel.x)) * RECORD;
    if RECORD > 0u {
        count = atomicLoad(&heads[record]);
    }
    if RECORD > 1u {
        laid = atomicLoad(&heads[record + RECORD_LAID]);
    }
    if RECORD > 1u && laid > 0u {
        color = vec3f(recorded(record + RECORD_COLOR), recorded(record + RECORD_COLOR + 1u), recorded(record + RECORD_COLOR + 2u));
        through = recorded(record + RECORD_THROUGH);
        city_through = through;
        shown = vec2u(atomicLoad(&heads[record + RECORD_SHOWN]), atomicLoad(&heads[record + RECORD_SHOWN + 1u]));
        shown_depth = recorded(record + RECORD_SHOWN_DEPTH);
        // The nodes in the list come after it.
        last.key.x = atomicLoad(&heads[record + RECORD_BEFORE]);
    }
    while is_left {
        var walk = Walk(select(head, 0u, SORTED), 0u, 0u);
        //@first
        if SORTED {
            kept_0 = node_at(listed);
            listed = link_of(listed);
        }
        while walk.next != 0u {
            //@more
            // Here, not at the beginning: a software adapter goes through a whole round to find that there is none.
            if walk.next == 0u {
                break;
            }
        }
        count = select(walk.count, count, SORTED);
        rounds += count;
        let most = select(min(KEPT, count - laid), 1u, SORTED);
        var place = 0u;
        var is_kept = kept_0.key.x != 0u;
        while is_kept {
            //@pick
            let depth = bitcast<f32>(node.key.x);
            let normal = node.key.z;
            var before = vec4f(color, through);
            lay_fields(pixel, in.clip.xy, distance_of_depth(depth), in.part.x, &before);
            color = before.rgb;
            through = before.w;
            let code = node.key.y & NODE_CODE;
            see_object(surface_shown(code - 1u).object);
            see_pixel(in.clip.xy, distance_of_depth(depth));
            let ray = ray_of_pixel(in.clip.xy);
            var point = point_of(pixel, ray, depth, vec2u(code, normal), unpacked(node.light));
            point.base = point.natural;
            if TEXTURED {
                let texel = unpacked_texel(node.key.w);
                point.base = texel.rgb;
                point.opacity *= texel.a;
            }
            if CLAY {
                point.base = CLAY_COLOR;
            }
            point.layer = laid;
            point.last_layer = count - 1u;
            point.is_covered = node.key.x == last.key.x;
            let classes = classes_at(sight_at(pixel, ray, depth, point.object), in.part.x);
            let opacity = opacity_at(point, classes);
            let paint = shade(&point, classes);
            color += (through * opacity) * paint;
            through *= 1.0 - opacity;
            city_through *= 1.0 - opacity;
            if PICKS {
                picked = select(picked, vec4f(paint, -opacity), laid == atomicLoad(&heads[PICKED]));
            }
            if city_through <= 0.5 && shown.x == 0u {
                shown = vec2u(code, normal);
                shown_depth = depth;
                write_classes(pixel, point, classes);
            }
            laid += 1u;
            twins = select(1u, twins + 1u, are_alike(node, last));
            last = node;
            place += 1u;
            is_kept = place < most && through >= least_seen;
            if !is_kept {
                break;
            }
        }
        is_left = select(laid < count, listed != 0u, SORTED) && through >= least_seen;
        if is_left && !SORTED && rounds + count > MOST_ROUNDS {
            atomicMax(&heads[LONGEST], count);
            is_left = false;
        }
        if !is_left {
            break;
        }
    }
    let opaque_depth = textureLoad(scene_depth, pixel, 0);
    var before = vec4f(color, through);
    lay_fields(pixel, in.clip.xy, select(FAR_AWAY, distance_of_depth(opaque_depth), opaque_depth > 0.0), in.part.x, &before);
    color = before.rgb;
    through = before.w;
    // What fields hide is the shown surface still.
    if through <= 0.5 && city_through > 0.5 {
        write_classes_of_opaque(pixel, in.clip.xy, opaque_depth, in.part.x);
    }
    if TAIL {
        let sum = textureLoad(tail_sums, pixel, 0);
        let rest = textureLoad(tail_through, pixel, 0).x;
        if sum.a > 0.0 {
            color += (through * (1.0 - rest)) * (sum.rgb / sum.a);
        }
        through *= rest;
        // Which of the layers is the shown surface is not known: it is what is opaque.
        if through <= 0.5 && shown.x == 0u {
            let depth = textureLoad(scene_depth, pixel, 0);
            see_object(surface_shown(textureLoad(codes, pixel, 0).x - 1u).object);
            see_pixel(in.clip.xy, distance_of_depth(depth));
            let ray = ray_of_pixel(in.clip.xy);
            let point = point_at(pixel, ray, depth);
            write_classes(pixel, point, classes_at(sight_of_point(point, ray), in.part.x));
        }
    }
    if RECORD > 1u && laid > 0u {
        for (var i = 0u; i < 3u; i++) {
            atomicStore(&heads[record + RECORD_COLOR + i], bitcast<u32>(color[i]));
            if i == 2u {
                break;
            }
        }
        atomicStore(&heads[record + RECORD_THROUGH], bitcast<u32>(through));
        atomicStore(&heads[record + RECORD_LAID], laid);
        atomicStore(&heads[record + RECORD_SHOWN], shown.x);
        atomicStore(&heads[record + RECORD_SHOWN + 1u], shown.y);
        atomicStore(&heads[record + RECORD_SHOWN_DEPTH], bitcast<u32>(shown_depth));
        atomicStore(&heads[record + RECORD_BEFORE], last.key.x);
    }
    return Composite(select(vec4f(color, through), picked, PICKS), shown, shown_depth);
}
