// Written by generate.py from api.json; not by hand.

use core::ffi::{c_char, c_void};

pub type tribo_status = i32;

pub const TRIBO_VERSION_MAJOR: u32 = 0;
pub const TRIBO_VERSION_MINOR: u32 = 1;
pub const TRIBO_VERSION_PATCH: u32 = 0;
pub const TRIBO_WORLD: u32 = 4294967295;
pub const TRIBO_MAX_POINTS: u32 = 4;
pub const TRIBO_MAX_FACE: u32 = 32;
pub const TRIBO_OK: tribo_status = 0;
/// a pointer that must not be null is null
pub const TRIBO_ERROR_NULL: tribo_status = 10;
/// struct_size is zero, odd or larger than this library knows
pub const TRIBO_ERROR_STRUCT_SIZE: tribo_status = 11;
/// an enumerated option has no such value
pub const TRIBO_ERROR_OPTION: tribo_status = 12;
/// an index lies outside of its array
pub const TRIBO_ERROR_INDEX: tribo_status = 13;
/// the instruction set is not available on this machine
pub const TRIBO_ERROR_ISA: tribo_status = 14;
/// no entry has that name
pub const TRIBO_ERROR_NAME: tribo_status = 15;
/// two arguments that must differ are the same object
pub const TRIBO_ERROR_ALIAS: tribo_status = 16;
/// the caller's buffer is too small; the size needed is told
pub const TRIBO_ERROR_CAPACITY: tribo_status = 17;
/// a library beneath could not allocate
pub const TRIBO_ERROR_MEMORY: tribo_status = 18;
/// a block of data is not one that this library made
pub const TRIBO_ERROR_DATA: tribo_status = 19;
/// an input is NaN or infinite
pub const TRIBO_ERROR_NOT_FINITE: tribo_status = 20;
/// a finite input or the result is outside of the stated
/// range
pub const TRIBO_ERROR_RANGE: tribo_status = 21;
/// the contact normal is not of unit length
pub const TRIBO_ERROR_NORMAL: tribo_status = 22;
/// the quaternion is not of unit length
pub const TRIBO_ERROR_ORIENTATION: tribo_status = 23;
/// the contact frame is not orthonormal and right-handed
pub const TRIBO_ERROR_FRAME: tribo_status = 24;
/// mass or inverse mass is negative, or zero where it must not
/// be
pub const TRIBO_ERROR_MASS: tribo_status = 30;
/// inertia is asymmetric, indefinite, or of no possible body
pub const TRIBO_ERROR_INERTIA: tribo_status = 31;
/// a length or density of a shape is not positive
pub const TRIBO_ERROR_SHAPE: tribo_status = 32;
/// the time step is negative, or too long to be resolved
pub const TRIBO_ERROR_TIME_STEP: tribo_status = 33;
/// points span no volume, or no triangle has an area
pub const TRIBO_ERROR_DEGENERATE: tribo_status = 34;
/// a user's support function contradicts itself
pub const TRIBO_ERROR_SUPPORT: tribo_status = 35;
/// these two kinds of shapes cannot be tested against each other
pub const TRIBO_ERROR_PAIR: tribo_status = 36;
/// mu_s < 0, mu_d < 0, mu_s < mu_d, or a length of rolling or
/// spinning resistance < 0
pub const TRIBO_ERROR_FRICTION: tribo_status = 40;
/// e lies outside of \[0, 1\] (tangential: \[-1, 1\])
pub const TRIBO_ERROR_RESTITUTION: tribo_status = 41;
/// the contact matrix is not positive semidefinite
pub const TRIBO_ERROR_CONTACT_MATRIX: tribo_status = 50;
/// neither body can move at the contact along the normal
pub const TRIBO_ERROR_IMMOVABLE: tribo_status = 51;
/// no bounded impulse satisfies Coulomb's law: the contact
/// jams
pub const TRIBO_ERROR_JAM: tribo_status = 52;
/// sqrt(a b): Box2D, Box3D and Jolt for friction
pub const TRIBO_MIX_GEOMETRIC_MEAN: u32 = 0;
/// min(a, b)
pub const TRIBO_MIX_MINIMUM: u32 = 1;
/// max(a, b): Box2D, Box3D and Jolt for restitution
pub const TRIBO_MIX_MAXIMUM: u32 = 2;
/// a b: Bullet
pub const TRIBO_MIX_PRODUCT: u32 = 3;
/// (a + b) / 2: default of PhysX and of Rapier
pub const TRIBO_MIX_ARITHMETIC_MEAN: u32 = 4;
/// separates, or no impulse is needed
pub const TRIBO_MODE_OPEN: u32 = 0;
/// friction takes all sliding it is asked to, within mu_s p_n
pub const TRIBO_MODE_STICK: u32 = 1;
/// the impulse lies on the friction cone of mu_d
pub const TRIBO_MODE_SLIP: u32 = 2;
/// batch only: no bounded impulse exists
pub const TRIBO_MODE_JAM: u32 = 3;
/// Chatterjee & Ruina, J. Appl. Mech. 65 (1998) 939: P = (1+e) P_I + kappa (P_II - P_I), P_I
///  the frictionless plastic and P_II the sticking plastic impulse, kappa = 1 + e_t, or the
///  greatest smaller value that keeps P in the friction cone. u_n+ = -e u_n-; the cone holds;
///  and, because P_I and P_II - P_I are W-orthogonal, energy never grows:
///  dT = -(1-e^2)/2 |P_I|^2_W - kappa (2 - kappa)/2 |P_II - P_I|^2_W. Closed form.
pub const TRIBO_LAW_ALGEBRAIC: u32 = 0;
/// p = -(1+e) u_n / W_nn along the normal (lecture, collision resolution, steps 1-5).
pub const TRIBO_LAW_FRICTIONLESS: u32 = 1;
/// The lecture's velocity rule through the 3x3 system: u_n+ = -e u_n-; u_t+ = 0 if
///  |u_t| <= mu_s v_c, else (1 - mu_d) u_t. Faithful to the slides; it may leave the friction
///  cone or gain energy, which the audit shows.
pub const TRIBO_LAW_LECTURE: u32 = 2;
/// Coulomb's law exactly (cone, and slip opposite to friction after the impact) with Newton's
///  u_n+ = -e u_n-. May gain energy for e > 0 with friction: see energy in the info.
pub const TRIBO_LAW_COULOMB: u32 = 3;
/// Routh's incremental law: Coulomb friction along the growing normal impulse (Keller,
///  J. Appl. Mech. 53 (1986) 1), ended by Newton's hypothesis u_n+ = -e u_n-.
pub const TRIBO_LAW_ROUTH_NEWTON: u32 = 4;
/// ... ended by Poisson's: p_n = (1+e) p_n at greatest compression. Where slip that turns
///  compresses the contact a second time, the last compression counts, for this law and the
///  next.
pub const TRIBO_LAW_ROUTH_POISSON: u32 = 5;
/// ... ended by Stronge's (J. Appl. Mech. 58 (1991) 1049): the normal work regained in
///  restitution is e^2 times that spent in compression.
pub const TRIBO_LAW_ROUTH_STRONGE: u32 = 6;
/// As LECTURE, but sliding loses what dynamic friction on the closing velocity v_c takes:
///  u_t+ = u_t max(0, 1 - mu_d v_c / |u_t|), the rule before the slides' approximation.
pub const TRIBO_LAW_LECTURE_CLOSING: u32 = 7;
/// the best one that this machine has
pub const TRIBO_ISA_BEST: u32 = 0;
/// one contact after the other by the functions of contact.h
pub const TRIBO_ISA_SCALAR: u32 = 1;
/// lanes with what every machine of this architecture has
pub const TRIBO_ISA_BASELINE: u32 = 2;
/// AVX2
pub const TRIBO_ISA_X86_64_V3: u32 = 3;
/// AVX-512
pub const TRIBO_ISA_X86_64_V4: u32 = 4;
/// size = {radius}
pub const TRIBO_SHAPE_SPHERE: u32 = 1;
/// size = {hx, hy, hz}, half-extents
pub const TRIBO_SHAPE_BOX: u32 = 2;
/// size = {radius, half_height}: all within r of z = -h to h
pub const TRIBO_SHAPE_CAPSULE: u32 = 3;
/// size = {radius, half_height}, axis z
pub const TRIBO_SHAPE_CYLINDER: u32 = 4;
/// size = {radius, half_height}: base at z = -h, apex at z = h
pub const TRIBO_SHAPE_CONE: u32 = 5;
/// size = {a, b, c}, semi-axes
pub const TRIBO_SHAPE_ELLIPSOID: u32 = 6;
/// data: block of tribo_hull_build
pub const TRIBO_SHAPE_HULL: u32 = 7;
/// data: const tribo_convex *, the user's own support function
pub const TRIBO_SHAPE_CONVEX: u32 = 8;
/// size = {nx, ny, nz, d}: n . x <= d, with |n| = 1 to 5e-13
pub const TRIBO_SHAPE_HALFSPACE: u32 = 9;
/// data: block of tribo_mesh_build; static terrain
pub const TRIBO_SHAPE_MESH: u32 = 10;
/// data: const tribo_child *, count children, each convex
pub const TRIBO_SHAPE_COMPOUND: u32 = 11;
/// closed form if there is one, else general
pub const TRIBO_METHOD_AUTOMATIC: u32 = 0;
/// closed form, or TRIBO_ERROR_OPTION if the pair has none
pub const TRIBO_METHOD_CLOSED: u32 = 1;
/// by support functions alone; not for half-spaces
pub const TRIBO_METHOD_GENERAL: u32 = 2;
/// Gauss-Seidel first; then Newton, in turns with sweeps that Anderson's method accelerates
///  (Walker & Ni, SIAM J. Numer. Anal. 49 (2011) 1715), for the components of the system that it
///  does not finish.
pub const TRIBO_SOLVER_AUTO: u32 = 0;
/// Sweeps of the exact solve of one contact after the other (Jourdan, Alart & Jean, Comput.
///  Methods Appl. Mech. Eng. 155 (1998) 31).
pub const TRIBO_SOLVER_GAUSS_SEIDEL: u32 = 1;
/// Proximal point and semismooth Newton, in the bodies' velocities or on W; and where that does
///  not end soon, an interior-point method on the convex neighbour of the problem (Anitescu,
///  Math. Program. 105 (2006) 113), which finds how a system can stand, whatever its size, and
///  the central path of Coulomb's law itself, followed where it turns back, too. Where bodies
///  slide over each other that path goes first.
pub const TRIBO_SOLVER_NEWTON: u32 = 2;
/// The greatest eta of the contacts: tribo_measures of audit.h, with all of W.
pub const TRIBO_MEASURE_ETA: u32 = 0;
/// sqrt(sum |s r - P_K(s r - u')|^2) / |q| over all contacts, s the mean diagonal entry of
///  W.
pub const TRIBO_MEASURE_INVARIANT: u32 = 1;
/// the tolerance is met
pub const TRIBO_STOP_TOLERANCE: u32 = 0;
/// max_iterations were done
pub const TRIBO_STOP_ITERATIONS: u32 = 1;
/// max_seconds are over
pub const TRIBO_STOP_TIME: u32 = 2;
/// the progress callback asked for it
pub const TRIBO_STOP_CANCEL: u32 = 3;
/// no solver makes progress any more
pub const TRIBO_STOP_STALL: u32 = 4;
/// no bounded impulses exist, or none that double can hold: the
/// least-bad ones found are returned
pub const TRIBO_STOP_JAM: u32 = 5;
/// the faster one, judged by operations for each number in the
/// factors
pub const TRIBO_SPARSE_AUTO: u32 = 0;
/// CHOLMOD simplicial, KLU: best where factors stay thin
pub const TRIBO_SPARSE_SIMPLICIAL: u32 = 1;
/// CHOLMOD supernodal, UMFPACK: best where they fill up
pub const TRIBO_SPARSE_SUPERNODAL: u32 = 2;
/// forces and contacts; it has a mass
pub const TRIBO_BODY_DYNAMIC: u32 = 0;
/// its own velocities, which nothing changes
pub const TRIBO_BODY_KINEMATIC: u32 = 1;
/// nothing; its velocities are zero
pub const TRIBO_BODY_STATIC: u32 = 2;
/// start solvers from zero
pub const TRIBO_SKIP_WARM_START: u32 = 1;
/// leave overlaps as they are
pub const TRIBO_SKIP_CORRECTION: u32 = 2;
/// all impacts are plastic
pub const TRIBO_SKIP_RESTITUTION: u32 = 4;
/// contacts act once surfaces have met, not before
pub const TRIBO_SKIP_SPECULATION: u32 = 8;
/// touch in this step, and did not in the last
pub const TRIBO_EVENT_BEGIN: u32 = 1;
/// in both
pub const TRIBO_EVENT_PERSIST: u32 = 2;
/// in the last step alone
pub const TRIBO_EVENT_END: u32 = 3;

/// A tree of boxes; opaque, inside the caller's block.
#[repr(C)]
pub struct tribo_tree {
    _private: [u8; 0],
}

/// Factors of the last matrix, and the analysis of the last pattern.
#[repr(C)]
pub struct tribo_sparse {
    _private: [u8; 0],
}

/// A scene; opaque.
#[repr(C)]
pub struct tribo_scene {
    _private: [u8; 0],
}

/// A user's own rule: fill `out` from a and b. Must be as thread-safe as the caller needs.
pub type tribo_mix_function =
    unsafe extern "C" fn(a: *const tribo_material, b: *const tribo_material, user: *mut c_void, out: *mut tribo_material);

