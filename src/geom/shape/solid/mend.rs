//! Bodies as files have them, made closed and oriented.

use std::collections::{BTreeMap, HashMap};

use glam::DVec3;
use rustc_hash::FxHashMap;

use crate::geom::aabb::Aabb;

/// The faces of a body with holes closed and turned so that they look outwards, and how many faces closed holes. Points that
/// are equal are one; faces without three different corners are left out.
pub(super) fn closed(points: &[DVec3], triangles: &[[u32; 3]]) -> (Vec<[DVec3; 3]>, usize) {
    let (corners, mut faces) = welded(points, triangles);
    orient(&corners, &mut faces);
    let own = faces.len();
    let mut corners = corners;
    for ring in open_rings(&faces) {
        // Against the direction of the open edges: the fan is their other side.
        let middle = ring.iter().map(|&i| corners[i as usize]).sum::<DVec3>() / ring.len() as f64;
        let tip = corners.len() as u32;
        corners.push(middle.as_vec3().as_dvec3());
        for i in 0..ring.len() {
            faces.push([ring[(i + 1) % ring.len()], ring[i], tip]);
        }
    }
    let added = faces.len() - own;
    (faces.into_iter().map(|face| face.map(|i| corners[i as usize])).collect(), added)
}

fn welded(points: &[DVec3], triangles: &[[u32; 3]]) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let mut corners = Vec::new();
    let mut numbers: FxHashMap<[u64; 3], u32> = HashMap::default();
    let mut number = |i: u32| {
        // -0 and 0 are one place.
        let p = points[i as usize] + DVec3::ZERO;
        *numbers.entry(p.to_array().map(f64::to_bits)).or_insert_with(|| {
            corners.push(p);
            corners.len() as u32 - 1
        })
    };
    let faces: Vec<[u32; 3]> =
        triangles.iter().map(|t| t.map(&mut number)).filter(|[a, b, c]| a != b && b != c && c != a).collect();
    (corners, faces)
}

fn edges([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}

/// Turns faces round so that neighbours agree, and each part that they make so that it encloses a positive volume; a part that
/// lies in another one and was turned the other way stays a cavity of it.
fn orient(corners: &[DVec3], faces: &mut [[u32; 3]]) {
    let mut of_edge: FxHashMap<[u32; 2], Vec<u32>> = HashMap::default();
    for (i, face) in faces.iter().enumerate() {
        for [a, b] in edges(*face) {
            of_edge.entry([a.min(b), a.max(b)]).or_default().push(i as u32);
        }
    }
    // Where more than two faces share an edge, which belong together is not known: there the file's word is taken.
    let mut part_of = vec![u32::MAX; faces.len()];
    let mut is_turned = vec![false; faces.len()];
    let mut parts: Vec<Vec<u32>> = Vec::new();
    for first in 0..faces.len() {
        if part_of[first] != u32::MAX {
            continue;
        }
        let part = parts.len() as u32;
        part_of[first] = part;
        let mut members = vec![first as u32];
        let mut next = 0;
        let (mut turned, mut is_branching) = (0, false);
        while next < members.len() {
            let face = members[next] as usize;
            next += 1;
            for [a, b] in edges(faces[face]) {
                let sharing = &of_edge[&[a.min(b), a.max(b)]];
                is_branching |= sharing.len() > 2;
                let [x, y] = sharing[..] else { continue };
                let other = (if x as usize == face { y } else { x }) as usize;
                if part_of[other] != u32::MAX {
                    continue;
                }
                part_of[other] = part;
                // Neighbours run along their edge in opposite directions.
                let runs_alike = edges(faces[other]).contains(&[a, b]);
                is_turned[other] = is_turned[face] != runs_alike;
                turned += u32::from(is_turned[other]);
                members.push(other as u32);
            }
        }
        if is_branching {
            members.iter().for_each(|&f| is_turned[f as usize] = false);
        } else if 2 * turned as usize > members.len() {
            // As most of them were given.
            members.iter().for_each(|&f| is_turned[f as usize] = !is_turned[f as usize]);
        }
        parts.push(members);
    }
    for (face, _) in faces.iter_mut().zip(&is_turned).filter(|(_, turned)| **turned) {
        face.swap(1, 2);
    }
    let corners_of = |f: &u32| faces[*f as usize].map(|i| corners[i as usize]);
    let bounds: Vec<Aabb> = parts.iter().map(|part| Aabb::from_points(part.iter().flat_map(corners_of))).collect();
    let mut is_inward = Vec::with_capacity(parts.len());
    let mut area_by_sense = [0.0, 0.0];
    for (part, bounds) in parts.iter().zip(&bounds) {
        let own = |f: &u32| corners_of(f).map(|p| p - bounds.center());
        let volume: f64 = part.iter().map(own).map(|[a, b, c]| a.dot(b.cross(c))).sum();
        let area: f64 = part.iter().map(own).map(|[a, b, c]| (b - a).cross(c - a).length()).sum();
        area_by_sense[usize::from(volume < 0.0)] += area;
        is_inward.push(volume < 0.0);
    }
    // A file may mean all faces the other way round: cavities have the smaller surface.
    let is_inside_out = area_by_sense[1] > area_by_sense[0];
    for (i, part) in parts.iter().enumerate() {
        let looks_in = is_inward[i] != is_inside_out;
        let holds = |outer: &Aabb| outer.min.cmplt(bounds[i].min).all() && outer.max.cmpgt(bounds[i].max).all();
        // Fewer than four faces enclose nothing.
        let is_cavity = looks_in && part.len() >= 4 && bounds.iter().any(holds);
        if is_inside_out != (looks_in && !is_cavity) {
            part.iter().for_each(|&f| faces[f as usize].swap(1, 2));
        }
    }
}

/// Rings of edges that no face answers, as the faces run along them.
fn open_rings(faces: &[[u32; 3]]) -> Vec<Vec<u32>> {
    let mut net: BTreeMap<[u32; 2], i32> = BTreeMap::new();
    for face in faces {
        for [a, b] in edges(*face) {
            let (key, sense) = if a < b { ([a, b], 1) } else { ([b, a], -1) };
            *net.entry(key).or_default() += sense;
        }
    }
    let mut onwards: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for (&[a, b], &count) in &net {
        let (from, to) = if count > 0 { (a, b) } else { (b, a) };
        let list = onwards.entry(from).or_default();
        list.extend(std::iter::repeat_n(to, count.unsigned_abs() as usize));
    }
    onwards.retain(|_, list| !list.is_empty());
    let starts: Vec<u32> = onwards.keys().copied().collect();
    let mut rings = Vec::new();
    for start in starts {
        let mut way = vec![start];
        let mut places: FxHashMap<u32, usize> = HashMap::from_iter([(start, 0)]);
        let mut at = start;
        // As many edges arrive at a corner as leave it: whoever walks on comes back.
        while let Some(next) = onwards.get_mut(&at).and_then(Vec::pop) {
            match places.get(&next) {
                // A corner met again ends a ring of its own.
                Some(&first) => {
                    let ring = way.split_off(first);
                    ring[1..].iter().for_each(|corner| {
                        places.remove(corner);
                    });
                    rings.push(ring);
                }
                None => {
                    places.insert(next, way.len());
                }
            }
            way.push(next);
            at = next;
        }
    }
    rings
}
