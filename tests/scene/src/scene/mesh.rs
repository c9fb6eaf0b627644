//! Triangle meshes, built in code.

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec2, Vec3};
use std::f32::consts::TAU;

/// One vertex, as the vertex shader reads it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Vertex {
    /// Position in metres.
    pub position: [f32; 3],
    /// Unit normal.
    pub normal: [f32; 3],
    /// Unit tangent, along which `u` grows. The bitangent is `normal x tangent`.
    pub tangent: [f32; 3],
    /// Texture coordinates; the textures repeat every unit.
    pub uv: [f32; 2],
    /// Share of the light of sun and sky that reaches the surface, 0 (indoors) to 1 (in the open).
    pub sky: f32,
}

/// An indexed triangle list, counter-clockwise seen from outside.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// Vertices.
    pub vertices: Vec<Vertex>,
    /// Three indices a triangle.
    pub indices: Vec<u32>,
}

impl Mesh {
    fn push_grid(&mut self, columns: u32, rows: u32, vertex: impl Fn(f32, f32) -> Vertex) {
        let first = self.vertices.len() as u32;
        for j in 0..=rows {
            for i in 0..=columns {
                self.vertices.push(vertex(i as f32 / columns as f32, j as f32 / rows as f32));
            }
        }
        for j in 0..rows {
            for i in 0..columns {
                let a = first + j * (columns + 1) + i;
                let (b, c, d) = (a + 1, a + columns + 1, a + columns + 2);
                self.indices.extend([a, b, d, a, d, c]);
            }
        }
    }

    /// Adds a flat rectangle from `corner` along `u` and `v`, facing `u x v`; textures repeat every
    /// `tile` metres.
    pub fn rectangle(&mut self, corner: Vec3, u: Vec3, v: Vec3, tile: f32, sky: f32) {
        let (size, tangent) = (Vec2::new(u.length(), v.length()), u.normalize());
        let normal = u.cross(v).normalize();
        self.push_grid(1, 1, |s, t| Vertex {
            position: (corner + u * s + v * t).into(),
            normal: normal.into(),
            tangent: tangent.into(),
            uv: [s * size.x / tile, (1.0 - t) * size.y / tile],
            sky,
        });
    }

    /// Adds a rectangle that shows the whole texture once.
    pub fn picture(&mut self, corner: Vec3, u: Vec3, v: Vec3, sky: f32) {
        let first = self.vertices.len();
        self.rectangle(corner, u, v, 1.0, sky);
        for (vertex, uv) in
            self.vertices[first..].iter_mut().zip([[0.0, 1.0], [1.0, 1.0], [0.0, 0.0], [1.0, 0.0]])
        {
            vertex.uv = uv;
        }
    }

    /// Adds a rectangle that shows one cell of a texture of `columns` x `rows` cells; cells are counted from the
    /// upper left, row by row.
    pub fn cell(&mut self, rectangle: [Vec3; 3], [columns, rows]: [u32; 2], cell: u32, sky: f32) {
        let first = self.vertices.len();
        let [corner, u, v] = rectangle;
        self.picture(corner, u, v, sky);
        let (left, top) = ((cell % columns) as f32, (cell / columns % rows) as f32);
        for vertex in &mut self.vertices[first..] {
            let [s, t] = vertex.uv;
            vertex.uv = [(left + s) / columns as f32, (top + t) / rows as f32];
        }
    }

    /// Adds a straight rod with six sides.
    pub fn rod(&mut self, from: Vec3, to: Vec3, radius: f32, sky: f32) {
        let along = (to - from).normalize();
        let side = along.any_orthonormal_vector();
        let other = side.cross(along);
        let length = (to - from).length();
        self.push_grid(6, 1, |s, t| {
            let (sin, cos) = (s * TAU).sin_cos();
            let normal = other * sin - side * cos;
            Vertex {
                position: (from.lerp(to, t) + normal * radius).into(),
                normal: normal.into(),
                tangent: along.into(),
                uv: [t * length, s],
                sky,
            }
        });
    }

    /// Adds another mesh, placed by a rigid transform.
    pub fn add(&mut self, other: Self, transform: Mat4) {
        let first = self.vertices.len() as u32;
        let other = other.transformed(transform);
        self.vertices.extend(other.vertices);
        self.indices.extend(other.indices.into_iter().map(|index| first + index));
    }

    /// Adds an axis-aligned box between two corners.
    pub fn cuboid(&mut self, min: Vec3, max: Vec3, tile: f32, sky: f32) {
        let (x, y, z) = (Vec3::X * (max.x - min.x), Vec3::Y * (max.y - min.y), Vec3::Z * (max.z - min.z));
        self.rectangle(min + z, x, y, tile, sky);
        self.rectangle(min + x, -x, y, tile, sky);
        self.rectangle(min + x + z, -z, y, tile, sky);
        self.rectangle(min, z, y, tile, sky);
        self.rectangle(min + y + z, x, -z, tile, sky);
        self.rectangle(min, x, z, tile, sky);
    }

