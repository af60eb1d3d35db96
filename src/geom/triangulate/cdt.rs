//! Constrained Delaunay triangulation of any rings, and winding numbers to tell in from out.
//!
//! Coordinates below 2⁵³ are exact in `f64` and `spade` decides by exact predicates, so all of this is exact. Rings may
//! touch themselves and each other, in points and along edges. They may not cross, and no place may be enclosed twice
//! or by a hole alone: with winding numbers 0 and 1 only, the triangles' area is the rings' and nothing overlaps.

use rustc_hash::FxHashMap;
use spade::{
    CdtEdge, ConstrainedDelaunayTriangulation, Point2, Triangulation,
    handles::{DirectedEdgeHandle, FixedVertexHandle},
};

use super::{Corner, Refusal};

/// A plane position that remembers its corner.
struct Site {
    at: Point2<f64>,
    corner: u32,
}

impl spade::HasPosition for Site {
    type Scalar = f64;

    fn position(&self) -> Point2<f64> {
        self.at
    }
}

type Net = ConstrainedDelaunayTriangulation<Site>;

/// Appends triangles that cover what the rings enclose (outer ring counter-clockwise, holes clockwise).
pub(super) fn fill(corners: &[Corner], ends: &[u32], triangles: &mut Vec<[u32; 3]>) -> Result<(), Refusal> {
    // One site per position: of corners at one position the first stands for all.
    let mut site_at: FxHashMap<[i64; 2], u32> = FxHashMap::default();
    let mut sites = Vec::with_capacity(corners.len());
    let site_of: Vec<u32> = (0..corners.len() as u32)
        .map(|corner| {
            let at = corners[corner as usize].at;
            *site_at.entry(at).or_insert_with(|| {
                sites.push(Site { at: Point2::new(at[0] as f64, at[1] as f64), corner });
                sites.len() as u32 - 1
            })
        })
        .collect();
    let mut net = Net::bulk_load_cdt(sites, Vec::new()).map_err(|_| Refusal::AreaMismatch)?;
    let steps = constrain(&mut net, ends, &site_of)?;
    let windings = wind(&net, &steps)?;
    for face in net.inner_faces() {
        if windings[face.fix().index()] == 1 {
            triangles.push(face.vertices().map(|vertex| vertex.data().corner));
        }
    }
    Ok(())
}

/// Makes every ring edge an edge of the net. Returns, per undirected edge, how much the winding number rises from its
/// right to its left, seen along its canonical direction.
fn constrain(net: &mut Net, ends: &[u32], site_of: &[u32]) -> Result<Vec<i32>, Refusal> {
    let mut steps = vec![0; net.num_undirected_edges()];
    let mut start = 0;
    for &end in ends {
        let ring = &site_of[start..end as usize];
        start = end as usize;
        for (i, &from) in ring.iter().enumerate() {
            let to = ring[(i + 1) % ring.len()];
            let [from, to] = [from, to].map(|site| FixedVertexHandle::from_index(site as usize));
            // A ring edge that runs over other corners, or along other edges, comes back as several pieces.
            let pieces = net.try_add_constraint(from, to);
            if pieces.is_empty() {
                return Err(Refusal::SelfCrossing);
            }
            let (a, b) = (net.vertex(from).position(), net.vertex(to).position());
            for piece in pieces {
                let [c, d] = net.directed_edge(piece).positions();
                let forward = (d.x - c.x) * (b.x - a.x) + (d.y - c.y) * (b.y - a.y) > 0.0;
                let canonical = piece == piece.as_undirected().as_directed();
                steps[piece.as_undirected().index()] += if forward == canonical { 1 } else { -1 };
            }
        }
    }
    Ok(steps)
}

/// The winding number of every face, walked from the outside in; only 0 and 1 are allowed.
fn wind(net: &Net, steps: &[i32]) -> Result<Vec<i32>, Refusal> {
    let outside = net.outer_face().fix();
    let mut windings: Vec<Option<i32>> = vec![None; net.num_all_faces()];
    windings[outside.index()] = Some(0);
    let mut open: Vec<DirectedEdgeHandle<'_, Site, (), CdtEdge<()>, ()>> = net
        .undirected_edges()
        .flat_map(|edge| [edge.as_directed(), edge.as_directed().rev()])
        .filter(|edge| edge.face().fix() == outside)
        .collect();
    // `open` holds edges whose left face is known.
    while let Some(edge) = open.pop() {
        let step = steps[edge.fix().as_undirected().index()];
        let canonical = edge.fix() == edge.as_undirected().as_directed().fix();
        let Some(left) = windings[edge.face().fix().index()] else { continue };
        let right = left - if canonical { step } else { -step };
        let beyond = edge.rev().face();
        let place = &mut windings[beyond.fix().index()];
        if place.is_none() {
            *place = Some(right);
            if !(0..=1).contains(&right) {
                return Err(Refusal::SelfCrossing);
            }
            if let Some(inner) = beyond.as_inner() {
                open.extend(inner.adjacent_edges());
            }
        } else if *place != Some(right) {
            return Err(Refusal::AreaMismatch);
        }
    }
    Ok(windings.into_iter().map(|winding| winding.unwrap_or(0)).collect())
}
