/**
 * @file dat.h
 * The text format of Siconos: numbers between white space, in local form (dimension, contacts, W,
 * q, mu) or global form (dimension, contacts, M, H, f, w, mu). Each matrix is dense, of sparse
 * blocks, or a listing by CSparse.
 */
#ifndef TRIBO_CLI_DAT_H
#define TRIBO_CLI_DAT_H

#include "recorded.h"

/** Read `length` bytes that end with one more, which is 0. Memory is bounded by 32 times the
 *  length.
 *  @return 0, or CLI_BAD_INPUT after a message with file, line and column; *out is to be freed in
 *          both cases */
int dat_read(const char *file, const char *bytes, size_t length, recorded *out);

#endif
