//! The command buffers of a device, and their queries.

use super::Count;
use ash::vk;
use std::collections::HashMap;

struct Pool {
    /// Whether its buffers can be counted: they can draw, and are not protected.
    counted: bool,
    buffers: Vec<vk::CommandBuffer>,
}

struct Buffer {
    pool: vk::CommandPool,
    level: vk::CommandBufferLevel,
    /// One query; null until it is needed.
    query: vk::QueryPool,
    /// Whether what is recorded uses the query.
    counted: bool,
    /// Submitted, and the result not read yet.
    pending: bool,
    draws: u64,
}

/// All of a device's command buffers, and the sums.
pub(super) struct Buffers {
    device: ash::Device,
    graphics_families: Vec<bool>,
    pools: HashMap<vk::CommandPool, Pool>,
    buffers: HashMap<vk::CommandBuffer, Buffer>,
    invocations: u64,
    count: Count,
}

impl Buffers {
    /// Nothing yet; with a reason, nothing will be counted.
    pub fn new(device: ash::Device, graphics_families: Vec<bool>, reason: Option<&str>) -> Self {
        let count = Count { reason: reason.map(str::to_owned), ..Count::default() };
        Self {
            device,
            graphics_families,
            pools: HashMap::new(),
            buffers: HashMap::new(),
            invocations: 0,
            count,
        }
    }

    pub fn add_pool(&mut self, pool: vk::CommandPool, family: u32, flags: vk::CommandPoolCreateFlags) {
        let graphics = self.graphics_families.get(family as usize) == Some(&true);
        let counted = graphics && !flags.contains(vk::CommandPoolCreateFlags::PROTECTED);
        self.pools.insert(pool, Pool { counted, buffers: Vec::new() });
    }

    pub fn add(&mut self, pool: vk::CommandPool, level: vk::CommandBufferLevel, new: &[vk::CommandBuffer]) {
        if let Some(pool) = self.pools.get_mut(&pool) {
            pool.buffers.extend(new);
        }
        for &buffer in new {
            let query = vk::QueryPool::null();
            self.buffers
                .insert(buffer, Buffer { pool, level, query, counted: false, pending: false, draws: 0 });
        }
    }

    /// The buffers of a pool.
    pub fn of_pool(&self, pool: vk::CommandPool) -> Vec<vk::CommandBuffer> {
        self.pools.get(&pool).map(|pool| pool.buffers.clone()).unwrap_or_default()
    }

    pub fn is_secondary(&self, buffer: vk::CommandBuffer) -> bool {
        self.buffers.get(&buffer).is_some_and(|known| known.level == vk::CommandBufferLevel::SECONDARY)
    }

    /// Recording began: starts the query.
    ///
    /// # Safety
    ///
    /// `buffer` is in the recording state, at its beginning.
    pub unsafe fn begin(&mut self, buffer: vk::CommandBuffer) {
        let Some(known) = self.buffers.get_mut(&buffer) else { return };
        known.draws = 0;
        known.counted = false;
        let counted = self.pools.get(&known.pool).is_some_and(|pool| pool.counted);
        if known.level != vk::CommandBufferLevel::PRIMARY || !counted || self.count.reason.is_some() {
            return;
        }
        if known.query == vk::QueryPool::null() {
            let info = vk::QueryPoolCreateInfo::default()
                .query_type(vk::QueryType::PIPELINE_STATISTICS)
                .query_count(1)
                .pipeline_statistics(vk::QueryPipelineStatisticFlags::FRAGMENT_SHADER_INVOCATIONS);
            // SAFETY: the device is live and has the feature.
            match unsafe { self.device.create_query_pool(&info, None) } {
                Ok(query) => known.query = query,
                Err(error) => {
                    self.count.reason = Some(format!("vkCreateQueryPool: {error}"));
                    return;
                }
            }
        }
        known.counted = true;
        // SAFETY: the caller vouches for the buffer; it is outside of render passes, of a family that draws,
        // and the query's last use has completed, or the buffer could not be recorded.
        unsafe {
            self.device.cmd_reset_query_pool(buffer, known.query, 0, 1);
            self.device.cmd_begin_query(buffer, known.query, 0, vk::QueryControlFlags::empty());
        }
    }

