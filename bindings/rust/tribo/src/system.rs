//! Many contacts coupled through their bodies.

use std::ptr::null_mut;

use crate::contact::fits;
use crate::{sized, Body, Error, Result, SparseInfo, SystemContact, SystemInfo, SystemOptions};
use tribo_sys as sys;

/// Solves systems; keeps workspace, factorisations and results.
///
/// ```
/// let (mass, _, inertia) = tribo::Shape::cuboid(0.5, 0.5, 0.5)?.mass(1000.0)?;
/// let mut bodies = [tribo::body_of(mass, &inertia)?];
/// bodies[0].velocity[2] = -0.1;
/// let corner = |x, y| {
///     let mut c = tribo::SystemContact { b: tribo::WORLD, dimension: 3, ..Default::default() };
///     c.contact.normal = [0.0, 0.0, 1.0];
///     c.contact.arm_a = [x, y, -0.5];
///     c
/// };
/// let contacts = [corner(-0.5, -0.5), corner(0.5, -0.5), corner(-0.5, 0.5), corner(0.5, 0.5)];
/// let mut system = tribo::System::new()?;
/// system.solve(&bodies, &contacts, Default::default())?;
/// system.apply(&mut bodies)?;
/// assert!(bodies[0].velocity[2].abs() < 1e-12);
/// # Ok::<(), tribo::Error>(())
/// ```
pub struct System {
    sparse: *mut sys::tribo_sparse,
    workspace: Vec<u64>,
    /// Impulses on A of the last solve, contact coordinates, N s.
    pub impulses: Vec<[f64; 3]>,
    /// Torques on A of contacts that resist rolling or spinning, N m s.
    pub torques: Vec<[f64; 3]>,
    /// Velocities of the bodies after the last solve; 3 and 3 numbers.
    pub velocities: Vec<[f64; 6]>,
    /// Certificate of the last solve.
    pub info: SystemInfo,
}

// SAFETY: the object is C's alone and bound to no thread.
unsafe impl Send for System {}

impl System {
    /// An empty one.
    pub fn new() -> Result<System> {
        let mut sparse = null_mut();
        // SAFETY: the allocator is the default.
        Error::of(unsafe {
            sys::tribo_sparse_create(sys::TRIBO_SPARSE_AUTO, std::ptr::null(), &mut sparse)
        })?;
        Ok(System {
            sparse,
            workspace: Vec::new(),
            impulses: Vec::new(),
            torques: Vec::new(),
            velocities: Vec::new(),
            info: SystemInfo::default(),
        })
    }

    /// Solve for bodies and contacts; results stay in this object. `options.warm_start = 1` starts
    /// from `impulses` and `torques`; their number must fit ([`Error::CAPACITY`]). Callbacks and
    /// pointers of the options are not used.
    pub fn solve(
        &mut self,
        bodies: &[Body],
        contacts: &[SystemContact],
        options: SystemOptions,
    ) -> Result<&SystemInfo> {
        let n = contacts.len();
        let is_warm = options.warm_start != 0;
        fits(!is_warm || (self.impulses.len() == n && self.torques.len() == n))?;
        let mut impulses = if is_warm { self.impulses.clone() } else { vec![[0.0; 3]; n] };
        let mut torques = if is_warm { self.torques.clone() } else { vec![[0.0; 3]; n] };
        let mut velocities = vec![[0.0; 6]; bodies.len()];
        let mut linear = sized!(sys::tribo_linear);
        // SAFETY: the sparse object outlives the call.
        Error::of(unsafe { sys::tribo_sparse_linear(self.sparse, &mut linear) })?;
        let options = SystemOptions {
            linear: &linear,
            torques: torques.as_mut_ptr().cast(),
            progress: None,
            parallel: None,
            clock: None,
            user: null_mut(),
            ..sized!(SystemOptions, options)
        };
        let mut info = sized!(SystemInfo);
        let mut size = 0;
        // SAFETY: lengths are those of the slices.
        Error::of(unsafe {
            sys::tribo_system_workspace_size(bodies.len(), n, contacts.as_ptr(), &options, &mut size)
        })?;
        self.workspace.resize(self.workspace.len().max(size.div_ceil(8)), 0);
        // SAFETY: lengths are those of the slices and vectors.
        Error::of(unsafe {
            sys::tribo_system_solve(
                bodies.len(),
                bodies.as_ptr(),
                n,
                contacts.as_ptr(),
                &options,
                self.workspace.as_mut_ptr().cast(),
                8 * self.workspace.len(),
                impulses.as_mut_ptr().cast(),
                velocities.as_mut_ptr().cast(),
                &mut info,
            )
        })?;
        (self.impulses, self.torques) = (impulses, torques);
        (self.velocities, self.info) = (velocities, info);
        Ok(&self.info)
    }

