//! Scenes as `docs/scene.md` describes them, written as text: the mask of each lens is what the words there mean, worked out here in
//! f64 without any of the program's geometry.

use crate::studio::{bits, is_thorough, of_scene, picture, snapping};
use glam::{DMat3, DVec2, DVec3};
use veduta::figure::scene_file::{self, Options};

/// The size of pictures, and how many pixels each lens holds from all eyes.
const WHOLE: ([u32; 2], usize) = ([480, 360], 1000);

/// Whether a lens holds a place, seen from the eye.
type Holds = Box<dyn Fn(DVec3) -> bool>;

/// A lens: its keys, and what they mean.
struct Described {
    keys: &'static str,
    holds: Holds,
}

fn lens(keys: &'static str, holds: impl Fn(DVec3) -> bool + 'static) -> Described {
    Described { keys, holds: Box::new(holds) }
}

/// `[yaw, pitch, roll]`: what is at (x, y, z) of the shape's own axes stands at this matrix times that.
fn rotated(yaw: f64, pitch: f64, roll: f64) -> DMat3 {
    let [yaw, pitch, roll] = [yaw, pitch, roll].map(f64::to_radians);
    // Its x: east, turned counter-clockwise as seen from above, its end lifted.
    let x = DVec3::new(yaw.cos() * pitch.cos(), yaw.sin() * pitch.cos(), pitch.sin());
    let level = DVec3::new(-yaw.sin(), yaw.cos(), 0.0);
    let steep = x.cross(level);
    let y = level * roll.cos() + steep * roll.sin();
    DMat3::from_cols(x, y, x.cross(y))
}

/// Height and distance from an axis through `from`.
fn along(p: DVec3, from: DVec3, axis: DVec3) -> (f64, f64) {
    let axis = axis / axis.length();
    let at = (p - from).dot(axis);
    (at, (p - from - at * axis).length())
}

/// Whether a polygon goes around a place, by the angles its sides are seen under.
fn goes_around(points: &[[f64; 2]], p: DVec2) -> bool {
    let ring = points.iter().zip(points.iter().cycle().skip(1));
    let turn: f64 = ring.map(|(&a, &b)| (DVec2::from(a) - p).angle_to(DVec2::from(b) - p)).sum();
    turn.abs() > std::f64::consts::PI
}

fn distance_to_segment(p: DVec2, a: DVec2, b: DVec2) -> f64 {
    let t = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
    (p - a - t * (b - a)).length()
}

/// Analytic shapes, alone, turned, several in one lens.
fn forms() -> Vec<Described> {
    vec![
        lens(r#"shape = { kind = "sphere", center = [0, 0, 10], radius = 48.0 }"#, |p| {
            p.distance(DVec3::new(0.0, 0.0, 10.0)) < 48.0
        }),
        lens(
            r#"shape = { kind = "ellipsoid", center = [90, 30, 5], radii = [80, 35, 25], rotation_deg = [30, 10, -20] }"#,
            |p| {
                let own = rotated(30.0, 10.0, -20.0).transpose() * (p - DVec3::new(90.0, 30.0, 5.0));
                (own / DVec3::new(80.0, 35.0, 25.0)).length() < 1.0
            },
        ),
        lens(
            r#"shape = { kind = "box", center = [-80, -40, 8], size = [120, 50, 40], rotation_deg = [-35, 15, 25] }"#,
            |p| {
                let own = rotated(-35.0, 15.0, 25.0).transpose() * (p - DVec3::new(-80.0, -40.0, 8.0));
                own.abs().cmplt(DVec3::new(60.0, 25.0, 20.0)).all()
            },
        ),
        lens(
            r#"shape = { kind = "cylinder", center = [60, -70, 10], radius = 30, height = 150, axis = [2, 1, 0.2] }"#,
            |p| {
                let (at, out) = along(p, DVec3::new(60.0, -70.0, 10.0), DVec3::new(2.0, 1.0, 0.2));
                at.abs() < 75.0 && out < 30.0
            },
        ),
        lens(r#"shape = { kind = "cone", center = [-60, 80, 25], radius = 70, height = 70 }"#, |p| {
            let (at, out) = along(p, DVec3::new(-60.0, 80.0, 25.0), DVec3::Z);
            at.abs() < 35.0 && out < 70.0 * (0.5 - at / 70.0)
        }),
        lens(
            r#"shapes = [
    { kind = "frustum", center = [150, -20, 10], radius = 20, top_radius = 45, height = 60, axis = [0, -1, 0.5] },
    { kind = "sphere", center = [200, 60, 0], radius = 40 },
]"#,
            |p| {
                let (at, out) = along(p, DVec3::new(150.0, -20.0, 10.0), DVec3::new(0.0, -1.0, 0.5));
                let cone = at.abs() < 30.0 && out < 32.5 + 25.0 * at / 60.0;
                cone || p.distance(DVec3::new(200.0, 60.0, 0.0)) < 40.0
            },
        ),
        lens(
            r#"shape = { kind = "convex", points = [[-30, -130, -1], [80, -120, -1], [20, -20, -1], [20, -90, 70]] }"#,
            |p| {
                // In a tetrahedron a place is on the inner side of all four faces.
                let corners = [[-30.0, -130.0, -1.0], [80.0, -120.0, -1.0], [20.0, -20.0, -1.0], [20.0, -90.0, 70.0]];
                let corners = corners.map(DVec3::from);
                (0..4).all(|i| {
                    let [a, b, c] = [1, 2, 3].map(|k| corners[(i + k) % 4]);
                    let normal = (b - a).cross(c - a);
                    normal.dot(p - a) * normal.dot(corners[i] - a) > 0.0
                })
            },
        ),
        lens(
            r#"shape = { kind = "polytope", planes = [[1, 0, 0, -100], [-1, 0, 0, 190], [0, 1, 0, 60], [0, -2, 0, 80], [0, 0, 1, 30], [0, 0, -1, 1], [1, 1, 0, -110]] }"#,
            |p| {
                let within = p.x < -100.0 && p.x > -190.0 && p.y < 60.0 && p.y > -40.0 && p.z < 30.0 && p.z > -1.0;
                within && p.x + p.y < -110.0
            },
        ),
        lens(
            r#"shape = { kind = "corridor", points = [[-200, -90, 5], [0, -60, 5], [120, 90, 5]], width = 30, height = 20 }"#,
            |p| {
                let line = [[-200.0, -90.0], [0.0, -60.0], [120.0, 90.0]].map(DVec2::from);
                let near = line.windows(2).any(|w| distance_to_segment(p.truncate(), w[0], w[1]) < 15.0);
                near && (p.z - 5.0).abs() < 10.0
            },
        ),
    ]
}

