//! Passes over parts of the picture that read what geometry left.

use crate::render::{
    pass::context::FrameContext,
    picture_parts::Piece,
    resource::{
        key::AnyKey,
        recording::{Counted, DrawnPass, Recording, Shaded, scissor},
    },
};

/// A pass over the picture: its colour if it has one, and its depth.
pub struct PicturePass<'a> {
    pub name: &'static str,
    pub color: Option<wgpu::RenderPassColorAttachment<'a>>,
    pub depth: wgpu::RenderPassDepthStencilAttachment<'a>,
}

impl PicturePass<'_> {
    /// Records it, with what shading reads bound and the mesh of the picture's parts.
    pub fn record(
        self,
        frame: &FrameContext,
        recording: &mut Recording,
        draw: impl FnOnce(&mut wgpu::RenderPass) -> Counted,
    ) {
        let groups = frame.groups;
        let color = [self.color];
        let pass = DrawnPass {
            name: self.name,
            view: "main",
            lenses: &[],
            shaded: Shaded::Counted,
            colors: if color[0].is_some() { &color } else { &[] },
            depth: Some(self.depth),
        };
        recording.draw(pass, |pass| {
            pass.set_bind_group(0, &groups.view, &[]);
            pass.set_bind_group(1, &groups.shade, &[]);
            pass.set_bind_group(2, &groups.lenses, &[]);
            pass.set_vertex_buffer(0, frame.shared.mesh.buffer().slice(..));
            draw(pass)
        });
    }
}

/// Draws pieces of the picture, of the context (part 0) or of the lenses (part 1).
pub fn draw_pieces(
    frame: &FrameContext,
    pass: &mut wgpu::RenderPass,
    key: &(dyn AnyKey + 'static),
    part: u32,
    pieces: &[Piece],
) -> Counted {
    let mut drawn = pieces.iter().filter(|(corners, tile)| !corners.is_empty() && !tile.is_empty()).peekable();
    let mut counted = Counted::NONE;
    if drawn.peek().is_some() {
        pass.set_pipeline(frame.pipelines.get(key));
    }
    for (corners, tile) in drawn {
        scissor(pass, *tile);
        pass.draw(corners.clone(), part..part + 1);
        counted += Counted::corners(corners.len() as u32);
    }
    counted
}
