//! One render pass of a frame graph, with its truth.

use crate::frame_graphs::frame::Image;
use parafovea::pass_detection::{Draws, Eye, ImageKey, Pass, PassFacts, Reads, Target};
use smallvec::SmallVec;

/// The truth on a pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Truth {
    /// It draws the scene of this eye, or of both.
    Eye(Option<Eye>),
    /// A full-screen pass that shades the scene: lighting from a G-buffer, or the resolve of a visibility buffer.
    Shading(Option<Eye>),
    /// A full-screen pass that shades nothing: tone mapping, upscaling, anti-aliasing, a copy. Coarse rates only lose detail there.
    FullScreen,
    /// A texture of the scene, or a picture outside of the eyes: a mirror, a shadow map, a scope, a user interface, a spectator's window.
    Texture,
    /// Its eye cannot be determined by observation: it must stay at 1x1.
    Ambiguous,
}

/// One render pass.
#[derive(Clone, Debug)]
pub struct Step {
    pub(crate) name: &'static str,
    pub(crate) truth: Truth,
    pub(crate) pass: Pass,
}

impl Step {
    /// A pass over the whole of `colors`, that draws nothing yet.
    pub fn new(name: &'static str, truth: Truth, colors: &[Image]) -> Self {
        let extent = colors.first().map_or([0; 2], |image| image.extent);
        let is_layered = colors.iter().all(|image| image.layers == 2) && !colors.is_empty();
        let pass = Pass {
            colors: colors.iter().map(|image| image.target()).collect(),
            resolves: SmallVec::new(),
            depth: None,
            area: [0, 0, extent[0], extent[1]],
            region: [0, 0, extent[0], extent[1]],
            view_mask: if is_layered { 0b11 } else { 0 },
            facts: PassFacts::default(),
            unmasked: None,
            draws: Some(Draws::default()),
        };
        Self { name, truth, pass }
    }

    /// A pass that draws depth alone.
    pub fn depth_only(name: &'static str, truth: Truth, depth: Image) -> Self {
        let mut step = Self::new(name, truth, &[]).clears(depth);
        step.pass.area = [0, 0, depth.extent[0], depth.extent[1]];
        step.pass.view_mask = if depth.layers == 2 { 0b11 } else { 0 };
        step
    }

    /// With a depth attachment that it clears.
    pub fn clears(mut self, depth: Image) -> Self {
        self.pass.depth = Some(depth.target());
        self.pass.facts.clears_depth = true;
        self
    }

    /// With the depth of an earlier pass.
    pub fn loads(mut self, depth: Image) -> Self {
        self.pass.depth = Some(depth.target());
        self
    }

    /// Over the content of its targets.
    pub fn over(mut self) -> Self {
        self.pass.facts.loads_color = true;
        self
    }

    /// Resolved to these at its end.
    pub fn resolves(mut self, to: &[Image]) -> Self {
        self.pass.resolves = to.iter().map(|image| image.target()).collect();
        self
    }

    /// Into a part of its targets.
    pub fn area(mut self, area: [u32; 4]) -> Self {
        self.pass.area = area;
        self
    }

    /// Into one array layer of each target.
    pub fn layer(mut self, layer: u32) -> Self {
        let targets = self.pass.colors.iter_mut().chain(&mut self.pass.resolves).chain(&mut self.pass.depth);
        targets.for_each(|target| *target = Target { base_layer: layer, layers: 1, ..*target });
        self.pass.view_mask = 0;
        self
    }

    /// Into a mip level.
    pub fn level(mut self, level: u32, extent: [u32; 2]) -> Self {
        self.pass.colors.iter_mut().for_each(|target| target.level = level);
        self.pass.area = [0, 0, extent[0], extent[1]];
        self
    }

    /// Draws so many meshes, which sample `textures`.
    pub fn meshes(mut self, count: u32, textures: &[Image]) -> Self {
        let draws = self.pass.draws.get_or_insert_default();
        draws.meshes += count;
        draws.vertices += count * MESH_VERTICES;
        push(&mut draws.read_by_meshes, textures);
        self
    }

    /// Draws so many meshes of few vertices.
    pub fn small_meshes(mut self, count: u32, vertices: u32, textures: &[Image]) -> Self {
        let draws = self.pass.draws.get_or_insert_default();
        draws.meshes += count;
        draws.vertices += count * vertices;
        push(&mut draws.read_by_meshes, textures);
        self
    }

    /// Draws so many quads, which sample `textures`.
    pub fn quads(mut self, count: u32, textures: &[Image]) -> Self {
        let draws = self.pass.draws.get_or_insert_default();
        draws.quads += count;
        draws.vertices += count * Draws::QUAD_VERTICES;
        push(&mut draws.read_by_quads, textures);
        self
    }

    /// Draws one triangle over all of it, which samples `images`.
    pub fn full_screen(mut self, images: &[Image]) -> Self {
        let draws = self.pass.draws.get_or_insert_default();
        draws.quads += 1;
        draws.vertices += 3;
        push(&mut draws.read_by_quads, images);
        self
    }

    /// Only these images are known among the reads of its draws.
    pub(crate) fn reading(mut self, is_known: impl Fn(ImageKey) -> bool) -> Self {
        if let Some(draws) = &mut self.pass.draws {
            for reads in [&mut draws.read_by_quads, &mut draws.read_by_meshes] {
                reads.images.retain(|image| is_known(*image));
            }
        }
        self
    }

    /// The reads of its draws are unknown.
    pub(crate) fn bindless(mut self) -> Self {
        if let Some(draws) = &mut self.pass.draws {
            let unknown = Reads { images: SmallVec::new(), may_read_more: true };
            (draws.read_by_quads, draws.read_by_meshes) = (unknown.clone(), unknown);
        }
        self
    }
}

/// Vertices of a mesh.
const MESH_VERTICES: u32 = 900;

fn push(reads: &mut Reads, images: &[Image]) {
    images.iter().for_each(|image| reads.push(image.key));
}
