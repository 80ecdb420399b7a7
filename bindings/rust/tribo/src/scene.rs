//! Bodies with shapes that step through time.

use std::any::Any;
use std::collections::HashMap;
use std::ffi::c_void;
use std::ptr::{null, null_mut};
use std::sync::Arc;

use crate::shape::list;
use crate::{
    sized, Body, Error, Material, Result, SceneContact, SceneEvent, SceneSettings, Shape, StepInfo,
    StepOptions, Totals,
};
use tribo_sys as sys;

/// What moves a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
#[repr(u32)]
pub enum Kind {
    /// Forces and contacts; it has a mass.
    #[default]
    Dynamic = sys::TRIBO_BODY_DYNAMIC,
    /// Its own velocities, which nothing changes.
    Kinematic = sys::TRIBO_BODY_KINEMATIC,
    /// Nothing.
    Static = sys::TRIBO_BODY_STATIC,
}

/// A body to add to a scene.
#[derive(Clone, Debug)]
pub struct SceneBody {
    /// What moves it.
    pub kind: Kind,
    /// Mass, pose and velocities.
    pub state: Body,
    /// None touches nothing.
    pub shape: Option<Shape>,
    /// Place of the shape in the body's axes.
    pub offset: crate::Pose,
    /// Mixed with that of what it touches.
    pub material: Material,
    /// Velocity of the surface past the body, m/s, body axes.
    pub belt: [f64; 3],
    /// Rolling resistance, m; of a pair the greater counts.
    pub rolling: f64,
    /// Spinning resistance, m; of a pair the greater counts.
    pub spinning: f64,
}

impl SceneBody {
    /// An immovable body of a shape, at the origin.
    pub fn fixed(shape: Shape, material: Material) -> SceneBody {
        SceneBody {
            kind: Kind::Static,
            state: crate::fixed_body(),
            shape: Some(shape),
            offset: crate::pose([0.0; 3], [1.0, 0.0, 0.0, 0.0]),
            material,
            belt: [0.0; 3],
            rolling: 0.0,
            spinning: 0.0,
        }
    }

    /// A uniform solid of a shape, its centre of mass at the origin, at rest.
    pub fn solid(shape: Shape, density: f64, material: Material) -> Result<SceneBody> {
        let (mass, center, inertia) = shape.mass(density)?;
        let mut body = SceneBody::fixed(shape, material);
        body.kind = Kind::Dynamic;
        body.state = crate::body_of(mass, &inertia)?;
        body.offset.position = center.map(|x| 0.0 - x);
        Ok(body)
    }
}

type Keep = HashMap<u32, Option<Arc<dyn Any + Send + Sync>>>;

/// A world of bodies.
///
/// ```
/// use tribo::{Material, Scene, SceneBody, Shape};
/// let material = Material { mu_s: 0.3, mu_d: 0.3, ..Default::default() };
/// let mut scene = Scene::new([0.0, 0.0, -9.81])?;
/// scene.add(&SceneBody::fixed(Shape::halfspace(&[0.0, 0.0, 1.0], 0.0)?, material))?;
/// let mut ball = SceneBody::solid(Shape::sphere(0.5)?, 4.0, material)?;
/// ball.state.position[2] = 0.5;
/// ball.state.velocity[0] = 7.0;
/// let id = scene.add(&ball)?;
/// for _ in 0..200 {
///     scene.step(0.01, Default::default())?;
/// }
/// assert!((scene.body(id)?.velocity[0] - 5.0).abs() < 1e-9);
/// # Ok::<(), tribo::Error>(())
/// ```
pub struct Scene {
    raw: *mut sys::tribo_scene,
    keep: Keep,
}

// SAFETY: the object is C's alone and bound to no thread; support functions are Send and Sync.
unsafe impl Send for Scene {}

/// A state of a scene; it keeps alive the shapes that it refers to.
#[derive(Clone)]
pub struct Saved {
    words: Vec<u64>,
    keep: Keep,
}

