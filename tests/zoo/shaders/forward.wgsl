// Drawn at once with its lighting; `draw.view` is the index of the view.

struct Sky {
    @builtin(position) position: vec4<f32>,
    @location(0) direction: vec3<f32>,
}

@vertex
fn boxes_vs(@builtin(vertex_index) vertex: u32, @builtin(instance_index) number: u32) -> Surface {
    return box_vertex(vertex, number, draw.view);
}

@fragment
fn boxes_fs(in: Surface) -> @location(0) vec4<f32> {
    let color = albedo(in.local, in.box);
    return vec4(lit(color, in.world, normalize(in.normal), frame.views[in.view].eye.xyz), 1.0);
}

@vertex
fn sky_vs(@builtin(vertex_index) vertex: u32) -> Sky {
    let clip = full_screen(vertex);
    return Sky(vec4(clip, draw.far, 1.0), direction(draw.view, clip));
}

@fragment
fn sky_fs(in: Sky) -> @location(0) vec4<f32> {
    return vec4(sky(in.direction), 1.0);
}
