//! One contact, and many that do not influence each other.

use std::ffi::CString;
use std::ptr::null_mut;

use crate::{
    sized, Body, CollisionInfo, Contact, Error, ImpactInfo, ImpactOptions, Isa, Material, Measures,
    Result, SolveInfo, Totals,
};
use tribo_sys as sys;

/// An immovable body at the origin.
pub fn fixed_body() -> Body {
    let mut body = Body::default();
    body.orientation[0] = 1.0;
    body
}

/// A body at the origin, at rest, of a mass (kg) and an inertia tensor (kg m², body axes).
pub fn body_of(mass: f64, inertia: &[f64; 9]) -> Result<Body> {
    let mut body = fixed_body();
    // SAFETY: both are of the length that C asks for.
    Error::of(unsafe { sys::tribo_body_set_mass(&mut body, mass, inertia.as_ptr()) })?;
    Ok(body)
}

/// Judge every field of a body.
pub fn check_body(body: &Body) -> Result<()> {
    // SAFETY: a struct that is only read.
    Error::of(unsafe { sys::tribo_body_check(body) })
}

/// Free flight of a body by dt seconds.
pub fn advance(body: &mut Body, acceleration: &[f64; 3], dt: f64) -> Result<()> {
    // SAFETY: both are of the length that C asks for.
    Error::of(unsafe { sys::tribo_body_advance(body, acceleration.as_ptr(), dt) })
}

/// Add an impulse (N s, world axes) at an arm from the centre of mass.
pub fn apply_impulse(body: &mut Body, arm: &[f64; 3], impulse: &[f64; 3]) -> Result<()> {
    // SAFETY: all are of the length that C asks for.
    Error::of(unsafe { sys::tribo_body_apply_impulse(body, arm.as_ptr(), impulse.as_ptr()) })
}

/// Momentum about `origin` and kinetic energy of bodies.
pub fn totals(bodies: &[Body], origin: &[f64; 3]) -> Result<Totals> {
    let mut out = Totals::default();
    // SAFETY: pointer and length are of one slice.
    Error::of(unsafe {
        sys::tribo_audit_bodies(bodies.len(), bodies.as_ptr(), origin.as_ptr(), &mut out)
    })?;
    Ok(out)
}

/// The pair of two surfaces; rules are `TRIBO_MIX_...` of [`crate::sys`].
pub fn mix(a: &Material, b: &Material, friction: u32, restitution: u32) -> Result<Material> {
    let mut out = Material::default();
    // SAFETY: structs of C.
    Error::of(unsafe { sys::tribo_material_mix(a, b, friction, restitution, &mut out) })?;
    Ok(out)
}

/// Entry of the table of pairs, such as "wood on stone".
pub fn material(name: &str) -> Result<Material> {
    let name = CString::new(name).map_err(|_| Error::NAME)?;
    let mut out = Material::default();
    // SAFETY: a string that ends in 0.
    Error::of(unsafe { sys::tribo_material_find(name.as_ptr(), &mut out) })?;
    Ok(out)
}

/// Rotation by |v| radians about v, as a quaternion (w, x, y, z).
pub fn rotation(v: &[f64; 3]) -> Result<[f64; 4]> {
    let mut out = [0.0; 4];
    // SAFETY: both are of the length that C asks for.
    Error::of(unsafe { sys::tribo_quat_from_rotation_vector(v.as_ptr(), out.as_mut_ptr()) })?;
    Ok(out)
}

/// v / |v|.
pub fn normalize(v: &[f64; 3]) -> Result<[f64; 3]> {
    let mut out = [0.0; 3];
    // SAFETY: both are of the length that C asks for.
    Error::of(unsafe { sys::tribo_vec3_normalize(v.as_ptr(), out.as_mut_ptr()) })?;
    Ok(out)
}

/// Exact Signorini-Coulomb solve of one contact, v = W p + b: the impulse.
///
/// ```
/// let p = tribo::solve(&[1.0, 0.0, 0.0, 3.5, 0.0, 3.5], &[-1.5, 3.0, -4.0], 0.5, 0.5)?;
/// assert!((p[0] - 1.5).abs() < 1e-15 && (p[1] + 0.45).abs() < 1e-15);
/// # Ok::<(), tribo::Error>(())
/// ```
#[inline]
pub fn solve(w: &[f64; 6], b: &[f64; 3], mu_s: f64, mu_d: f64) -> Result<[f64; 3]> {
    let mut p = [0.0; 3];
    // SAFETY: all are of the length that C asks for.
    Error::of(unsafe {
        sys::tribo_contact_solve(w.as_ptr(), b.as_ptr(), mu_s, mu_d, p.as_mut_ptr(), null_mut())
    })?;
    Ok(p)
}

