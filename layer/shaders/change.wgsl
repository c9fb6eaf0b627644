// Kernel `change`: the difference between the content of tiles and an earlier picture's content in the same directions, or at the same places.
// Reference: core/src/kernels/change.rs. One thread a tile, one dispatch for each earlier picture.

struct ChangeParams {
    to_earlier: array<vec4<f32>, 3>,
    weights: vec3<f32>,
    noise: f32,
    pixel: vec2<f32>,
    offset: vec2<f32>,
    extent: vec2<f32>,
    tile_size: vec2<f32>,
    first: vec2<u32>,
    count: u32,
    dark: f32,
    parallax: vec4<f32>,
    nearness: vec4<f32>,
    depth_offset: vec2<u32>,
    depth_scale: vec2<f32>,
}

// Storage: lavapipe of Mesa 22.3 recompiles a shader that branches on uniforms for each dispatch.
@group(0) @binding(0) var<storage, read> params: ChangeParams;
// Tiles: column, and row in the upper half.
@group(0) @binding(1) var<storage, read> tiles: array<u32>;
@group(0) @binding(2) var<storage, read_write> changes: array<f32>;
@group(1) @binding(0) var newest: texture_2d<f32>;
@group(1) @binding(1) var between_newest: sampler;
@group(2) @binding(0) var earlier: texture_2d<f32>;
@group(2) @binding(1) var between_earlier: sampler;

const LARGEST_COMPONENT: f32 = 65504.0;
const INFINITY: u32 = 0x7f800000u;

// By its bits: a compiler may take it that no number is NaN.
fn component(value: f32) -> f32 {
    let is_nan = (bitcast<u32>(value) & 0x7fffffffu) > INFINITY;
    return select(clamp(value, 0.0, LARGEST_COMPONENT), 0.0, is_nan);
}

fn luminance(color: vec4<f32>) -> f32 {
    return dot(params.weights, vec3(component(color.r), component(color.g), component(color.b)));
}

fn quarter(index: u32) -> vec2<f32> {
    return vec2(f32(index & 1u), f32(index >> 1u));
}

// Statistics of the samples of a tile so far.
struct Seen {
    // Of one part: luminance in the newest and the earlier picture, added up, and its range in both.
    sums: vec2<f32>,
    low: vec2<f32>,
    high: vec2<f32>,
    // Of all parts so far.
    greatest: f32,
    light: f32,
}

fn tile_at(index: u32) -> vec2<f32> {
    let word = tiles[params.first.x + index];
    return vec2(f32(word & 0xffffu), f32(word >> 16u));
}

fn point_at(tile: vec2<f32>, part: u32, tap: u32) -> vec2<f32> {
    let at = tile + (2.0 * quarter(part) + quarter(tap) + 0.5) / 4.0;
    return max(min(at * params.tile_size, params.extent - 1.0), vec2(0.0));
}

// Where a point that is endlessly far away lies in the earlier picture, not divided.
fn homogeneous(point: vec2<f32>) -> vec3<f32> {
    let found = params.to_earlier[0] * point.x + params.to_earlier[1] * point.y + params.to_earlier[2];
    return found.xyz;
}

fn with_tap(before: Seen, point: vec2<f32>, found: vec3<f32>) -> Seen {
    let here = (point + params.offset) * params.pixel;
    let values = vec2(
        luminance(textureSampleLevel(newest, between_newest, here, 0.0)),
        luminance(textureSampleLevel(earlier, between_earlier, found.xy / found.z, 0.0)),
    );
    var seen = before;
    seen.sums += values;
    seen.low = min(seen.low, values);
    seen.high = max(seen.high, values);
    return seen;
}

fn begin_part(before: Seen) -> Seen {
    return Seen(vec2(0.0), vec2(LARGEST_COMPONENT), vec2(0.0), before.greatest, before.light);
}

fn end_part(before: Seen) -> Seen {
    var seen = before;
    let spread = seen.high - seen.low;
    let difference = abs(seen.sums.x - seen.sums.y) / 4.0 - params.noise * max(spread.x, spread.y);
    seen.greatest = max(seen.greatest, difference);
    seen.light += seen.sums.x + seen.sums.y;
    return seen;
}

fn tell(index: u32, seen: Seen) {
    changes[params.first.y + index] = seen.greatest / (seen.light / 32.0 + params.dark);
}

@compute @workgroup_size(64)
fn change(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= params.count {
        return;
    }
    let tile = tile_at(id.x);
    var seen: Seen;
    for (var part = 0u; part < 4u; part++) {
        seen = begin_part(seen);
        for (var tap = 0u; tap < 4u; tap++) {
            let point = point_at(tile, part, tap);
            seen = with_tap(seen, point, homogeneous(point));
        }
        seen = end_part(seen);
    }
    tell(id.x, seen);
}

// Of the newest picture, where the head has moved.
@group(3) @binding(0) var depth: texture_2d<f32>;

fn parallax_at(point: vec2<f32>) -> vec3<f32> {
    let pixel = params.depth_offset + vec2<u32>(point * params.depth_scale);
    let value = textureLoad(depth, vec2<i32>(pixel), 0).r;
    let nearness = params.nearness.x + params.nearness.y * min(max(value, params.nearness.z), params.nearness.w);
    return params.parallax.xyz * nearness;
}

// Separate from `change`: the functions that an entry point calls determine the descriptor sets that its pipeline needs.
@compute @workgroup_size(64)
fn moved_change(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= params.count {
        return;
    }
    let tile = tile_at(id.x);
    var seen: Seen;
    for (var part = 0u; part < 4u; part++) {
        seen = begin_part(seen);
        for (var tap = 0u; tap < 4u; tap++) {
            let point = point_at(tile, part, tap);
            seen = with_tap(seen, point, homogeneous(point) + parallax_at(point));
        }
        seen = end_part(seen);
    }
    tell(id.x, seen);
}
