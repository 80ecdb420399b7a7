// Package tribo resolves contact and friction between rigid bodies, exactly and fast: one contact,
// batches, systems of thousands, contacts from shapes, and scenes that step through time.
//
// SI units; quaternions are (w, x, y, z); contact coordinates are (n, t1, t2) with the normal from
// body B to body A. Structs and constants are those of the C library, in which a function of the same
// name says in full what it means.
//
// Errors of the C library are of type Error; on one, nothing was changed. A Scene, System or Tree is
// for one goroutine at a time: a call while another is inside returns ErrBusy.
package tribo

/*
#cgo CFLAGS: -std=c99 -O3 -w -Icsrc/include -DTRIBO_BUILD -fvisibility=hidden
#cgo amd64 CFLAGS: -DTRIBO_HAVE_X86_64_LEVELS=1
#cgo LDFLAGS: -lccd -lqhull_r -lcholmod -lklu -lumfpack -lsuitesparseconfig -lm
#include <tribo/tribo.h>
*/
import "C"

import (
	"errors"
	"sync"
	"unsafe"
)

// Error is a status of the C library other than TRIBO_OK.
type Error int32

// Error says what is wrong, in one sentence.
func (e Error) Error() string {
	return "tribo: " + C.GoString(C.tribo_status_string(C.tribo_status(e)))
}

// Name is the name in C, such as "TRIBO_ERROR_NULL".
func (e Error) Name() string {
	return C.GoString(C.tribo_status_name(C.tribo_status(e)))
}

// Errors that are not of the C library.
var (
	// ErrBusy: another goroutine is inside of a call on the same object.
	ErrBusy = errors.New("tribo: the object is in use")
	// ErrClosed: the object was closed.
	ErrClosed = errors.New("tribo: the object is closed")
	// ErrLength: slices whose lengths do not fit each other.
	ErrLength = errors.New("tribo: lengths of slices do not fit each other")
)

func check(status C.tribo_status) error {
	if status == 0 {
		return nil
	}
	return Error(status)
}

// Version of the C library.
func Version() string {
	return C.GoString(C.tribo_version_string())
}

// owner holds something of C: freed once, used by one goroutine at a time.
type owner struct {
	lock   sync.Mutex
	closed bool
}

func (o *owner) enter() error {
	if !o.lock.TryLock() {
		return ErrBusy
	}
	if o.closed {
		o.lock.Unlock()
		return ErrClosed
	}
	return nil
}

// first is the address of a slice's first element; nil of an empty one.
func first[T any](s []T) unsafe.Pointer {
	return unsafe.Pointer(unsafe.SliceData(s))
}
