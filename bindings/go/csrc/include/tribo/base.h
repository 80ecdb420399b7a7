/**
 * @file base.h
 * Version, export macro, status codes and the rules that hold for every function of tribo.
 *
 * Rules, stated once and true everywhere:
 * - Units are SI: metre, kilogram, second, radian. Impulses are N s.
 * - Vectors are double[3], quaternions double[4] as (w, x, y, z), 3x3 matrices double[9] row by
 *   row, symmetric 3x3 matrices double[6] as (00, 01, 02, 11, 12, 22).
 * - Pointers must be valid, aligned and of the stated length. An output may be the same array as an
 *   input unless said otherwise; partial overlap is not allowed.
 * - A function that can fail returns a tribo_status. Unless it returns TRIBO_OK, every output is
 *   untouched. Null pointers, struct sizes and option values are judged first, in this order; which
 *   of several other faults is named is not specified.
 * - Functions that return no status accept finite input, and pass NaN and infinity on.
 * - Nothing allocates, aborts, prints or keeps state between calls. Every function may be called
 *   from any number of threads at once, as long as no two of them write the same output.
 * - The caller's floating-point environment must round to nearest and keep subnormal numbers (the
 *   default of every C implementation). Then results are the same bits on every
 *   platform.
 */
#ifndef TRIBO_BASE_H
#define TRIBO_BASE_H

#include <stddef.h>
#include <stdint.h>

/** Version of these headers. Same major number: same ABI (while it is 0: same minor number). */
#define TRIBO_VERSION_MAJOR 0
#define TRIBO_VERSION_MINOR 1
#define TRIBO_VERSION_PATCH 0

#if defined(TRIBO_API)
/* set by the build */
#elif defined(_WIN32) && defined(TRIBO_BUILD)
#define TRIBO_API __declspec(dllexport)
#elif defined(_WIN32) && defined(TRIBO_DLL)
#define TRIBO_API __declspec(dllimport)
#elif defined(__GNUC__)
#define TRIBO_API __attribute__((visibility("default")))
#else
#define TRIBO_API
#endif

/* C99 inline: the header gives the body, one source file of the library the exported symbol. */
#if !defined(TRIBO_INLINE)
#define TRIBO_INLINE inline
#endif

#ifdef __cplusplus
extern "C" {
#endif

/** Outcome of a call. Numbers are pinned: they never change meaning, and gaps are for later
 *  ones. */
typedef int32_t tribo_status;

enum {
    TRIBO_OK = 0,
    TRIBO_ERROR_NULL = 10,        /**< a pointer that must not be null is null */
    TRIBO_ERROR_STRUCT_SIZE = 11, /**< struct_size is zero, odd or larger than this library knows */
    TRIBO_ERROR_OPTION = 12,      /**< an enumerated option has no such value */
    TRIBO_ERROR_INDEX = 13,       /**< an index lies outside of its array */
    TRIBO_ERROR_ISA = 14,         /**< the instruction set is not available on this machine */
    TRIBO_ERROR_NAME = 15,        /**< no entry has that name */
    TRIBO_ERROR_ALIAS = 16,       /**< two arguments that must differ are the same object */
    TRIBO_ERROR_CAPACITY = 17,    /**< the caller's buffer is too small; the size needed is told */
    TRIBO_ERROR_MEMORY = 18,      /**< a library beneath could not allocate */
    TRIBO_ERROR_DATA = 19,        /**< a block of data is not one that this library made */
    TRIBO_ERROR_NOT_FINITE = 20,  /**< an input is NaN or infinite */
    TRIBO_ERROR_RANGE = 21,       /**< a finite input or the result is outside of the stated
                                       range */
    TRIBO_ERROR_NORMAL = 22,      /**< the contact normal is not of unit length */
    TRIBO_ERROR_ORIENTATION = 23, /**< the quaternion is not of unit length */
    TRIBO_ERROR_FRAME = 24,       /**< the contact frame is not orthonormal and right-handed */
    TRIBO_ERROR_MASS = 30,        /**< mass or inverse mass is negative, or zero where it must not
                                       be */
    TRIBO_ERROR_INERTIA = 31,     /**< inertia is asymmetric, indefinite, or of no possible body */
    TRIBO_ERROR_SHAPE = 32,       /**< a length or density of a shape is not positive */
    TRIBO_ERROR_TIME_STEP = 33,   /**< the time step is negative, or too long to be resolved */
    TRIBO_ERROR_DEGENERATE = 34,  /**< points span no volume, or no triangle has an area */
    TRIBO_ERROR_SUPPORT = 35,     /**< a user's support function contradicts itself */
    TRIBO_ERROR_PAIR = 36,     /**< these two kinds of shapes cannot be tested against each other */
    TRIBO_ERROR_FRICTION = 40, /**< mu_s < 0, mu_d < 0, mu_s < mu_d, or a length of rolling or
                                    spinning resistance < 0 */
    TRIBO_ERROR_RESTITUTION = 41,    /**< e lies outside of [0, 1] (tangential: [-1, 1]) */
    TRIBO_ERROR_CONTACT_MATRIX = 50, /**< the contact matrix is not positive semidefinite */
    TRIBO_ERROR_IMMOVABLE = 51,      /**< neither body can move at the contact along the normal */
    TRIBO_ERROR_JAM = 52             /**< no bounded impulse satisfies Coulomb's law: the contact
                                          jams */
};

/** Name of a status, as written above ("TRIBO_ERROR_NULL"); "TRIBO_ERROR_UNKNOWN" for any other
 *  number. The string is static. */
TRIBO_API const char *tribo_status_name(tribo_status status);

/** One English sentence that says what is wrong; never null. The string is static. */
TRIBO_API const char *tribo_status_string(tribo_status status);

/** Version of the library that is linked, as major * 10000 + minor * 100 + patch. */
TRIBO_API uint32_t tribo_version(void);

/** The same as "major.minor.patch". The string is static. */
TRIBO_API const char *tribo_version_string(void);

#ifdef __cplusplus
}
#endif

#endif