/// point = the point of the shape that is farthest along `direction` (not zero, not of unit
///  length), both in the axes of the shape. Called any number of times; must be a function of its
///  arguments alone.
pub type tribo_support_function =
    unsafe extern "C" fn(user: *const c_void, direction: *const f64, point: *mut f64);

/// The face that faces `direction` most: up to `capacity` vertices to points (width 3), in order
///  around it, either way. Returns their number, 0 if the surface is curved or has no face there.
///  More than `capacity`, a point that is not finite or a polygon without area count as 0.
pub type tribo_face_function =
    unsafe extern "C" fn(user: *const c_void, direction: *const f64, capacity: u32, points: *mut f64) -> u32;

/// Factorise the n x n matrix with rows row_starts\[i\] to row_starts\[i + 1\] of `columns` (ascending
///  in each row) and `values`. symmetric = 1: it is symmetric, positive definite but for rounding,
///  and only entries with column <= row are given. The arrays stay as they are until the last solve.
///  @return TRIBO_OK; TRIBO_ERROR_CONTACT_MATRIX if it is singular; any other status.
pub type tribo_factor_function =
    unsafe extern "C" fn(context: *mut c_void, n: u32, row_starts: *const u32, columns: *const u32, values: *const f64, symmetric: u32) -> tribo_status;

/// Replace x by the solution for the right-hand side x, n numbers.
pub type tribo_solve_function =
    unsafe extern "C" fn(context: *mut c_void, x: *mut f64) -> tribo_status;

/// Tell the sign of the determinant of the matrix that was factorised last: -1 or 1.
///  @return TRIBO_OK; any other status ends the solve with it, but for TRIBO_ERROR_CONTACT_MATRIX: the
///          sign is not known.
pub type tribo_sign_function =
    unsafe extern "C" fn(context: *mut c_void, sign: *mut i32) -> tribo_status;

/// Called with what is known so far; return other than 0 to stop.
pub type tribo_progress_function =
    unsafe extern "C" fn(user: *mut c_void, info: *const tribo_system_info) -> u32;

/// Run task(data, i) for each i from 0 to count - 1, in any order, on any threads, and return when
///  all are done.
pub type tribo_parallel_function =
    unsafe extern "C" fn(user: *mut c_void, task: Option<unsafe extern "C" fn(data: *mut c_void, i: u32)>, data: *mut c_void, count: u32);

/// A clock in seconds from any moment on.
pub type tribo_clock_function =
    unsafe extern "C" fn(user: *mut c_void) -> f64;

/// Memory for `size` bytes (never 0), aligned for any type; null if there is none.
pub type tribo_allocate_function =
    unsafe extern "C" fn(user: *mut c_void, size: usize) -> *mut c_void;

/// Take back what allocate gave (never null).
pub type tribo_release_function =
    unsafe extern "C" fn(user: *mut c_void, memory: *mut c_void);

/// A rigid body. All zeros but orientation\[0\] = 1 is an immovable body at the origin.
///  160 bytes; layout is part of the ABI.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct tribo_body {
    /// centre of mass, world axes, m
    pub position: [f64; 3],
    /// body to world; unit to 1e-6, used as if normalised
    pub orientation: [f64; 4],
    /// of the centre of mass, world axes, m/s
    pub velocity: [f64; 3],
    /// world axes, rad/s
    pub angular_velocity: [f64; 3],
    /// 1/kg; 0: cannot be moved
    pub inverse_mass: f64,
    /// about the centre of mass, BODY axes, 1/(kg m^2), symmetric,
    /// positive semidefinite; a zero row is an axis that cannot be
    /// turned
    pub inverse_inertia: [f64; 6],
}

impl Default for tribo_body {
    /// All zeros.
    fn default() -> Self {
        // SAFETY: numbers, null pointers and absent functions are all zeros.
        unsafe { core::mem::zeroed() }
    }
}

#[cfg(target_pointer_width = "64")]
const _: () = assert!(core::mem::size_of::<tribo_body>() == 160);

/// Coefficients of one material, or of a pair in contact; all without unit. 24 bytes.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct tribo_material {
    /// static friction, 0 <= mu_d <= mu_s < infinity: sticking holds up to mu_s
    /// p_n
    pub mu_s: f64,
    /// dynamic friction: sliding friction is mu_d p_n
    pub mu_d: f64,
    /// restitution, 0 (plastic) to 1 (elastic)
    pub e: f64,
}

impl Default for tribo_material {
    /// All zeros.
    fn default() -> Self {
        // SAFETY: numbers, null pointers and absent functions are all zeros.
        unsafe { core::mem::zeroed() }
    }
}

#[cfg(target_pointer_width = "64")]
const _: () = assert!(core::mem::size_of::<tribo_material>() == 24);

/// Geometry of one contact. Arms instead of a point keep it exact far from the origin. 72 bytes.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct tribo_contact {
    /// unit to 1e-12, world axes, from B to A
    pub normal: [f64; 3],
    /// contact point minus centre of mass of A, world axes, m
    pub arm_a: [f64; 3],
    /// contact point minus centre of mass of B, world axes, m
    pub arm_b: [f64; 3],
}

impl Default for tribo_contact {
    /// All zeros.
    fn default() -> Self {
        // SAFETY: numbers, null pointers and absent functions are all zeros.
        unsafe { core::mem::zeroed() }
    }
}

#[cfg(target_pointer_width = "64")]
const _: () = assert!(core::mem::size_of::<tribo_contact>() == 72);

/// Options of an impact. Zero-initialise, set struct_size = sizeof(tribo_impact_options). A null
///  pointer in place of options means all defaults (zeros).
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct tribo_impact_options {
    /// bytes of this struct as the caller knows it; smaller (older) is
    /// accepted
    pub struct_size: u32,
    /// TRIBO_LAW_...; default ALGEBRAIC
    pub law: u32,
    /// e_t in \[-1, 1\], ALGEBRAIC only; default 0: plastic
    /// sticking
    pub tangential_restitution: f64,
}

impl Default for tribo_impact_options {
    /// All zeros.
    fn default() -> Self {
        // SAFETY: numbers, null pointers and absent functions are all zeros.
        unsafe { core::mem::zeroed() }
    }
}

#[cfg(target_pointer_width = "64")]
const _: () = assert!(core::mem::size_of::<tribo_impact_options>() == 16);

/// What an impact did. The caller sets struct_size; a smaller (older) struct is filled as far as it
///  goes.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct tribo_impact_info {
    pub struct_size: u32,
    /// TRIBO_MODE_... at the end of the impact
    pub mode: u32,
    /// root-finding or integration steps; 0 for closed forms
    pub iterations: u32,
    pub reserved: u32,
    /// u+ in contact coordinates, m/s
    pub velocity: [f64; 3],
    /// change of kinetic energy, p . (u- + u+) / 2, J
    pub energy: f64,
    /// ALGEBRAIC: the kappa used; other laws: 0
    pub kappa: f64,
    /// ROUTH: normal impulse at greatest compression, N s; other laws: 0
    pub compression: f64,
}

impl Default for tribo_impact_info {
    /// All zeros.
    fn default() -> Self {
        // SAFETY: numbers, null pointers and absent functions are all zeros.
        unsafe { core::mem::zeroed() }
    }
}

#[cfg(target_pointer_width = "64")]
const _: () = assert!(core::mem::size_of::<tribo_impact_info>() == 64);

/// What the exact solve did; struct_size as above.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct tribo_solve_info {
    pub struct_size: u32,
    /// OPEN, STICK or SLIP
    pub mode: u32,
    /// Newton and bisection steps on the slip equation
    pub iterations: u32,
    pub reserved: u32,
    /// slip: u_t = -nu p_t, 1/kg, DBL_MAX if beyond double; else 0
    pub nu: f64,
}

impl Default for tribo_solve_info {
    /// All zeros.
    fn default() -> Self {
        // SAFETY: numbers, null pointers and absent functions are all zeros.
        unsafe { core::mem::zeroed() }
    }
}

#[cfg(target_pointer_width = "64")]
const _: () = assert!(core::mem::size_of::<tribo_solve_info>() == 24);

/// A whole collision; struct_size as above.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct tribo_collision_info {
    pub struct_size: u32,
    /// TRIBO_MODE_...
    pub mode: u32,
    /// as in tribo_impact_info
    pub iterations: u32,
    pub reserved: u32,
    /// rows n, t1, t2: world to contact coordinates
    pub frame: [f64; 9],
    /// W, 1/kg
    pub matrix: [f64; 6],
    /// u-, contact coordinates, m/s
    pub velocity_before: [f64; 3],
    /// u+ = u- + W p
    pub velocity_after: [f64; 3],
    /// p, contact coordinates, N s
    pub impulse: [f64; 3],
    /// the same in world axes; acts on A, its negative on B
    pub impulse_world: [f64; 3],
    /// change of kinetic energy, p . (u- + u+) / 2, J
    pub energy: f64,
}

impl Default for tribo_collision_info {
    /// All zeros.
    fn default() -> Self {
        // SAFETY: numbers, null pointers and absent functions are all zeros.
        unsafe { core::mem::zeroed() }
    }
}

#[cfg(target_pointer_width = "64")]
const _: () = assert!(core::mem::size_of::<tribo_collision_info>() == 240);

/// Totals over bodies. Bodies with zero inverse mass have no finite momentum and are left out. 80
///  bytes.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct tribo_totals {
    /// sum m v, kg m/s
    pub linear: [f64; 3],
    /// sum (x - origin) x m v + I omega about one common point, kg m^2/s
    pub angular: [f64; 3],
    /// sum m |v|^2 / 2 + omega . I omega / 2, J
    pub energy: f64,
    /// sum m, kg
    pub mass: f64,
    /// sum m |v|: what |linear| is measured against
    pub linear_scale: f64,
    /// sum |x - origin| m |v| + |I omega|
    pub angular_scale: f64,
}

impl Default for tribo_totals {
    /// All zeros.
    fn default() -> Self {
        // SAFETY: numbers, null pointers and absent functions are all zeros.
        unsafe { core::mem::zeroed() }
    }
}

#[cfg(target_pointer_width = "64")]
const _: () = assert!(core::mem::size_of::<tribo_totals>() == 80);

/// What changed between two totals of the same bodies about the same origin.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct tribo_change {
    /// |change of linear momentum| / greater linear_scale; 0 if both are 0
    pub linear: f64,
    /// |change of angular momentum| / greater angular_scale
    pub angular: f64,
    /// (T+ - T-) / greater T, signed
    pub energy: f64,
}

impl Default for tribo_change {
    /// All zeros.
    fn default() -> Self {
        // SAFETY: numbers, null pointers and absent functions are all zeros.
        unsafe { core::mem::zeroed() }
    }
}

#[cfg(target_pointer_width = "64")]
const _: () = assert!(core::mem::size_of::<tribo_change>() == 24);

/// Measures of an impulse p for the problem v = W p + b with coefficient mu. Scales: V = |b| + the
///  norm of |W||p| (entrywise absolute values), P = V / greatest W_ii.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct tribo_measures {
    /// natural map |p - P_K(p - rho (v + mu |v_t| e_n))| / P,
    /// rho = 1 / (greatest W_ii max(1, mu)): 0 at, and only at, a solution
    pub eta: f64,
    /// |min(v_n / V, p_n / P)|
    pub signorini: f64,
    /// max(0, |p_t| - mu p_n) / P
    pub cone: f64,
    /// | |v_t| p_t + mu p_n v_t | / (P V): friction not opposite to slip
    pub misalignment: f64,
    /// p . (b + v) / 2 / (P V): change of energy, signed, b the velocity
    /// before (e = 0)
    pub energy: f64,
    /// v_n, m/s: the separating velocity
    pub velocity: f64,
}

impl Default for tribo_measures {
    /// All zeros.
    fn default() -> Self {
        // SAFETY: numbers, null pointers and absent functions are all zeros.
        unsafe { core::mem::zeroed() }
    }
}

#[cfg(target_pointer_width = "64")]
const _: () = assert!(core::mem::size_of::<tribo_measures>() == 48);

/// A shape. 48 bytes on 64-bit machines; layout is part of the ABI.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct tribo_shape {
    /// TRIBO_SHAPE_...
    pub r#type: u32,
    /// COMPOUND: number of children; else 0
    pub count: u32,
    /// as above, m; unused entries are not looked at
    pub size: [f64; 4],
    /// as above; null where a shape has none
    pub data: *const c_void,
}

impl Default for tribo_shape {
    /// All zeros.
    fn default() -> Self {
        // SAFETY: numbers, null pointers and absent functions are all zeros.
        unsafe { core::mem::zeroed() }
    }
}

#[cfg(target_pointer_width = "64")]
const _: () = assert!(core::mem::size_of::<tribo_shape>() == 48);

/// Position and orientation: body axes to world axes, as in tribo_body. 56 bytes.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct tribo_pose {
    /// m
    pub position: [f64; 3],
    /// (w, x, y, z), unit to 1e-6, used as if normalised
    pub orientation: [f64; 4],
}

impl Default for tribo_pose {
    /// All zeros.
    fn default() -> Self {
        // SAFETY: numbers, null pointers and absent functions are all zeros.
        unsafe { core::mem::zeroed() }
    }
}

#[cfg(target_pointer_width = "64")]
const _: () = assert!(core::mem::size_of::<tribo_pose>() == 56);

