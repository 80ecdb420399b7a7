/**
 * @file toss.h
 * Measured tosses of a cube onto a board, predicted by a scene from one measured state of each.
 */
#ifndef TRIBO_CLI_TOSS_H
#define TRIBO_CLI_TOSS_H

#include <stddef.h>

#include <tribo/scene.h>

/** Columns of a row, in this order. */
enum { TOSS_NUMBER = 0, TOSS_STEP = 1, TOSS_Q = 2, TOSS_P = 6, TOSS_W = 9, TOSS_V = 12 };
enum { TOSS_COLUMNS = 15 };

/** A measured state. */
typedef struct toss_row {
    double values[TOSS_COLUMNS];
} toss_row;

/** All tosses of a file; toss i has the rows starts[i] to starts[i + 1] - 1. */
typedef struct toss_data {
    toss_row *rows;
    size_t *starts;
    size_t tosses, count, rows_room, starts_room;
    const char *file;
} toss_data;

/** The cube, the board, the file, and how they are simulated. */
typedef struct toss_options {
    tribo_material pair;
    double inertia; /**< moment of inertia over mass width^2: 1/6 solid, 5/18 thin walls */
    double scale;   /**< true length over length in the file */
    double lag;     /**< age of the velocities in the file, steps */
    double drag;    /**< of the air: deceleration over speed^2, 1/m */
    uint32_t from;  /**< step that prediction starts from; the toss's first is 0 */
    tribo_step_options step;
} toss_options;

/** Of one toss: means over the steps after the one that prediction starts from. */
typedef struct toss_error {
    double position; /**< widths of the cube */
    double rotation; /**< degrees */
} toss_error;

/** Means over tosses. */
typedef struct toss_result {
    size_t tosses, steps;
    toss_error error;
    double seconds; /**< of the steps alone */
} toss_result;

/** The greatest `from` of toss_compare. */
enum { TOSS_FROM_AT_MOST = 4 };

/** What predicts the measured tosses best, in the order of fitting: see toss_predict.c. */
toss_options toss_defaults(void);

/** Read `file` ("-": standard input). Each toss must have a step after step `from`.
 *  @return 0, or an exit status after a message. */
int toss_read(const char *file, uint32_t from, toss_data *data);

void toss_free(toss_data *data);

/** Predict all tosses.
 *  @param errors receives those of each toss; may be null
 *  @return 0, or an exit status after a message. */
int toss_predict(const toss_data *data, const toss_options *options, toss_error *errors,
                 toss_result *result);

/** Fit friction, restitution and inertia, and print what is found, also with a fifth of the tosses
 * kept aside in turn. */
int toss_fit(const toss_data *data, const toss_options *start);

/** Print what each choice of the model is worth: a line for each other choice. */
int toss_compare(const toss_data *data, const toss_options *options);

#endif
