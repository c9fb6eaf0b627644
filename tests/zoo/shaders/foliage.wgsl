// Thin blades, cut out of crossed quads by an alpha test, among boxes that stand on a floor with fine lines, filtered by derivatives.
//
// Entry points with "look" show how that is with a map of shading rates: a fragment is of a block of pixels, and everything about it is
// as at the block's centre, beyond the edge of its triangle too. Coverage by triangles stays that of pixels. The draw's `value` is the
// side of the picture, its `count` how coarse it may be: log2 of a block's longest side in bits 0 and 1; bit 2: its filter is that of a pixel.

@group(0) @binding(1) var rates: texture_2d<u32>;

struct Sky {
    @builtin(position) position: vec4<f32>,
    @location(0) direction: vec3<f32>,
}

struct Leaf {
    @builtin(position) position: vec4<f32>,
    @location(0) world: vec3<f32>,
    @location(1) @interpolate(flat) quad: u32,
    @location(2) @interpolate(flat) view: u32,
}

// A quad with blades: its lower left corner, and its sides.
struct Quad {
    corner: vec3<f32>,
    right: vec3<f32>,
    up: vec3<f32>,
}

const BLADES = 9u;

fn quad_of(n: u32) -> Quad {
    let bush = n / 2u + 1000u;
    let near = 2.0 + 8.0 * random(bush, 2u);
    let center = vec3((random(bush, 0u) - 0.5) * 1.9 * near, (random(bush, 1u) - 0.5) * 1.7 * near, -near);
    let size = 0.7 + 0.6 * random(bush, 3u);
    let angle = 3.14 * random(bush, 4u) + 1.57 * f32(n % 2u);
    let right = vec3(cos(angle), 0.0, sin(angle)) * size;
    let up = vec3(0.15 * size * sin(frame.animation.x + f32(bush)), size, 0.0);
    return Quad(center - 0.5 * (right + up), right, up);
}

// Place on the quad of a point in its plane, 0 to 1.
fn on_quad(quad: Quad, world: vec3<f32>) -> vec2<f32> {
    let v = (world - quad.corner).y / quad.up.y;
    let across = world - quad.corner - quad.up * v;
    return vec2(dot(across, quad.right) / dot(quad.right, quad.right), v);
}

// Whether a place on a quad is on one of its blades.
fn is_blade(n: u32, at: vec2<f32>) -> bool {
    if any(at < vec2(0.0)) || any(at > vec2(1.0)) {
        return false;
    }
    for (var blade = 0u; blade < BLADES; blade += 1u) {
        let k = n * 16u + blade;
        let foot = 0.1 + 0.8 * random(k, 20u);
        let bend = (random(k, 21u) - 0.5) * 0.7;
        let tall = 0.5 + 0.5 * random(k, 22u);
        let middle = foot + bend * at.y * at.y;
        if at.y < tall && abs(at.x - middle) < 0.022 * (1.0 - at.y / tall) + 0.004 {
            return true;
        }
    }
    return false;
}

fn blade_color(n: u32, quad: Quad, at: vec2<f32>, world: vec3<f32>, view: u32) -> vec3<f32> {
    let base = mix(vec3(0.08, 0.22, 0.05), vec3(0.55, 0.6, 0.2), at.y * (0.6 + 0.4 * random(n, 30u)));
    let eye = frame.views[view].eye.xyz;
    let facing = normalize(cross(quad.right, quad.up));
    return lit(base, world, select(-facing, facing, dot(facing, eye - world) > 0.0), eye);
}

// Share of light of a surface with lines every 0.4 m, where a pixel is so wide.
fn lines(at: vec3<f32>, width: vec3<f32>) -> f32 {
    let line = abs(fract(at * 2.5 + 0.5) - 0.5);
    let wide = clamp(width * 2.5, vec3(0.001), vec3(1.0));
    // The share of the pixel that lines of 4 cm cover, along each axis: none across the surface itself.
    let covered = clamp((0.05 + 0.5 * wide - line) / wide, vec3(0.0), vec3(1.0)) * min(vec3(1.0), 0.1 / wide);
    return 1.0 - 0.7 * max(covered.x, max(covered.y, covered.z));
}

// The colour of a box; floor and wall have lines.
fn box_color(box: u32, local: vec3<f32>, width: vec3<f32>, world: vec3<f32>, normal: vec3<f32>, view: u32) -> vec3<f32> {
    let flat_side = abs(turned(normal, box_of(box).axis, -box_of(box).angle)) > vec3(0.5);
    let on_plane = select(local, vec3(0.2), flat_side);
    let share = select(1.0, lines(on_plane, width), box < 2u);
    return lit(albedo(local, box) * share, world, normal, frame.views[view].eye.xyz);
}

