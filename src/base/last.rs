//! The last thing that was worked out, kept for whoever asks for the same again.

use std::sync::{Arc, Mutex, PoisonError};

/// What followed last from whatever bears this, by what was asked; clones of it keep the same. It is no part of what that
/// is: things with and without are equal.
#[derive(Debug)]
pub struct Last<K, V>(Arc<Mutex<Option<Kept<K, V>>>>);

#[derive(Debug)]
struct Kept<K, V> {
    asked: K,
    value: Arc<V>,
}

impl<K, V> Clone for Last<K, V> {
    fn clone(&self) -> Self {
        Self(self.0.clone())
    }
}

impl<K, V> Default for Last<K, V> {
    fn default() -> Self {
        Self(Arc::default())
    }
}

impl<K, V> PartialEq for Last<K, V> {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl<K: PartialEq, V> Last<K, V> {
    /// What was asked for, which `work_out` gives if it is not what is kept. Nothing is locked meanwhile: asked for from two
    /// threads at once it may be worked out twice.
    ///
    /// # Errors
    /// Those of `work_out`; then what was kept stays.
    pub fn get<E>(&self, asked: K, work_out: impl FnOnce() -> Result<V, E>) -> Result<Arc<V>, E> {
        let kept = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(kept) = kept().as_ref().filter(|kept| kept.asked == asked) {
            return Ok(kept.value.clone());
        }
        let value = Arc::new(work_out()?);
        *kept() = Some(Kept { asked, value: value.clone() });
        Ok(value)
    }

    /// What is kept, whoever asked for it.
    pub fn kept(&self) -> Option<Arc<V>> {
        let kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        kept.as_ref().map(|kept| kept.value.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_is_worked_out_once_and_an_error_leaves_it() {
        let last = Last::<u32, String>::default();
        let clone = last.clone();
        let mut times = 0;
        for asked in [7, 7, 8, 8, 7] {
            let found = last.get(asked, || {
                times += 1;
                Ok::<_, ()>(asked.to_string())
            });
            assert_eq!(*found.unwrap(), asked.to_string());
        }
        assert_eq!(times, 3);
        assert_eq!(clone.get(9, || Err("no")), Err("no"));
        assert_eq!(*clone.get(7, || Err("asked again")).unwrap(), "7");
        assert_eq!(clone.kept().as_deref().map(String::as_str), Some("7"));
        assert!(last == Last::default());
    }
}
