//! Code of shader modules, kept as long as modules or recipes need it.

use crate::abi::copies::words;
use crate::vk::table::Table;
use ash::vk;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Most bytes of code that are kept at a time: games have some hundred MiB of shaders, and passes need some dozens. Further code is not
/// kept.
const MOST_CODE: usize = 64 << 20;

/// Code of a module.
pub type Code = Arc<Kept>;

/// Words of SPIR-V.
pub struct Kept {
    words: Box<[u32]>,
    /// Number of bytes that are kept, including these.
    bytes: Arc<AtomicUsize>,
}

impl Kept {
    /// The words.
    pub fn words(&self) -> &[u32] {
        &self.words
    }
}

impl Drop for Kept {
    fn drop(&mut self) {
        self.bytes.fetch_sub(size_of_val(&*self.words), Ordering::Relaxed);
    }
}

/// The code of live modules of a device, as far as it is kept.
#[derive(Default)]
pub struct Codes {
    modules: Table<vk::ShaderModule, Code>,
    bytes: Arc<AtomicUsize>,
}

impl Codes {
    /// A module was created.
    ///
    /// # Safety
    ///
    /// `info` is valid (valid usage of vkCreateShaderModule).
    pub unsafe fn add(&self, module: vk::ShaderModule, info: &vk::ShaderModuleCreateInfo<'_>) {
        self.modules.remove(module);
        // SAFETY: the code is valid, by the valid usage of vkCreateShaderModule.
        let words = unsafe { words(info.p_code.cast(), info.code_size) };
        if let Some(kept) = self.keep(&words) {
            self.modules.insert(module, kept);
        }
    }

    /// Code of a pipeline without a module; `None` if no more code is kept.
    pub fn keep(&self, words: &[u32]) -> Option<Code> {
        let size = size_of_val(words);
        if self.bytes.load(Ordering::Relaxed).saturating_add(size) > MOST_CODE {
            return None;
        }
        self.bytes.fetch_add(size, Ordering::Relaxed);
        Some(Arc::new(Kept { words: words.into(), bytes: Arc::clone(&self.bytes) }))
    }

    /// A module is about to be destroyed.
    pub fn forget(&self, module: vk::ShaderModule) {
        self.modules.remove(module);
    }

    /// The code of a live module.
    pub fn get(&self, module: vk::ShaderModule) -> Option<Code> {
        self.modules.get(module)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ash::vk::Handle;

    #[test]
    fn code_counts_as_long_as_it_is_kept() {
        let codes = Codes::default();
        let words = vec![0u32; MOST_CODE / 4 - 1];
        let info = vk::ShaderModuleCreateInfo::default().code(&words);
        let module = vk::ShaderModule::from_raw;
        // SAFETY: code that is there.
        let add = |number| unsafe { codes.add(module(number), &info) };
        add(1);
        let kept = codes.get(module(1));
        codes.forget(module(1));
        add(2);
        assert!(kept.is_some() && codes.get(module(2)).is_none(), "a recipe has it still");
        drop(kept);
        add(3);
        assert!(codes.get(module(3)).is_some());
    }
}
