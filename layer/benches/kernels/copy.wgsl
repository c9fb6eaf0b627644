// Baseline of the comparison: every texel read once and written once, by the same workgroups as the kernels of pictures.

@group(0) @binding(0) var picture: texture_2d<f32>;
@group(0) @binding(1) var<storage, read_write> copied: array<vec4<f32>>;

@compute @workgroup_size(64)
fn copy(@builtin(global_invocation_id) id: vec3<u32>) {
    let extent = textureDimensions(picture);
    if any(id.xy >= extent) {
        return;
    }
    copied[id.y * extent.x + id.x] = textureLoad(picture, id.xy, 0);
}