/// One convex part of a compound.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct tribo_child {
    /// convex: not HALFSPACE, MESH or COMPOUND
    pub shape: tribo_shape,
    /// in the axes of the compound
    pub pose: tribo_pose,
}

impl Default for tribo_child {
    /// All zeros.
    fn default() -> Self {
        // SAFETY: numbers, null pointers and absent functions are all zeros.
        unsafe { core::mem::zeroed() }
    }
}

#[cfg(target_pointer_width = "64")]
const _: () = assert!(core::mem::size_of::<tribo_child>() == 104);

/// A convex shape given by functions. The caller sets struct_size, to sizeof(tribo_convex).
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct tribo_convex {
    pub struct_size: u32,
    pub reserved: u32,
    pub support: Option<tribo_support_function>,
    /// may be null: contacts are then single points
    pub face: Option<tribo_face_function>,
    /// passed on as it is
    pub user: *const c_void,
    /// a point well inside
    pub center: [f64; 3],
    /// of a ball around center that holds the shape, m
    pub radius: f64,
}

impl Default for tribo_convex {
    /// All zeros.
    fn default() -> Self {
        // SAFETY: numbers, null pointers and absent functions are all zeros.
        unsafe { core::mem::zeroed() }
    }
}

#[cfg(target_pointer_width = "64")]
const _: () = assert!(core::mem::size_of::<tribo_convex>() == 64);

/// One point of a manifold. 64 bytes.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct tribo_point {
    /// from A's position to the point, midway between the surfaces, m
    pub arm_a: [f64; 3],
    /// the same point from the position of B's pose, m
    pub arm_b: [f64; 3],
    /// of the surfaces along the normal, m; negative inside
    pub distance: f64,
    /// which features touch, A's in the high half, B's in the low: persists from
    /// step to step while they do. A corner within 1e-4 of the shortest side from
    /// a vertex or edge has its name, so stacks of equal boxes keep theirs
    pub id: u64,
}

impl Default for tribo_point {
    /// All zeros.
    fn default() -> Self {
        // SAFETY: numbers, null pointers and absent functions are all zeros.
        unsafe { core::mem::zeroed() }
    }
}

#[cfg(target_pointer_width = "64")]
const _: () = assert!(core::mem::size_of::<tribo_point>() == 64);

/// Contact between two convex parts.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct tribo_manifold {
    /// number of points, 0 to 4
    pub count: u32,
    /// COMPOUND: index of the child; MESH: of the triangle; else 0
    pub child_a: u32,
    pub child_b: u32,
    /// TRIBO_METHOD_... that found it
    pub method: u32,
    /// unit, world axes, from B to A
    pub normal: [f64; 3],
    /// those from `count` on mean nothing
    pub points: [tribo_point; 4],
}

impl Default for tribo_manifold {
    /// All zeros.
    fn default() -> Self {
        // SAFETY: numbers, null pointers and absent functions are all zeros.
        unsafe { core::mem::zeroed() }
    }
}

#[cfg(target_pointer_width = "64")]
const _: () = assert!(core::mem::size_of::<tribo_manifold>() == 296);

/// Options of a collision query. Zero-initialise, set struct_size. Null: all defaults.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct tribo_collide_options {
    /// smaller (older) structs are accepted
    pub struct_size: u32,
    /// TRIBO_METHOD_...
    pub method: u32,
    /// 1 to 4; 0: 4. The deepest stays, and what keeps most area: all of an
    /// overlap of up to four corners. Faces of boxes have up to eight; of
    /// random ones the best four corners keep 0.97 of the area on the mean,
    /// 0.81 at worst, and 0.74 where the deepest is none of those. Corners
    /// as deep as the deepest to 1e-5 of the size are: area alone chooses,
    /// and the deepest of those that stay tells the greatest depth
    pub max_points: u32,
    pub reserved: u32,
    /// surfaces up to this far apart count (speculative), >= 0, m
    pub margin: f64,
}

impl Default for tribo_collide_options {
    /// All zeros.
    fn default() -> Self {
        // SAFETY: numbers, null pointers and absent functions are all zeros.
        unsafe { core::mem::zeroed() }
    }
}

#[cfg(target_pointer_width = "64")]
const _: () = assert!(core::mem::size_of::<tribo_collide_options>() == 24);

/// What a query cost. The caller sets struct_size.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct tribo_collide_info {
    pub struct_size: u32,
    /// pairs done in closed form
    pub closed: u32,
    /// pairs done by libccd
    pub general: u32,
    /// of these, those that ran into a bound of work: another direction may be
    /// a little less deep; the depth is that of the normal even then
    pub capped: u32,
    /// support function calls of the search; faces and bounds need a few
    pub supports: u64,
    /// upper bound of allocations libccd made
    pub mallocs: u64,
}

impl Default for tribo_collide_info {
    /// All zeros.
    fn default() -> Self {
        // SAFETY: numbers, null pointers and absent functions are all zeros.
        unsafe { core::mem::zeroed() }
    }
}

#[cfg(target_pointer_width = "64")]
const _: () = assert!(core::mem::size_of::<tribo_collide_info>() == 32);

/// One contact between two bodies of a system. 152 bytes.
///
///  Rows: one with dimension 1, or with mu_s = 0 and both lengths 0; three with friction; six with
///  a length > 0. An axis whose length is 0 has no torque.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct tribo_system_contact {
    /// index of body A, or TRIBO_WORLD
    pub a: u32,
    /// index of body B, or TRIBO_WORLD; not that of A
    pub b: u32,
    /// 3; or 1: frictionless, one row whatever the pair's friction and the
    /// lengths are
    pub dimension: u32,
    /// 0
    pub reserved: u32,
    /// normal and arms
    pub contact: tribo_contact,
    /// mu_s, mu_d, e
    pub pair: tribo_material,
    /// m/s, in contact coordinates: u - target takes the place of u in the
    /// laws of contact. Normal: -g/dt lets a gap g close and no more;
    /// tangential: the speed of a belt
    pub target: [f64; 3],
    /// m, >= 0: greatest torque about a tangent, of r_n; 0: none
    pub rolling: f64,
    /// m, >= 0: greatest torque about the normal, of r_n; 0: none
    pub spinning: f64,
}

impl Default for tribo_system_contact {
    /// All zeros.
    fn default() -> Self {
        // SAFETY: numbers, null pointers and absent functions are all zeros.
        unsafe { core::mem::zeroed() }
    }
}

#[cfg(target_pointer_width = "64")]
const _: () = assert!(core::mem::size_of::<tribo_system_contact>() == 152);

/// Certificate: how far the impulses are from the exact law. Per-contact measures are those of
///  audit.h with the scales V = |q_c| + |sum |W_cj||r_j|| and P = V / greatest diagonal entry of
///  W_cc; in the bodies form the sum is taken body by body, |J_c| |M^-1| sum |J_j^T||r_j|, which is
///  somewhat more. A contact is judged by mu_d; by mu_s where that is nearer, and then its sliding
///  velocity counts in full: over V in eta, squared in the sums of invariant and siconos. One-row
///  contacts are judged as contacts without friction. With restitution the measures judge the
///  plastic solution that it is built on.
///
///  The torque of a contact with a length is judged beside its impulse, and the worse of the two
///  counts: eta is |tau - P(tau - s omega)| / T with P the nearest torque within the bounds, 1 / s
///  the greatest diagonal entry of its 3x3 matrix W_tau (omega = W_tau tau + ...), T = s Omega, and
///  Omega the scale of omega as V is that of u, with V / arm added to it. The arm is about the
///  radius of gyration: the power of two with the binary exponent (x - y) / 2, rounded down, where x
///  and y are those of the greatest entries on the diagonals of W_cc and W_tau. Sums over contacts
///  (invariant, siconos, energy_scale, |q|) take arm omega for one more u and tau / arm for its r.
///  Cone is max(0, |tau| - bound) / T, misalignment | |omega| tau + bound omega | / (T Omega).
///
///  TRIBO_STOP_TOLERANCE by eta also promises eta V <= a tenth of the greatest |q|: where impulses
///  grow without bound, eta falls though nothing is solved. Of contacts with mu_d above 1 it promises
///  signorini within the tolerance too: eta divides by mu what normal velocities leave open.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct tribo_system_info {
    /// sizeof(tribo_system_info), set by the caller; of a smaller one
    /// what lies beyond it is not computed either
    pub struct_size: u32,
    /// TRIBO_STOP_...
    pub stop: u32,
    /// the TRIBO_SOLVER_... that gave the result
    pub solver: u32,
    /// connected components (islands) of the system
    pub components: u32,
    /// Gauss-Seidel sweeps, of the component that had most
    pub sweeps: u64,
    /// Newton's and interior steps, over all components
    pub steps: u64,
    /// matrices factored
    pub factorizations: u64,
    /// greatest natural-map residual of a contact, no unit
    pub eta: f64,
    /// root mean square of the same
    pub eta_rms: f64,
    /// greatest |min(u_n / V, r_n / P)|
    pub signorini: f64,
    /// greatest max(0, |r_t| - mu r_n) / P
    pub cone: f64,
    /// greatest | |u_t| r_t + mu r_n u_t | / (P V)
    pub misalignment: f64,
    /// as in TRIBO_MEASURE_INVARIANT; |q| = 0 gives 0
    pub invariant: f64,
    /// sqrt(sum |r - P_K(r - u')|^2) / max(|q|, |r|, |u|): the measure of
    /// Siconos 4.4, not free of units; not divided by less than 2^-52
    pub siconos: f64,
    /// change of kinetic energy by the impulses, r . (q + u) / 2, J;
    /// without the work of targets
    pub energy: f64,
    /// sum |r_c| (|q_c| + |u_c|) / 2, J: what energy is measured
    /// against
    pub energy_scale: f64,
    /// |change of total linear momentum, impulses of the world counted| /
    /// sum m |dv|; 0 in the assembled form
    pub linear: f64,
    /// the same of angular momentum about the origin; of meaning where
    /// the arms of each contact meet, and no axis is locked
    pub angular: f64,
    /// least share of the restitution stage that the energy allowed, 0 to
    /// 1; 1 where there is none
    pub restitution: f64,
    /// by the clock in the options; 0 without one
    pub seconds: f64,
    /// of the workspace that were used
    pub bytes: u64,
}

impl Default for tribo_system_info {
    /// All zeros.
    fn default() -> Self {
        // SAFETY: numbers, null pointers and absent functions are all zeros.
        unsafe { core::mem::zeroed() }
    }
}

#[cfg(target_pointer_width = "64")]
const _: () = assert!(core::mem::size_of::<tribo_system_info>() == 152);

/// Factorise and solve sparse linear systems for Newton: a user's own, or tribo_sparse of
///  libtribo. Without one, systems up to `dense_limit` unknowns are factored by dense elimination;
///  so they are, and narrow matrices of more unknowns, with one.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct tribo_linear {
    /// sizeof(tribo_linear), or offsetof(tribo_linear, sign)
    pub struct_size: u32,
    /// 0
    pub reserved: u32,
    /// handed to all functions
    pub context: *mut c_void,
    pub factor: Option<tribo_factor_function>,
    pub solve: Option<tribo_solve_function>,
    /// May be null, or beyond struct_size: piles that creep may end unsolved then, for the path of
    ///  Coulomb's law is followed by this sign.
    pub sign: Option<tribo_sign_function>,
}

impl Default for tribo_linear {
    /// All zeros.
    fn default() -> Self {
        // SAFETY: numbers, null pointers and absent functions are all zeros.
        unsafe { core::mem::zeroed() }
    }
}

#[cfg(target_pointer_width = "64")]
const _: () = assert!(core::mem::size_of::<tribo_linear>() == 40);

/// Options. All zeros but struct_size is the default.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct tribo_system_options {
    /// sizeof(tribo_system_options)
    pub struct_size: u32,
    /// TRIBO_SOLVER_...
    pub solver: u32,
    /// TRIBO_MEASURE_...
    pub measure: u32,
    /// TRIBO_ISA_... of the sweeps; no bit depends on it
    pub isa: u32,
    /// 1: `impulses` holds a start; 0: start from zero
    pub warm_start: u32,
    /// most tasks to hand to `parallel` at once; 0 counts as 1. No bit
    /// depends on it
    pub tasks: u32,
    /// of sweeps, and of Newton steps; 0: 1 000 000
    pub max_iterations: u64,
    /// 0: 1e-10; else > 0
    pub tolerance: f64,
    /// 0: no limit; else > 0, and a clock. Looked at between sweeps and
    /// steps
    pub max_seconds: f64,
    /// most unknowns of a dense matrix; 0: 192. The workspace grows with
    /// its square. Narrow matrices of more unknowns (towers, chains) are
    /// kept in the same memory, if they fit in
    pub dense_limit: u32,
    /// 0
    pub reserved: u32,
    /// may be null
    pub linear: *const tribo_linear,
    /// may be null
    pub progress: Option<tribo_progress_function>,
    /// may be null: all in the caller's thread
    pub parallel: Option<tribo_parallel_function>,
    /// may be null: no time is measured
    pub clock: Option<tribo_clock_function>,
    /// handed to progress, parallel and clock
    pub user: *mut c_void,
    /// width 3: receives the torques on A of all contacts, N m s; 0 where both
    /// lengths are 0. Holds their start if warm_start is 1. May be null: they
    /// start from 0 and are not told. Bodies form only
    pub torques: *mut f64,
}

impl Default for tribo_system_options {
    /// All zeros.
    fn default() -> Self {
        // SAFETY: numbers, null pointers and absent functions are all zeros.
        unsafe { core::mem::zeroed() }
    }
}

