package tribo

/*
#include <stdint.h>
#include <stdlib.h>
#include <tribo/broad.h>
#include <tribo/collide.h>

void goSupport(uintptr_t handle, double *direction, double *point);

static void support(const void *user, const double direction[3], double point[3])
{
	double d[3] = {direction[0], direction[1], direction[2]};
	goSupport(*(const uintptr_t *)user, d, point);
}

// A user's convex shape, and the handle of its function behind it.
typedef struct own_convex {
	tribo_convex convex;
	uintptr_t handle;
} own_convex;

static own_convex *make_convex(uintptr_t handle, const double center[3], double radius)
{
	own_convex *c = calloc(1, sizeof *c);
	if (c) {
		c->handle = handle;
		c->convex.struct_size = sizeof c->convex;
		c->convex.support = support;
		c->convex.user = &c->handle;
		for (int i = 0; i < 3; i++) {
			c->convex.center[i] = center[i];
		}
		c->convex.radius = radius;
	}
	return c;
}

static void touch_options(tribo_collide_options *o, double margin)
{
	*o = (tribo_collide_options){.struct_size = sizeof *o, .margin = margin};
}
*/
import "C"

import (
	"math"
	"runtime"
	"runtime/cgo"
	"unsafe"
)

// Shape is a shape; a value, which may be copied and shared. It keeps alive what it is made of.
type Shape struct {
	raw  C.tribo_shape
	keep *block
}

// block is memory of C that shapes refer to; it is freed when no Go value refers to it.
type block struct {
	data   unsafe.Pointer
	handle cgo.Handle
	parts  []Shape
}

func newBlock(data unsafe.Pointer) *block {
	b := &block{data: data}
	runtime.SetFinalizer(b, func(b *block) {
		C.free(b.data)
		if b.handle != 0 {
			b.handle.Delete()
		}
	})
	return b
}

func makeShape(kind uint32, size [4]float64, count int, keep *block) (Shape, error) {
	s := Shape{keep: keep}
	s.raw._type = C.uint32_t(kind)
	s.raw.count = C.uint32_t(count)
	for i, length := range size {
		s.raw.size[i] = C.double(length)
	}
	if keep != nil {
		s.raw.data = keep.data
	}
	err := check(C.tribo_shape_check(&s.raw))
	runtime.KeepAlive(keep)
	return s, err
}

// Sphere is a ball.
func Sphere(radius float64) (Shape, error) {
	return makeShape(ShapeSphere, [4]float64{radius}, 0, nil)
}

// Box has half-extents.
func Box(hx, hy, hz float64) (Shape, error) {
	return makeShape(ShapeBox, [4]float64{hx, hy, hz}, 0, nil)
}

// Capsule is all within radius of the axis z from -halfHeight to halfHeight.
func Capsule(radius, halfHeight float64) (Shape, error) {
	return makeShape(ShapeCapsule, [4]float64{radius, halfHeight}, 0, nil)
}

// Cylinder has axis z.
func Cylinder(radius, halfHeight float64) (Shape, error) {
	return makeShape(ShapeCylinder, [4]float64{radius, halfHeight}, 0, nil)
}

// Cone has axis z, apex up.
func Cone(radius, halfHeight float64) (Shape, error) {
	return makeShape(ShapeCone, [4]float64{radius, halfHeight}, 0, nil)
}

// Ellipsoid has semi-axes.
func Ellipsoid(a, b, c float64) (Shape, error) {
	return makeShape(ShapeEllipsoid, [4]float64{a, b, c}, 0, nil)
}

// HalfSpace is all x with normal . x <= d.
func HalfSpace(normal [3]float64, d float64) (Shape, error) {
	return makeShape(ShapeHalfspace, [4]float64{normal[0], normal[1], normal[2], d}, 0, nil)
}

func ofBlock(kind uint32, build func(data unsafe.Pointer, size C.size_t, needed *C.size_t) C.tribo_status,
) (Shape, error) {
	var needed C.size_t
	if status := build(nil, 0, &needed); status != C.TRIBO_ERROR_CAPACITY && status != 0 {
		return Shape{}, Error(status)
	}
	data := C.malloc(needed + 1)
	if data == nil {
		return Shape{}, ErrMemory
	}
	keep := newBlock(data)
	if err := check(build(data, needed, &needed)); err != nil {
		return Shape{}, err
	}
	return makeShape(kind, [4]float64{}, 0, keep)
}

// Hull is the convex hull of points, 3 numbers each.
func Hull(points []float64) (Shape, error) {
	if len(points)%3 != 0 {
		return Shape{}, ErrLength
	}
	return ofBlock(ShapeHull, func(data unsafe.Pointer, size C.size_t, needed *C.size_t) C.tribo_status {
		return C.tribo_hull_build(C.size_t(len(points)/3), (*C.double)(first(points)), data, size,
			needed)
	})
}

