use glam::{DMat3, DVec2, DVec3, Vec3Swizzles};
use proptest::prelude::*;

use super::*;
use crate::geom::shape::solid::form::Bitmap;

fn mesh(faces: &[[[i64; 3]; 3]]) -> Mesh {
    let points = faces.iter().flatten().map(|p| DVec3::new(p[0] as f64, p[1] as f64, p[2] as f64)).collect();
    Mesh { points, triangles: (0..faces.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect() }
}

/// The winding number by crossings of a line towards +x, in whole numbers; `None` where it meets an edge or a corner.
fn oracle(faces: &[[[i64; 3]; 3]], p: [i64; 3]) -> Option<i64> {
    let mut winding = 0;
    for face in faces {
        let flat = |i: usize| [i128::from(face[i][1] - p[1]), i128::from(face[i][2] - p[2])];
        let side = |i: usize, j: usize| flat(i)[0] * flat(j)[1] - flat(i)[1] * flat(j)[0];
        let sides = [side(0, 1), side(1, 2), side(2, 0)];
        if sides.contains(&0) {
            // On the line through an edge: a miss only where the others disagree.
            if sides.iter().any(|s| *s > 0) && sides.iter().any(|s| *s < 0) {
                continue;
            }
            return None;
        }
        let sense = sides[0].signum();
        if sides.iter().any(|s| s.signum() != sense) {
            continue;
        }
        let r = |i: usize, k: usize| i128::from(face[i][k] - p[k]);
        let minor = |a: usize, b: usize, c: usize| {
            r(a, 0) * (r(b, 1) * r(c, 2) - r(b, 2) * r(c, 1)) - r(a, 1) * (r(b, 0) * r(c, 2) - r(b, 2) * r(c, 0))
                + r(a, 2) * (r(b, 0) * r(c, 1) - r(b, 1) * r(c, 0))
        };
        // The volume of the tetrahedron from the place tells on which side of the face it is.
        let volume = minor(0, 1, 2);
        if volume == 0 {
            return None;
        }
        let is_ahead = volume.signum() == sense;
        if is_ahead {
            winding += i64::try_from(sense).unwrap_or(0);
        }
    }
    Some(winding)
}

fn triangles(quads: &[[[i64; 3]; 4]]) -> Vec<[[i64; 3]; 3]> {
    quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect()
}

/// A torus of quads, its corners rounded to whole numbers.
fn torus(around: i64, across: i64, radii: [f64; 2]) -> Vec<[[i64; 3]; 3]> {
    let at = |i: i64, j: i64| {
        let [a, b] = [(i, around), (j, across)].map(|(k, n)| std::f64::consts::TAU * (k % n) as f64 / n as f64);
        let r = radii[0] + radii[1] * b.cos();
        [r * a.cos(), r * a.sin(), radii[1] * b.sin()].map(|v| v.round() as i64)
    };
    let cells = (0..around).flat_map(|i| (0..across).map(move |j| (i, j)));
    let quads = cells.map(|(i, j)| [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
    triangles(&quads.collect::<Vec<_>>())
}

/// What stands over a polygon in plan, as quads and a fan that may overlap itself: its winding numbers are the polygon's.
fn standing(ring: &[[i64; 2]], [low, high]: [i64; 2]) -> Vec<[[i64; 3]; 3]> {
    let at = |i: usize, z: i64| [ring[i % ring.len()][0], ring[i % ring.len()][1], z];
    let mut faces = Vec::new();
    for i in 0..ring.len() {
        faces.extend(triangles(&[[at(i, low), at(i + 1, low), at(i + 1, high), at(i, high)]]));
        faces.push([at(0, high), at(i, high), at(i + 1, high)]);
        faces.push([at(0, low), at(i + 1, low), at(i, low)]);
    }
    faces.retain(|[a, b, c]| a != b && b != c && c != a);
    faces
}

/// A star of this many points that touches itself where its arms are `deep`.
fn star(points: usize, deep: f64) -> Vec<[i64; 2]> {
    (0..2 * points)
        .map(|i| {
            let angle = std::f64::consts::PI * i as f64 / points as f64;
            let r = if i % 2 == 0 { 1000.0 } else { deep };
            [(r * angle.cos()).round() as i64, (r * angle.sin()).round() as i64]
        })
        .collect()
}

fn shapes() -> Vec<(&'static str, Vec<[[i64; 3]; 3]>)> {
    // Its arms meet in the middle: one point, nine times.
    let arm = |i: usize| {
        let at = |turn: f64, r: f64| {
            let angle = std::f64::consts::TAU * (i as f64 + turn) / 9.0;
            [(r * angle.cos()).round() as i64, (r * angle.sin()).round() as i64]
        };
        [[0, 0], at(-0.2, 600.0), at(0.0, 1000.0), at(0.2, 600.0)]
    };
    let touching: Vec<[i64; 2]> = (0..9).flat_map(arm).collect();
    let comb: Vec<[i64; 2]> = (0..20)
        .flat_map(|i| [[100 * i, 0], [100 * i, 900], [100 * i + 50, 900], [100 * i + 50, 60]])
        .chain([[2000, 60], [2000, 0]])
        .collect();
    let mut crossing = torus(24, 12, [700.0, 250.0]);
    crossing.extend(torus(24, 12, [700.0, 250.0]).into_iter().map(|f| f.map(|[x, y, z]| [x + 300, z + 40, -y])));
    vec![
        ("torus", torus(32, 16, [800.0, 300.0])),
        ("star", standing(&star(7, 300.0), [-200, 300])),
        ("star that touches itself", standing(&touching, [-200, 300])),
        ("comb of 40 walls", standing(&comb, [0, 500])),
        ("two tori that cross", crossing),
    ]
}

#[test]
fn concave_and_self_touching_solids_hold_what_whole_numbers_say() {
    for (name, faces) in shapes() {
        let solid = Solid::of_faces(
            faces.iter().map(|f| f.map(|p| DVec3::new(p[0] as f64, p[1] as f64, p[2] as f64))).collect(),
            0,
        )
        .unwrap();
        let (mut inside, mut asked) = (0, 0);
        for i in 0..20_000_i64 {
            let p = [(i * 7919) % 2600 - 1200, (i * 104_729) % 2600 - 1200, (i * 1299) % 1200 - 600];
            let Some(expected) = oracle(&faces, p) else { continue };
            let found = solid.winding(DVec3::new(p[0] as f64, p[1] as f64, p[2] as f64));
            assert_eq!(i64::from(found), expected, "{name} at {p:?}");
            inside += u32::from(expected != 0);
            asked += 1;
        }
        assert!(asked > 10_000 && inside > 300, "{name}: {inside} of {asked}");
    }
}

#[test]
fn entries_and_exits_of_any_ray_balance_and_say_where_it_is_inside() {
    for (name, faces) in shapes() {
        let solid = Solid::of_faces(
            faces.iter().map(|f| f.map(|p| DVec3::new(p[0] as f64, p[1] as f64, p[2] as f64))).collect(),
            0,
        )
        .unwrap();
        for i in 0..400 {
            let [a, b] = [f64::from(i) * 0.618, f64::from(i) * 0.311];
            let origin = DVec3::new(1500.0 * a.cos(), 1500.0 * a.sin(), 500.0 * b.sin());
            // At corners too: of every third ray the aim is one.
            let aim =
                if i % 3 == 0 { faces[i as usize % faces.len()][0].map(|v| v as f64).into() } else { DVec3::ZERO };
            let ray = Ray { origin, direction: aim - origin };
            let mut crossings = solid.crossings(&ray);
            assert_eq!(crossings.iter().map(|c| c.step).sum::<i32>(), 0, "{name}, ray {i}");
            crossings.sort_by(|a, b| a.t.total_cmp(&b.t));
            let mut winding = 0;
            for pair in crossings.windows(2) {
                winding += pair[0].step;
                if pair[1].t - pair[0].t < 1e-6 {
                    continue;
                }
                let middle = ray.at(pair[0].t.midpoint(pair[1].t));
                if solid.distance(middle) > 1e-6 {
                    assert_eq!(solid.winding(middle), winding, "{name}, ray {i} at {middle}");
                }
            }
        }
    }
}

#[test]
fn a_comb_is_entered_and_left_twenty_times() {
    let (_, faces) = &shapes()[3];
    let solid = Solid::new(&[mesh(faces)], DVec3::ZERO).unwrap();
    let ray = Ray { origin: DVec3::new(-50.0, 400.0, 100.0), direction: DVec3::X };
    assert_eq!(solid.crossings(&ray).len(), 40);
}

#[test]
fn small_faults_are_mended() {
    let faces = torus(24, 12, [800.0, 300.0]);
    let whole = Solid::new(&[mesh(&faces)], DVec3::ZERO).unwrap();
    assert_eq!(whole.mended, 0);
    let places =
        || (0..3000_i64).map(|i| [(i * 7919) % 2300 - 1150, (i * 104_729) % 2300 - 1150, (i * 1299) % 700 - 350]);
    let volume = |solid: &Solid| places().filter(|p| solid.winding(DVec3::from(p.map(|v| v as f64))) != 0).count();
    // Faces turned round.
    let mut turned = faces.clone();
    for i in [3, 77, 200, 201, 333] {
        turned[i].swap(0, 1);
    }
    // All of them, as of a file that means it the other way.
    let inside_out: Vec<_> = faces.iter().map(|f| [f[0], f[2], f[1]]).collect();
    for (name, faults) in [("turned", turned), ("inside out", inside_out)] {
        let solid = Solid::new(&[mesh(&faults)], DVec3::ZERO).unwrap();
        assert_eq!(solid.mended, 0, "{name}");
        for p in places() {
            let p = DVec3::from(p.map(|v| v as f64));
            assert_eq!(solid.winding(p), whole.winding(p), "{name} at {p}");
        }
    }
    // Some are gone.
    let mut holes = faces.clone();
    for i in [400, 301, 300, 120, 7] {
        holes.remove(i);
    }
    let solid = Solid::new(&[mesh(&holes)], DVec3::ZERO).unwrap();
    // Two of them had an edge in common.
    assert_eq!(solid.mended, 13);
    let differ = places()
        .map(|p| DVec3::from(p.map(|v| v as f64)))
        .filter(|p| (solid.winding(*p) != 0) != (whole.winding(*p) != 0))
        .count();
    assert!(differ < 30 && volume(&solid) > 500, "{differ} of 3000 places");
}

#[test]
fn loose_faces_enclose_nothing_however_many() {
    // Not one has a neighbour: each is a hole of its own. Whoever looks for the next hole among all takes hours.
    let face = |i: i64| {
        let [x, y] = [10 * (i % 500), 10 * (i / 500)];
        [[x, y, i % 7], [x + 5, y, i % 5], [x, y + 5, i % 3]]
    };
    let loose: Vec<_> = (0..200_000).map(face).collect();
    assert_eq!(Solid::new(&[mesh(&loose)], DVec3::ZERO), Err(ShapeError::NoBody));
}

#[test]
fn a_cavity_stays_one() {
    let cube = |side: i64| {
        let s = side;
        triangles(&[
            [[-s, -s, -s], [-s, s, -s], [s, s, -s], [s, -s, -s]],
            [[-s, -s, s], [s, -s, s], [s, s, s], [-s, s, s]],
            [[-s, -s, -s], [s, -s, -s], [s, -s, s], [-s, -s, s]],
            [[s, -s, -s], [s, s, -s], [s, s, s], [s, -s, s]],
            [[s, s, -s], [-s, s, -s], [-s, s, s], [s, s, s]],
            [[-s, s, -s], [-s, -s, -s], [-s, -s, s], [-s, s, s]],
        ])
    };
    let mut hollow = cube(10);
    hollow.extend(cube(4).into_iter().map(|[a, b, c]| [a, c, b]));
    for all_turned in [false, true] {
        let faces: Vec<_> = hollow.iter().map(|&[a, b, c]| if all_turned { [a, c, b] } else { [a, b, c] }).collect();
        let solid = Solid::new(&[mesh(&faces)], DVec3::ZERO).unwrap();
        assert_eq!(solid.winding(DVec3::new(0.1, 0.2, 0.3)), 0);
        assert_eq!(solid.winding(DVec3::new(7.1, 0.2, 0.3)), 1);
        assert_eq!(solid.winding(DVec3::new(11.1, 0.2, 0.3)), 0);
    }
    // One cube in another, both looking outwards, is filled.
    let mut filled = cube(10);
    filled.extend(cube(4));
    let solid = Solid::new(&[mesh(&filled)], DVec3::ZERO).unwrap();
    assert_eq!(solid.winding(DVec3::new(0.1, 0.2, 0.3)), 2);
    assert_eq!(Solid::new(&[], DVec3::ZERO), Err(ShapeError::NoBody));
    let flat = mesh(&[[[0, 0, 0], [5, 0, 0], [0, 5, 0]]]);
    assert_eq!(Solid::new(&[flat], DVec3::ZERO), Err(ShapeError::NoBody));
}

#[test]
fn faces_that_look_up_or_down_belong_to_the_body() {
    let ring = [[0.0, 0.0], [10.0, 0.0], [10.0, 8.0], [4.0, 8.0], [4.0, 3.0], [0.0, 3.0]].map(DVec2::from).to_vec();
    let solid = prism(std::slice::from_ref(&ring), 2.0, 5.0, DVec3::ZERO).unwrap();
    for (z, expected) in [(1.999, 0), (2.0, 1), (4.0, 1), (7.0, 1), (7.001, 0)] {
        assert_eq!(solid.winding(DVec3::new(6.0, 5.0, z)), expected, "{z}");
        assert_eq!(solid.winding(DVec3::new(2.0, 5.0, z)), 0, "{z}");
    }
    // Either way round is the same polygon.
    let back: Vec<DVec2> = ring.into_iter().rev().collect();
    assert_eq!(prism(&[back], 2.0, 5.0, DVec3::ZERO).unwrap().winding(DVec3::new(6.0, 5.0, 4.0)), 1);
}

/// A polygon of a district, in whole centimetres, by the crossings of a line.
fn holds(ring: &[[i64; 2]], p: [i64; 2]) -> bool {
    let crosses = |a: [i64; 2], b: [i64; 2]| {
        let (low, high) = if a[1] < b[1] { (a, b) } else { (b, a) };
        let side = i128::from(high[0] - low[0]) * i128::from(p[1] - low[1])
            - i128::from(high[1] - low[1]) * i128::from(p[0] - low[0]);
        low[1] <= p[1] && p[1] < high[1] && side > 0
    };
    (0..ring.len()).filter(|&i| crosses(ring[i], ring[(i + 1) % ring.len()])).count() % 2 == 1
}

#[test]
fn a_district_far_from_the_origin_is_exact_to_its_rounding() {
    // An irregular ring of 400 corners around a place in national coordinates.
    let centre = [78_612_345_i64, 457_912_377];
    let ring: Vec<[i64; 2]> = (0..400)
        .map(|i| {
            let angle = std::f64::consts::TAU * f64::from(i) / 400.0;
            let r = 60_000.0 + 25_000.0 * (9.0 * angle).sin() + 900.0 * f64::from(i * 7919 % 17);
            [centre[0] + (r * angle.cos()) as i64, centre[1] + (r * angle.sin()) as i64]
        })
        .collect();
    let metres = |p: [i64; 2]| DVec2::new(p[0] as f64, p[1] as f64) / 100.0;
    let origin = metres(centre).round().extend(0.0);
    let solid = prism(&[ring.iter().map(|p| metres(*p)).collect()], 0.0, 50.0, origin).unwrap();
    // 2^-24 of the extent of 1,000 m, in each direction.
    let step = 2_f64.powi(-13);
    let (mut asked, mut inside) = (0, 0);
    for i in 0..40_000_i64 {
        let p = [centre[0] + i * 7919 % 200_000 - 100_000, centre[1] + i * 104_729 % 200_000 - 100_000];
        let local = metres(p).extend(25.0) - origin;
        if solid.distance(local) < 2.0 * step {
            continue;
        }
        assert_eq!(solid.winding(local) != 0, holds(&ring, p), "{p:?}");
        (asked, inside) = (asked + 1, inside + u32::from(holds(&ring, p)));
    }
    assert!(asked > 39_000 && inside > 8_000, "{inside} of {asked}");
}

#[test]
fn wrong_polygons_are_refused_in_words() {
    let ring = |points: &[[f64; 2]]| points.iter().map(|p| DVec2::from(*p)).collect::<Vec<_>>();
    for (rings, words) in [
        (vec![ring(&[[0.0, 0.0], [9.0, 0.0]])], "at least 3 points"),
        (vec![ring(&[[0.0, 0.0], [4.0, 0.0], [9.0, 0.0]])], "no area"),
        (vec![ring(&[[0.0, 0.0], [9.0, 9.0], [9.0, 0.0], [0.0, 9.0]])], "crosses itself"),
        (
            vec![
                ring(&[[0.0, 0.0], [9.0, 0.0], [9.0, 9.0], [0.0, 9.0]]),
                ring(&[[20.0, 20.0], [22.0, 20.0], [22.0, 22.0]]),
            ],
            "hole",
        ),
    ] {
        let error = prism(&rings, 0.0, 5.0, DVec3::ZERO).expect_err(words).to_string();
        assert!(error.contains(words), "{error}");
    }
}

proptest! {
    #![proptest_config(crate::seeds::config())]

    #[test]
    fn a_mask_holds_its_cells(bits in prop::collection::vec(any::<bool>(), 3 * 7 * 5), turn in 0..3_usize) {
        let layers: Vec<Bitmap> = bits.chunks(35).map(|b| Bitmap { size: [7, 5], bits: b.to_vec() }).collect();
        prop_assume!(bits.iter().any(|b| *b));
        let (corner, size) = (DVec3::new(-3.0, 10.0, 1.0), DVec3::new(14.0, 20.0, 6.0));
        let origin = [DVec3::ZERO, DVec3::new(2.0, 20.0, 4.0), DVec3::new(0.3, 0.7, 0.1)][turn];
        let solid = stacked(&layers, [corner, size], origin).unwrap();
        for (k, layer) in layers.iter().enumerate() {
            for y in 0..5 {
                for x in 0..7 {
                    let cell = DVec3::new(f64::from(x), f64::from(4 - y), k as f64);
                    let middle = corner + (cell + DVec3::new(0.4, 0.6, 0.5)) * DVec3::new(2.0, 4.0, 2.0);
                    let is_in = layer.bits[(y * 7 + x) as usize];
                    prop_assert_eq!(solid.winding(middle - origin) != 0, is_in, "{} {} {}", x, y, k);
                }
            }
        }
        prop_assert_eq!(solid.winding(corner - origin - 1.0), 0);
        prop_assert_eq!(solid.winding(corner + size - origin + 1.0), 0);
    }

    #[test]
    fn triangles_that_meet_a_solid_are_those_whose_places_do(
        p in prop::array::uniform3(-1100.0..1100.0f64), q in prop::array::uniform3(-1100.0..1100.0f64),
        r in prop::array::uniform3(-500.0..500.0f64),
    ) {
        let solid = Solid::new(&[mesh(&torus(20, 10, [700.0, 200.0]))], DVec3::ZERO).unwrap();
        let corners = [DVec3::from(p), DVec3::from(q), DVec3::from(r)];
        // Places of the triangle, close together.
        let places = (0..=60).flat_map(|i| (0..=60 - i).map(move |j| (f64::from(i) / 60.0, f64::from(j) / 60.0)));
        let of = |(u, v): (f64, f64)| corners[0] + u * (corners[1] - corners[0]) + v * (corners[2] - corners[0]);
        let by_places = places.map(of).any(|p| solid.winding(p) != 0);
        let found = solid.meets_triangle(&corners);
        // A triangle may touch it between the places.
        prop_assert!(found || !by_places, "{:?}", corners);
        if found && !by_places {
            let near = (0..=60).flat_map(|i| (0..=60 - i).map(move |j| (f64::from(i) / 60.0, f64::from(j) / 60.0))).map(of)
                .map(|p| solid.distance(p)).fold(f64::INFINITY, f64::min);
            prop_assert!(near < 60.0, "{:?} is {} away", corners, near);
        }
    }

    #[test]
    fn a_solid_turned_and_moved_is_the_same(angles in prop::array::uniform3(-3.0..3.0f64), p in prop::array::uniform3(-1200.0..1200.0f64)) {
        let solid = Arc::new(Solid::new(&[mesh(&torus(20, 10, [700.0, 200.0]))], DVec3::ZERO).unwrap());
        let rotation = glam::DQuat::from_euler(glam::EulerRot::XYZ, angles[0], angles[1], angles[2]);
        let at = DVec3::new(4e5, -3e5, 120.0);
        let placed = PlacedSolid { solid: solid.clone(), rotation, at };
        let p = DVec3::from(p);
        let volume = crate::geom::shape::Volume::Solid(placed.clone());
        prop_assume!(solid.distance(p) > 1e-3);
        prop_assert_eq!(volume.contains(placed.world(p)), solid.winding(p) != 0);
        prop_assert!((volume.signed_distance(placed.world(p)).abs() - solid.distance(p)).abs() < 1e-6);
        let bounds = volume.bounds();
        let turned = DMat3::from_quat(rotation);
        for corner in solid.faces().iter().flatten() {
            let q = at + turned * *corner;
            prop_assert!(q.cmpge(bounds.min - 1e-6).all() && q.cmple(bounds.max + 1e-6).all());
        }
    }

    #[test]
    fn the_words_tell_the_nearest_face_within_a_reach(p in prop::array::uniform3(-1300.0..1300.0f64), reach in 1.0..400.0f64) {
        let solid = Solid::new(&[mesh(&torus(20, 10, [700.0, 200.0]))], DVec3::ZERO).unwrap();
        let p = DVec3::from(p).with_z(p[2] * 0.5);
        let (found, asked) = Words(solid.words()).distance(p, reach);
        let wanted = solid.distance(p);
        if wanted < reach {
            prop_assert!((found - wanted).abs() < 1e-3, "{} for {}", found, wanted);
        } else {
            prop_assert!(found >= reach && found <= wanted + 1e-3, "{} for {}, no less than {}", found, wanted, reach);
        }
        prop_assert!(asked <= solid.faces().len() / 4, "{} of {} faces are asked", asked, solid.faces().len());
    }

    #[test]
    fn the_words_tell_all_faces_that_a_line_meets(p in prop::array::uniform3(-1300.0..1300.0f64), d in prop::array::uniform3(-1.0..1.0f64)) {
        let solid = Solid::new(&[mesh(&torus(20, 10, [700.0, 200.0]))], DVec3::ZERO).unwrap();
        let ray = Ray { origin: DVec3::from(p), direction: DVec3::from(d) };
        let mut wanted: Vec<f64> = solid.crossings(&ray).iter().map(|c| c.t).collect();
        let faces = Words(solid.words()).faces_met(&ray);
        prop_assert!(faces.len() <= solid.faces().len() / 4, "{} of {} faces are asked", faces.len(), solid.faces().len());
        let bounds = solid.bounds();
        let some = Solid { columns: Columns::new(&faces, &bounds), bounds, faces, mended: 0 };
        let mut found: Vec<f64> = some.crossings(&ray).iter().map(|c| c.t).collect();
        wanted.sort_by(f64::total_cmp);
        found.sort_by(f64::total_cmp);
        prop_assert_eq!(found.len(), wanted.len());
        prop_assert!(found.iter().zip(&wanted).all(|(a, b)| (a - b).abs() < 1e-9 * b.abs().max(1.0)), "{:?} for {:?}", found, wanted);
    }
}

/// The words of a solid, read as `shape/solid.wgsl` and `lib/solid-distance.wgsl` read them.
struct Words(Vec<[u32; 4]>);

impl Words {
    fn vec(&self, at: usize) -> DVec3 {
        let [x, y, z, _] = self.0[at].map(f32::from_bits);
        DVec3::new(x.into(), y.into(), z.into())
    }

    /// The faces of all leaves that are entered: of each, whether it is at the border.
    fn walk(&self, mut enters: impl FnMut(&Aabb) -> bool, mut visit: impl FnMut([DVec3; 3], bool)) {
        let [nodes, count, faces, _] = self.0[2].map(|w| w as usize);
        let mut at = 0;
        while at < count {
            let bounds = Aabb { min: self.vec(nodes + 2 * at), max: self.vec(nodes + 2 * at + 1) };
            let (next, listed) = (self.0[nodes + 2 * at][3], self.0[nodes + 2 * at + 1][3]);
            let is_entered = enters(&bounds);
            if is_entered {
                for face in listed >> 3..(listed >> 3) + (listed & 7) {
                    let face = faces + 4 * face as usize;
                    visit([0, 1, 2].map(|i| self.vec(face + i)), self.0[face + 1][3] == 1);
                }
            }
            at = if is_entered && listed & 7 == 0 { at + 1 } else { next as usize };
        }
    }

    /// How far the surface is, no less than `reach` where it is farther; and how many faces were asked.
    fn distance(&self, p: DVec3, reach: f64) -> (f64, usize) {
        let (least, beyond) = (std::cell::Cell::new(reach), std::cell::Cell::new(f64::INFINITY));
        let mut asked = 0;
        let enters = |bounds: &Aabb| {
            let free = bounds.distance_to(p);
            if free >= least.get() {
                beyond.set(beyond.get().min(free));
            }
            free < least.get()
        };
        self.walk(enters, |[a, b, c], is_border| {
            asked += 1;
            if is_border {
                let distance = nearest_to_origin(a - p, b - p, c - p).length();
                least.set(least.get().min(distance));
                beyond.set(beyond.get().min(distance));
            }
        });
        (if least.get() < reach { least.get() } else { beyond.get() }, asked)
    }

    fn faces_met(&self, ray: &Ray) -> Vec<[DVec3; 3]> {
        let mut faces = Vec::new();
        let meets = |bounds: &Aabb| {
            let (to, half) = (bounds.center() - ray.origin, 0.5 * bounds.size());
            let along = ray.direction.abs();
            to.cross(ray.direction).abs().cmple(half.yzx() * along.zxy() + half.zxy() * along.yzx()).all()
        };
        self.walk(meets, |[a, b, c], _| faces.push([a, b, c]));
        faces
    }
}

#[test]
fn where_bodies_touch_there_is_no_border() {
    let cube = |x: i64| {
        let p = |i: i64| [x + 10 * (i & 1), 10 * (i >> 1 & 1), 10 * (i >> 2)];
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        mesh(&triangles(&quads.map(|q| q.map(p))))
    };
    let solid = Solid::new(&[cube(0), cube(10)], DVec3::ZERO).unwrap();
    let (found, _) = Words(solid.words()).distance(DVec3::new(9.0, 5.0, 5.0), 6.0);
    assert_eq!(found, 5.0, "the wall between is 1 m away");
}