impl PartialEq for Saved {
    /// The same to the bit.
    fn eq(&self, other: &Saved) -> bool {
        self.words == other.words
    }
}

/// Runs the tasks of a step on as many threads.
unsafe extern "C" fn run_tasks(
    _user: *mut c_void,
    task: Option<unsafe extern "C" fn(data: *mut c_void, i: u32)>,
    data: *mut c_void,
    count: u32,
) {
    struct Data(*mut c_void);
    // SAFETY: C hands the data to any thread that runs its tasks.
    unsafe impl Sync for Data {}

    let data = &Data(data);
    if let Some(task) = task {
        std::thread::scope(|scope| {
            for i in 1..count {
                // SAFETY: tasks may run at once, each index once.
                scope.spawn(move || unsafe { task({ data }.0, i) });
            }
            if count > 0 {
                // SAFETY: as above.
                unsafe { task(data.0, 0) };
            }
        });
    }
}

impl Scene {
    /// An empty scene with gravity, m/s².
    pub fn new(gravity: [f64; 3]) -> Result<Scene> {
        Scene::with_settings(SceneSettings { gravity, ..Default::default() })
    }

    /// An empty scene.
    pub fn with_settings(settings: SceneSettings) -> Result<Scene> {
        let settings = sized!(SceneSettings, settings);
        let mut raw = null_mut();
        // SAFETY: the allocator is the default.
        Error::of(unsafe { sys::tribo_scene_create(&settings, null(), &mut raw) })?;
        Ok(Scene { raw, keep: Keep::new() })
    }

    /// Add a body; gives its id.
    pub fn add(&mut self, body: &SceneBody) -> Result<u32> {
        let mut raw = sys::tribo_scene_body::default();
        // SAFETY: a struct of C.
        Error::of(unsafe { sys::tribo_scene_body_init(&mut raw) })?;
        raw.kind = body.kind as u32;
        raw.state = body.state;
        raw.offset = body.offset;
        raw.material = body.material;
        raw.belt = body.belt;
        (raw.rolling, raw.spinning) = (body.rolling, body.spinning);
        if let Some(shape) = &body.shape {
            raw.shape = shape.raw;
        }
        let mut id = 0;
        // SAFETY: what the shape points to is kept below, as long as the body is there.
        Error::of(unsafe { sys::tribo_scene_add(self.raw, &raw, &mut id) })?;
        self.keep.insert(id, body.shape.as_ref().and_then(Shape::keep));
        Ok(id)
    }

    /// Remove a body and its contacts.
    pub fn remove(&mut self, id: u32) -> Result<()> {
        // SAFETY: C judges the id.
        Error::of(unsafe { sys::tribo_scene_remove(self.raw, id) })?;
        self.keep.remove(&id);
        Ok(())
    }

    /// Number of bodies.
    pub fn len(&self) -> usize {
        self.keep.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.keep.is_empty()
    }

    /// Ids in use, ascending.
    pub fn ids(&self) -> Vec<u32> {
        let mut ids: Vec<u32> = self.keep.keys().copied().collect();
        ids.sort_unstable();
        ids
    }

    /// Advance by dt seconds. `options.tasks` above 1 runs on as many threads; pointers of the
    /// options are not used. On an error the scene is as it was.
    pub fn step(&mut self, dt: f64, options: StepOptions) -> Result<StepInfo> {
        let mut info = sized!(StepInfo);
        let options = StepOptions {
            parallel: if options.tasks > 1 { Some(run_tasks) } else { None },
            user: null_mut(),
            ..sized!(StepOptions, options)
        };
        // SAFETY: shapes are kept; `&mut self` makes this the only call.
        Error::of(unsafe { sys::tribo_scene_step(self.raw, dt, &options, &mut info) })?;
        Ok(info)
    }

