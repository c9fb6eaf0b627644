// Kernel `compose`: the pixels of one region, drawn over a copy of the image, tile by tile.
// Reference: core/src/kernels/compose.rs and what it calls, in the same order.

struct ComposeParams {
    rect_offset: vec2<u32>,
    rect_extent: vec2<u32>,
    plane_origin: vec2<f32>,
    plane_step: vec2<f32>,
    gaze: vec3<f32>,
    plateau: f32,
    red_weight: f32,
    blue_weight: f32,
    range_scale: f32,
    cb_bound: f32,
    cr_bound: f32,
    rim_scale: f32,
    cb_fall_off: f32,
    cr_fall_off: f32,
    radius: f32,
    strength: f32,
    gamut_floor: f32,
    gamut_ceiling: f32,
}

@group(0) @binding(0) var<uniform> params: ComposeParams;
@group(1) @binding(0) var source: texture_2d<f32>;

const TILE_SIZE: u32 = 16u;
const HALF_PI: f32 = 1.5707964;
const MIN_SHIFT: f32 = 1e-6;

// geometry::eccentricity of a point of the region, in pixels from its upper left corner, less the radius of what
// counts as looked at.
fn eccentricity(point: vec2<f32>) -> f32 {
    let direction = vec3(params.plane_origin + params.plane_step * point, -1.0);
    return atan2(length(cross(direction, params.gaze)), dot(direction, params.gaze)) - params.radius;
}

// Below 90 degrees plateau and radius are a cone, hence convex: a tile lies inside where its corners do. Beyond, any
// tile may hold the hole that is left.
fn tile_has_work(low: vec2<f32>, high: vec2<f32>) -> bool {
    let farthest = max(
        max(eccentricity(low), eccentricity(high)),
        max(eccentricity(vec2(high.x, low.y)), eccentricity(vec2(low.x, high.y))),
    );
    return farthest > params.plateau || params.plateau + params.radius >= HALF_PI;
}

// One instance a tile, as a strip of four vertices. The viewport is the region.
@vertex
fn tile(@builtin(vertex_index) vertex: u32, @builtin(instance_index) instance: u32) -> @builtin(position) vec4<f32> {
    let columns = (params.rect_extent.x + TILE_SIZE - 1u) / TILE_SIZE;
    let low = vec2(instance % columns, instance / columns) * TILE_SIZE;
    let high = min(low + TILE_SIZE, params.rect_extent);
    if !tile_has_work(vec2<f32>(low), vec2<f32>(high)) {
        return vec4(-2.0, -2.0, 0.0, 1.0);
    }
    let corner = select(low, high, vec2((vertex & 1u) != 0u, (vertex & 2u) != 0u));
    return vec4(vec2<f32>(corner) / vec2<f32>(params.rect_extent) * 2.0 - 1.0, 0.0, 1.0);
}

// chroma::Curves::gains: of Cb in x, of Cr in y. The angle is above the plateau.
fn gains(angle: f32) -> vec2<f32> {
    let e = saturate((angle - params.plateau) * params.range_scale);
    let cb = pow((1.0 - e) * (1.0 + e), params.cb_bound);
    let half = cos(HALF_PI * pow(e, params.cr_bound));
    let rim = 1.0 - e * params.rim_scale;
    let floor = exp2(-vec2(params.cb_fall_off, params.cr_fall_off) * angle);
    return max(vec2(cb, max(half * half, rim)), floor);
}

// By its bits: a compiler may take it that no number is infinite or NaN.
fn is_finite(x: f32) -> bool {
    return (bitcast<u32>(x) & 0x7f800000u) != 0x7f800000u;
}

// chroma::attenuate
fn attenuate(rgb: vec3<f32>, gain: vec2<f32>) -> vec3<f32> {
    let weights = vec3(params.red_weight, 1.0 - params.red_weight - params.blue_weight, params.blue_weight);
    let y = dot(weights, rgb);
    if !is_finite(y) {
        return rgb;
    }
    let red = rgb.r - y;
    let blue = rgb.b - y;
    let red_share = weights.r / weights.g;
    let blue_share = weights.b / weights.g;

    let without_blue = y - red_share * gain.y * red;
    let room = select(params.gamut_ceiling - without_blue, without_blue - params.gamut_floor, blue > 0.0);
    let limit = room / max(blue_share * abs(blue), MIN_SHIFT);
    let cb = min(gain.x, max(limit, gain.y));

    let lost_red = (1.0 - gain.y) * red;
    let lost_blue = (1.0 - cb) * blue;
    return vec3(rgb.r - lost_red, rgb.g + red_share * lost_red + blue_share * lost_blue, rgb.b - lost_blue);
}

// Alpha is masked off by the pipeline.
@fragment
fn pixel(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let angle = eccentricity(position.xy - vec2<f32>(params.rect_offset));
    if angle <= params.plateau {
        discard;
    }
    let rgb = textureLoad(source, vec2<i32>(position.xy), 0).rgb;
    let gain = 1.0 - params.strength * (1.0 - gains(angle));
    return vec4(attenuate(rgb, gain), 1.0);
}
