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
        standing::Placement,
        standing::Standing,
    },
};

/// The edges of a city at rest, and where that stands.
pub(super) struct RestEdges<'a> {
    pub all: &'a [Edge],
    /// Of each surface, what its object's height becomes; none where no height does.
    pub raised: &'a [Option<Height>],
    pub placement: &'a Placement,
}

/// The edges that stay as they are, and those that deformations reach; of a city that is placed, all are among these.
pub(super) fn deformed_edges(
    gpu: &Gpu,
    edges: &EdgeBuffers,
    rest: &RestEdges,
    refiner: &Refiner,
) -> Result<[EdgeBuffers; 2], GpuError> {
    let RestEdges { all, raised, placement } = *rest;
    let deformers = refiner.deformers;
    // With other heights, anything may be met.
    let is_any = !raised.is_empty() || !placement.is_none();
    let is_met = |bounds: &Aabb| is_any || deformers.supports().any(|support| support.reaches(bounds));
    let (met, left): (Vec<_>, Vec<_>) = edges.chunks.iter().cloned().partition(|(_, bounds)| is_met(bounds));
    let of_chunk = |range: &std::ops::Range<u32>| &all[range.start as usize..range.end as usize];
    let moved: Vec<Edge> = met
        .par_iter()
        .flat_map_iter(|(range, _)| {
            of_chunk(range).iter().flat_map(|edge| {
                let raised = raised.get(edge.surface_number() as usize).copied().flatten();
                moved(edge, refiner, &Standing { raised, placement })
            })
        })
        .collect();
    let left = EdgeBuffers { instances: edges.instances.clone(), chunks: left, count: 0, bytes: 0 };
    Ok([left, EdgeBuffers::of_edges(gpu, &moved)?])
}

/// An edge in as many parts as it is halved into.
fn moved(edge: &Edge, refiner: &Refiner, standing: &Standing) -> Vec<Edge> {
    let world = |p: [f32; 3]| standing.place(IVec3::from(edge.origin).as_dvec3() + Vec3::from(p).as_dvec3());
    let [start, end] = [edge.start, edge.end].map(world);
    let scale = standing.placement.scale as f32;
    let longer = |metres: u16| if scale == 1.0 { metres } else { half(metres_of(metres) * scale) };
    let own = Edge {
        normal_a: standing.packed_normal(edge.normal_a),
        normal_b: standing.packed_normal(edge.normal_b),
        along: edge
            .along
            .map(|packed| u32::from(longer(packed as u16)) | u32::from(longer((packed >> 16) as u16)) << 16),
        ..*edge
    };
    if !refiner.meets(start, end) {
        return if standing.is_moved() {
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
