//! What the GPU makes of deformations against the same formulas in f64 (`geom::deform`), finite differences, and brute force.

use std::collections::{BTreeMap, BTreeSet};

use bytemuck::Zeroable;
use glam::{DMat3, DVec2, DVec3, IVec3};
use proptest::prelude::*;

use super::*;
use crate::{
    city::{decode_normal, encode_normal},
    geom::deform::{
        Band, Control, ControlPlane, Deformation, Frame, Operator, Profile, Space, Texels,
        refine::{order, refined},
        tests::{deformation, difference, ready, street, vector},
    },
};

/// Of places: the lattice rounds to half a cell at rest and half a cell shown, and the GPU counts in f32: some 16 roundings of ways from
/// the pivot, which steps stretch threefold at most here.
fn place_error(rest: &Rest, span: f64) -> f64 {
    4.0 * rest.lattice.cell_m() + 64.0 * f64::from(f32::EPSILON) * span
}

/// Of normals, radians: 16 bits of each axis at rest and shown, and the numbers of a Jacobian in f32.
const NORMAL_ERROR: f64 = 1.5e-3;

/// A mesh on the GPU.
struct Body {
    rest: Rest,
    places: Vec<[DVec3; 3]>,
}

/// Puts triangles on the GPU, corners in order of their places.
fn body(gpu: &Gpu, triangles: &[[DVec3; 3]], deformers: &Deformers) -> Body {
    let (mut corners, mut bits, mut places) = (Vec::new(), Vec::new(), Vec::new());
    for (i, triangle) in triangles.iter().enumerate() {
        // As the GPU has them: whole metres and the rest in f32.
        let split = |p: &DVec3| (p.floor().as_ivec3(), (*p - p.floor()).as_vec3());
        let own = triangle.each_ref().map(|p| split(p).0.as_dvec3() + split(p).1.as_dvec3());
        let normal = (own[1] - own[0]).cross(own[2] - own[0]).normalize_or(DVec3::Z);
        let mut sorted = [0, 1, 2];
        sorted.sort_by(|&i, &j| order(own[i], own[j]));
        let is_turned = matches!(sorted, [0, 2, 1] | [1, 0, 2] | [2, 1, 0]);
        bits.push(u32::from(is_turned) * TURNED);
        places.push(sorted.map(|i| own[i]));
        for k in sorted {
            let (origin, position) = split(&triangle[k]);
            corners.push(CityVertex::new(origin, i as u32, position.to_array(), encode_normal(normal)));
        }
    }
    let bounds = Aabb::from_points(places.iter().flatten().copied());
    let reach = bounds.union(deformers.deformed_bounds(&bounds));
    let firsts = vec![0, bits.len() as u32];
    let rest =
        Rest::new(gpu, RestTriangles { corners: &corners, bits: &bits, texcoords: None, firsts }, deformers, &reach)
            .expect("room");
    Body { rest, places }
}

/// A corner of what was made.
#[derive(Clone, Copy, Debug)]
struct Vertex {
    cell: IVec3,
    rest: DVec3,
    shown: DVec3,
    /// Its bits.
    whole: [u32; 6],
    normal: DVec3,
    source: u32,
}

/// What was made, read back.
struct Read {
    vertices: Vec<Vertex>,
    triangles: Vec<[u32; 3]>,
    made: Made,
}

fn words(gpu: &Gpu, buffer: &wgpu::Buffer, count: usize) -> Vec<u32> {
    let bytes = gpu.read_buffer(buffer).expect("a buffer that can be read");
    bytemuck::pod_collect_to_vec::<u8, u32>(&bytes)[..count].to_vec()
}