#[cfg(target_pointer_width = "64")]
const _: () = assert!(core::mem::size_of::<tribo_system_options>() == 104);

/// Where libtribo takes memory from.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct tribo_allocator {
    /// sizeof(tribo_allocator)
    pub struct_size: u32,
    /// 0
    pub reserved: u32,
    pub allocate: Option<tribo_allocate_function>,
    pub release: Option<tribo_release_function>,
    /// handed to both functions
    pub user: *mut c_void,
}

impl Default for tribo_allocator {
    /// All zeros.
    fn default() -> Self {
        // SAFETY: numbers, null pointers and absent functions are all zeros.
        unsafe { core::mem::zeroed() }
    }
}

#[cfg(target_pointer_width = "64")]
const _: () = assert!(core::mem::size_of::<tribo_allocator>() == 32);

/// What a tribo_sparse has done.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct tribo_sparse_info {
    /// sizeof(tribo_sparse_info), set by the caller
    pub struct_size: u32,
    /// SIMPLICIAL or SUPERNODAL: of the last matrix; AUTO: none yet
    pub method: u32,
    /// matrices factored, singular ones counted
    pub factorizations: u64,
    /// patterns analysed
    pub analyses: u64,
    /// right-hand sides
    pub solves: u64,
    /// of memory held now, SuiteSparse's part included
    pub bytes: u64,
    /// numbers in the factors of the last matrix, those of L or of L and
    /// U
    pub fill: u64,
}

impl Default for tribo_sparse_info {
    /// All zeros.
    fn default() -> Self {
        // SAFETY: numbers, null pointers and absent functions are all zeros.
        unsafe { core::mem::zeroed() }
    }
}

#[cfg(target_pointer_width = "64")]
const _: () = assert!(core::mem::size_of::<tribo_sparse_info>() == 48);

/// What holds for all of a scene. All zeros but struct_size is the default.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct tribo_scene_settings {
    /// sizeof(tribo_scene_settings)
    pub struct_size: u32,
    /// TRIBO_MIX_...: mu_s and mu_d of a pair
    pub friction_rule: u32,
    /// TRIBO_MIX_...: e of a pair
    pub restitution_rule: u32,
    /// 0
    pub reserved: u32,
    /// m/s^2, world axes; acts on dynamic bodies
    pub gravity: [f64; 3],
}

impl Default for tribo_scene_settings {
    /// All zeros.
    fn default() -> Self {
        // SAFETY: numbers, null pointers and absent functions are all zeros.
        unsafe { core::mem::zeroed() }
    }
}

#[cfg(target_pointer_width = "64")]
const _: () = assert!(core::mem::size_of::<tribo_scene_settings>() == 40);

/// A body of a scene. Fill it by tribo_scene_body_init, then change what differs.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct tribo_scene_body {
    /// sizeof(tribo_scene_body)
    pub struct_size: u32,
    /// TRIBO_BODY_...
    pub kind: u32,
    /// mass, pose, velocities; of a body that is not dynamic, inverse mass
    /// and inertia must be zero
    pub state: tribo_body,
    /// type 0: none, it touches nothing. HALFSPACE and MESH are not for
    /// dynamic bodies. What `data` names must outlive the body
    pub shape: tribo_shape,
    /// of the shape in the body's axes, origin at the centre of mass
    pub offset: tribo_pose,
    /// mixed with that of the other body by the rules of the scene
    pub material: tribo_material,
    /// m/s, body axes: velocity of the surface past the body, as that of a
    /// conveyor; what it has along a normal does nothing
    pub belt: [f64; 3],
    /// m, >= 0: length of rolling resistance, as in tribo_system_contact. Of two
    /// bodies the greater counts, for rubber resists on steel as it does
    /// on rubber
    pub rolling: f64,
    /// m, >= 0: the same of spinning resistance
    pub spinning: f64,
}

impl Default for tribo_scene_body {
    /// All zeros.
    fn default() -> Self {
        // SAFETY: numbers, null pointers and absent functions are all zeros.
        unsafe { core::mem::zeroed() }
    }
}

#[cfg(target_pointer_width = "64")]
const _: () = assert!(core::mem::size_of::<tribo_scene_body>() == 336);

/// Options of a step. All zeros but struct_size is the default.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct tribo_step_options {
    /// sizeof(tribo_step_options)
    pub struct_size: u32,
    /// 0 counts as 1; at most 2^20
    pub substeps: u32,
    /// TRIBO_SOLVER_...
    pub solver: u32,
    /// TRIBO_SKIP_..., or'ed
    pub skip: u32,
    /// of tribo_system_options; 0: 1000
    pub max_iterations: u64,
    /// the same; 0: 1e-12
    pub tolerance: f64,
    /// m: surfaces that are so near count as contacts, even if they do not
    /// come closer. 0: 1/64 of the lesser radius of the two bodies
    pub margin: f64,
    /// m/s: slower approaches are plastic. 0: what forces add to the
    /// approach in one sub-step
    pub threshold: f64,
    /// share of an overlap that one sub-step takes away; 0: 1/4; else in
    /// (0, 1\]
    pub correction: f64,
    /// s of rest after which an island sleeps; 0: never
    pub sleep_time: f64,
    /// m/s: rest is |v| + |omega| radius below this
    pub sleep_speed: f64,
    /// as in tribo_system_options
    pub tasks: u32,
    /// 0
    pub reserved: u32,
    /// may be null
    pub parallel: Option<tribo_parallel_function>,
    /// handed to parallel
    pub user: *mut c_void,
}

impl Default for tribo_step_options {
    /// All zeros.
    fn default() -> Self {
        // SAFETY: numbers, null pointers and absent functions are all zeros.
        unsafe { core::mem::zeroed() }
    }
}

#[cfg(target_pointer_width = "64")]
const _: () = assert!(core::mem::size_of::<tribo_step_options>() == 96);

/// What a step did, summed over its sub-steps unless stated. Stages that the scene did not need are
///  zero.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct tribo_step_info {
    /// sizeof(tribo_step_info), set by the caller
    pub struct_size: u32,
    /// done
    pub substeps: u32,
    /// worst TRIBO_STOP_... of contact and impact solves
    pub stop: u32,
    /// bodies that sleep at the end
    pub asleep: u32,
    /// bodies advanced
    pub flights: u64,
    /// of these, those that turned
    pub turns: u64,
    /// sub-steps with a broad phase
    pub broad: u64,
    /// pairs of bodies collided
    pub pairs: u64,
    /// contact points held by the contact solves
    pub contacts: u64,
    /// of these, those with one row
    pub frictionless: u64,
    /// of these, those with a length of resistance: six rows
    pub resisting: u64,
    /// of these, those with an impulse of the last sub-step
    pub matched: u64,
    /// sub-steps with a contact solve
    pub contact_solves: u64,
    /// sub-steps with an impact solve
    pub impact_solves: u64,
    /// contact points that had restitution in one
    pub impacts: u64,
    /// sub-steps in which bodies were moved apart
    pub correction_solves: u64,
    /// of tribo_system_info, over all solves
    pub sweeps: u64,
    /// the same
    pub newton_steps: u64,
    /// the same
    pub factorizations: u64,
    /// greatest of contact and impact solves
    pub eta: f64,
    /// least share of a restitution stage that the energy allowed; 1
    /// where there was none
    pub restitution: f64,
    /// greatest overlap at a midpoint, m
    pub penetration: f64,
}

impl Default for tribo_step_info {
    /// All zeros.
    fn default() -> Self {
        // SAFETY: numbers, null pointers and absent functions are all zeros.
        unsafe { core::mem::zeroed() }
    }
}

#[cfg(target_pointer_width = "64")]
const _: () = assert!(core::mem::size_of::<tribo_step_info>() == 160);

/// A contact point. A is the body with the lesser id.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct tribo_scene_contact {
    /// id of body A
    pub a: u32,
    /// id of body B
    pub b: u32,
    /// as in tribo_manifold
    pub child_a: u32,
    pub child_b: u32,
    /// which features touch
    pub id: u64,
    /// unit, from B to A
    pub normal: [f64; 3],
    /// from the centre of mass of A to the point, m
    pub arm_a: [f64; 3],
    /// the same from that of B
    pub arm_b: [f64; 3],
    /// of the surfaces, m; negative inside
    pub distance: f64,
    /// on A, world axes, N s, in the last sub-step; without impacts
    pub impulse: [f64; 3],
    /// of rolling and spinning resistance on A, world axes, N m s, the same
    pub torque: [f64; 3],
}

impl Default for tribo_scene_contact {
    /// All zeros.
    fn default() -> Self {
        // SAFETY: numbers, null pointers and absent functions are all zeros.
        unsafe { core::mem::zeroed() }
    }
}

#[cfg(target_pointer_width = "64")]
const _: () = assert!(core::mem::size_of::<tribo_scene_contact>() == 152);

/// What two bodies did to each other in a step. They touch in a step if in a sub-step of it they
///  exchange an impulse or a distance is not positive.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct tribo_scene_event {
    /// TRIBO_EVENT_...
    pub kind: u32,
    /// id
    pub a: u32,
    /// id, greater than a
    pub b: u32,
    /// contact points with restitution, over the sub-steps
    pub impacts: u32,
    /// on A, world axes, N s: all of the step, impacts included
    pub impulse: [f64; 3],
    /// sum of the normal impulses, N s
    pub normal: f64,
}

impl Default for tribo_scene_event {
    /// All zeros.
    fn default() -> Self {
        // SAFETY: numbers, null pointers and absent functions are all zeros.
        unsafe { core::mem::zeroed() }
    }
}

#[cfg(target_pointer_width = "64")]
const _: () = assert!(core::mem::size_of::<tribo_scene_event>() == 48);

