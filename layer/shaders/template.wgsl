// Kernel `template`: the skipped pixels of a depth template, drawn to an image of several samples that was cleared to the depth
// of shaded ones. The viewport's depth range is the skipped pixels' depth alone.
// Reference: core/src/kernels/template.rs.

struct TemplateParams {
    width: u32,
    layer_words: u32,
    texels_in_word: u32,
    shaded: u32,
}

// Storage: lavapipe of Mesa 22.3 recompiles a shader that branches on uniforms for each dispatch.
@group(0) @binding(0) var<storage, read> params: TemplateParams;
@group(0) @binding(1) var<storage, read> depths: array<u32>;

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

@fragment
fn skipped(corner: Corner) {
    let pixel = vec2<u32>(corner.position.xy);
    let texel = pixel.y * params.width + pixel.x;
    let word = depths[corner.layer * params.layer_words + texel / params.texels_in_word];
    let bits = select(32u, 16u, params.texels_in_word == 2u);
    let value = extractBits(word, bits * (texel % params.texels_in_word), bits);
    if value == params.shaded {
        discard;
    }
}
