// How far a place is from a solid; where that is more than its table is made for, not less than that. Twin:
// `veduta::geom::shape::solid::Near`, which says how.
//
// From `near` on: low x, y, z of the grid, cells per metre (f32); cells in x, y and z, fours of words that the next list
// takes; fours that the numbers of faces take, how far the table goes (f32, metres); where the faces of each cell begin; their numbers;
// the corners of all faces.

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

fn distance_to_solid(s: Solid, sight: Sight) -> f32 {
    if sight.distance >= FAR_AWAY {
        return FAR_AWAY;
    }
    let o = in_solid(s, sight.position - s.center);
    let first = s.near;
    let grid = bitcast<vec4f>(solids[first]);
    let sizes = solids[first + 1u];
    let cell = floor((o - grid.xyz) * grid.w);
    let reach = bitcast<f32>(solids[first + 2u].y);
    let half = 0.5 * vec3f(sizes.xyz) / grid.w;
    let beside = max(abs(o - grid.xyz - half) - half, vec3f(0.0));
    var distance = reach + length(beside);
    if all(cell >= vec3f(0.0)) && all(cell < vec3f(sizes.xyz)) {
        let at = vec3u(cell);
        let number = (at.z * sizes.y + at.y) * sizes.x + at.x;
        let starts = first + 3u;
        let begin = solids[starts + number / 4u][number % 4u];
        let end = solids[starts + (number + 1u) / 4u][(number + 1u) % 4u];
        let numbers = starts + sizes.w;
        let corners = numbers + solids[first + 2u].x;
        for (var i = begin; i < end; i++) {
            let face = corners + 3u * solids[numbers + i / 4u][i % 4u];
            let a = bitcast<vec3f>(solids[face].xyz);
            let b = bitcast<vec3f>(solids[face + 1u].xyz);
            let c = bitcast<vec3f>(solids[face + 2u].xyz);
            distance = min(distance, distance_to_face(o, a, b, c));
        }
    }
    return select(distance, -distance, solid_holds(s, sight.position, sight.distance, sight.off));
}
