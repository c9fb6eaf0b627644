// The scene, as all shaders know it: boxes on a floor before a wall, four lights, a sky. No buffers but the one of
// the frame: a box follows from its number.

struct View {
    clip_from_world: mat4x4<f32>,
    world_from_clip: mat4x4<f32>,
    eye: vec4<f32>,
}

struct Light {
    position: vec4<f32>,
    color: vec4<f32>,
}

struct Frame {
    views: array<View, 2>,
    lights: array<Light, 4>,
    // x: phase of the animation in radians.
    animation: vec4<f32>,
}

struct Draw {
    view: u32,
    // Depth of the far plane.
    far: f32,
    // Further parameters of a draw.
    value: f32,
    count: u32,
}

@group(0) @binding(0) var<uniform> frame: Frame;
var<immediate> draw: Draw;

// A box: half its size, turned about an axis, at a place.
struct Box {
    center: vec3<f32>,
    half_size: vec3<f32>,
    axis: vec3<f32>,
    angle: f32,
}

// Inputs of a fragment of a surface.
struct Surface {
    @builtin(position) position: vec4<f32>,
    @location(0) world: vec3<f32>,
    // Of the box: -1 to 1 at its faces, times half its size.
    @location(1) local: vec3<f32>,
    @location(2) normal: vec3<f32>,
    @location(3) @interpolate(flat) box: u32,
    @location(4) @interpolate(flat) view: u32,
}

fn hash(n: u32) -> u32 {
    let x = n * 747796405u + 2891336453u;
    let y = ((x >> ((x >> 28u) + 4u)) ^ x) * 277803737u;
    return (y >> 22u) ^ y;
}

fn random(n: u32, k: u32) -> f32 {
    return f32(hash(hash(n) + k) >> 8u) / 16777216.0;
}

fn box_of(n: u32) -> Box {
    if n == 0u {
        return Box(vec3(0.0, -2.0, -8.0), vec3(16.0, 0.2, 14.0), vec3(0.0, 1.0, 0.0), 0.0);
    }
    if n == 1u {
        return Box(vec3(0.0, 3.0, -16.0), vec3(15.0, 6.0, 0.3), vec3(0.0, 1.0, 0.0), 0.0);
    }
    let near = 2.5 + 11.0 * random(n, 2u);
    let center = vec3((random(n, 0u) - 0.5) * 1.9 * near, (random(n, 1u) - 0.4) * 0.9 * near, -near);
    let half_size = 0.12 + 0.5 * vec3(random(n, 3u), random(n, 4u), random(n, 5u));
    let axis = normalize(vec3(random(n, 6u) - 0.5, 0.6, random(n, 7u) - 0.5));
    let angle = 6.28 * random(n, 8u) + frame.animation.x * (random(n, 9u) - 0.5);
    return Box(center, half_size, axis, angle);
}

fn turned(v: vec3<f32>, axis: vec3<f32>, angle: f32) -> vec3<f32> {
    let c = cos(angle);
    return v * c + cross(axis, v) * sin(angle) + axis * dot(axis, v) * (1.0 - c);
}

fn face_normal(face: u32) -> vec3<f32> {
    let sign = select(-1.0, 1.0, face % 2u == 1u);
    var axis = vec3(0.0);
    axis[face / 2u] = sign;
    return axis;
}

// Corner `vertex` of 36 of a box, from -1 to 1.
fn corner(vertex: u32) -> vec3<f32> {
    var square = array(vec2(-1.0, -1.0), vec2(1.0, -1.0), vec2(1.0, 1.0),
                       vec2(-1.0, -1.0), vec2(1.0, 1.0), vec2(-1.0, 1.0));
    let face = vertex / 6u;
    let uv = square[vertex % 6u];
    let s = select(-1.0, 1.0, face % 2u == 1u);
    switch face / 2u {
        case 0u: { return vec3(s, uv.x, uv.y); }
        case 1u: { return vec3(uv.y, s, uv.x); }
        default: { return vec3(uv.x, uv.y, s); }
    }
}

