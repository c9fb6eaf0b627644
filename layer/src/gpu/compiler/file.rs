//! The data of a pipeline cache between two launches: a line with version, device and checksum, then the data.

use crate::cache_file::{self, checksum};
use ash::vk;
use std::fmt::Write as _;
use std::io;
use std::path::{Path, PathBuf};

/// Beginning of the first line. The number changes with the format; the rest is of this build, whose pipelines the data is of.
const HEADER: &str =
    concat!("parafovea pipelines 1 ", env!("CARGO_PKG_VERSION"), " ", env!("SHADERS_CHECKSUM"), " ");

/// Most bytes of a file: the pipelines of all kernels take 0.1 to 1 MiB.
const MAX_BYTES: u64 = 8 << 20;

/// File of the data of one device, and the first line, which identifies the device.
pub(super) struct CacheFile {
    path: PathBuf,
    first: String,
}

impl CacheFile {
    /// Of a device, in `folder`: a file for each device, whose driver's last version counts.
    pub(super) fn new(folder: &Path, properties: &vk::PhysicalDeviceProperties) -> Self {
        let vk::PhysicalDeviceProperties {
            vendor_id, device_id, pipeline_cache_uuid, driver_version, ..
        } = *properties;
        let mut first = format!("{HEADER}{vendor_id:04x}:{device_id:04x} {driver_version:08x} ");
        for byte in pipeline_cache_uuid {
            // Writing to a String cannot fail.
            let _ = write!(first, "{byte:02x}");
        }
        first.push(' ');
        Self { path: folder.join(format!("pipelines-{vendor_id:04x}-{device_id:04x}")), first }
    }

    /// The data; `None` where there is none, or it is damaged, another build's or another driver's.
    pub(super) fn read(&self) -> Option<Vec<u8>> {
        let bytes = cache_file::read(&self.path, MAX_BYTES)?;
        let rest = bytes.strip_prefix(self.first.as_bytes())?;
        let (sum, data) = rest.split_at_checked(16)?;
        let data = data.strip_prefix(b"\n")?;
        let sum = u64::from_str_radix(str::from_utf8(sum).ok()?, 16).ok()?;
        (sum == checksum(data)).then(|| data.to_vec())
    }

    /// Writes the data for the next launch.
    ///
    /// # Errors
    /// A failed call; data that would be too large to be read.
    pub(super) fn write(&self, data: &[u8]) -> io::Result<()> {
        let mut bytes = format!("{}{:016x}\n", self.first, checksum(data)).into_bytes();
        bytes.extend_from_slice(data);
        if bytes.len() as u64 > MAX_BYTES {
            return Err(io::ErrorKind::FileTooLarge.into());
        }
        cache_file::write(&self.path, &bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn device(id: u32, uuid: u8) -> vk::PhysicalDeviceProperties {
        vk::PhysicalDeviceProperties {
            vendor_id: 0x1002,
            device_id: id,
            driver_version: 7,
            pipeline_cache_uuid: [uuid; 16],
            ..Default::default()
        }
    }

    #[test]
    fn only_the_same_driver_of_the_same_device_reads_what_was_written() {
        let folder = tempfile::tempdir().unwrap();
        let file = |id, uuid| CacheFile::new(folder.path(), &device(id, uuid));
        assert_eq!(file(1, 2).read(), None);
        file(1, 2).write(b"some data\nof a driver").unwrap();
        assert_eq!(file(1, 2).read().as_deref(), Some(&b"some data\nof a driver"[..]));
        assert_eq!((file(1, 3).read(), file(2, 2).read()), (None, None));
        let updated = vk::PhysicalDeviceProperties { driver_version: 8, ..device(1, 2) };
        assert_eq!(CacheFile::new(folder.path(), &updated).read(), None);
        file(1, 3).write(b"another driver's").unwrap();
        assert_eq!(file(1, 2).read(), None);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "one file for each device");
        assert!(file(1, 2).write(&vec![0; MAX_BYTES as usize]).is_err());
    }

    /// A file that is cut at any byte, or has any one byte changed.
    #[test]
    fn a_damaged_file_has_no_data() {
        let folder = tempfile::tempdir().unwrap();
        let file = CacheFile::new(folder.path(), &device(1, 2));
        file.write(b"data").unwrap();
        let bytes = fs::read(&file.path).unwrap();
        for end in 0..bytes.len() {
            fs::write(&file.path, &bytes[..end]).unwrap();
            assert_eq!(file.read(), None, "cut after {end} bytes");
        }
        for index in 0..bytes.len() {
            let mut damaged = bytes.clone();
            damaged[index] ^= 1;
            fs::write(&file.path, damaged).unwrap();
            assert_eq!(file.read(), None, "byte {index}");
        }
    }
}
