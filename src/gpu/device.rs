//! The device and everything that is made on it.
//!
//! Every allocation and upload goes through [`Gpu`], so that "nothing is allocated or uploaded while
//! nothing changes" is a number one can read and not a promise.

use std::sync::{
    Arc, Mutex, PoisonError,
    atomic::{AtomicU64, Ordering::Relaxed},
};

use wgpu::util::DeviceExt;

use super::snapping;

/// What a 3D texture takes, bytes, at most.
const MOST_3D_BYTES: u64 = 4 << 30;

/// What can go wrong between here and the GPU.
#[derive(Debug, thiserror::Error)]
pub enum GpuError {
    /// No adapter at all, none of the wanted name, or none that will do.
    #[error("{0}")]
    NoAdapter(String),
    /// The device was refused.
    #[error("graphics adapter {adapter}: {message}")]
    NoDevice {
        /// Its name.
        adapter: String,
        /// What it said.
        message: String,
    },
    /// An allocation that would not fit.
    #[error("{what} needs {needed} of graphics memory in one piece, but {adapter} allows {allowed}; {advice}")]
    TooLarge {
        /// What was to be made.
        what: String,
        /// Its size.
        needed: String,
        /// The largest the adapter takes.
        allowed: String,
        /// Its name.
        adapter: String,
        /// What would help.
        advice: String,
    },
    /// More of something than a picture takes.
    #[error("{what}: {count}; one picture takes {most}")]
    TooMany {
        /// Of what.
        what: &'static str,
        /// How many there are.
        count: usize,
        /// How many there may be.
        most: usize,
    },
    /// Something the driver reported while working.
    #[error("graphics adapter {adapter}: {message}")]
    Failed {
        /// Its name.
        adapter: String,
        /// What it said.
        message: String,
    },
}

/// A device with its queue, and counters of what was made on it.
#[derive(Debug)]
pub struct Gpu {
    /// wgpu's device.
    pub device: wgpu::Device,
    /// Its only queue.
    pub queue: wgpu::Queue,
    /// Name, backend, kind.
    pub info: wgpu::AdapterInfo,
    /// How far from their places corners of triangles are drawn at most, pixels, measured when it is opened; 0 where depth is made of corners
    /// that have not been moved. What is seen may be off along the normal of its face by so much.
    pub snapping: f64,
    /// Whether depths of thin triangles leave those of their corners: pixels are covered by corners on a grid, and depth is made of corners
    /// in their places.
    pub strays: bool,
    allocations: AtomicU64,
    uploads: AtomicU64,
    uploaded_bytes: AtomicU64,
    allocated_bytes: AtomicU64,
    /// What the driver complained about first while nobody was on guard.
    trouble: Arc<Mutex<Option<String>>>,
}

/// No buffer is smaller: any one structure of the shaders fits, so an empty list can be bound too.
const LEAST_BYTES: usize = 256;

/// Features used where the adapter has them; nothing here is required.
fn wanted_features() -> wgpu::Features {
    wgpu::Features::TIMESTAMP_QUERY
        | wgpu::Features::PIPELINE_STATISTICS_QUERY
        | wgpu::Features::FLOAT32_BLENDABLE
        | wgpu::Features::FLOAT32_FILTERABLE
        | wgpu::Features::SHADER_EARLY_DEPTH_TEST
}

impl Gpu {
    /// Opens an adapter: the one whose name contains `VEDUTA_ADAPTER`, else hardware first, else software.
    pub fn open() -> Result<Self, GpuError> {
        let wanted = std::env::var("VEDUTA_ADAPTER").ok().filter(|w| !w.is_empty());
        pollster::block_on(Self::open_async(wanted.as_deref()))
    }