extern "C" {
    /// Name of a status, as written above ("TRIBO_ERROR_NULL"); "TRIBO_ERROR_UNKNOWN" for any other
    ///  number. The string is static.
    pub fn tribo_status_name(status: tribo_status) -> *const c_char;
    /// One English sentence that says what is wrong; never null. The string is static.
    pub fn tribo_status_string(status: tribo_status) -> *const c_char;
    /// Version of the library that is linked, as major * 10000 + minor * 100 + patch.
    pub fn tribo_version() -> u32;
    /// The same as "major.minor.patch". The string is static.
    pub fn tribo_version_string() -> *const c_char;
    /// a . b, summed from left to right.
    pub fn tribo_vec3_dot(a: *const f64, b: *const f64) -> f64;
    /// out = a x b.
    pub fn tribo_vec3_cross(a: *const f64, b: *const f64, out: *mut f64);
    /// out = a + b.
    pub fn tribo_vec3_add(a: *const f64, b: *const f64, out: *mut f64);
    /// out = a - b.
    pub fn tribo_vec3_subtract(a: *const f64, b: *const f64, out: *mut f64);
    /// out = s a.
    pub fn tribo_vec3_scale(s: f64, a: *const f64, out: *mut f64);
    /// out = a + s b.
    pub fn tribo_vec3_add_scaled(a: *const f64, s: f64, b: *const f64, out: *mut f64);
    /// |a|, without overflow or underflow of the squares.
    pub fn tribo_vec3_norm(a: *const f64) -> f64;
    /// out = a / |a|, correct to 2 eps whatever the length of a.
    ///  @return TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE, or TRIBO_ERROR_RANGE if a is zero.
    pub fn tribo_vec3_normalize(a: *const f64, out: *mut f64) -> tribo_status;
    /// out = a b.
    pub fn tribo_mat3_multiply(a: *const f64, b: *const f64, out: *mut f64);
    /// out = a transposed.
    pub fn tribo_mat3_transpose(a: *const f64, out: *mut f64);
    /// out = a x.
    pub fn tribo_mat3_apply(a: *const f64, x: *const f64, out: *mut f64);
    /// out = a transposed, times x.
    pub fn tribo_mat3_apply_transposed(a: *const f64, x: *const f64, out: *mut f64);
    /// out = s x for a symmetric s.
    pub fn tribo_sym3_apply(s: *const f64, x: *const f64, out: *mut f64);
    /// out = S(r) = \[0 -rz ry; rz 0 -rx; -ry rx 0\]; S + S^T = 0 to the bit.
    pub fn tribo_skew_matrix(r: *const f64, out: *mut f64);
    /// out = S(r)^T A S(r) for a symmetric A: symmetric to the bit because each entry is computed once.
    ///  With A the inverse inertia in the same axes this is the angular part of the contact matrix.
    pub fn tribo_skew_congruence(r: *const f64, a: *const f64, out: *mut f64);
    /// out = r x (A x), A symmetric.
    pub fn tribo_skew_cross_apply(r: *const f64, a: *const f64, x: *const f64, out: *mut f64);
    /// Orthonormal right-handed basis from a unit normal: rows (n, t1, t2) of `frame`, the first equal
    ///  to n to the bit. x_contact = frame x_world.
    ///
    ///  Continuous everywhere but at n = (0, 0, -1) (and within 1e-150 of it), where t1 = (1, 0, 0),
    ///  t2 = (0, -1, 0). (No basis is
    ///  continuous on the whole sphere.) At n = (0, 0, 1): t1 = (1, 0, 0), t2 = (0, 1, 0). Zeros of
    ///  either sign give the same basis. Construction: rotate z to n about z x n; where n_z < 0 the
    ///  denominator 1 + n_z is formed without cancellation as (n_x^2 + n_y^2) / (1 - n_z).
    ///  Deviation from orthonormality: at most 8 eps for a normal that is unit to an eps.
    ///  @return TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE, or TRIBO_ERROR_NORMAL if | |n|^2 - 1 | >
    ///           1e-12.
    pub fn tribo_basis_from_normal(n: *const f64, frame: *mut f64) -> tribo_status;
    /// out = a b: the rotation b, then a.
    pub fn tribo_quat_multiply(a: *const f64, b: *const f64, out: *mut f64);
    /// out = (w, -x, -y, -z): the inverse of a unit quaternion.
    pub fn tribo_quat_conjugate(q: *const f64, out: *mut f64);
    /// out = q / |q|. @return TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE, TRIBO_ERROR_RANGE if q is
    ///  zero.
    pub fn tribo_quat_normalize(q: *const f64, out: *mut f64) -> tribo_status;
    /// Rotation matrix of q / |q|; q need not be of unit length, but must not be zero.
    pub fn tribo_quat_to_mat3(q: *const f64, out: *mut f64);
    /// out = R(q) x: body to world.
    pub fn tribo_quat_rotate(q: *const f64, x: *const f64, out: *mut f64);
    /// out = R(q)^T x: world to body.
    pub fn tribo_quat_rotate_inverse(q: *const f64, x: *const f64, out: *mut f64);
    /// Quaternion of the rotation by |v| radians about v (the exponential map); |v| <= 2^20.
    ///  @return TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE, TRIBO_ERROR_RANGE.
    pub fn tribo_quat_from_rotation_vector(v: *const f64, out: *mut f64) -> tribo_status;
    /// Angle in \[0, pi\] of the rotation that takes a to b; both of any length but zero. Accurate for
    ///  small angles too: 2 atan2(|vector part|, |scalar part|) of conj(a) b.
    pub fn tribo_quat_angle(a: *const f64, b: *const f64) -> f64;
    /// Sine and cosine of x radians, |x| <= 2^20 (NaN beyond), within 2 ulp.
    ///  Reduction by pi/2 in three parts (Cody & Waite 1980), then Taylor polynomials on \[-pi/4,
    ///  pi/4\].
    pub fn tribo_sin_cos(x: f64, sine: *mut f64, cosine: *mut f64);
    /// Angle of the point (x, y) in \[-pi, pi\], within 2 ulp; 0 for (0, 0); signed
    ///  zeros as in C; NaN if an argument is not finite.
    pub fn tribo_atan2(y: f64, x: f64) -> f64;
    /// The power of two s with 1 <= s |x| < 2 for |x| in \[2^-1000, 2^1000\]; beyond, s of the nearer end
    ///  of that range; 1 for x = 0. Scaling by it is exact.
    pub fn tribo_pow2_scale(x: f64) -> f64;
    /// Make `body` immovable, at the origin, at rest. @return TRIBO_ERROR_NULL.
    pub fn tribo_body_init(body: *mut tribo_body) -> tribo_status;
    /// Set inverse mass and inverse inertia from mass (kg) and inertia tensor (kg m^2, about the centre
    ///  of mass, body axes).
    ///  @param inertia symmetric (relative asymmetry up to 1e-12 is averaged out), positive definite,
    ///         and of a possible body: no principal moment exceeds the sum of the others by more than
    ///         1e-9 of it.
    ///  @return TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE, TRIBO_ERROR_MASS (mass <= 0),
    ///          TRIBO_ERROR_INERTIA, TRIBO_ERROR_RANGE (a reciprocal is not finite).
    pub fn tribo_body_set_mass(body: *mut tribo_body, mass: f64, inertia: *const f64) -> tribo_status;
    /// Judge every field of a body.
    ///  @return TRIBO_OK, TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE, TRIBO_ERROR_ORIENTATION
    ///          (||q|-1|>1e-6), TRIBO_ERROR_MASS (negative), TRIBO_ERROR_INERTIA (not positive
    ///          semidefinite to 1e-12).
    pub fn tribo_body_check(body: *const tribo_body) -> tribo_status;
    /// Ball of the given radius: I = 2/5 m r^2.
    pub fn tribo_mass_sphere(density: f64, radius: f64, mass: *mut f64, inertia: *mut f64) -> tribo_status;
    /// Box of half-extents h: I_xx = m/3 (h_y^2 + h_z^2), and so on.
    pub fn tribo_mass_box(density: f64, half: *const f64, mass: *mut f64, inertia: *mut f64) -> tribo_status;
    /// Cylinder of axis z from -half_height to half_height, with half-balls of the same radius on its
    ///  ends.
    pub fn tribo_mass_capsule(density: f64, radius: f64, half_height: f64, mass: *mut f64, inertia: *mut f64) -> tribo_status;
    /// Cylinder of axis z from -half_height to half_height.
    pub fn tribo_mass_cylinder(density: f64, radius: f64, half_height: f64, mass: *mut f64, inertia: *mut f64) -> tribo_status;
    /// Ellipsoid of semi-axes a: I_xx = m/5 (a_y^2 + a_z^2), and so on.
    pub fn tribo_mass_ellipsoid(density: f64, semi_axes: *const f64, mass: *mut f64, inertia: *mut f64) -> tribo_status;
    /// Inverse inertia in world axes: R I_body^-1 R^T (lecture, "The algorithm for angular motion").
    ///  Symmetric to the bit. @return TRIBO_ERROR_NULL or a status of tribo_body_check.
    pub fn tribo_body_world_inverse_inertia(body: *const tribo_body, out: *mut f64) -> tribo_status;
    /// Spin angular momentum about the centre of mass, world axes, kg m^2/s: R I R^T omega; an axis
    ///  that cannot be turned contributes nothing.
    ///  @return TRIBO_ERROR_NULL, a status of tribo_body_check, TRIBO_ERROR_INERTIA also where the
    ///          inverse inertia is singular in any other way than by zero rows.
    pub fn tribo_body_spin(body: *const tribo_body, out: *mut f64) -> tribo_status;
    /// Velocity of the body's point at `arm` from the centre of mass (world axes): v + omega x arm,
    ///  m/s.
    pub fn tribo_body_point_velocity(body: *const tribo_body, arm: *const f64, out: *mut f64);
    /// Add the impulse `p` (N s, world axes) at `arm`: v += p/m, omega += I^-1 (arm x p).
    ///  An immovable body is not changed.
    ///  @return TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE, or a status of tribo_body_check;
    ///          TRIBO_ERROR_RANGE if a velocity would not be finite.
    pub fn tribo_body_apply_impulse(body: *mut tribo_body, arm: *const f64, p: *const f64) -> tribo_status;
    /// Free flight: advance pose and velocities by dt seconds under a constant acceleration (m/s^2,
    ///  world axes; may be null: none) and no torque.
    ///
    ///  Translation is the exact parabola. Rotation solves Euler's equations I w' = (I w) x w with the
    ///  quaternion by Taylor series in the body's axes, to rounding: order and number of sub-steps
    ///  follow from |omega| dt, so kinetic energy and angular momentum are kept to rounding and there is
    ///  no time-step error (free rotation as in Goldstein, Classical Mechanics, 3rd ed., 5.6). Bodies
    ///  with equal moments cost less. Cost grows with |omega| dt beyond about half a radian per step.
    ///  A body with locked axes (zero rows of inverse inertia) keeps the angular velocity that it has.
    ///  A body with zero inverse mass is kinematic: it moves with its velocities and is not accelerated.
    ///  @param dt >= 0; |omega| dt <= 1e5.
    ///  @return TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE, TRIBO_ERROR_TIME_STEP, TRIBO_ERROR_RANGE
    ///          (result not finite), or a status of tribo_body_check (TRIBO_ERROR_INERTIA as in
    ///          tribo_body_spin).
    pub fn tribo_body_advance(body: *mut tribo_body, acceleration: *const f64, dt: f64) -> tribo_status;
    /// @return TRIBO_OK, TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE, TRIBO_ERROR_FRICTION,
    ///          TRIBO_ERROR_RESTITUTION.
    pub fn tribo_material_check(material: *const tribo_material) -> tribo_status;
    /// Mix two materials into the coefficients of the pair. Symmetric in a and b to the bit.
    ///  @param friction_rule    TRIBO_MIX_..., for mu_s and mu_d (mu_d <= mu_s is kept by each rule)
    ///  @param restitution_rule TRIBO_MIX_..., for e
    ///  @return TRIBO_ERROR_NULL, TRIBO_ERROR_OPTION, a status of tribo_material_check,
    ///          TRIBO_ERROR_RANGE (the product overflows).
    pub fn tribo_material_mix(a: *const tribo_material, b: *const tribo_material, friction_rule: u32, restitution_rule: u32, out: *mut tribo_material) -> tribo_status;
    /// Mix by the user's rule; what it returns is checked before `out` is written.
    ///  @return TRIBO_ERROR_NULL (user may be null), a status of tribo_material_check.
    pub fn tribo_material_mix_with(a: *const tribo_material, b: *const tribo_material, rule: Option<tribo_mix_function>, user: *mut c_void, out: *mut tribo_material) -> tribo_status;
    /// Number of entries in the table of pairs. The table is the lecture's ("Some coefficients"): wood
    ///  on stone 0.7/0.3 and steel on steel 0.16/0.12; it gives no restitution, so e is 0.
    pub fn tribo_material_count() -> u32;
    /// Entry `index` of the table.
    ///  @param name receives a static string, such as "wood on stone"; may be null
    ///  @return TRIBO_ERROR_NULL (out), TRIBO_ERROR_INDEX.
    pub fn tribo_material_at(index: u32, name: *mut *const c_char, out: *mut tribo_material) -> tribo_status;
    /// Entry of the table by its name. @return TRIBO_ERROR_NULL, TRIBO_ERROR_NAME.
    pub fn tribo_material_find(name: *const c_char, out: *mut tribo_material) -> tribo_status;
    /// Contact of bodies A and B at a world point with a normal from B to A. b may be null: the world,
    ///  whose arm is zero.
    ///  @return TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE, TRIBO_ERROR_NORMAL.
    pub fn tribo_contact_at(a: *const tribo_body, b: *const tribo_body, point: *const f64, normal: *const f64, out: *mut tribo_contact) -> tribo_status;
    /// Judge a contact. @return TRIBO_OK, TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE,
    ///  TRIBO_ERROR_NORMAL.
    pub fn tribo_contact_check(contact: *const tribo_contact) -> tribo_status;
    /// u = frame (v_A - v_B) at the contact point, m/s. b may be null: the world at rest. `frame` as
    ///  from tribo_basis_from_normal (any orthonormal rows do). @return TRIBO_ERROR_NULL,
    ///  TRIBO_ERROR_NOT_FINITE.
    pub fn tribo_contact_velocity(a: *const tribo_body, b: *const tribo_body, contact: *const tribo_contact, frame: *const f64, u: *mut f64) -> tribo_status;
    /// Contact matrix W = N^T \[(1/m_A + 1/m_B) 1 + sum S(r)^T I^-1 S(r)\] N with N^T = frame (lecture,
    ///  "The algorithm for angular motion": Delta V_contact). Six entries, each computed once: symmetric
    ///  to the bit. Built in body axes as sum_k x_k . I_body^-1 x_l, x_k = R^T (r x n_k), so slender
    ///  bodies lose no digits; immovable bodies cost nothing. b may be null: the world.
    ///  @return TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE, TRIBO_ERROR_NORMAL, TRIBO_ERROR_FRAME (rows
    ///          not orthonormal to 1e-9), TRIBO_ERROR_ALIAS (a is b), a status of tribo_body_check,
    ///          TRIBO_ERROR_IMMOVABLE (W_nn = 0), TRIBO_ERROR_RANGE (an entry overflows).
    pub fn tribo_contact_matrix(a: *const tribo_body, b: *const tribo_body, contact: *const tribo_contact, frame: *const f64, w: *mut f64) -> tribo_status;
    /// Apply p (contact coordinates, N s) as +p to A and -p to B. b may be null.
    ///  @return TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE, TRIBO_ERROR_ALIAS (a is b), a status of
    ///          tribo_body_check, TRIBO_ERROR_RANGE.
    pub fn tribo_contact_apply(a: *mut tribo_body, b: *mut tribo_body, contact: *const tribo_contact, frame: *const f64, p: *const f64) -> tribo_status;
    /// 1 if p lies in K, allowing |p_t| a relative excess of `tolerance` (>= 0; rounding of p itself
    ///  makes 4 eps a sensible least value), else 0. 0 <= mu < infinity.
    pub fn tribo_cone_contains(p: *const f64, mu: f64, tolerance: f64) -> u32;
    /// out = the point of K nearest to p. No division by mu; right for all finite p and mu >= 0, also
    ///  where squares would overflow. @return TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE,
    ///  TRIBO_ERROR_FRICTION, TRIBO_ERROR_RANGE (that point is beyond double).
    pub fn tribo_cone_project(p: *const f64, mu: f64, out: *mut f64) -> tribo_status;
    /// out = the point of K* nearest to x; x = P_K(x) - P_K*(-x) (Moreau). Statuses as above.
    pub fn tribo_cone_project_dual(x: *const f64, mu: f64, out: *mut f64) -> tribo_status;
    /// out = p with p_n raised to 0 and p_t shortened to mu p_n: the cheap clamp of engines, not a
    ///  projection. Statuses as above.
    pub fn tribo_cone_clamp(p: *const f64, mu: f64, out: *mut f64) -> tribo_status;
    /// Find p with v = W p + b, 0 <= v_n, 0 <= p_n, v_n p_n = 0, |p_t| <= mu p_n, and sliding velocity
    ///  v_t opposite to p_t wherever |p_t| = mu p_n: exact Signorini-Coulomb, no pyramid, no relaxation.
    ///
    ///  b_n >= 0: p = 0. Else the sticking p = -W^-1 b if it lies in the cone of mu_s. Else slip with
    ///  mu_d, one scalar equation: with S = W_tt - w_t w_t^T / W_nn and c = -(b_t - w_t b_n / W_nn),
    ///  find nu > 0 with mu p_n(nu) = |p_t(nu)|, p_t = (S + nu 1)^-1 c, p_n = -(b_n + w_t . p_t) / W_nn.
    ///  A root lies in (0, |c| (W_nn + mu |w_t|) / (mu |b_n|)\], so bisection behind Newton cannot fail.
    ///  Where Coulomb's law has three solutions, stick is preferred to slip, and the slip that is found
    ///  is the same on every platform.
    ///
    ///  W and b are scaled by powers of two first: multiplying W by 2^i and b by 2^j multiplies p by
    ///  2^(j-i) to the bit.
    ///
    ///  @param w    positive semidefinite to 1e-12, greatest diagonal entry within \[2^-1000, 2^1000\]
    ///  @param b    velocity that is to be cancelled, |b_i| <= 2^1000
    ///  @param mu_s static, mu_d dynamic coefficient, 0 <= mu_d <= mu_s
    ///  @param p    receives the impulse
    ///  @param info may be null
    ///  @return TRIBO_ERROR_NULL, TRIBO_ERROR_STRUCT_SIZE, TRIBO_ERROR_NOT_FINITE, TRIBO_ERROR_RANGE
    ///          (input beyond the above, or p beyond double), TRIBO_ERROR_FRICTION,
    ///          TRIBO_ERROR_CONTACT_MATRIX (also where W is so near to singular that no answer can be
    ///          certified), TRIBO_ERROR_IMMOVABLE (W_nn = 0), TRIBO_ERROR_JAM (W is only semidefinite
    ///          and no bounded impulse exists).
    pub fn tribo_contact_solve(w: *const f64, b: *const f64, mu_s: f64, mu_d: f64, p: *mut f64, info: *mut tribo_solve_info) -> tribo_status;
    /// The same for any W with W_nn > 0, symmetric or not (row by row), such as implicit integrators of
    ///  gyroscopic terms give: the same steps on the same scalar equation, which needs no symmetry of S,
    ///  and bisection behind them. If no nu solves it, nor sticking, the contact jams.
    ///  @return as tribo_contact_solve; TRIBO_ERROR_CONTACT_MATRIX if W_nn < 0 or the symmetric part of
    ///          the Schur complement of W_nn is not positive semidefinite.
    pub fn tribo_contact_solve_general(w: *const f64, b: *const f64, mu_s: f64, mu_d: f64, p: *mut f64, info: *mut tribo_solve_info) -> tribo_status;
    /// Impulse of an impact with relative velocity u by the law in `options`. u_n >= 0: p = 0, OPEN.
    ///  @param w       contact matrix, as in tribo_contact_solve
    ///  @param u       u- in contact coordinates, |u_i| <= 2^1000
    ///  @param pair    coefficients of the pair
    ///  @param options may be null: ALGEBRAIC
    ///  @param p       receives the impulse, N s
    ///  @param info    may be null
    ///  @return TRIBO_ERROR_NULL, TRIBO_ERROR_STRUCT_SIZE, TRIBO_ERROR_OPTION, TRIBO_ERROR_NOT_FINITE,
    ///          TRIBO_ERROR_RANGE (p, or what info asks for, is beyond double), TRIBO_ERROR_FRICTION,
    ///          TRIBO_ERROR_RESTITUTION, TRIBO_ERROR_CONTACT_MATRIX, TRIBO_ERROR_IMMOVABLE,
    ///          TRIBO_ERROR_JAM. FRICTIONLESS needs, and judges, no more of W than its size and
    ///          diagonal. A W that is only semidefinite is accepted by FRICTIONLESS and ALGEBRAIC
    ///          always, by LECTURE never (TRIBO_ERROR_CONTACT_MATRIX), by COULOMB and ROUTH where a
    ///          solution exists.
    pub fn tribo_impact(w: *const f64, u: *const f64, pair: *const tribo_material, options: *const tribo_impact_options, p: *mut f64, info: *mut tribo_impact_info) -> tribo_status;
    /// A whole collision: judge, build frame and W, find the impulse, apply it. Only the velocities of
    ///  a and b change; nothing changes if they separate.
    ///  @param b       may be null: the immovable world
    ///  @param pair    coefficients of the pair (tribo_material_mix makes them of two materials)
    ///  @param options may be null: ALGEBRAIC
    ///  @param info    may be null
    ///  @return TRIBO_ERROR_NULL, TRIBO_ERROR_STRUCT_SIZE, TRIBO_ERROR_OPTION, TRIBO_ERROR_NOT_FINITE,
    ///          TRIBO_ERROR_NORMAL, TRIBO_ERROR_ALIAS (a is b), a status of tribo_body_check,
    ///          tribo_material_check or tribo_impact.
    pub fn tribo_contact_resolve(a: *mut tribo_body, b: *mut tribo_body, contact: *const tribo_contact, pair: *const tribo_material, options: *const tribo_impact_options, info: *mut tribo_collision_info) -> tribo_status;
    /// tribo_contact_at, then tribo_contact_resolve.
    pub fn tribo_collide(a: *mut tribo_body, b: *mut tribo_body, point: *const f64, normal: *const f64, pair: *const tribo_material, options: *const tribo_impact_options, info: *mut tribo_collision_info) -> tribo_status;
    /// Reaction r = -|f . n| n of a force f (N) that presses the body onto the surface, f . n < 0, n
    ///  the surface's unit normal (towards the body); zero if f does not press.
    ///  @return TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE, TRIBO_ERROR_NORMAL.
    pub fn tribo_friction_reaction(f: *const f64, n: *const f64, reaction: *mut f64) -> tribo_status;
    /// Planar force f - r, the part of f that tries to slide the body; f minus its normal part if f
    ///  does not press. Statuses as above.
    pub fn tribo_friction_planar(f: *const f64, n: *const f64, planar: *mut f64) -> tribo_status;
    /// 1 if static friction holds: |planar| <= mu_s |reaction|; else 0.
    pub fn tribo_friction_holds(planar: *const f64, reaction: *const f64, mu_s: f64) -> u32;
    /// Friction force on a body at rest under f: static, -planar, while that holds; else dynamic,
    ///  -mu_d |r| planar / |planar|. `mode` (may be null) receives STICK, SLIP, or OPEN if f does not
    ///  press (then the force is zero).
    ///  @return TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE, TRIBO_ERROR_NORMAL, a status of
    ///          tribo_material_check.
    pub fn tribo_friction_force(f: *const f64, n: *const f64, pair: *const tribo_material, force: *mut f64, mode: *mut u32) -> tribo_status;
    /// Momentum about `origin` and kinetic energy of `count` bodies.
    ///  Angular momentum is conserved only about one point common to all bodies (lecture).
    ///  @return TRIBO_ERROR_NULL, or a status of tribo_body_check for the first bad body.
    pub fn tribo_audit_bodies(count: usize, bodies: *const tribo_body, origin: *const f64, out: *mut tribo_totals) -> tribo_status;
    /// @return TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE.
    pub fn tribo_audit_change(before: *const tribo_totals, after: *const tribo_totals, out: *mut tribo_change) -> tribo_status;
    /// Measures of one contact; b = 0 and p = 0 give zeros.
    ///  @return TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE, TRIBO_ERROR_FRICTION (mu < 0),
    ///          TRIBO_ERROR_IMMOVABLE (no positive diagonal entry), TRIBO_ERROR_RANGE (a measure is
    ///          beyond double, where mu or p is).
    pub fn tribo_audit_contact(w: *const f64, b: *const f64, mu: f64, p: *const f64, out: *mut tribo_measures) -> tribo_status;
    /// Measures of an impact: those of tribo_audit_contact for b = ((1+e) u_n, u_t) and the coefficient
    ///  that fits p (mu_s if p leaves no sliding velocity, else mu_d), but with `energy` = p . (u- + u+)
    ///  / 2 / (P V), the true change, and `velocity` the deviation (u_n+ + e u_n-) / V from Newton's
    ///  restitution, 0 where u_n- >= 0 (there is no impact then). eta is then the distance of any law's
    ///  impulse from Coulomb's law with Newton's restitution.
    ///  @return as tribo_audit_contact, TRIBO_ERROR_FRICTION, TRIBO_ERROR_RESTITUTION.
    pub fn tribo_audit_impact(w: *const f64, u: *const f64, pair: *const tribo_material, p: *const f64, out: *mut tribo_measures) -> tribo_status;
    /// Measures over `count` contacts: greatest absolute value and root mean square of each field.
    ///  @param w,b,p widths 6, 3, 3, contact-major as in batch.h
    ///  @param mu    width 1
    ///  @param max   may be null
    ///  @param rms   may be null
    ///  @return TRIBO_ERROR_NULL, or a status of tribo_audit_contact for the first bad contact. count =
    ///          0 gives zeros.
    pub fn tribo_audit_contacts(count: usize, w: *const f64, b: *const f64, mu: *const f64, p: *const f64, max: *mut tribo_measures, rms: *mut tribo_measures) -> tribo_status;
    /// 1 if this machine and this build have the instruction set, else 0.
    pub fn tribo_isa_available(isa: u32) -> u32;
    /// "best", "scalar", "baseline", "x86-64-v3", "x86-64-v4"; null for any other number. Static
    ///  string.
    pub fn tribo_isa_name(isa: u32) -> *const c_char;
    /// Frames and contact matrices of `count` contacts.
    ///  @param isa        TRIBO_ISA_...
    ///  @param bodies     body_count bodies; each body that is used is judged as by tribo_body_check
    ///  @param pairs      width 2: indices of bodies A and B, or TRIBO_WORLD
    ///  @param contacts   count contacts
    ///  @param frames     width 9: receives the frames of tribo_basis_from_normal; may be null
    ///  @param w          width 6: receives the matrices, as tribo_contact_matrix gives them
    ///  @param statuses   width 1: receives a status per contact (TRIBO_ERROR_INDEX for a bad index,
    ///                    TRIBO_ERROR_ALIAS for the same body twice); may be null
    ///  @return TRIBO_OK; the first status that is not TRIBO_OK by contact order; or, with nothing done,
    ///          TRIBO_ERROR_NULL (arrays may be null if count is 0), TRIBO_ERROR_OPTION,
    ///          TRIBO_ERROR_ISA.
    pub fn tribo_batch_matrix(isa: u32, body_count: usize, bodies: *const tribo_body, count: usize, pairs: *const u32, contacts: *const tribo_contact, frames: *mut f64, w: *mut f64, statuses: *mut tribo_status) -> tribo_status;
    /// Exact solve of `count` contacts: tribo_contact_solve on each.
    ///  @param w        width 6
    ///  @param b        width 3
    ///  @param mu       width 2: mu_s, mu_d
    ///  @param p        width 3: receives impulses
    ///  @param modes    width 1: receives TRIBO_MODE_...; JAM where the status is TRIBO_ERROR_JAM; may
    ///                  be null
    ///  @param statuses as in tribo_batch_matrix
    ///  @return as tribo_batch_matrix.
    pub fn tribo_batch_solve(isa: u32, count: usize, w: *const f64, b: *const f64, mu: *const f64, p: *mut f64, modes: *mut u32, statuses: *mut tribo_status) -> tribo_status;
    /// ALGEBRAIC impact of `count` contacts: tribo_impact with default options, and without info, on
    ///  each.
    ///  @param u     width 3: relative velocities before
    ///  @param pairs count coefficients of pairs
    ///  @param p     width 3: receives impulses
    ///  @param modes as in tribo_batch_solve
    ///  @return as tribo_batch_matrix.
    pub fn tribo_batch_impact(isa: u32, count: usize, w: *const f64, u: *const f64, pairs: *const tribo_material, p: *mut f64, modes: *mut u32, statuses: *mut tribo_status) -> tribo_status;
    /// Bytes for a tree of up to `capacity` boxes (1 to 2^30); 0 if that is out of range.
    pub fn tribo_tree_size(capacity: u32) -> usize;
    /// Make an empty tree in `block` (aligned to 8, of tribo_tree_size(capacity) bytes). The block
    ///  may be copied or moved: it has no pointers.
    ///  @param margin m, >= 0: stored boxes are larger by it on each side, so that small moves cost
    ///                nothing
    ///  @param tree   receives the tree: the block itself
    ///  @return TRIBO_ERROR_NULL, TRIBO_ERROR_RANGE, TRIBO_ERROR_NOT_FINITE.
    pub fn tribo_tree_init(block: *mut c_void, capacity: u32, margin: f64, tree: *mut *mut tribo_tree) -> tribo_status;
    /// Add a box; `id` receives its number: the smallest that is free.
    ///  @return TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE (NaN; infinities are allowed),
    ///          TRIBO_ERROR_RANGE (low > high), TRIBO_ERROR_CAPACITY.
    pub fn tribo_tree_add(tree: *mut tribo_tree, low: *const f64, high: *const f64, id: *mut u32) -> tribo_status;
    /// Move a box. @return as tribo_tree_add, but for the capacity; TRIBO_ERROR_INDEX.
    pub fn tribo_tree_move(tree: *mut tribo_tree, id: u32, low: *const f64, high: *const f64) -> tribo_status;
    /// Remove a box. @return TRIBO_ERROR_NULL, TRIBO_ERROR_INDEX.
    pub fn tribo_tree_remove(tree: *mut tribo_tree, id: u32) -> tribo_status;
    /// All pairs of overlapping boxes (touching counts), each once as (smaller id, greater id),
    ///  sorted: the order does not depend on how the tree came to be. Exact boxes are compared, not
    ///  the enlarged ones.
    ///  @param capacity room in pairs (width 2)
    ///  @param pairs    may be null if capacity is 0
    ///  @param count    receives the number of pairs, also with TRIBO_ERROR_CAPACITY (then pairs
    ///                  holds nothing of use)
    ///  @return TRIBO_ERROR_NULL, TRIBO_ERROR_CAPACITY.
    pub fn tribo_tree_pairs(tree: *const tribo_tree, capacity: usize, pairs: *mut u32, count: *mut usize) -> tribo_status;
    /// Boxes that overlap a box (touching counts, bounds may be infinite): ids, sorted.
    ///  As tribo_tree_pairs; TRIBO_ERROR_NOT_FINITE (NaN), TRIBO_ERROR_RANGE (low > high).
    pub fn tribo_tree_query_box(tree: *const tribo_tree, low: *const f64, high: *const f64, capacity: usize, ids: *mut u32, count: *mut usize) -> tribo_status;
    /// Boxes that the segment from + t (to - from), 0 <= t <= 1, meets: ids, sorted. None that is
    ///  met is missed, touched ones included. One that the segment passes by is told only where
    ///  rounding hides the gap: beside an edge or corner, where changing t by a part of 2^-48 closes
    ///  it. As tribo_tree_pairs; TRIBO_ERROR_NOT_FINITE (infinities too).
    pub fn tribo_tree_query_ray(tree: *const tribo_tree, from: *const f64, to: *const f64, capacity: usize, ids: *mut u32, count: *mut usize) -> tribo_status;
    /// Judge a shape and the data it names; of a block its head alone, at the same cost for any size
    ///  (tribo_hull_check and tribo_mesh_check judge all of it).
    ///  @return TRIBO_OK, TRIBO_ERROR_NULL (shape, or data that its type needs), TRIBO_ERROR_OPTION
    ///          (type), TRIBO_ERROR_NOT_FINITE, TRIBO_ERROR_SHAPE (a size is not positive; a compound
    ///          has no child, or one that is not convex),
    ///          TRIBO_ERROR_NORMAL (HALFSPACE), TRIBO_ERROR_ORIENTATION (child), TRIBO_ERROR_STRUCT_SIZE
    ///          (CONVEX), TRIBO_ERROR_DATA (the block is not one of this version).
    pub fn tribo_shape_check(shape: *const tribo_shape) -> tribo_status;
    /// Support point of a convex shape in its own axes: the farthest along `direction` (any length but
    ///  zero). Where an edge or a face is farthest: the box gives the corner on the positive side, round
    ///  shapes the centre of the cap or the apex, a hull one of the vertices. Zeros of either sign are
    ///  the same.
    ///  @return TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE, TRIBO_ERROR_RANGE (direction is zero),
    ///          TRIBO_ERROR_SHAPE (not convex, or unbounded), TRIBO_ERROR_SUPPORT (the user's function
    ///          gave a point that is not finite). The shape is not judged otherwise.
    pub fn tribo_shape_support(shape: *const tribo_shape, direction: *const f64, point: *mut f64) -> tribo_status;
    /// Face of a convex shape that faces `direction` most, in its own axes: its vertices in order,
    ///  counter-clockwise seen from outside. A curved place gives 1 point; the side of a capsule,
    ///  cylinder or cone a line of it, 2 points by rising z (of a capsule moved out along the
    ///  direction); circles give 8 points at multiples of 45 degrees from the x axis. Of a hull the
    ///  faces at the support point are compared: a better one elsewhere would be no place of contact.
    ///  @param capacity room in points (width 3); TRIBO_MAX_FACE is always enough (larger faces are
    ///                  thinned)
    ///  @param count    receives the number of points
    ///  @param normal   receives the outward unit normal of the face; of a point or edge, direction /
    ///                  |direction|
    ///  @return as tribo_shape_support, TRIBO_ERROR_CAPACITY.
    pub fn tribo_shape_face(shape: *const tribo_shape, direction: *const f64, capacity: u32, points: *mut f64, count: *mut u32, normal: *mut f64) -> tribo_status;
    /// Axis-aligned bounds of a shape at a pose, world axes; the tightest, to rounding (no margin is
    ///  added). CONVEX: by six calls of the user's function. MESH: visits all triangles. HALFSPACE:
    ///  infinite along what it does not bound, and it bounds only an axis on which its normal lies to
    ///  the bit.
    ///  @return a status of tribo_shape_check, TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE,
    ///          TRIBO_ERROR_ORIENTATION, TRIBO_ERROR_SUPPORT (the user's function gave a point that is
    ///          not finite).
    pub fn tribo_shape_bounds(shape: *const tribo_shape, pose: *const tribo_pose, low: *mut f64, high: *mut f64) -> tribo_status;
    /// Mass properties of a uniform solid of that shape. Hulls by exact integrals; what the children of
    ///  a compound have in common counts for each of them.
    ///  @param density kg/m^3
    ///  @param mass    receives kg
    ///  @param center  receives the centre of mass in the axes of the shape, m
    ///  @param inertia receives the inertia about that centre, in the axes of the shape, kg m^2
    ///  @return a status of tribo_shape_check, TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE,
    ///          TRIBO_ERROR_SHAPE (density <= 0; HALFSPACE, MESH and CONVEX have none),
    ///          TRIBO_ERROR_RANGE.
    pub fn tribo_shape_mass(shape: *const tribo_shape, density: f64, mass: *mut f64, center: *mut f64, inertia: *mut f64) -> tribo_status;
    /// Convex hull of points as a flat block: vertices, face planes, ordered faces (coplanar ones
    ///  merged), neighbours. Faces by Qhull (Barber, Dobkin, Huhdanpaa, ACM TOMS 22 (1996) 469). This is
    ///  the one function here that allocates, by malloc, and it frees all before it returns.
    ///  @param count  number of points, 4 to 2^24
    ///  @param points width 3
    ///  @param block  receives the hull, aligned to 8; may be null if capacity is 0
    ///  @param needed receives the bytes the block needs (also with TRIBO_ERROR_CAPACITY); may be null
    ///  @return TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE, TRIBO_ERROR_RANGE (count, or the
    ///          radius overflows), TRIBO_ERROR_DEGENERATE (all points equal, on a line or in a plane,
    ///          relative to their extent by 1e-12; or so nearly that rounding leaves no convex solid),
    ///          TRIBO_ERROR_CAPACITY, TRIBO_ERROR_MEMORY.
    pub fn tribo_hull_build(count: usize, points: *const f64, block: *mut c_void, capacity: usize, needed: *mut usize) -> tribo_status;
    /// Judge a block from elsewhere, such as a file, before it is used: whether tribo_hull_build of this
    ///  version made it, on a machine of the same byte order, and no byte of it has changed since.
    ///  Damage shows by a sum over all bytes. A block that was written to deceive may pass, and then is
    ///  some other shape, but no call that is given it leaves it or runs without end. Takes time of the
    ///  order of its size.
    ///  @param size bytes that may be read at `block`; those beyond the block are not looked at
    ///  @return TRIBO_ERROR_NULL, TRIBO_ERROR_DATA (also if it is not aligned to 8, or cut off).
    pub fn tribo_hull_check(block: *const c_void, size: usize) -> tribo_status;
    /// Numbers of vertices and (merged) faces of a hull block; its head alone is judged.
    ///  @return TRIBO_ERROR_NULL, TRIBO_ERROR_DATA.
    pub fn tribo_hull_counts(block: *const c_void, vertices: *mut u32, faces: *mut u32) -> tribo_status;
    /// Static triangle mesh as a flat block: triangles counter-clockwise seen from outside, a tree of
    ///  bounds, and which edges are convex, so that bodies do not trip over inner edges. Neighbours are
    ///  known by the positions of their vertices; they need not share indices.
    ///  @param vertex_count 3 to 2^31
    ///  @param vertices     width 3, m
    ///  @param count        number of triangles, 1 to 2^30; those whose height is below 1e-12 of their
    ///                      longest edge are left out, and keep their numbers
    ///  @param triangles    width 3: vertex indices
    ///  @param block,capacity,needed as in tribo_hull_build
    ///  @return TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE, TRIBO_ERROR_INDEX, TRIBO_ERROR_RANGE,
    ///          TRIBO_ERROR_DEGENERATE (no triangle is left), TRIBO_ERROR_CAPACITY.
    pub fn tribo_mesh_build(vertex_count: usize, vertices: *const f64, count: usize, triangles: *const u32, block: *mut c_void, capacity: usize, needed: *mut usize) -> tribo_status;
    /// Judge a block from elsewhere that is said to be a mesh: as tribo_hull_check.
    pub fn tribo_mesh_check(block: *const c_void, size: usize) -> tribo_status;
    /// Manifolds between shape A at pose A and shape B at pose B. Convex pairs give at most one;
    ///  compounds and meshes one per pair of parts that touch, in the order of their indices.
    ///
    ///  Only relative positions enter, so the result is the same far from the origin as near it.
    ///  Swapping A and B swaps the arms and turns the normal round. Depths are exact to rounding for
    ///  closed forms; general: to 1e-9 of the smaller size. Of nearly concentric pairs, where a great
    ///  many directions are nearly as deep, one in 1000 is given one that is deeper than the least by
    ///  more than 1e-9 of the depth, one in 2500 by more than 1e-6, up to some 4e-3.
    ///
    ///  A gap is told along the normal, so it is never more than the true one. Closed forms but boxes:
    ///  exact to rounding. General: to 2e-9 of the smaller size, and to 1 % of a gap of 1e-8 of that size
    ///  or more; to 1e-8 of it where bodies are a hundred times as long as thick.
    ///  Two boxes in closed form part along a normal of a face or across two edges: where a corner is
    ///  nearest to a corner or an edge, that gap is less than the true one, and only
    ///  TRIBO_METHOD_GENERAL has the direction between the nearest points.
    ///  @param options   may be null
    ///  @param capacity  room in manifolds
    ///  @param manifolds receives the manifolds with at least one point
    ///  @param count     receives their number; with TRIBO_ERROR_CAPACITY the number needed
    ///  @param info      may be null
    ///  @return TRIBO_ERROR_NULL, TRIBO_ERROR_STRUCT_SIZE, TRIBO_ERROR_OPTION, TRIBO_ERROR_NOT_FINITE,
    ///          TRIBO_ERROR_RANGE (margin < 0; lengths so large that they overflow), a status of
    ///          tribo_shape_check, TRIBO_ERROR_ORIENTATION, TRIBO_ERROR_PAIR (two shapes that cannot
    ///          meet: two of HALFSPACE and MESH), TRIBO_ERROR_SUPPORT (a user's support function
    ///          contradicts itself), TRIBO_ERROR_CAPACITY, TRIBO_ERROR_MEMORY.
    pub fn tribo_collide_shapes(shape_a: *const tribo_shape, pose_a: *const tribo_pose, shape_b: *const tribo_shape, pose_b: *const tribo_pose, options: *const tribo_collide_options, capacity: u32, manifolds: *mut tribo_manifold, count: *mut u32, info: *mut tribo_collide_info) -> tribo_status;
    /// Many convex pairs. Pair i is shapes\[pairs\[2i\]\] at poses\[pairs\[2i\]\] and the same for 2i + 1; it
    ///  fills manifolds\[i\] (count 0 if they do not touch) and statuses\[i\]. Pairs do not influence each
    ///  other. Where a status is not TRIBO_OK, that manifold is untouched and all other pairs are still
    ///  done.
    ///  @param statuses may be null
    ///  @param info     may be null; sums over all pairs
    ///  @return the first status that is not TRIBO_OK by order; or with nothing done TRIBO_ERROR_NULL,
    ///          TRIBO_ERROR_STRUCT_SIZE, TRIBO_ERROR_OPTION, or for the margin TRIBO_ERROR_NOT_FINITE,
    ///          TRIBO_ERROR_RANGE. Of a pair also TRIBO_ERROR_INDEX, TRIBO_ERROR_ALIAS (i with i),
    ///          TRIBO_ERROR_PAIR (MESH or COMPOUND).
    pub fn tribo_collide_batch(shape_count: u32, shapes: *const tribo_shape, poses: *const tribo_pose, count: usize, pairs: *const u32, options: *const tribo_collide_options, manifolds: *mut tribo_manifold, statuses: *mut tribo_status, info: *mut tribo_collide_info) -> tribo_status;
    /// Bytes of workspace for tribo_system_solve.
    ///  @param options may be null: defaults
    ///  @return TRIBO_ERROR_NULL, TRIBO_ERROR_STRUCT_SIZE, TRIBO_ERROR_OPTION, TRIBO_ERROR_INDEX,
    ///          TRIBO_ERROR_CAPACITY (more than 2^31 bodies or contacts, or a size beyond size_t).
    pub fn tribo_system_workspace_size(body_count: usize, count: usize, contacts: *const tribo_system_contact, options: *const tribo_system_options, size: *mut usize) -> tribo_status;
    /// Solve a system of bodies and contacts.
    ///  @param body_count bodies; those with zero inverse mass and inertia do not move, any number of
    ///                    them
    ///  @param bodies     body_count bodies, with the velocities before the contacts act (forces of the
    ///                    step added)
    ///  @param count      contacts
    ///  @param contacts   count contacts
    ///  @param options    may be null: defaults
    ///  @param workspace  aligned for double; may be null if its size is 0
    ///  @param size       of the workspace, bytes
    ///  @param impulses   width 3: receives impulses on A, N s; holds the start if warm_start is 1
    ///  @param velocities width 6: receives v, m/s, and omega, rad/s, of each body; may be null
    ///  @param info       may be null
    ///  @return TRIBO_OK whatever the certificate says: see info->stop; TRIBO_ERROR_NULL,
    ///          TRIBO_ERROR_STRUCT_SIZE, TRIBO_ERROR_OPTION, TRIBO_ERROR_ISA, TRIBO_ERROR_INDEX,
    ///          TRIBO_ERROR_ALIAS (A is B), TRIBO_ERROR_CAPACITY (workspace), TRIBO_ERROR_NOT_FINITE, a
    ///          status of tribo_body_check, tribo_material_check, TRIBO_ERROR_FRICTION (a length < 0),
    ///          TRIBO_ERROR_NORMAL, TRIBO_ERROR_IMMOVABLE (neither body of a contact can move along its
    ///          normal), TRIBO_ERROR_RANGE (numbers beyond double), or a status of options->linear.
    pub fn tribo_system_solve(body_count: usize, bodies: *const tribo_body, count: usize, contacts: *const tribo_system_contact, options: *const tribo_system_options, workspace: *mut c_void, size: usize, impulses: *mut f64, velocities: *mut f64, info: *mut tribo_system_info) -> tribo_status;
    /// Bytes of workspace for tribo_system_solve_assembled. Parameters and statuses as there.
    pub fn tribo_system_assembled_workspace_size(count: usize, row_starts: *const u32, columns: *const u32, options: *const tribo_system_options, size: *mut usize) -> tribo_status;
    /// Solve an assembled problem u = W r + q. W need not be symmetric (implicit integrators of
    ///  gyroscopic terms give such ones) nor of full rank; it is solved as it is given.
    ///  @param count      contacts
    ///  @param row_starts count + 1 numbers: blocks row_starts\[i\] to row_starts\[i + 1\] - 1 stand in
    ///                    block row i. Null: W is dense, all count^2 blocks
    ///  @param columns    block columns, ascending in each row; the diagonal block is always there. Null
    ///                    with row_starts
    ///  @param blocks     width 9: 3x3 blocks, each row by row. If row_starts is null, W as one dense
    ///                    matrix of 3 count rows, row by row
    ///  @param q          width 3, m/s
    ///  @param mu         width 2: mu_s, mu_d. mu_s = 0 costs one row
    ///  @param impulses   width 3: receives r; holds the start if warm_start is 1
    ///  @param velocities width 3: receives u = W r + q; may be null
    ///  @return as tribo_system_solve; TRIBO_ERROR_INDEX for a bad row_starts or columns;
    ///          TRIBO_ERROR_FRICTION; TRIBO_ERROR_CONTACT_MATRIX (a diagonal block that is not positive
    ///          semidefinite), TRIBO_ERROR_IMMOVABLE (W_nn = 0 in a diagonal block).
    pub fn tribo_system_solve_assembled(count: usize, row_starts: *const u32, columns: *const u32, blocks: *const f64, q: *const f64, mu: *const f64, options: *const tribo_system_options, workspace: *mut c_void, size: usize, impulses: *mut f64, velocities: *mut f64, info: *mut tribo_system_info) -> tribo_status;
    /// Give the velocities of tribo_system_solve to the bodies.
    ///  @return TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE.
    pub fn tribo_system_apply(body_count: usize, bodies: *mut tribo_body, velocities: *const f64) -> tribo_status;
    /// Make one.
    ///  @param method    TRIBO_SPARSE_...
    ///  @param allocator copied; may be null: malloc and free
    ///  @param sparse    receives the object
    ///  @return TRIBO_ERROR_NULL (sparse, a function of the allocator), TRIBO_ERROR_STRUCT_SIZE,
    ///          TRIBO_ERROR_OPTION, TRIBO_ERROR_MEMORY.
    pub fn tribo_sparse_create(method: u32, allocator: *const tribo_allocator, sparse: *mut *mut tribo_sparse) -> tribo_status;
    /// Free it and all that it holds; null is nothing.
    pub fn tribo_sparse_destroy(sparse: *mut tribo_sparse);
    /// The object as tribo_system_options.linear takes it; it must outlive `linear`.
    ///
    ///  factor: TRIBO_OK; TRIBO_ERROR_CONTACT_MATRIX (singular, not positive definite, or not finite:
    ///  there are no factors then), TRIBO_ERROR_MEMORY, TRIBO_ERROR_NULL, TRIBO_ERROR_CAPACITY (2^31 - 1
    ///  entries or rows, or more), TRIBO_ERROR_INDEX (rows that do not follow each other, columns that
    ///  do not rise or lie outside, or above the diagonal if symmetric). An unsymmetric matrix is solved
    ///  with one step of iterative refinement, which reads the arrays given to factor.
    ///
    ///  solve: TRIBO_OK; TRIBO_ERROR_CONTACT_MATRIX (no factors), TRIBO_ERROR_MEMORY, TRIBO_ERROR_NULL.
    ///
    ///  sign: TRIBO_OK (1 for a symmetric matrix, and for one without rows); otherwise as solve, and
    ///  *sign is left as it is.
    ///
    ///  @param linear struct_size set by the caller; where it ends before `sign`, that is not given
    ///  @return TRIBO_ERROR_NULL, TRIBO_ERROR_STRUCT_SIZE (neither of the two).
    pub fn tribo_sparse_linear(sparse: *mut tribo_sparse, linear: *mut tribo_linear) -> tribo_status;
    /// Tell what it has done.
    ///  @return TRIBO_ERROR_NULL, TRIBO_ERROR_STRUCT_SIZE.
    pub fn tribo_sparse_report(sparse: *const tribo_sparse, info: *mut tribo_sparse_info) -> tribo_status;
    /// Make an empty scene.
    ///  @param settings  may be null: defaults
    ///  @param allocator copied; may be null: malloc and free
    ///  @param scene     receives the scene
    ///  @return TRIBO_ERROR_NULL (scene, a function of the allocator), TRIBO_ERROR_STRUCT_SIZE,
    ///          TRIBO_ERROR_OPTION, TRIBO_ERROR_NOT_FINITE, TRIBO_ERROR_MEMORY.
    pub fn tribo_scene_create(settings: *const tribo_scene_settings, allocator: *const tribo_allocator, scene: *mut *mut tribo_scene) -> tribo_status;
    /// Free it and all that it holds; null is nothing.
    pub fn tribo_scene_destroy(scene: *mut tribo_scene);
    /// A dynamic body without shape or mass, at the origin, at rest; friction and restitution 0.
    ///  @return TRIBO_ERROR_NULL.
    pub fn tribo_scene_body_init(body: *mut tribo_scene_body) -> tribo_status;
    /// Add a body. One that is not dynamic wakes all others, for it may be anywhere.
    ///  @param id receives its number
    ///  @return TRIBO_ERROR_NULL, TRIBO_ERROR_STRUCT_SIZE, TRIBO_ERROR_OPTION (kind), a status of
    ///          tribo_body_check, tribo_material_check or tribo_shape_check, TRIBO_ERROR_MASS (dynamic
    ///          with zero inverse mass, or not dynamic with another), TRIBO_ERROR_INERTIA (not dynamic
    ///          with any, or one that tribo_body_spin refuses), TRIBO_ERROR_SHAPE (HALFSPACE or MESH on
    ///          a dynamic body), TRIBO_ERROR_ORIENTATION (offset), TRIBO_ERROR_NOT_FINITE,
    ///          TRIBO_ERROR_FRICTION (a length < 0), TRIBO_ERROR_RANGE (a static body with velocities),
    ///          TRIBO_ERROR_SUPPORT, TRIBO_ERROR_CAPACITY (2^30 bodies), TRIBO_ERROR_MEMORY.
    pub fn tribo_scene_add(scene: *mut tribo_scene, body: *const tribo_scene_body, id: *mut u32) -> tribo_status;
    /// Remove a body and its contacts; bodies that it touched wake. Its contacts are not told as ended.
    ///  @return TRIBO_ERROR_NULL, TRIBO_ERROR_INDEX.
    pub fn tribo_scene_remove(scene: *mut tribo_scene, id: u32) -> tribo_status;
    /// Number of bodies, and one more than the greatest id in use; each may be null.
    ///  @return TRIBO_ERROR_NULL (scene).
    pub fn tribo_scene_counts(scene: *const tribo_scene, bodies: *mut u32, end: *mut u32) -> tribo_status;
    /// Pose and velocities of a body, at the end of the last step.
    ///  @param asleep receives 1 if it sleeps, else 0; may be null
    ///  @return TRIBO_ERROR_NULL, TRIBO_ERROR_INDEX.
    pub fn tribo_scene_get_body(scene: *const tribo_scene, id: u32, state: *mut tribo_body, asleep: *mut u32) -> tribo_status;
    /// Change pose, velocities or mass of a body. It wakes, and so do those that it touched; if it is
    ///  not dynamic, all do. What it touches is found anew.
    ///  @return TRIBO_ERROR_NULL, TRIBO_ERROR_INDEX, and for the state as in tribo_scene_add.
    pub fn tribo_scene_set_body(scene: *mut tribo_scene, id: u32, state: *const tribo_body) -> tribo_status;
    /// Force (N) at the centre of mass and torque (N m), world axes, that act on a dynamic body from
    ///  now on, until they are set anew. The body wakes if they change.
    ///  @param force,torque may be null: zero
    ///  @return TRIBO_ERROR_NULL (scene), TRIBO_ERROR_INDEX, TRIBO_ERROR_NOT_FINITE, TRIBO_ERROR_MASS
    ///          (not dynamic).
    pub fn tribo_scene_set_force(scene: *mut tribo_scene, id: u32, force: *const f64, torque: *const f64) -> tribo_status;
    /// Change gravity; all bodies wake. @return TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE.
    pub fn tribo_scene_set_gravity(scene: *mut tribo_scene, gravity: *const f64) -> tribo_status;
    /// Momentum about `origin` and kinetic energy of the dynamic bodies.
    ///  @param potential receives -sum m g . (x - origin), J; may be null
    ///  @return TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE.
    pub fn tribo_scene_totals(scene: *const tribo_scene, origin: *const f64, totals: *mut tribo_totals, potential: *mut f64) -> tribo_status;
    /// Advance the scene by dt seconds.
    ///  @param dt      > 0
    ///  @param options may be null: defaults
    ///  @param info    may be null
    ///  @return TRIBO_OK whatever the solvers say: see info->stop; TRIBO_ERROR_NULL,
    ///          TRIBO_ERROR_STRUCT_SIZE, TRIBO_ERROR_OPTION, TRIBO_ERROR_TIME_STEP (dt <= 0, or a body
    ///          turns by more than 1e5 radians), TRIBO_ERROR_NOT_FINITE, TRIBO_ERROR_RANGE (an option,
    ///          or a state beyond double), TRIBO_ERROR_SUPPORT, TRIBO_ERROR_CAPACITY (2^31 contacts),
    ///          TRIBO_ERROR_MEMORY. With any of them the scene is as it was before the call.
    pub fn tribo_scene_step(scene: *mut tribo_scene, dt: f64, options: *const tribo_step_options, info: *mut tribo_step_info) -> tribo_status;
    /// Contact points of the last sub-step, as of its midpoint, sorted by a, b, child_a and child_b.
    ///  @param contacts may be null if capacity is 0
    ///  @param count    receives their number, also with TRIBO_ERROR_CAPACITY
    ///  @return TRIBO_ERROR_NULL, TRIBO_ERROR_CAPACITY.
    pub fn tribo_scene_contacts(scene: *const tribo_scene, capacity: usize, contacts: *mut tribo_scene_contact, count: *mut usize) -> tribo_status;
    /// Events of the last step, sorted by a and b. At rest the impulses on a body sum up to -m g dt, to
    ///  the tolerance of the solver. Bodies asleep tell the impulses of when they went to sleep.
    ///  @return as tribo_scene_contacts.
    pub fn tribo_scene_events(scene: *const tribo_scene, capacity: usize, events: *mut tribo_scene_event, count: *mut usize) -> tribo_status;
    /// Write all of the scene to a block: bodies, contacts, events, settings. It has no pointers but
    ///  those of shapes to their data, and is of the machine's byte order.
    ///  @param block    aligned for double; may be null if capacity is 0
    ///  @param needed   receives the bytes the block needs, also with TRIBO_ERROR_CAPACITY; may be null
    ///  @return TRIBO_ERROR_NULL, TRIBO_ERROR_CAPACITY.
    pub fn tribo_scene_save(scene: *const tribo_scene, block: *mut c_void, capacity: usize, needed: *mut usize) -> tribo_status;
    /// Make the scene what it was when the block was saved, by this scene or another of the same
    ///  process: steps from here on give the same bits as they did from there on.
    ///  @param size bytes that may be read at `block`
    ///  @return TRIBO_ERROR_NULL, TRIBO_ERROR_DATA (not made by this version, cut off, or changed),
    ///          TRIBO_ERROR_MEMORY.
    pub fn tribo_scene_load(scene: *mut tribo_scene, block: *const c_void, size: usize) -> tribo_status;
}
