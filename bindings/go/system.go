package tribo

/*
#include <stdlib.h>
#include <tribo/sparse.h>

// What a solve is asked for, in plain numbers.
typedef struct ask {
	uint32_t solver, measure, warm_start, isa;
	uint64_t max_iterations;
	double tolerance;
} ask;

static tribo_status fill(const ask *a, tribo_sparse *sparse, double *torques, tribo_linear *linear,
                         tribo_system_options *o)
{
	*linear = (tribo_linear){.struct_size = sizeof *linear};
	*o = (tribo_system_options){.struct_size = sizeof *o, .solver = a->solver, .measure = a->measure,
	                            .warm_start = a->warm_start, .isa = a->isa,
	                            .max_iterations = a->max_iterations, .tolerance = a->tolerance,
	                            .linear = linear, .torques = torques};
	return tribo_sparse_linear(sparse, linear);
}

static tribo_status solve_bodies(const ask *a, tribo_sparse *sparse, size_t body_count,
                                 const tribo_body *bodies, size_t count,
                                 const tribo_system_contact *contacts, void **workspace, size_t *size,
                                 double *impulses, double *torques, double *velocities,
                                 tribo_system_info *info)
{
	tribo_linear linear;
	tribo_system_options o;
	size_t needed = 0;
	tribo_status status = fill(a, sparse, torques, &linear, &o);
	if (status == TRIBO_OK) {
		status = tribo_system_workspace_size(body_count, count, contacts, &o, &needed);
	}
	if (status == TRIBO_OK && needed > *size) {
		free(*workspace);
		*workspace = malloc(needed);
		*size = *workspace ? needed : 0;
		status = *workspace ? TRIBO_OK : TRIBO_ERROR_MEMORY;
	}
	return status != TRIBO_OK ? status
	                          : tribo_system_solve(body_count, bodies, count, contacts, &o, *workspace,
	                                               *size, impulses, velocities, info);
}

static tribo_status solve_blocks(const ask *a, tribo_sparse *sparse, size_t count,
                                 const uint32_t *row_starts, const uint32_t *columns,
                                 const double *blocks, const double *q, const double *mu,
                                 void **workspace, size_t *size, double *impulses,
                                 double *velocities, tribo_system_info *info)
{
	tribo_linear linear;
	tribo_system_options o;
	size_t needed = 0;
	tribo_status status = fill(a, sparse, NULL, &linear, &o);
	if (status == TRIBO_OK) {
		status = tribo_system_assembled_workspace_size(count, row_starts, columns, &o, &needed);
	}
	if (status == TRIBO_OK && needed > *size) {
		free(*workspace);
		*workspace = malloc(needed);
		*size = *workspace ? needed : 0;
		status = *workspace ? TRIBO_OK : TRIBO_ERROR_MEMORY;
	}
	return status != TRIBO_OK
	           ? status
	           : tribo_system_solve_assembled(count, row_starts, columns, blocks, q, mu, &o, *workspace,
	                                          *size, impulses, velocities, info);
}
*/
import "C"

import (
	"runtime"
	"unsafe"
)

// SystemOptions are the options of a solve; zeros are the defaults.
type SystemOptions struct {
	Solver        uint32  // Solver...
	Measure       uint32  // Measure...: what Tolerance bounds
	Isa           uint32  // Isa...; no bit depends on it
	WarmStart     bool    // from Impulses and Torques of the last solve
	MaxIterations uint64  // of sweeps, and of Newton steps
	Tolerance     float64 // 0: 1e-10
}

// System solves systems of bodies and contacts; it keeps workspace, factorisations and results.
// Close it, or leave it to the collector.
type System struct {
	owner
	sparse    *C.tribo_sparse
	workspace *struct { // in C: Go hands over its address
		data unsafe.Pointer
		size C.size_t
	}

	Impulses   []float64 // 3 a contact, on A, contact coordinates, N s
	Torques    []float64 // 3 a contact that resists rolling or spinning, N m s
	Velocities []float64 // 6 a body; 3 a contact after SolveAssembled
	Info       SystemInfo
}

// NewSystem makes an empty one.
func NewSystem() (*System, error) {
	s := &System{}
	if err := check(C.tribo_sparse_create(C.TRIBO_SPARSE_AUTO, nil, &s.sparse)); err != nil {
		return nil, err
	}
	room := C.calloc(1, C.size_t(unsafe.Sizeof(*s.workspace)))
	if room == nil {
		C.tribo_sparse_destroy(s.sparse)
		return nil, ErrMemory
	}
	s.workspace = (*struct {
		data unsafe.Pointer
		size C.size_t
	})(room)
	runtime.SetFinalizer(s, func(s *System) { s.Close() })
	return s, nil
}

