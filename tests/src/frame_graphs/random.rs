//! Random frame graphs with their truth: cameras of any size whose images the scene samples, a forward or deferred scene, any
//! post-processing, any way to the swapchain. No texture may ever become coarser, with any descriptors.

use crate::frame_graphs::frame::{
    Arrangement, BYTES, DEPTH, Frame, HDR, Image, LDR, NORMALS, PACKED, World, eye_of, scaled,
};
use crate::frame_graphs::score::Score;
use crate::frame_graphs::step::{Step, Truth, Truth::Eye as IsEye, Truth::FullScreen, Truth::Shading};
use fastrand::Rng;

/// Frames of a random graph.
pub const FRAMES: u64 = 12;

/// One random graph.
#[derive(Clone, Debug)]
pub struct RandomGraph {
    eye: [u32; 2],
    is_array: bool,
    is_bindless: bool,
    is_dynamic: bool,
    /// Side of the scene's targets without dynamic resolution, in sides of the eye buffer.
    side: f32,
    cameras: Vec<Camera>,
    scene: Scene,
    /// Full-screen passes after the scene, each with its side in sides of the scene's targets.
    post: Vec<f32>,
    end: End,
    /// Whether both eyes share the images of the scene.
    shares_images: bool,
}

/// A picture that the scene samples.
#[derive(Clone, Copy, Debug)]
struct Camera {
    /// Its size: of its own, or in sides of the scene's targets.
    size: Size,
    has_depth: bool,
    buffers: usize,
    meshes: u32,
    quads: u32,
    /// Full-screen passes over it.
    post: usize,
    /// Whether it is drawn after the scene, and sampled in the next frame.
    is_late: bool,
    /// Whether its content only reaches the scene through another camera's pass.
    is_nested: bool,
    /// Whether it is drawn in these frames alone: every so many.
    every: u64,
}

