//! Volumetric depth sprites: what is stored is what their CPU twin stores, and what is tested by them is what f64 says.

use crate::studio::{self, bits, lens, orthographic, picture, scene, synthetic};
use glam::{DQuat, DVec3};
use veduta::{
    geom::{Aabb, Shape},
    lens::{
        Class, Lens, LensSprite, Region,
        sprite::{Format, Mapping},
    },
    render::picture::Studio,
    view::{Camera, View},
};

const SIZE: [u32; 2] = [200, 150];

fn house(studio: &Studio) -> DVec3 {
    let geometry = studio.geometries[studio.geometries.len() / 2];
    studio.model.geometries[geometry as usize].bounds.center()
}

fn cameras(at: DVec3) -> [Camera; 3] {
    [
        Camera::looking(at + DVec3::new(90.0, -120.0, 70.0), at, 0.9),
        orthographic(at + DVec3::new(90.0, -120.0, 70.0), at, 160.0),
        // Inside of what is 30 m large.
        Camera::looking(at + DVec3::new(9.0, 3.0, 12.0), at + DVec3::new(60.0, 30.0, -6.0), 1.1),
    ]
}

fn view(camera: Camera, size: [u32; 2]) -> View {
    View::new(camera, size, &Aabb { min: camera.eye - 1e5, max: camera.eye + 1e5 }).expect("a view")
}

/// Every format and mapping of scene files.
fn codes() -> impl Iterator<Item = LensSprite> {
    let formats = Format::WORDS.into_iter().map(|(_, format)| format);
    formats
        .flat_map(|format| Mapping::WORDS.map(|(_, mapping)| LensSprite { format, mapping, ..LensSprite::default() }))
}

fn convex(at: DVec3) -> [Shape; 2] {
    let turn = DQuat::from_rotation_z(0.6) * DQuat::from_rotation_x(0.35);
    [
        Shape::Sphere { center: at, radius: 30.0 },
        Shape::Box { center: at, size: DVec3::new(50.0, 40.0, 30.0), rotation: turn },
    ]
}

#[test]
fn stored_codes_are_those_of_the_twin() {
    let mut studio = synthetic(20);
    let at = house(&studio);
    for camera in cameras(at) {
        for shape in convex(at) {
            let volume = shape.volume().expect("a volume");
            for sprite in codes() {
                let lens = Lens { sprite: Some(sprite), ..lens("any", [shape.clone()], "sepia") };
                let scene = scene(camera, vec![lens]);
                let found = studio.sprites(&scene, SIZE, 0).expect("a picture");
                let view = view(camera, SIZE);
                let of = format!("{shape:?} {sprite:?} from {}", camera.eye);
                assert_eq!(found.len(), 1, "{of}");
                let (found, code) = (&found[0], found[0].code);
                assert_eq!((found.layers, found.space.size, code.format), (1, SIZE, sprite.format), "{of}");
                let [width, height] = found.bounds.size;
                assert_eq!(found.codes.len() as u32, width * height, "{of}");
                let row = if sprite.format == Format::Unorm8 { width.next_multiple_of(2) } else { width };
                assert_eq!(found.bytes, u64::from(2 * row * height * sprite.format.bits() / 8), "{of}");
                let (mut met, mut apart) = (0, 0);
                for (i, &stored) in found.codes.iter().enumerate() {
                    let [x, y] = [i as u32 % width + found.bounds.origin[0], i as u32 / width + found.bounds.origin[1]];
                    let span = volume.entry_exit(&view.pixel_ray(x, y)).filter(|s| s.1 > 0.0 || view.is_orthographic());
                    let right = code.codes(span.map(|(a, b)| (a as f32, b as f32)), camera.near_m as f32);
                    met += u32::from(span.is_some());
                    if stored == right {
                        continue;
                    }
                    let (Some((enter, exit)), Some((a, b))) = (span, code.distances(stored)) else {
                        // Grazed by rounding.
                        apart += 1;
                        continue;
                    };
                    // f32 finds the ends of a grazing ray to the root of its rounding.
                    let grazing = 2.0 * 30.0 * (1e-4_f64 * 100.0 / (exit - enter).max(1e-3)).min(1.0) * 1e-2;
                    for (stored, right) in [(f64::from(a), enter), (f64::from(b), exit)] {
                        if stored.is_infinite() && right <= camera.near_m * 1.000_001 {
                            continue;
                        }
                        let right = right.clamp(code.near_m, code.far_m);
                        let quantum = code.quantum_m(right).max(code.quantum_m(stored.min(code.far_m)));
                        let room = 2.1 * quantum + 1e-4 + grazing;
                        assert!((stored - right).abs() <= room, "{of}: {x},{y} has {stored}, {right} is right, {room}");
                    }
                }
                assert!(met > 1500 && apart <= 4, "{of}: {apart} of {met}");
            }
        }
    }
}