/// Refines with so many pixels for each metre.
fn read(gpu: &Gpu, refinery: &mut Refinery, rest: &Rest, tolerance: f32, shortest: f32) -> Read {
    let stage = layout::Refinement {
        pixels: 1.0,
        orthographic: 1,
        near: 0.1,
        forward: [0.0, 0.0, -1.0],
        tolerance,
        shortest,
        ..layout::Refinement::zeroed()
    };
    let made = refinery.refined(gpu, rest, &stage).expect("room");
    let indices = words(gpu, &made.indices, 3 * made.triangles as usize);
    let all = words(gpu, refinery.triangles[0].buffer(), 5 * made.triangles as usize);
    let bits = words(gpu, &rest.bits, rest.triangles as usize);
    let triangle = |(drawn, &[a, b, c, source, _]): (&[u32; 3], &[u32; 5])| {
        // As they are, or turned back to what their sources were.
        let own = if bits[source as usize] & 4 == 0 { [a, b, c] } else { [a, c, b] };
        // What is too narrow to be drawn is still part of the body.
        assert!([own, [a; 3]].contains(drawn), "{drawn:?} is not {own:?}");
        own
    };
    let triangles: Vec<[u32; 3]> =
        indices.as_chunks::<3>().0.iter().zip(all.as_chunks::<5>().0).map(triangle).collect();
    let count = triangles.iter().flatten().max().map_or(0, |most| *most as usize + 1);
    let corners = words(gpu, refinery.corners[0].buffer(), 8 * count);
    let vertices = words(gpu, &made.vertices, 8 * count);
    let vertex = |(corner, vertex): (&[u32; 8], &[u32; 8])| {
        let whole = |at: usize| IVec3::from([0, 1, 2].map(|i| vertex[at + i] as i32)).as_dvec3();
        let part = DVec3::from([4, 5, 6].map(|i| f64::from(f32::from_bits(vertex[i]))));
        let cell = IVec3::from([0, 1, 2].map(|i| corner[i] as i32));
        Vertex {
            cell,
            rest: rest.lattice.place(cell),
            shown: whole(0) + part,
            whole: [0, 1, 2, 4, 5, 6].map(|i| vertex[i]),
            normal: decode_normal(vertex[7]),
            source: corner[3],
        }
    };
    let pairs = corners.as_chunks::<8>().0.iter().zip(vertices.as_chunks::<8>().0);
    Read { vertices: pairs.map(vertex).collect(), triangles, made }
}

/// A ball of triangles around a place.
fn ball(center: DVec3, radius: f64, shakes: &[DVec3]) -> Vec<[DVec3; 3]> {
    let corners = [DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_X, DVec3::NEG_Y, DVec3::NEG_Z];
    let faces = [[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]];
    let half = |a: DVec3, b: DVec3| (a + b).normalize_or(DVec3::X);
    let fine = faces.iter().flat_map(|f: &[usize; 3]| {
        let [a, b, c] = f.map(|i| corners[i]);
        let [m, n, k] = [half(a, b), half(b, c), half(c, a)];
        [[a, m, k], [m, b, n], [k, n, c], [m, n, k]]
    });
    // One place, one shake.
    let shaken = |p: DVec3| {
        let number = ((p.x * 7.0 + p.y * 11.0 + p.z * 13.0) * 8.0).round().rem_euclid(shakes.len() as f64) as usize;
        center + radius * (p + 0.15 * shakes[number])
    };
    fine.map(|triangle| triangle.map(shaken)).collect()
}

/// Many small triangles all over a cube.
fn dust(center: DVec3, half: f64, count: usize) -> Vec<[DVec3; 3]> {
    let spread = |n: usize, base: f64| (n as f64 * base).fract() * 2.0 - 1.0;
    (0..count)
        .map(|n| {
            let at =
                center + half * DVec3::new(spread(n, 0.754_877_67), spread(n, 0.569_840_29), spread(n, 0.430_159_71));
            let along = DVec3::new(spread(n, 0.137), spread(n, 0.713), spread(n, 0.391)).normalize_or(DVec3::X);
            [at, at + 0.3 * along, at + 0.3 * along.any_orthogonal_vector()]
        })
        .collect()
}

