//! Forms of volumes: a row of the table each.

/// The table of forms: `FORM = "name", EXTENT;`. The name is that of the WGSL file in `shaders/shape`, in which the struct has the form's
/// name; what they extend to is an [`Extent`]. Handed to a macro, which makes of it what it needs.
macro_rules! volume_forms {
    ($take:ident) => {
        $take! {
            Sphere = "sphere", Convex;
            Box = "box", Convex;
            Cylinder = "cylinder", Convex;
            Convex = "convex", Convex;
            Ellipsoid = "ellipsoid", Convex;
            Frustum = "frustum", Convex;
            Solid = "solid", Faces;
            Flat = "flat", Endless;
        }
    };
}
pub(crate) use volume_forms;

/// What a form extends to, and so how it is asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// A ray is in it once, from an end to an end, both of which have closed forms.
    Convex,
    /// Any, by its faces.
    Faces,
    /// From a plane to infinity; it holds also where nothing is, and the eye's rays alone say what.
    Endless,
}

macro_rules! declare {
    ($($form:ident = $name:literal, $extent:ident;)*) => {
        /// Forms of volumes.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum VolumeForm {
            $(#[doc = concat!("`shaders/shape/", $name, ".wgsl`.")] $form,)*
        }

        impl VolumeForm {
            /// All of them, in order.
            pub const ALL: &[Self] = &[$(Self::$form),*];

            /// Its name: that of its WGSL file.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$form => $name,)*
                }
            }

            /// The name of its WGSL struct.
            pub fn struct_name(self) -> &'static str {
                match self {
                    $(Self::$form => stringify!($form),)*
                }
            }

            /// What it extends to.
            pub fn extent(self) -> Extent {
                match self {
                    $(Self::$form => Extent::$extent,)*
                }
            }
        }
    };
}
volume_forms!(declare);