    async fn open_async(wanted: Option<&str>) -> Result<Self, GpuError> {
        // GL is asked only where nothing better answers: its libraries complain on stderr where there is no display.
        let mut adapters = adapters_of(wgpu::Backends::PRIMARY).await;
        if adapters.is_empty() {
            adapters = adapters_of(wgpu::Backends::SECONDARY).await;
        }
        let names: Vec<String> = adapters.iter().map(|a| describe(&a.get_info())).collect();
        if let Some(wanted) = wanted {
            let needle = wanted.to_lowercase();
            adapters.retain(|a| describe(&a.get_info()).to_lowercase().contains(&needle));
            if adapters.is_empty() {
                let found = if names.is_empty() { "none".to_owned() } else { names.join("; ") };
                return Err(GpuError::NoAdapter(format!(
                    "VEDUTA_ADAPTER=\"{wanted}\" matches no graphics adapter; found: {found}"
                )));
            }
        }
        adapters.sort_by_key(|a| rank(&a.get_info()));
        let mut refusals: Vec<String> = Vec::new();
        for adapter in adapters {
            match Self::on(&adapter).await {
                Ok(gpu) => {
                    refusals.iter().for_each(|refusal| log::warn!("passed over: {refusal}"));
                    return Ok(gpu);
                }
                Err(error) => refusals.push(error.to_string()),
            }
        }
        let found = if refusals.is_empty() { "no graphics adapter found".to_owned() } else { refusals.join("; ") };
        Err(GpuError::NoAdapter(format!("{found}; {PACKAGE}")))
    }

