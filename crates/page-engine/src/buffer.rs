//! The buffer, and the functions that a page calls.
//!
//! Names without mangling count as unsafe code, because another library could define the same name.
//! A WebAssembly module has one definition of each. There is no other unsafe code.
#![allow(unsafe_code)]

use std::cell::RefCell;

use crate::session::Session;

thread_local! {
    static BUFFER: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
    static SESSION: RefCell<Session> = RefCell::new(Session::of_module());
}

/// Makes room for a request of so many bytes and returns its address.
#[unsafe(no_mangle)]
pub extern "C" fn reserve(bytes: usize) -> *mut u8 {
    BUFFER.with_borrow_mut(|buffer| {
        buffer.clear();
        buffer.resize(bytes, 0);
        buffer.as_mut_ptr()
    })
}

/// Answers the request in the buffer and returns the number of bytes of the answer, which replaces
/// it.
#[unsafe(no_mangle)]
pub extern "C" fn answer() -> usize {
    BUFFER.with_borrow_mut(|buffer| {
        *buffer = SESSION.with_borrow_mut(|session| session.answer(buffer)).into_bytes();
        buffer.len()
    })
}

/// The address of the answer.
#[unsafe(no_mangle)]
pub extern "C" fn address() -> *const u8 {
    BUFFER.with_borrow(|buffer| buffer.as_ptr())
}
