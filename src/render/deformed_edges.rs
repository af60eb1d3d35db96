//! Edges of the deformed city: halved where the edges of its triangles are, by the same question.

use glam::{DVec3, IVec3, Vec3};
use rayon::prelude::*;

use crate::{
    city::{decode_normal, encode_normal},
    geom::{
        Aabb,
        deform::{Deformers, cofactor, refine::Refiner},
    },
    gpu::{Gpu, GpuError},
    render::{
        deformed::origin_of,
        edges::{Edge, EdgeBuffers, half, metres_of},
        heights::Height,
    },
};

/// The edges that stay as they are, and those that deformations reach.
pub(super) fn deformed_edges(
    gpu: &Gpu,
    edges: &EdgeBuffers,
    all: &[Edge],
    refiner: &Refiner,
    raised: &[Option<Height>],
) -> Result<[EdgeBuffers; 2], GpuError> {
    let deformers = refiner.deformers;
    // With other heights, anything may be met.
    let is_met = |bounds: &Aabb| !raised.is_empty() || deformers.supports().any(|support| support.reaches(bounds));
    let (met, left): (Vec<_>, Vec<_>) = edges.chunks.iter().cloned().partition(|(_, bounds)| is_met(bounds));
    let of_chunk = |range: &std::ops::Range<u32>| &all[range.start as usize..range.end as usize];
    let moved: Vec<Edge> = met
        .par_iter()
        .flat_map_iter(|(range, _)| {
            of_chunk(range)
                .iter()
                .flat_map(|edge| moved(edge, refiner, raised.get(edge.surface_number() as usize).copied().flatten()))
        })
        .collect();
    let left = EdgeBuffers { instances: edges.instances.clone(), chunks: left, count: 0, bytes: 0 };
    Ok([left, EdgeBuffers::of_edges(gpu, &moved)?])
}

/// An edge in as many parts as it is halved into.
fn moved(edge: &Edge, refiner: &Refiner, raised: Option<Height>) -> Vec<Edge> {
    let world = |p: [f32; 3]| IVec3::from(edge.origin).as_dvec3() + Vec3::from(p).as_dvec3();
    let ends = [world(edge.start), world(edge.end)];
    let mut own = *edge;
    let [start, end] = match raised {
        None => ends,
        Some(height) => {
            let normal = |packed| encode_normal(height.normal(decode_normal(packed)));
            (own.normal_a, own.normal_b) = (normal(edge.normal_a), normal(edge.normal_b));
            ends.map(|place| height.place(place))
        }
    };
    if !refiner.meets(start, end) {
        return if raised.is_some() {
            vec![piece(&own, [start, end], [start, end], refiner.deformers)]
        } else {
            vec![own]
        };
    }
    let places = refiner.halved(start, end);
    places.windows(2).map(|part| piece(&own, [start, end], [part[0], part[1]], refiner.deformers)).collect()
}

/// The part of an edge between two of its places at rest.
fn piece(edge: &Edge, [start, end]: [DVec3; 2], [from, to]: [DVec3; 2], deformers: &Deformers) -> Edge {
    let shown = [from, to].map(|place| deformers.value(place));
    let turned = cofactor(&deformers.jacobian(0.5 * (from + to)));
    let normal = |packed: u32| {
        let normal = (turned * decode_normal(packed)).try_normalize();
        normal.map_or(packed, encode_normal)
    };
    let origin = origin_of(shown[0]);
    let offset = |place: DVec3| (place - origin).as_vec3().to_array();
    // The faces beside it go on along it as far as they did.
    let more = [start.distance(from), end.distance(to)].map(|metres| metres as f32);
    let along = edge.along.map(|packed| {
        let [before, beyond] = [packed as u16, (packed >> 16) as u16].map(metres_of);
        u32::from(half(before + more[0])) | u32::from(half(beyond + more[1])) << 16
    });
    Edge {
        origin: origin.as_ivec3().to_array(),
        start: offset(shown[0]),
        end: offset(shown[1]),
        normal_a: normal(edge.normal_a),
        normal_b: normal(edge.normal_b),
        along,
        ..*edge
    }
}
