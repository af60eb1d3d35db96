//! Forms of volumes: a file and a row of the table each.

pub mod body;
mod convex;
pub mod cylinder;
pub mod ellipsoid;
mod flat;
pub mod frustum;
pub mod given;
pub mod oriented_box;
mod solid;
pub mod sphere;

use crate::geom::shape::{flat::Flat, form::body::Body, hull::Hull, solid::PlacedSolid};

/// The table of forms: `FORM(TYPE) = "name", EXTENT;`. The type is its [`Body`]; the name is that of the WGSL file in `shaders/shape`, in which
/// the struct has the form's name; how far it extends is an [`Extent`]. Handed to a macro, which makes its own of it.
macro_rules! volume_forms {
    ($take:ident) => {
        $take! {
            Sphere(sphere::Sphere) = "sphere", Convex;
            Box(oriented_box::OrientedBox) = "box", Convex;
            Cylinder(cylinder::Cylinder) = "cylinder", Convex;
            Convex(Hull) = "convex", Convex;
            Ellipsoid(ellipsoid::Ellipsoid) = "ellipsoid", Convex;
            Frustum(frustum::Frustum) = "frustum", Convex;
            Solid(PlacedSolid) = "solid", Faces;
            Flat(Flat) = "flat", Endless;
        }
    };
}
pub(crate) use volume_forms;

/// Forms that scene files give by their fields ([`given::Given`]), in the order of the docs. Handed to a macro, as [`volume_forms`].
macro_rules! given_forms {
    ($take:ident) => {
        $take! {
            $crate::geom::shape::form::sphere::Sphere;
            $crate::geom::shape::form::ellipsoid::Ellipsoid;
            $crate::geom::shape::form::oriented_box::OrientedBox;
            $crate::geom::shape::form::cylinder::Cylinder;
        }
    };
}
pub(crate) use given_forms;

/// A type that is the body of a form.
pub trait OfVolume: Sized {
    /// A volume's body, if it is of this form.
    fn of_volume(volume: &Volume) -> Option<&Self>;
}

/// How far a form extends, and so how it is asked.
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
    ($($form:ident($body:ty) = $name:literal, $extent:ident;)*) => {
        /// A checked shape with what its tests need worked out once.
        #[derive(Clone, Debug, PartialEq)]
        pub enum Volume {
            $(#[doc = concat!("A ", $name, ".")] $form($body),)*
        }

        impl Volume {
            /// Its form.
            pub fn form(&self) -> VolumeForm {
                match self {
                    $(Self::$form(_) => VolumeForm::$form,)*
                }
            }

            /// The body that answers for it.
            pub(super) fn body(&self) -> &dyn Body {
                match self {
                    $(Self::$form(body) => body,)*
                }
            }

            /// [`Self::body`], to change it.
            pub(super) fn body_mut(&mut self) -> &mut dyn Body {
                match self {
                    $(Self::$form(body) => body,)*
                }
            }
        }

        $(
            impl From<$body> for Volume {
                fn from(body: $body) -> Self {
                    Self::$form(body)
                }
            }

            impl OfVolume for $body {
                fn of_volume(volume: &Volume) -> Option<&Self> {
                    match volume {
                        Volume::$form(body) => Some(body),
                        _ => None,
                    }
                }
            }
        )*

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

            /// How far it extends.
            pub fn extent(self) -> Extent {
                match self {
                    $(Self::$form => Extent::$extent,)*
                }
            }
        }
    };
}
volume_forms!(declare);

#[cfg(test)]
mod tests;
