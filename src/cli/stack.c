#define _POSIX_C_SOURCE 200809L

#include "stack.h"

#include <dirent.h>
#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <tribo/sparse.h>

#include "cli.h"
#include "problem.h"

const char *const stack_names[STACK_CURVES] = {"Gauss-Seidel", "Newton", "automatic"};
const uint64_t stack_sweeps[STACK_POINTS] = {1, 3, 10, 30, 100, 300, 1000};
const double stack_tolerances[STACK_POINTS] = {1e-1, 1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12};

static const uint32_t SOLVERS[STACK_CURVES] = {TRIBO_SOLVER_GAUSS_SEIDEL, TRIBO_SOLVER_NEWTON,
                                               TRIBO_SOLVER_AUTO};

/* ---- scenes ---------------------------------------------------------------------------------- */

enum { BOXES = 10, COLUMNS = 8, ROWS = 8, MOST_BODIES = 80, MOST_CONTACTS = 512 };

static const double FALL = 9.81 / 60.0; /* g dt, m/s */
static const double FRICTION = 0.5;

typedef struct stack_scene {
    size_t body_count, count;
    double mass; /* of all bodies, kg */
    tribo_body bodies[MOST_BODIES];
    tribo_system_contact contacts[MOST_CONTACTS];
} stack_scene;

/* A box that gravity has acted on. */
static tribo_status add_box(stack_scene *scene, const double half[3], double density,
                            const double position[3])
{
    tribo_body *box = &scene->bodies[scene->body_count++];
    double mass = 0.0, inertia[9];

    tribo_status status = tribo_body_init(box);
    if (status == TRIBO_OK)
        status = tribo_mass_box(density, half, &mass, inertia);
    if (status == TRIBO_OK)
        status = tribo_body_set_mass(box, mass, inertia);
    memcpy(box->position, position, sizeof box->position);
    box->velocity[2] = -FALL;
    scene->mass += mass;
    return status;
}

/* Four contacts of the last box on b, at the corners of a rectangle: from left to right, 1 m deep.
 */
static void add_corners(stack_scene *scene, uint32_t b, double left, double right)
{
    const uint32_t a = (uint32_t)(scene->body_count - 1);
    const double *x = scene->bodies[a].position;

    for (int i = 0; i < 4; i++) {
        tribo_system_contact *c = &scene->contacts[scene->count++];
        const double corner[3] = {i % 2 == 0 ? left : right, i < 2 ? -0.5 : 0.5, x[2] - 0.5};
        *c = (tribo_system_contact){.a = a,
                                    .b = b,
                                    .dimension = 3,
                                    .contact.normal = {0.0, 0.0, 1.0},
                                    .pair = {FRICTION, FRICTION, 0.0}};
        tribo_vec3_subtract(corner, x, c->contact.arm_a);
        if (b != TRIBO_WORLD)
            tribo_vec3_subtract(corner, scene->bodies[b].position, c->contact.arm_b);
    }
}

/* Cubes of 1 m and 1 kg, but for the top one. */
static tribo_status make_tower(double top_mass, stack_scene *scene)
{
    static const double half[3] = {0.5, 0.5, 0.5};
    tribo_status status = TRIBO_OK;

    for (uint32_t i = 0; i < BOXES && status == TRIBO_OK; i++) {
        const double position[3] = {0.0, 0.0, i + 0.5};
        status = add_box(scene, half, i + 1 == BOXES ? top_mass : 1.0, position);
        add_corners(scene, i == 0 ? TRIBO_WORLD : i - 1, -0.5, 0.5);
    }
    return status;
}

static tribo_status tower(stack_scene *scene)
{
    return make_tower(1.0, scene);
}

static tribo_status heavy_tower(stack_scene *scene)
{
    return make_tower(1000.0, scene);
}

/* Each box goes its own way, turned from that of the one below by the golden angle, and spins the
 * other way round. */
static tribo_status sliding_tower(stack_scene *scene)
{
    const tribo_status status = make_tower(1.0, scene);

    for (size_t i = 0; i < BOXES; i++) {
        const double angle = 2.3999632297286533 * (double)i;
        scene->bodies[i].velocity[0] = cos(angle);
        scene->bodies[i].velocity[1] = sin(angle);
        scene->bodies[i].angular_velocity[2] = i % 2 == 0 ? 2.0 : -2.0;
    }
    return status;
}

/* Where brick k of a row begins. Odd rows begin and end with half a brick. */
static double joint(unsigned row, unsigned k)
{
    return fmin(fmax(2.0 * k - row % 2, 0.0), 2.0 * COLUMNS);
}

