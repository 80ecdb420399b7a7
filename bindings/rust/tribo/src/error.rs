use std::ffi::CStr;
use std::fmt;

use tribo_sys as sys;

/// A call that the C library refused; nothing was changed.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct Error(i32);

/// What a call gives.
pub type Result<T> = std::result::Result<T, Error>;

macro_rules! statuses {
    ($($name:ident = $constant:ident,)*) => {
        #[allow(missing_docs)]
        impl Error {
            $(pub const $name: Error = Error(sys::$constant);)*
        }
    };
}

statuses! {
    NULL = TRIBO_ERROR_NULL,
    STRUCT_SIZE = TRIBO_ERROR_STRUCT_SIZE,
    OPTION = TRIBO_ERROR_OPTION,
    INDEX = TRIBO_ERROR_INDEX,
    ISA = TRIBO_ERROR_ISA,
    NAME = TRIBO_ERROR_NAME,
    ALIAS = TRIBO_ERROR_ALIAS,
    CAPACITY = TRIBO_ERROR_CAPACITY,
    MEMORY = TRIBO_ERROR_MEMORY,
    DATA = TRIBO_ERROR_DATA,
    NOT_FINITE = TRIBO_ERROR_NOT_FINITE,
    RANGE = TRIBO_ERROR_RANGE,
    NORMAL = TRIBO_ERROR_NORMAL,
    ORIENTATION = TRIBO_ERROR_ORIENTATION,
    FRAME = TRIBO_ERROR_FRAME,
    MASS = TRIBO_ERROR_MASS,
    INERTIA = TRIBO_ERROR_INERTIA,
    SHAPE = TRIBO_ERROR_SHAPE,
    TIME_STEP = TRIBO_ERROR_TIME_STEP,
    DEGENERATE = TRIBO_ERROR_DEGENERATE,
    SUPPORT = TRIBO_ERROR_SUPPORT,
    PAIR = TRIBO_ERROR_PAIR,
    FRICTION = TRIBO_ERROR_FRICTION,
    RESTITUTION = TRIBO_ERROR_RESTITUTION,
    CONTACT_MATRIX = TRIBO_ERROR_CONTACT_MATRIX,
    IMMOVABLE = TRIBO_ERROR_IMMOVABLE,
    JAM = TRIBO_ERROR_JAM,
}

impl Error {
    /// The error of a status, if it is one.
    pub fn of(status: i32) -> Result<()> {
        match status {
            sys::TRIBO_OK => Ok(()),
            other => Err(Error(other)),
        }
    }

    /// The number that C has for it.
    pub fn status(self) -> i32 {
        self.0
    }

    /// Its name in C, such as "TRIBO_ERROR_NULL".
    pub fn name(self) -> &'static str {
        // SAFETY: the string is static, and ASCII.
        unsafe { CStr::from_ptr(sys::tribo_status_name(self.0)) }.to_str().unwrap_or("")
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // SAFETY: the string is static, and ASCII.
        let text = unsafe { CStr::from_ptr(sys::tribo_status_string(self.0)) };
        f.write_str(text.to_str().unwrap_or(""))
    }
}

impl fmt::Debug for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {self}", self.name())
    }
}

impl std::error::Error for Error {}