const DISTRICT: [[f64; 2]; 6] =
    [[-150.0, -60.0], [-20.0, -110.0], [30.0, -10.0], [110.0, 20.0], [40.0, 130.0], [-60.0, 20.0]];
const SQUARE: [[f64; 2]; 4] = [[-60.0, -50.0], [-20.0, -50.0], [-20.0, -10.0], [-60.0, -10.0]];

fn district(p: DVec3) -> bool {
    let q = p.truncate();
    p.z > -2.0 && p.z < 38.0 && goes_around(&DISTRICT, q) && !goes_around(&SQUARE, q)
}

/// Solids, combinations, choices.
fn bodies() -> Vec<Described> {
    let ball = |x: f64, y: f64, z: f64, r: f64| move |p: DVec3| p.distance(DVec3::new(x, y, z)) < r;
    vec![
        lens(
            r#"shape = { kind = "mask", base = -2, height = 40, points = [[-150, -60], [-20, -110], [30, -10], [110, 20], [40, 130], [-60, 20]], holes = [[[-60, -50], [-20, -50], [-20, -10], [-60, -10]]] }"#,
            district,
        ),
        lens(
            r#"shape = { kind = "union", shapes = [{ kind = "sphere", center = [120, 0, 10], radius = 50 }, { kind = "sphere", center = [170, 20, 10], radius = 40 }] }"#,
            move |p| ball(120.0, 0.0, 10.0, 50.0)(p) || ball(170.0, 20.0, 10.0, 40.0)(p),
        ),
        lens(
            r#"shape = { kind = "intersection", shapes = [{ kind = "sphere", center = [0, -60, 0], radius = 80 }, { kind = "box", center = [10, -60, 10], size = [60, 200, 60] }] }"#,
            move |p| {
                ball(0.0, -60.0, 0.0, 80.0)(p)
                    && (p - DVec3::new(10.0, -60.0, 10.0)).abs().cmplt(DVec3::new(30.0, 100.0, 30.0)).all()
            },
        ),
        lens(
            r#"shape = { kind = "difference", shapes = [{ kind = "cylinder", center = [-120, 60, 0], radius = 70, height = 90 }, { kind = "sphere", center = [-100, 50, 5], radius = 45 }, { kind = "sphere", center = [-170, 60, 5], radius = 25 }] }"#,
            move |p| {
                let (at, out) = along(p, DVec3::new(-120.0, 60.0, 0.0), DVec3::Z);
                at.abs() < 45.0 && out < 70.0 && !ball(-100.0, 50.0, 5.0, 45.0)(p) && !ball(-170.0, 60.0, 5.0, 25.0)(p)
            },
        ),
    ]
}

/// The eye of a scene: its keys, where it is, its axes, and half the height of what it sees (of perspective views at distance 1).
struct Eye {
    keys: &'static str,
    at: DVec3,
    axes: [DVec3; 3],
    half: f64,
    is_level: bool,
}

impl Eye {
    fn new(keys: &'static str, at: [f64; 3], target: [f64; 3], half: f64, is_level: bool) -> Self {
        let (at, target) = (DVec3::from(at), DVec3::from(target));
        let forward = (target - at) / (target - at).length();
        let right = forward.cross(DVec3::Z) / forward.cross(DVec3::Z).length();
        Self { keys, at, axes: [right, right.cross(forward), forward], half, is_level }
    }

