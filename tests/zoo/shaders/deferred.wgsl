// A G-buffer, and the lighting of it.

@group(0) @binding(1) var colors: texture_2d<f32>;
@group(0) @binding(2) var normals: texture_2d<f32>;
@group(0) @binding(3) var depths: texture_2d<f32>;
@group(0) @binding(4) var motions: texture_2d<f32>;

// Of all surfaces, exact in half floats.
const MOTION: vec2<f32> = vec2(0.25, -8.0);

struct Layers {
    @location(0) color: vec4<f32>,
    @location(1) normal: vec4<f32>,
    @location(2) motion: vec2<f32>,
}

struct Screen {
    @builtin(position) position: vec4<f32>,
    @location(0) clip: vec2<f32>,
}

@fragment
fn layers_fs(in: Surface) -> Layers {
    return Layers(vec4(albedo(in.local, in.box), 1.0), vec4(normalize(in.normal), 1.0), MOTION);
}

@vertex
fn screen_vs(@builtin(vertex_index) vertex: u32) -> Screen {
    let clip = full_screen(vertex);
    return Screen(vec4(clip, 0.0, 1.0), clip);
}

@fragment
fn lighting_fs(in: Screen) -> @location(0) vec4<f32> {
    let at = vec2<i32>(in.position.xy);
    let depth = textureLoad(depths, at, 0).x;
    if depth >= 1.0 {
        return vec4(sky(direction(draw.view, in.clip)), 1.0);
    }
    let world = frame.views[draw.view].world_from_clip * vec4(in.clip, depth, 1.0);
    let color = textureLoad(colors, at, 0).rgb;
    let normal = textureLoad(normals, at, 0).xyz;
    let light = lit(color, world.xyz / world.w, normalize(normal), frame.views[draw.view].eye.xyz);
    // Black where the motion is any other.
    let is_known = all(textureLoad(motions, at, 0).xy == MOTION);
    return vec4(select(vec3(0.0), light, is_known), 1.0);
}
