//! Panics as errors.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook};

/// Calls a function and turns a panic into an error: an algorithm that panics on a mesh is a result
/// like others.
pub(super) fn catch_panic<T>(work: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
    let hook = take_hook();
    set_hook(Box::new(|_| ()));
    let result = catch_unwind(AssertUnwindSafe(work));
    set_hook(hook);
    result.unwrap_or_else(|panic| Err(format!("panicked: {}", message(&*panic))))
}

fn message(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().copied();
    let text = text.or_else(|| panic.downcast_ref::<String>().map(String::as_str));
    let first_line = text.and_then(|text| text.lines().next());
    first_line.unwrap_or("no reason given").to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_a_reason() {
        assert_eq!(catch_panic(|| Ok(3)), Ok(3));
        assert_eq!(catch_panic::<()>(|| Err("no".into())), Err("no".into()));
        let why = catch_panic::<()>(|| panic!("{} is wrong\nand more", 3));
        assert_eq!(why, Err("panicked: 3 is wrong".into()));
    }
}
