// Kernel `samples`: skipped pixels of pictures and of depth of several samples, drawn to all samples of a pixel at once.
// Reference: core/src/kernels/samples.rs.

struct SampleParams {
    row_words: u32,
    layer_words: u32,
    column_shift: u32,
    row_shift: u32,
    shaded: u32,
    width: u32,
    height: u32,
    padding: u32,
}

// Storage: lavapipe of Mesa 22.3 recompiles a shader that branches on uniforms for each dispatch.
@group(0) @binding(0) var<storage, read> params: SampleParams;
// The template.
@group(0) @binding(1) var<storage, read> depths: array<u32>;
// The picture, resolved and filled.
@group(0) @binding(2) var picture: texture_2d_array<f32>;
// A layer of a copy of depth.
@group(0) @binding(3) var copied: texture_depth_multisampled_2d;

// core::mask::BLOCK, core::mask::REACH
const BLOCK: i32 = 4;
const REACH: i32 = 7;

struct Corner {
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(flat) layer: u32,
}

// Three for each array layer.
@vertex
fn corner(@builtin(vertex_index) index: u32) -> Corner {
    let i = index % 3u;
    let position = vec4(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
    return Corner(position, index / 3u);
}

fn is_shaded(layer: u32, pixel: vec2<i32>) -> bool {
    let at = vec2<u32>(pixel) >> vec2(params.column_shift, params.row_shift);
    return depths[layer * params.layer_words + at.y * params.row_words + at.x] == params.shaded;
}

@fragment
fn color(corner: Corner) -> @location(0) vec4<f32> {
    let pixel = vec2<i32>(corner.position.xy);
    if is_shaded(corner.layer, pixel) {
        discard;
    }
    return textureLoad(picture, pixel, i32(corner.layer), 0);
}

fn around(distance: i32, index: i32) -> vec2<i32> {
    let along = index % (2 * distance) - distance;
    switch index / (2 * distance) {
        case 0: { return vec2(along, -distance); }
        case 1: { return vec2(distance, along); }
        case 2: { return vec2(-along, distance); }
        default: { return vec2(-distance, -along); }
    }
}

@fragment
fn depth(corner: Corner) -> @builtin(frag_depth) f32 {
    let pixel = vec2<i32>(corner.position.xy);
    if is_shaded(corner.layer, pixel) {
        discard;
    }
    let extent = vec2<i32>(vec2(params.width, params.height));
    let origin = pixel / BLOCK * BLOCK;
    var source = pixel;
    for (var distance = 1; distance <= REACH; distance++) {
        var least = 0x7fffffff;
        for (var index = 0; index < 8 * distance; index++) {
            let first = origin + around(distance, index) * BLOCK;
            let nearest = clamp(pixel, first, first + (BLOCK - 1));
            if any(nearest < vec2(0)) || any(nearest >= extent) {
                continue;
            }
            let away = nearest - pixel;
            let square = dot(away, away);
            if square < least && is_shaded(corner.layer, nearest) {
                least = square;
                source = nearest;
            }
        }
        if least != 0x7fffffff {
            break;
        }
    }
    return textureLoad(copied, source, 0);
}
