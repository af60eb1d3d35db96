//! What makes a pipeline the one it is: a value of the key type of its pass.

use std::{
    any::Any,
    borrow::Borrow,
    fmt::{self, Debug},
    hash::{Hash, Hasher},
    ops::Deref,
    sync::Arc,
};

use crate::{render::resource::bindings::GroupLayout, render::resource::formats::DEPTH, shader::Module};

/// A pass' own type of keys: plain data from which a pipeline can be made.
pub trait PipelineKey: Debug + Eq + Hash + Send + Sync + 'static {
    /// A name for people and statistics.
    fn name(&self) -> String;

    /// What the pipeline is made of; `sums`: the format of sums of samples.
    fn parts(&self, sums: wgpu::TextureFormat) -> Parts;
}

/// What a pipeline is made of.
#[derive(Debug)]
pub struct Parts {
    /// Its WGSL.
    pub module: Module,
    /// Bind groups from 0 on; `None` where it has none of that number.
    pub groups: Vec<Option<&'static GroupLayout>>,
    /// Values of constants that pipelines override.
    pub constants: Vec<(&'static str, f64)>,
    /// What it does.
    pub stage: Stage,
}

/// What a pipeline does.
#[derive(Debug)]
pub enum Stage {
    /// Computes, from this entry point.
    Compute(&'static str),
    /// Draws.
    Draw(Draw),
}

/// What a pipeline that draws is made of.
#[derive(Debug)]
pub struct Draw {
    /// Entry point of the vertex shader.
    pub vertex: &'static str,
    /// Entry point of the fragment shader.
    pub fragment: Option<&'static str>,
    /// Vertex buffers.
    pub buffers: Vec<Option<wgpu::VertexBufferLayout<'static>>>,
    /// What vertices make.
    pub topology: wgpu::PrimitiveTopology,
    /// What is drawn into.
    pub targets: Vec<Option<wgpu::ColorTargetState>>,
    /// The depth test.
    pub depth: Option<wgpu::DepthStencilState>,
}

impl Draw {
    /// Triangles of these entry points without vertex buffers, into no target, without a depth test.
    pub fn new(vertex: &'static str, fragment: Option<&'static str>) -> Self {
        Self {
            vertex,
            fragment,
            buffers: Vec::new(),
            topology: wgpu::PrimitiveTopology::TriangleList,
            targets: Vec::new(),
            depth: None,
        }
    }
}

/// A depth test.
pub fn depth_test(compare: wgpu::CompareFunction, writes: bool) -> wgpu::DepthStencilState {
    wgpu::DepthStencilState {
        format: DEPTH,
        depth_write_enabled: Some(writes),
        depth_compare: Some(compare),
        stencil: wgpu::StencilState::default(),
        bias: wgpu::DepthBiasState::default(),
    }
}

/// A target with all channels written.
pub fn target(format: wgpu::TextureFormat, blend: Option<wgpu::BlendState>) -> Option<wgpu::ColorTargetState> {
    Some(wgpu::ColorTargetState { format, blend, write_mask: wgpu::ColorWrites::ALL })
}

/// 1 where something is on: a constant of a pipeline.
pub fn flag(on: bool) -> f64 {
    f64::from(u8::from(on))
}

/// The words of those that are on, each with a space before it.
pub fn words(list: &[(bool, &str)]) -> String {
    list.iter().filter(|(on, _)| *on).map(|(_, name)| format!(" {name}")).collect()
}

/// A [`PipelineKey`] of any type.
pub trait AnyKey: Debug + Send + Sync {
    /// [`PipelineKey::name`].
    fn name(&self) -> String;
    /// [`PipelineKey::parts`].
    fn parts(&self, sums: wgpu::TextureFormat) -> Parts;
    /// The value itself.
    fn as_any(&self) -> &dyn Any;
    /// Whether both are the same.
    fn is(&self, other: &dyn AnyKey) -> bool;
    /// Feeds a hasher.
    fn feed(&self, hasher: &mut dyn Hasher);
}

impl<K: PipelineKey> AnyKey for K {
    fn name(&self) -> String {
        PipelineKey::name(self)
    }

    fn parts(&self, sums: wgpu::TextureFormat) -> Parts {
        PipelineKey::parts(self, sums)
    }

    fn as_any(&self) -> &dyn Any {
        self
    }

    fn is(&self, other: &dyn AnyKey) -> bool {
        other.as_any().downcast_ref::<K>() == Some(self)
    }

    fn feed(&self, mut hasher: &mut dyn Hasher) {
        self.hash(&mut hasher);
    }
}

impl PartialEq for dyn AnyKey {
    fn eq(&self, other: &Self) -> bool {
        self.is(other)
    }
}

impl Eq for dyn AnyKey {}

impl Hash for dyn AnyKey {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.feed(state);
    }
}

/// A key of any pass, kept.
#[derive(Clone)]
pub struct Key(Arc<dyn AnyKey>);

impl<K: PipelineKey> From<K> for Key {
    fn from(key: K) -> Self {
        Self(Arc::new(key))
    }
}

impl Deref for Key {
    type Target = dyn AnyKey;

    fn deref(&self) -> &Self::Target {
        &*self.0
    }
}

impl Borrow<dyn AnyKey + 'static> for Key {
    fn borrow(&self) -> &(dyn AnyKey + 'static) {
        &*self.0
    }
}

impl PartialEq for Key {
    fn eq(&self, other: &Self) -> bool {
        **self == **other
    }
}

impl Eq for Key {}

impl Hash for Key {
    fn hash<H: Hasher>(&self, state: &mut H) {
        (**self).hash(state);
    }
}

impl Debug for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        (**self).fmt(f)
    }
}
