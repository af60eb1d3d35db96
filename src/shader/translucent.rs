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

/// Fills the hooks of the entry points. `opaque`: the texture that the opaque depth can be read from; `leave`: the statement with which a
/// fragment goes that is behind.
///
/// What a content shows is tested by the shader wherever that can read: it must be before the plane of what is opaque.
pub(super) fn filled<'a>(
    text: Template<'a>,
    test: DepthTest,
    has_contents: bool,
    opaque: Option<&str>,
    leave: &str,
) -> Template<'a> {
    let early = if test == DepthTest::Early { " @early_depth_test(force)" } else { "" };
    let behind = match opaque.filter(|_| has_contents || test == DepthTest::InShader) {
        Some(texture) => format!(
            "    let room = room_before_opaque(in.clip.z, vec2f(dpdx(in.clip.z), dpdy(in.clip.z)));\n    \
             if textureLoad({texture}, vec2i(in.clip.xy), 0) >= in.clip.z - room {{\n        {leave}\n    }}\n"
        ),
        None => String::new(),
    };
    text.fill("early", early).fill("behind", behind)
}

/// The opaque depth, read from a binding of its own.
pub(super) const OPAQUE_DEPTH: &str = "@group(0) @binding(3) var opaque_depth: texture_depth_2d;\n";

/// Compares a fragment whose depth is that of its plane with the opaque depth in this texture.
pub(super) fn behind_plane(texture: &str) -> String {
    format!(
        "    if textureLoad({texture}, vec2i(in.clip.xy), 0) > depth - room_before_opaque(depth, in.plane.xy) {{\n        discard;\n    }}\n"
    )
}
