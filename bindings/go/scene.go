package tribo

/*
#include <tribo/scene.h>

// Go's options, in plain numbers.
typedef struct step_ask {
	uint32_t substeps, solver, skip;
	uint64_t max_iterations;
	double tolerance, margin, threshold, correction, sleep_time, sleep_speed;
} step_ask;

static tribo_status step(tribo_scene *scene, double dt, const step_ask *a, tribo_step_info *info)
{
	const tribo_step_options o = {
	    .struct_size = sizeof o, .substeps = a->substeps, .solver = a->solver, .skip = a->skip,
	    .max_iterations = a->max_iterations, .tolerance = a->tolerance, .margin = a->margin,
	    .threshold = a->threshold, .correction = a->correction, .sleep_time = a->sleep_time,
	    .sleep_speed = a->sleep_speed};
	return tribo_scene_step(scene, dt, &o, info);
}
*/
import "C"

import (
	"maps"
	"runtime"
	"slices"
	"unsafe"
)

// SceneBody is a body to add to a scene.
type SceneBody struct {
	Kind     uint32     // BodyDynamic, BodyKinematic or BodyStatic
	State    Body       // mass, pose and velocities
	Shape    *Shape     // nil: it touches nothing
	Offset   Pose       // of the shape in the body's axes
	Material Material   // mixed with that of what it touches
	Belt     [3]float64 // velocity of the surface past the body, m/s, body axes
	Rolling  float64    // rolling resistance, m; of a pair the greater counts
	Spinning float64    // spinning resistance, m; of a pair the greater counts
}

// Fixed is an immovable body of a shape, at the origin.
func Fixed(shape Shape, material Material) SceneBody {
	return SceneBody{Kind: BodyStatic, State: FixedBody(), Shape: &shape, Offset: At(0, 0, 0),
		Material: material}
}

// Solid is a uniform solid of a shape, its centre of mass at the origin, at rest.
func Solid(shape Shape, density float64, material Material) (SceneBody, error) {
	mass, center, inertia, err := shape.Mass(density)
	if err != nil {
		return SceneBody{}, err
	}
	body := Fixed(shape, material)
	body.Kind = BodyDynamic
	body.Offset = At(0-center[0], 0-center[1], 0-center[2])
	body.State, err = BodyOf(mass, inertia)
	return body, err
}

// StepOptions are the options of a step; zeros are the defaults. See tribo_step_options.
type StepOptions struct {
	Substeps      uint32
	Solver        uint32 // Solver...
	Skip          uint32 // Skip..., or'ed
	MaxIterations uint64
	Tolerance     float64
	Margin        float64 // m
	Threshold     float64 // m/s
	Correction    float64
	SleepTime     float64 // s
	SleepSpeed    float64 // m/s
}

// Scene is a world of bodies that steps through time. Close it, or leave it to the collector.
type Scene struct {
	owner
	raw  *C.tribo_scene
	keep map[uint32]*block
}

// NewScene makes an empty scene with gravity, m/s²; friction and restitution mix by the geometric
// mean.
func NewScene(gravity [3]float64) (*Scene, error) {
	return NewSceneWithRules(gravity, MixGeometricMean, MixGeometricMean)
}

// NewSceneWithRules has rules Mix... for friction and restitution of pairs.
func NewSceneWithRules(gravity [3]float64, friction, restitution uint32) (*Scene, error) {
	settings := C.tribo_scene_settings{friction_rule: C.uint32_t(friction),
		restitution_rule: C.uint32_t(restitution)}
	settings.struct_size = C.uint32_t(unsafe.Sizeof(settings))
	for i, g := range gravity {
		settings.gravity[i] = C.double(g)
	}
	s := &Scene{keep: map[uint32]*block{}}
	if err := check(C.tribo_scene_create(&settings, nil, &s.raw)); err != nil {
		return nil, err
	}
	runtime.SetFinalizer(s, func(s *Scene) { s.Close() })
	return s, nil
}