// Mesh is a static triangle mesh: 3 numbers a vertex, 3 indices a triangle.
func Mesh(vertices []float64, triangles []uint32) (Shape, error) {
	if len(vertices)%3 != 0 || len(triangles)%3 != 0 {
		return Shape{}, ErrLength
	}
	return ofBlock(ShapeMesh, func(data unsafe.Pointer, size C.size_t, needed *C.size_t) C.tribo_status {
		return C.tribo_mesh_build(C.size_t(len(vertices)/3), (*C.double)(first(vertices)),
			C.size_t(len(triangles)/3), (*C.uint32_t)(first(triangles)), data, size, needed)
	})
}

// Child is a convex part of a compound.
type Child struct {
	Shape Shape
	Pose  Pose
}

// Compound is made of convex parts.
func Compound(children []Child) (Shape, error) {
	data := C.calloc(C.size_t(len(children)+1), C.sizeof_tribo_child)
	if data == nil {
		return Shape{}, ErrMemory
	}
	keep := newBlock(data)
	parts := unsafe.Slice((*C.tribo_child)(data), len(children))
	for i, child := range children {
		parts[i].shape = child.Shape.raw
		parts[i].pose = *cPose(&child.Pose)
		keep.parts = append(keep.parts, child.Shape)
	}
	return makeShape(ShapeCompound, [4]float64{}, len(children), keep)
}

// Convex is a shape by a support function: direction to the farthest point along it, body axes.
// center is a point well inside, radius that of a ball around it that holds the shape. A function
// that panics makes calls fail with ErrSupport.
func Convex(support func(direction [3]float64) [3]float64, center [3]float64, radius float64,
) (Shape, error) {
	handle := cgo.NewHandle(support)
	data := C.make_convex(C.uintptr_t(handle), (*C.double)(&center[0]), C.double(radius))
	if data == nil {
		handle.Delete()
		return Shape{}, ErrMemory
	}
	keep := newBlock(unsafe.Pointer(data))
	keep.handle = handle
	return makeShape(ShapeConvex, [4]float64{}, 0, keep)
}

//export goSupport
func goSupport(handle C.uintptr_t, direction, point *C.double) {
	out := (*[3]float64)(unsafe.Pointer(point))
	*out = [3]float64{math.NaN(), math.NaN(), math.NaN()}
	// A panic must not pass through C: a point that is no number is a status there.
	defer func() { _ = recover() }()
	call := cgo.Handle(handle).Value().(func([3]float64) [3]float64)
	*out = call(*(*[3]float64)(unsafe.Pointer(direction)))
}

// Support is the farthest point along a direction.
func (s Shape) Support(direction [3]float64) ([3]float64, error) {
	var out [3]float64
	err := check(C.tribo_shape_support(&s.raw, (*C.double)(&direction[0]), (*C.double)(&out[0])))
	runtime.KeepAlive(s.keep)
	return out, err
}

// Bounds are the least and greatest corner of the axis-aligned bounds at a pose.
func (s Shape) Bounds(pose Pose) (low, high [3]float64, err error) {
	err = check(C.tribo_shape_bounds(&s.raw, cPose(&pose), (*C.double)(&low[0]),
		(*C.double)(&high[0])))
	runtime.KeepAlive(s.keep)
	return low, high, err
}

// Mass, centre of mass and inertia about it of a uniform solid.
func (s Shape) Mass(density float64) (mass float64, center [3]float64, inertia [9]float64, err error) {
	err = check(C.tribo_shape_mass(&s.raw, C.double(density), (*C.double)(&mass),
		(*C.double)(&center[0]), (*C.double)(&inertia[0])))
	runtime.KeepAlive(s.keep)
	return mass, center, inertia, err
}

func cPose(p *Pose) *C.tribo_pose {
	return (*C.tribo_pose)(unsafe.Pointer(p))
}

// At is a pose without rotation.
func At(x, y, z float64) Pose {
	return Pose{Position: [3]float64{x, y, z}, Orientation: [4]float64{1, 0, 0, 0}}
}

// Touch gives the contact manifolds between two shapes at poses, if they are not farther apart than
// margin.
func Touch(a Shape, poseA Pose, b Shape, poseB Pose, margin float64) ([]Manifold, error) {
	var options C.tribo_collide_options
	C.touch_options(&options, C.double(margin))
	defer runtime.KeepAlive(a.keep)
	defer runtime.KeepAlive(b.keep)
	for capacity := 4; ; {
		out := make([]Manifold, capacity)
		var count C.uint32_t
		status := C.tribo_collide_shapes(&a.raw, cPose(&poseA), &b.raw, cPose(&poseB), &options,
			C.uint32_t(capacity), (*C.tribo_manifold)(first(out)), &count, nil)
		if status != C.TRIBO_ERROR_CAPACITY {
			return out[:min(int(count), capacity)], check(status)
		}
		capacity = int(count)
	}
}