    /// Solve u = W r + q with a dense W, row by row; `impulses` receives r. mu: mu_s, mu_d.
    pub fn solve_dense(
        &mut self,
        w: &[f64],
        q: &[[f64; 3]],
        mu: &[[f64; 2]],
        options: SystemOptions,
    ) -> Result<&SystemInfo> {
        let n = q.len();
        fits(mu.len() == n && w.len() == 9 * n * n)?;
        self.solve_blocks_raw(None, w, q, mu, options)
    }

    /// The same with W by 3x3 blocks: blocks `row_starts[i]` to `row_starts[i + 1] - 1` stand in row
    /// i, at `columns`.
    pub fn solve_blocks(
        &mut self,
        row_starts: &[u32],
        columns: &[u32],
        blocks: &[[f64; 9]],
        q: &[[f64; 3]],
        mu: &[[f64; 2]],
        options: SystemOptions,
    ) -> Result<&SystemInfo> {
        let n = q.len();
        fits(mu.len() == n && row_starts.len() == n + 1 && columns.len() == blocks.len())?;
        fits(row_starts[n] as usize == columns.len())?;
        // SAFETY: an array of arrays is flat.
        let flat =
            unsafe { std::slice::from_raw_parts(blocks.as_ptr().cast::<f64>(), 9 * blocks.len()) };
        self.solve_blocks_raw(Some((row_starts, columns)), flat, q, mu, options)
    }

    fn solve_blocks_raw(
        &mut self,
        rows: Option<(&[u32], &[u32])>,
        blocks: &[f64],
        q: &[[f64; 3]],
        mu: &[[f64; 2]],
        options: SystemOptions,
    ) -> Result<&SystemInfo> {
        let n = q.len();
        let is_warm = options.warm_start != 0;
        fits(!is_warm || self.impulses.len() == n)?;
        let mut impulses = if is_warm { self.impulses.clone() } else { vec![[0.0; 3]; n] };
        let mut linear = sized!(sys::tribo_linear);
        // SAFETY: the sparse object outlives the call.
        Error::of(unsafe { sys::tribo_sparse_linear(self.sparse, &mut linear) })?;
        let options = SystemOptions {
            linear: &linear,
            torques: null_mut(),
            progress: None,
            parallel: None,
            clock: None,
            user: null_mut(),
            ..sized!(SystemOptions, options)
        };
        let (starts, columns) = rows.map_or((std::ptr::null(), std::ptr::null()), |(s, c)| {
            (s.as_ptr(), c.as_ptr())
        });
        let mut info = sized!(SystemInfo);
        let mut size = 0;
        // SAFETY: lengths were judged; C judges what the rows say.
        Error::of(unsafe {
            sys::tribo_system_assembled_workspace_size(n, starts, columns, &options, &mut size)
        })?;
        self.workspace.resize(self.workspace.len().max(size.div_ceil(8)), 0);
        // SAFETY: as above.
        Error::of(unsafe {
            sys::tribo_system_solve_assembled(
                n,
                starts,
                columns,
                blocks.as_ptr(),
                q.as_ptr().cast(),
                mu.as_ptr().cast(),
                &options,
                self.workspace.as_mut_ptr().cast(),
                8 * self.workspace.len(),
                impulses.as_mut_ptr().cast(),
                null_mut(),
                &mut info,
            )
        })?;
        self.torques = vec![[0.0; 3]; n];
        (self.impulses, self.velocities, self.info) = (impulses, Vec::new(), info);
        Ok(&self.info)
    }

    /// Give the velocities of the last [`System::solve`] to the bodies.
    pub fn apply(&self, bodies: &mut [Body]) -> Result<()> {
        fits(self.velocities.len() == bodies.len())?;
        let velocities = self.velocities.as_ptr().cast();
        // SAFETY: lengths were judged.
        Error::of(unsafe { sys::tribo_system_apply(bodies.len(), bodies.as_mut_ptr(), velocities) })
    }

    /// What the factorisations did.
    pub fn report(&self) -> Result<SparseInfo> {
        let mut info = sized!(SparseInfo);
        // SAFETY: an object of this one.
        Error::of(unsafe { sys::tribo_sparse_report(self.sparse, &mut info) })?;
        Ok(info)
    }
}

impl Drop for System {
    fn drop(&mut self) {
        // SAFETY: made by create, and destroyed once.
        unsafe { sys::tribo_sparse_destroy(self.sparse) };
    }
}