/// Compares all that was placed with f64; how many normals had differences to compare with.
fn compare(read: &Read, body: &Body, deformers: &Deformers) -> usize {
    let bounds = Aabb::from_points(body.places.iter().flatten().copied());
    let pivots = deformers.0.iter().map(|d| d.support().frame.pivot);
    let span = pivots.fold(bounds, Aabb::grown).size().length();
    let error = place_error(&body.rest, span);
    let mut compared = 0;
    for vertex in &read.vertices {
        let truth = deformers.value(vertex.rest);
        assert!(vertex.shown.distance(truth) <= error, "{vertex:?} {truth} {error}");
        let corners = &body.places[vertex.source as usize];
        let is_turned = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let Some(jacobian) = difference(|p| deformers.value(p), vertex.rest) else { continue };
        let normal = (jacobian.inverse().transpose() * is_turned).try_normalize();
        let Some(normal) = normal.filter(|_| jacobian.determinant() > 0.05) else { continue };
        // Triangles are turned either way.
        let angle = normal.cross(vertex.normal).length();
        // What is crushed or stretched magnifies the error of the normal at rest.
        let stretch = condition(&jacobian);
        assert!(angle <= NORMAL_ERROR * stretch, "{vertex:?} {normal} {angle} {stretch}");
        compared += 1;
    }
    compared
}

/// The largest stretch over the smallest, at most.
fn condition(jacobian: &DMat3) -> f64 {
    let size = |m: &DMat3| m.to_cols_array().iter().map(|x| x * x).sum::<f64>().sqrt();
    (size(jacobian) * size(&jacobian.inverse())).max(1.0)
}

fn plane(profile: Profile, band: Option<Band>) -> Control {
    let size = DVec2::new(50.0, 40.0);
    Control::Plane(ControlPlane { corner: -0.5 * size.extend(0.0), size, profile, band })
}

/// Each step with everything, each control with a step, and a chain.
fn samples() -> Vec<(String, Deformation)> {
    let z = [-10.0, 12.0];
    let steps = [
        Operator::Translate(DVec3::new(3.0, -4.0, 5.0)),
        Operator::Scale { factors: DVec3::new(0.6, 1.3, 2.0), about: DVec3::new(1.0, 2.0, -3.0) },
        Operator::Shear { slope: DVec2::new(0.7, -0.3), base: -2.0 },
        Operator::Taper { z, factors: [1.0, 0.4] },
        Operator::Twist { z, angles: [-1.0, 2.5] },
        Operator::Bend { curvature: 0.03, y: [-14.0, 12.0], about: -3.0, base: 1.0 },
        Operator::Open(street()),
    ];
    let texels = Texels::new(5, 4, (0..20).map(|i| (i * 7 % 20) as f32 / 19.0).collect()).expect("in 0..=1");
    let band = Some(Band { low: -9.0, high: 12.0, fade: 5.0 });
    let controls = [
        plane(Profile::Linear { border: 0.3 }, None),
        plane(Profile::Smooth { border: 0.4 }, band),
        plane(Profile::Bump, None),
        plane(Profile::Ring { inner: 0.2, outer: 0.9 }, None),
        plane(Profile::Texels(texels), band),
    ];
    let frame = Frame::new(DVec3::new(85_000.5, 447_000.25, 12.0), DVec3::new(0.8, 0.5, 0.1), DVec3::Y);
    let made = |chain: Vec<Operator>, control: Control| Deformation {
        frame: frame.expect("a frame"),
        space: Space::World,
        chain,
        control,
    };
    let mut all: Vec<(String, Deformation)> = Vec::new();
    for step in &steps {
        all.push((format!("{step:?}"), made(vec![step.clone()], Control::Everywhere)));
    }
    for control in controls {
        let chain = vec![Operator::Translate(DVec3::new(1.0, 2.0, 6.0)), steps[4].at_strength(0.2)];
        all.push((format!("{control:?}"), made(chain, control)));
    }
    all.push(("a chain".to_owned(), made(steps.iter().map(|s| s.at_strength(0.4)).collect(), Control::Everywhere)));
    all
}

