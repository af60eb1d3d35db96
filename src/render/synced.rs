//! A buffer that is written only when its content changes.

use crate::gpu::{Gpu, GpuError};

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
        Ok(Self { label, usage, bytes: Vec::new(), buffer: gpu.empty_buffer(label, usage, 256)? })
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
