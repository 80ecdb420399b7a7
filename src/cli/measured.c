#include "measured.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "cli.h"
#include "problem.h"
#include "toss.h"

enum { PATH_AT_MOST = 4096 };

/* Those of the collection that have one contact. */
static const char *const PROBLEMS[] = {"FrictionContact3D_1c", "FrictionContact3D_RR_1c",
                                       "Rover11035",           "Rover11211",
                                       "GFC3D_Example0",       "GFC3D_Example0_SBM",
                                       "GFC3D_Example00",      "GFC3D_Example00_badly_scaled",
                                       "GFC3D_Example1",       "GFC3D_OneContact"};

static int make_path(char path[PATH_AT_MOST], const char *data, const char *folder,
                     const char *name, const char *extension)
{
    const int length = snprintf(path, PATH_AT_MOST, "%s/%s/%s%s", data, folder, name, extension);

    if (length < 0 || length >= PATH_AT_MOST)
        return cli_error(CLI_BAD_INPUT, "TRIBO_DATA: the path is too long");
    return 0;
}

static int run_tosses(const char *data)
{
    const toss_options options = toss_defaults();
    char path[PATH_AT_MOST];
    toss_data tosses;
    int exit_status = make_path(path, data, "cube_tosses", "tosses", ".csv");

    if (exit_status == 0)
        exit_status = toss_read(path, TOSS_FROM_AT_MOST, &tosses);
    if (exit_status != 0)
        return exit_status;
    printf("\n%zu measured tosses of a cube, predicted by a scene from state %u of each (mu %g, e "
           "%g)\n\n",
           tosses.tosses, (unsigned)options.from, options.pair.mu_s, options.pair.e);
    exit_status = toss_compare(&tosses, &options);
    toss_free(&tosses);
    return exit_status;
}

/* The natural map |s p - P_K(s p - u')| / |q|, u' = u + mu |u_t| e_n, s = tr(W) / 3. */
static double natural_map(const double w[9], const double q[3], double mu, const double p[3])
{
    const double sigma = (w[0] + w[4] + w[8]) / 3.0;
    const double size = tribo_vec3_norm(q);
    double u[3], moved[3], projected[3];

    tribo_mat3_apply(w, p, u);
    tribo_vec3_add(u, q, u);
    const double slip[3] = {u[1], u[2], 0.0};
    u[0] += mu * tribo_vec3_norm(slip);
    tribo_vec3_scale(sigma, p, moved);
    tribo_vec3_subtract(moved, u, moved);
    if (tribo_cone_project(moved, mu, projected) != TRIBO_OK || size == 0.0)
        return size == 0.0 ? 0.0 : (double)NAN;
    tribo_vec3_scale(sigma, p, moved);
    tribo_vec3_subtract(moved, projected, moved);
    return tribo_vec3_norm(moved) / size;
}

static int solve_problem(const char *path, const char *name, const problem *given)
{
    const double *w = given->blocks, *q = given->q, mu = given->mu[0];
    const double half[6] = {w[0], w[1], w[2], w[4], w[5], w[8]};
    const int general = w[1] != w[3] || w[2] != w[6] || w[5] != w[7];
    tribo_solve_info info = {.struct_size = sizeof info};
    double p[3];

    if (given->count != 1)
        return cli_error(CLI_BAD_INPUT, "%s: %zu contacts instead of 1", path, given->count);
    const tribo_status status = general ? tribo_contact_solve_general(w, q, mu, mu, p, &info)
                                        : tribo_contact_solve(half, q, mu, mu, p, &info);
    if (status != TRIBO_OK) {
        printf("  %-28s  %s\n", name, tribo_status_name(status));
        return cli_error(CLI_BAD_INPUT, "%s: %s", path, tribo_status_string(status));
    }
    printf("  %-28s  %-9s  %-5s  %11.4g %11.4g %11.4g  %9.1e\n", name,
           general ? "general" : "symmetric", cli_mode_name(info.mode), p[0], p[1], p[2],
           natural_map(w, q, mu, p));
    return 0;
}

static int run_problem(const char *data, const char *name)
{
    char path[PATH_AT_MOST];
    problem given;
    int exit_status = make_path(path, data, "fc", name, ".dat");

    if (exit_status == 0)
        exit_status = problem_read(path, &given);
    if (exit_status != 0)
        return exit_status;
    exit_status = solve_problem(path, name, &given);
    problem_free(&given);
    return exit_status;
}

int measured_run(const char *data)
{
    int exit_status = run_tosses(data);

    if (exit_status != 0)
        return exit_status;
    puts("\nRecorded problems of one contact, solved exactly; the error is the natural map over "
         "|q|\n\n"
         "  problem                       W          mode            pn          p1          p2    "
         "  error");
    for (size_t i = 0; i < sizeof PROBLEMS / sizeof PROBLEMS[0] && exit_status == 0; i++)
        exit_status = run_problem(data, PROBLEMS[i]);
    return exit_status;
}
