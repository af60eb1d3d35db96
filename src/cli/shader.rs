//! `veduta shader`: the generated WGSL of a scene.

use std::path::PathBuf;

use clap::Args;

use crate::{
    cli::{
        arguments::GlobalArguments,
        failure::{Failure, Outcome},
        output,
        render::{
            self,
            arguments::{Shaders, Size, scene_among},
        },
    },
    render::frame::ShaderPart,
};

const EXAMPLES: &str = "\
Examples:
  veduta shader scene.toml
  veduta shader scene.toml --shaders uber
  veduta shader scene.toml --module geometry    what hides things
  veduta shader scene.toml --set lens.0.enabled=false > plain.wgsl

What is printed is what the graphics card gets where the scene's lenses are in the picture (where there is none: the whole
picture), validated; lens names are in comments.";

/// Arguments of `veduta shader`.
#[derive(Args, Clone, Debug, Default)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// One scene (.toml), or city files
    #[arg(required = true, value_name = "SCENE|FILE")]
    pub files: Vec<PathBuf>,
    /// Change the scene, as for `render`
    #[arg(long = "set", value_name = "PATH=VALUE")]
    pub settings: Vec<String>,
    /// Width and height in pixels: which lenses are in the picture may depend on it
    #[arg(long, value_name = "WxH")]
    pub size: Option<Size>,
    /// Which back end
    #[arg(long, value_name = "HOW", value_enum, default_value_t)]
    pub shaders: Shaders,
    /// Which module
    #[arg(long, value_name = "WHICH", value_enum, default_value_t)]
    pub module: Part,
}

/// Modules that a scene's lenses have a part in.
#[derive(clap::ValueEnum, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Part {
    /// How what is shown looks: styles, materials, light
    #[default]
    Shade,
    /// What is there: hidings such as eraser and wireframe
    Geometry,
    /// What casts a shadow
    Shadow,
    /// Edges as lines: wireframe, hidden-line
    Lines,
    /// What is translucent: opacity rules such as transparent and x-ray
    Layers,
    /// Translucent layers, one over the other
    Composite,
}

impl From<Part> for ShaderPart {
    fn from(part: Part) -> Self {
        match part {
            Part::Shade => Self::Shade,
            Part::Geometry => Self::Geometry,
            Part::Shadow => Self::Shadow,
            Part::Lines => Self::Lines,
            Part::Layers => Self::Layers,
            Part::Composite => Self::Composite,
        }
    }
}

/// Prints it.
pub fn run(arguments: &Arguments, global: &GlobalArguments) -> Outcome {
    let file = scene_among(&arguments.files);
    if file.is_some() && arguments.files.len() > 1 {
        return Err(Failure::usage("shader: one scene (.toml) or any number of city files"));
    }
    let options = render::options_of(file, global);
    let (mut scene, of_camera) = render::scene_of(&arguments.files, &arguments.settings, &options)?;
    if let Some(size) = arguments.size {
        scene.figure.set_pixels(size.0);
    }
    let (studio, _) = render::open(&scene, &options, &[], global)?;
    let scene = render::with_camera(scene, &of_camera, &studio)?;
    let scene = studio.on_ground(&scene).map_err(Failure::failed)?;
    let text = studio
        .shader(&scene, scene.figure.pixels(), arguments.shaders.into(), arguments.module.into())
        .map_err(Failure::failed)?;
    output::print(&text)
}
