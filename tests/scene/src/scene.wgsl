// The courtyard's only shader file: lit surfaces, the sky, and the flat board of the quad layer.

struct Light {
    position: vec3f,
    inverse_range_2: f32,
    colour: vec3f,
    padding: f32,
}

struct View {
    clip_from_world: mat4x4f,
    // World-space directions of the view's corners: from the centre of clip space, to its right and up.
    ray_centre: vec3f,
    light_count: u32,
    ray_right: vec3f,
    time: f32,
    ray_up: vec3f,
    padding: f32,
    eye: vec3f,
    padding_2: f32,
}

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<uniform> lights: array<Light, 256>;
@group(0) @binding(2) var detail_map: texture_2d<f32>;
@group(0) @binding(3) var repeating: sampler;

@group(1) @binding(0) var albedo_map: texture_2d<f32>;
@group(1) @binding(1) var relief_map: texture_2d<f32>;

// 0: tone-mapped linear light (the format encodes); 1: tone-mapped and sRGB-encoded here; 2: linear light
// without an upper end (a float format).
override OUTPUT: u32 = 0;

const PI = 3.14159265;
const SUN_DIRECTION = vec3f(0.5774, 0.3849, -0.7201);
const SUN = vec3f(1.5, 1.15, 0.75);
const SKY_LIGHT = vec3f(0.14, 0.19, 0.30);
const GROUND_LIGHT = vec3f(0.09, 0.075, 0.06);

struct VertexIn {
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) tangent: vec3f,
    @location(3) uv: vec2f,
    @location(4) sky: f32,
    @location(5) world_x: vec4f,
    @location(6) world_y: vec4f,
    @location(7) world_z: vec4f,
    @location(8) world_w: vec4f,
    @location(9) emission: vec3f,
}

struct Surface {
    @builtin(position) clip: vec4f,
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) tangent: vec3f,
    @location(3) uv: vec2f,
    @location(4) sky: f32,
    @location(5) emission: vec3f,
}

@vertex
fn surface_vertex(in: VertexIn) -> Surface {
    let world = mat4x4f(in.world_x, in.world_y, in.world_z, in.world_w);
    let position = (world * vec4f(in.position, 1.0)).xyz;
    var out: Surface;
    out.clip = view.clip_from_world * vec4f(position, 1.0);
    out.position = position;
    out.normal = (world * vec4f(in.normal, 0.0)).xyz;
    out.tangent = (world * vec4f(in.tangent, 0.0)).xyz;
    out.uv = in.uv;
    out.sky = in.sky;
    out.emission = in.emission;
    return out;
}

// Cook-Torrance with the GGX distribution, Smith's height-correlated visibility in Hammon's approximation
// (GDC 2017) and Schlick's Fresnel, times the cosine; plus Lambert's diffuse term. The half vector is never
// formed: its cosines follow from v.l, n.l and n.v.
fn shade(n_v: f32, n_l: f32, v_l: f32, albedo: vec3f, alpha: f32) -> vec3f {
    let v_h = sqrt(max(0.5 + 0.5 * v_l, 1e-4));
    let n_h = min(0.5 * (n_v + n_l) / v_h, 1.0);
    let alpha_2 = alpha * alpha;
    let d = n_h * n_h * (alpha_2 - 1.0) + 1.0;
    let specular = 0.5 * alpha_2 / (PI * d * d * mix(2.0 * n_l * n_v, n_l + n_v, alpha));
    let one_minus = 1.0 - v_h;
    let square = one_minus * one_minus;
    let fresnel = 0.04 + 0.96 * square * square * one_minus;
    return (albedo * ((1.0 - fresnel) / PI) + specular * fresnel) * n_l;
}

// Inverse square, brought to zero at the range by the window of Karis (SIGGRAPH 2013).
fn falloff(distance_2: f32, inverse_range_2: f32) -> f32 {
    let ratio_2 = distance_2 * inverse_range_2;
    let window = clamp(1.0 - ratio_2 * ratio_2, 0.0, 1.0);
    return window * window / (distance_2 + 0.01);
}