/// Pixels of a lens' mask that are wrong in f64, and the furthest of them from the border in units of what is allowed: a quantum
/// of the format along the view axis, and a texel across it.
fn worst(studio: &mut Studio, camera: Camera, lens: &Lens, texel_px: f64) -> (usize, f64) {
    let scene = scene(camera, vec![lens.clone()]);
    let drawn = picture(studio, &scene, SIZE);
    let code = studio.sprites(&scene, SIZE, 0).expect("a picture")[0].code;
    let (view, inside) = (view(camera, SIZE), bits(&drawn, 0));
    let reference = studio::Reference::of(&lens.shapes[0]);
    let (mut wrong, mut most) = (0, 0.0_f64);
    for (i, &d) in drawn.depth.as_ref().expect("depth").iter().enumerate() {
        let ray = view.pixel_ray(i as u32 % SIZE[0], i as u32 / SIZE[0]);
        let p = ray.at(f64::from(d));
        let holds = d.is_finite() && reference.distance(p) <= 0.0;
        if inside[i] == holds {
            continue;
        }
        assert!(d.is_finite(), "{lens:?}: nothing is inside at {i}");
        wrong += 1;
        let d = f64::from(d);
        // Along the ray a quantum is longer than along the axis; a coarse one reaches from end to end.
        let along = ray.direction.length() * code.quantum_m(d.clamp(code.near_m, code.far_m));
        let room = 2.0 * along + 1.5 * texel_px * view.pixel_m(d) + 1e-3;
        most = most.max(reference.distance(p).abs() / room);
    }
    (wrong, most)
}

#[test]
fn masks_err_by_no_more_than_a_quantum_and_a_texel() {
    let mut studio = synthetic(60);
    let at = house(&studio);
    for camera in cameras(at) {
        for shape in convex(at) {
            let mut by_format = Vec::new();
            for sprite in codes() {
                for resolution in [None, Some(64)] {
                    let sprite = LensSprite { resolution, ..sprite };
                    let lens = Lens { sprite: Some(sprite), ..lens("any", [shape.clone()], "sepia") };
                    let (wrong, most) = worst(&mut studio, camera, &lens, if resolution.is_some() { 4.0 } else { 1.0 });
                    assert!(most <= 1.0, "{lens:?} from {}: {wrong} wrong, {most} times what is allowed", camera.eye);
                    if resolution.is_none() {
                        by_format.push((sprite, wrong));
                    }
                }
            }
            // The default is right to the pixel, 8 bits are not.
            let of = |format, mapping| {
                by_format.iter().find(|(s, _)| (s.format, s.mapping) == (format, mapping)).map(|(_, wrong)| *wrong)
            };
            assert!(of(Format::Float32, Mapping::InverseW) <= Some(3), "{by_format:?}");
            assert!(of(Format::Unorm8, Mapping::W) > Some(4), "{by_format:?}");
        }
    }
}