    /// Pose and velocities of a body.
    pub fn body(&self, id: u32) -> Result<Body> {
        let mut out = Body::default();
        // SAFETY: C judges the id.
        Error::of(unsafe { sys::tribo_scene_get_body(self.raw, id, &mut out, null_mut()) })?;
        Ok(out)
    }

    /// Whether a body sleeps.
    pub fn is_asleep(&self, id: u32) -> Result<bool> {
        let (mut out, mut asleep) = (Body::default(), 0);
        // SAFETY: C judges the id.
        Error::of(unsafe { sys::tribo_scene_get_body(self.raw, id, &mut out, &mut asleep) })?;
        Ok(asleep != 0)
    }

    /// Change pose, velocities or mass of a body.
    pub fn set_body(&mut self, id: u32, state: &Body) -> Result<()> {
        // SAFETY: C judges id and state.
        Error::of(unsafe { sys::tribo_scene_set_body(self.raw, id, state) })
    }

    /// Force (N) at the centre of mass and torque (N m), from now on.
    pub fn set_force(&mut self, id: u32, force: &[f64; 3], torque: &[f64; 3]) -> Result<()> {
        // SAFETY: C judges id and numbers.
        Error::of(unsafe {
            sys::tribo_scene_set_force(self.raw, id, force.as_ptr(), torque.as_ptr())
        })
    }

    /// Change gravity.
    pub fn set_gravity(&mut self, gravity: &[f64; 3]) -> Result<()> {
        // SAFETY: of the length that C asks for.
        Error::of(unsafe { sys::tribo_scene_set_gravity(self.raw, gravity.as_ptr()) })
    }

    /// Momentum about `origin`, kinetic energy; and potential energy.
    pub fn totals(&self, origin: &[f64; 3]) -> Result<(Totals, f64)> {
        let (mut out, mut potential) = (Totals::default(), 0.0);
        // SAFETY: of the length that C asks for.
        Error::of(unsafe {
            sys::tribo_scene_totals(self.raw, origin.as_ptr(), &mut out, &mut potential)
        })?;
        Ok((out, potential))
    }

    /// Contact points of the last sub-step.
    pub fn contacts(&self) -> Result<Vec<SceneContact>> {
        // SAFETY: the capacity is that of the vector.
        list(|n, out, count| unsafe { sys::tribo_scene_contacts(self.raw, n, out, count) })
    }

    /// What touched in the last step.
    pub fn events(&self) -> Result<Vec<SceneEvent>> {
        // SAFETY: the capacity is that of the vector.
        list(|n, out, count| unsafe { sys::tribo_scene_events(self.raw, n, out, count) })
    }

    /// All of the scene; [`Scene::load`] goes on from there to the bit.
    pub fn save(&self) -> Result<Saved> {
        let mut needed = 0;
        // SAFETY: with no room only the size is told.
        unsafe { sys::tribo_scene_save(self.raw, null_mut(), 0, &mut needed) };
        let mut words = vec![0_u64; needed.div_ceil(8)];
        // SAFETY: the capacity is that of the vector.
        Error::of(unsafe {
            let block = words.as_mut_ptr().cast();
            sys::tribo_scene_save(self.raw, block, 8 * words.len(), &mut needed)
        })?;
        Ok(Saved { words, keep: self.keep.clone() })
    }

    /// Go back to what [`Scene::save`] of this or another scene gave.
    pub fn load(&mut self, saved: &Saved) -> Result<()> {
        let block = saved.words.as_ptr().cast();
        // SAFETY: made by save, of this process; its shapes are kept.
        Error::of(unsafe { sys::tribo_scene_load(self.raw, block, 8 * saved.words.len()) })?;
        self.keep = saved.keep.clone();
        Ok(())
    }
}

impl Drop for Scene {
    fn drop(&mut self) {
        // SAFETY: made by create, and destroyed once.
        unsafe { sys::tribo_scene_destroy(self.raw) };
    }
}
