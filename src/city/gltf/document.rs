//! The JSON of a glTF file, as far as it is read: every element of a list by itself, so that what is wrong with one, or strange in
//! one that nothing uses, leaves the others as they are.
//!
//! The `gltf` crate gives the types of elements. Its types for whole files are not used: they refuse what the format allows
//! (scenes without nodes, channels of animations without a node, textures whose image an extension names, whole numbers
//! written as `36.0`), and hold placements of nodes in f32, which national coordinates do not fit.

use gltf::json::{
    accessor::Accessor,
    buffer::{Buffer, View},
    image::Image,
    material::Material,
    mesh::Mesh,
    texture::Sampler,
};
use serde::{Deserialize, de::DeserializeOwned};
use serde_json::{Map, Value, value::RawValue};

/// A file's lists.
#[derive(Debug)]
pub(super) struct Document {
    /// The scene to be shown.
    pub scene: Option<usize>,
    pub scenes: List<Scene>,
    pub nodes: List<Node>,
    pub meshes: List<Mesh>,
    pub accessors: List<Accessor>,
    pub buffer_views: List<View>,
    pub buffers: List<Buffer>,
    pub materials: List<Material>,
    pub textures: List<Texture>,
    pub images: List<Image>,
    pub samplers: List<Sampler>,
    /// Extensions of the file itself.
    pub extensions: Map<String, Value>,
}

/// A list of a file; elements that cannot be read say why.
#[derive(Debug)]
pub(super) struct List<T> {
    /// Its member name.
    name: &'static str,
    elements: Vec<Result<T, String>>,
}

/// A scene: its root nodes.
#[derive(Debug, Deserialize)]
pub(super) struct Scene {
    #[serde(default)]
    pub nodes: Vec<u32>,
}

/// A node; its placement is exactly the numbers of the file.
#[derive(Debug, Deserialize)]
pub(super) struct Node {
    pub name: Option<String>,
    pub mesh: Option<u32>,
    pub skin: Option<u32>,
    #[serde(default)]
    pub children: Vec<u32>,
    /// Columns.
    pub matrix: Option<[f64; 16]>,
    pub translation: Option<[f64; 3]>,
    pub rotation: Option<[f64; 4]>,
    pub scale: Option<[f64; 3]>,
    pub extras: Option<Box<RawValue>>,
    #[serde(default)]
    pub extensions: Map<String, Value>,
}

/// A texture: an image and how it is sampled.
#[derive(Debug, Deserialize)]
pub(super) struct Texture {
    pub sampler: Option<u32>,
    source: Option<u32>,
    #[serde(default)]
    extensions: Map<String, Value>,
}

/// The members of a file that are read.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Members<'a> {
    #[serde(borrow)]
    scene: Option<&'a RawValue>,
    #[serde(borrow)]
    scenes: Option<&'a RawValue>,
    #[serde(borrow)]
    nodes: Option<&'a RawValue>,
    #[serde(borrow)]
    meshes: Option<&'a RawValue>,
    #[serde(borrow)]
    accessors: Option<&'a RawValue>,
    #[serde(borrow)]
    buffer_views: Option<&'a RawValue>,
    #[serde(borrow)]
    buffers: Option<&'a RawValue>,
    #[serde(borrow)]
    materials: Option<&'a RawValue>,
    #[serde(borrow)]
    textures: Option<&'a RawValue>,
    #[serde(borrow)]
    images: Option<&'a RawValue>,
    #[serde(borrow)]
    samplers: Option<&'a RawValue>,
    #[serde(borrow)]
    extensions: Option<&'a RawValue>,
}

