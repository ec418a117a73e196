//! The smallest files that pass for shared libraries by their headers.

/// Linux, for a machine of ELF's numbers: 62 is x86-64, 183 ARM of 64 bits.
pub fn elf(machine: u16) -> Vec<u8> {
    let mut library = b"\x7fELF\x02\x01\x01".to_vec();
    library.resize(16, 0);
    library.extend(3_u16.to_le_bytes());
    library.extend(machine.to_le_bytes());
    library.resize(64, 0);
    library
}

/// Windows, for a machine of COFF's numbers: 0x8664 is x86-64.
pub fn pe(machine: u16) -> Vec<u8> {
    let mut library = b"MZ".to_vec();
    library.resize(0x3c, 0);
    library.extend(0x40_u32.to_le_bytes());
    library.extend(b"PE\0\0");
    library.extend(machine.to_le_bytes());
    library.resize(0x40 + 22, 0);
    library.extend(0x2022_u16.to_le_bytes());
    library.resize(0x80, 0);
    library
}

/// macOS, for a processor of Mach-O's numbers: 0x01000007 is x86-64, 0x0100000c ARM of 64 bits.
#[allow(dead_code)]
pub fn mach_o(processor: u32) -> Vec<u8> {
    let mut library = b"\xcf\xfa\xed\xfe".to_vec();
    library.extend(processor.to_le_bytes());
    library.resize(12, 0);
    library.extend(6_u32.to_le_bytes());
    library.resize(32, 0);
    library
}

/// macOS, for several processors.
#[allow(dead_code)]
pub fn universal(processors: &[u32]) -> Vec<u8> {
    let mut library = b"\xca\xfe\xba\xbe".to_vec();
    library.extend((processors.len() as u32).to_be_bytes());
    let mut start = 8 + 20 * processors.len() as u32;
    for processor in processors {
        let length = mach_o(*processor).len() as u32;
        for number in [*processor, 0, start, length, 0] {
            library.extend(number.to_be_bytes());
        }
        start += length;
    }
    processors
        .iter()
        .for_each(|processor| library.extend(mach_o(*processor)));
    library
}
