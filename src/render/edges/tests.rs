use glam::{DVec2, DVec3};

use super::{
    bench::{Bench, Solids, source},
    *,
};
use crate::{
    city::{
        CityModel, ObjectClass,
        edges::EdgeClass,
        test_city::{LATTICE, add, add_box, builder, grid_of_cubes},
    },
    view::{Camera, Projection, View},
};

const SIZE: [u32; 2] = [320, 200];

fn boxes(list: &[([i64; 3], [i64; 3])]) -> CityModel {
    let mut b = builder();
    for (i, (min, max)) in list.iter().enumerate() {
        add_box(&mut b, &i.to_string(), *min, *max);
    }
    b.finish()
}

/// Metres of the test cities in the world.
fn at(x: f64, y: f64, z: f64) -> DVec3 {
    LATTICE.origin + DVec3::new(x, y, z)
}

fn looking(eye: DVec3, target: DVec3, fov_deg: f64) -> View {
    View::new(Camera::looking(eye, target, fov_deg.to_radians()), SIZE, &Aabb::EMPTY).unwrap()
}

fn world_ends(edge: &Edge) -> [DVec3; 2] {
    [edge.start, edge.end].map(|p| IVec3::from(edge.origin).as_dvec3() + Vec3::from(p).as_dvec3())
}

/// Where a segment before the near plane is in the picture: pixels, y down.
fn projected(view: &View, ends: [DVec3; 2]) -> Option<[DVec2; 2]> {
    let near = view.camera.near_m;
    let distance = |p: DVec3| (p - view.camera.eye).dot(view.basis.forward);
    let [a, b] = ends.map(distance);
    if a < near && b < near {
        return None;
    }
    let mut ends = ends;
    let cut = ends[0] + (ends[1] - ends[0]) * ((near - a) / (b - a));
    if a < near {
        ends[0] = cut;
    } else if b < near {
        ends[1] = cut;
    }
    let half = view.half_extent();
    Some(ends.map(|p| {
        let p = view.basis.view_from_world() * (p - view.camera.eye);
        let depth = if view.is_orthographic() { 1.0 } else { -p.z };
        let ndc = p.truncate() / depth / half;
        DVec2::new(0.5 + 0.5 * ndc.x, 0.5 - 0.5 * ndc.y) * DVec2::new(view.size[0].into(), view.size[1].into())
    }))
}

fn distance_to(p: DVec2, [a, b]: [DVec2; 2]) -> f64 {
    let along = b - a;
    let t = if along == DVec2::ZERO { 0.0 } else { ((p - a).dot(along) / along.length_squared()).clamp(0.0, 1.0) };
    p.distance(a + along * t)
}

/// Coverage of all pixels by the lines of some edges, from distances in f64.
fn oracle(view: &View, width: f64, edges: &[[DVec3; 2]]) -> Vec<f64> {
    let lines: Vec<_> = edges.iter().filter_map(|&ends| projected(view, ends)).collect();
    let pixel = |i: u32| DVec2::new(f64::from(i % view.size[0]) + 0.5, f64::from(i / view.size[0]) + 0.5);
    let covered = |i: u32| {
        let nearest = lines.iter().map(|&line| distance_to(pixel(i), line)).fold(f64::INFINITY, f64::min);
        (0.5 * width + 0.5 - nearest).clamp(0.0, 1.0)
    };
    (0..view.size[0] * view.size[1]).map(covered).collect()
}

/// The pixel where two pictures differ most, and by how much.
fn worst(a: &[f64], b: &[f64]) -> (usize, f64) {
    let differences = a.iter().zip(b).map(|(a, b)| (a - b).abs()).enumerate();
    differences.fold((0, 0.0), |worst, this| if this.1 > worst.1 { this } else { worst })
}

fn assert_same(what: &str, view: &View, drawn: &[f64], expected: &[f64], tolerance: f64) {
    let (i, error) = worst(drawn, expected);
    let (x, y) = (i as u32 % view.size[0], i as u32 / view.size[0]);
    assert!(error <= tolerance, "{what}: pixel {x},{y} is {}, not {}", drawn[i], expected[i]);
}