    async fn on(adapter: &wgpu::Adapter) -> Result<Self, GpuError> {
        let info = adapter.get_info();
        let limits = adapter.limits();
        let flags = adapter.get_downlevel_capabilities().flags;
        let lacks = lacking(&limits, flags);
        if !lacks.is_empty() {
            let message = format!("it lacks {}", lacks.join(", "));
            return Err(GpuError::NoDevice { adapter: describe(&info), message });
        }
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("veduta"),
            required_features: adapter.features() & wanted_features(),
            required_limits: limits,
            experimental_features: wgpu::ExperimentalFeatures::disabled(),
            memory_hints: wgpu::MemoryHints::default(),
            trace: wgpu::Trace::Off,
        };
        let (device, queue) = adapter
            .request_device(&descriptor)
            .await
            .map_err(|error| GpuError::NoDevice { adapter: describe(&info), message: one_line(&error.to_string()) })?;
        let trouble = Arc::new(Mutex::new(None));
        let first = trouble.clone();
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            log::debug!("{error}");
            first.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert_with(|| one_line(&error.to_string()));
        }));
        let mut gpu = Self {
            device,
            queue,
            info,
            snapping: 0.0,
            strays: false,
            allocations: AtomicU64::new(0),
            uploads: AtomicU64::new(0),
            uploaded_bytes: AtomicU64::new(0),
            allocated_bytes: AtomicU64::new(0),
            trouble,
        };
        (gpu.snapping, gpu.strays) = snapping::measured(&gpu)?;
        if gpu.is_software() {
            log::info!("software graphics adapter in use: {}", gpu.name());
        }
        Ok(gpu)
    }

    /// The adapter's name and backend.
    pub fn name(&self) -> String {
        describe(&self.info)
    }

    /// Whether the adapter is a program, not a GPU.
    pub fn is_software(&self) -> bool {
        self.info.device_type == wgpu::DeviceType::Cpu
    }

    /// Whether shaders that store can have the depth test before them.
    pub fn tests_depth_early(&self) -> bool {
        self.device.features().contains(wgpu::Features::SHADER_EARLY_DEPTH_TEST)
    }

    /// `hardware`, `integrated`, `virtual`, `software` or `other`.
    pub fn kind(&self) -> &'static str {
        match self.info.device_type {
            wgpu::DeviceType::DiscreteGpu => "hardware",
            wgpu::DeviceType::IntegratedGpu => "integrated",
            wgpu::DeviceType::VirtualGpu => "virtual",
            wgpu::DeviceType::Cpu => "software",
            wgpu::DeviceType::Other => "other",
        }
    }

    /// Allocations so far.
    pub fn allocations(&self) -> u64 {
        self.allocations.load(Relaxed)
    }

    /// Uploads (buffer and texture writes) so far.
    pub fn uploads(&self) -> u64 {
        self.uploads.load(Relaxed)
    }

    /// Bytes of these.
    pub fn uploaded_bytes(&self) -> u64 {
        self.uploaded_bytes.load(Relaxed)
    }

    fn count_upload(&self, bytes: u64) {
        self.uploads.fetch_add(1, Relaxed);
        self.uploaded_bytes.fetch_add(bytes, Relaxed);
    }

    /// Bytes ever allocated through this device.
    pub fn allocated_bytes(&self) -> u64 {
        self.allocated_bytes.load(Relaxed)
    }

    fn count_allocation(&self, bytes: u64) {
        self.allocations.fetch_add(1, Relaxed);
        self.allocated_bytes.fetch_add(bytes, Relaxed);
    }

    /// Refuses what the adapter cannot hold in one buffer or bind at once.
    fn check_buffer(&self, what: &str, bytes: u64, usage: wgpu::BufferUsages) -> Result<(), GpuError> {
        let limits = self.device.limits();
        let mut allowed = limits.max_buffer_size;
        if usage.contains(wgpu::BufferUsages::STORAGE) {
            allowed = allowed.min(limits.max_storage_buffer_binding_size);
        }
        if bytes <= allowed {
            return Ok(());
        }
        Err(GpuError::TooLarge {
            what: what.to_owned(),
            needed: mebibytes(bytes),
            allowed: mebibytes(allowed),
            adapter: self.name(),
            advice: "load fewer files or cap the level of detail ([city] lod)".to_owned(),
        })
    }

    /// Refuses a texture of more rows than the adapter takes; `row_bytes` is what each holds.
    pub fn check_rows(&self, what: &str, rows: u32, row_bytes: u64) -> Result<(), GpuError> {
        let allowed = self.device.limits().max_texture_dimension_2d;
        if rows <= allowed {
            return Ok(());
        }
        Err(GpuError::TooLarge {
            what: what.to_owned(),
            needed: mebibytes(u64::from(rows) * row_bytes),
            allowed: mebibytes(u64::from(allowed) * row_bytes),
            adapter: self.name(),
            advice: "load fewer files or cap the level of detail ([city] lod)".to_owned(),
        })
    }

    /// A buffer holding `data` (at least [`LEAST_BYTES`], so that it can always be bound).
    pub fn buffer<T: bytemuck::NoUninit>(
        &self,
        label: &str,
        usage: wgpu::BufferUsages,
        data: &[T],
    ) -> Result<wgpu::Buffer, GpuError> {
        let bytes: &[u8] = bytemuck::cast_slice(data);
        self.check_buffer(label, bytes.len() as u64, usage)?;
        let padded;
        let contents = if bytes.len() >= LEAST_BYTES && bytes.len().is_multiple_of(4) {
            bytes
        } else {
            padded = [bytes, &vec![0; bytes.len().next_multiple_of(16).max(LEAST_BYTES) - bytes.len()]].concat();
            &padded
        };
        self.count_allocation(contents.len() as u64);
        self.count_upload(contents.len() as u64);
        Ok(self.device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: Some(label), contents, usage }))
    }

    /// Whether triangles hold their depth where they are seen edge on: it needs that, and can bind what it takes.
    pub fn holds_depth(&self) -> bool {
        self.strays && self.device.limits().max_bind_groups > 4
    }

    /// What vertices and indices of so many bytes are used for beside being drawn from, where corners must be read by each other so that
    /// triangles hold their depth; nothing where they need not, or there are too many of them.
    pub fn read_by_corners(&self, bytes: usize) -> wgpu::BufferUsages {
        let is_bound = bytes as u64 <= self.device.limits().max_storage_buffer_binding_size;
        if self.holds_depth() && is_bound { wgpu::BufferUsages::STORAGE } else { wgpu::BufferUsages::empty() }
    }

    /// A buffer of `bytes` zeros (at least [`LEAST_BYTES`]).
    pub fn empty_buffer(&self, label: &str, usage: wgpu::BufferUsages, bytes: u64) -> Result<wgpu::Buffer, GpuError> {
        let size = bytes.max(LEAST_BYTES as u64).next_multiple_of(16);
        self.check_buffer(label, size, usage)?;
        self.count_allocation(size);
        Ok(self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size,
            usage,
            mapped_at_creation: false,
        }))
    }

    /// Replaces the start of a buffer.
    pub fn write<T: bytemuck::NoUninit>(&self, buffer: &wgpu::Buffer, data: &[T]) {
        self.write_from(buffer, 0, data);
    }

    /// Replaces a part of a buffer from a byte on, a multiple of 4.
    pub fn write_from<T: bytemuck::NoUninit>(&self, buffer: &wgpu::Buffer, first_byte: u64, data: &[T]) {
        let bytes: &[u8] = bytemuck::cast_slice(data);
        self.count_upload(bytes.len() as u64);
        self.queue.write_buffer(buffer, first_byte, bytes);
    }

    /// A 2D texture (array), one sample per texel.
    pub fn texture(
        &self,
        label: &str,
        [width, height, layers]: [u32; 3],
        mip_level_count: u32,
        format: wgpu::TextureFormat,
        usage: wgpu::TextureUsages,
    ) -> wgpu::Texture {
        let texel = u64::from(format.block_copy_size(None).unwrap_or(4));
        self.count_allocation(u64::from(width) * u64::from(height) * u64::from(layers) * texel);
        self.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d { width, height, depth_or_array_layers: layers },
            mip_level_count,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage,
            view_formats: &[],
        })
    }

    /// A 3D texture to read from.
    ///
    /// # Errors
    /// It has more texels along an edge than the adapter takes, or more in all than a picture may: `what` needs it, `advice` would help.
    pub fn texture_3d(
        &self,
        what: &str,
        [width, height, depth]: [u32; 3],
        format: wgpu::TextureFormat,
        advice: &str,
    ) -> Result<wgpu::Texture, GpuError> {
        let most = self.device.limits().max_texture_dimension_3d;
        let texel = u64::from(format.block_copy_size(None).unwrap_or(4));
        let bytes = [height, depth].iter().try_fold(u64::from(width) * texel, |all, n| all.checked_mul((*n).into()));
        let too_large = |allowed: String| GpuError::TooLarge {
            what: what.to_owned(),
            needed: format!("{width} x {height} x {depth} texels"),
            allowed,
            adapter: self.name(),
            advice: advice.to_owned(),
        };
        if [width, height, depth].iter().any(|n| *n > most) {
            return Err(too_large(format!("{most} along an edge")));
        }
        let bytes = bytes.filter(|bytes| *bytes <= MOST_3D_BYTES).ok_or_else(|| too_large(mebibytes(MOST_3D_BYTES)))?;
        self.count_allocation(bytes);
        Ok(self.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(what),
            size: wgpu::Extent3d { width, height, depth_or_array_layers: depth },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D3,
            format,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        }))
    }

    /// Fills a box of a 3D texture, from a slice on; `texels` are tightly packed.
    pub fn write_texture_box(&self, texture: &wgpu::Texture, first_slice: u32, size: [u32; 3], texels: &[u8]) {
        self.count_upload(texels.len() as u64);
        let [width, height, depth_or_array_layers] = size;
        let row = width * texture.format().block_copy_size(None).unwrap_or(4);
        let origin = wgpu::Origin3d { z: first_slice, ..wgpu::Origin3d::ZERO };
        self.queue.write_texture(
            wgpu::TexelCopyTextureInfo { origin, ..texture.as_image_copy() },
            texels,
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: Some(height) },
            wgpu::Extent3d { width, height, depth_or_array_layers },
        );
    }

    /// Fills one mip level of a texture's first layer; `texels` are tightly packed.
    pub fn write_texture_level(&self, texture: &wgpu::Texture, level: u32, texels: &[u8]) {
        self.count_upload(texels.len() as u64);
        let size = texture.size().mip_level_size(level, wgpu::TextureDimension::D2);
        let texel = texture.format().block_copy_size(None).unwrap_or(4);
        self.queue.write_texture(
            wgpu::TexelCopyTextureInfo { mip_level: level, ..texture.as_image_copy() },
            texels,
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(size.width * texel), rows_per_image: None },
            wgpu::Extent3d { depth_or_array_layers: 1, ..size },
        );
    }

    /// Replaces whole rows of a 2D texture's first layer and level, from one on.
    pub fn write_texture_rows(&self, texture: &wgpu::Texture, first_row: u32, texels: &[u8]) {
        self.count_upload(texels.len() as u64);
        let row = texture.width() * texture.format().block_copy_size(None).unwrap_or(4);
        let origin = wgpu::Origin3d { y: first_row, ..wgpu::Origin3d::ZERO };
        self.queue.write_texture(
            wgpu::TexelCopyTextureInfo { origin, ..texture.as_image_copy() },
            texels,
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: None },
            wgpu::Extent3d { width: texture.width(), height: texels.len() as u32 / row, depth_or_array_layers: 1 },
        );
    }

    /// Waits until everything submitted is done.
    pub fn wait(&self) -> Result<(), GpuError> {
        match self.device.poll(wgpu::PollType::wait_indefinitely()) {
            Ok(_) => Ok(()),
            Err(error) => Err(GpuError::Failed { adapter: self.name(), message: error.to_string() }),
        }
    }

    /// What the driver has complained about since this was asked last, where [`Self::guarded`] did not hear it.
    ///
    /// # Errors
    /// The first of it.
    pub fn check(&self) -> Result<(), GpuError> {
        match self.trouble.lock().unwrap_or_else(PoisonError::into_inner).take() {
            Some(message) => Err(GpuError::Failed { adapter: self.name(), message }),
            None => Ok(()),
        }
    }

    /// Runs `work` and turns what the driver complains about meanwhile into an error.
    pub fn guarded<T>(&self, work: impl FnOnce() -> Result<T, GpuError>) -> Result<T, GpuError> {
        let memory = self.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let validation = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let result = work();
        let failures = [pollster::block_on(validation.pop()), pollster::block_on(memory.pop())];
        match failures.into_iter().flatten().next() {
            Some(error) => Err(GpuError::Failed { adapter: self.name(), message: one_line(&error.to_string()) }),
            None => result,
        }
    }
}