#[test]
fn each_step_and_each_control_is_that_of_the_host() {
    let gpu = Gpu::open().expect("an adapter");
    for (name, deformation) in samples() {
        let center = deformation.frame.pivot;
        let deformers = Deformers(vec![ready(deformation)]);
        let body = body(&gpu, &dust(center, 28.0, 3000), &deformers);
        let mut refinery = Refinery::new(&gpu).expect("room");
        // Nothing is halved.
        let read = read(&gpu, &mut refinery, &body.rest, 1e9, 1.0);
        assert_eq!((read.triangles.len(), read.vertices.len()), (3000, 9000), "{name}");
        let compared = compare(&read, &body, &deformers);
        assert!(compared > 6000, "{name}: {compared}");
    }
}

#[test]
fn what_no_support_reaches_is_not_halved_nor_moved() {
    let gpu = Gpu::open().expect("an adapter");
    let at = DVec3::new(85_000.0, 447_000.0, 0.0);
    let size = DVec2::splat(20.0);
    let control = ControlPlane { corner: -0.5 * size.extend(0.0), size, profile: Profile::Bump, band: None };
    let deformers = Deformers(vec![ready(Deformation {
        frame: Frame { pivot: at, ..Frame::WORLD },
        space: Space::World,
        chain: vec![Operator::Translate(DVec3::Z * 9.0)],
        control: Control::Plane(control),
    })]);
    // A large triangle that the lens is in, and one beside it that ends a millimetre before.
    let level = |x: f64, y: f64| at + DVec3::new(x, y, 0.125);
    let triangles = [
        [level(-900.0, -800.0), level(1000.0, -900.0), level(0.0, 1000.0)],
        [level(10.001, -800.0), level(1000.0, -900.0), level(10.001, 900.0)],
    ];
    let body = body(&gpu, &triangles, &deformers);
    let mut refinery = Refinery::new(&gpu).expect("room");
    let read = read(&gpu, &mut refinery, &body.rest, 0.05, 0.01);
    let of = |source: u32| read.triangles.iter().filter(|t| read.vertices[t[0] as usize].source == source).count();
    assert_eq!(of(1), 1);
    assert!((100..40_000).contains(&of(0)), "{}", of(0));
    let highest = read.vertices.iter().map(|v| v.shown.z).fold(0.0, f64::max);
    assert!((highest - 9.125).abs() < 0.1, "the lens is found: {highest}");
    for vertex in &read.vertices {
        let is_inside = (vertex.rest - at).truncate().length() < 10.0;
        assert!(is_inside || vertex.shown.distance(vertex.rest) <= body.rest.lattice.cell_m(), "{vertex:?}");
    }
}

/// Each directed edge once, and once the other way.
fn is_closed(read: &Read) -> bool {
    let mut edges: BTreeMap<([i32; 3], [i32; 3]), u32> = BTreeMap::new();
    for t in &read.triangles {
        let cells = t.map(|i| read.vertices[i as usize].cell.to_array());
        for i in 0..3 {
            *edges.entry((cells[i], cells[(i + 1) % 3])).or_default() += 1;
        }
    }
    edges.iter().all(|((a, b), count)| *count == 1 && edges.get(&(*b, *a)) == Some(&1))
}

fn cells(read: &Read) -> BTreeSet<[[i32; 3]; 3]> {
    let sorted = |t: &[u32; 3]| {
        let mut cells = t.map(|i| read.vertices[i as usize].cell.to_array());
        cells.sort_unstable();
        cells
    };
    read.triangles.iter().map(sorted).collect()
}

/// The farthest that the deformed edge is from what is drawn for it, by brute force.
fn chord(deformers: &Deformers, [a, b]: [DVec3; 2]) -> f64 {
    let (start, end) = (deformers.value(a), deformers.value(b));
    let off = |i: u32| {
        let t = f64::from(i) / 64.0;
        deformers.value(a.lerp(b, t)).distance(start.lerp(end, t))
    };
    (0..=64).map(off).fold(0.0, f64::max)
}

