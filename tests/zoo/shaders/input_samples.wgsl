// A subpass that resolves the output of the previous subpass: `light` becomes an input attachment with four samples.

@group(0) @binding(7) var light: texture_multisampled_2d<f32>;

@fragment
fn resolve_fs() -> @location(0) vec4<f32> {
    let sum = textureLoad(light, vec2(0, 0), 0) + textureLoad(light, vec2(0, 0), 1)
        + textureLoad(light, vec2(0, 0), 2) + textureLoad(light, vec2(0, 0), 3);
    return vec4(sum.rgb / 4.0, 1.0);
}