/* Bricks of 2 x 1 x 1 m and 1 kg, in rows, each over the joints of the row below. */
static tribo_status wall(stack_scene *scene)
{
    tribo_status status = TRIBO_OK;

    for (unsigned row = 0, below = 0, first = 0; row < ROWS; row++, below = first) {
        first = (unsigned)scene->body_count;
        for (unsigned k = 0; k < COLUMNS + row % 2 && status == TRIBO_OK; k++) {
            const double left = joint(row, k), right = joint(row, k + 1);
            const double half[3] = {0.5 * (right - left), 0.5, 0.5};
            const double position[3] = {0.5 * (left + right), 0.0, row + 0.5};
            status = add_box(scene, half, 0.5, position);
            if (row == 0)
                add_corners(scene, TRIBO_WORLD, left, right);
            for (unsigned i = below; i < first; i++) {
                const double low = fmax(left, joint(row - 1, i - below));
                const double high = fmin(right, joint(row - 1, i - below + 1));
                if (low < high)
                    add_corners(scene, i, low, high);
            }
        }
    }
    return status;
}

static const struct {
    const char *title;
    uint32_t rests;
    tribo_status (*make)(stack_scene *scene);
} SCENES[STACK_SCENES] = {{"tower of 10 boxes at rest", 1, tower},
                          {"the same under a box of 1000:1", 1, heavy_tower},
                          {"tower of 10 boxes, sliding and spinning", 0, sliding_tower},
                          {"wall of bricks at rest", 1, wall}};

/* ---- solves ---------------------------------------------------------------------------------- */

/* One of both forms; the other is null. */
typedef struct stack_task {
    const stack_scene *scene;
    const problem *given;
    double *impulses;
} stack_task;

static tribo_status workspace_size(const stack_task *task, const tribo_system_options *options,
                                   size_t *size)
{
    const stack_scene *scene = task->scene;
    const problem *given = task->given;

    if (scene != NULL)
        return tribo_system_workspace_size(scene->body_count, scene->count, scene->contacts,
                                           options, size);
    return tribo_system_assembled_workspace_size(given->count, given->row_starts, given->columns,
                                                 options, size);
}

static tribo_status solve(const stack_task *task, const tribo_system_options *options,
                          void *workspace, size_t size, tribo_system_info *info)
{
    const stack_scene *scene = task->scene;
    const problem *given = task->given;

    if (scene != NULL)
        return tribo_system_solve(scene->body_count, scene->bodies, scene->count, scene->contacts,
                                  options, workspace, size, task->impulses, NULL, info);
    return tribo_system_solve_assembled(given->count, given->row_starts, given->columns,
                                        given->blocks, given->q, given->mu, options, workspace,
                                        size, task->impulses, NULL, info);
}

/* A workspace that lasts for all runs, made at the first. */
typedef struct stack_memory {
    void *workspace;
    size_t size;
} stack_memory;

static tribo_status reserve(const stack_task *task, const tribo_system_options *options,
                            stack_memory *memory)
{
    if (memory->workspace != NULL)
        return TRIBO_OK;
    const tribo_status status = workspace_size(task, options, &memory->size);
    if (status == TRIBO_OK)
        memory->workspace = malloc(memory->size + 1);
    return status == TRIBO_OK && memory->workspace == NULL ? TRIBO_ERROR_MEMORY : status;
}

/* With nothing kept from any solve before: the analysis of patterns is part of the time. */
static tribo_status solve_afresh(const stack_task *task, const tribo_system_options *given,
                                 stack_memory *memory, tribo_system_info *info)
{
    tribo_system_options options = *given;
    tribo_linear linear = {.struct_size = sizeof linear};
    tribo_sparse *sparse = NULL;
    tribo_status status = tribo_sparse_create(TRIBO_SPARSE_AUTO, NULL, &sparse);

    options.linear = &linear;
    options.clock = cli_now;
    if (status == TRIBO_OK)
        status = tribo_sparse_linear(sparse, &linear);
    if (status == TRIBO_OK)
        status = reserve(task, &options, memory);
    if (status == TRIBO_OK)
        status = solve(task, &options, memory->workspace, memory->size, info);
    tribo_sparse_destroy(sparse);
    return status;
}

/* The least time of at least three runs, and of as many as fit into 5 ms. */
static tribo_status measure(const stack_task *task, const tribo_system_options *options,
                            tribo_system_info *info)
{
    stack_memory memory = {0};
    double least = HUGE_VAL, sum = 0.0;
    tribo_status status = TRIBO_OK;

    *info = (tribo_system_info){.struct_size = sizeof *info};
    for (int run = 0; (run < 3 || sum < 0.005) && status == TRIBO_OK; run++) {
        status = solve_afresh(task, options, &memory, info);
        least = fmin(least, info->seconds);
        sum += info->seconds;
    }
    info->seconds = least;
    free(memory.workspace);
    return status;
}

/* ---- scenes by each solver ------------------------------------------------------------------- */

static double load_error(const stack_scene *scene, const double *impulses)
{
    const double weight = scene->mass * FALL;
    double load = 0.0;

    for (size_t i = 0; i < scene->count; i++)
        load += scene->contacts[i].b == TRIBO_WORLD ? impulses[3 * i] : 0.0;
    return fabs(load - weight) / weight;
}

