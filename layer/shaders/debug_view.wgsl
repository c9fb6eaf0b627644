// Kernel `debug_view`: the decisions, blended over an eye's finished picture.
// Reference: core/src/kernels/debug_view.rs, with the same names.

struct DebugViewParams {
    rect_offset: vec2<u32>,
    rect_extent: vec2<u32>,
    plane_origin: vec2<f32>,
    plane_step: vec2<f32>,
    gaze: vec3<f32>,
    view: u32,
    map_extent: vec2<u32>,
    texel: vec2<u32>,
    tiles: vec2<u32>,
    first_word: u32,
    is_upside_down: u32,
}

@group(0) @binding(0) var<uniform> params: DebugViewParams;
// Maps, a byte for each tile.
@group(0) @binding(2) var<storage, read> words: array<u32>;

const TINT: f32 = 0.4;
const FAINT: f32 = 0.25;
const LINE: f32 = 0.85;
const OLDEST: u32 = 6u;
const RING_DEG: f32 = 10.0;
const RING_HALF_DEG: f32 = 0.2;
const FAR_DEG: f32 = 60.0;
const DOT_DEG: f32 = 1.0;
const DOT_LINE_DEG: f32 = 1.3;
const NOTHING: vec4<f32> = vec4(0.0);

// The viewport is the picture.
@vertex
fn corner(@builtin(vertex_index) vertex: u32) -> @builtin(position) vec4<f32> {
    let at = vec2(f32(vertex & 1u), f32(vertex >> 1u));
    return vec4(at * 2.0 - 1.0, 0.0, 1.0);
}

// By its tangent: an arc cosine is inexact where the angle is small.
fn degrees_from_gaze(pixel: vec2<u32>) -> f32 {
    let point = vec2<f32>(pixel) + 0.5;
    let direction = vec3(params.plane_origin + params.plane_step * point, -1.0);
    return degrees(atan2(length(cross(params.gaze, direction)), dot(params.gaze, direction)));
}

fn tile(pixel: vec2<u32>) -> u32 {
    let upwards = params.rect_extent.y - 1u - pixel.y;
    let from_top = vec2(pixel.x, select(pixel.y, upwards, params.is_upside_down == 1u));
    let tile = min(from_top * params.map_extent / params.rect_extent / params.texel, params.tiles - 1u);
    let row_bytes = (params.tiles.x + 3u) / 4u * 4u;
    let index = tile.y * row_bytes + tile.x;
    return (words[params.first_word + index / 4u] >> (index % 4u * 8u)) & 0xffu;
}

// Colour and opacity.
fn of_rate(texel: u32) -> vec4<f32> {
    let width = (texel >> 2u) & 3u;
    let height = texel & 3u;
    if width > 2u || height > 2u {
        return NOTHING;
    }
    switch width + height {
        case 1u: { return vec4(0.1946, 0.6376, 0.0823, TINT); }
        case 2u: { return vec4(0.0160, 0.3916, 0.2307, TINT); }
        case 3u: { return vec4(0.0232, 0.1878, 0.2705, TINT); }
        case 4u: { return vec4(0.0529, 0.0578, 0.2423, TINT); }
        default: { return NOTHING; }
    }
}

fn of_age(frames: u32) -> vec4<f32> {
    if frames == 0u {
        return NOTHING;
    }
    let age = f32(min(frames, OLDEST) - 1u) / f32(OLDEST - 1u);
    return vec4(1.0, 0.8 * (1.0 - age), 0.0, TINT);
}

fn of_angle(angle: f32) -> vec4<f32> {
    let ring = floor(angle / RING_DEG + 0.5);
    if ring >= 1.0 && abs(angle - ring * RING_DEG) < RING_HALF_DEG {
        return vec4(1.0, 1.0, 1.0, LINE);
    }
    let far = min(angle / FAR_DEG, 1.0);
    return vec4(far, 1.0 - far, 0.0, FAINT);
}

fn of_dot(angle: f32) -> vec4<f32> {
    if angle < DOT_DEG {
        return vec4(1.0, 0.0, 0.0, LINE);
    }
    if angle < DOT_LINE_DEG {
        return vec4(1.0, 1.0, 1.0, LINE);
    }
    return NOTHING;
}

fn at(position: vec4<f32>) -> vec2<u32> {
    return vec2<u32>(position.xy) - params.rect_offset;
}

// The pipeline adds this to the picture times one minus alpha, and keeps the picture's own alpha.
fn blended(colour: vec4<f32>) -> vec4<f32> {
    if colour.a == 0.0 {
        discard;
    }
    return vec4(colour.rgb * colour.a, colour.a);
}

// One entry point for each view, and no branch on parameters alone: software devices make a new shader whenever those change.
// Nothing is drawn without a map, or without a gaze.
@fragment
fn rates(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    return blended(of_rate(tile(at(position))));
}

@fragment
fn eccentricity(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    return blended(of_angle(degrees_from_gaze(at(position))));
}

@fragment
fn age(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    return blended(of_age(tile(at(position))));
}

@fragment
fn gaze(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    return blended(of_dot(degrees_from_gaze(at(position))));
}
