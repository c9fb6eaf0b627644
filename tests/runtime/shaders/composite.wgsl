// Draws composition layers, and copies sub-images and finished eyes to pictures. Each entry point fills its target with
// one triangle and computes the visible colour, texel by texel. Rows go downwards, +y is up.

struct Params {
    // From the eye's space to the space of the layer: of the submitted view, or of the quad.
    rotation: mat3x3<f32>,
    // The eye in the quad's space, in metres.
    origin: vec3<f32>,
    // MODE_*.
    mode: u32,
    // Tangents of the edges: left, right, up, down.
    target_edges: vec4<f32>,
    source_edges: vec4<f32>,
    // The sub-image: x, y, width, height in texels.
    rect: vec4<i32>,
    // Of the quad, in metres.
    quad_size: vec2<f32>,
    // In texels.
    target_size: vec2<f32>,
    array_layer: i32,
    // ALPHA_*.
    alpha: u32,
    // Whether values are linear light, which pictures are not.
    encode: u32,
    padding: u32,
}

// The view that is shown is the view that was submitted: texel by texel.
const MODE_EXACT: u32 = 0;
// The view that is shown is turned against the view that was submitted.
const MODE_PROJECTION: u32 = 1;
const MODE_QUAD: u32 = 2;

const ALPHA_OPAQUE: u32 = 0;
const ALPHA_PREMULTIPLIED: u32 = 1;
const ALPHA_STRAIGHT: u32 = 2;

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var image: texture_2d_array<f32>;
@group(0) @binding(2) var bilinear: sampler;

@vertex
fn whole_target(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return vec4(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

// Direction of a texel of the target, in the space of the layer.
fn direction(position: vec2<f32>) -> vec3<f32> {
    let uv = position / params.target_size;
    let edges = params.target_edges;
    return params.rotation * vec3(mix(edges.x, edges.y, uv.x), mix(edges.z, edges.w, uv.y), -1.0);
}

// Where the sub-image has a place, with (0, 0) at its upper left and (1, 1) at its lower right.
fn sampled(uv: vec2<f32>) -> vec4<f32> {
    let low = vec2<f32>(params.rect.xy) + 0.5;
    let high = vec2<f32>(params.rect.xy + params.rect.zw) - 0.5;
    let texel = clamp(vec2<f32>(params.rect.xy) + uv * vec2<f32>(params.rect.zw), low, high);
    return textureSampleLevel(image, bilinear, texel / vec2<f32>(textureDimensions(image)), params.array_layer, 0.0);
}

fn fetched(position: vec2<f32>) -> vec4<f32> {
    return textureLoad(image, params.rect.xy + vec2<i32>(position), params.array_layer, 0);
}

fn within(uv: vec2<f32>) -> bool {
    return all(uv >= vec2(0.0)) && all(uv <= vec2(1.0));
}

// Premultiplied colour to blend over the layers below, by the flags of XrCompositionLayerFlags.
fn blended(colour: vec4<f32>) -> vec4<f32> {
    switch params.alpha {
        case ALPHA_PREMULTIPLIED: { return colour; }
        case ALPHA_STRAIGHT: { return vec4(colour.rgb * colour.a, colour.a); }
        default: { return vec4(colour.rgb, 1.0); }
    }
}

@fragment
fn layer(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    if params.mode == MODE_EXACT {
        return blended(fetched(position.xy));
    }
    let ray = direction(position.xy);
    var uv = vec2(-1.0);
    if params.mode == MODE_QUAD {
        // Seen from its front, and in front of the eye.
        let distance = -params.origin.z / ray.z;
        let place = params.origin.xy + ray.xy * distance;
        if params.origin.z > 0.0 && distance > 0.0 {
            uv = vec2(0.5 + place.x / params.quad_size.x, 0.5 - place.y / params.quad_size.y);
        }
    } else if ray.z < 0.0 {
        let tangents = ray.xy / -ray.z;
        let edges = params.source_edges;
        uv = (tangents - edges.xz) / (edges.yw - edges.xz);
    }
    if !within(uv) {
        return vec4(0.0);
    }
    return blended(sampled(uv));
}

// The transfer function of IEC 61966-2-1.
fn srgb(linear: vec3<f32>) -> vec3<f32> {
    let x = clamp(linear, vec3(0.0), vec3(1.0));
    return select(1.055 * pow(x, vec3(1.0 / 2.4)) - 0.055, 12.92 * x, x <= vec3(0.0031308));
}

// A sub-image, or an eye (whose alpha is 1), as it goes into a picture.
@fragment
fn picture(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let colour = fetched(position.xy);
    if params.encode == 0u {
        return colour;
    }
    return vec4(srgb(colour.rgb), colour.a);
}
