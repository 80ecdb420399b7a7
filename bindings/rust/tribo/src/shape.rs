//! Shapes, contact manifolds and the broad phase.

use std::any::Any;
use std::fmt;
use std::panic::{catch_unwind, AssertUnwindSafe};
use std::ptr::{null, null_mut};
use std::sync::Arc;

use crate::contact::fits;
use crate::{sized, CollideOptions, Error, Manifold, Pose, Result};
use tribo_sys as sys;

/// A shape. Cheap to clone; it keeps alive what it is made of.
#[derive(Clone)]
pub struct Shape {
    pub(crate) raw: sys::tribo_shape,
    keep: Option<Arc<dyn Any + Send + Sync>>,
}

// SAFETY: `raw.data` points into `keep`, which is immutable, Send and Sync.
unsafe impl Send for Shape {}
// SAFETY: as above.
unsafe impl Sync for Shape {}

impl fmt::Debug for Shape {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Shape {{ kind: {}, size: {:?} }}", self.raw.r#type, self.raw.size)
    }
}

/// The user's own support function: direction to the farthest point along it, in body axes.
pub type Support = dyn Fn(&[f64; 3]) -> [f64; 3] + Send + Sync;

struct Convex {
    raw: sys::tribo_convex,
    support: Box<Support>,
}

// SAFETY: `raw.user` points to this same object, whose function is Send and Sync.
unsafe impl Send for Convex {}
// SAFETY: as above.
unsafe impl Sync for Convex {}

unsafe extern "C" fn call_support(
    user: *const std::ffi::c_void,
    direction: *const f64,
    point: *mut f64,
) {
    // SAFETY: `user` is the Convex that the shape keeps; both arrays have three numbers.
    let (convex, direction) = unsafe { (&*user.cast::<Convex>(), &*direction.cast::<[f64; 3]>()) };
    // A panic must not pass through C: a point that is no number is a status there.
    let out = catch_unwind(AssertUnwindSafe(|| (convex.support)(direction)));
    // SAFETY: as above.
    unsafe { *point.cast::<[f64; 3]>() = out.unwrap_or([f64::NAN; 3]) };
}

