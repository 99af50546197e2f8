//! What the standard library asks of a C library for WASI, and Debian's, which is older, lacks. No thread can be started.
#![no_std]

#[unsafe(no_mangle)]
pub extern "C" fn __errno_location() -> *mut i32 {
    static mut NUMBER: i32 = 0;
    &raw mut NUMBER
}

#[unsafe(no_mangle)]
pub extern "C" fn fchmod(_: i32, _: u32) -> i32 {
    0
}

#[unsafe(no_mangle)]
pub extern "C" fn realpath(_: *const u8, _: *mut u8) -> *mut u8 {
    core::ptr::null_mut()
}

#[unsafe(no_mangle)]
pub extern "C" fn pthread_create(_: *mut u8, _: *const u8, _: *const u8, _: *mut u8) -> i32 {
    const NOT_SUPPORTED: i32 = 58;
    NOT_SUPPORTED
}

#[unsafe(no_mangle)]
pub extern "C" fn pthread_detach(_: *mut u8) -> i32 {
    0
}

#[unsafe(no_mangle)]
pub extern "C" fn pthread_join(_: *mut u8, _: *mut u8) -> i32 {
    0
}

#[unsafe(no_mangle)]
pub extern "C" fn pthread_attr_init(_: *mut u8) -> i32 {
    0
}

#[unsafe(no_mangle)]
pub extern "C" fn pthread_attr_destroy(_: *mut u8) -> i32 {
    0
}

#[unsafe(no_mangle)]
pub extern "C" fn pthread_attr_setstacksize(_: *mut u8, _: usize) -> i32 {
    0
}