@vertex
fn boxes_vs(@builtin(vertex_index) vertex: u32, @builtin(instance_index) number: u32) -> Surface {
    return box_vertex(vertex, number, draw.view);
}

@fragment
fn boxes_fs(in: Surface) -> @location(0) vec4<f32> {
    return vec4(box_color(in.box, in.local, fwidth(in.local), in.world, normalize(in.normal), in.view), 1.0);
}

@vertex
fn sky_vs(@builtin(vertex_index) vertex: u32) -> Sky {
    let clip = full_screen(vertex);
    return Sky(vec4(clip, draw.far, 1.0), direction(draw.view, clip));
}

@fragment
fn sky_fs(in: Sky) -> @location(0) vec4<f32> {
    return vec4(sky(in.direction), 1.0);
}

@vertex
fn leaves_vs(@builtin(vertex_index) vertex: u32, @builtin(instance_index) number: u32) -> Leaf {
    var square = array(vec2(0.0, 0.0), vec2(1.0, 0.0), vec2(1.0, 1.0), vec2(0.0, 0.0), vec2(1.0, 1.0), vec2(0.0, 1.0));
    let quad = quad_of(number);
    let at = square[vertex];
    let world = quad.corner + quad.right * at.x + quad.up * at.y;
    return Leaf(frame.views[draw.view].clip_from_world * vec4(world, 1.0), world, number, draw.view);
}

@fragment
fn leaves_fs(in: Leaf) -> @location(0) vec4<f32> {
    let quad = quad_of(in.quad);
    let at = on_quad(quad, in.world);
    if !is_blade(in.quad, at) {
        discard;
    }
    return vec4(blade_color(in.quad, quad, at, in.world, in.view), 1.0);
}

// Pixels of the block of a fragment, along each axis.
fn block(position: vec4<f32>) -> vec2<f32> {
    let texels = vec2<f32>(textureDimensions(rates));
    let side = ceil(draw.value / texels);
    let texel = textureLoad(rates, vec2<i32>(position.xy / exp2(ceil(log2(side)))), 0).x;
    let most = draw.count & 3u;
    return vec2(f32(1u << min(texel >> 2u, most)), f32(1u << min(texel & 3u, most)));
}

// The centre of the block of a fragment, pixels.
fn center(position: vec4<f32>, size: vec2<f32>) -> vec2<f32> {
    return (floor(position.xy / size) + 0.5) * size;
}

// The direction in the world of a place in the picture, pixels.
fn through(pixel: vec2<f32>, view: u32) -> vec3<f32> {
    return direction(view, pixel / draw.value * 2.0 - 1.0);
}

// Intersection of the ray through a pixel with the plane of a point and a normal; the point itself if the plane is seen from its side.
fn in_plane(world: vec3<f32>, normal: vec3<f32>, pixel: vec2<f32>, view: u32) -> vec3<f32> {
    let eye = frame.views[view].eye.xyz;
    let along = normalize(through(pixel, view));
    let toward = dot(normal, along);
    let distance = dot(normal, world - eye) / toward;
    return select(world, eye + along * distance, abs(toward) > 0.01 && distance > 0.0);
}

@fragment
fn boxes_look_fs(in: Surface) -> @location(0) vec4<f32> {
    let normal = normalize(in.normal);
    let size = block(in.position);
    let pixel = center(in.position, size);
    let world = in_plane(in.world, normal, pixel, in.view);
    let box = box_of(in.box);
    let local = turned(world - box.center, box.axis, -box.angle);
    let step = select(size, vec2(1.0), (draw.count & 4u) != 0u);
    let right = turned(in_plane(in.world, normal, pixel + vec2(step.x, 0.0), in.view) - world, box.axis, -box.angle);
    let down = turned(in_plane(in.world, normal, pixel + vec2(0.0, step.y), in.view) - world, box.axis, -box.angle);
    return vec4(box_color(in.box, local, abs(right) + abs(down), world, normal, in.view), 1.0);
}

@fragment
fn sky_look_fs(in: Sky) -> @location(0) vec4<f32> {
    return vec4(sky(through(center(in.position, block(in.position)), draw.view)), 1.0);
}

@fragment
fn leaves_look_fs(in: Leaf) -> @location(0) vec4<f32> {
    let quad = quad_of(in.quad);
    let pixel = center(in.position, block(in.position));
    let world = in_plane(in.world, normalize(cross(quad.right, quad.up)), pixel, in.view);
    let at = on_quad(quad, world);
    if !is_blade(in.quad, at) {
        discard;
    }
    return vec4(blade_color(in.quad, quad, at, world, in.view), 1.0);
}