#[test]
fn the_shader_is_valid_and_has_the_hosts_layout() {
    let source = source(0.0);
    let parsed =
        wgpu::naga::front::wgsl::parse_str(&source).unwrap_or_else(|e| panic!("{}", e.emit_to_string(&source)));
    let mut validator = wgpu::naga::valid::Validator::new(
        wgpu::naga::valid::ValidationFlags::all(),
        wgpu::naga::valid::Capabilities::default() | wgpu::naga::valid::Capabilities::SHADER_FLOAT16_IN_FLOAT32,
    );
    validator.validate(&parsed).unwrap_or_else(|e| panic!("{}", e.emit_to_string(&source)));
    let found = parsed.types.iter().find_map(|(_, t)| match &t.inner {
        wgpu::naga::TypeInner::Struct { members, span } if t.name.as_deref() == Some("Edge") => {
            let names = members.iter().map(|m| (m.name.clone().unwrap_or_default(), m.offset as usize));
            Some((names.collect::<Vec<_>>(), *span as usize))
        }
        _ => None,
    });
    let (members, span) = found.expect("a struct Edge");
    let host = [
        ("origin", std::mem::offset_of!(Edge, origin)),
        ("surface", std::mem::offset_of!(Edge, surface)),
        ("start", std::mem::offset_of!(Edge, start)),
        ("normal_a", std::mem::offset_of!(Edge, normal_a)),
        ("end", std::mem::offset_of!(Edge, end)),
        ("normal_b", std::mem::offset_of!(Edge, normal_b)),
        ("inward", std::mem::offset_of!(Edge, inward)),
        ("along", std::mem::offset_of!(Edge, along)),
        ("other", std::mem::offset_of!(Edge, other)),
    ];
    assert_eq!(members.iter().map(|(n, o)| (n.as_str(), *o)).collect::<Vec<_>>(), host);
    // It is a vertex, not a member of an array: only in WGSL does it end on a multiple of 16.
    assert_eq!((span, size_of::<Edge>()), (80, 68));
    assert_eq!(Edge::LAYOUT.attributes.iter().map(|a| a.offset as usize).collect::<Vec<_>>(), host.map(|h| h.1));
    for (name, class) in [("BORDER", EdgeClass::Border), ("CREASE", EdgeClass::Crease), ("FLAT", EdgeClass::Flat)] {
        assert!(source.contains(&format!("const EDGE_{name}: u32 = {}u;", class as u32)));
    }
}

#[test]
fn halves_are_near() {
    let value = |h: u16| 2_f32.powi(i32::from(h >> 10) - 15) * (1.0 + f32::from(h & 0x3ff) / 1024.0);
    for m in [0.001, 0.05, 0.3, 1.0, 2.999, 64.0, 777.7, 65_000.0] {
        assert!((value(half(m)) - m).abs() <= m / 2048.0, "{m}");
    }
    assert_eq!([0.0, -1.0, 1e-9, 1e9, f32::INFINITY].map(half), [0, 0, 0, 0x7bff, 0x7bff]);
}

#[test]
fn instances_say_whose_they_are_and_chunks_hold_them() {
    let bench = Bench::new(grid_of_cubes(20, 10));
    assert_eq!((bench.edges.count, bench.all.len()), (2400, 2400));
    assert_eq!(bench.edges.bytes, 2400 * 68);
    for edge in &bench.all {
        let surface = bench.city.surface_table[(edge.surface & NO_SURFACE) as usize];
        assert_eq!(edge.surface >> CLASS_SHIFT, EdgeClass::Crease as u32);
        assert_eq!(surface.normal, edge.normal_a);
        let bounds = bench.model.geometries[surface.object as usize].bounds;
        assert!(world_ends(edge).iter().all(|p| bounds.meets(&Aabb::from_points([*p]))));
    }
    let chunks = &bench.edges.chunks;
    assert!(chunks.len() > 5);
    assert_eq!(chunks.iter().map(|c| c.0.len()).sum::<usize>(), 2400);
    for (range, bounds) in chunks {
        let inside = &bench.all[range.start as usize..range.end as usize];
        assert!(inside.iter().all(|e| world_ends(e).iter().all(|p| bounds.meets(&Aabb::from_points([*p])))));
    }
}