// Close frees what it holds but the results; later calls return ErrClosed.
func (s *System) Close() error {
	if err := s.enter(); err != nil {
		return err
	}
	defer s.lock.Unlock()
	C.tribo_sparse_destroy(s.sparse)
	C.free(s.workspace.data)
	C.free(unsafe.Pointer(s.workspace))
	s.closed = true
	return nil
}

func (s *System) ask(o SystemOptions, n int) (C.ask, []float64, []float64, error) {
	a := C.ask{solver: C.uint32_t(o.Solver), measure: C.uint32_t(o.Measure), isa: C.uint32_t(o.Isa),
		max_iterations: C.uint64_t(o.MaxIterations), tolerance: C.double(o.Tolerance)}
	impulses, torques := make([]float64, 3*n), make([]float64, 3*n)
	if o.WarmStart {
		if len(s.Impulses) != 3*n || len(s.Torques) != 3*n {
			return a, nil, nil, ErrLength
		}
		a.warm_start = 1
		copy(impulses, s.Impulses)
		copy(torques, s.Torques)
	}
	return a, impulses, torques, nil
}

// Solve solves for bodies and contacts; the results are in Impulses, Torques, Velocities and Info,
// which stay as they were on an error.
func (s *System) Solve(bodies []Body, contacts []SystemContact, options SystemOptions) error {
	if err := s.enter(); err != nil {
		return err
	}
	defer s.lock.Unlock()
	a, impulses, torques, err := s.ask(options, len(contacts))
	if err != nil {
		return err
	}
	velocities := make([]float64, 6*len(bodies))
	info := SystemInfo{structSize: uint32(unsafe.Sizeof(SystemInfo{}))}
	err = check(C.solve_bodies(&a, s.sparse, C.size_t(len(bodies)), (*C.tribo_body)(first(bodies)),
		C.size_t(len(contacts)), (*C.tribo_system_contact)(first(contacts)), &s.workspace.data,
		&s.workspace.size, (*C.double)(first(impulses)), (*C.double)(first(torques)),
		(*C.double)(first(velocities)), (*C.tribo_system_info)(unsafe.Pointer(&info))))
	if err == nil {
		s.Impulses, s.Torques, s.Velocities, s.Info = impulses, torques, velocities, info
	}
	return err
}

// SolveAssembled solves u = W r + q: q has 3, mu 2 numbers a contact. rowStarts and columns nil: W is
// dense, row by row; else blocks of 9 numbers.
func (s *System) SolveAssembled(rowStarts, columns []uint32, blocks, q, mu []float64,
	options SystemOptions) error {
	n := len(mu) / 2
	isDense := rowStarts == nil && columns == nil
	if !fits(n, len(mu), 2, len(q), 3) || (isDense && len(blocks) != 9*n*n) ||
		(!isDense && (len(rowStarts) != n+1 || int(rowStarts[n]) != len(columns) ||
			len(blocks) != 9*len(columns))) {
		return ErrLength
	}
	if err := s.enter(); err != nil {
		return err
	}
	defer s.lock.Unlock()
	a, impulses, torques, err := s.ask(options, n)
	if err != nil {
		return err
	}
	velocities := make([]float64, 3*n)
	info := SystemInfo{structSize: uint32(unsafe.Sizeof(SystemInfo{}))}
	err = check(C.solve_blocks(&a, s.sparse, C.size_t(n), (*C.uint32_t)(first(rowStarts)),
		(*C.uint32_t)(first(columns)), (*C.double)(first(blocks)), (*C.double)(first(q)),
		(*C.double)(first(mu)), &s.workspace.data, &s.workspace.size, (*C.double)(first(impulses)),
		(*C.double)(first(velocities)), (*C.tribo_system_info)(unsafe.Pointer(&info))))
	if err == nil {
		clear(torques)
		s.Impulses, s.Torques, s.Velocities, s.Info = impulses, torques, velocities, info
	}
	return err
}

// Apply gives the velocities of the last Solve to the bodies.
func (s *System) Apply(bodies []Body) error {
	if len(s.Velocities) != 6*len(bodies) {
		return ErrLength
	}
	return check(C.tribo_system_apply(C.size_t(len(bodies)), (*C.tribo_body)(first(bodies)),
		(*C.double)(first(s.Velocities))))
}

// Report tells what the factorisations did.
func (s *System) Report() (SparseInfo, error) {
	info := SparseInfo{structSize: uint32(unsafe.Sizeof(SparseInfo{}))}
	if err := s.enter(); err != nil {
		return info, err
	}
	defer s.lock.Unlock()
	return info, check(C.tribo_sparse_report(s.sparse, (*C.tribo_sparse_info)(unsafe.Pointer(&info))))
}
