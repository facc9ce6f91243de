//! Several files as one ZIP, stored without compression: GLB files hold images that are compressed already.
//!
//! APPNOTE.TXT 6.3.10: local headers with their files, the central directory, its end.

use flate2::Crc;

/// The files of a ZIP, by name.
#[derive(Default)]
pub(crate) struct Zip {
    bytes: Vec<u8>,
    directory: Vec<u8>,
    count: u16,
}

/// The first of January 1980: equal files make an equal ZIP.
const DATE: u16 = 1 << 5 | 1;
/// Names are UTF-8.
const FLAGS: u16 = 1 << 11;
/// 2.0, as for folders and plain files.
const VERSION: u16 = 20;

impl Zip {
    /// Adds a file below 4 GiB.
    pub(crate) fn add(&mut self, name: &str, file: &[u8]) {
        let mut crc = Crc::new();
        crc.update(file);
        let offset = self.bytes.len() as u32;
        let size = (file.len() as u32).to_le_bytes();
        let mut common = Vec::new();
        for field in [VERSION, FLAGS, 0, 0, DATE] {
            common.extend(field.to_le_bytes());
        }
        common.extend(crc.sum().to_le_bytes());
        common.extend([size, size].concat());
        common.extend((name.len() as u16).to_le_bytes());
        // Without extra fields.
        common.extend([0; 2]);
        self.bytes.extend(b"PK\x03\x04");
        self.bytes.extend(&common);
        self.bytes.extend(name.as_bytes());
        self.bytes.extend(file);
        self.directory.extend(b"PK\x01\x02");
        self.directory.extend(VERSION.to_le_bytes());
        self.directory.extend(&common);
        // Comment, disk and attributes.
        self.directory.extend([0; 10]);
        self.directory.extend(offset.to_le_bytes());
        self.directory.extend(name.as_bytes());
        self.count += 1;
    }

    /// The ZIP.
    pub(crate) fn finish(mut self) -> Vec<u8> {
        let start = self.bytes.len() as u32;
        let length = self.directory.len() as u32;
        self.bytes.append(&mut self.directory);
        self.bytes.extend(b"PK\x05\x06");
        self.bytes.extend([0; 4]);
        self.bytes.extend(self.count.to_le_bytes());
        self.bytes.extend(self.count.to_le_bytes());
        self.bytes.extend(length.to_le_bytes());
        self.bytes.extend(start.to_le_bytes());
        self.bytes.extend([0; 2]);
        self.bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An empty ZIP is its end alone; a file adds 30 bytes before it, 46 in the directory, and its name twice.
    #[test]
    fn sizes_are_those_of_the_format() {
        assert_eq!(Zip::default().finish().len(), 22);
        let mut zip = Zip::default();
        zip.add("a.glb", b"leaf");
        let bytes = zip.finish();
        assert_eq!(bytes.len(), 22 + 30 + 46 + 2 * 5 + 4);
        // CRC-32 of "leaf".
        assert_eq!(bytes[14..18], 0xc69f_00e7_u32.to_le_bytes());
        assert_eq!(bytes[39..43], *b"PK\x01\x02");
    }
}