// TouchBatch gives one manifold for each pair of indices; statuses may be nil.
func TouchBatch(shapes []Shape, poses []Pose, pairs []uint32, margin float64, statuses []int32,
) ([]Manifold, error) {
	n := len(pairs) / 2
	if len(shapes) != len(poses) || len(pairs) != 2*n || !optional(n, len(statuses)) {
		return nil, ErrLength
	}
	var options C.tribo_collide_options
	C.touch_options(&options, C.double(margin))
	raw := (*C.tribo_shape)(C.calloc(C.size_t(len(shapes)+1), C.sizeof_tribo_shape))
	if raw == nil {
		return nil, ErrMemory
	}
	defer C.free(unsafe.Pointer(raw))
	for i, s := range shapes {
		unsafe.Slice(raw, len(shapes))[i] = s.raw
	}
	out := make([]Manifold, n)
	err := check(C.tribo_collide_batch(C.uint32_t(len(shapes)), raw, (*C.tribo_pose)(first(poses)),
		C.size_t(n), (*C.uint32_t)(first(pairs)), &options, (*C.tribo_manifold)(first(out)),
		(*C.tribo_status)(first(statuses)), nil))
	runtime.KeepAlive(shapes)
	return out, err
}

// ---- broad phase --------------------------------------------------------------------------------

// Tree finds which of many axis-aligned boxes overlap. Close it, or leave it to the collector.
type Tree struct {
	owner
	raw *C.tribo_tree
}

// NewTree makes a tree of up to capacity boxes, which it stores larger by margin.
func NewTree(capacity uint32, margin float64) (*Tree, error) {
	data := C.calloc(C.tribo_tree_size(C.uint32_t(capacity))+1, 1)
	if data == nil {
		return nil, ErrMemory
	}
	t := &Tree{}
	if err := check(C.tribo_tree_init(data, C.uint32_t(capacity), C.double(margin), &t.raw)); err != nil {
		C.free(data)
		return nil, err
	}
	runtime.SetFinalizer(t, func(t *Tree) { t.Close() })
	return t, nil
}

// Close frees the tree; later calls return ErrClosed.
func (t *Tree) Close() error {
	if err := t.enter(); err != nil {
		return err
	}
	defer t.lock.Unlock()
	C.free(unsafe.Pointer(t.raw))
	t.closed = true
	return nil
}

// Add adds a box and gives its id.
func (t *Tree) Add(low, high [3]float64) (uint32, error) {
	if err := t.enter(); err != nil {
		return 0, err
	}
	defer t.lock.Unlock()
	var id C.uint32_t
	err := check(C.tribo_tree_add(t.raw, (*C.double)(&low[0]), (*C.double)(&high[0]), &id))
	return uint32(id), err
}

// Move moves a box.
func (t *Tree) Move(id uint32, low, high [3]float64) error {
	if err := t.enter(); err != nil {
		return err
	}
	defer t.lock.Unlock()
	return check(C.tribo_tree_move(t.raw, C.uint32_t(id), (*C.double)(&low[0]),
		(*C.double)(&high[0])))
}

// Remove removes a box.
func (t *Tree) Remove(id uint32) error {
	if err := t.enter(); err != nil {
		return err
	}
	defer t.lock.Unlock()
	return check(C.tribo_tree_remove(t.raw, C.uint32_t(id)))
}

// ids asks for a list with no room, then with enough; width numbers an entry.
func (t *Tree) ids(width int, fill func(n C.size_t, out *C.uint32_t, count *C.size_t) C.tribo_status,
) ([]uint32, error) {
	if err := t.enter(); err != nil {
		return nil, err
	}
	defer t.lock.Unlock()
	var count C.size_t
	status := fill(0, nil, &count)
	out := make([]uint32, width*int(count))
	if status == C.TRIBO_ERROR_CAPACITY {
		status = fill(count, (*C.uint32_t)(first(out)), &count)
	}
	return out, check(status)
}

// Pairs are overlapping pairs of ids, two numbers a pair, sorted.
func (t *Tree) Pairs() ([]uint32, error) {
	return t.ids(2, func(n C.size_t, out *C.uint32_t, count *C.size_t) C.tribo_status {
		return C.tribo_tree_pairs(t.raw, n, out, count)
	})
}

// QueryBox gives ids of boxes that overlap a box, sorted.
func (t *Tree) QueryBox(low, high [3]float64) ([]uint32, error) {
	return t.ids(1, func(n C.size_t, out *C.uint32_t, count *C.size_t) C.tribo_status {
		return C.tribo_tree_query_box(t.raw, (*C.double)(&low[0]), (*C.double)(&high[0]), n, out,
			count)
	})
}

// QueryRay gives ids of boxes that a segment meets, sorted.
func (t *Tree) QueryRay(from, to [3]float64) ([]uint32, error) {
	return t.ids(1, func(n C.size_t, out *C.uint32_t, count *C.size_t) C.tribo_status {
		return C.tribo_tree_query_ray(t.raw, (*C.double)(&from[0]), (*C.double)(&to[0]), n, out,
			count)
	})
}
