#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli.h"
#include "toss.h"

static const double DEGREES = 57.295779513082320877; /* in a radian */

/* ---- fitting ------------------------------------------------------------------------------------
 *
 * Friction (one coefficient: a static one above the dynamic one earns nothing), restitution and
 * inertia by compass search (Kolda, Lewis & Torczon, SIAM Review 45 (2003) 385, algorithm 1) on a
 * lattice: the errors are as rough as the tosses are chaotic, so that derivatives mean nothing and
 * finer steps neither. What is made small is the mean of position errors in widths plus rotation
 * errors in radians. Errors of each toss are kept for each point, so that the search without a
 * fifth of the tosses mostly walks where the other searches have been. */

enum { FITTED = 3, FOLDS = 5, NO_FOLD = FOLDS, FIRST_STRIDE = 8 };

static const double UNITS[FITTED] = {0.0025, 0.0125, 0.005};
static const double STARTS[FITTED] = {0.18, 0.125, 0.2}; /* that come with the data */
static const double ENDS[FITTED] = {1.0, 1.0, 0.5};      /* 1/2: all mass in the corners */

typedef struct fit_point {
    int at[FITTED]; /* in units */
    toss_error *errors;
} fit_point;

typedef struct fit {
    const toss_data *data;
    const toss_options *start;
    fit_point *points;
    size_t count, room;
    double seconds;
    size_t steps;
} fit;

static void set_fitted(const int at[FITTED], toss_options *options)
{
    options->pair.mu_s = options->pair.mu_d = at[0] * UNITS[0];
    options->pair.e = at[1] * UNITS[1];
    options->inertia = at[2] * UNITS[2];
}

static int add_point(fit *f, const int at[FITTED])
{
    toss_options options = *f->start;
    toss_result result;

    if (f->count == f->room) {
        const size_t room = 2 * f->room + 64;
        fit_point *points = realloc(f->points, room * sizeof *points);
        if (points == NULL)
            return cli_error(CLI_BAD_INPUT, "%s", tribo_status_string(TRIBO_ERROR_MEMORY));
        f->points = points;
        f->room = room;
    }
    fit_point *point = f->points + f->count;
    memcpy(point->at, at, sizeof point->at);
    point->errors = calloc(f->data->tosses, sizeof *point->errors);
    if (point->errors == NULL)
        return cli_error(CLI_BAD_INPUT, "%s", tribo_status_string(TRIBO_ERROR_MEMORY));
    f->count++;
    set_fitted(at, &options);
    const int exit_status = toss_predict(f->data, &options, point->errors, &result);
    f->seconds += result.seconds;
    f->steps += result.steps;
    return exit_status;
}

/* Errors at a point, from the list or by prediction; null after a message. */
static const toss_error *errors_at(fit *f, const int at[FITTED])
{
    for (size_t i = 0; i < f->count; i++) {
        if (memcmp(f->points[i].at, at, sizeof f->points[i].at) == 0)
            return f->points[i].errors;
    }
    return add_point(f, at) == 0 ? f->points[f->count - 1].errors : NULL;
}

/* Sum over the tosses of the fold, or over all others; `count` receives how many. */
static toss_error sum_errors(const fit *f, const toss_error *errors, size_t fold, int inside,
                             size_t *count)
{
    toss_error sum = {0.0, 0.0};

    *count = 0;
    for (size_t i = 0; i < f->data->tosses; i++) {
        if ((i % FOLDS == fold) == inside) {
            sum.position += errors[i].position;
            sum.rotation += errors[i].rotation;
            ++*count;
        }
    }
    return sum;
}

static int cost_at(fit *f, const int at[FITTED], size_t fold, double *cost)
{
    const toss_error *errors = NULL;
    size_t count;

    *cost = HUGE_VAL;
    for (size_t k = 0; k < FITTED; k++) {
        if (at[k] < (k == 2) || at[k] * UNITS[k] > ENDS[k])
            return 0;
    }
    errors = errors_at(f, at);
    if (errors == NULL)
        return CLI_BAD_INPUT;
    const toss_error sum = sum_errors(f, errors, fold, 0, &count);
    *cost = (sum.position + sum.rotation / DEGREES) / (double)count;
    return 0;
}

/* The best point for all tosses but those of the fold. */
static int search(fit *f, size_t fold, int at[FITTED])
{
    double best, cost;
    int stride = FIRST_STRIDE;

    for (size_t k = 0; k < FITTED; k++)
        at[k] = (int)floor(STARTS[k] / UNITS[k] + 0.5);
    int exit_status = cost_at(f, at, fold, &best);
    while (exit_status == 0 && stride > 0) {
        int moved = 0;
        for (size_t way = 0; way < 2 * FITTED && exit_status == 0; way++) {
            int next[FITTED];
            memcpy(next, at, sizeof next);
            next[way / 2] += way % 2 == 0 ? stride : -stride;
            exit_status = cost_at(f, next, fold, &cost);
            if (cost < best) {
                best = cost;
                memcpy(at, next, sizeof next);
                moved = 1;
            }
        }
        stride = moved ? stride : stride / 2;
    }
    return exit_status;
}

static void print_point(const int at[FITTED], toss_error error)
{
    printf("mu %g restitution %g inertia %g position_error_widths %.6f rotation_error_deg %.6f\n",
           at[0] * UNITS[0], at[1] * UNITS[1], at[2] * UNITS[2], error.position, error.rotation);
}

