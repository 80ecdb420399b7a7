package tribo

/*
#include <stdlib.h>
#include <tribo/tribo.h>

// Options and infos are made in C, so that Go hands over addresses of plain numbers alone.
#cgo noescape solve_one
#cgo nocallback solve_one
static tribo_status solve_one(const double *w, const double *b, double mu_s, double mu_d, double *p)
{
	return tribo_contact_solve(w, b, mu_s, mu_d, p, NULL);
}
*/
import "C"

import "unsafe"

// FixedBody is an immovable body at the origin.
func FixedBody() Body {
	return Body{Orientation: [4]float64{1, 0, 0, 0}}
}

// BodyOf is a body at the origin, at rest, of a mass (kg) and an inertia tensor (kg m², body axes).
func BodyOf(mass float64, inertia [9]float64) (Body, error) {
	body := FixedBody()
	err := check(C.tribo_body_set_mass(cBody(&body), C.double(mass), (*C.double)(&inertia[0])))
	return body, err
}

func cBody(b *Body) *C.tribo_body {
	return (*C.tribo_body)(unsafe.Pointer(b))
}

// Check judges every field of the body.
func (b *Body) Check() error {
	return check(C.tribo_body_check(cBody(b)))
}

// Advance is free flight by dt seconds under a constant acceleration.
func (b *Body) Advance(acceleration [3]float64, dt float64) error {
	return check(C.tribo_body_advance(cBody(b), (*C.double)(&acceleration[0]), C.double(dt)))
}

// ApplyImpulse adds an impulse (N s, world axes) at an arm from the centre of mass.
func (b *Body) ApplyImpulse(arm, impulse [3]float64) error {
	return check(C.tribo_body_apply_impulse(cBody(b), (*C.double)(&arm[0]),
		(*C.double)(&impulse[0])))
}

// TotalsOf is the momentum about origin and the kinetic energy of bodies.
func TotalsOf(bodies []Body, origin [3]float64) (Totals, error) {
	var out Totals
	err := check(C.tribo_audit_bodies(C.size_t(len(bodies)), (*C.tribo_body)(first(bodies)),
		(*C.double)(&origin[0]), (*C.tribo_totals)(unsafe.Pointer(&out))))
	return out, err
}

// Mix makes the pair of two surfaces by rules Mix....
func Mix(a, b Material, friction, restitution uint32) (Material, error) {
	var out Material
	err := check(C.tribo_material_mix((*C.tribo_material)(unsafe.Pointer(&a)),
		(*C.tribo_material)(unsafe.Pointer(&b)), C.uint32_t(friction), C.uint32_t(restitution),
		(*C.tribo_material)(unsafe.Pointer(&out))))
	return out, err
}

// NamedMaterial is an entry of the table of pairs, such as "wood on stone".
func NamedMaterial(name string) (Material, error) {
	var out Material
	text := C.CString(name)
	defer C.free(unsafe.Pointer(text))
	err := check(C.tribo_material_find(text, (*C.tribo_material)(unsafe.Pointer(&out))))
	return out, err
}

// Rotation by |v| radians about v, as a quaternion.
func Rotation(v [3]float64) ([4]float64, error) {
	var out [4]float64
	err := check(C.tribo_quat_from_rotation_vector((*C.double)(&v[0]), (*C.double)(&out[0])))
	return out, err
}

// Normalize is v / |v|.
func Normalize(v [3]float64) ([3]float64, error) {
	var out [3]float64
	err := check(C.tribo_vec3_normalize((*C.double)(&v[0]), (*C.double)(&out[0])))
	return out, err
}

// Solve is the exact Signorini-Coulomb solve of one contact, v = W p + b: the impulse.
// w: nn, n1, n2, 11, 12, 22. On an error p is as it was.
func Solve(w *[6]float64, b *[3]float64, muS, muD float64, p *[3]float64) error {
	return check(C.solve_one((*C.double)(&w[0]), (*C.double)(&b[0]), C.double(muS), C.double(muD),
		(*C.double)(&p[0])))
}

// SolveWithInfo also tells what the solve did.
func SolveWithInfo(w [6]float64, b [3]float64, muS, muD float64) ([3]float64, SolveInfo, error) {
	var p [3]float64
	info := SolveInfo{structSize: uint32(unsafe.Sizeof(SolveInfo{}))}
	err := check(C.tribo_contact_solve((*C.double)(&w[0]), (*C.double)(&b[0]), C.double(muS),
		C.double(muD), (*C.double)(&p[0]), (*C.tribo_solve_info)(unsafe.Pointer(&info))))
	return p, info, err
}

// SolveGeneral is the same for any W, symmetric or not, row by row.
func SolveGeneral(w [9]float64, b [3]float64, muS, muD float64) ([3]float64, SolveInfo, error) {
	var p [3]float64
	info := SolveInfo{structSize: uint32(unsafe.Sizeof(SolveInfo{}))}
	err := check(C.tribo_contact_solve_general((*C.double)(&w[0]), (*C.double)(&b[0]),
		C.double(muS), C.double(muD), (*C.double)(&p[0]),
		(*C.tribo_solve_info)(unsafe.Pointer(&info))))
	return p, info, err
}