impl Shape {
    fn make(kind: u32, size: [f64; 4]) -> Result<Shape> {
        let raw = sys::tribo_shape { r#type: kind, count: 0, size, data: null() };
        Shape { raw, keep: None }.judged()
    }

    fn judged(self) -> Result<Shape> {
        // SAFETY: data, if there is any, is kept.
        Error::of(unsafe { sys::tribo_shape_check(&self.raw) })?;
        Ok(self)
    }

    /// A ball.
    pub fn sphere(radius: f64) -> Result<Shape> {
        Shape::make(sys::TRIBO_SHAPE_SPHERE, [radius, 0.0, 0.0, 0.0])
    }

    /// A box of half-extents.
    pub fn cuboid(hx: f64, hy: f64, hz: f64) -> Result<Shape> {
        Shape::make(sys::TRIBO_SHAPE_BOX, [hx, hy, hz, 0.0])
    }

    /// All within `radius` of the axis z from -half_height to half_height.
    pub fn capsule(radius: f64, half_height: f64) -> Result<Shape> {
        Shape::make(sys::TRIBO_SHAPE_CAPSULE, [radius, half_height, 0.0, 0.0])
    }

    /// Axis z.
    pub fn cylinder(radius: f64, half_height: f64) -> Result<Shape> {
        Shape::make(sys::TRIBO_SHAPE_CYLINDER, [radius, half_height, 0.0, 0.0])
    }

    /// Axis z, apex up.
    pub fn cone(radius: f64, half_height: f64) -> Result<Shape> {
        Shape::make(sys::TRIBO_SHAPE_CONE, [radius, half_height, 0.0, 0.0])
    }

    /// Semi-axes.
    pub fn ellipsoid(a: f64, b: f64, c: f64) -> Result<Shape> {
        Shape::make(sys::TRIBO_SHAPE_ELLIPSOID, [a, b, c, 0.0])
    }

    /// All x with normal . x <= d.
    pub fn halfspace(normal: &[f64; 3], d: f64) -> Result<Shape> {
        Shape::make(sys::TRIBO_SHAPE_HALFSPACE, [normal[0], normal[1], normal[2], d])
    }

    fn of_block(
        kind: u32,
        build: impl Fn(*mut std::ffi::c_void, usize, *mut usize) -> i32,
    ) -> Result<Shape> {
        let mut needed = 0;
        let status = build(null_mut(), 0, &mut needed);
        if status != sys::TRIBO_ERROR_CAPACITY {
            Error::of(status)?;
        }
        let mut block = vec![0_u64; needed.div_ceil(8)];
        Error::of(build(block.as_mut_ptr().cast(), 8 * block.len(), &mut needed))?;
        let block: Arc<Vec<u64>> = Arc::new(block);
        let data = block.as_ptr().cast();
        let raw = sys::tribo_shape { r#type: kind, count: 0, size: [0.0; 4], data };
        Shape { raw, keep: Some(block) }.judged()
    }

    /// Convex hull of points.
    pub fn hull(points: &[[f64; 3]]) -> Result<Shape> {
        Shape::of_block(sys::TRIBO_SHAPE_HULL, |block, capacity, needed| {
            // SAFETY: lengths are those of the slices.
            unsafe {
                let data = points.as_ptr().cast();
                sys::tribo_hull_build(points.len(), data, block, capacity, needed)
            }
        })
    }

    /// Static triangle mesh.
    pub fn mesh(vertices: &[[f64; 3]], triangles: &[[u32; 3]]) -> Result<Shape> {
        Shape::of_block(sys::TRIBO_SHAPE_MESH, |block, capacity, needed| {
            let (v, t) = (vertices.as_ptr().cast(), triangles.as_ptr().cast());
            let (m, n) = (vertices.len(), triangles.len());
            // SAFETY: lengths are those of the slices.
            unsafe { sys::tribo_mesh_build(m, v, n, t, block, capacity, needed) }
        })
    }

    /// Convex parts at poses.
    pub fn compound(children: &[(Shape, Pose)]) -> Result<Shape> {
        struct Parts(Vec<sys::tribo_child>, #[allow(dead_code)] Vec<Shape>);
        // SAFETY: what the parts point to is kept beside them, and immutable.
        unsafe impl Send for Parts {}
        // SAFETY: as above.
        unsafe impl Sync for Parts {}

        let parts = Arc::new(Parts(
            children.iter().map(|(s, p)| sys::tribo_child { shape: s.raw, pose: *p }).collect(),
            children.iter().map(|(s, _)| s.clone()).collect(),
        ));
        let count = u32::try_from(children.len()).map_err(|_| Error::CAPACITY)?;
        let data = parts.0.as_ptr().cast();
        let kind = sys::TRIBO_SHAPE_COMPOUND;
        let raw = sys::tribo_shape { r#type: kind, count, size: [0.0; 4], data };
        Shape { raw, keep: Some(parts) }.judged()
    }

    /// A convex shape by a support function. `center`: a point well inside; `radius`: of a ball
    /// around it that holds the shape. A function that panics makes calls fail with
    /// [`Error::SUPPORT`].
    pub fn convex(support: Box<Support>, center: [f64; 3], radius: f64) -> Result<Shape> {
        let raw = sys::tribo_convex {
            support: Some(call_support),
            center,
            radius,
            ..sized!(sys::tribo_convex)
        };
        let mut convex = Arc::new(Convex { raw, support });
        let user = Arc::as_ptr(&convex).cast();
        Arc::get_mut(&mut convex).expect("not shared yet").raw.user = user;
        let data = (&convex.raw as *const sys::tribo_convex).cast();
        let kind = sys::TRIBO_SHAPE_CONVEX;
        let raw = sys::tribo_shape { r#type: kind, count: 0, size: [0.0; 4], data };
        Shape { raw, keep: Some(convex) }.judged()
    }

    /// The farthest point along a direction.
    pub fn support(&self, direction: &[f64; 3]) -> Result<[f64; 3]> {
        let mut out = [0.0; 3];
        // SAFETY: both are of the length that C asks for.
        Error::of(unsafe {
            sys::tribo_shape_support(&self.raw, direction.as_ptr(), out.as_mut_ptr())
        })?;
        Ok(out)
    }

    /// Least and greatest corner of the axis-aligned bounds at a pose.
    pub fn bounds(&self, pose: &Pose) -> Result<([f64; 3], [f64; 3])> {
        let (mut low, mut high) = ([0.0; 3], [0.0; 3]);
        // SAFETY: all are of the length that C asks for.
        Error::of(unsafe {
            sys::tribo_shape_bounds(&self.raw, pose, low.as_mut_ptr(), high.as_mut_ptr())
        })?;
        Ok((low, high))
    }

    /// Mass, centre of mass and inertia about it of a uniform solid.
    pub fn mass(&self, density: f64) -> Result<(f64, [f64; 3], [f64; 9])> {
        let (mut mass, mut center, mut inertia) = (0.0, [0.0; 3], [0.0; 9]);
        let (c, i) = (center.as_mut_ptr(), inertia.as_mut_ptr());
        // SAFETY: all are of the length that C asks for.
        Error::of(unsafe { sys::tribo_shape_mass(&self.raw, density, &mut mass, c, i) })?;
        Ok((mass, center, inertia))
    }

    pub(crate) fn keep(&self) -> Option<Arc<dyn Any + Send + Sync>> {
        self.keep.clone()
    }
}

/// A pose: position and orientation (w, x, y, z).
pub fn pose(position: [f64; 3], orientation: [f64; 4]) -> Pose {
    Pose { position, orientation }
}

/// Contact manifolds between two shapes at poses.
///
/// ```
/// use tribo::{pose, touch, Shape};
/// let cube = Shape::cuboid(0.5, 0.5, 0.5)?;
/// let (low, high) = (pose([0.0; 3], [1.0, 0.0, 0.0, 0.0]), pose([0.0, 0.0, 0.99], [1.0, 0.0, 0.0, 0.0]));
/// let manifolds = touch(&cube, &high, &cube, &low, Default::default())?;
/// assert_eq!((manifolds.len(), manifolds[0].count, manifolds[0].normal), (1, 4, [0.0, 0.0, 1.0]));
/// # Ok::<(), tribo::Error>(())
/// ```
pub fn touch(
    a: &Shape,
    pose_a: &Pose,
    b: &Shape,
    pose_b: &Pose,
    options: CollideOptions,
) -> Result<Vec<Manifold>> {
    let options = sized!(CollideOptions, options);
    let mut out = vec![Manifold::default(); 4];
    loop {
        let mut count = 0;
        // SAFETY: the capacity is that of the vector.
        let status = unsafe {
            sys::tribo_collide_shapes(
                &a.raw,
                pose_a,
                &b.raw,
                pose_b,
                &options,
                out.len() as u32,
                out.as_mut_ptr(),
                &mut count,
                null_mut(),
            )
        };
        out.resize(count as usize, Manifold::default());
        if status != sys::TRIBO_ERROR_CAPACITY {
            Error::of(status)?;
            return Ok(out);
        }
    }
}

/// One manifold for each pair of indices.
pub fn touch_batch(
    shapes: &[Shape],
    poses: &[Pose],
    pairs: &[[u32; 2]],
    options: CollideOptions,
    statuses: Option<&mut [i32]>,
) -> Result<Vec<Manifold>> {
    fits(shapes.len() == poses.len())?;
    fits(statuses.as_ref().map_or(true, |s| s.len() == pairs.len()))?;
    let raw: Vec<_> = shapes.iter().map(|s| s.raw).collect();
    let options = sized!(CollideOptions, options);
    let mut out = vec![Manifold::default(); pairs.len()];
    // SAFETY: lengths were judged.
    Error::of(unsafe {
        sys::tribo_collide_batch(
            u32::try_from(raw.len()).map_err(|_| Error::CAPACITY)?,
            raw.as_ptr(),
            poses.as_ptr(),
            pairs.len(),
            pairs.as_ptr().cast(),
            &options,
            out.as_mut_ptr(),
            statuses.map_or(null_mut(), |s| s.as_mut_ptr()),
            null_mut(),
        )
    })?;
    Ok(out)
}

/// A list whose length C tells: asked for with no room, then with enough.
pub(crate) fn list<T: Clone + Default>(
    fill: impl Fn(usize, *mut T, &mut usize) -> i32,
) -> Result<Vec<T>> {
    let mut count = 0;
    let mut out = Vec::new();
    let mut status = fill(0, null_mut(), &mut count);
    if status == sys::TRIBO_ERROR_CAPACITY {
        out = vec![T::default(); count];
        status = fill(count, out.as_mut_ptr(), &mut count);
    }
    Error::of(status)?;
    Ok(out)
}

/// Which of many axis-aligned boxes overlap: a dynamic tree.
pub struct Tree {
    block: Vec<u64>,
}

impl Tree {
    /// A tree of up to `capacity` boxes, which it stores larger by `margin`.
    pub fn new(capacity: u32, margin: f64) -> Result<Tree> {
        // SAFETY: no pointers.
        let size = unsafe { sys::tribo_tree_size(capacity) };
        let mut block = vec![0_u64; size.div_ceil(8)];
        let mut tree = null_mut();
        // SAFETY: the block has the size that C asks for; for a bad capacity C does not touch it.
        Error::of(unsafe {
            sys::tribo_tree_init(block.as_mut_ptr().cast(), capacity, margin, &mut tree)
        })?;
        Ok(Tree { block })
    }

    // The tree is the block itself, and has no pointers: the block may move.
    fn raw(&self) -> *const sys::tribo_tree {
        self.block.as_ptr().cast()
    }

    fn raw_mut(&mut self) -> *mut sys::tribo_tree {
        self.block.as_mut_ptr().cast()
    }

    /// Add a box; gives its id.
    pub fn add(&mut self, low: &[f64; 3], high: &[f64; 3]) -> Result<u32> {
        let mut id = 0;
        // SAFETY: a tree of this object, alone.
        Error::of(unsafe {
            sys::tribo_tree_add(self.raw_mut(), low.as_ptr(), high.as_ptr(), &mut id)
        })?;
        Ok(id)
    }

    /// Move a box.
    pub fn move_to(&mut self, id: u32, low: &[f64; 3], high: &[f64; 3]) -> Result<()> {
        // SAFETY: as in add.
        Error::of(unsafe { sys::tribo_tree_move(self.raw_mut(), id, low.as_ptr(), high.as_ptr()) })
    }

    /// Remove a box.
    pub fn remove(&mut self, id: u32) -> Result<()> {
        // SAFETY: as in add.
        Error::of(unsafe { sys::tribo_tree_remove(self.raw_mut(), id) })
    }

    /// Overlapping pairs of ids, sorted.
    pub fn pairs(&self) -> Result<Vec<[u32; 2]>> {
        // SAFETY: the capacity is that of the vector.
        list(|n, out: *mut [u32; 2], count| unsafe {
            sys::tribo_tree_pairs(self.raw(), n, out.cast(), count)
        })
    }

    /// Ids of boxes that overlap a box, sorted.
    pub fn query_box(&self, low: &[f64; 3], high: &[f64; 3]) -> Result<Vec<u32>> {
        // SAFETY: the capacity is that of the vector.
        list(|n, out, count| unsafe {
            sys::tribo_tree_query_box(self.raw(), low.as_ptr(), high.as_ptr(), n, out, count)
        })
    }

    /// Ids of boxes that a segment meets, sorted.
    pub fn query_ray(&self, from: &[f64; 3], to: &[f64; 3]) -> Result<Vec<u32>> {
        // SAFETY: the capacity is that of the vector.
        list(|n, out, count| unsafe {
            sys::tribo_tree_query_ray(self.raw(), from.as_ptr(), to.as_ptr(), n, out, count)
        })
    }
}