fn shown(light: vec3f) -> vec4f {
    if OUTPUT == 2 {
        return vec4f(light, 1.0);
    }
    // Narkowicz's fit of the ACES curve (2015).
    let mapped = clamp(light * (2.51 * light + 0.03) / (light * (2.43 * light + 0.59) + 0.14), vec3f(0.0), vec3f(1.0));
    if OUTPUT == 1 {
        let low = mapped * 12.92;
        let high = 1.055 * pow(mapped, vec3f(1.0 / 2.4)) - 0.055;
        return vec4f(select(high, low, mapped <= vec3f(0.0031308)), 1.0);
    }
    return vec4f(mapped, 1.0);
}

@fragment
fn surface_fragment(in: Surface) -> @location(0) vec4f {
    let albedo = textureSample(albedo_map, repeating, in.uv).rgb;
    let relief = textureSample(relief_map, repeating, in.uv);
    let tilt = relief.xyz * 2.0 - 1.0;
    let n = normalize(in.tangent * tilt.x + cross(in.normal, in.tangent) * tilt.y + in.normal * tilt.z);
    let v = normalize(view.eye - in.position);
    let n_v = max(dot(n, v), 1e-3);
    let alpha = relief.a * relief.a;

    var light = in.emission * albedo;
    light += albedo * mix(GROUND_LIGHT, SKY_LIGHT, 0.5 + 0.5 * n.y) * in.sky;
    let sun = shade(n_v, max(dot(n, SUN_DIRECTION), 1e-4), dot(v, SUN_DIRECTION), albedo, alpha);
    light += sun * SUN * in.sky;
    for (var i = 0u; i < view.light_count; i++) {
        let lamp = lights[i];
        let to_lamp = lamp.position - in.position;
        let distance_2 = dot(to_lamp, to_lamp);
        let l = to_lamp * inverseSqrt(distance_2);
        let reflected = shade(n_v, max(dot(n, l), 1e-4), dot(v, l), albedo, alpha);
        light += reflected * lamp.colour * falloff(distance_2, lamp.inverse_range_2);
    }
    return shown(light);
}

struct Sky {
    @builtin(position) clip: vec4f,
    @location(0) ray: vec3f,
}

// One triangle over the whole view, at the far plane.
@vertex
fn sky_vertex(@builtin(vertex_index) index: u32) -> Sky {
    let corner = vec2f(f32((index << 1u) & 2u), f32(index & 2u)) * 2.0 - 1.0;
    var out: Sky;
    out.clip = vec4f(corner, 1.0, 1.0);
    out.ray = view.ray_centre + view.ray_right * corner.x + view.ray_up * corner.y;
    return out;
}

@fragment
fn sky_fragment(in: Sky) -> @location(0) vec4f {
    let ray = normalize(in.ray);
    let height = max(ray.y, 0.0);
    var light = mix(vec3f(0.85, 0.62, 0.46), vec3f(0.05, 0.15, 0.46), sqrt(height));
    // A sheet of cloud, drifting.
    let plane = ray.xz / (height + 0.12);
    let sheet = textureSample(detail_map, repeating, plane * 0.22 + view.time * vec2f(0.002, 0.0)).r;
    let cloud = smoothstep(0.52, 0.68, sheet) * smoothstep(0.0, 0.15, height);
    light = mix(light, vec3f(1.25, 1.02, 0.88), cloud * 0.8);
    let to_sun = dot(ray, SUN_DIRECTION);
    let glow_2 = max(to_sun, 0.0) * max(to_sun, 0.0);
    let glow_8 = glow_2 * glow_2 * glow_2 * glow_2;
    light += SUN * (smoothstep(0.9985, 0.9994, to_sun) * 12.0 + glow_8 * glow_8 * 0.25);
    return shown(light);
}

struct Board {
    @builtin(position) clip: vec4f,
    @location(0) uv: vec2f,
}

@vertex
fn board_vertex(@builtin(vertex_index) index: u32) -> Board {
    let corner = vec2f(f32((index << 1u) & 2u), f32(index & 2u));
    var out: Board;
    out.clip = vec4f(corner * 2.0 - 1.0, 0.0, 1.0);
    out.uv = vec2f(corner.x, 1.0 - corner.y);
    return out;
}

// The board as it is, slightly see-through (premultiplied alpha).
@fragment
fn board_fragment(in: Board) -> @location(0) vec4f {
    return vec4f(shown(textureSample(albedo_map, repeating, in.uv).rgb).rgb * 0.9, 0.9);
}
