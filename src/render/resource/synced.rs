//! Buffers that follow a scene: written only when their content changes, or by the GPU alone.

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
        if !bytes.is_empty() {
            gpu.write(&self.buffer, bytes);
        }
        self.bytes.clear();
        self.bytes.extend_from_slice(bytes);
        Ok(grown)
    }
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
