// Kernel `change`: how much what tiles show differs from what an earlier picture shows in the same directions.
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
}

// Storage: lavapipe of Mesa 22.3 compiles a shader that branches on uniforms anew for each dispatch.
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

@compute @workgroup_size(64)
fn change(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= params.count {
        return;
    }
    let word = tiles[params.first.x + id.x];
    let tile = vec2(f32(word & 0xffffu), f32(word >> 16u));
    var greatest = 0.0;
    var light = 0.0;
    for (var part = 0u; part < 4u; part++) {
        var sums = vec2(0.0);
        var low = vec2(LARGEST_COMPONENT);
        var high = vec2(0.0);
        for (var tap = 0u; tap < 4u; tap++) {
            let at = tile + (2.0 * quarter(part) + quarter(tap) + 0.5) / 4.0;
            let point = max(min(at * params.tile_size, params.extent - 1.0), vec2(0.0));
            let here = (point + params.offset) * params.pixel;
            let found = params.to_earlier[0] * point.x + params.to_earlier[1] * point.y + params.to_earlier[2];
            let values = vec2(
                luminance(textureSampleLevel(newest, between_newest, here, 0.0)),
                luminance(textureSampleLevel(earlier, between_earlier, found.xy / found.z, 0.0)),
            );
            sums += values;
            low = min(low, values);
            high = max(high, values);
        }
        let spread = high - low;
        greatest = max(greatest, abs(sums.x - sums.y) / 4.0 - params.noise * max(spread.x, spread.y));
        light += sums.x + sums.y;
    }
    changes[params.first.y + id.x] = greatest / (light / 32.0 + params.dark);
}
