/**
 * @file collide.h
 * Pairs of shapes as text, one pair a line: SHAPE POSE SHAPE POSE, words between blanks.
 *
 * Lines without a word are no pairs. Numbers are decimal or hexadecimal, also "nan" and "inf",
 * which are judged by whoever gets them. Nothing is allocated but for the points and blocks of
 * hulls, and no more than the line has room for, whatever count it names.
 */
#ifndef TRIBO_CLI_COLLIDE_H
#define TRIBO_CLI_COLLIDE_H

#include <tribo/shape.h>

enum {
    COLLIDE_POINTS_AT_MOST = 1 << 24, /**< of a hull, as tribo_hull_build takes them */
    COLLIDE_BYTES_AT_MOST = 1024      /**< in a word */
};

/** A shape at its pose, and where they stand in the line (bytes, from 1). */
typedef struct collide_item {
    tribo_shape shape;
    tribo_pose pose;
    tribo_status built; /**< TRIBO_OK, or why there is no hull of these points */
    unsigned long shape_column, pose_column;
} collide_item;

/** A line. The blocks of its hulls last until the function that takes it returns. */
typedef struct collide_pair {
    const char *file;
    unsigned long line; /**< from 1 */
    collide_item items[2];
} collide_pair;

/** Takes a pair; returns 0 to go on, else the exit status to end with. */
typedef int (*collide_function)(void *user, const collide_pair *pair);

/** Read `file` ("-": standard input) and give each pair to `take`.
 *  @return 0; CLI_BAD_INPUT after a message with file, line and column; or what `take` returned. */
int collide_read(const char *file, collide_function take, void *user);

#endif
