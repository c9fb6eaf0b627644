//! The command buffers of a device, and their queries.

use super::features::Family;
use super::{Counted, Kind};
use crate::cpu_time::process_cpu_ns;
use ash::vk;
use std::collections::HashMap;

/// Render passes of a command buffer whose samples are counted.
pub(super) const MOST_PASSES: u32 = 256;

/// Stage of the timestamps: the end of all commands before them.
const ALL_DONE: vk::PipelineStageFlags = vk::PipelineStageFlags::BOTTOM_OF_PIPE;

struct Pool {
    /// Whether its buffers can be counted: they can draw, or write timestamps, and are not protected.
    counted: bool,
    /// Bits of timestamps that hold.
    timestamps: u64,
    buffers: Vec<vk::CommandBuffer>,
}

struct Buffer {
    pool: vk::CommandPool,
    level: vk::CommandBufferLevel,
    /// One query, or one for each render pass; null until they are needed.
    queries: vk::QueryPool,
    /// Whether the recorded commands can use the queries.
    counted: bool,
    /// Number of queries that it uses.
    used: u32,
    /// Whether it is in a render pass with a query.
    in_pass: bool,
    /// Submitted at this CPU time of the process, and the result not read yet.
    pending: Option<u64>,
    draws: u64,
}

/// Counts of a device.
#[derive(Clone, Default)]
pub(super) struct Sums {
    /// Counts of each command buffer's queries, or its nanoseconds.
    pub by_submit: Vec<Counted>,
    /// Reason why that is not all.
    pub reason: Option<String>,
    /// Primary command buffers executed.
    pub command_buffers: u64,
    /// Render passes executed, and counted.
    pub passes: u64,
    /// Draw calls executed.
    pub draws: u64,
    /// Calls of vkQueueSubmit and vkQueueSubmit2.
    pub queue_submits: u64,
}

impl Sums {
    /// The queries' counts, if all are available.
    pub fn counted(&self) -> Option<u64> {
        let sum = || self.by_submit.iter().map(|counted| counted.value).sum();
        self.reason.is_none().then(sum)
    }
}

/// All of a device's command buffers, and the sums.
pub(super) struct Buffers {
    kind: Kind,
    device: ash::Device,
    families: Vec<Family>,
    /// Nanoseconds of a timestamp's step.
    timestamp_period_ns: f32,
    pools: HashMap<vk::CommandPool, Pool>,
    buffers: HashMap<vk::CommandBuffer, Buffer>,
    sums: Sums,
}

impl Buffers {
    /// Nothing yet; with a reason, nothing will be counted.
    pub fn new(
        kind: Kind,
        device: ash::Device,
        (families, timestamp_period_ns): (Vec<Family>, f32),
        reason: Option<&str>,
    ) -> Self {
        let sums = Sums { reason: reason.map(str::to_owned), ..Sums::default() };
        let (pools, buffers) = (HashMap::new(), HashMap::new());
        Self { kind, device, families, timestamp_period_ns, pools, buffers, sums }
    }

    /// Something cannot be counted: from now on nothing is.
    pub fn give_up(&mut self, reason: &str) {
        self.sums.reason.get_or_insert_with(|| reason.to_owned());
    }

    pub fn add_pool(&mut self, pool: vk::CommandPool, family: u32, flags: vk::CommandPoolCreateFlags) {
        let family = self.families.get(family as usize);
        let bits = family.map_or(0, |family| family.timestamp_bits);
        let can_be = match self.kind {
            Kind::Times => bits > 0,
            Kind::Invocations | Kind::Samples => family.is_some_and(|family| family.draws),
        };
        let counted = can_be && !flags.contains(vk::CommandPoolCreateFlags::PROTECTED);
        let timestamps = u64::MAX.checked_shr(u64::BITS.saturating_sub(bits)).unwrap_or(0);
        self.pools.insert(pool, Pool { counted, timestamps, buffers: Vec::new() });
    }

