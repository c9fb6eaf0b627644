// A visibility buffer with the visible face and its box, and a pass that shades them.

@group(0) @binding(1) var faces: texture_2d<u32>;

struct Face {
    @builtin(position) position: vec4<f32>,
    // 1 + 6 times the box + the face.
    @location(0) @interpolate(flat) number: u32,
}

struct Screen {
    @builtin(position) position: vec4<f32>,
    @location(0) clip: vec2<f32>,
}

@vertex
fn faces_vs(@builtin(vertex_index) vertex: u32, @builtin(instance_index) number: u32) -> Face {
    return Face(box_vertex(vertex, number, draw.view).position, 1u + 6u * number + vertex / 6u);
}

@fragment
fn faces_fs(in: Face) -> @location(0) u32 {
    return in.number;
}

@vertex
fn screen_vs(@builtin(vertex_index) vertex: u32) -> Screen {
    let clip = full_screen(vertex);
    return Screen(vec4(clip, 0.0, 1.0), clip);
}

@fragment
fn resolve_fs(in: Screen) -> @location(0) vec4<f32> {
    let number = textureLoad(faces, vec2<i32>(in.position.xy), 0).x;
    let ray = direction(draw.view, in.clip);
    if number == 0u {
        return vec4(sky(ray), 1.0);
    }
    let n = (number - 1u) / 6u;
    let box = box_of(n);
    // The ray in the box's own space, where the face is a plane across an axis.
    let eye = frame.views[draw.view].eye.xyz;
    let origin = turned(eye - box.center, box.axis, -box.angle);
    let along = turned(ray, box.axis, -box.angle);
    let plane = face_normal((number - 1u) % 6u);
    let distance = (dot(abs(plane), box.half_size) - dot(plane, origin)) / dot(plane, along);
    let normal = turned(plane, box.axis, box.angle);
    return vec4(lit(albedo(origin + along * distance, n), eye + ray * distance, normal, eye), 1.0);
}