/// Where one is to be had that will do.
const PACKAGE: &str = "on Debian and Ubuntu the package mesa-vulkan-drivers gives a software one";

/// What an adapter lacks of what is needed.
fn lacking(limits: &wgpu::Limits, flags: wgpu::DownlevelFlags) -> Vec<&'static str> {
    use wgpu::DownlevelFlags as F;
    let needed = [
        (limits.max_storage_buffers_per_shader_stage >= 8, "eight storage buffers"),
        (limits.max_color_attachment_bytes_per_sample >= 64, "wide render targets"),
        (limits.max_compute_workgroups_per_dimension > 0 && flags.contains(F::COMPUTE_SHADERS), "compute shaders"),
        (flags.contains(F::FRAGMENT_WRITABLE_STORAGE), "storage that fragments write"),
        (flags.contains(F::VERTEX_STORAGE), "storage that vertices read"),
        (flags.contains(F::DEPTH_TEXTURE_AND_BUFFER_COPIES), "depth that can be read back"),
        (flags.contains(F::COMPARISON_SAMPLERS), "comparison samplers"),
        (flags.contains(F::INDEPENDENT_BLEND), "independent blending"),
        (flags.contains(F::BASE_VERTEX), "base vertices"),
    ];
    needed.into_iter().filter(|(has, _)| !has).map(|(_, what)| what).collect()
}

