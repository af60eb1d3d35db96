// How far a place is from a solid: exact where that is less than half the width of a border, else no more than it is and no less than
// that half. Twin: `veduta::geom::shape::Solid`. Each loop goes on even where it reads zeros (`shape/solid.wgsl`).

fn distance_to_face(p: vec3f, a: vec3f, b: vec3f, c: vec3f) -> f32 {
    let ab = b - a;
    let bc = c - b;
    let ca = a - c;
    let pa = p - a;
    let pb = p - b;
    let pc = p - c;
    let normal = cross(ab, -ca);
    let is_over = dot(cross(normal, ab), pa) >= 0.0 && dot(cross(normal, bc), pb) >= 0.0 && dot(cross(normal, ca), pc) >= 0.0;
    let area = dot(normal, normal);
    if is_over && area > 0.0 {
        return abs(dot(normal, pa)) / sqrt(area);
    }
    let to_ab = pa - ab * clamp(dot(pa, ab) / max(dot(ab, ab), 1e-30), 0.0, 1.0);
    let to_bc = pb - bc * clamp(dot(pb, bc) / max(dot(bc, bc), 1e-30), 0.0, 1.0);
    let to_ca = pc - ca * clamp(dot(pc, ca) / max(dot(ca, ca), 1e-30), 0.0, 1.0);
    return sqrt(min(dot(to_ab, to_ab), min(dot(to_bc, to_bc), dot(to_ca, to_ca))));
}

fn squared_distance_to_box(p: vec3f, low: vec3f, high: vec3f) -> f32 {
    let away = max(max(low - p, p - high), vec3f(0.0));
    return dot(away, away);
}

// Of one face of a solid, if it is at the border.
fn distance_to_border(face: u32, p: vec3f) -> f32 {
    let b = solids[face + 1u];
    let a = bitcast<vec3f>(solids[face].xyz);
    let c = bitcast<vec3f>(solids[face + 2u].xyz);
    return select(FAR_AWAY, distance_to_face(p, a, bitcast<vec3f>(b.xyz), c), b.w == 1u);
}

// The least distance of the faces of a leaf, two at most. No loop: software adapters end loops after 65,535 rounds of all of them.
fn distance_to_leaf_of_solid(s: Solid, node: SolidNode, p: vec3f) -> f32 {
    let first = s.first + solids[s.first + 2u].z + 4u * node.first;
    var distance = distance_to_border(first, p);
    if node.count > 1u {
        distance = min(distance, distance_to_border(first + 4u, p));
    }
    return distance;
}

// Of the surface, own coordinates.
fn distance_to_surface(s: Solid, p: vec3f, reach: f32) -> f32 {
    let sizes = solids[s.first + 2u];
    let nodes = s.first + sizes.x;
    var beyond = FAR_AWAY;
    var least = reach;
    for (var i = 0u; i < sizes.y;) {
        let own = solid_node(nodes + 2u * i);
        let free = sqrt(squared_distance_to_box(p, own.low, own.high));
        let is_entered = free < least;
        if is_entered && own.count > 0u {
            let distance = distance_to_leaf_of_solid(s, own, p);
            beyond = min(beyond, distance);
            least = min(least, distance);
        } else if !is_entered {
            beyond = min(beyond, free);
        }
        i = select(own.next, i + 1u, is_entered && own.count == 0u && own.next != NO_SOLID_NODE);
    }
    return select(beyond, least, least < reach);
}

fn distance_to_solid(s: Solid, sight: Sight, border: vec4f) -> f32 {
    if sight.distance >= FAR_AWAY {
        return FAR_AWAY;
    }
    let o = in_solid(s, sight.position - s.center);
    let distance = distance_to_surface(s, o, 0.5 * border_width(border, sight));
    return select(distance, -distance, solid_holds(s, sight.position, sight.distance, sight.off));
}
