/**
 * @file toss.h
 * Predict measured tosses of a cube onto a board from the first state of each.
 */
#ifndef TRIBO_CLI_TOSS_H
#define TRIBO_CLI_TOSS_H

#include <tribo/tribo.h>

/** How impacts go. */
typedef struct toss_options {
    tribo_material pair;
    uint32_t law;  /**< TRIBO_LAW_... */
    int each_toss; /**< write a line for each toss to standard output */
} toss_options;

/** Means over all tosses of the means over the steps of a toss. */
typedef struct toss_result {
    unsigned long tosses, steps;
    double position_error; /**< widths of the cube */
    double rotation_error; /**< degrees */
    double seconds;        /**< processor time of the predictions alone */
} toss_result;

/** The coefficients and the law that predict the measured tosses best. */
toss_options toss_defaults(void);

/** Predict all tosses in `file` ("-": standard input); 0 or an exit status after a message. */
int toss_predict(const char *file, const toss_options *options, toss_result *result);

#endif
