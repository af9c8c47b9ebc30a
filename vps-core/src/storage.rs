//! Borrowed or owned data, so that one type serves flash memory and heaps.

use core::ops::Deref;

/// A slice that is borrowed (from a file in memory, from flash) or, with `alloc`, owned.
#[derive(Clone, Debug)]
pub enum Storage<'a, T> {
    /// Borrowed data.
    Borrowed(&'a [T]),
    /// Owned data.
    #[cfg(feature = "alloc")]
    Owned(alloc::vec::Vec<T>),
}

impl<T> Deref for Storage<'_, T> {
    type Target = [T];

    #[inline]
    fn deref(&self) -> &[T] {
        match self {
            Self::Borrowed(slice) => slice,
            #[cfg(feature = "alloc")]
            Self::Owned(vec) => vec,
        }
    }
}

impl<'a, T> From<&'a [T]> for Storage<'a, T> {
    fn from(slice: &'a [T]) -> Self {
        Self::Borrowed(slice)
    }
}

#[cfg(feature = "alloc")]
impl<T> From<alloc::vec::Vec<T>> for Storage<'_, T> {
    fn from(vec: alloc::vec::Vec<T>) -> Self {
        Self::Owned(vec)
    }
}

#[cfg(feature = "alloc")]
impl<T: Clone> Storage<'_, T> {
    pub(crate) fn into_owned(self) -> Storage<'static, T> {
        Storage::Owned(match self {
            Self::Borrowed(slice) => slice.into(),
            Self::Owned(vec) => vec,
        })
    }
}
