//! Closed bodies of faces whose corners are whole millimetres, as a translucent city: how many layers each pixel has by each method, and
//! by an outline in f64 how many there must be.

use std::{
    path::PathBuf,
    sync::atomic::{AtomicU32, Ordering::Relaxed},
};

use glam::{DVec2, DVec3};
use veduta::{
    render::{frame::Backend, picture::Studio},
    scene::{Scene, Transparency},
    view::{Camera, View},
};

use crate::{oracle::P3, panes::transparency, studio};

/// Where the bodies' origin is, metres: where cities are.
pub const ORIGIN: DVec3 = DVec3::new(85_000.0, 447_000.0, 3.0);

/// A body: its faces, each a ring of corners in millimetres from [`ORIGIN`].
pub type Body = Vec<Vec<P3>>;

/// Metres.
pub fn place(p: P3) -> DVec3 {
    ORIGIN + 0.001 * DVec3::from(p.map(|c| c as f64))
}

/// A box from corner to corner; of no size along an axis it is two faces, one on the other.
pub fn block(low: P3, high: P3) -> Body {
    let at = |i: usize| [0, 1, 2].map(|axis| if i >> axis & 1 == 0 { low[axis] } else { high[axis] });
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let is_flat = |face: &[usize; 4]| {
        let sizes =
            (0..3).filter(|&axis| low[axis] != high[axis] && face.iter().any(|i| (i ^ face[0]) >> axis & 1 == 1));
        sizes.count() < 2
    };
    faces.into_iter().filter(|face| !is_flat(face)).map(|face| face.map(at).to_vec()).collect()
}

/// The city of these bodies, an object each.
pub fn studio_of(bodies: &[Body]) -> Studio {
    static MADE: AtomicU32 = AtomicU32::new(0);
    let mut vertices: Vec<P3> = Vec::new();
    let mut objects = Vec::new();
    for (i, body) in bodies.iter().enumerate() {
        let mut faces = Vec::new();
        for ring in body {
            let first = vertices.len();
            vertices.extend(ring);
            let corners: Vec<String> = (first..vertices.len()).map(|v| v.to_string()).collect();
            faces.push(format!("[[{}]]", corners.join(",")));
        }
        objects.push(format!(
            r#""b{i}": {{"type": "Building", "geometry": [{{"type": "MultiSurface", "lod": "2", "boundaries": [{}]}}]}}"#,
            faces.join(",")
        ));
    }
    let vertices: Vec<String> = vertices.iter().map(|[x, y, z]| format!("[{x},{y},{z}]")).collect();
    let text = format!(
        r#"{{"type": "CityJSON", "version": "2.0", "transform": {{"scale": [0.001, 0.001, 0.001], "translate": [{}, {}, {}]}},
            "CityObjects": {{{}}}, "vertices": [{}]}}"#,
        ORIGIN.x,
        ORIGIN.y,
        ORIGIN.z,
        objects.join(",\n"),
        vertices.join(",")
    );
    let name = format!("veduta-bodies-{}-{}.city.json", std::process::id(), MADE.fetch_add(1, Relaxed));
    let path: PathBuf = std::env::temp_dir().join(name);
    std::fs::write(&path, text).expect("a temporary file");
    let made = studio::studio(std::slice::from_ref(&path));
    std::fs::remove_file(path).expect("the temporary file");
    made
}

/// The methods that lay or count every layer of a pixel.
pub const METHODS: [Transparency; 4] = [
    Transparency::Exact,
    Transparency::Peel { layers: 0 },
    Transparency::KBuffer { layers: 4 },
    Transparency::Weighted,
];

/// All that is shown lets so much less than all through.
pub fn translucent(camera: Camera, opacity: f64, method: Transparency) -> Scene {
    let mut scene = studio::scene(camera, vec![]);
    scene.style.effects = vec![studio::with_numbers("transparent", &[("opacity", opacity)])];
    scene.style.transparency = method;
    scene
}

/// How many layers each pixel has, 23 at most: each lets half of the light through, and powers of two are exact.
pub fn layers(studio: &mut Studio, camera: Camera, size: [u32; 2], method: Transparency) -> Vec<u32> {
    let layers = transparency(studio, &translucent(camera, 0.5, method), Backend::Specialised, size);
    let of = |v: &[f32; 4]| {
        let count = -v[3].log2();
        assert!(count.fract() == 0.0 && (0.0..=23.0).contains(&count), "{v:?}");
        count as u32
    };
    layers.iter().map(of).collect()
}

/// The layers of each pixel, alike by all [`METHODS`] and both back ends.
pub fn layers_by_all(studio: &mut Studio, camera: Camera, size: [u32; 2]) -> Vec<u32> {
    let exact = layers(studio, camera, size, Transparency::Exact);
    for method in METHODS {
        assert_eq!(exact, layers(studio, camera, size, method), "{method:?}");
    }
    let scene = translucent(camera, 0.5, Transparency::Exact);
    let [one, other] = [Backend::Specialised, Backend::Uber].map(|backend| transparency(studio, &scene, backend, size));
    assert_eq!(one, other, "both back ends");
    studio.backend = Backend::Specialised;
    exact
}

/// The outline of a convex body in a picture, pixels: a polygon, counter-clockwise in a system whose y goes down.
pub struct Outline(Vec<DVec2>);

impl Outline {
    /// Of the hull of these corners, as far as it is before the near plane.
    pub fn of(view: &View, corners: &[DVec3]) -> Self {
        let near = view.camera.near_m;
        let depth = |p: DVec3| (p - view.camera.eye).dot(view.basis.forward);
        let mut seen: Vec<DVec3> = corners.iter().copied().filter(|p| depth(*p) >= near).collect();
        // Where segments of the hull pass the near plane.
        for a in corners.iter().filter(|p| depth(**p) >= near) {
            for b in corners.iter().filter(|p| depth(**p) < near) {
                seen.push(*a + (*b - *a) * ((depth(*a) - near) / (depth(*a) - depth(*b))));
            }
        }
        let all = seen.iter().filter_map(|p| view.pixel(*p)).map(|p| p.truncate());
        Self(hull(all.collect()))
    }

    /// How far a place is inside, pixels; negative outside, where it may be less far than that.
    pub fn inside_by(&self, p: DVec2) -> f64 {
        let side = |i: usize| {
            let (a, b) = (self.0[i], self.0[(i + 1) % self.0.len()]);
            (b - a).perp_dot(p - a) / (b - a).length()
        };
        if self.0.len() < 3 { f64::NEG_INFINITY } else { (0..self.0.len()).map(side).fold(f64::INFINITY, f64::min) }
    }
}

/// The convex hull (monotone chain).
fn hull(mut points: Vec<DVec2>) -> Vec<DVec2> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup();
    let half = |points: &mut dyn Iterator<Item = DVec2>| {
        let mut chain: Vec<DVec2> = Vec::new();
        for p in points {
            while let [.., a, b] = chain[..]
                && (b - a).perp_dot(p - a) <= 0.0
            {
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let mut all = half(&mut points.iter().copied());
    all.extend(half(&mut points.iter().rev().copied()));
    all
}

/// The middle of the `i`th pixel.
pub fn middle(size: [u32; 2], i: usize) -> DVec2 {
    let width = size[0] as usize;
    DVec2::new((i % width) as f64 + 0.5, (i / width) as f64 + 0.5)
}