static int fit_folds(fit *f)
{
    toss_error all = {0.0, 0.0};

    for (size_t fold = 0; fold < FOLDS; fold++) {
        int at[FITTED];
        size_t count;
        const int exit_status = search(f, fold, at);
        const toss_error *errors = exit_status == 0 ? errors_at(f, at) : NULL;
        if (errors == NULL)
            return CLI_BAD_INPUT;
        const toss_error sum = sum_errors(f, errors, fold, 1, &count);
        const toss_error mean = {sum.position / (double)count, sum.rotation / (double)count};
        printf("fold %zu held out %zu ", fold + 1, count);
        print_point(at, mean);
        all.position += sum.position / (double)f->data->tosses;
        all.rotation += sum.rotation / (double)f->data->tosses;
    }
    printf("held out mean position_error_widths %.6f rotation_error_deg %.6f\n", all.position,
           all.rotation);
    return 0;
}

static int fit_all(fit *f)
{
    int at[FITTED];
    size_t count;
    const int exit_status = search(f, NO_FOLD, at);
    const toss_error *errors = exit_status == 0 ? errors_at(f, at) : NULL;

    if (errors == NULL)
        return CLI_BAD_INPUT;
    const toss_error sum = sum_errors(f, errors, NO_FOLD, 0, &count);
    const toss_error mean = {sum.position / (double)count, sum.rotation / (double)count};
    printf("fitted to all %zu ", count);
    print_point(at, mean);
    return 0;
}

int toss_fit(const toss_data *data, const toss_options *start)
{
    fit f = {.data = data, .start = start};
    int exit_status = 0;

    if (data->tosses < 2 * FOLDS)
        return cli_error(CLI_BAD_INPUT, "%s: fitting needs at least %d tosses", data->file,
                         2 * FOLDS);
    exit_status = fit_folds(&f);
    if (exit_status == 0)
        exit_status = fit_all(&f);
    if (exit_status == 0)
        printf("points %zu us_per_step %.2f\n", f.count, f.seconds * 1e6 / (double)f.steps);
    for (size_t i = 0; i < f.count; i++)
        free(f.points[i].errors);
    free(f.points);
    return exit_status;
}

/* ---- comparing ------------------------------------------------------------------------------- */

typedef struct toss_choice {
    const char *name;
    void (*take)(toss_options *options);
} toss_choice;

static void take_nothing(toss_options *o)
{
    (void)o;
}

static void take_plastic(toss_options *o)
{
    o->pair.e = 0.0;
}

static void take_bouncy(toss_options *o)
{
    o->pair.e *= 2.0;
}

static void take_smooth(toss_options *o)
{
    o->pair.mu_s = o->pair.mu_d *= 15.0 / 16.0;
}

static void take_rough(toss_options *o)
{
    o->pair.mu_s = o->pair.mu_d *= 17.0 / 16.0;
}

static void take_static(toss_options *o)
{
    o->pair.mu_s = 1.25 * o->pair.mu_d;
}

static void take_stated_inertia(toss_options *o)
{
    o->inertia = 0.199;
}

static void take_hollow(toss_options *o)
{
    o->inertia = 5.0 / 18.0;
}

static void take_lengths(toss_options *o)
{
    o->scale = 1.0;
}

static void take_velocities(toss_options *o)
{
    o->lag = 0.0;
}

static void take_air(toss_options *o)
{
    o->drag = 0.041;
}

static void take_threshold(toss_options *o)
{
    o->step.threshold = 0.3;
}

static void take_one_substep(toss_options *o)
{
    o->step.substeps = 1;
}

static void take_many_substeps(toss_options *o)
{
    o->step.substeps = 12;
}

static void take_no_speculation(toss_options *o)
{
    o->step.skip |= TRIBO_SKIP_SPECULATION;
}

static void take_step_0(toss_options *o)
{
    o->from = 0;
}

static void take_step_1(toss_options *o)
{
    o->from = 1;
}

static void take_step_4(toss_options *o)
{
    o->from = TOSS_FROM_AT_MOST;
}

static const toss_choice CHOICES[] = {{"as by the options", take_nothing},
                                      {"no restitution", take_plastic},
                                      {"twice the restitution", take_bouncy},
                                      {"friction 1/16 less", take_smooth},
                                      {"friction 1/16 more", take_rough},
                                      {"static friction 1/4 above dynamic", take_static},
                                      {"inertia as stated, 0.199", take_stated_inertia},
                                      {"inertia of a box with thin walls", take_hollow},
                                      {"lengths as in the file", take_lengths},
                                      {"velocities as in the file", take_velocities},
                                      {"drag of air, 0.041 / m", take_air},
                                      {"impacts below 0.3 m/s plastic", take_threshold},
                                      {"1 sub-step", take_one_substep},
                                      {"12 sub-steps", take_many_substeps},
                                      {"contacts only once surfaces met", take_no_speculation},
                                      {"from step 0", take_step_0},
                                      {"from step 1", take_step_1},
                                      {"from step 4", take_step_4}};

int toss_compare(const toss_data *data, const toss_options *options)
{
    int exit_status = 0;

    printf(
        "  choice                              position error   rotation error   time per step\n"
        "                                              widths          degrees              us\n");
    for (size_t i = 0; i < sizeof CHOICES / sizeof CHOICES[0] && exit_status == 0; i++) {
        toss_options other = *options;
        toss_result result;
        CHOICES[i].take(&other);
        exit_status = toss_predict(data, &other, NULL, &result);
        if (exit_status == 0)
            printf("  %-34s  %14.3f  %15.2f  %14.2f\n", CHOICES[i].name, result.error.position,
                   result.error.rotation, result.seconds * 1e6 / (double)result.steps);
    }
    return exit_status;
}
