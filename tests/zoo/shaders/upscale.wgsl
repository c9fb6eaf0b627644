// Scales a picture up.

@group(0) @binding(1) var first: texture_2d<f32>;
@group(0) @binding(5) var linear: sampler;
@group(0) @binding(8) var scaled: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) at: vec3<u32>) {
    let size = textureDimensions(scaled);
    if any(at.xy >= size) {
        return;
    }
    let uv = (vec2<f32>(at.xy) + 0.5) / vec2<f32>(size);
    textureStore(scaled, at.xy, textureSampleLevel(first, linear, uv, 0.0));
}
