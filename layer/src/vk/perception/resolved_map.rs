//! The map of one candidate, resolved from rates that the GPU decided.

use super::eye::EyeTiles;
use super::{Perception, Tools};
use crate::backend::MapForm;
use crate::backend::mask::mask_views;
use crate::gpu::{AppCommands, GpuError};
use crate::kernels::mask::MaskTarget;
use crate::kernels::resolve::RateMapTexels;
use crate::pass_detection::Part;
use crate::rate_map::{DeviceRates, RateImage};
use crate::vk::frame::Frame;
use crate::vk::pre_submit::Kept;
use ash::vk;
use smallvec::SmallVec;
use std::any::Any;
use std::sync::Arc;

/// Of the plans of both eyes: size of the picture and of a tile, pixels, and columns and rows of tiles.
type Shapes = [[[u32; 2]; 3]; 2];

/// The objects that resolve a candidate's map, as long as its passes draw the same.
pub struct ResolvedMap {
    parts: SmallVec<[Part; 4]>,
    image: RateImage,
    shapes: Shapes,
    skips_stale_tiles: bool,
    eyes: [Arc<EyeTiles>; 2],
    /// `None` if it cannot be resolved.
    targets: Option<ResolvedTargets>,
}

/// The written buffers of a map.
#[derive(Clone)]
pub struct ResolvedTargets {
    tools: Arc<Tools>,
    texels: Arc<RateMapTexels>,
    /// Of a mask, the target that is written from those.
    mask: Option<Arc<MaskTarget>>,
}

/// Target of resolving a map.
pub struct MapTarget<'a> {
    /// The queue that it is submitted to.
    pub queue: vk::Queue,
    /// The parts that the passes draw.
    pub parts: &'a [Part],
    /// The map.
    pub image: &'a RateImage,
    /// Whether stale tiles are skipped.
    pub skips_stale_tiles: bool,
}

/// The recorded writes.
pub enum Written {
    /// The texels are in this buffer, to be copied.
    Texels(vk::Buffer),
    /// The mask is written.
    Mask,
}

impl ResolvedMap {
    fn is_for(&self, place: &MapTarget, shapes: &Shapes, eyes: &[Arc<EyeTiles>; 2]) -> bool {
        self.parts.as_slice() == place.parts
            && self.image == *place.image
            && self.shapes == *shapes
            && self.skips_stale_tiles == place.skips_stale_tiles
            && self.eyes.iter().zip(eyes).all(|(known, eye)| Arc::ptr_eq(known, eye))
    }

    fn new(
        (frame, rates): (&Frame, &DeviceRates),
        tools: &Arc<Tools>,
        place: &MapTarget,
        form: &MapForm,
        shapes: Shapes,
        eyes: [Arc<EyeTiles>; 2],
    ) -> Self {
        let targets = targets((frame, rates), tools, place, form, &shapes, &eyes)
            .inspect_err(|error| error.log("rings instead of rates by contrast in one render target"));
        Self {
            parts: place.parts.into(),
            image: *place.image,
            shapes,
            skips_stale_tiles: place.skips_stale_tiles,
            eyes,
            targets: targets.ok().flatten(),
        }
    }
}

/// The targets that resolve a map; `None` if an eye that it shows has tiles and none of them are decided.
fn targets(
    (frame, rates): (&Frame, &DeviceRates),
    tools: &Arc<Tools>,
    place: &MapTarget,
    form: &MapForm,
    shapes: &Shapes,
    eyes: &[Arc<EyeTiles>; 2],
) -> Result<Option<ResolvedTargets>, GpuError> {
    let is_own = |(index, eye): (usize, &Arc<EyeTiles>)| {
        let [_, _, tiles] = shapes[index];
        eye.eye == index || tiles.contains(&0)
    };
    let table = frame.plan().table(place.parts, place.image);
    let Some(table) = table.filter(|_| eyes.iter().enumerate().all(is_own)) else { return Ok(None) };
    let views = eyes.each_ref().map(|eye| &eye.view);
    let texels = Arc::new(tools.resolve.target(&table, views, rates.available(), place.skips_stale_tiles)?);
    let mask = match form {
        MapForm::Texels => None,
        MapForm::Mask(map) => {
            let RateImage { texel, tiles, layers, .. } = *place.image;
            let views = mask_views(place.parts, place.image);
            Some(Arc::new(tools.mask.target(Arc::clone(map), &texels, (texel, tiles, layers), &views)?))
        }
    };
    Ok(Some(ResolvedTargets { tools: Arc::clone(tools), texels, mask }))
}

impl ResolvedTargets {
    /// Serial of the objects in its commands; `None` if the commands depend on anything else.
    pub fn serial(&self) -> Option<u64> {
        self.mask.is_none().then(|| self.texels.serial())
    }

    /// Records the resolve from the last decision.
    ///
    /// # Safety
    ///
    /// The command buffer is being recorded, outside of a render pass, for the queue of the [`MapTarget`]; the objects that
    /// [`Perception::resolve`] keeps live until it has finished.
    pub unsafe fn record(&self, commands: vk::CommandBuffer) -> Written {
        let Self { tools, texels, mask } = self;
        // SAFETY: the command buffer is recording, as `# Safety` demands.
        let commands = unsafe { AppCommands::new(&tools.gpu, commands) };
        tools.resolve.record(&commands, texels);
        match mask {
            Some(mask) => {
                tools.mask.record(&commands, mask);
                Written::Mask
            }
            None => Written::Texels(texels.texels()),
        }
    }
}

impl Perception {
    /// The targets that resolve a candidate's map from the last decision, whose objects are added to `kept`; `None` if the plan's own rates
    /// hold. `resolved` is the state of an earlier call, made again if that was for another map.
    pub fn resolve(
        &self,
        (frame, rates): (&Frame, &DeviceRates),
        place: &MapTarget,
        form: &MapForm,
        resolved: &mut Option<ResolvedMap>,
        kept: &mut Kept,
    ) -> Option<ResolvedTargets> {
        if place.parts.is_empty() {
            return None;
        }
        let tools = self.made()?;
        let eyes = match self.decided_tiles(frame, place.queue)? {
            [Some(left), Some(right)] => [left, right],
            [Some(one), None] | [None, Some(one)] => [Arc::clone(&one), one],
            [None, None] => return None,
        };
        let shapes = {
            let plan = frame.plan();
            [plan.shape(0), plan.shape(1)]
        };
        if !resolved.as_ref().is_some_and(|known| known.is_for(place, &shapes, &eyes)) {
            *resolved = Some(ResolvedMap::new((frame, rates), &tools, place, form, shapes, eyes));
        }
        let known = resolved.as_ref()?;
        let targets = known.targets.as_ref()?;
        // The tiles must outlive the work.
        kept.extend(known.eyes.iter().map(|eye| Arc::clone(eye) as Arc<dyn Any + Send + Sync>));
        kept.push(Arc::clone(&targets.texels) as Arc<dyn Any + Send + Sync>);
        if let Some(mask) = &targets.mask {
            kept.push(Arc::clone(mask) as Arc<dyn Any + Send + Sync>);
        }
        Some(targets.clone())
    }
}