#[test]
fn the_other_classes_are_those_of_the_shapes() {
    let mut studio = synthetic(60);
    let at = house(&studio);
    for camera in cameras(at) {
        for shape in convex(at) {
            let all = |sprite| {
                let of_class = |class| veduta::lens::EffectUse { class, ..studio::used("sepia") };
                let classes = [Class::Inside, Class::Front, Class::Behind, Class::Rest];
                Lens { sprite, effects: classes.map(of_class).to_vec(), ..lens("any", [shape.clone()], "sepia") }
            };
            let mut counts = |sprite| {
                let drawn = picture(&mut studio, &scene(camera, vec![all(sprite)]), SIZE);
                let c = &drawn.statistics.lenses[0].classified;
                [c.inside, c.front, c.behind, c.rest].map(|n| n.expect("a count"))
            };
            let right = counts(None);
            for mapping in Mapping::WORDS.map(|(_, mapping)| mapping) {
                for format in [Format::Uint32, Format::Float32] {
                    let sprite = LensSprite { format, mapping, ..LensSprite::default() };
                    let found = counts(Some(sprite));
                    let apart = (0..4).map(|i| found[i].abs_diff(right[i])).max().unwrap_or(0);
                    assert!(apart <= 4, "{shape:?} {sprite:?} from {}: {found:?}, not {right:?}", camera.eye);
                }
            }
        }
    }
}

#[test]
fn clip_planes_that_are_given_clamp() {
    let mut studio = synthetic(60);
    let at = house(&studio);
    let camera = cameras(at)[0];
    let distance = camera.eye.distance(at);
    let ball: Region = Shape::Sphere { center: at, radius: 30.0 }.into();
    let mut inside = |near_m: f64, far_m: f64| {
        let sprite = LensSprite {
            format: Format::Unorm16,
            mapping: Mapping::W,
            near_m: Some(near_m),
            far_m: Some(far_m),
            ..LensSprite::default()
        };
        let lens = Lens { sprite: Some(sprite), ..lens("any", [ball.clone()], "sepia") };
        bits(&picture(&mut studio, &scene(camera, vec![lens]), SIZE), 0).iter().filter(|b| **b).count()
    };
    let all = inside(1.0, distance + 40.0);
    let half = inside(1.0, distance);
    assert!(half > 50 && half < all, "what lies beyond the far plane is not inside: {half} of {all}");
}

/// Lenses that rays enter and leave several times: solids, combinations, several shapes of one lens.
fn concave(at: DVec3) -> Vec<Vec<Region>> {
    let mut all: Vec<Vec<Region>> =
        studio::shapes(at, 30.0).split_off(7).into_iter().map(|focus| vec![focus]).collect();
    let ball = |x: f64| Region::from(Shape::Sphere { center: at + DVec3::new(x, 0.4 * x, 0.0), radius: 14.0 });
    all.push(vec![ball(-30.0), ball(-8.0), ball(8.0), ball(36.0)]);
    all.push(vec![all[1][0].clone(), ball(0.0), all[0][0].clone()]);
    all
}

#[test]
fn layers_hold_what_the_shapes_hold() {
    let mut studio = synthetic(60);
    let at = house(&studio);
    let mut inside = 0;
    for camera in cameras(at) {
        for shapes in concave(at) {
            for sprite in
                [LensSprite::default(), LensSprite { layers: 16, format: Format::Uint32, ..Default::default() }]
            {
                let of = |sprite| Lens { sprite, ..lens("any", shapes.clone(), "sepia") };
                let analytic = picture(&mut studio, &scene(camera, vec![of(None)]), SIZE);
                let with_sprite = scene(camera, vec![of(Some(sprite))]);
                let found = picture(&mut studio, &with_sprite, SIZE);
                let name = format!("{shapes:?} {sprite:?} from {}", camera.eye);
                assert_eq!(studio.sprites(&with_sprite, SIZE, 0).expect("a picture").len(), 1, "{name}");
                let depth = analytic.depth.as_ref().expect("depth");
                let view = view(camera, SIZE);
                let references: Vec<_> = shapes.iter().map(studio::Reference::of).collect();
                // Every pixel that differs lies within a texel of the border.
                let (right, seen) = (bits(&analytic, 0), bits(&found, 0));
                let mut apart = 0;
                for i in (0..right.len()).filter(|&i| right[i] != seen[i]) {
                    let d = f64::from(depth[i]);
                    let p = view.pixel_ray(i as u32 % SIZE[0], i as u32 / SIZE[0]).at(d);
                    let distance = references.iter().map(|r| r.distance(p)).fold(f64::INFINITY, f64::min).abs();
                    assert!(distance <= view.pixel_m(d), "{name}: pixel {i}, {distance} m from the border");
                    apart += 1;
                }
                assert!(apart <= 12, "{name}: {apart} differ");
                inside += right.iter().filter(|b| **b).count();
                let classes = |p: &veduta::render::picture::Picture| {
                    let c = &p.statistics.lenses[0].classified;
                    [c.inside, c.front, c.behind, c.rest].map(|n| n.expect("a count"))
                };
                let most = (0..4).map(|i| classes(&analytic)[i].abs_diff(classes(&found)[i])).max();
                assert!(most <= Some(12), "{name}: {:?}, not {:?}", classes(&found), classes(&analytic));
                assert!(found.statistics.warnings.is_empty(), "{name}: {:?}", found.statistics.warnings);
            }
        }
    }
    assert!(inside > 50_000, "{inside}");
}