/// The same, with what the solve did.
pub fn solve_info(w: &[f64; 6], b: &[f64; 3], mu_s: f64, mu_d: f64) -> Result<([f64; 3], SolveInfo)> {
    let mut p = [0.0; 3];
    let mut info = sized!(SolveInfo);
    // SAFETY: all are of the length that C asks for.
    Error::of(unsafe {
        sys::tribo_contact_solve(w.as_ptr(), b.as_ptr(), mu_s, mu_d, p.as_mut_ptr(), &mut info)
    })?;
    Ok((p, info))
}

/// The same for any W, symmetric or not, row by row.
pub fn solve_general(
    w: &[f64; 9],
    b: &[f64; 3],
    mu_s: f64,
    mu_d: f64,
) -> Result<([f64; 3], SolveInfo)> {
    let mut p = [0.0; 3];
    let mut info = sized!(SolveInfo);
    let (w, b) = (w.as_ptr(), b.as_ptr());
    // SAFETY: all are of the length that C asks for.
    Error::of(unsafe {
        sys::tribo_contact_solve_general(w, b, mu_s, mu_d, p.as_mut_ptr(), &mut info)
    })?;
    Ok((p, info))
}

/// Impulse of an impact with relative velocity u = (n, t1, t2), by the law of the options.
pub fn impact(
    w: &[f64; 6],
    u: &[f64; 3],
    pair: &Material,
    options: ImpactOptions,
) -> Result<([f64; 3], ImpactInfo)> {
    let mut p = [0.0; 3];
    let mut info = sized!(ImpactInfo);
    let options = sized!(ImpactOptions, options);
    // SAFETY: all are of the length that C asks for.
    Error::of(unsafe {
        sys::tribo_impact(w.as_ptr(), u.as_ptr(), pair, &options, p.as_mut_ptr(), &mut info)
    })?;
    Ok((p, info))
}

/// A whole collision of two bodies; `b` is None for the world.
///
/// ```
/// let (mass, _, inertia) = tribo::Shape::sphere(0.5)?.mass(3.8197186342054885)?;
/// let mut ball = tribo::body_of(mass, &inertia)?;
/// ball.velocity = [10.0, 0.0, -2.0];
/// ball.angular_velocity = [0.0, -8.0, 0.0];
/// let pair = tribo::Material { mu_s: 0.3, mu_d: 0.3, e: 0.5, ..Default::default() };
/// let normal = [0.0, 0.0, 1.0];
/// tribo::collide(&mut ball, None, &[0.0, 0.0, -0.5], &normal, &pair, Default::default())?;
/// assert!((ball.velocity[0] - 9.1).abs() < 1e-14);
/// # Ok::<(), tribo::Error>(())
/// ```
pub fn collide(
    a: &mut Body,
    b: Option<&mut Body>,
    point: &[f64; 3],
    normal: &[f64; 3],
    pair: &Material,
    options: ImpactOptions,
) -> Result<CollisionInfo> {
    let mut info = sized!(CollisionInfo);
    let options = sized!(ImpactOptions, options);
    let b = b.map_or(null_mut(), |b| b as *mut Body);
    // SAFETY: a and b are exclusive, so they are not the same body.
    Error::of(unsafe {
        sys::tribo_collide(a, b, point.as_ptr(), normal.as_ptr(), pair, &options, &mut info)
    })?;
    Ok(info)
}

// ---- batches ------------------------------------------------------------------------------------

/// Length of all slices of a batch, if they agree.
pub(crate) fn fits(is_right: bool) -> Result<()> {
    if is_right {
        Ok(())
    } else {
        Err(Error::CAPACITY)
    }
}

