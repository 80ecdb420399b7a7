/**
 * @file fclib.h
 * The HDF5 format of FCLib, local and global.
 */
#ifndef TRIBO_CLI_FCLIB_H
#define TRIBO_CLI_FCLIB_H

#include "recorded.h"

/** Whether these bytes are those of an HDF5 file. */
int fclib_recognise(const char *bytes, size_t length);

/** Read an HDF5 file of `length` bytes. libhdf5 does so in a process of its own with little memory
 *  and time, because it does not survive all files that are malformed.
 *  @return 0, or CLI_BAD_INPUT after a message with the file and the name in it; *out is to be
 *          freed in both cases */
int fclib_read(const char *file, const char *bytes, size_t length, recorded *out);

#endif
