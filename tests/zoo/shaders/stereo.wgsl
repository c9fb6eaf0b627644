// Both views in one draw, an instance each: even ones are the left view's. `viewport` becomes ViewportIndex.

struct Routed {
    @builtin(position) position: vec4<f32>,
    @location(0) world: vec3<f32>,
    @location(1) local: vec3<f32>,
    @location(2) normal: vec3<f32>,
    @location(3) @interpolate(flat) box: u32,
    @location(4) @interpolate(flat) view: u32,
    @location(7) @interpolate(flat) viewport: u32,
}

struct Sky {
    @builtin(position) position: vec4<f32>,
    @location(0) direction: vec3<f32>,
    @location(7) @interpolate(flat) viewport: u32,
}

@vertex
fn boxes_vs(@builtin(vertex_index) vertex: u32, @builtin(instance_index) instance: u32) -> Routed {
    let view = instance % 2u;
    let s = box_vertex(vertex, instance / 2u, view);
    return Routed(s.position, s.world, s.local, s.normal, s.box, s.view, view);
}

@vertex
fn sky_vs(@builtin(vertex_index) vertex: u32, @builtin(instance_index) view: u32) -> Sky {
    let clip = full_screen(vertex);
    return Sky(vec4(clip, draw.far, 1.0), direction(view, clip), view);
}
