//! Raw bindings of [tribo](https://crates.io/crates/tribo), which is what to use from Rust.
//!
//! The C sources come with the crate and are built by `build.rs`; libccd, Qhull and SuiteSparse are
//! libraries of the system. With the feature `pkg-config` an installed libtribo is linked instead.
#![no_std]
#![allow(non_camel_case_types)]

include!("bindings.rs");