    pub fn add(&mut self, pool: vk::CommandPool, level: vk::CommandBufferLevel, new: &[vk::CommandBuffer]) {
        if let Some(pool) = self.pools.get_mut(&pool) {
            pool.buffers.extend(new);
        }
        for &buffer in new {
            self.buffers.insert(
                buffer,
                Buffer {
                    pool,
                    level,
                    queries: vk::QueryPool::null(),
                    counted: false,
                    used: 0,
                    in_pass: false,
                    pending: None,
                    draws: 0,
                },
            );
        }
    }

    /// The buffers of a pool.
    pub fn of_pool(&self, pool: vk::CommandPool) -> Vec<vk::CommandBuffer> {
        self.pools.get(&pool).map(|pool| pool.buffers.clone()).unwrap_or_default()
    }

    pub fn is_secondary(&self, buffer: vk::CommandBuffer) -> bool {
        self.buffers.get(&buffer).is_some_and(|known| known.level == vk::CommandBufferLevel::SECONDARY)
    }

    /// Recording began: starts the query, or makes queries ready.
    ///
    /// # Safety
    ///
    /// `buffer` is in the recording state, at its beginning.
    pub unsafe fn begin(&mut self, buffer: vk::CommandBuffer) {
        let Some(known) = self.buffers.get_mut(&buffer) else { return };
        known.draws = 0;
        known.counted = false;
        known.used = 0;
        known.in_pass = false;
        let counted = self.pools.get(&known.pool).is_some_and(|pool| pool.counted);
        if known.level != vk::CommandBufferLevel::PRIMARY || !counted || self.sums.reason.is_some() {
            return;
        }
        let (info, count) = match self.kind {
            Kind::Invocations => {
                let info = vk::QueryPoolCreateInfo::default()
                    .query_type(vk::QueryType::PIPELINE_STATISTICS)
                    .pipeline_statistics(vk::QueryPipelineStatisticFlags::FRAGMENT_SHADER_INVOCATIONS);
                (info, 1)
            }
            Kind::Samples => {
                (vk::QueryPoolCreateInfo::default().query_type(vk::QueryType::OCCLUSION), MOST_PASSES)
            }
            Kind::Times => (vk::QueryPoolCreateInfo::default().query_type(vk::QueryType::TIMESTAMP), 2),
        };
        if known.queries == vk::QueryPool::null() {
            // SAFETY: the device is live and has the feature.
            match unsafe { self.device.create_query_pool(&info.query_count(count), None) } {
                Ok(queries) => known.queries = queries,
                Err(error) => {
                    self.sums.reason = Some(format!("vkCreateQueryPool: {error}"));
                    return;
                }
            }
        }
        known.counted = true;
        // SAFETY: the caller vouches for the buffer; it is outside of render passes, of a family that has such queries,
        // and the queries' last use has completed, or the buffer could not be recorded.
        unsafe {
            self.device.cmd_reset_query_pool(buffer, known.queries, 0, count);
            match self.kind {
                Kind::Invocations => {
                    known.used = 1;
                    self.device.cmd_begin_query(buffer, known.queries, 0, vk::QueryControlFlags::empty());
                }
                Kind::Samples => {}
                Kind::Times => {
                    known.used = count;
                    self.device.cmd_write_timestamp(buffer, ALL_DONE, known.queries, 0);
                }
            }
        }
    }

    /// Recording is about to end: ends the query.
    ///
    /// # Safety
    ///
    /// `buffer` is in the recording state, at its end.
    pub unsafe fn end(&self, buffer: vk::CommandBuffer) {
        let Some(known) = self.buffers.get(&buffer).filter(|known| known.counted) else { return };
        // SAFETY: the caller vouches for the buffer; `begin` began the query, or reset it, outside of render passes.
        unsafe {
            match self.kind {
                Kind::Invocations => self.device.cmd_end_query(buffer, known.queries, 0),
                Kind::Samples => {}
                Kind::Times => self.device.cmd_write_timestamp(buffer, ALL_DONE, known.queries, 1),
            }
        }
    }

