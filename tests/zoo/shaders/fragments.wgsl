// Fragments of boxes that differ from the usual ones.

struct Deep {
    @location(0) color: vec4<f32>,
    @builtin(frag_depth) depth: f32,
}

fn shaded(in: Surface) -> vec3<f32> {
    return lit(albedo(in.local, in.box), in.world, normalize(in.normal), frame.views[in.view].eye.xyz);
}

// Depth from the shader: the same as without it.
@fragment
fn depth_fs(in: Surface) -> Deep {
    return Deep(vec4(shaded(in), 1.0), in.position.z);
}

// Holes with soft edges in the boxes, but not in floor and wall.
@fragment
fn coverage_fs(in: Surface) -> @location(0) vec4<f32> {
    let hole = smoothstep(0.3, 0.4, noise(in.local * 9.0 + f32(in.box)));
    return vec4(shaded(in), select(hole, 1.0, in.box < 2u));
}

// A board with rows of text-like strokes.
@fragment
fn board_fs(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let at = vec2<u32>(position.xy);
    let stroke = at.y % 6u < 3u && random(at.x / 2u + 977u * (at.y / 6u), 0u) > 0.4;
    return vec4(vec3(select(0.8, 0.05, stroke)), 1.0);
}

// A mesh in clip space, at the near plane.
@vertex
fn near_vs(@location(0) clip: vec2<f32>) -> @builtin(position) vec4<f32> {
    return vec4(clip, 0.0, 1.0);
}
