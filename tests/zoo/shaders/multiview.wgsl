// Vertices for both views in one pass. The fragments are forward.wgsl's.

struct Sky {
    @builtin(position) position: vec4<f32>,
    @location(0) direction: vec3<f32>,
}

@vertex
fn boxes_vs(
    @builtin(vertex_index) vertex: u32,
    @builtin(instance_index) number: u32,
    @builtin(view_index) view: u32,
) -> Surface {
    return box_vertex(vertex, number, view);
}

// All of the screen by four triangles around its middle, corner `vertex` of 12, in clip space. Not by one triangle that
// reaches beyond the screen: llvmpipe 22.3 draws the clipped triangle to the first view only.
fn fan(vertex: u32) -> vec2<f32> {
    var corners = array(vec2(-1.0, -1.0), vec2(1.0, -1.0), vec2(1.0, 1.0), vec2(-1.0, 1.0));
    let corner = vertex % 3u;
    return select(corners[(vertex / 3u + corner) % 4u], vec2(0.0), corner == 2u);
}

@vertex
fn sky_vs(@builtin(vertex_index) vertex: u32, @builtin(view_index) view: u32) -> Sky {
    let clip = fan(vertex);
    return Sky(vec4(clip, draw.far, 1.0), direction(view, clip));
}

@vertex
fn screen_vs(@builtin(vertex_index) vertex: u32) -> @builtin(position) vec4<f32> {
    return vec4(fan(vertex), 0.0, 1.0);
}