/// A row of walls that a level ray goes through one by one, and the eye before it.
fn walls(at: DVec3, count: usize) -> (Camera, Vec<Region>) {
    let wall = |i: usize| {
        let center = at + DVec3::new(0.0, 4.0 * i as f64, 0.0);
        Region::from(Shape::Box { center, size: DVec3::new(80.0, 1.0, 60.0), rotation: DQuat::IDENTITY })
    };
    (Camera::looking(at - DVec3::Y * 40.0, at, 0.6), (0..count).map(wall).collect())
}

#[test]
fn rays_with_more_intervals_than_layers_are_counted() {
    let mut studio = synthetic(20);
    let at = house(&studio);
    let (camera, walls) = walls(at, 7);
    let mut drawn = |layers, aggregate| {
        let sprite = Some(LensSprite { layers, aggregate, ..LensSprite::default() });
        let scene = scene(camera, vec![Lens { sprite, ..lens("walls", walls.clone(), "sepia") }]);
        let texels = studio.sprites(&scene, SIZE, 0).expect("a picture").remove(0);
        (texels, picture(&mut studio, &scene, SIZE).statistics.warnings)
    };
    let middle = |texels: &veduta::render::stored::SpriteTexels| -> Vec<(f32, f32)> {
        let [x, y] = [0, 1].map(|i| SIZE[i] / 2 - texels.bounds.origin[i]);
        let first = ((y * texels.bounds.size[0] + x) * texels.layers) as usize;
        let codes = &texels.codes[first..first + texels.layers as usize];
        codes.iter().filter_map(|ends| texels.code.distances(*ends)).collect()
    };
    let near = |found: &[(f32, f32)], right: &[(f32, f32)]| {
        found.len() == right.len()
            && found.iter().zip(right).all(|(f, r)| (f.0 - r.0).abs() < 1e-3 && (f.1 - r.1).abs() < 1e-3)
    };
    let wall = |i: usize| (39.5 + 4.0 * i as f32, 40.5 + 4.0 * i as f32);
    let (all, none) = drawn(8, false);
    assert!(all.layers == 7 && none.is_empty(), "no more layers than there are shapes: {}, {none:?}", all.layers);
    assert!(near(&middle(&all), &(0..7).map(wall).collect::<Vec<_>>()), "{:?}", middle(&all));
    let (few, told) = drawn(3, false);
    assert!(near(&middle(&few), &[wall(0), wall(1), (wall(2).0, wall(6).1)]), "{:?}", middle(&few));
    assert_eq!(told.len(), 1);
    assert_eq!((&told[0]["code"], &told[0]["objects"][0]), (&"sprite-layers".into(), &"walls".into()));
    // All rays that meet the last wall, and no ray that meets none.
    let count = told[0]["count"].as_u64().expect("a count");
    assert!(count > 5_000 && count <= u64::from(SIZE[0] * SIZE[1]), "{count}");
    let (ends, none) = drawn(4, true);
    assert!(near(&middle(&ends), &[(wall(0).0, wall(6).1)]) && none.is_empty(), "{:?} {none:?}", middle(&ends));
}

