//! Textures and buffers back to the CPU, tightly packed, row 0 at the top.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

use super::{Gpu, GpuError};

impl Gpu {
    /// One layer of a texture, mip 0, `bytes_per_texel` each, rows without padding.
    pub fn read_texture(
        &self,
        texture: &wgpu::Texture,
        layer: u32,
        aspect: wgpu::TextureAspect,
    ) -> Result<Vec<u8>, GpuError> {
        let bytes_per_texel = texture.format().block_copy_size(Some(aspect)).unwrap_or(4);
        let (width, height) = (texture.width(), texture.height());
        let row = width * bytes_per_texel;
        let pitch = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let staging = self.empty_buffer(
            "read-back",
            wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            u64::from(pitch) * u64::from(height),
        )?;
        let from = wgpu::TexelCopyTextureInfo {
            texture,
            mip_level: 0,
            origin: wgpu::Origin3d { x: 0, y: 0, z: layer },
            aspect,
        };
        let to = wgpu::TexelCopyBufferInfo {
            buffer: &staging,
            layout: wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(pitch), rows_per_image: None },
        };
        self.guarded(|| {
            let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            encoder.copy_texture_to_buffer(from, to, wgpu::Extent3d { width, height, depth_or_array_layers: 1 });
            self.queue.submit([encoder.finish()]);
            Ok(())
        })?;
        self.mapped(&staging, |mapped| {
            let mut packed = Vec::with_capacity(row as usize * height as usize);
            for line in mapped.chunks(pitch as usize).take(height as usize) {
                packed.extend_from_slice(&line[..row as usize]);
            }
            packed
        })
    }

    /// The bytes of a buffer made with `COPY_SRC`.
    pub fn read_buffer(&self, buffer: &wgpu::Buffer) -> Result<Vec<u8>, GpuError> {
        let usage = wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ;
        let staging = self.empty_buffer("read-back", usage, buffer.size())?;
        self.guarded(|| {
            let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            encoder.copy_buffer_to_buffer(buffer, 0, &staging, 0, buffer.size());
            self.queue.submit([encoder.finish()]);
            Ok(())
        })?;
        self.mapped(&staging, <[u8]>::to_vec)
    }

    /// Waits for what was submitted, and shows `read` the bytes of a buffer made with `MAP_READ`.
    pub fn mapped<T>(&self, staging: &wgpu::Buffer, read: impl FnOnce(&[u8]) -> T) -> Result<T, GpuError> {
        let failed = Arc::new(AtomicBool::new(false));
        let flag = failed.clone();
        // Of a device that is gone there is no buffer.
        self.guarded(|| {
            staging.slice(..).map_async(wgpu::MapMode::Read, move |result| flag.store(result.is_err(), Relaxed));
            Ok(())
        })?;
        self.wait()?;
        self.check()?;
        let failure = || GpuError::Failed { adapter: self.name(), message: "a read-back was refused".to_owned() };
        if failed.load(Relaxed) {
            return Err(failure());
        }
        let view = staging.slice(..).get_mapped_range().map_err(|_| failure())?;
        let found = read(&view);
        drop(view);
        staging.unmap();
        Ok(found)
    }
}