// Impact is the impulse of an impact with relative velocity u = (n, t1, t2) by a law Law....
func Impact(w [6]float64, u [3]float64, pair Material, law uint32) ([3]float64, ImpactInfo, error) {
	var p [3]float64
	info := ImpactInfo{structSize: uint32(unsafe.Sizeof(ImpactInfo{}))}
	options := C.tribo_impact_options{law: C.uint32_t(law)}
	options.struct_size = C.uint32_t(unsafe.Sizeof(options))
	err := check(C.tribo_impact((*C.double)(&w[0]), (*C.double)(&u[0]),
		(*C.tribo_material)(unsafe.Pointer(&pair)), &options, (*C.double)(&p[0]),
		(*C.tribo_impact_info)(unsafe.Pointer(&info))))
	return p, info, err
}

// Collide is a whole collision of two bodies by a law Law...; b is nil for the world.
func Collide(a, b *Body, point, normal [3]float64, pair Material, law uint32) (CollisionInfo, error) {
	info := CollisionInfo{structSize: uint32(unsafe.Sizeof(CollisionInfo{}))}
	options := C.tribo_impact_options{law: C.uint32_t(law)}
	options.struct_size = C.uint32_t(unsafe.Sizeof(options))
	err := check(C.tribo_collide(cBody(a), cBody(b), (*C.double)(&point[0]),
		(*C.double)(&normal[0]), (*C.tribo_material)(unsafe.Pointer(&pair)), &options,
		(*C.tribo_collision_info)(unsafe.Pointer(&info))))
	return info, err
}

// ---- batches: flat slices, one contact after the other ------------------------------------------

func fits(n int, lengths ...int) bool {
	for i := 0; i < len(lengths); i += 2 {
		if lengths[i] != n*lengths[i+1] {
			return false
		}
	}
	return true
}

func optional(n, length int) bool {
	return length == 0 || length == n
}

// BatchSolve is Solve on many contacts: w has 6 numbers a contact, b 3, mu 2 (mu_s, mu_d), p 3.
// modes and statuses may be nil; with statuses each contact has its own, and the error is the first.
func BatchSolve(isa uint32, w, b, mu, p []float64, modes []uint32, statuses []int32) error {
	n := len(p) / 3
	if !fits(n, len(w), 6, len(b), 3, len(mu), 2, len(p), 3) || !optional(n, len(modes)) ||
		!optional(n, len(statuses)) {
		return ErrLength
	}
	return check(C.tribo_batch_solve(C.uint32_t(isa), C.size_t(n), (*C.double)(first(w)),
		(*C.double)(first(b)), (*C.double)(first(mu)), (*C.double)(first(p)),
		(*C.uint32_t)(first(modes)), (*C.tribo_status)(first(statuses))))
}

// BatchImpact is Impact by LawAlgebraic on many contacts; see BatchSolve.
func BatchImpact(isa uint32, w, u []float64, pairs []Material, p []float64, modes []uint32,
	statuses []int32) error {
	n := len(pairs)
	if !fits(n, len(w), 6, len(u), 3, len(p), 3) || !optional(n, len(modes)) ||
		!optional(n, len(statuses)) {
		return ErrLength
	}
	return check(C.tribo_batch_impact(C.uint32_t(isa), C.size_t(n), (*C.double)(first(w)),
		(*C.double)(first(u)), (*C.tribo_material)(first(pairs)), (*C.double)(first(p)),
		(*C.uint32_t)(first(modes)), (*C.tribo_status)(first(statuses))))
}

// BatchMatrix gives frames (9 numbers a contact, may be nil) and contact matrices (6) of contacts
// between bodies; pairs has two indices a contact, World for none. See BatchSolve.
func BatchMatrix(isa uint32, bodies []Body, pairs []uint32, contacts []Contact, frames, w []float64,
	statuses []int32) error {
	n := len(contacts)
	if !fits(n, len(pairs), 2, len(w), 6) || !optional(9*n, len(frames)) ||
		!optional(n, len(statuses)) {
		return ErrLength
	}
	return check(C.tribo_batch_matrix(C.uint32_t(isa), C.size_t(len(bodies)),
		(*C.tribo_body)(first(bodies)), C.size_t(n), (*C.uint32_t)(first(pairs)),
		(*C.tribo_contact)(first(contacts)), (*C.double)(first(frames)), (*C.double)(first(w)),
		(*C.tribo_status)(first(statuses))))
}

// Audit gives the greatest and the root-mean-square measures of impulses.
func Audit(w, b, mu, p []float64) (most, rms Measures, err error) {
	n := len(mu)
	if !fits(n, len(w), 6, len(b), 3, len(p), 3) {
		return most, rms, ErrLength
	}
	err = check(C.tribo_audit_contacts(C.size_t(n), (*C.double)(first(w)), (*C.double)(first(b)),
		(*C.double)(first(mu)), (*C.double)(first(p)), (*C.tribo_measures)(unsafe.Pointer(&most)),
		(*C.tribo_measures)(unsafe.Pointer(&rms))))
	return most, rms, err
}

// ConeProject is the point of the friction cone nearest to p.
func ConeProject(p [3]float64, mu float64) ([3]float64, error) {
	var out [3]float64
	err := check(C.tribo_cone_project((*C.double)(&p[0]), C.double(mu), (*C.double)(&out[0])))
	return out, err
}
