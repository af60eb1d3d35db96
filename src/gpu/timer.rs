//! What each pass cost: GPU time by timestamps, shaded pixels by pipeline statistics.
//!
//! Both are optional features; where one is missing its figure is `None`, never a guess.

use super::{Gpu, GpuError};

/// Passes one timer can hold; further ones stay unmeasured.
const CAPACITY: u32 = 256;

/// Byte offset of the pixel counts behind the times; a multiple of 256 as resolving demands.
const COUNTS_AT: u64 = CAPACITY as u64 * 16;

/// What was measured of one pass.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PassMeasure {
    /// Time on the GPU, milliseconds.
    pub gpu_ms: Option<f64>,
    /// Fragment shader invocations.
    pub pixels: Option<u64>,
}

/// Measures the passes of one frame. Made only when somebody asks for statistics.
pub struct Timer {
    times: Option<wgpu::QuerySet>,
    counts: Option<wgpu::QuerySet>,
    results: wgpu::Buffer,
    slots: Vec<Slot>,
    counted: u32,
}

/// Where one pass' results stand.
#[derive(Clone, Copy, Debug)]
pub struct Slot {
    time: u32,
    count: Option<u32>,
}

impl Slot {
    /// The place of its results in [`Timer::read`]'s list.
    pub fn index(self) -> usize {
        self.time as usize
    }
}

impl Timer {
    /// A timer for one frame.
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let features = gpu.device.features();
        let set = |ty: wgpu::QueryType, count: u32| {
            gpu.device.create_query_set(&wgpu::QuerySetDescriptor { label: Some("pass measures"), ty, count })
        };
        let times =
            features.contains(wgpu::Features::TIMESTAMP_QUERY).then(|| set(wgpu::QueryType::Timestamp, 2 * CAPACITY));
        let counts = features.contains(wgpu::Features::PIPELINE_STATISTICS_QUERY).then(|| {
            let shaded = wgpu::PipelineStatisticsTypes::FRAGMENT_SHADER_INVOCATIONS;
            set(wgpu::QueryType::PipelineStatistics(shaded), CAPACITY)
        });
        let usage = wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC;
        let results = gpu.empty_buffer("pass measures", usage, u64::from(3 * CAPACITY) * 8)?;
        Ok(Self { times, counts, results, slots: Vec::new(), counted: 0 })
    }

    /// A place for the next pass' results; `shades` where it runs fragment shaders. `None` when full.
    pub fn slot(&mut self, shades: bool) -> Option<Slot> {
        let time = self.slots.len() as u32;
        if time == CAPACITY {
            return None;
        }
        let count = (shades && self.counts.is_some()).then(|| {
            self.counted += 1;
            self.counted - 1
        });
        let slot = Slot { time, count };
        self.slots.push(slot);
        Some(slot)
    }

    /// Where a render pass writes its times.
    pub fn render_writes(&self, slot: Option<Slot>) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        let time = slot?.time;
        Some(wgpu::RenderPassTimestampWrites {
            query_set: self.times.as_ref()?,
            beginning_of_pass_write_index: Some(2 * time),
            end_of_pass_write_index: Some(2 * time + 1),
        })
    }

    /// Where a compute pass writes its times.
    pub fn compute_writes(&self, slot: Option<Slot>) -> Option<wgpu::ComputePassTimestampWrites<'_>> {
        let time = slot?.time;
        Some(wgpu::ComputePassTimestampWrites {
            query_set: self.times.as_ref()?,
            beginning_of_pass_write_index: Some(2 * time),
            end_of_pass_write_index: Some(2 * time + 1),
        })
    }

    /// Starts counting the shaded pixels of a render pass; [`Timer::end_count`] must follow in the same pass.
    pub fn begin_count(&self, pass: &mut wgpu::RenderPass<'_>, slot: Option<Slot>) {
        if let (Some(set), Some(Slot { count: Some(count), .. })) = (&self.counts, slot) {
            pass.begin_pipeline_statistics_query(set, count);
        }
    }

    /// Ends what [`Timer::begin_count`] began.
    pub fn end_count(&self, pass: &mut wgpu::RenderPass<'_>, slot: Option<Slot>) {
        if self.counts.is_some() && slot.is_some_and(|s| s.count.is_some()) {
            pass.end_pipeline_statistics_query();
        }
    }

    /// Puts the results where [`Timer::read`] finds them.
    pub fn resolve(&self, encoder: &mut wgpu::CommandEncoder) {
        let used = self.slots.len() as u32;
        if let (Some(times), 1..) = (&self.times, used) {
            encoder.resolve_query_set(times, 0..2 * used, &self.results, 0);
        }
        if let (Some(counts), 1..) = (&self.counts, self.counted) {
            encoder.resolve_query_set(counts, 0..self.counted, &self.results, COUNTS_AT);
        }
    }

    /// What every pass cost, in the order of [`Timer::slot`].
    pub fn read(&self, gpu: &Gpu) -> Result<Vec<PassMeasure>, GpuError> {
        let bytes = gpu.read_buffer(&self.results)?;
        let value = |at: u64| bytes[at as usize..].first_chunk().map_or(0, |b: &[u8; 8]| u64::from_le_bytes(*b));
        let period = f64::from(gpu.queue.get_timestamp_period());
        let begins = (0..self.slots.len() as u64).map(|slot| 16 * slot);
        let spans = spans(begins.map(|begin| [value(begin), value(begin + 8)]));
        let measure = |(slot, span): (&Slot, u64)| PassMeasure {
            gpu_ms: self.times.as_ref().map(|_| span as f64 * period / 1e6),
            pixels: slot.count.map(|count| value(COUNTS_AT + u64::from(count) * 8)),
        };
        Ok(self.slots.iter().zip(spans).map(measure).collect())
    }
}

/// How long each pass ran, from when they began and ended, in their order. GPUs begin a pass while those before it still run; that time is
/// theirs alone, so that all passes together take no longer than the frame.
fn spans(times: impl Iterator<Item = [u64; 2]>) -> Vec<u64> {
    let mut last = 0;
    let span = |[begin, end]: [u64; 2]| {
        let span = end.saturating_sub(begin.max(last));
        last = last.max(end);
        span
    };
    times.map(span).collect()
}

#[cfg(test)]
mod tests {
    use super::spans;

    #[test]
    fn what_runs_beside_a_pass_before_it_is_counted_once() {
        assert_eq!(spans([[10, 20], [25, 30]].into_iter()), [10, 5]);
        assert_eq!(spans([[10, 20], [12, 26], [13, 24], [14, 30]].into_iter()), [10, 6, 0, 4]);
    }
}
