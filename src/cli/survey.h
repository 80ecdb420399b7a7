/**
 * @file survey.h
 * The impact laws on the same random contacts: what a call costs, and how far its answer is from
 * Coulomb's law.
 */
#ifndef TRIBO_CLI_SURVEY_H
#define TRIBO_CLI_SURVEY_H

#include <tribo/tribo.h>

enum { SURVEY_CONTACTS = 4096 };

/** Corners of random boxes on the floor, with random velocities and coefficients. */
typedef struct survey_contacts {
    double w[SURVEY_CONTACTS][6];
    double u[SURVEY_CONTACTS][3];
    tribo_material pairs[SURVEY_CONTACTS];
} survey_contacts;

/** One law on all of them. Shares are of the contacts, 0 to 1. */
typedef struct survey_result {
    double nanoseconds; /**< per call; least of several runs */
    double median_eta, greatest_eta;
    double escapes;  /**< share of impulses outside of the cone of static friction */
    double gains;    /**< share of impacts that make energy */
    double rebounds; /**< share of impacts that break Newton's restitution */
} survey_result;

/** @return TRIBO_OK or the status of the library function that failed. */
tribo_status survey_make(survey_contacts *contacts);
tribo_status survey_law(uint32_t law, const survey_contacts *contacts, survey_result *result);

#endif