    /// Starts a query before a render pass begins. `why_not` is the reason if its samples cannot be counted.
    ///
    /// # Safety
    ///
    /// `buffer` is in the recording state, outside of render passes.
    pub unsafe fn begin_pass(&mut self, buffer: vk::CommandBuffer, why_not: Option<&str>) {
        let Some(known) = self.buffers.get_mut(&buffer) else { return };
        let why_not = match why_not {
            None if known.level != vk::CommandBufferLevel::PRIMARY => {
                Some("a render pass in a secondary command buffer")
            }
            None if known.used == MOST_PASSES => Some("too many render passes in a command buffer"),
            _ => why_not,
        };
        if let Some(why_not) = why_not {
            return self.give_up(why_not);
        }
        // Also where the reason not to count came during the recording.
        if !known.counted || self.sums.reason.is_some() {
            return;
        }
        // SAFETY: the caller vouches for the buffer; `begin` reset the query, and no other of its kind is active, as the
        // application has none.
        unsafe {
            let precise = vk::QueryControlFlags::PRECISE;
            self.device.cmd_begin_query(buffer, known.queries, known.used, precise);
        }
        known.used += 1;
        known.in_pass = true;
    }

    /// A render pass has ended: ends its query.
    ///
    /// # Safety
    ///
    /// `buffer` is in the recording state, outside of render passes.
    pub unsafe fn end_pass(&mut self, buffer: vk::CommandBuffer) {
        let Some(known) = self.buffers.get_mut(&buffer) else { return };
        if std::mem::take(&mut known.in_pass) {
            // SAFETY: the caller vouches for the buffer; `begin_pass` began the query, outside of render passes.
            unsafe { self.device.cmd_end_query(buffer, known.queries, known.used - 1) }
        }
    }

    pub fn add_draws(&mut self, buffer: vk::CommandBuffer, draws: u64) {
        if let Some(known) = self.buffers.get_mut(&buffer) {
            known.draws += draws;
        }
    }

    /// Counts the draws of secondary buffers that a primary one executes; `why_not` is the reason if their fragments cannot be counted.
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
            self.give_up(why_not);
        }
    }

    /// The buffer's last submit has completed, or is waited for: reads its result.
    ///
    /// # Safety
    ///
    /// `buffer` is not being destroyed.
    pub unsafe fn collect(&mut self, buffer: vk::CommandBuffer) {
        let Some(known) = self.buffers.get_mut(&buffer) else { return };
        let Some(process_cpu_ns) = known.pending.take().filter(|_| known.used > 0) else { return };
        let mut results = [0u64; MOST_PASSES as usize];
        let results = &mut results[..known.used as usize];
        let flags = vk::QueryResultFlags::TYPE_64 | vk::QueryResultFlags::WAIT;
        // SAFETY: the queries are live and were begun and ended in the submitted buffer.
        match unsafe { self.device.get_query_pool_results(known.queries, 0, results, flags) } {
            Ok(()) if self.kind == Kind::Times => {
                let bits = self.pools.get(&known.pool).map_or(u64::MAX, |pool| pool.timestamps);
                let steps = results[1].wrapping_sub(results[0]) & bits;
                let value = (steps as f64 * f64::from(self.timestamp_period_ns)).round() as u64;
                self.sums.by_submit.push(Counted { process_cpu_ns, value });
            }
            Ok(()) => self.sums.by_submit.push(Counted { process_cpu_ns, value: results.iter().sum() }),
            Err(error) => self.sums.reason = Some(format!("vkGetQueryPoolResults: {error}")),
        }
    }

    /// A submit of these buffers succeeded.
    pub fn submitted(&mut self, buffers: &[vk::CommandBuffer]) {
        self.sums.queue_submits += 1;
        let now = process_cpu_ns();
        for buffer in buffers {
            let Some(known) = self.buffers.get_mut(buffer) else { continue };
            self.sums.command_buffers += 1;
            self.sums.draws += known.draws;
            if self.kind == Kind::Samples {
                self.sums.passes += u64::from(known.used);
            }
            if known.pending.replace(now).is_some() {
                self.sums.reason = Some("a command buffer is twice in one submit".to_owned());
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
            unsafe { self.device.destroy_query_pool(known.queries, None) };
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
    pub fn finish(&mut self) -> Sums {
        let left: Vec<_> = self.buffers.keys().copied().collect();
        for buffer in &left {
            // SAFETY: the device is still live.
            unsafe { self.collect(*buffer) };
        }
        // SAFETY: the device is idle and about to be destroyed.
        unsafe { self.remove(&left) };
        self.sums.clone()
    }
}