#[test]
fn only_wanted_chunks_are_drawn() {
    let bench = Bench::new(grid_of_cubes(20, 10));
    let over = looking(at(150.0, 75.0, 900.0), at(150.0, 76.0, 0.0), 45.0).frustum(1.0);
    assert_eq!(bench.edges.visible(&over, |_| true), vec![0..2400], "neighbours are one draw");
    assert_eq!(bench.edges.visible(&over, |_| false), vec![]);
    let lens = Aabb { min: at(20.0, 20.0, 0.0), max: at(30.0, 30.0, 5.0) };
    let drawn = bench.edges.visible(&over, |bounds| bounds.meets(&lens));
    let count: u32 = drawn.iter().map(|d| d.end - d.start).sum();
    assert!(count > 0 && count < 1200, "{count}");
    for (i, edge) in bench.all.iter().enumerate() {
        let is_drawn = drawn.iter().any(|d| d.contains(&(i as u32)));
        assert!(is_drawn || !Aabb::from_points(world_ends(edge)).meets(&lens));
    }
    let away = looking(at(-50.0, 75.0, 10.0), at(-60.0, 75.0, 10.0), 45.0).frustum(1.0);
    assert_eq!(bench.edges.visible(&away, |_| true), vec![]);
}

/// CPU twin of `edge_part` in `lib/edge.wgsl`, in f64.
fn edge_part(view: &View, [p, q]: [DVec3; 2], guard: DVec2) -> [f64; 2] {
    let half = view.half_extent();
    let near = view.camera.near_m;
    let inside = |p: DVec3| {
        let w = if view.is_orthographic() { 1.0 } else { -p.z };
        let c = p.truncate() / half;
        [-p.z - near, guard.x * w - c.x, guard.x * w + c.x, guard.y * w - c.y, guard.y * w + c.y]
    };
    let mut part = [0.0_f64, 1.0_f64];
    for (a, b) in inside(p).into_iter().zip(inside(q)) {
        if a < 0.0 && b < 0.0 {
            return [1.0, 0.0];
        }
        if a < 0.0 {
            part[0] = part[0].max(a / (a - b));
        } else if b < 0.0 {
            part[1] = part[1].min(a / (a - b));
        }
    }
    part
}

/// Segments around the eye: near and far, before and behind it.
fn segments(count: usize) -> Vec<[DVec3; 2]> {
    let mut x = 7_u64;
    let mut next = || {
        x = x.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (x >> 33) as f64 / f64::from(1_u32 << 31) - 0.5
    };
    let mut point = |scale: f64| DVec3::new(next(), next(), next() - 0.2) * scale;
    (0..count)
        .map(|i| {
            let scale = 10_f64.powi(i as i32 % 5 - 1);
            // f32 positions: what the shader gets.
            [point(scale), point(scale)].map(|p| p.as_vec3().as_dvec3())
        })
        .collect()
}