#[derive(Clone, Copy, Debug)]
enum Size {
    Own([u32; 2]),
    Scaled(f32),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Scene {
    Forward,
    ForwardWithPrepass,
    Deferred,
    LightVolumes,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum End {
    /// The scene's passes draw to the swapchain.
    Straight,
    FullScreen,
    VisibleArea,
    Copy,
    Blit,
    /// Compute writes an image that is copied.
    Compute,
}

impl RandomGraph {
    /// That of a seed.
    pub fn new(seed: u64) -> Self {
        let mut rng = Rng::with_seed(seed);
        let eye = [[2016, 2240], [2560, 2560], [1440, 1600], [1832, 1920], [2048, 2048]][rng.usize(..5)];
        let camera = |rng: &mut Rng| {
            let side = [512, 1024, 1280, 2048, 2560, 4096][rng.usize(..6)];
            Camera {
                size: match rng.u8(..3) {
                    0 => Size::Own([side; 2]),
                    1 => Size::Own(eye),
                    _ => Size::Scaled([0.5, 0.75, 1.0, 1.0, 1.5][rng.usize(..5)]),
                },
                has_depth: rng.u8(..4) > 0,
                buffers: 1 + usize::from(rng.u8(..5) == 0) * 2,
                meshes: rng.u32(1..200),
                quads: rng.u32(..3) * rng.u32(..30),
                post: rng.usize(..3),
                is_late: rng.u8(..8) == 0,
                is_nested: rng.u8(..6) == 0,
                every: [1, 1, 1, 2, 3][rng.usize(..5)],
            }
        };
        let cameras = (0..rng.usize(..5)).map(|_| camera(&mut rng)).collect();
        let scenes = [Scene::Forward, Scene::ForwardWithPrepass, Scene::Deferred, Scene::LightVolumes];
        let ends = [End::Straight, End::FullScreen, End::VisibleArea, End::Copy, End::Blit, End::Compute];
        let end = ends[rng.usize(..ends.len())];
        Self {
            eye,
            is_array: rng.bool(),
            is_bindless: rng.u8(..4) == 0,
            is_dynamic: end != End::Straight && rng.u8(..3) == 0,
            side: 1.0,
            cameras,
            scene: scenes[rng.usize(..scenes.len())],
            post: (0..rng.usize(..4)).map(|_| [1.0, 1.0, 0.5, 0.25][rng.usize(..4)]).collect(),
            end,
            shares_images: rng.bool(),
        }
    }

    /// The same with a scene of a third of the sides, which is upscaled, at all times.
    pub fn third(self) -> Self {
        Self { side: 1.0 / 3.0, is_dynamic: false, ..self }
    }

    /// Draws all frames of it.
    pub fn run(&self) -> Score {
        let mut world = World::default();
        let arrangement = if self.is_array { Arrangement::Array } else { Arrangement::Separate };
        for number in 0..FRAMES {
            let step = [1.0, 0.9, 0.75, 0.6][(number / 2) as usize % 4];
            let scale = if self.is_dynamic { step } else { self.side };
            world.frame(self.eye, arrangement, scale, self.is_bindless, |frame| self.draw(frame));
        }
        let mut score = Score::default();
        world.seen.iter().for_each(|seen| score.count(seen, seen.frame));
        score
    }

    fn draw(&self, frame: &mut Frame<'_>) {
        let mut sampled = Vec::new();
        for (number, camera) in self.cameras.iter().enumerate() {
            let image = camera.image(frame, number);
            if !camera.is_late && frame.number.is_multiple_of(camera.every) {
                camera.draw(frame, number, &sampled);
            }
            if camera.is_nested {
                sampled.clear();
            }
            sampled.push(image);
        }
        match self.is_array {
            true => self.draw_eye(frame, None, &sampled),
            false => (0..2).for_each(|view| self.draw_eye(frame, Some(view), &sampled)),
        }
        for (number, camera) in self.cameras.iter().enumerate() {
            if camera.is_late && frame.number.is_multiple_of(camera.every) {
                camera.draw(frame, number, &[]);
            }
        }
    }

    /// The scene of one eye, or of both in layers.
    fn draw_eye(&self, frame: &mut Frame<'_>, view: Option<usize>, sampled: &[Image]) {
        let number = view.unwrap_or(0) * usize::from(!self.shares_images);
        let eye = view.and_then(eye_of);
        let size = if self.end == End::Straight { self.eye } else { frame.size() };
        let make = |frame: &mut Frame<'_>, name, format| match view {
            None => frame.array(name, size, format),
            Some(_) => frame.image(name, number, size, format),
        };
        let swapchain = frame.swapchain(view.unwrap_or(0));
        let depth = make(frame, "depth", DEPTH);
        let color = match self.end {
            End::Straight => swapchain,
            End::Copy | End::Blit if self.post.is_empty() => make(frame, "colour", LDR),
            _ => make(frame, "colour", PACKED),
        };
        let is_eye = IsEye(eye);
        match self.scene {
            Scene::Forward => {
                frame.add(Step::new("scene", is_eye, &[color]).clears(depth).meshes(250, sampled));
            }
            Scene::ForwardWithPrepass => {
                frame.add(Step::depth_only("pre-pass", is_eye, depth).meshes(90, &[]));
                frame.add(Step::new("scene", is_eye, &[color]).loads(depth).meshes(250, sampled));
            }
            Scene::Deferred | Scene::LightVolumes => {
                let buffers = [("albedo", BYTES), ("normals", NORMALS), ("material", BYTES)]
                    .map(|(name, format)| make(frame, name, format));
                frame.add(Step::new("G-buffer", is_eye, &buffers).clears(depth).meshes(300, sampled));
                let mut read = buffers.to_vec();
                read.push(depth);
                if self.scene == Scene::LightVolumes {
                    let lights = Step::new("lights", Shading(eye), &[color]).loads(depth);
                    frame.add(lights.small_meshes(30, 200, &read));
                } else {
                    read.extend(sampled);
                    frame.add(Step::new("lighting", Shading(eye), &[color]).full_screen(&read));
                }
                frame.add(Step::new("transparent", is_eye, &[color]).loads(depth).meshes(20, sampled));
            }
        }
        self.end(frame, view, color);
    }

    /// From the scene's picture to the swapchain.
    fn end(&self, frame: &mut Frame<'_>, view: Option<usize>, color: Image) {
        if self.end == End::Straight {
            return;
        }
        let names = ["post 0", "post 1", "post 2", "post 3"];
        let mut from = color;
        let last = self.post.iter().rposition(|scale| *scale == 1.0);
        for (index, (scale, name)) in self.post.iter().zip(names).enumerate() {
            let extent = scaled(color.extent, *scale);
            let format = if Some(index) == last { LDR } else { HDR };
            let to = match view {
                None => frame.array(name, extent, format),
                Some(_) => frame.image(name, 0, extent, format),
            };
            let read = [from, color];
            frame.add(Step::new("post", FullScreen, &[to]).full_screen(&read));
            // A smaller target is a blur beside the picture.
            if *scale == 1.0 {
                from = to;
            }
        }
        let swapchain = frame.swapchain(view.unwrap_or(0));
        let step = Step::new("to the swapchain", FullScreen, &[swapchain]);
        match self.end {
            End::FullScreen => frame.add(step.full_screen(&[from])),
            End::VisibleArea => frame.add(step.small_meshes(1, 280, &[from])),
            End::Copy if from.extent == swapchain.extent => frame.copy(from, swapchain),
            End::Copy | End::Blit => frame.blit(from, swapchain),
            End::Compute => {
                let out = match view {
                    None => frame.array("compute", swapchain.extent, BYTES),
                    Some(_) => frame.image("compute", 0, swapchain.extent, BYTES),
                };
                frame.copy(out, swapchain);
            }
            End::Straight => {}
        }
    }
}

impl Camera {
    fn extent(&self, frame: &Frame<'_>) -> [u32; 2] {
        match self.size {
            Size::Own(extent) => extent,
            Size::Scaled(scale) => scaled(frame.size(), scale),
        }
    }

    /// The image of it that is sampled.
    fn image(&self, frame: &mut Frame<'_>, number: usize) -> Image {
        let extent = self.extent(frame);
        match self.post {
            0 => frame.image("camera", number, extent, HDR),
            _ => frame.image("camera, processed", number, extent, HDR),
        }
    }

    fn draw(&self, frame: &mut Frame<'_>, number: usize, sampled: &[Image]) {
        let extent = self.extent(frame);
        let image = frame.image("camera", number, extent, HDR);
        let mut targets = vec![image];
        for name in ["camera albedo", "camera normals"].into_iter().take(self.buffers - 1) {
            targets.push(frame.image(name, number, extent, BYTES));
        }
        let step = Step::new("camera", Truth::Texture, &targets);
        let step = match self.has_depth {
            true => step.clears(frame.image("camera depth", number, extent, DEPTH)),
            false => step,
        };
        frame.add(step.meshes(self.meshes, sampled).quads(self.quads, sampled));
        let processed = frame.image("camera, processed", number, extent, HDR);
        for _ in 0..self.post {
            frame.add(Step::new("camera post", Truth::Texture, &[processed]).full_screen(&[image]));
        }
    }
}
