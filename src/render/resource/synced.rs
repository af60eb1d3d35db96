//! Buffers that follow a scene: written only when their content changes, or by the GPU alone.

use std::ops::Range;

use crate::gpu::{Gpu, GpuError};

/// What the smallest has: room for any stage that is bound at an offset.
const LEAST_BYTES: u64 = 512;

/// A GPU buffer and the bytes it holds.
#[derive(Debug)]
pub struct Synced {
    label: &'static str,
    usage: wgpu::BufferUsages,
    bytes: Vec<u8>,
    buffer: wgpu::Buffer,
}

impl Synced {
    /// A buffer of zeros.
    pub fn new(gpu: &Gpu, label: &'static str, usage: wgpu::BufferUsages) -> Result<Self, GpuError> {
        let usage = usage | wgpu::BufferUsages::COPY_DST;
        Ok(Self { label, usage, bytes: Vec::new(), buffer: gpu.empty_buffer(label, usage, LEAST_BYTES)? })
    }

    /// The buffer to bind.
    pub fn buffer(&self) -> &wgpu::Buffer {
        &self.buffer
    }

    /// Makes the buffer hold `data`; `true` if it had to be replaced by a larger one (bind groups are stale then).
    pub fn sync<T: bytemuck::NoUninit>(&mut self, gpu: &Gpu, data: &[T]) -> Result<bool, GpuError> {
        let bytes: &[u8] = bytemuck::cast_slice(data);
        if bytes == self.bytes {
            return Ok(false);
        }
        let grown = bytes.len() as u64 > self.buffer.size();
        if grown {
            self.buffer = gpu.empty_buffer(self.label, self.usage, (bytes.len() as u64).next_power_of_two())?;
        }
        match changed(&self.bytes, bytes).filter(|_| !grown) {
            // What changes of a buffer is mostly little of it.
            Some(runs) => runs.into_iter().for_each(|run| gpu.write_from(&self.buffer, run.start as u64, &bytes[run])),
            None if bytes.is_empty() => {}
            None => gpu.write(&self.buffer, bytes),
        }
        self.bytes.clear();
        self.bytes.extend_from_slice(bytes);
        Ok(grown)
    }
}

/// Runs that are written by themselves, at most.
const MOST_RUNS: usize = 64;

/// Where two contents of one length differ, in runs of whole words; `None`: that is too much, or they have not one length.
fn changed(before: &[u8], after: &[u8]) -> Option<Vec<Range<usize>>> {
    const WORD: usize = 4;
    if before.len() != after.len() || !after.len().is_multiple_of(WORD) {
        return None;
    }
    let mut runs: Vec<Range<usize>> = Vec::new();
    for (i, (a, b)) in before.chunks_exact(WORD).zip(after.chunks_exact(WORD)).enumerate() {
        if a == b {
            continue;
        }
        let word = i * WORD..(i + 1) * WORD;
        let is_full = runs.len() == MOST_RUNS;
        match runs.last_mut().filter(|last| last.end == word.start) {
            Some(last) => last.end = word.end,
            None if is_full => return None,
            None => runs.push(word),
        }
    }
    Some(runs)
}

/// A buffer that the GPU fills.
#[derive(Debug)]
pub struct Room {
    label: &'static str,
    usage: wgpu::BufferUsages,
    buffer: wgpu::Buffer,
    /// What to do where the GPU has no such buffer.
    advice: &'static str,
}

impl Room {
    /// A small one.
    pub fn new(
        gpu: &Gpu,
        label: &'static str,
        usage: wgpu::BufferUsages,
        advice: &'static str,
    ) -> Result<Self, GpuError> {
        Ok(Self { label, usage, buffer: gpu.empty_buffer(label, usage, LEAST_BYTES)?, advice })
    }

    /// The buffer to bind.
    pub fn buffer(&self) -> &wgpu::Buffer {
        &self.buffer
    }

    /// Makes room for so many bytes, and up to an eighth more, so that what grows a little does not have it made anew in every
    /// frame; `true` if it had to be replaced (bind groups are stale then).
    pub fn fit(&mut self, gpu: &Gpu, bytes: u64) -> Result<bool, GpuError> {
        if bytes <= self.buffer.size() {
            return Ok(false);
        }
        let size = bytes.next_multiple_of((bytes.next_power_of_two() / 16).max(256));
        self.buffer = gpu.empty_buffer(self.label, self.usage, size).map_err(|error| match error {
            GpuError::TooLarge { what, needed, allowed, adapter, .. } => {
                GpuError::TooLarge { what, needed, allowed, adapter, advice: self.advice.to_owned() }
            }
            other => other,
        })?;
        Ok(true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_changes_is_told_in_words() {
        let before: Vec<u8> = (0..32).collect();
        let with = |places: &[usize]| {
            let mut after = before.clone();
            places.iter().for_each(|&at| after[at] = 99);
            changed(&before, &after)
        };
        assert_eq!(with(&[]), Some(vec![]));
        assert_eq!(with(&[5]).map(|runs| runs.into_iter().flatten().collect()), Some(vec![4, 5, 6, 7]));
        assert_eq!(with(&[3, 4, 11, 31]), Some(vec![0..12, 28..32]));
        assert_eq!(changed(&before, &before[4..]), None, "of another length");
        let (zeros, every_other) = (vec![0; 8 * (MOST_RUNS + 1)], [1, 0, 0, 0, 0, 0, 0, 0].repeat(MOST_RUNS + 1));
        assert_eq!(changed(&zeros, &every_other), None, "too many");
        assert_eq!(changed(&zeros[8..], &every_other[8..]).map(|runs| runs.len()), Some(MOST_RUNS));
    }
}
