#include "survey.h"

#include <math.h>
#include <stdlib.h>

#include "cli.h"

/* Beyond this an impulse is outside of the cone, energy gained, restitution broken; without unit.
 */
static const double ROUNDING = 1e-9;

/* ---- contacts -------------------------------------------------------------------------------- */

/* xorshift64*, G. Marsaglia and S. Vigna: the same contacts at each run. */
static double uniform(uint64_t *state, double low, double high)
{
    *state ^= *state >> 12;
    *state ^= *state << 25;
    *state ^= *state >> 27;
    const uint64_t bits = (*state * UINT64_C(2685821657736338717)) >> 11;
    return low + (high - low) * ((double)bits / 9007199254740992.0);
}

static tribo_status random_box(uint64_t *state, tribo_body *box, double half[3])
{
    double mass, inertia[9], turn[3];

    for (int k = 0; k < 3; k++) {
        half[k] = uniform(state, 0.2, 1.0);
        turn[k] = uniform(state, -3.0, 3.0);
    }
    tribo_status status = tribo_body_init(box);
    if (status == TRIBO_OK)
        status = tribo_mass_box(1.0, half, &mass, inertia);
    if (status == TRIBO_OK)
        status = tribo_body_set_mass(box, mass, inertia);
    return status == TRIBO_OK ? tribo_quat_from_rotation_vector(turn, box->orientation) : status;
}

static tribo_status random_contact(uint64_t *state, double w[6], double u[3], tribo_material *pair)
{
    tribo_contact contact = {.normal = {0.0, 0.0, 1.0}};
    tribo_body box;
    double half[3], frame[9];

    tribo_status status = random_box(state, &box, half);
    if (status == TRIBO_OK)
        status = tribo_basis_from_normal(contact.normal, frame);
    /* The lowest corner, as on a floor: the one whose arm points down most. */
    double down[3];
    tribo_quat_rotate_inverse(box.orientation, contact.normal, down);
    for (int k = 0; k < 3; k++)
        half[k] = down[k] > 0.0 ? -half[k] : half[k];
    tribo_quat_rotate(box.orientation, half, contact.arm_a);
    if (status == TRIBO_OK)
        status = tribo_contact_matrix(&box, NULL, &contact, frame, w);
    u[0] = uniform(state, -1.0, -0.01);
    u[1] = uniform(state, -2.0, 2.0);
    u[2] = uniform(state, -2.0, 2.0);
    pair->mu_s = uniform(state, 0.0, 1.0);
    pair->mu_d = pair->mu_s * uniform(state, 0.5, 1.0);
    pair->e = uniform(state, 0.0, 1.0);
    return status;
}

tribo_status survey_make(survey_contacts *contacts)
{
    uint64_t state = UINT64_C(20240229);
    tribo_status status = TRIBO_OK;

    for (size_t i = 0; i < SURVEY_CONTACTS && status == TRIBO_OK; i++)
        status = random_contact(&state, contacts->w[i], contacts->u[i], &contacts->pairs[i]);
    return status;
}

/* ---- speed ----------------------------------------------------------------------------------- */

/* Seconds for all contacts, once. */
static double run_once(const survey_contacts *contacts, const tribo_impact_options *options)
{
    double p[3];
    const double start = cli_now(NULL);

    for (size_t i = 0; i < SURVEY_CONTACTS; i++)
        tribo_impact(contacts->w[i], contacts->u[i], &contacts->pairs[i], options, p, NULL);
    return cli_now(NULL) - start;
}

/* The least of at least three runs, and of as many as fit into a twentieth of a second. */
static double nanoseconds_per_call(const survey_contacts *contacts,
                                   const tribo_impact_options *options)
{
    double least = run_once(contacts, options), sum = least;

    for (int run = 1; run < 3 || sum < 0.05; run++) {
        const double seconds = run_once(contacts, options);
        least = fmin(least, seconds);
        sum += seconds;
    }
    return least * 1e9 / SURVEY_CONTACTS;
}

/* ---- errors ---------------------------------------------------------------------------------- */

static int compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;

    return (x > y) - (x < y);
}

static tribo_status judge(const survey_contacts *contacts, size_t i,
                          const tribo_impact_options *options, double *eta, survey_result *sums)
{
    const tribo_material *pair = &contacts->pairs[i];
    const double *u = contacts->u[i];
    tribo_impact_info info = {.struct_size = sizeof info};
    tribo_measures measures;
    double p[3];

    tribo_status status = tribo_impact(contacts->w[i], u, pair, options, p, &info);
    if (status == TRIBO_OK)
        status = tribo_audit_impact(contacts->w[i], u, pair, p, &measures);
    if (status != TRIBO_OK)
        return status;
    /* What a plastic frictionless impact would take: the energy that is at stake. */
    const double stake = 0.5 * u[0] * u[0] / contacts->w[i][0];
    *eta = measures.eta;
    sums->escapes += !tribo_cone_contains(p, pair->mu_s, ROUNDING);
    sums->gains += info.energy > ROUNDING * stake;
    sums->rebounds += fabs(measures.velocity) > ROUNDING;
    return TRIBO_OK;
}

tribo_status survey_law(uint32_t law, const survey_contacts *contacts, survey_result *result)
{
    const tribo_impact_options options = {.struct_size = sizeof options, .law = law};
    static double etas[SURVEY_CONTACTS];
    survey_result sums = {0};
    tribo_status status = TRIBO_OK;

    for (size_t i = 0; i < SURVEY_CONTACTS && status == TRIBO_OK; i++)
        status = judge(contacts, i, &options, &etas[i], &sums);
    qsort(etas, SURVEY_CONTACTS, sizeof etas[0], compare);
    *result = sums;
    result->median_eta = etas[SURVEY_CONTACTS / 2];
    result->greatest_eta = etas[SURVEY_CONTACTS - 1];
    result->escapes /= SURVEY_CONTACTS;
    result->gains /= SURVEY_CONTACTS;
    result->rebounds /= SURVEY_CONTACTS;
    if (status == TRIBO_OK)
        result->nanoseconds = nanoseconds_per_call(contacts, &options);
    return status;
}
