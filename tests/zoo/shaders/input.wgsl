// A subpass that reads the output of the previous subpass: `light` becomes an input attachment.

@group(0) @binding(7) var light: texture_2d<f32>;

@fragment
fn tonemap_fs() -> @location(0) vec4<f32> {
    let color = textureLoad(light, vec2(0, 0), 0).rgb;
    let luminance = dot(color, vec3(0.2126, 0.7152, 0.0722));
    return vec4(color * (1.0 + luminance / 16.0) / (1.0 + luminance), 1.0);
}