/// Why the lists of a file cannot be read.
pub(super) enum DocumentError {
    /// It is no JSON.
    Syntax(serde_json::Error),
    /// A member is no list, nor what else it must be: which, and what is wrong.
    Member(&'static str, String),
}

impl Document {
    /// Reads the lists of a file.
    ///
    /// # Errors
    /// What is no JSON, and members of another type; elements are not among them.
    pub fn parse(json: &[u8]) -> Result<Self, DocumentError> {
        let members: Members = serde_json::from_slice(json).map_err(DocumentError::Syntax)?;
        let scene = members.scene.map(|scene| parse::<Option<usize>>(scene.get())).transpose();
        Ok(Self {
            scene: scene.map_err(|what| DocumentError::Member("scene", what))?.flatten(),
            scenes: List::of("scenes", members.scenes)?,
            nodes: List::of("nodes", members.nodes)?,
            meshes: List::of("meshes", members.meshes)?,
            accessors: List::of("accessors", members.accessors)?,
            buffer_views: List::of("bufferViews", members.buffer_views)?,
            buffers: List::of("buffers", members.buffers)?,
            materials: List::of("materials", members.materials)?,
            textures: List::of("textures", members.textures)?,
            images: List::of("images", members.images)?,
            samplers: List::of("samplers", members.samplers)?,
            extensions: members.extensions.and_then(|own| serde_json::from_str(own.get()).ok()).unwrap_or_default(),
        })
    }
}

impl<T> List<T> {
    fn of(name: &'static str, json: Option<&RawValue>) -> Result<Self, DocumentError>
    where
        T: DeserializeOwned,
    {
        let elements: Option<Vec<&RawValue>> = match json {
            Some(json) => serde_json::from_str(json.get()).map_err(|e| DocumentError::Member(name, said(&e)))?,
            None => None,
        };
        let elements = elements.into_iter().flatten().map(|element| parse(element.get())).collect();
        Ok(Self { name, elements })
    }

    /// An element.
    ///
    /// # Errors
    /// What is wrong with it, with its JSON path.
    pub fn get(&self, index: usize) -> Result<&T, String> {
        let Self { name, elements } = self;
        match elements.get(index) {
            Some(Ok(element)) => Ok(element),
            Some(Err(what)) => Err(format!("{name}[{index}]: {what}")),
            None => Err(format!("{name}[{index}] does not exist; the file has {}", elements.len())),
        }
    }

    /// All of them in order.
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = Result<&T, &str>> {
        self.elements.iter().map(|element| element.as_ref().map_err(String::as_str))
    }

    pub fn len(&self) -> usize {
        self.elements.len()
    }
}

impl Texture {
    /// Its image: where one has been made of a format that an extension names, that one.
    pub fn image(&self) -> Option<usize> {
        let webp = self.extensions.get("EXT_texture_webp").and_then(|own| own.get("source")?.as_u64());
        webp.or(self.source.map(u64::from)).and_then(|image| usize::try_from(image).ok())
    }
}

impl Node {
    /// Whether it is shown, and all below it (`KHR_node_visibility`).
    pub fn is_visible(&self) -> bool {
        let own = self.extensions.get("KHR_node_visibility").and_then(|own| own.get("visible")?.as_bool());
        own.unwrap_or(true)
    }
}

/// What a JSON error says, without its place in a part of the file.
pub(super) fn said(error: &serde_json::Error) -> String {
    let text = error.to_string();
    text.rsplit_once(" at line ").map_or(text.as_str(), |(what, _)| what).to_owned()
}

/// Reads a part of the file; whole numbers may be written as fractions.
fn parse<T: DeserializeOwned>(json: &str) -> Result<T, String> {
    serde_json::from_str(json).or_else(|error| {
        let whole = with_whole_numbers(json).and_then(|json| serde_json::from_str(&json).ok());
        whole.ok_or_else(|| said(&error))
    })
}

/// The same JSON with numbers such as `36.0` and `3.6e1` written as `36`; `None` where there are none.
fn with_whole_numbers(json: &str) -> Option<String> {
    /// All whole numbers up to here are f64s, 2⁵³.
    const MOST: f64 = 9_007_199_254_740_992.0;
    let bytes = json.as_bytes();
    let mut out = String::with_capacity(json.len());
    let (mut kept, mut at, mut is_text) = (0, 0, false);
    while at < bytes.len() {
        match bytes[at] {
            b'\\' if is_text => at += 1,
            b'"' => is_text = !is_text,
            b'-' | b'0'..=b'9' if !is_text => {
                let is_of_number = |b: &&u8| matches!(b, b'-' | b'+' | b'.' | b'e' | b'E' | b'0'..=b'9');
                let end = at + bytes[at..].iter().take_while(is_of_number).count();
                let number = &json[at..end];
                let is_written_otherwise = number.contains(['.', 'e', 'E']);
                let whole = number.parse().ok().filter(|n: &f64| n.fract() == 0.0 && n.abs() <= MOST);
                if let (true, Some(whole)) = (is_written_otherwise, whole) {
                    out.push_str(&json[kept..at]);
                    out.push_str(&(whole as i64).to_string());
                    kept = end;
                }
                at = end - 1;
            }
            _ => {}
        }
        at += 1;
    }
    (kept > 0).then(|| out + &json[kept..])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_numbers_are_whole_however_they_are_written() {
        let text =
            r#"{"a": 36.0, "b": [1e2,-4.0e+0 ,3.6e1], "c": "1.0 \" 2.0", "d": 0.5, "e": 1.5e300, "f": -0.0, "g": 7}"#;
        let whole = r#"{"a": 36, "b": [100,-4 ,36], "c": "1.0 \" 2.0", "d": 0.5, "e": 1.5e300, "f": 0, "g": 7}"#;
        assert_eq!(with_whole_numbers(text).as_deref(), Some(whole));
        assert_eq!(with_whole_numbers(r#"{"a": 36, "b": 0.25, "c": "\\"}"#), None);
        assert_eq!(parse::<Vec<u32>>("[1.0, 20e-1]"), Ok(vec![1, 2]));
        assert!(parse::<Vec<u32>>("[1.5]").is_err());
    }

    #[test]
    fn what_is_wrong_with_an_element_is_said_where_it_is_used() {
        let json = br#"{"nodes": [{"mesh": -1}, {"mesh": 3.0}, null], "meshes": null, "accessors": [{"count": 1}], "cameras": 7}"#;
        let Ok(document) = Document::parse(json) else { panic!("it is read") };
        assert_eq!((document.nodes.len(), document.meshes.len(), document.scenes.len()), (3, 0, 0));
        assert_eq!(document.nodes.get(1).expect("a node").mesh, Some(3));
        assert!(document.nodes.get(0).expect_err("no index").starts_with("nodes[0]: invalid value: integer `-1`"));
        assert!(document.nodes.get(2).is_err());
        assert_eq!(document.nodes.get(3).expect_err("none"), "nodes[3] does not exist; the file has 3");
        assert_eq!(document.accessors.get(0).expect_err("half"), "accessors[0]: missing field `componentType`");
        let wrong = Document::parse(br#"{"nodes": {}}"#);
        assert!(matches!(wrong, Err(DocumentError::Member("nodes", _))));
        assert!(matches!(Document::parse(b"{\"nodes\": ["), Err(DocumentError::Syntax(_))));
    }
}
