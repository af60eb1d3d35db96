//! The body between planes: its corners and faces, found from the planes themselves, which stay as they were given.

use glam::DVec3;

use crate::geom::shape::{
    error::ShapeError,
    hull::{Hull, THIN_M},
    limits::MAX_PLANES,
};

/// Directions whose sines are below this count as one.
const PARALLEL: f64 = 1e-9;

/// The body where `n · p ≤ d` for every plane `[n.x, n.y, n.z, d]`; normals outwards, of any length but 0.
pub(super) fn between(planes: &[[f64; 4]]) -> Result<Hull, ShapeError> {
    if planes.len() > MAX_PLANES {
        return Err(ShapeError::ManyPlanes(planes.len()));
    }
    let mut units = Vec::with_capacity(planes.len());
    for (i, plane) in planes.iter().enumerate() {
        if !plane.iter().all(|v| v.is_finite()) {
            return Err(ShapeError::NotFinite);
        }
        let [x, y, z, offset] = *plane;
        // First by its largest part: the square of a long normal has no number.
        let normal = DVec3::new(x, y, z);
        let largest = normal.abs().max_element();
        let unit = (normal / largest).try_normalize().ok_or(ShapeError::NoNormal(i))?;
        let distance = offset / largest / (normal / largest).length();
        if !distance.is_finite() {
            return Err(ShapeError::NotFinite);
        }
        units.push((unit, distance));
    }
    if is_open(&units) {
        return Err(ShapeError::Open);
    }
    // Relative to a corner of some planes digits are kept where the city is far from the origin.
    let first = corners_of(&units, 1.0).next().ok_or(ShapeError::Nothing)?;
    let near: Vec<(DVec3, f64)> = units.iter().map(|(n, d)| (*n, d - n.dot(first))).collect();
    let reach = near.iter().map(|(_, d)| d.abs()).fold(1.0, f64::max);
    let mut corners: Vec<DVec3> = Vec::new();
    for corner in corners_of(&near, 1e-8 + 1e-12 * reach) {
        if !corners.iter().any(|c| c.distance(corner) < THIN_M) {
            corners.push(corner);
        }
    }
    let faces = near.iter().filter_map(|(normal, offset)| {
        let mut face: Vec<u32> =
            (0..corners.len() as u32).filter(|&i| (normal.dot(corners[i as usize]) - offset).abs() < THIN_M).collect();
        let (across, up) = normal.any_orthonormal_pair();
        let middle = face.iter().map(|&i| corners[i as usize]).sum::<DVec3>() / face.len().max(1) as f64;
        let turn = |i: &u32| {
            let v = corners[*i as usize] - middle;
            v.dot(up).atan2(v.dot(across))
        };
        face.sort_by(|a, b| turn(a).total_cmp(&turn(b)));
        (face.len() > 2).then_some((face, *normal, *offset))
    });
    let (mut triangles, mut kept): (Vec<[u32; 3]>, Vec<(DVec3, f64)>) = (Vec::new(), Vec::new());
    for (face, normal, offset) in faces {
        let is_again = kept.iter().any(|(n, d)| n.distance(normal) < PARALLEL && (d - offset).abs() < THIN_M);
        if !is_again {
            triangles.extend((2..face.len()).map(|i| [face[0], face[i - 1], face[i]]));
            kept.push((normal, offset));
        }
    }
    let thickness = |(n, d): &(DVec3, f64)| corners.iter().map(|c| d - n.dot(*c)).fold(f64::NEG_INFINITY, f64::max);
    if kept.len() < 4 || kept.iter().any(|plane| thickness(plane) < THIN_M) {
        return Err(ShapeError::Nothing);
    }
    Ok(Hull { center: first, corners, triangles, planes: kept })
}

/// Where three planes meet within `slack` metres of the inner side of all others.
fn corners_of(planes: &[(DVec3, f64)], slack: f64) -> impl Iterator<Item = DVec3> + '_ {
    let n = planes.len();
    let triples = (0..n).flat_map(move |i| (i + 1..n).flat_map(move |j| (j + 1..n).map(move |k| [i, j, k])));
    triples.filter_map(move |triple| {
        let [(a, da), (b, db), (c, dc)] = triple.map(|i| planes[i]);
        let volume = a.dot(b.cross(c));
        if volume.abs() < PARALLEL {
            return None;
        }
        let corner = (da * b.cross(c) + db * c.cross(a) + dc * a.cross(b)) / volume;
        let is_other = |(i, (n, d)): (usize, &(DVec3, f64))| triple.contains(&i) || n.dot(corner) - d <= slack;
        planes.iter().enumerate().all(is_other).then_some(corner)
    })
}

/// Whether what lies between them goes on for ever: some way crosses none of them outwards. Where there is one, there is one
/// along two of the planes, or all are parallel to a line.
fn is_open(planes: &[(DVec3, f64)]) -> bool {
    let leads_out = |way: DVec3| planes.iter().all(|(n, _)| n.dot(way) <= PARALLEL);
    let mut is_spanned = false;
    for (i, (a, _)) in planes.iter().enumerate() {
        for (b, _) in &planes[i + 1..] {
            let Some(way) = a.cross(*b).try_normalize().filter(|_| a.cross(*b).length() > PARALLEL) else { continue };
            is_spanned |= planes.iter().any(|(n, _)| n.dot(way).abs() > PARALLEL);
            if leads_out(way) || leads_out(-way) {
                return true;
            }
        }
    }
    !is_spanned
}
