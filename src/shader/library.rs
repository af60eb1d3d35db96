//! The WGSL files that modules are made of: `shaders/lib`, importable and free of side effects; `shaders/shape`, one file for each form of
//! volumes; and `shaders/pass`, one file for each entry point.

use crate::{
    geom::shape::{VolumeForm, form::volume_forms},
    shader::wgsl::function::FunctionError,
};

/// A WGSL file that comes with the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct File {
    /// Its path below `shaders`.
    pub(super) path: &'static str,
    /// Its text.
    pub(super) text: &'static str,
}

impl File {
    /// Whether some words stand in it.
    pub(super) fn says(&self, words: &str) -> bool {
        self.text.contains(words)
    }

    /// Its text as a paragraph of another.
    pub(super) fn paragraph(&self) -> String {
        format!("{}\n", self.text)
    }

    /// Its text, changed by its tokens.
    ///
    /// # Panics
    /// Where the text has not what is changed: as a hook that is not filled ([`crate::shader::template::Template::text`]).
    pub(super) fn changed(&self, change: impl FnOnce(&str) -> Result<String, FunctionError>) -> String {
        change(self.text).unwrap_or_else(|error| panic!("shaders/{}: {error}", self.path))
    }
}

macro_rules! files {
    ($($name:ident = $path:literal;)*) => {
        $(pub(super) const $name: File = File { path: $path, text: include_str!(concat!("../../shaders/", $path)) };)*

        /// All of them.
        #[cfg(test)]
        pub(super) const ALL: &[File] = &[$($name),*];
    };
}

macro_rules! form_files {
    ($($form:ident($body:ty) = $name:literal, $extent:ident;)*) => {
        /// The file of a form.
        pub(super) fn file_of(form: VolumeForm) -> File {
            match form {
                $(VolumeForm::$form => File {
                    path: concat!("shape/", $name, ".wgsl"),
                    text: include_str!(concat!("../../shaders/shape/", $name, ".wgsl")),
                },)*
            }
        }
    };
}
volume_forms!(form_files);