#[test]
fn the_visible_part_is_that_of_the_cpu_and_of_brute_force() {
    let perspective = Camera { near_m: 0.125, ..Camera::looking(DVec3::ZERO, DVec3::Y, 0.9) };
    let orthographic = Camera { projection: Projection::Orthographic { height_m: 7.0 }, ..perspective };
    let bench = Bench::new(boxes(&[([0; 3], [1000; 3])]));
    let list = segments(5000);
    let guard = DVec2::new(1.1, 1.2);
    for camera in [perspective, orthographic] {
        let view = View::new(camera, SIZE, &Aabb { min: DVec3::splat(-900.0), max: DVec3::splat(900.0) }).unwrap();
        let found = bench.parts(&view, &list, guard);
        let half = view.half_extent();
        let is_inside = |p: DVec3, slack: f64| {
            let w = if view.is_orthographic() { 1.0 } else { -p.z };
            -p.z - 0.125 > -slack && ((p.truncate() / half).abs() - guard * w).max_element() < slack
        };
        let mut seen = 0;
        for (&segment, found) in list.iter().zip(found) {
            let expected = edge_part(&view, segment, guard);
            let (is_seen, length) = (expected[0] < expected[1], segment[0].distance(segment[1]));
            let short = (expected[1] - expected[0]).abs() * length < 1e-4 * length.max(1.0);
            assert!(short || is_seen == (found[0] < found[1]), "{segment:?}: {expected:?} {found:?}");
            if is_seen && !short {
                seen += 1;
                let error = (0..2).map(|k| (expected[k] - found[k]).abs()).fold(0.0, f64::max);
                assert!(error < 1e-4, "{segment:?}: {expected:?} {found:?}");
            }
            for i in 0..=50 {
                let t = f64::from(i) / 50.0;
                let p = segment[0] + (segment[1] - segment[0]) * t;
                let is_kept = expected[0] <= t && t <= expected[1];
                assert!(is_kept || !is_inside(p, -1e-9), "{segment:?} at {t}");
                assert!(!is_kept || is_inside(p, 1e-9), "{segment:?} at {t}");
            }
        }
        assert!(seen > 500, "{seen}");
    }
}

#[test]
fn lines_lie_where_edges_do_also_around_the_eye() {
    let bench = Bench::new(grid_of_cubes(3, 3));
    let all: Vec<_> = bench.all.iter().map(world_ends).collect();
    // From afar, between the cubes, in one of them, with a corner behind the eye, along an edge.
    let views = [
        ("afar", at(-60.0, -40.0, 50.0), at(20.0, 20.0, 0.0), 40.0),
        ("street", at(12.5, -3.0, 1.7), at(12.0, 40.0, 3.0), 70.0),
        ("inside", at(3.0, 4.0, 5.0), at(30.0, 28.0, 6.0), 100.0),
        ("close to an edge", at(9.9, -0.2, 4.0), at(10.1, 12.0, 5.0), 90.0),
        ("along an edge", at(5.0, -0.001, 10.001), at(40.0, 0.3, 9.7), 60.0),
        ("nearly on an edge, across", at(9.99, 4.0, 10.02), at(-3.0, 5.0, 7.0), 120.0),
    ];
    for (what, eye, target, fov) in views {
        for near_m in [0.125, 0.001] {
            let mut camera = Camera::looking(eye, target, f64::to_radians(fov));
            camera.near_m = near_m;
            let view = View::new(camera, SIZE, &Aabb::EMPTY).unwrap();
            for width in [1.0, 3.0] {
                let drawn = bench.draw(&view, width, Solids::Absent);
                assert_same(what, &view, &drawn, &oracle(&view, width, &all), 0.06);
            }
        }
    }
    let camera = Camera {
        projection: Projection::Orthographic { height_m: 40.0 },
        ..looking(at(-60.0, -40.0, 50.0), at(20.0, 20.0, 0.0), 40.0).camera
    };
    let view = View::new(camera, SIZE, &bench.city.bounds).unwrap();
    assert_same("orthographic", &view, &bench.draw(&view, 2.0, Solids::Absent), &oracle(&view, 2.0, &all), 0.06);
}

/// Edges of which a face shows its front: all that is seen of a single box.
fn front_edges(bench: &Bench, view: &View) -> Vec<[DVec3; 2]> {
    let is_front = |edge: &&Edge| {
        [edge.normal_a, edge.normal_b].iter().any(|&n| {
            let to_eye = view.camera.eye - world_ends(edge)[0];
            crate::city::decode_normal(n).dot(to_eye) > 0.0
        })
    };
    bench.all.iter().filter(is_front).map(world_ends).collect()
}