// Close frees the scene; later calls return ErrClosed.
func (s *Scene) Close() error {
	if err := s.enter(); err != nil {
		return err
	}
	defer s.lock.Unlock()
	C.tribo_scene_destroy(s.raw)
	s.closed = true
	s.keep = nil
	return nil
}

// Add adds a body and gives its id.
func (s *Scene) Add(body SceneBody) (uint32, error) {
	if err := s.enter(); err != nil {
		return 0, err
	}
	defer s.lock.Unlock()
	var raw C.tribo_scene_body
	C.tribo_scene_body_init(&raw)
	raw.kind = C.uint32_t(body.Kind)
	raw.state = *cBody(&body.State)
	raw.offset = *cPose(&body.Offset)
	raw.material = *(*C.tribo_material)(unsafe.Pointer(&body.Material))
	for i, v := range body.Belt {
		raw.belt[i] = C.double(v)
	}
	raw.rolling, raw.spinning = C.double(body.Rolling), C.double(body.Spinning)
	var keep *block
	if body.Shape != nil {
		raw.shape = body.Shape.raw
		keep = body.Shape.keep
	}
	var id C.uint32_t
	if err := check(C.tribo_scene_add(s.raw, &raw, &id)); err != nil {
		return 0, err
	}
	s.keep[uint32(id)] = keep
	return uint32(id), nil
}

// Remove removes a body and its contacts.
func (s *Scene) Remove(id uint32) error {
	if err := s.enter(); err != nil {
		return err
	}
	defer s.lock.Unlock()
	err := check(C.tribo_scene_remove(s.raw, C.uint32_t(id)))
	if err == nil {
		delete(s.keep, id)
	}
	return err
}

// IDs are those in use, ascending.
func (s *Scene) IDs() ([]uint32, error) {
	if err := s.enter(); err != nil {
		return nil, err
	}
	defer s.lock.Unlock()
	return slices.Sorted(maps.Keys(s.keep)), nil
}

// Step advances by dt seconds. On an error the scene is as it was.
func (s *Scene) Step(dt float64, o StepOptions) (StepInfo, error) {
	info := StepInfo{structSize: uint32(unsafe.Sizeof(StepInfo{}))}
	if err := s.enter(); err != nil {
		return info, err
	}
	defer s.lock.Unlock()
	a := C.step_ask{substeps: C.uint32_t(o.Substeps), solver: C.uint32_t(o.Solver),
		skip: C.uint32_t(o.Skip), max_iterations: C.uint64_t(o.MaxIterations),
		tolerance: C.double(o.Tolerance), margin: C.double(o.Margin),
		threshold: C.double(o.Threshold), correction: C.double(o.Correction),
		sleep_time: C.double(o.SleepTime), sleep_speed: C.double(o.SleepSpeed)}
	err := check(C.step(s.raw, C.double(dt), &a, (*C.tribo_step_info)(unsafe.Pointer(&info))))
	runtime.KeepAlive(s.keep)
	return info, err
}

// Body gives pose and velocities of a body.
func (s *Scene) Body(id uint32) (Body, error) {
	body, _, err := s.get(id)
	return body, err
}

// Asleep tells whether a body sleeps.
func (s *Scene) Asleep(id uint32) (bool, error) {
	_, asleep, err := s.get(id)
	return asleep, err
}

func (s *Scene) get(id uint32) (Body, bool, error) {
	var body Body
	var asleep C.uint32_t
	if err := s.enter(); err != nil {
		return body, false, err
	}
	defer s.lock.Unlock()
	err := check(C.tribo_scene_get_body(s.raw, C.uint32_t(id), cBody(&body), &asleep))
	return body, asleep != 0, err
}

