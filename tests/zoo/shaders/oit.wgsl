// Order-independent transparency: glass is summed up in a buffer, in any order, and then laid over the picture.

// For each pixel red, green and blue weighted by alpha, and alpha, in units of 1/4096.
@group(0) @binding(6) var<storage, read_write> sums: array<atomic<u32>>;

struct Glass {
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(flat) number: u32,
}

const UNIT: f32 = 4096.0;

@vertex
fn glass_vs(@builtin(vertex_index) vertex: u32, @builtin(instance_index) number: u32) -> Glass {
    return Glass(box_vertex(vertex, number, draw.view).position, number);
}

@fragment
fn glass_fs(in: Glass) {
    let pixel = vec2<u32>(in.position.xy);
    let at = (pixel.y * draw.count + pixel.x) * 4u;
    let n = in.number;
    let color = vec3(random(n, 20u), random(n, 21u), random(n, 22u)) * 0.3;
    for (var i = 0u; i < 3u; i += 1u) {
        atomicAdd(&sums[at + i], u32(color[i] * UNIT));
    }
    atomicAdd(&sums[at + 3u], u32(0.3 * UNIT));
}

@vertex
fn screen_vs(@builtin(vertex_index) vertex: u32) -> @builtin(position) vec4<f32> {
    return vec4(full_screen(vertex), 0.0, 1.0);
}

@fragment
fn composite_fs(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let pixel = vec2<u32>(position.xy);
    let at = (pixel.y * draw.count + pixel.x) * 4u;
    let alpha = f32(atomicLoad(&sums[at + 3u])) / UNIT;
    let sum = vec3(f32(atomicLoad(&sums[at])), f32(atomicLoad(&sums[at + 1u])), f32(atomicLoad(&sums[at + 2u])));
    return vec4(sum / UNIT / max(alpha, 0.001), 1.0 - exp(-alpha));
}