/// A comb of walls in one mesh: more crossings than there is room for, where the picture shows little else.
#[test]
fn what_finds_no_room_on_the_lists_is_not_lost() {
    let mut studio = synthetic(20);
    let at = house(&studio);
    let mut text = String::new();
    let count = 30;
    for i in 0..count {
        let (low, high) = (f64::from(i), f64::from(i) + 0.5);
        for [x, y, z] in (0..8).map(|c| [[-30.0, 30.0][c & 1], [low, high][c >> 1 & 1], [-30.0, 30.0][c >> 2]]) {
            text += &format!("v {x} {y} {z}\n");
        }
        let first = 8 * i + 1;
        for [a, b, c, d] in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]] {
            text += &format!("f {} {} {} {}\n", first + a, first + b, first + c, first + d);
        }
    }
    let file = std::env::temp_dir().join(format!("veduta-comb-{}.obj", std::process::id()));
    std::fs::write(&file, text).expect("a temporary file");
    let comb = Region::Mesh { file: file.clone(), at, rotation: DQuat::IDENTITY, scale: 1.0 };
    let camera = Camera::looking(at - DVec3::Y * 20.0, at, 0.6);
    let size = [64, 48];
    let of = |sprite| Lens { sprite, ..lens("comb", [comb.clone()], "sepia") };
    let sprite = Some(LensSprite { layers: 16, ..LensSprite::default() });
    let with_sprite = scene(camera, vec![of(sprite)]);
    let texels = studio.sprites(&with_sprite, size, 0).expect("a picture").remove(0);
    let drawn = picture(&mut studio, &with_sprite, size);
    let analytic = picture(&mut studio, &scene(camera, vec![of(None)]), size);
    std::fs::remove_file(file).expect("the temporary file");
    // 60 crossings a ray, 8 have room at first.
    let told = &drawn.statistics.warnings[0];
    assert!(told["count"].as_u64() > Some(2_000), "{told}");
    let width = texels.bounds.size[0];
    let middle = (24 - texels.bounds.origin[1]) * width + 32 - texels.bounds.origin[0];
    let first = 16 * middle as usize;
    for (i, ends) in texels.codes[first..first + 15].iter().enumerate() {
        let (enter, exit) = texels.code.distances(*ends).expect("a wall");
        let right = 20.0 + i as f32;
        assert!((enter - right).abs() < 1e-3 && (exit - right - 0.5).abs() < 1e-3, "{i}: {enter} {exit}");
    }
    let last = texels.code.distances(texels.codes[first + 15]).expect("the rest");
    assert!((last.0 - 35.0).abs() < 1e-3 && (last.1 - 49.5).abs() < 1e-3, "{last:?}");
    // The first fifteen walls are told apart: there both tests agree.
    let depth = drawn.depth.as_ref().expect("depth");
    let (right, found) = (bits(&analytic, 0), bits(&drawn, 0));
    let wrong = (0..depth.len()).filter(|&i| depth[i] < 34.9 && right[i] != found[i]).count();
    assert!(wrong <= 3, "{wrong} of them are wrong");
}

/// The command line says it on stderr, and in the statistics.
#[test]
fn render_tells_of_too_few_layers() {
    let folder = std::env::temp_dir().join(format!("veduta-layers-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a temporary folder");
    let wall = |y: i32| format!("{{ kind = \"box\", center = [0, {y}, 5], size = [60, 2, 30] }}");
    let scene = format!(
        "veduta = 1\n[city]\nfiles = [\"builtin:square\"]\n[camera]\neye = [0, -80, 20]\ntarget = [0, 0, 5]\n[[lens]]\n\
         name = \"two walls\"\nshapes = [{}, {}]\nsprite = {{ layers = 1 }}\n",
        wall(-8),
        wall(8)
    );
    let file = |name: &str| folder.join(name);
    std::fs::write(file("s.toml"), scene).expect("a scene file");
    let output = crate::program()
        .arg("render")
        .arg(file("s.toml"))
        .args(["--size", "64x48", "--samples", "2", "-o"])
        .arg(file("o.png"))
        .arg("--stats")
        .arg(file("stats.json"))
        .output()
        .expect("it runs");
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{told}");
    assert!(told.contains("rays enter lens \"two walls\" more often than its sprite has layers"), "{told}");
    let stats = std::fs::read(file("stats.json")).expect("statistics");
    let stats: serde_json::Value = serde_json::from_slice(&stats).expect("JSON");
    let warnings = stats["warnings"].as_array().expect("a list");
    assert!(warnings.iter().any(|w| w["code"] == "sprite-layers" && w["count"].as_u64() > Some(100)), "{warnings:?}");
    std::fs::remove_dir_all(folder).expect("the temporary folder");
}
