// Regions of lenses as buffers hold them: four rows of numbers in view space. The host computes every number relative to the eye
// in f64 before it rounds to f32. The struct of the region's form says what they are (`shape/`, and `lib/` for members, combinations and
// sprites): its members name their places in the rows, by which they are loaded (`shader::rows`).

struct Region {
    a: vec3f,
    test: u32,                  // SPHERE, ...: how the region is tested; as a leaf of a combination: its form
    b: vec4f,
    c: vec4f,
    d: vec4f,
}

// Further rows, named by regions: planes (n, d: inside where n.p <= d), sides of polygons, leaves of combinations, sprites' own eyes.
@group(1) @binding(1) var<storage, read> planes: array<vec4f>;

// Where a ray is inside: [enter, exit] in D, may start behind the eye; empty when enter > exit.
struct Span {
    enter: f32,
    exit: f32,
}

const EMPTY_SPAN = Span(1.0, -1.0);

// Where rays never leave.
const NO_END: f32 = FAR_AWAY;