proptest! {
    #![proptest_config(crate::seeds::cases(12))]
    #[test]
    fn bodies_are_refined_as_the_host_does(
        deformation in deformation(5e4), shift in vector(10.0), shakes in prop::collection::vec(vector(1.0), 18),
        fineness in 0.0..1.5f64, turn in any::<usize>(),
    ) {
        let gpu = Gpu::open().expect("an adapter");
        let center = deformation.frame.pivot + shift;
        let triangles = ball(center, 15.0, &shakes);
        let deformers = Deformers(vec![ready(deformation.at_strength(0.5))]);
        let tolerance = 0.5 * 10.0_f64.powf(-fineness);
        let body = body(&gpu, &triangles, &deformers);
        let mut refinery = Refinery::new(&gpu).expect("room");
        let first = read(&gpu, &mut refinery, &body.rest, tolerance as f32, 0.01);
        prop_assume!(first.made.report.too_coarse == 0 && f64::from(first.made.report.tolerance_px as f32) < 1.01 * tolerance);
        compare(&first, &body, &deformers);
        // No seam opens: closed stays closed, and one place at rest is shown at one place, to the bit.
        prop_assert!(is_closed(&first));
        let mut shown: BTreeMap<[i32; 3], [u32; 6]> = BTreeMap::new();
        for vertex in &first.vertices {
            prop_assert_eq!(*shown.entry(vertex.cell.to_array()).or_insert(vertex.whole), vertex.whole);
        }
        // Edges are as near as asked for; the lattice rounds.
        let room = 1.05 * tolerance + place_error(&body.rest, 50.0);
        for t in &first.triangles {
            let rest = t.map(|i| first.vertices[i as usize].rest);
            for i in 0..3 {
                let off = chord(&deformers, [rest[i], rest[(i + 1) % 3]]);
                prop_assert!(off <= room, "{} {}", off, tolerance);
            }
        }
        // In boxes that hold all of it.
        let (range, bounds) = &first.made.chunks[0];
        prop_assert_eq!(range.clone(), 0..first.made.triangles);
        prop_assert!(first.vertices.iter().all(|v| v.shown.cmpge(bounds.min).all() && v.shown.cmple(bounds.max).all()));
        // About as many as the host makes.
        let positions: Vec<DVec3> = body.places.iter().flatten().copied().collect();
        let indices: Vec<[u32; 3]> = (0..body.places.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let even = |_: DVec3| 1.0;
        let host = refined(&positions, &indices, &deformers, &even, tolerance, Limits::default());
        let [own, truth] = [first.triangles.len(), host.triangles.len() + host.kept.len()].map(|n| n as f64);
        prop_assert!((own - truth).abs() <= 0.03 * truth + 8.0, "{} {}", own, truth);
        // The same again, and whatever the order of triangles and corners.
        let again = read(&gpu, &mut refinery, &body.rest, tolerance as f32, 0.01);
        prop_assert_eq!(&again.triangles, &first.triangles);
        let mut other = triangles.clone();
        other.rotate_left(turn % triangles.len());
        other.iter_mut().enumerate().for_each(|(i, t)| t.rotate_left((turn + i) % 3));
        let other = super::tests::body(&gpu, &other, &deformers);
        let other = read(&gpu, &mut refinery, &other.rest, tolerance as f32, 0.01);
        prop_assert_eq!(cells(&other), cells(&first));
    }
}

#[test]
fn too_many_are_said_and_not_cut_off() {
    let gpu = Gpu::open().expect("an adapter");
    let (_, deformation) = samples().remove(4);
    let center = deformation.frame.pivot;
    let deformers = Deformers(vec![ready(deformation)]);
    let body = body(&gpu, &ball(center, 15.0, &[DVec3::ZERO]), &deformers);
    let mut refinery = Refinery::new(&gpu).expect("room");
    let coarse = read(&gpu, &mut refinery, &body.rest, 0.05, 4.0);
    assert!(coarse.made.report.too_coarse > 0);
    assert!(is_closed(&coarse));
}