static tribo_status run_scene(const stack_scene *scene, stack_result *result)
{
    static double impulses[3 * MOST_CONTACTS];
    const stack_task task = {.scene = scene, .impulses = impulses};
    tribo_status status = TRIBO_OK;

    result->contacts = scene->count;
    for (int i = 0; i < STACK_CURVES * STACK_POINTS && status == TRIBO_OK; i++) {
        const int curve = i / STACK_POINTS, k = i % STACK_POINTS;
        const int by_sweeps = SOLVERS[curve] == TRIBO_SOLVER_GAUSS_SEIDEL;
        tribo_system_options options = {.struct_size = sizeof options};
        options.solver = SOLVERS[curve];
        options.tolerance = by_sweeps ? DBL_EPSILON : stack_tolerances[k];
        options.max_iterations = by_sweeps ? stack_sweeps[k] : 0;
        stack_point *point = &result->points[curve][k];
        status = measure(&task, &options, &point->info);
        point->load_error = load_error(scene, impulses);
    }
    return status;
}

tribo_status stack_survey(stack_result results[STACK_SCENES])
{
    tribo_status status = TRIBO_OK;

    for (int i = 0; i < STACK_SCENES && status == TRIBO_OK; i++) {
        static stack_scene scene;
        scene = (stack_scene){0};
        results[i] = (stack_result){.title = SCENES[i].title, .rests = SCENES[i].rests};
        status = SCENES[i].make(&scene);
        if (status == TRIBO_OK)
            status = run_scene(&scene, &results[i]);
    }
    return status;
}

/* ---- recorded problems ----------------------------------------------------------------------- */

enum { FEW = 20, TOLERANCES = 3, PATH_AT_MOST = 4096 };

static int print_recorded(const char *path, const char *name, const problem *given)
{
    static const double tolerances[TOLERANCES] = {1e-3, 1e-6, 1e-9};
    double *impulses = malloc(3 * given->count * sizeof *impulses);
    const stack_task task = {.given = given, .impulses = impulses};
    tribo_status status = impulses == NULL ? TRIBO_ERROR_MEMORY : TRIBO_OK;
    tribo_system_info infos[TOLERANCES];

    for (int i = 0; i < TOLERANCES && status == TRIBO_OK; i++) {
        tribo_system_options options = {.struct_size = sizeof options};
        options.measure = TRIBO_MEASURE_INVARIANT;
        options.tolerance = tolerances[i];
        status = measure(&task, &options, &infos[i]);
    }
    free(impulses);
    if (status != TRIBO_OK)
        return cli_error(CLI_BAD_INPUT, "%s: %s: %s", path, tribo_status_name(status),
                         tribo_status_string(status));
    printf("  %-36s  %8zu  %8.1e", name, given->count, infos[TOLERANCES - 1].invariant);
    for (int i = 0; i < TOLERANCES; i++) {
        if (infos[i].stop == TRIBO_STOP_TOLERANCE)
            printf("  %9.3f", 1e3 * infos[i].seconds);
        else
            printf("  %9s", "-");
    }
    putchar('\n');
    return 0;
}

static int run_recorded(const char *data, const char *name)
{
    char path[PATH_AT_MOST];
    const int length = snprintf(path, sizeof path, "%s/fc/%s", data, name);
    problem given;

    if (length < 0 || length >= PATH_AT_MOST)
        return cli_error(CLI_BAD_INPUT, "TRIBO_DATA: the path is too long");
    int exit_status = problem_read(path, &given);
    if (exit_status != 0)
        return exit_status;
    if (given.count > FEW)
        exit_status = print_recorded(path, name, &given);
    problem_free(&given);
    return exit_status;
}

static int is_problem(const struct dirent *entry)
{
    const char *dot = strrchr(entry->d_name, '.');

    return dot != NULL && (strcmp(dot, ".dat") == 0 || strcmp(dot, ".hdf5") == 0);
}

int stack_recorded(const char *data)
{
    char path[PATH_AT_MOST];
    const int length = snprintf(path, sizeof path, "%s/fc", data);
    struct dirent **entries = NULL;
    int exit_status = 0;

    if (length < 0 || length >= PATH_AT_MOST)
        return cli_error(CLI_BAD_INPUT, "TRIBO_DATA: the path is too long");
    const int count = scandir(path, &entries, is_problem, alphasort);
    if (count < 0)
        return cli_error(CLI_BAD_INPUT, "%s: %s", path, strerror(errno));
    printf("\nRecorded problems of more than %d contacts by the automatic choice: time for an "
           "error e_inv\n\n"
           "  problem                               contacts     e_inv   ms: 1e-3       1e-6       "
           "1e-9\n",
           (int)FEW);
    for (int i = 0; i < count; i++) {
        if (exit_status == 0)
            exit_status = run_recorded(data, entries[i]->d_name);
        free(entries[i]);
    }
    free(entries);
    if (exit_status == 0)
        puts("  e_inv: |s r - P_K(s r - u')| / |q|, s the mean diagonal entry of W; the column is "
             "that of 1e-9.\n"
             "  -: not reached.");
    return exit_status;
}
