//! Translucent fragments drawn: what `pass/layers.wgsl` and `pass/translucent.wgsl` leave open.

use crate::shader::template::Template;

/// When a fragment is compared with what is opaque.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum DepthTest {
    /// By the depth test, before the shader.
    Early,
    /// By the shader too, since the depth test may come after it, when the fragment is noted already.
    InShader,
    /// By the depth test, before the shader or after it: nothing is noted.
    Any,
}

impl DepthTest {
    /// The test of a pass that notes fragments; `is_early`: whether the adapter can test depth before the shader.
    pub(super) fn of_nodes(is_early: bool) -> Self {
        if is_early { Self::Early } else { Self::InShader }
    }
}

/// Fills the hooks of the entry points; `leave` is the statement with which a fragment goes that is behind.
pub(super) fn filled<'a>(text: Template<'a>, test: DepthTest, leave: &str) -> Template<'a> {
    let early = if test == DepthTest::Early { " @early_depth_test(force)" } else { "" };
    let behind = match test {
        DepthTest::InShader => {
            format!("    if textureLoad(opaque_depth, vec2i(in.clip.xy), 0) >= in.clip.z {{\n        {leave}\n    }}\n")
        }
        DepthTest::Early | DepthTest::Any => String::new(),
    };
    text.fill("early", early).fill("behind", behind)
}

/// The opaque depth, read from a binding of its own.
pub(super) const OPAQUE_DEPTH: &str = "@group(0) @binding(3) var opaque_depth: texture_depth_2d;\n";

/// Compares a fragment whose depth is that of its plane with the opaque depth in this texture.
pub(super) fn behind_plane(texture: &str) -> String {
    format!("    if textureLoad({texture}, vec2i(in.clip.xy), 0) > depth {{\n        discard;\n    }}\n")
}
