//! What the program does, feature by feature, in one binary: it is linked once. Modules need nothing of each other.

mod above_ground;
mod animate;
mod best_views;
mod bodies;
mod borders;
mod call_outs;
mod captions;
mod changes;
mod citydata;
mod cli;
mod compare;
mod contents;
mod counts;
mod deformations;
mod deformed_contents;
mod deformed_scenes;
mod derived;
mod described;
mod discard;
mod dither;
mod effects;
mod exporters;
mod facades;
mod far_views;
mod faults;
mod floors;
mod furniture;
mod gpu;
mod ground;
mod handlers;
mod layers;
#[path = "../layouts/mod.rs"]
mod layouts;
mod light;
mod lines;
mod magnified;
mod many;
mod maps;
mod materials;
mod measure;
mod members;
mod meshes;
mod occlusion;
mod outputs;
mod over_time;
mod overlay_views;
mod overlays;
mod own_handlers;
#[path = "../panes/mod.rs"]
mod panes;
mod picture;
mod placement;
mod random_scenes;
mod renderings;
mod scenes;
mod second_driver;
mod sections;
mod sheets;
mod sky;
mod sprite_files;
mod sprites;
#[path = "../studio/mod.rs"]
mod studio;
mod techniques;
mod thematic;
mod tiles;
mod time;
mod traced_rays;
mod transparency;
mod volumes;
mod warnings;
mod wrong_input;

/// The program, which draws one sample per pixel where neither a scene nor the command line says how many: few of these tests are about
/// how smooth pictures are.
fn program() -> std::process::Command {
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_veduta"));
    command.env("VEDUTA_QUALITY", "draft");
    command
}
