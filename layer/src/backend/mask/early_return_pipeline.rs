//! Pipelines whose fragment shaders return early in skipped blocks, bound in place of the application's in passes that have such
//! a mask.

use super::Masks;
use super::recipe::Recipe;
use crate::backend::mask::EarlyReturnSupport;
use crate::gpu::{AppendedLayout, Compilation, Later, Owned};
use ash::vk;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};

/// A pipeline of the application's with the one that is bound in its place.
pub struct EarlyReturnPipeline {
    recipe: Arc<Recipe>,
    /// Whether samples pass depth tests, and are counted, as without.
    keeps_coverage: bool,
    /// Asked for when it is first bound in such a pass.
    made: OnceLock<Later<Owned<vk::Pipeline>>>,
}

impl EarlyReturnPipeline {
    /// By a recipe.
    pub(super) fn new(recipe: Recipe, keeps_coverage: bool) -> Self {
        Self { recipe: Arc::new(recipe), keeps_coverage, made: OnceLock::new() }
    }

    /// Facts for passes.
    pub(super) fn facts(&self) -> EarlyReturnSupport {
        EarlyReturnSupport { any: true, keeping_coverage: self.keeps_coverage }
    }

    /// The layout that the pipeline has, valid as long as `self`.
    pub(crate) fn layout(&self) -> &AppendedLayout {
        self.recipe.layout()
    }

    /// The pipeline, once it is made, valid as long as `self`.
    pub fn pipeline(&self) -> Option<vk::Pipeline> {
        self.made.get().and_then(Later::get).map(|made| made.handle())
    }
}

impl Masks {
    /// Whether something may be bound in place of a pipeline.
    pub fn can_return(&self, pipeline: vk::Pipeline) -> bool {
        self.returning.get(pipeline).is_some()
    }

    /// Requests the substitute of a pipeline, if it may have one. True once it is made, false if it cannot be made, else `None`.
    pub fn prepare_return(&self, pipeline: vk::Pipeline, keeps_coverage: bool) -> Option<bool> {
        match self.returning(pipeline, keeps_coverage) {
            Some(_) => Some(true),
            None => {
                let known = self.returning.get(pipeline)?;
                known.made.get().is_some_and(Later::has_failed).then_some(false)
            }
        }
    }

    /// The substitute of a pipeline, in a pass that needs its coverage kept or not; `None` where the application's own stays, or the
    /// substitute is not made yet.
    pub fn returning(
        &self,
        pipeline: vk::Pipeline,
        keeps_coverage: bool,
    ) -> Option<Arc<EarlyReturnPipeline>> {
        let known = self.returning.get(pipeline)?;
        if keeps_coverage && !known.keeps_coverage {
            return None;
        }
        if known.made.get().is_none() {
            let (gpu, recipe) = (Arc::clone(self.gpu()?), Arc::clone(&known.recipe));
            let is_cpu = self.is_cpu;
            let make = move |compilation: &Arc<Compilation>| {
                gpu.compile_with(compilation);
                recipe.make(&gpu, is_cpu)
            };
            let new = self.compiler().ask("a fragment shader does not return early", make);
            known.made.get_or_init(|| new);
        }
        known.pipeline().is_some().then_some(known)
    }
}

/// Whether the bound graphics state is followed, in command buffers that begin from now on. It costs each binding a lock, so that it begins
/// with the first pass that needs it, of any device.
static FOLLOWS: AtomicBool = AtomicBool::new(false);

/// Begins to follow the bound graphics state.
pub fn follow_graphics() {
    FOLLOWS.store(true, Ordering::Relaxed);
}

/// Whether that is followed.
pub fn follows_graphics() -> bool {
    FOLLOWS.load(Ordering::Relaxed)
}
