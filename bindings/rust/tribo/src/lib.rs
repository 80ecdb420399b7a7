//! Contact and friction between rigid bodies, resolved exactly and fast.
//!
//! One contact ([`solve`], [`impact`], [`collide`]), many that do not influence each other
//! ([`batch_solve`], ...), many that do ([`System`]), contacts from shapes ([`touch`]), and worlds
//! that step through time ([`Scene`]). SI units; quaternions are (w, x, y, z); contact coordinates
//! are (n, t1, t2) with the normal from body B to body A.
//!
//! Structs are those of C, with public fields and all zeros as default; their `struct_size` is set
//! by the calls. What a function means in full stands in [`sys`] at the function of the same name.
//! Objects are `Send`; those that C lets one thread at a time use ask for `&mut self` to change, and
//! are not `Sync`.
#![warn(missing_docs)]

mod contact;
mod error;
mod scene;
mod shape;
mod system;

pub use contact::*;
pub use error::{Error, Result};
pub use scene::{Kind, Saved, Scene, SceneBody};
pub use shape::{pose, touch, touch_batch, Shape, Support, Tree};
pub use system::System;
pub use tribo_sys as sys;

pub use sys::{
    tribo_body as Body, tribo_collide_options as CollideOptions,
    tribo_collision_info as CollisionInfo, tribo_contact as Contact, tribo_impact_info as ImpactInfo,
    tribo_impact_options as ImpactOptions, tribo_manifold as Manifold, tribo_material as Material,
    tribo_measures as Measures, tribo_pose as Pose, tribo_scene_contact as SceneContact,
    tribo_scene_event as SceneEvent, tribo_scene_settings as SceneSettings,
    tribo_solve_info as SolveInfo, tribo_sparse_info as SparseInfo, tribo_step_info as StepInfo,
    tribo_step_options as StepOptions, tribo_system_contact as SystemContact,
    tribo_system_info as SystemInfo, tribo_system_options as SystemOptions,
    tribo_totals as Totals, TRIBO_WORLD as WORLD,
};

/// A struct of C with its size set.
macro_rules! sized {
    ($kind:ty) => {
        sized!($kind, <$kind>::default())
    };
    ($kind:ty, $value:expr) => {{
        let mut value: $kind = $value;
        value.struct_size = std::mem::size_of::<$kind>() as u32;
        value
    }};
}
pub(crate) use sized;

/// Instruction sets of batches; no bit depends on them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
#[repr(u32)]
pub enum Isa {
    /// The best one that this machine has.
    #[default]
    Best = sys::TRIBO_ISA_BEST,
    /// One contact after the other.
    Scalar = sys::TRIBO_ISA_SCALAR,
    /// What every machine of this architecture has.
    Baseline = sys::TRIBO_ISA_BASELINE,
    /// AVX2.
    X86_64V3 = sys::TRIBO_ISA_X86_64_V3,
    /// AVX-512.
    X86_64V4 = sys::TRIBO_ISA_X86_64_V4,
}

/// Version of the C library, as "major.minor.patch".
pub fn version() -> &'static str {
    // SAFETY: the string is static, and ASCII.
    unsafe { std::ffi::CStr::from_ptr(sys::tribo_version_string()) }.to_str().unwrap_or("")
}
