// Moves the lights: writes them into the uniforms of a frame.

@group(0) @binding(6) var<storage, read_write> uniforms: array<vec4<f32>>;

// Of the slots, and of the lights in one, in vectors of four floats.
const STRIDE: u32 = 32u;
const LIGHTS: u32 = 18u;

@compute @workgroup_size(4)
fn main(@builtin(local_invocation_index) index: u32) {
    var colors = array(vec3(1.0, 0.85, 0.6), vec3(0.6, 0.8, 1.0), vec3(1.0, 0.6, 0.7), vec3(0.7, 1.0, 0.75));
    let angle = draw.value * 0.5 + f32(index) * 1.5707964;
    let position = vec3(5.0 * cos(angle), 2.5 + 0.5 * f32(index), -7.0 + 4.0 * sin(angle));
    let at = draw.count * STRIDE + LIGHTS + 2u * index;
    uniforms[at] = vec4(position, 1.0);
    uniforms[at + 1u] = vec4(colors[index], 0.0);
}
