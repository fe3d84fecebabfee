//! Elements of values: numbers, and what is made of several.

use openusd::gf;
use openusd::gf::f16;

/// Something of a fixed number of bytes.
pub(super) trait Element: Sized {
    const SIZE: usize;

    /// Out of [`SIZE`](Self::SIZE) bytes.
    fn read(bytes: &[u8]) -> Self;

    /// Out of the 32 bits of a value that stands nowhere else; `None` where there are no such.
    fn inlined(bits: u32) -> Option<Self>;
}

/// A number whose arrays may be compressed.
pub(super) trait Scalar: Element + Copy {
    fn of(number: i64) -> Self;
}

macro_rules! scalar {
    ($type:ty, $size:literal, $inlined:expr, $of:expr) => {
        impl Element for $type {
            const SIZE: usize = $size;

            fn read(bytes: &[u8]) -> Self {
                Self::from_le_bytes(bytes.first_chunk().copied().unwrap_or_default())
            }

            fn inlined(bits: u32) -> Option<Self> {
                Some($inlined(bits))
            }
        }

        impl Scalar for $type {
            fn of(number: i64) -> Self {
                $of(number)
            }
        }
    };
}

scalar!(u8, 1, |bits| bits as u8, |number| number as u8);
scalar!(i32, 4, |bits| bits as i32, |number| number as i32);
scalar!(u32, 4, |bits| bits, |number| number as u32);
scalar!(i64, 8, |bits| i64::from(bits as i32), |number| number);
scalar!(u64, 8, u64::from, |number| number as u64);
scalar!(f16, 2, |bits| f16::from_bits(bits as u16), |number| f16::from_f64(number as f64));
scalar!(f32, 4, f32::from_bits, |number| number as f32);
scalar!(f64, 8, |bits| f64::from(f32::from_bits(bits)), |number| number as f64);

/// The numbers of an element.
fn numbers<T: Scalar, const N: usize>(bytes: &[u8]) -> [T; N] {
    std::array::from_fn(|i| T::read(bytes.get(i * T::SIZE..).unwrap_or_default()))
}

/// Small whole numbers, a byte each.
fn small<T: From<i8>, const N: usize>(bits: u32) -> [T; N] {
    let bytes = bits.to_le_bytes();
    std::array::from_fn(|i| T::from(bytes.get(i).map_or(0, |byte| *byte as i8)))
}

macro_rules! vectors {
    ($($name:ident $type:ty, $numbers:literal;)*) => {$(
        impl Element for gf::$name {
            const SIZE: usize = $numbers * size_of::<$type>();

            fn read(bytes: &[u8]) -> Self {
                numbers::<$type, $numbers>(bytes).into()
            }

            fn inlined(bits: u32) -> Option<Self> {
                Some(small::<$type, $numbers>(bits).into())
            }
        }
    )*};
}

vectors! {
    Vec2d f64, 2; Vec2f f32, 2; Vec2i i32, 2;
    Vec3d f64, 3; Vec3f f32, 3; Vec3h f16, 3; Vec3i i32, 3;
    Vec4d f64, 4; Vec4f f32, 4; Vec4h f16, 4; Vec4i i32, 4;
}

impl Element for gf::Vec2h {
    const SIZE: usize = 4;

    fn read(bytes: &[u8]) -> Self {
        numbers::<f16, 2>(bytes).into()
    }

    /// They are 32 bits.
    fn inlined(bits: u32) -> Option<Self> {
        Some(Self::read(&bits.to_le_bytes()))
    }
}

macro_rules! turns {
    ($($name:ident $type:ty;)*) => {$(
        impl Element for gf::$name {
            const SIZE: usize = 4 * size_of::<$type>();

            /// The real part stands last in files, and first in text.
            fn read(bytes: &[u8]) -> Self {
                let [x, y, z, w] = numbers::<$type, 4>(bytes);
                [w, x, y, z].into()
            }

            fn inlined(_: u32) -> Option<Self> {
                None
            }
        }
    )*};
}

turns! { Quatd f64; Quatf f32; Quath f16; }

impl Element for gf::Matrix4d {
    const SIZE: usize = 128;

    fn read(bytes: &[u8]) -> Self {
        Self(numbers(bytes))
    }

    /// The diagonal.
    fn inlined(bits: u32) -> Option<Self> {
        let diagonal: [f64; 4] = small(bits);
        Some(Self(std::array::from_fn(|i| if i % 5 == 0 { diagonal[i / 5] } else { 0.0 })))
    }
}