// SetBody changes pose, velocities or mass of a body.
func (s *Scene) SetBody(id uint32, state Body) error {
	if err := s.enter(); err != nil {
		return err
	}
	defer s.lock.Unlock()
	return check(C.tribo_scene_set_body(s.raw, C.uint32_t(id), cBody(&state)))
}

// SetForce sets force (N) at the centre of mass and torque (N m), from now on.
func (s *Scene) SetForce(id uint32, force, torque [3]float64) error {
	if err := s.enter(); err != nil {
		return err
	}
	defer s.lock.Unlock()
	return check(C.tribo_scene_set_force(s.raw, C.uint32_t(id), (*C.double)(&force[0]),
		(*C.double)(&torque[0])))
}

// SetGravity changes gravity.
func (s *Scene) SetGravity(gravity [3]float64) error {
	if err := s.enter(); err != nil {
		return err
	}
	defer s.lock.Unlock()
	return check(C.tribo_scene_set_gravity(s.raw, (*C.double)(&gravity[0])))
}

// Totals are momentum about origin and kinetic energy; and the potential energy.
func (s *Scene) Totals(origin [3]float64) (Totals, float64, error) {
	var out Totals
	var potential C.double
	if err := s.enter(); err != nil {
		return out, 0, err
	}
	defer s.lock.Unlock()
	err := check(C.tribo_scene_totals(s.raw, (*C.double)(&origin[0]),
		(*C.tribo_totals)(unsafe.Pointer(&out)), &potential))
	return out, float64(potential), err
}

// Contacts are the contact points of the last sub-step.
func (s *Scene) Contacts() ([]SceneContact, error) {
	return list(s, func(n C.size_t, out *SceneContact, count *C.size_t) C.tribo_status {
		return C.tribo_scene_contacts(s.raw, n, (*C.tribo_scene_contact)(unsafe.Pointer(out)), count)
	})
}

// Events are what touched in the last step.
func (s *Scene) Events() ([]SceneEvent, error) {
	return list(s, func(n C.size_t, out *SceneEvent, count *C.size_t) C.tribo_status {
		return C.tribo_scene_events(s.raw, n, (*C.tribo_scene_event)(unsafe.Pointer(out)), count)
	})
}

// list asks for a list with no room, then with enough.
func list[T any](s *Scene, fill func(n C.size_t, out *T, count *C.size_t) C.tribo_status) ([]T, error) {
	if err := s.enter(); err != nil {
		return nil, err
	}
	defer s.lock.Unlock()
	var count C.size_t
	status := fill(0, nil, &count)
	out := make([]T, count)
	if status == C.TRIBO_ERROR_CAPACITY {
		status = fill(count, unsafe.SliceData(out), &count)
	}
	return out, check(status)
}

// Saved is a state of a scene, for this process; it keeps alive the shapes that it refers to.
type Saved struct {
	words []uint64
	keep  map[uint32]*block
}

// Equal tells whether two states are the same to the bit.
func (s Saved) Equal(other Saved) bool {
	return slices.Equal(s.words, other.words)
}

// Save keeps all of the scene; Load goes on from there to the bit.
func (s *Scene) Save() (Saved, error) {
	if err := s.enter(); err != nil {
		return Saved{}, err
	}
	defer s.lock.Unlock()
	var needed C.size_t
	C.tribo_scene_save(s.raw, nil, 0, &needed)
	words := make([]uint64, (needed+7)/8)
	err := check(C.tribo_scene_save(s.raw, first(words), C.size_t(8*len(words)), &needed))
	return Saved{words, maps.Clone(s.keep)}, err
}

// Load goes back to what Save of this or another scene gave.
func (s *Scene) Load(saved Saved) error {
	if err := s.enter(); err != nil {
		return err
	}
	defer s.lock.Unlock()
	err := check(C.tribo_scene_load(s.raw, first(saved.words), C.size_t(8*len(saved.words))))
	if err == nil {
		s.keep = maps.Clone(saved.keep)
	}
	return err
}