files! {
    VIEW = "lib/view.wgsl";
    VIEW_UNIFORM = "lib/view-uniform.wgsl";
    BENT_RAYS = "lib/bent-rays.wgsl";
    BENT_EDGES = "lib/bent-edges.wgsl";
    RAY_IMAGES = "pass/ray-images.wgsl";
    RAY_GRID = "lib/ray-grid.wgsl";
    RAYS = "pass/rays.wgsl";
    RAY_VERTICES = "pass/ray-vertices.wgsl";
    RAY_WARP = "pass/ray-warp.wgsl";
    RAY_WALK = "lib/ray-walk.wgsl";
    RAY_LAYERS = "pass/ray-layers.wgsl";
    LAYER_NODES = "lib/layer-nodes.wgsl";
    FACADE = "lib/facade.wgsl";
    SURFACE = "lib/surface.wgsl";
    COLOR = "lib/color.wgsl";
    PACKED = "lib/packed.wgsl";
    TEXEL = "lib/texel.wgsl";
    REGION = "lib/region.wgsl";
    FORM = "lib/form.wgsl";
    LIGHT = "lib/light.wgsl";
    BLEND = "lib/blend.wgsl";
    MATERIAL = "lib/material.wgsl";
    CLASS = "lib/class.wgsl";
    DITHER = "lib/dither.wgsl";
    BORDER = "lib/border.wgsl";
    BORDER_WIDTH = "lib/border-width.wgsl";
    SOLID_DISTANCE = "lib/solid-distance.wgsl";
    COMBINED_DISTANCE = "lib/combined-distance.wgsl";
    SIGHT = "lib/sight.wgsl";
    LENS = "lib/lens.wgsl";
    LENS_SPRITE = "lib/lens-sprite.wgsl";
    DEPTH_CODE = "lib/depth-code.wgsl";
    STORED_SPRITE = "lib/stored-sprite.wgsl";
    OWN_SPRITE = "lib/own-sprite.wgsl";
    STORED_PASS = "pass/stored-sprite.wgsl";
    STORED_FORM = "lib/stored-form.wgsl";
    STORED_LAYERS = "lib/stored-layers.wgsl";
    SPRITE_LIST = "pass/sprite-list.wgsl";
    CROSSING = "lib/crossing.wgsl";
    MEMBERS = "lib/members.wgsl";
    FADING_MEMBERS = "lib/fading-members.wgsl";
    FADING_OUTLINE = "lib/fading-outline.wgsl";
    MEMBER_OUTLINE = "lib/member-outline.wgsl";
    SOLID_SPRITE = "lib/solid-sprite.wgsl";
    COMBINED = "lib/combined.wgsl";
    OWN = "shape/own.wgsl";
    COMBINED_SECTION = "lib/combined-section.wgsl";
    COMBINED_SPRITE = "lib/combined-sprite.wgsl";
    COMBINED_PASS = "pass/combined-sprite.wgsl";
    OBJECTS = "lib/objects.wgsl";
    MOMENT = "lib/moment.wgsl";
    LIFETIME = "lib/lifetime.wgsl";
    INSTANTS = "lib/instants.wgsl";
    MOVING = "lib/moving.wgsl";
    FIXED = "lib/fixed.wgsl";
    VARYING = "lib/varying.wgsl";
    POINT = "lib/point.wgsl";
    LINE = "lib/line.wgsl";
    TRANSPARENCY = "lib/transparency.wgsl";
    EDGE = "lib/edge.wgsl";
    ONE_CITY = "lib/one-city.wgsl";
    CITIES = "lib/cities.wgsl";
    FRAGMENT = "lib/fragment.wgsl";
    FRAGMENT_AT = "lib/fragment-at.wgsl";
    FIELDS = "lib/fields.wgsl";
    NO_FIELDS = "lib/no-fields.wgsl";
    CUT = "lib/cut.wgsl";
    OUTLINE = "lib/outline.wgsl";
    SILHOUETTE = "lib/silhouette.wgsl";
    CLEAR = "lib/clear.wgsl";
    GLASS = "lib/glass.wgsl";
    SHELL = "lib/shell.wgsl";
    SHELL_SIDES = "lib/shell-sides.wgsl";
    SHELL_SPRITE = "lib/shell-sprite.wgsl";
    HALO = "lib/halo.wgsl";
    FILTERED = "lib/filter.wgsl";
    GEOMETRY = "pass/geometry.wgsl";
    HOLE = "lib/hole.wgsl";
    SHADOW = "pass/shadow.wgsl";
    SHADOW_CUT = "pass/shadow-cut.wgsl";
    SPRITE = "pass/sprite.wgsl";
    SHADE = "pass/shade.wgsl";
    LINES = "pass/lines.wgsl";
    FRAGMENT_NODES = "lib/fragment-nodes.wgsl";
    LAYERS = "pass/layers.wgsl";
    HELD = "pass/held.wgsl";
    HELD_LAYERS = "pass/held-layers.wgsl";
    COMPOSITE = "pass/composite.wgsl";
    COUNT_LAYERS = "pass/count-layers.wgsl";
    SORT_LAYERS = "pass/sort-layers.wgsl";
    SHOWN = "pass/shown.wgsl";
    SLOTS = "lib/slots.wgsl";
    FORWARD = "lib/forward.wgsl";
    TAIL = "lib/tail.wgsl";
    CHANCE = "lib/chance.wgsl";
    TRANSLUCENT = "pass/translucent.wgsl";
    LINK_SLOTS = "pass/link-slots.wgsl";
    FILTER = "pass/filter.wgsl";
    AMBIENT_OCCLUSION = "pass/ambient-occlusion.wgsl";
    RESOLVE = "pass/resolve.wgsl";
    NARROW = "pass/narrow.wgsl";
    DEFORM = "lib/deform.wgsl";
    REFINE = "pass/refine.wgsl";
    REGIONS = "pass/regions.wgsl";
    SECTIONS = "pass/sections.wgsl";
    FURNITURE = "pass/furniture.wgsl";
    FURNITURE_OVER = "pass/furniture-over.wgsl";
    BARE = "pass/bare.wgsl";
    INVOKERS = "lib/invokers.wgsl";
    TILE_INVOKERS = "lib/invokers-of-tiles.wgsl";
    NO_CLASSES = "lib/no-classes.wgsl";
    INVOKER_CLASSES = "lib/classes-of-invokers.wgsl";
    SHARE_OF_INVOKER = "lib/share-of-invoker.wgsl";
    SHARE_AT_INVOKER = "lib/share-at-invoker.wgsl";
    LENS_COVERS = "lib/lens-covers.wgsl";
    LENS_CLEAR = "lib/lens-clear.wgsl";
    LENS_DISTANCE = "lib/lens-distance.wgsl";
    LENS_ENDS = "lib/lens-ends.wgsl";
    FRAGMENT_RUNS = "lib/fragment-runs.wgsl";
    FRAGMENT_RUNS_DITHERED = "lib/fragment-runs-dithered.wgsl";
    FRAGMENT_RUNS_EVERYWHERE = "lib/fragment-runs-everywhere.wgsl";
}
