//! The node tree: mesh nodes depth first, each with its chained transform and nearest ancestor that has a mesh.

use std::path::Path;

use glam::{DAffine3, DMat4, DQuat, DVec3};

use super::{
    accessor::{self, View},
    buffers::Buffers,
    document::{Document, Node},
    world_from_scene,
};
use crate::city::warning::{WarningCode, Warnings};

/// A mesh node on the way through the tree.
#[derive(Clone, Debug)]
pub(super) struct Visit<'a> {
    /// Index in the file's nodes.
    pub number: usize,
    pub node: &'a Node,
    /// Index in the file's meshes; may be out of range.
    pub mesh: usize,
    /// Position in the list of visits of the nearest ancestor that has a mesh.
    pub parent: Option<usize>,
    /// From the node's space to the world.
    pub world_from_node: DAffine3,
}

/// A node that is still to be visited.
struct Pending {
    node: usize,
    parent: Option<usize>,
    world_from_parent: DAffine3,
}

/// All mesh nodes of the default scene (else the first; else every root), depth first, children in order.
pub(super) fn visits<'a>(document: &'a Document, path: &Path, warnings: &mut Warnings) -> Vec<Visit<'a>> {
    let world = world_from_scene(document);
    let starts = start_nodes(document, path, warnings);
    let mut stack: Vec<Pending> =
        starts.into_iter().rev().map(|node| Pending { node, parent: None, world_from_parent: world }).collect();
    let mut seen = vec![false; document.nodes.len()];
    let mut visits = Vec::new();
    while let Some(Pending { node: number, parent, world_from_parent }) = stack.pop() {
        let node = match document.nodes.get(number) {
            Ok(node) => node,
            Err(what) => {
                warnings.add(WarningCode::Malformed, "", || format!("{}, {what}", path.display()));
                continue;
            }
        };
        if std::mem::replace(&mut seen[number], true) {
            warnings.add(WarningCode::CyclicParents, "", || {
                format!(
                    "{}, nodes[{number}] has several parents or is its own ancestor; it is shown once",
                    path.display()
                )
            });
            continue;
        }
        if !node.is_visible() {
            continue;
        }
        let world_from_node = world_from_parent * local(node);
        let mut below = parent;
        if let Some(mesh) = node.mesh {
            below = Some(visits.len());
            visits.push(Visit { number, node, mesh: mesh as usize, parent, world_from_node });
        }
        let children = node.children.iter().rev();
        stack.extend(children.map(|c| Pending {
            node: *c as usize,
            parent: below,
            world_from_parent: world_from_node,
        }));
    }
    visits
}

/// The roots of the scene to be shown: the one that the file names, else the first that has some, else every node that is no child.
fn start_nodes(document: &Document, path: &Path, warnings: &mut Warnings) -> Vec<usize> {
    let named = document.scene.map(|number| document.scenes.get(number));
    if let Some(Err(what)) = &named {
        warnings.add(WarningCode::Malformed, "", || format!("{}, {what}; another is shown", path.display()));
    }
    let first = || document.scenes.iter().flatten().find(|scene| !scene.nodes.is_empty());
    if let Some(scene) = named.and_then(Result::ok).or_else(first) {
        return scene.nodes.iter().map(|n| *n as usize).collect();
    }
    let mut is_child = vec![false; document.nodes.len()];
    for child in document.nodes.iter().flatten().flat_map(|node| &node.children) {
        if let Some(flag) = is_child.get_mut(*child as usize) {
            *flag = true;
        }
    }
    (0..document.nodes.len()).filter(|n| !is_child[*n]).collect()
}

/// The node's own transform: its matrix, else translation × rotation × scale.
fn local(node: &Node) -> DAffine3 {
    if let Some(matrix) = &node.matrix {
        return DAffine3::from_mat4(DMat4::from_cols_array(matrix));
    }
    affine(
        node.translation.unwrap_or_default(),
        node.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]),
        node.scale.unwrap_or([1.0; 3]),
    )
}

fn affine(translation: [f64; 3], rotation: [f64; 4], scale: [f64; 3]) -> DAffine3 {
    // Written as f32 in most files: unit only to 1e-7, which at a large scale is seen.
    let rotation = glam::DVec4::from(rotation).try_normalize().map_or(DQuat::IDENTITY, DQuat::from_vec4);
    DAffine3::from_scale_rotation_translation(DVec3::from(scale), rotation, DVec3::from(translation))
}

/// Copies of one mesh (`EXT_mesh_gpu_instancing`).
#[derive(Debug)]
pub(super) struct Instances<'a> {
    translation: Option<View<'a>>,
    rotation: Option<View<'a>>,
    scale: Option<View<'a>>,
}

/// The instances of a node, if it is instanced.
pub(super) fn instances<'a>(
    document: &Document,
    buffers: &'a Buffers<'_>,
    node: &Node,
) -> Result<Option<Instances<'a>>, String> {
    let Some(json) = node.extensions.get("EXT_mesh_gpu_instancing") else { return Ok(None) };
    let find = |name: &str| {
        let index = json.get("attributes").and_then(|a| a.get(name)).and_then(serde_json::Value::as_u64);
        index.map(|i| accessor::open(document, buffers, usize::try_from(i).unwrap_or(usize::MAX))).transpose()
    };
    let found = Instances { translation: find("TRANSLATION")?, rotation: find("ROTATION")?, scale: find("SCALE")? };
    let counts: Vec<u64> = found.views().map(|v| v.count).collect();
    match counts[..] {
        [] => Err("has none of TRANSLATION, ROTATION, SCALE".into()),
        [first, ..] if counts.iter().any(|c| *c != first) => Err("its attributes differ in count".into()),
        _ => Ok(Some(found)),
    }
}

impl<'a> Instances<'a> {
    fn views(&self) -> impl Iterator<Item = &View<'a>> {
        [&self.translation, &self.rotation, &self.scale].into_iter().flatten()
    }

    /// The number of copies.
    pub fn count(&self) -> u64 {
        self.views().next().map_or(1, |v| v.count)
    }

    /// Where copy `i` stands in the node's space.
    pub fn get(&self, i: u64) -> DAffine3 {
        let vector = |view: &Option<View<'_>>, default| view.as_ref().map_or(default, |v| v.get::<3>(i));
        let rotation = self.rotation.as_ref().map_or([0.0, 0.0, 0.0, 1.0], |v| v.get::<4>(i));
        affine(vector(&self.translation, [0.0; 3]), rotation, vector(&self.scale, [1.0; 3]))
    }
}