/// Exact solve of `p.len()` contacts. `statuses` receives an outcome for each contact; the first
/// error is returned. Slices of different lengths are [`Error::CAPACITY`].
pub fn batch_solve(
    isa: Isa,
    w: &[[f64; 6]],
    b: &[[f64; 3]],
    mu: &[[f64; 2]],
    p: &mut [[f64; 3]],
    modes: Option<&mut [u32]>,
    statuses: Option<&mut [i32]>,
) -> Result<()> {
    let n = p.len();
    fits(w.len() == n && b.len() == n && mu.len() == n)?;
    fits(modes.as_ref().map_or(true, |m| m.len() == n))?;
    fits(statuses.as_ref().map_or(true, |s| s.len() == n))?;
    // SAFETY: lengths were judged; arrays of arrays are flat.
    Error::of(unsafe {
        sys::tribo_batch_solve(
            isa as u32,
            n,
            w.as_ptr().cast(),
            b.as_ptr().cast(),
            mu.as_ptr().cast(),
            p.as_mut_ptr().cast(),
            modes.map_or(null_mut(), |m| m.as_mut_ptr()),
            statuses.map_or(null_mut(), |s| s.as_mut_ptr()),
        )
    })
}

/// ALGEBRAIC impacts of `p.len()` contacts; see [`batch_solve`].
pub fn batch_impact(
    isa: Isa,
    w: &[[f64; 6]],
    u: &[[f64; 3]],
    pairs: &[Material],
    p: &mut [[f64; 3]],
    modes: Option<&mut [u32]>,
    statuses: Option<&mut [i32]>,
) -> Result<()> {
    let n = p.len();
    fits(w.len() == n && u.len() == n && pairs.len() == n)?;
    fits(modes.as_ref().map_or(true, |m| m.len() == n))?;
    fits(statuses.as_ref().map_or(true, |s| s.len() == n))?;
    // SAFETY: lengths were judged; arrays of arrays are flat.
    Error::of(unsafe {
        sys::tribo_batch_impact(
            isa as u32,
            n,
            w.as_ptr().cast(),
            u.as_ptr().cast(),
            pairs.as_ptr(),
            p.as_mut_ptr().cast(),
            modes.map_or(null_mut(), |m| m.as_mut_ptr()),
            statuses.map_or(null_mut(), |s| s.as_mut_ptr()),
        )
    })
}

/// Frames and contact matrices of `w.len()` contacts; see [`batch_solve`]. pairs: indices of A and
/// B, or [`crate::WORLD`].
pub fn batch_matrix(
    isa: Isa,
    bodies: &[Body],
    pairs: &[[u32; 2]],
    contacts: &[Contact],
    frames: Option<&mut [[f64; 9]]>,
    w: &mut [[f64; 6]],
    statuses: Option<&mut [i32]>,
) -> Result<()> {
    let n = w.len();
    fits(pairs.len() == n && contacts.len() == n)?;
    fits(frames.as_ref().map_or(true, |f| f.len() == n))?;
    fits(statuses.as_ref().map_or(true, |s| s.len() == n))?;
    // SAFETY: lengths were judged; arrays of arrays are flat.
    Error::of(unsafe {
        sys::tribo_batch_matrix(
            isa as u32,
            bodies.len(),
            bodies.as_ptr(),
            n,
            pairs.as_ptr().cast(),
            contacts.as_ptr(),
            frames.map_or(null_mut(), |f| f.as_mut_ptr().cast()),
            w.as_mut_ptr().cast(),
            statuses.map_or(null_mut(), |s| s.as_mut_ptr()),
        )
    })
}

/// Greatest and root-mean-square measures of how far impulses are from Coulomb's law.
pub fn audit(
    w: &[[f64; 6]],
    b: &[[f64; 3]],
    mu: &[f64],
    p: &[[f64; 3]],
) -> Result<(Measures, Measures)> {
    let n = p.len();
    let (mut most, mut rms) = (Measures::default(), Measures::default());
    fits(w.len() == n && b.len() == n && mu.len() == n)?;
    // SAFETY: lengths were judged; arrays of arrays are flat.
    Error::of(unsafe {
        sys::tribo_audit_contacts(
            n,
            w.as_ptr().cast(),
            b.as_ptr().cast(),
            mu.as_ptr(),
            p.as_ptr().cast(),
            &mut most,
            &mut rms,
        )
    })?;
    Ok((most, rms))
}

/// The point of the friction cone nearest to p.
pub fn cone_project(p: &[f64; 3], mu: f64) -> Result<[f64; 3]> {
    let mut out = [0.0; 3];
    // SAFETY: both are of the length that C asks for.
    Error::of(unsafe { sys::tribo_cone_project(p.as_ptr(), mu, out.as_mut_ptr()) })?;
    Ok(out)
}