#[test]
fn a_box_shows_its_nine_front_edges_whole() {
    let bench = Bench::new(boxes(&[([0; 3], [10_000, 14_000, 8_000])]));
    for (eye, fov) in [
        (at(-20.0, -25.0, 20.0), 30.0),
        (at(-200.0, -250.0, 100.0), 4.0),
        (at(-2.0, -3.0, 1.7), 80.0),
        (at(-30.0, -0.5, 8.2), 30.0),
        (at(-300.0, -1.0, 9.0), 3.0),
    ] {
        let view = looking(eye, at(5.0, 7.0, 4.0), fov);
        let visible = front_edges(&bench, &view);
        let are_three = [eye.x < 85_000.0, eye.y < 447_000.0, eye.z > 8.0] == [true; 3];
        assert_eq!(visible.len(), if are_three { 9 } else { 7 });
        let drawn = bench.draw(&view, 1.5, Solids::Hide);
        assert_same(&format!("{eye}"), &view, &drawn, &oracle(&view, 1.5, &visible), 0.06);
    }
}

#[test]
fn edges_of_the_ground_are_whole_at_a_grazing_angle() {
    // A square of 400 m, seen from a standing person's height and from a mouse's, from its middle and from outside.
    let mut b = builder();
    let points = vec![[-200_000, -200_000, 0], [200_000, -200_000, 0], [200_000, 200_000, 0], [-200_000, 200_000, 0]];
    add(&mut b, "ground", ObjectClass::Road, None, points, &[vec![0, 1, 2, 3]]);
    let bench = Bench::new(b.finish());
    let all: Vec<_> = bench.all.iter().map(world_ends).collect();
    for (eye, target) in [
        (at(3.0, 5.0, 1.7), at(80.0, 130.0, 1.0)),
        (at(0.0, -230.0, 1.7), at(10.0, 100.0, 1.5)),
        (at(0.0, -230.0, 0.3), at(40.0, 100.0, 1.5)),
        (at(-190.0, -190.0, 1.7), at(190.0, 190.0, 1.5)),
    ] {
        let view = looking(eye, target, 45.0);
        let drawn = bench.draw(&view, 1.5, Solids::Hide);
        assert_same(&format!("{eye}"), &view, &drawn, &oracle(&view, 1.5, &all), 0.06);
    }
}

#[test]
fn a_thin_wall_hides_what_stands_behind_it() {
    // 5 cm of wall, 100 m away, and houses of many edges that touch its back.
    let wall = ([-30_000, 100_000, 0], [30_000, 100_050, 12_000]);
    let houses = (0..5).map(|i| ([i * 4_000 - 9_000, 100_050, 0], [i * 4_000 - 7_000, 106_000, 3_000 + i * 1_500]));
    let list: Vec<_> = std::iter::once(wall).chain(houses).collect();
    let bench = Bench::new(boxes(&list));
    for eye in [at(0.0, 0.0, 5.0), at(70.0, 30.0, 6.0), at(-40.0, 10.0, 1.7), at(0.0, 0.0, 11.9), at(90.0, 60.0, 1.7)] {
        let view = looking(eye, at(0.0, 100.0, 6.0), 14.0);
        let drawn = bench.draw(&view, 1.5, Solids::Hide);
        let is_of_wall = |ends: &[DVec3; 2]| ends.iter().all(|p| (p.x - LATTICE.origin.x).abs() > 29.9);
        let own: Vec<_> = bench.all.iter().map(world_ends).filter(is_of_wall).collect();
        assert_eq!(own.len(), 12);
        let allowed = oracle(&view, 4.0, &own);
        let wrong = drawn.iter().zip(&allowed).filter(|(drawn, allowed)| **drawn > 0.0 && **allowed == 0.0).count();
        assert_eq!(wrong, 0, "{eye}");
        assert!(drawn.iter().any(|&c| c > 0.9), "the wall's own edges");
    }
}
