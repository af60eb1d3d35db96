//! Faults of a file that could be lived with: a documented, closed table of codes.

use std::collections::BTreeMap;

use crate::text::one_line;

macro_rules! warning_codes {
    ($($(#[doc = $doc:literal])+ $name:ident = $code:literal,)*) => {
        /// The closed table of warning codes (`info --json`, `warnings[].code`).
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum WarningCode { $($(#[doc = $doc])+ $name,)* }

        impl WarningCode {
            /// Every code, in the order of the table.
            pub const ALL: &[Self] = &[$(Self::$name,)*];

            /// The stable code as it stands in JSON.
            pub fn code(self) -> &'static str {
                match self { $(Self::$name => $code,)* }
            }

            /// One sentence that says what happened and what was done about it.
            pub fn meaning(self) -> &'static str {
                match self { $(Self::$name => concat!($($doc),+).trim_ascii(),)* }
            }
        }
    };
}

warning_codes! {
    /// Two city objects share an id; later ones are renamed `ID#2`, `ID#3`, ...
    DuplicateId = "duplicate-id",
    /// A parent or child that is not in the file is named; the link is dropped.
    DanglingLink = "dangling-link",
    /// An object is its own ancestor; the link that closes the cycle is dropped.
    CyclicParents = "cyclic-parents",
    /// A vertex index points past the vertex list; the face is dropped.
    VertexIndex = "vertex-index-out-of-range",
    /// A coordinate is NaN, infinite or farther than 1e9 m (height: 1e6 m) from the origin; its faces are dropped.
    BadCoordinate = "bad-coordinate",
    /// A ring has fewer than three distinct points; the ring (and the face, if outer) is dropped.
    ShortRing = "short-ring",
    /// A face has no area; it is dropped.
    ZeroArea = "zero-area",
    /// A ring crosses itself or another ring of its face; the face is dropped.
    SelfCrossing = "self-crossing",
    /// No triangulation of the face has exactly its area; the face is dropped.
    AreaMismatch = "area-mismatch",
    /// A face is not planar; it is drawn as its canonical triangulation.
    NonPlanar = "non-planar",
    /// The same shape is given twice in one object; it is drawn once.
    DuplicateShape = "duplicate-shape",
    /// A geometry is of a type that is not known or is malformed; it is skipped.
    BadGeometry = "bad-geometry",
    /// A geometry names a template that does not exist; it is skipped.
    TemplateIndex = "template-index-out-of-range",
    /// A texture image is missing or unreadable; the material's colour is used.
    MissingTexture = "missing-texture",
    /// A material or texture index points past its list; it is ignored.
    AppearanceIndex = "appearance-index-out-of-range",
    /// A semantics index points past the surface list, or the semantics do not match the boundaries; they are ignored.
    SemanticsMismatch = "semantics-mismatch",
    /// The file lacks the transform its version requires; its numbers are taken as metres.
    MissingTransform = "missing-transform",
    /// The file is damaged after this point; what came before is shown.
    TruncatedFile = "truncated-file",
    /// An attribute is beyond what its type holds; it is kept as text.
    AttributeRange = "attribute-range",
    /// The coordinate reference system is not understood; coordinates are used as they are.
    UnknownCrs = "unknown-crs",
    /// The files of one city name different coordinate reference systems.
    CrsMismatch = "crs-mismatch",
    /// A path leaves the folders the user named; it is not followed (see `--allow-outside`).
    OutsidePath = "outside-path",
    /// Something the format allows is not drawn by this version (named in the message).
    Unsupported = "unsupported",
    /// A member or line is malformed and was skipped (named in the message).
    Malformed = "malformed",
}

/// The number of objects that a warning names.
const NAMED_OBJECTS: usize = 8;

/// All occurrences of one code.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Warning {
    /// The number of times that it happened.
    pub count: u64,
    /// Ids of the first objects it happened to, at most eight.
    pub objects: Vec<String>,
    /// The first occurrence in words: file, place, what would be right.
    pub message: String,
}

/// Warnings gathered while loading, one entry per code, in the order of the table.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Warnings {
    entries: BTreeMap<WarningCode, Warning>,
}

impl Warnings {
    /// Notes one occurrence; `object` is the id it happened to, empty for none.
    pub fn add(&mut self, code: WarningCode, object: &str, message: impl FnOnce() -> String) {
        let entry = self.entries.entry(code).or_default();
        if entry.count == 0 {
            entry.message = one_line(&message());
        }
        entry.count += 1;
        if !object.is_empty() && entry.objects.len() < NAMED_OBJECTS && !entry.objects.iter().any(|o| o == object) {
            entry.objects.push(object.to_owned());
        }
    }

    /// Appends what another list (a later file, a later chunk) gathered.
    pub fn append(&mut self, other: Self) {
        for (code, theirs) in other.entries {
            let entry = self.entries.entry(code).or_default();
            if entry.count == 0 {
                entry.message = theirs.message;
            }
            entry.count += theirs.count;
            for object in theirs.objects {
                if entry.objects.len() < NAMED_OBJECTS && !entry.objects.contains(&object) {
                    entry.objects.push(object);
                }
            }
        }
    }

    /// The number of times that `code` happened.
    pub fn count(&self, code: WarningCode) -> u64 {
        self.entries.get(&code).map_or(0, |w| w.count)
    }

    /// Whether nothing was noted.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// Entries in the order of the table.
    pub fn iter(&self) -> impl Iterator<Item = (WarningCode, &Warning)> {
        self.entries.iter().map(|(code, warning)| (*code, warning))
    }
}