    /// The width of a pixel at distance D, metres.
    fn pixel_m(&self, size: [u32; 2], d: f64) -> f64 {
        2.0 * self.half / f64::from(size[1]) * if self.is_level { 1.0 } else { d }
    }

    /// Where a pixel's sight line is at distance D.
    fn place(&self, [x, y]: [u32; 2], size: [u32; 2], d: f64) -> DVec3 {
        let [w, h] = size.map(f64::from);
        let right = self.half * (w / h) * (2.0 * (f64::from(x) + 0.5) / w - 1.0);
        let up = self.half * (1.0 - 2.0 * (f64::from(y) + 0.5) / h);
        let [to_right, upwards, forward] = self.axes;
        let across = right * to_right + up * upwards;
        self.at + d * forward + if self.is_level { across } else { d * across }
    }
}

fn eyes() -> [Eye; 3] {
    [
        Eye::new(
            "eye = [-40, -330, 210]\ntarget = [20, 0, 0]",
            [-40.0, -330.0, 210.0],
            [20.0, 0.0, 0.0],
            22.5_f64.to_radians().tan(),
            false,
        ),
        Eye::new(
            "eye = [150, 90, 95]\ntarget = [-60, -30, 5]\nfov_deg = 70\nnear_m = 0.5",
            [150.0, 90.0, 95.0],
            [-60.0, -30.0, 5.0],
            35.0_f64.to_radians().tan(),
            false,
        ),
        Eye::new(
            "eye = [-200, 250, 300]\ntarget = [0, 0, 0]\nprojection = \"orthographic\"\nheight_m = 330",
            [-200.0, 250.0, 300.0],
            [0.0, 0.0, 0.0],
            165.0,
            true,
        ),
    ]
}

/// Draws the lenses from each eye and compares their masks, each of which holds more than `least` pixels; places that move across a border within the rounding of stored depths
/// (8·2⁻²³ of the distance, a second half as much for the faces' own band) may be on either side.
fn check(described: &[Described], style: &str, eyes: &[Eye], (size, least): ([u32; 2], usize)) {
    let mut studio = None;
    let mut inside = vec![0; described.len()];
    for eye in eyes {
        let mut text = format!("veduta = 1\n[city]\nfiles = [\"builtin:town\"]\n[camera]\n{}\n{style}", eye.keys);
        for (i, one) in described.iter().enumerate() {
            text.push_str(&format!("\n[[lens]]\nname = \"{i}\"\neffects = [\"sepia\"]\n{}\n", one.keys));
        }
        let scene = scene_file::parse(&text, "described.toml", &Options::default()).unwrap_or_else(|e| panic!("{e}"));
        let studio = studio.get_or_insert_with(|| of_scene(&scene));
        let drawn = picture(studio, &scene, size);
        let depth = drawn.depth.as_ref().expect("depth was asked for");
        for (i, one) in described.iter().enumerate() {
            let (mask, mut on_border) = (bits(&drawn, i), 0);
            for (pixel, &d) in depth.iter().enumerate() {
                let (x, y) = (pixel as u32 % size[0], pixel as u32 / size[0]);
                let d = f64::from(d);
                if !d.is_finite() {
                    assert!(!mask[pixel], "lens {i} holds the sky at {x},{y}");
                    continue;
                }
                let place = eye.place([x, y], size, d);
                let holds = (one.holds)(place);
                inside[i] += usize::from(holds);
                if mask[pixel] == holds {
                    continue;
                }
                // Steps along axes cross a face that leans by its distance times sqrt(3) at most.
                let off = 3_f64.sqrt() * snapping() * eye.pixel_m(size, d);
                let band = 12.0 * f64::from(f32::EPSILON) * d.max(place.length() + eye.at.length()) + off;
                let steps = [DVec3::X, DVec3::Y, DVec3::Z].into_iter().flat_map(|axis| [axis * band, axis * -band]);
                let is_near = steps.into_iter().any(|step| (one.holds)(place + step) != holds);
                assert!(
                    is_near,
                    "lens {i} at {x},{y}, {d} m from the eye at {}: mask {}, f64 {holds}",
                    eye.at, mask[pixel]
                );
                on_border += 1;
            }
            assert!(on_border < 20, "lens {i}: {on_border} pixels on its border");
        }
    }
    assert!(inside.iter().all(|&count| count > least), "pixels inside of the lenses: {inside:?}");
}

#[test]
fn analytic_shapes_hold_what_their_words_say() {
    check(&forms(), "", &eyes(), WHOLE);
}

#[test]
fn solids_and_combinations_hold_what_their_words_say() {
    check(&bodies(), "", &eyes(), WHOLE);
}

#[test]
fn many_of_them_hold_the_same() {
    let all = || forms().into_iter().chain(bodies());
    let many: Vec<Described> = all().chain(all()).chain(forms()).collect();
    // So many take most of a minute from each eye.
    let (eyes, style) = (eyes(), "[sun]\nshadows = false");
    if is_thorough() {
        check(&many, style, &eyes, WHOLE);
    } else {
        check(&many, style, &eyes[..1], ([160, 120], 75));
    }
}
