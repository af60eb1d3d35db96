// The eye, of passes that read it where they need it; shading carries it (`pass/shade.wgsl`).

@group(0) @binding(0) var<uniform> view: View;