/// A driver's complaint, which may be long and of many lines, in one.
fn one_line(text: &str) -> String {
    const MOST: usize = 300;
    let words = text.split_whitespace().collect::<Vec<_>>().join(" ");
    match words.char_indices().nth(MOST) {
        Some((end, _)) => format!("{} …", &words[..end]),
        None => words,
    }
}

async fn adapters_of(backends: wgpu::Backends) -> Vec<wgpu::Adapter> {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle_from_env();
    descriptor.backends &= backends;
    wgpu::Instance::new(descriptor).enumerate_adapters(backends).await
}

fn describe(info: &wgpu::AdapterInfo) -> String {
    format!("{} ({:?})", info.name, info.backend)
}

/// Hardware first; among equals the backend with full features.
fn rank(info: &wgpu::AdapterInfo) -> (u8, u8) {
    let kind = match info.device_type {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Cpu => 3,
        // GL reports "other" for software and hardware alike: prefer a Vulkan one of known kind.
        wgpu::DeviceType::Other => 4,
    };
    (kind, u8::from(info.backend == wgpu::Backend::Gl))
}

fn mebibytes(bytes: u64) -> String {
    format!("{:.0} MiB", bytes as f64 / f64::from(1 << 20))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_an_adapter_lacks_is_said() {
        let (limits, all) = (wgpu::Limits::default(), wgpu::DownlevelFlags::all());
        assert_eq!(
            lacking(&wgpu::Limits { max_color_attachment_bytes_per_sample: 64, ..limits.clone() }, all),
            [""; 0]
        );
        let few = wgpu::Limits {
            max_storage_buffers_per_shader_stage: 4,
            max_color_attachment_bytes_per_sample: 64,
            ..limits
        };
        let flags = all - wgpu::DownlevelFlags::DEPTH_TEXTURE_AND_BUFFER_COPIES;
        assert_eq!(lacking(&few, flags), ["eight storage buffers", "depth that can be read back"]);
    }

    #[test]
    fn complaints_are_one_line() {
        assert_eq!(
            one_line("Validation Error\n\nCaused by:\n  In a CommandEncoder\n"),
            "Validation Error Caused by: In a CommandEncoder"
        );
        assert_eq!(one_line(&"é".repeat(400)).chars().count(), 302);
    }
}