    /// Recording is about to end: ends the query.
    ///
    /// # Safety
    ///
    /// `buffer` is in the recording state, at its end.
    pub unsafe fn end(&self, buffer: vk::CommandBuffer) {
        if let Some(known) = self.buffers.get(&buffer).filter(|known| known.counted) {
            // SAFETY: the caller vouches for the buffer; `begin` began the query, outside of render passes.
            unsafe { self.device.cmd_end_query(buffer, known.query, 0) }
        }
    }

    pub fn add_draws(&mut self, buffer: vk::CommandBuffer, draws: u64) {
        if let Some(known) = self.buffers.get_mut(&buffer) {
            known.draws += draws;
        }
    }

    /// A primary buffer executes secondary ones; `why_not` says why their fragments cannot be counted.
    pub fn execute(
        &mut self,
        primary: vk::CommandBuffer,
        secondary: &[vk::CommandBuffer],
        why_not: Option<&str>,
    ) {
        let draws =
            secondary.iter().filter_map(|buffer| self.buffers.get(buffer)).map(|known| known.draws).sum();
        self.add_draws(primary, draws);
        if let Some(why_not) = why_not {
            self.count.reason.get_or_insert_with(|| why_not.to_owned());
        }
    }

    /// The buffer's last submit has completed, or is waited for: reads its result.
    ///
    /// # Safety
    ///
    /// `buffer` is not being destroyed.
    pub unsafe fn collect(&mut self, buffer: vk::CommandBuffer) {
        let Some(known) = self.buffers.get_mut(&buffer) else { return };
        if !std::mem::take(&mut known.pending) || !known.counted {
            return;
        }
        let mut result = [0u64];
        let flags = vk::QueryResultFlags::TYPE_64 | vk::QueryResultFlags::WAIT;
        // SAFETY: the query is live and was begun and ended in the submitted buffer.
        match unsafe { self.device.get_query_pool_results(known.query, 0, &mut result, flags) } {
            Ok(()) => self.invocations += result[0],
            Err(error) => self.count.reason = Some(format!("vkGetQueryPoolResults: {error}")),
        }
    }

    /// A submit of these buffers succeeded.
    pub fn submitted(&mut self, buffers: &[vk::CommandBuffer]) {
        self.count.queue_submits += 1;
        for buffer in buffers {
            let Some(known) = self.buffers.get_mut(buffer) else { continue };
            self.count.command_buffers += 1;
            self.count.draws += known.draws;
            if std::mem::replace(&mut known.pending, true) {
                self.count.reason = Some("a command buffer is twice in one submit".to_owned());
            }
        }
    }

    /// Takes back the queries of freed buffers.
    ///
    /// # Safety
    ///
    /// The buffers were collected, and are freed.
    pub unsafe fn remove(&mut self, freed: &[vk::CommandBuffer]) {
        for buffer in freed {
            let Some(known) = self.buffers.remove(buffer) else { continue };
            if let Some(pool) = self.pools.get_mut(&known.pool) {
                pool.buffers.retain(|other| other != buffer);
            }
            // SAFETY: nothing uses the query any more; null is allowed.
            unsafe { self.device.destroy_query_pool(known.query, None) };
        }
    }

    /// As [`Self::remove`], for a destroyed pool.
    ///
    /// # Safety
    ///
    /// The pool's buffers were collected, and it is destroyed.
    pub unsafe fn remove_pool(&mut self, pool: vk::CommandPool) {
        // SAFETY: the caller vouches for it.
        unsafe { self.remove(&self.of_pool(pool)) };
        self.pools.remove(&pool);
    }

    /// The device is about to be destroyed: everything that was submitted has completed.
    pub fn finish(&mut self) -> Count {
        let left: Vec<_> = self.buffers.keys().copied().collect();
        for buffer in &left {
            // SAFETY: the device is still live.
            unsafe { self.collect(*buffer) };
        }
        // SAFETY: the device is idle and about to be destroyed.
        unsafe { self.remove(&left) };
        let counted = self.count.reason.is_none().then_some(self.invocations);
        Count { fragment_invocations: counted, ..self.count.clone() }
    }
}
