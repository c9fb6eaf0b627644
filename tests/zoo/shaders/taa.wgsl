// Temporal anti-aliasing, and exposure by the mean luminance of the whole picture.

@group(0) @binding(1) var now: texture_2d<f32>;
@group(0) @binding(2) var history: texture_2d<f32>;
@group(0) @binding(3) var luminance: texture_2d<f32>;
@group(0) @binding(3) var rates: texture_2d<u32>;
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

// The history, kept to the range of the neighbours, and a tenth of the new picture; the first frame has no history.
fn accumulated(at: vec2<i32>, uv: vec2<f32>, is_first: bool) -> vec4<f32> {
    let last = vec2<i32>(textureDimensions(now)) - 1;
    let color = textureLoad(now, at, 0).rgb;
    var low = color;
    var high = color;
    for (var y = -1; y <= 1; y += 1) {
        for (var x = -1; x <= 1; x += 1) {
            let near = textureLoad(now, clamp(at + vec2(x, y), vec2(0), last), 0).rgb;
            low = min(low, near);
            high = max(high, near);
        }
    }
    let before = clamp(textureSampleLevel(history, linear, uv, 0.0).rgb, low, high);
    return vec4(select(mix(before, color, 0.1), color, is_first), 1.0);
}

@fragment
fn accumulate_fs(in: Screen) -> @location(0) vec4<f32> {
    return accumulated(vec2<i32>(in.position.xy), in.uv, draw.value > 0.5);
}

// The same where a fragment is a block of pixels, as in `foliage.wgsl`; `draw.far` marks the first frame.
@fragment
fn accumulate_look_fs(in: Screen) -> @location(0) vec4<f32> {
    let side = ceil(draw.value / vec2<f32>(textureDimensions(rates)));
    let texel = textureLoad(rates, vec2<i32>(in.position.xy / exp2(ceil(log2(side)))), 0).x;
    let most = draw.count & 3u;
    let size = vec2(f32(1u << min(texel >> 2u, most)), f32(1u << min(texel & 3u, most)));
    let center = (floor(in.position.xy / size) + 0.5) * size;
    return accumulated(vec2<i32>(center), center / draw.value, draw.far > 0.5);
}

@fragment
fn luminance_fs(in: Screen) -> @location(0) vec4<f32> {
    let color = textureSampleLevel(now, linear, in.uv, 0.0).rgb;
    return vec4(log2(max(dot(color, vec3(0.2126, 0.7152, 0.0722)), 0.0001)), 0.0, 0.0, 1.0);
}

// Reinhard's operator, after the mean luminance was brought to 0.25.
@fragment
fn expose_fs(in: Screen) -> @location(0) vec4<f32> {
    let level = i32(textureNumLevels(luminance)) - 1;
    let mean = exp2(textureLoad(luminance, vec2(0), level).x);
    let color = textureLoad(now, vec2<i32>(in.position.xy), 0).rgb * (0.25 / mean);
    return vec4(color / (1.0 + dot(color, vec3(0.2126, 0.7152, 0.0722))), 1.0);
}