    /// Adds an upright cylinder without caps that widens or narrows from `radii.0` at the base to
    /// `radii.1` at the top.
    pub fn column(&mut self, base: Vec3, height: f32, radii: (f32, f32), segments: u32, sky: f32) {
        let slope = (radii.0 - radii.1) / height;
        let around = (radii.0 * TAU).ceil();
        self.push_grid(segments, 1, |s, t| {
            let (sin, cos) = (s * TAU).sin_cos();
            let radius = radii.0 + (radii.1 - radii.0) * t;
            Vertex {
                position: (base + Vec3::new(radius * sin, height * t, radius * cos)).into(),
                normal: Vec3::new(sin, slope, cos).normalize().into(),
                tangent: [cos, 0.0, -sin],
                uv: [s * around, (1.0 - t) * height],
                sky,
            }
        });
    }

    /// Adds a sphere.
    pub fn sphere(&mut self, centre: Vec3, radius: f32, segments: u32, sky: f32) {
        self.push_grid(segments, segments / 2, |s, t| {
            let (sin, cos) = (s * TAU).sin_cos();
            let (down, along) = ((0.5 - t) * TAU / 2.0).sin_cos();
            let normal = Vec3::new(along * sin, -down, along * cos);
            Vertex {
                position: (centre + normal * radius).into(),
                normal: normal.into(),
                tangent: [cos, 0.0, -sin],
                uv: [s * 2.0, 1.0 - t],
                sky,
            }
        });
    }

    /// Adds a cable that hangs between two points and sags by `sag` metres in the middle (a parabola,
    /// which is a catenary's shape for small sags), with a square cross-section.
    pub fn cable(&mut self, from: Vec3, to: Vec3, sag: f32, radius: f32) {
        const SEGMENTS: u32 = 24;
        let side = (to - from).cross(Vec3::Y).normalize();
        self.push_grid(4, SEGMENTS, |s, t| {
            let centre = from.lerp(to, t) - Vec3::Y * sag * 4.0 * t * (1.0 - t);
            let along = ((to - from) - Vec3::Y * sag * 4.0 * (1.0 - 2.0 * t)).normalize();
            let up = side.cross(along);
            let (sin, cos) = (s * TAU).sin_cos();
            let normal = up * sin - side * cos;
            Vertex {
                position: (centre + normal * radius).into(),
                normal: normal.into(),
                tangent: along.into(),
                uv: [t * 8.0, s],
                sky: 1.0,
            }
        });
    }

    /// Moves everything added so far by a rigid transform.
    pub fn transformed(mut self, transform: Mat4) -> Self {
        for vertex in &mut self.vertices {
            vertex.position = transform.transform_point3(vertex.position.into()).into();
            vertex.normal = transform.transform_vector3(vertex.normal.into()).into();
            vertex.tangent = transform.transform_vector3(vertex.tangent.into()).into();
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every triangle's winding agrees with its vertices' normals, or back-face culling eats it.
    #[test]
    fn triangles_face_outwards() {
        let mut mesh = Mesh::default();
        mesh.cuboid(Vec3::ZERO, Vec3::new(1.0, 2.0, 3.0), 1.0, 1.0);
        mesh.column(Vec3::X * 5.0, 3.0, (0.3, 0.2), 12, 1.0);
        mesh.sphere(Vec3::Y * 7.0, 1.0, 16, 1.0);
        mesh.cable(Vec3::new(-3.0, 4.0, 0.0), Vec3::new(3.0, 4.0, -1.0), 0.5, 0.01);
        mesh.rod(Vec3::new(-3.0, 4.0, 0.0), Vec3::new(3.0, 4.5, -1.0), 0.01, 1.0);
        mesh.rod(Vec3::new(-3.0, 4.0, 0.0), Vec3::new(-3.0, 9.0, 0.0), 0.01, 1.0);
        for triangle in mesh.indices.chunks_exact(3) {
            let [a, b, c] = [0, 1, 2].map(|i| mesh.vertices[triangle[i] as usize]);
            let [p, q, r] = [a, b, c].map(|vertex| Vec3::from(vertex.position));
            let face = (q - p).cross(r - p);
            let normal = Vec3::from(a.normal) + Vec3::from(b.normal) + Vec3::from(c.normal);
            assert!(face.dot(normal) >= -1e-6, "{p} {q} {r} faces {face}, its normals {normal}");
        }
    }
}
