// Post-processing: full-screen passes that read textures.

@group(0) @binding(1) var first: texture_2d<f32>;
@group(0) @binding(5) var linear: sampler;

struct Screen {
    @builtin(position) position: vec4<f32>,
    @location(0) uv: vec2<f32>,
}

@vertex
fn screen_vs(@builtin(vertex_index) vertex: u32) -> Screen {
    let clip = full_screen(vertex);
    return Screen(vec4(clip, 0.0, 1.0), clip * 0.5 + 0.5);
}

// For fragments that need nothing but where they are.
@vertex
fn bare_vs(@builtin(vertex_index) vertex: u32) -> @builtin(position) vec4<f32> {
    return vec4(full_screen(vertex), 0.0, 1.0);
}

// Reinhard's operator on luminance, with the white point at 4 (Reinhard et al. 2002, equation 4).
fn tone_mapped(color: vec3<f32>) -> vec3<f32> {
    let luminance = dot(color, vec3(0.2126, 0.7152, 0.0722));
    return color * (1.0 + luminance / 16.0) / (1.0 + luminance);
}

@fragment
fn tonemap_fs(in: Screen) -> @location(0) vec4<f32> {
    let color = textureLoad(first, vec2<i32>(in.position.xy), 0).rgb;
    return vec4(tone_mapped(color), 1.0);
}

// The picture at another size.
@fragment
fn scale_fs(in: Screen) -> @location(0) vec4<f32> {
    return vec4(textureSampleLevel(first, linear, in.uv, 0.0).rgb, 1.0);
}
