//! Streams that meshoptimizer 1.3 has encoded (`MeshoptEncoder` of its JavaScript), and what its decoder gives for them.

use super::*;

type Stream = ((&'static str, &'static str, u64, u64), &'static [u8], &'static [u8]);

#[rustfmt::skip]
const STREAMS: [Stream; 6] = [
    (
        ("ATTRIBUTES", "OCTAHEDRAL", 4, 5),
        &[160, 1, 63, 192, 0, 0, 43, 171, 10, 106, 1, 63, 192, 0, 0, 104, 110, 146, 24, 0, 1, 63, 192, 0, 0, 3, 4, 3, 4, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 43, 172, 127, 129],
        &[58, 143, 0, 129, 32, 207, 113, 127, 152, 37, 63, 129, 206, 107, 210, 127, 248, 126, 14, 129],
    ),
    (
        ("ATTRIBUTES", "OCTAHEDRAL", 8, 5),
        &[160, 1, 63, 192, 0, 0, 239, 40, 162, 140, 1, 63, 192, 0, 0, 45, 171, 10, 108, 1, 63, 192, 0, 0, 52, 136, 92, 76, 1, 63, 192, 0, 0, 104, 112, 146, 24, 0, 0, 1, 63, 192, 0, 0, 3, 4, 3, 4, 1, 25, 128, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 44, 43, 45, 171, 255, 127, 1, 128],
        &[15, 58, 238, 141, 0, 0, 1, 128, 138, 31, 39, 206, 152, 113, 255, 127, 56, 151, 211, 37, 9, 63, 1, 128, 204, 205, 181, 107, 112, 208, 255, 127, 70, 248, 238, 126, 146, 14, 1, 128],
    ),
    (
        ("ATTRIBUTES", "QUATERNION", 8, 5),
        &[160, 1, 63, 192, 0, 0, 103, 228, 173, 154, 1, 63, 192, 0, 0, 73, 188, 25, 15, 1, 63, 192, 0, 0, 207, 39, 165, 206, 1, 63, 192, 0, 0, 145, 83, 50, 34, 1, 63, 192, 0, 0, 231, 179, 58, 26, 1, 63, 192, 0, 0, 16, 251, 20, 10, 1, 12, 0, 0, 0, 3, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 12, 175, 254, 127],
        &[0, 0, 194, 198, 124, 114, 0, 0, 205, 204, 205, 204, 101, 102, 103, 230, 243, 80, 122, 40, 12, 175, 122, 40, 66, 95, 192, 31, 127, 192, 161, 47, 101, 102, 153, 25, 205, 204, 51, 51],
    ),
    (
        ("ATTRIBUTES", "EXPONENTIAL", 8, 5),
        &[160, 1, 63, 192, 0, 0, 20, 121, 21, 245, 1, 63, 192, 0, 0, 21, 130, 22, 9, 1, 8, 0, 0, 0, 1, 58, 128, 0, 0, 3, 1, 60, 192, 0, 0, 39, 81, 20, 1, 60, 192, 0, 0, 44, 86, 21, 1, 32, 0, 0, 0, 1, 58, 128, 0, 0, 3, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 31, 223, 255, 245, 20, 234, 255, 245],
        &[0, 132, 131, 192, 0, 96, 47, 192, 0, 92, 175, 191, 0, 0, 0, 0, 0, 96, 175, 63, 0, 92, 47, 64, 0, 132, 131, 64, 0, 92, 175, 64, 0, 48, 219, 64, 0, 132, 3, 65],
    ),
    (
        ("INDICES", "NONE", 4, 11),
        &[209, 0, 4, 4, 20, 14, 2, 0, 28, 193, 12, 5, 12, 0, 0, 0, 0],
        &[0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 7, 0, 0, 0, 3, 0, 0, 0, 2, 0, 0, 0, 2, 0, 0, 0, 9, 0, 0, 0, 144, 1, 0, 0, 145, 1, 0, 0, 12, 0, 0, 0],
    ),
    (
        ("TRIANGLES", "NONE", 4, 24),
        &[225, 240, 16, 16, 255, 31, 255, 16, 28, 255, 18, 1, 1, 6, 255, 196, 4, 2, 2, 0, 118, 135, 86, 103, 120, 169, 134, 101, 137, 104, 152, 1, 105, 0, 0],
        &[0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 2, 0, 0, 0, 1, 0, 0, 0, 3, 0, 0, 0, 3, 0, 0, 0, 1, 0, 0, 0, 4, 0, 0, 0, 9, 0, 0, 0, 8, 0, 0, 0, 7, 0, 0, 0, 7, 0, 0, 0, 8, 0, 0, 0, 10, 0, 0, 0, 44, 1, 0, 0, 45, 1, 0, 0, 46, 1, 0, 0, 46, 1, 0, 0, 45, 1, 0, 0, 5, 0, 0, 0, 5, 0, 0, 0, 45, 1, 0, 0, 0, 0, 0, 0],
    ),
];

fn packed((mode, filter, byte_stride, count): (&str, &str, u64, u64)) -> Meshopt {
    let (mode, filter) = (mode.to_owned(), Some(filter.to_owned()));
    Meshopt { buffer: 0, byte_offset: 0, byte_length: 0, byte_stride, count, mode, filter }
}

#[test]
fn streams_of_meshoptimizer_are_what_its_decoder_gives() {
    for (what, stream, expected) in STREAMS {
        match unpack(&packed(what), stream) {
            Unpacked::Bytes(bytes) => assert_eq!(bytes, expected, "{what:?}"),
            Unpacked::Unknown | Unpacked::Broken => panic!("{what:?} is not unpacked"),
        }
    }
}

#[test]
fn what_is_cut_off_is_broken_and_what_is_newer_is_unknown() {
    for (what @ (mode, filter, stride, count), stream, _) in STREAMS {
        for length in 0..stream.len() {
            // An end may be missed only where nothing is read of it.
            let _ = unpack(&packed(what), &stream[..length]);
        }
        assert!(matches!(unpack(&packed(what), &[]), Unpacked::Broken));
        assert!(
            matches!(unpack(&packed((mode, filter, stride, count << 40)), stream), Unpacked::Broken),
            "{mode}"
        );
        for odd in [0, 3, 260, u64::MAX] {
            assert!(
                !matches!(unpack(&packed((mode, filter, odd, count)), stream), Unpacked::Bytes(_)),
                "{mode} {odd}"
            );
        }
        let newer: Vec<u8> = std::iter::once(0xaf).chain(stream[1..].iter().copied()).collect();
        assert!(matches!(unpack(&packed(what), &newer), Unpacked::Unknown));
        assert!(matches!(unpack(&packed((mode, "COLOR", stride, count)), stream), Unpacked::Unknown));
        // Whatever is in it, nothing panics.
        for at in 0..stream.len() {
            let mut wrong = stream.to_vec();
            wrong[at] ^= 0x5a;
            let _ = unpack(&packed(what), &wrong);
        }
    }
}