// A vertex of a box, in clip space, as a view sees it.
fn box_vertex(vertex: u32, number: u32, view: u32) -> Surface {
    let box = box_of(number);
    let local = corner(vertex) * box.half_size;
    let world = box.center + turned(local, box.axis, box.angle);
    let normal = turned(face_normal(vertex / 6u), box.axis, box.angle);
    let position = frame.views[view].clip_from_world * vec4(world, 1.0);
    return Surface(position, world, local, normal, number, view);
}

fn corner_noise(cell: vec3<i32>) -> f32 {
    let n = u32(cell.x) * 73856093u ^ u32(cell.y) * 19349663u ^ u32(cell.z) * 83492791u;
    return f32(hash(n) >> 8u) / 16777216.0;
}

// Value noise, 0 to 1.
fn noise(at: vec3<f32>) -> f32 {
    let cell = vec3<i32>(floor(at));
    let f = fract(at);
    let w = f * f * (3.0 - 2.0 * f);
    let a = mix(corner_noise(cell), corner_noise(cell + vec3(1, 0, 0)), w.x);
    let b = mix(corner_noise(cell + vec3(0, 1, 0)), corner_noise(cell + vec3(1, 1, 0)), w.x);
    let c = mix(corner_noise(cell + vec3(0, 0, 1)), corner_noise(cell + vec3(1, 0, 1)), w.x);
    let d = mix(corner_noise(cell + vec3(0, 1, 1)), corner_noise(cell + vec3(1, 1, 1)), w.x);
    return mix(mix(a, b, w.y), mix(c, d, w.y), w.z);
}

// Linear-light colour of a surface: bands of noise.
fn albedo(local: vec3<f32>, box: u32) -> vec3<f32> {
    let base = 0.15 + 0.7 * vec3(random(box, 10u), random(box, 11u), random(box, 12u));
    let at = local * 7.0 + f32(box);
    let grain = 0.55 * noise(at) + 0.3 * noise(at * 2.3) + 0.15 * noise(at * 5.1);
    let line = smoothstep(0.42, 0.5, abs(fract(local.x * 1.5 + local.y * 1.5 + local.z * 1.5) - 0.5));
    return base * (0.45 + 0.65 * grain) * (1.0 - 0.5 * line);
}

// Linear-light colour of a lit surface: four lights, diffuse and specular.
fn lit(color: vec3<f32>, world: vec3<f32>, normal: vec3<f32>, eye: vec3<f32>) -> vec3<f32> {
    let to_eye = normalize(eye - world);
    var sum = color * vec3(0.09, 0.1, 0.13);
    for (var i = 0u; i < 4u; i += 1u) {
        let light = frame.lights[i];
        let to_light = light.position.xyz - world;
        let distance2 = dot(to_light, to_light);
        let l = to_light * inverseSqrt(distance2);
        let diffuse = max(dot(normal, l), 0.0);
        let specular = pow(max(dot(normal, normalize(l + to_eye)), 0.0), 40.0) * 0.35;
        sum += light.color.rgb * (color * diffuse + specular * diffuse) / (1.0 + 0.06 * distance2);
    }
    return sum;
}

// Linear-light colour of the sky.
fn sky(direction: vec3<f32>) -> vec3<f32> {
    let d = normalize(direction);
    let height = clamp(d.y, 0.0, 1.0);
    let cloud = smoothstep(0.45, 0.8, noise(d * 6.0 + vec3(frame.animation.x * 0.1, 0.0, 0.0)));
    return mix(mix(vec3(0.5, 0.6, 0.75), vec3(0.1, 0.22, 0.55), height), vec3(0.8), cloud * 0.6);
}

// The direction in the world in which a view has this place of clip space.
fn direction(view: u32, clip: vec2<f32>) -> vec3<f32> {
    let at = frame.views[view].world_from_clip * vec4(clip, 0.5, 1.0);
    return at.xyz / at.w - frame.views[view].eye.xyz;
}

// A triangle over everything: corner `vertex` of 3, in clip space.
fn full_screen(vertex: u32) -> vec2<f32> {
    return vec2(f32(vertex & 1u) * 4.0 - 1.0, f32(vertex >> 1u) * 4.0 - 1.0);
}
