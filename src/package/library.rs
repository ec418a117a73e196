//! The target of a shared library, by its header.

/// The target of a shared library. All have 64 bits, as the platforms of an FMU do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Target {
    LinuxX86,
    LinuxArm,
    WindowsX86,
    MacX86,
    MacArm,
}

impl Target {
    /// The targets of the shared library in a file: on macOS one file may contain several.
    pub fn of(library: &[u8]) -> Vec<Self> {
        let one = elf(library)
            .or_else(|| pe(library))
            .or_else(|| mach_o(library));
        one.map_or_else(
            || universal(library).unwrap_or_default(),
            |target| vec![target],
        )
    }
}

fn array<const N: usize>(bytes: &[u8], at: usize) -> Option<[u8; N]> {
    bytes.get(at..)?.first_chunk().copied()
}

fn u16_at(bytes: &[u8], at: usize) -> Option<u16> {
    array(bytes, at).map(u16::from_le_bytes)
}

fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    array(bytes, at).map(u32::from_le_bytes)
}

/// Linux (System V ABI, "ELF header"): 64 bits, little-endian, a shared object.
fn elf(library: &[u8]) -> Option<Target> {
    const SHARED_OBJECT: u16 = 3;
    let is_shared =
        library.starts_with(b"\x7fELF\x02\x01") && u16_at(library, 16)? == SHARED_OBJECT;
    match u16_at(library, 18)? {
        62 if is_shared => Some(Target::LinuxX86),
        183 if is_shared => Some(Target::LinuxArm),
        _ => None,
    }
}

/// Windows ("PE Format"): the COFF header with its machine stands behind the DOS program.
fn pe(library: &[u8]) -> Option<Target> {
    const AMD64: u16 = 0x8664;
    const DLL: u16 = 0x2000;
    let start = u32_at(library, 0x3c)? as usize;
    let header = library.get(start..)?;
    let is_pe = library.starts_with(b"MZ") && header.starts_with(b"PE\0\0");
    let is_ours = u16_at(header, 4)? == AMD64 && u16_at(header, 22)? & DLL != 0;
    (is_pe && is_ours).then_some(Target::WindowsX86)
}

const MAC_X86: u32 = 0x0100_0007;
const MAC_ARM: u32 = 0x0100_000c;

/// macOS (`mach-o/loader.h`): 64 bits, a dynamic library or a bundle.
fn mach_o(library: &[u8]) -> Option<Target> {
    let is_shared =
        library.starts_with(b"\xcf\xfa\xed\xfe") && matches!(u32_at(library, 12)?, 6 | 8);
    match u32_at(library, 4)? {
        MAC_X86 if is_shared => Some(Target::MacX86),
        MAC_ARM if is_shared => Some(Target::MacArm),
        _ => None,
    }
}

/// Several of macOS' in one file (`mach-o/fat.h`), each at an offset in a big-endian table; nothing unless all are there.
fn universal(library: &[u8]) -> Option<Vec<Target>> {
    /// Java's classes have the same first bytes, and here a version from 45 on.
    const MAX_COUNT: u32 = 16;
    let number = |at: usize| array(library, at).map(u32::from_be_bytes);
    let count = number(4).filter(|count| *count <= MAX_COUNT)?;
    if !library.starts_with(b"\xca\xfe\xba\xbe") {
        return None;
    }
    let one = |index: u32| {
        let entry = 8 + 20 * index as usize;
        let (start, length) = (number(entry + 8)? as usize, number(entry + 12)? as usize);
        mach_o(library.get(start..start.checked_add(length)?)?)
    };
    (0..count).map(one).collect()
}

#[cfg(test)]
#[path = "../../tests/common/libraries.rs"]
pub(super) mod minimal;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn libraries_are_known_by_their_headers() {
        for (library, expected) in [
            (minimal::elf(62), &[Target::LinuxX86][..]),
            (minimal::elf(183), &[Target::LinuxArm]),
            (minimal::pe(0x8664), &[Target::WindowsX86]),
            (minimal::mach_o(MAC_X86), &[Target::MacX86]),
            (minimal::mach_o(MAC_ARM), &[Target::MacArm]),
            (
                minimal::universal(&[MAC_X86, MAC_ARM]),
                &[Target::MacX86, Target::MacArm],
            ),
            // i386 in each format.
            (minimal::elf(3), &[]),
            (minimal::pe(0x014c), &[]),
            (minimal::mach_o(7), &[]),
            (minimal::universal(&[7]), &[]),
            // A script, a Java class and nothing.
            (b"#!/bin/sh\nrm -rf ~\n".repeat(9), &[]),
            (b"\xca\xfe\xba\xbe\0\0\0\x34".repeat(9), &[]),
            (Vec::new(), &[]),
        ] {
            assert_eq!(Target::of(&library), expected, "{library:?}");
        }
    }

    #[test]
    fn programs_and_cut_files_are_no_libraries() {
        let mut program = minimal::elf(62);
        program[16] = 2;
        assert_eq!(Target::of(&program), []);
        let mut wide = minimal::elf(62);
        wide[4] = 1;
        assert_eq!(Target::of(&wide), []);
        for library in [
            minimal::elf(62),
            minimal::pe(0x8664),
            minimal::universal(&[MAC_ARM]),
        ] {
            let header = library.iter().rposition(|byte| *byte != 0).unwrap();
            for length in 0..header {
                assert_eq!(Target::of(&library[..length]), [], "{length}");
            }
        }
    }
}
