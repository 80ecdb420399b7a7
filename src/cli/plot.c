#define _POSIX_C_SOURCE 200809L

#include "plot.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli.h"

/* Colours that the colour-blind can tell apart (Okabe and Ito), point types, dashes and widths by
 * law. */
typedef struct plot_style {
    const char *colour;
    int point, dash;
    double width;
} plot_style;

static const plot_style STYLES[CLI_LAWS] = {{"#0072B2", 7, 1, 3.0},  {"#888888", 3, 1, 1.6},
                                            {"#D55E00", 8, 1, 1.6},  {"#000000", 4, 1, 1.6},
                                            {"#009E73", 12, 1, 3.2}, {"#CC79A7", 10, 1, 1.6},
                                            {"#56B4E9", 6, 2, 2.2},  {"#E69F00", 2, 1, 1.6}};

/* ---- gnuplot --------------------------------------------------------------------------------- */

int plot_available(void)
{
    return system("command -v gnuplot >/dev/null 2>&1") == 0;
}

/* gnuplot ends its strings in single quotes; a quote inside is written twice. */
static void put_quoted(FILE *gnuplot, const char *text)
{
    for (; *text != '\0'; text++) {
        fputc(*text, gnuplot);
        if (*text == '\'')
            fputc('\'', gnuplot);
    }
}

static FILE *begin_plot(const char *folder, const char *name, int width, int height)
{
    FILE *gnuplot = popen("LC_ALL=C.UTF-8 gnuplot", "w"); /* whatever the user's own locale */

    if (gnuplot == NULL) {
        cli_error(CLI_BAD_INPUT, "gnuplot: %s", strerror(errno));
        return NULL;
    }
    fprintf(
        gnuplot,
        "set encoding utf8\n"
        "set terminal svg size %d,%d dynamic enhanced font 'Helvetica,15' background '#ffffff'\n"
        "set output '",
        width, height);
    put_quoted(gnuplot, folder);
    fprintf(gnuplot, "/%s'\n", name);
    fputs("set border linecolor '#444444'\n"
          "set grid linecolor '#dddddd' linetype 1 linewidth 0.7\n"
          "set tics nomirror textcolor '#222222'\n"
          "set key noautotitle\n",
          gnuplot);
    return gnuplot;
}

static int end_plot(FILE *gnuplot, const char *name)
{
    const int failed = ferror(gnuplot);

    if (pclose(gnuplot) != 0 || failed)
        return cli_error(CLI_BAD_INPUT, "gnuplot could not draw %s", name);
    return 0;
}

/* ---- the throws ------------------------------------------------------------------------------ */

static void put_path(FILE *gnuplot, const throw_record *record, unsigned first, unsigned last)
{
    for (unsigned frame = first; frame <= last; frame++) {
        const double *x = record->path[frame].position;
        fprintf(gnuplot, "%.5g %.5g %.5g\n", x[0], x[1], x[2]);
    }
    fputs("END\n", gnuplot);
}

/* The flight that all have in common, and the paths after it. */
static void put_paths(FILE *gnuplot, const throw_record *records)
{
    fputs("$flight << END\n", gnuplot);
    put_path(gnuplot, records, 0, records->first_frame);
    for (int law = 0; law < CLI_LAWS; law++) {
        fprintf(gnuplot, "$path%d << END\n", law);
        put_path(gnuplot, &records[law], records->first_frame, THROW_FRAMES - 1);
    }
}

/* Outlines are drawn at these intervals, so that the last one shows the box at rest. */
enum { OUTLINE_FRAMES = 63 };

/* The twelve edges of the box at some times, as pairs of points. */
static void put_outlines(FILE *gnuplot, const throw_record *record, const double half[3])
{
    fputs("$outlines << END\n", gnuplot);
    for (int frame = 0; frame < THROW_FRAMES; frame += OUTLINE_FRAMES) {
        const tribo_body *box = &record->path[frame];
        for (unsigned edge = 0; edge < 24; edge++) {
            /* Corner `corner` and the one across axis `axis`; each edge once. */
            const unsigned corner = edge % 8, axis = edge / 8;
            if ((corner >> axis & 1u) != 0)
                continue;
            for (unsigned end = 0; end < 2; end++) {
                double local[3], x[3];
                for (unsigned k = 0; k < 3; k++) {
                    const unsigned bits = corner | end << axis;
                    local[k] = (bits >> k & 1u) != 0 ? half[k] : -half[k];
                }
                tribo_quat_rotate(box->orientation, local, x);
                tribo_vec3_add(box->position, x, x);
                fprintf(gnuplot, "%.5g %.5g %.5g\n", x[0], x[1], x[2]);
            }
            fputc('\n', gnuplot);
        }
    }
    fputs("END\n", gnuplot);
}

/* `columns` are the two coordinates that are shown; titles make the legend. */
static void plot_paths(FILE *gnuplot, const char *columns, int titles)
{
    fprintf(gnuplot, "plot $outlines using %s with lines linecolor '#b8cfe0' linewidth 0.8",
            columns);
    for (int law = 0; law < CLI_LAWS; law++) {
        const plot_style *style = &STYLES[law];
        fprintf(gnuplot,
                ", $path%d using %s with lines linecolor '%s' dashtype %d linewidth %g title '%s'",
                law, columns, style->colour, style->dash, style->width,
                titles ? cli_law_names[law] : "");
    }
    fprintf(gnuplot, ", $flight using %s with lines linecolor '#333333' linewidth 2.5\n", columns);
}

int plot_throws(const char *folder, const char *name, const throw_record *records)
{
    FILE *gnuplot = begin_plot(folder, name, 1100, 941);
    const tumble scene = throw_scene(TRIBO_LAW_ALGEBRAIC);

    if (gnuplot == NULL)
        return CLI_BAD_INPUT;
    put_paths(gnuplot, records);
    put_outlines(gnuplot, &records[TRIBO_LAW_ALGEBRAIC], scene.half);
    /* Both panels have 450 pixels to the metre. */
    fputs("set multiplot\n"
          "set lmargin at screen 0.08\nset rmargin at screen 0.98\n"
          "set xrange [-0.15:2.05]\nset xtics 0.2\nset ytics 0.2\n"
          "set label 2 'One box, thrown with spin: the path of its centre under each impact law'"
          " at screen 0.53,0.965 center font ',19'\n"
          "set key at screen 0.53,0.9 center center horizontal maxrows 2 samplen 2.5 width -1\n"
          "set bmargin at screen 0.5857\nset tmargin at screen 0.8630\n"
          "set ylabel 'height z / m' offset 1\nset yrange [-0.03:0.55]\nset format x ''\n"
          "set label 1 'from the side' at graph 0.985,0.92 right textcolor '#444444'\n"
          "set arrow 1 from graph 0,first 0 to graph 1,first 0 nohead linecolor '#444444' "
          "linewidth 2\n",
          gnuplot);
    plot_paths(gnuplot, "1:3", 1);
    fputs("unset label 2\nunset arrow 1\nset format x '%g'\nunset key\n"
          "set label 1 'from above'\n"
          "set bmargin at screen 0.075\nset tmargin at screen 0.5628\n"
          "set xlabel 'x / m'\nset ylabel 'y / m' offset 1\nset yrange [-0.16:0.86]\n",
          gnuplot);
    plot_paths(gnuplot, "1:2", 0);
    fputs("unset multiplot\n", gnuplot);
    return end_plot(gnuplot, name);
}

/* ---- the cone -------------------------------------------------------------------------------- */

/* Per law: |p_t| and p_n, then p_t over p_n against the sliding before the impact and across it. */
static void put_impulses(FILE *gnuplot, const throw_record *records)
{
    for (int law = 0; law < CLI_LAWS; law++) {
        const double *p = records[law].first.info.impulse;
        const double *u = records[law].first.info.velocity_before;
        const double slip[3] = {u[1], u[2], 0.0};
        const double speed = tribo_vec3_norm(slip);
        const double tangent[3] = {p[1], p[2], 0.0};
        const double against = -(p[1] * u[1] + p[2] * u[2]) / speed;
        const double across = (p[1] * u[2] - p[2] * u[1]) / speed;
        fprintf(gnuplot, "$impulse%d << END\n%.6g %.6g %.6g %.6g\nEND\n", law,
                tribo_vec3_norm(tangent), p[0], against / p[0], across / p[0]);
    }
}

static void plot_impulses(FILE *gnuplot, const char *columns, int titles)
{
    for (int law = 0; law < CLI_LAWS; law++) {
        const plot_style *style = &STYLES[law];
        fprintf(gnuplot,
                ", $impulse%d using %s with points pointtype %d pointsize 1.3 linewidth 2 "
                "linecolor '%s'"
                " title '%s'",
                law, columns, style->point, style->colour, titles ? cli_law_names[law] : "");
    }
    fputc('\n', gnuplot);
}

int plot_cone(const char *folder, const char *name, const throw_record *records)
{
    FILE *gnuplot = begin_plot(folder, name, 1100, 600);
    const tumble scene = throw_scene(TRIBO_LAW_ALGEBRAIC);

    if (gnuplot == NULL)
        return CLI_BAD_INPUT;
    put_impulses(gnuplot, records);
    fprintf(gnuplot, "mus = %g\nmud = %g\n", scene.pair.mu_s, scene.pair.mu_d);
    fputs("set multiplot\n"
          "set label 2 'The impulse of the first impact, and the friction cone'"
          " at screen 0.53,0.955 center font ',19'\n"
          "set bmargin at screen 0.12\nset tmargin at screen 0.79\n"
          "set lmargin at screen 0.07\nset rmargin at screen 0.52\n"
          "set xrange [-2.4:3.2]\nset yrange [0:6.5]\nset xtics 1\n"
          "set xlabel 'friction impulse |p\u209c| / N s'\n"
          "set ylabel 'normal impulse p\u2099 / N s'\n"
          "set label 1 'friction cone' at 0,5.9 center textcolor '#5b7f9c'\n"
          "set label 3 '\u03bc_d' at -4.6*mud,4.6 left offset 1.2,0 textcolor '#5b7f9c'\n"
          "set label 4 '\u03bc_s' at -4.6*mus,4.6 right offset -1,0 textcolor '#5b7f9c'\n"
          "set object 1 polygon from 0,0 to 9*mud,9 to -9*mud,9 to 0,0 fillcolor '#e3eef7'"
          " fillstyle solid noborder behind\n"
          "set samples 1001\n"
          "plot abs(x) / mud with lines linecolor '#5b7f9c' linewidth 1.2"
          ", abs(x) / mus with lines linecolor '#5b7f9c' linewidth 1.2 dashtype 2",
          gnuplot);
    plot_impulses(gnuplot, "1:2", 0);
    fputs("unset label\nunset object\n"
          "set lmargin at screen 0.60\nset rmargin at screen 0.98\n"
          "set xrange [-0.45:0.59]\nset yrange [-0.5:0.5]\nset xtics 0.2\nset ytics 0.2\n"
          "set xlabel 'p\u209c / p\u2099 against the sliding before the impact'\n"
          "set ylabel 'p\u209c / p\u2099 across it'\n"
          "set label 1 'the cone from above' at graph 0.97,0.94 right textcolor '#5b7f9c'\n"
          "set object 1 circle at 0,0 size mud fillcolor '#e3eef7' fillstyle solid border"
          " linecolor '#5b7f9c' behind\n"
          "set object 2 circle at 0,0 size mus fillstyle empty border linecolor '#5b7f9c' dashtype "
          "2\n"
          "plot 1/0",
          gnuplot);
    plot_impulses(gnuplot, "3:4", 0);
    /* A panel of the whole width with nothing but the legend: gnuplot folds it to its panel. */
    fputs("unset label\nunset object\nunset border\nunset tics\nunset xlabel\nunset ylabel\n"
          "set lmargin at screen 0.02\nset rmargin at screen 0.98\nset xrange [9:10]\n"
          "set key at screen 0.53,0.87 center center horizontal maxrows 2 samplen 1 width 1\n"
          "plot 1/0",
          gnuplot);
    plot_impulses(gnuplot, "1:2", 1);
    fputs("unset multiplot\n", gnuplot);
    return end_plot(gnuplot, name);
}

/* ---- speed and error ------------------------------------------------------------------------- */

int plot_survey(const char *folder, const char *name, const survey_result *results)
{
    FILE *gnuplot = begin_plot(folder, name, 900, 560);

    if (gnuplot == NULL)
        return CLI_BAD_INPUT;
    for (int law = 0; law < CLI_LAWS; law++)
        fprintf(gnuplot, "$law%d << END\n%g %g %g\nEND\n", law, results[law].nanoseconds,
                results[law].median_eta, results[law].greatest_eta);
    fputs("set logscale xy\nset xrange [10:30000]\nset yrange [1e-17:10]\n"
          "set format y '10^{%T}'\nset ytics 1e4\nunset mytics\nset mxtics 10\n"
          "set title 'Speed against error of the impact laws' font ',19'\n"
          "set xlabel 'time per call / ns'\n"
          "set ylabel 'distance \u03b7 from Coulomb''s law: median and greatest'\n"
          "set key outside right center samplen 1\n"
          "plot 1/0",
          gnuplot);
    for (int law = 0; law < CLI_LAWS; law++) {
        const plot_style *style = &STYLES[law];
        fprintf(gnuplot,
                ", $law%d using 1:2:2:3 with yerrorbars pointtype %d pointsize 1.3 linewidth 1.6"
                " linecolor '%s' title '%s'",
                law, style->point, style->colour, cli_law_names[law]);
    }
    fputc('\n', gnuplot);
    return end_plot(gnuplot, name);
}

/* ---- manifolds ------------------------------------------------------------------------------- */

/* Axes of the picture in the world: right, up, and towards the eye. */
static const double VIEW[3][3] = {{0.85716730070211233, 0.51503807491005416, 0.0},
                                  {-0.20948485764513794, 0.34864135044192218, 0.91354545764260087},
                                  {0.47051069384706956, -0.78306129399618407, 0.40673664307580021}};

static void put_point(FILE *gnuplot, const double x[3])
{
    fprintf(gnuplot, "%.5g %.5g\n", tribo_vec3_dot(VIEW[0], x), tribo_vec3_dot(VIEW[1], x));
}

static void to_world(const tribo_pose *pose, const double local[3], double x[3])
{
    tribo_quat_rotate(pose->orientation, local, x);
    tribo_vec3_add(pose->position, x, x);
}

/* What is seen of a convex shape against the light: its support points around the view. */
static void put_silhouette(FILE *gnuplot, const tribo_shape *shape, const tribo_pose *pose)
{
    enum { STEPS = 180 };
    double way[3], local[3], point[3];

    for (int i = 0; i <= STEPS; i++) {
        const double angle = 6.2831853071795865 * i / STEPS;
        tribo_vec3_scale(cos(angle), VIEW[0], way);
        tribo_vec3_add_scaled(way, sin(angle), VIEW[1], way);
        tribo_quat_rotate_inverse(pose->orientation, way, local);
        if (tribo_shape_support(shape, local, point) == TRIBO_OK) {
            to_world(pose, point, point);
            put_point(gnuplot, point);
        }
    }
}

/* Faces of a polyhedron, each once: those that `side` of it shows the eye (1) or hides from it. */
static void put_faces(FILE *gnuplot, const tribo_shape *shape, const tribo_pose *pose, int side)
{
    enum { DIRECTIONS = 400, FACES = 32 };
    double points[3 * TRIBO_MAX_FACE], normals[FACES][3], x[3];
    uint32_t count = 0;

    for (int i = 0, faces = 0; i < DIRECTIONS && faces < FACES; i++) {
        /* A spiral from pole to pole, evenly spread. */
        const double z = 1.0 - (2.0 * i + 1.0) / DIRECTIONS, turn = 2.3999632297286533 * i;
        const double r = sqrt(1.0 - z * z), way[3] = {r * cos(turn), r * sin(turn), z};
        double *n = normals[faces];
        int known = 0;
        if (tribo_shape_face(shape, way, TRIBO_MAX_FACE, points, &count, n) != TRIBO_OK ||
            count < 3)
            continue;
        for (int k = 0; k < faces && !known; k++)
            known = tribo_vec3_dot(n, normals[k]) > 0.999;
        faces += !known;
        tribo_quat_rotate(pose->orientation, n, x);
        if (known || (tribo_vec3_dot(x, VIEW[2]) > 0.0) != side)
            continue;
        for (uint32_t k = 0; k <= count; k++) {
            to_world(pose, points + 3 * (k % count), x);
            put_point(gnuplot, x);
        }
        fputc('\n', gnuplot);
    }
}

/* A square of a half-space around the origin of its pose. */
static void put_square(FILE *gnuplot, const tribo_pose *pose)
{
    static const double corners[5][3] = {
        {-0.7, -0.7, 0.0}, {0.7, -0.7, 0.0}, {0.7, 0.7, 0.0}, {-0.7, 0.7, 0.0}, {-0.7, -0.7, 0.0}};
    double x[3];

    for (int i = 0; i < 5; i++) {
        to_world(pose, corners[i], x);
        put_point(gnuplot, x);
    }
}

/* Blocks of panel k: $base and $edges of B, $hidden, $shown and $outline of A, $patch and $normals
 * of the contact. */
static void put_scene(FILE *gnuplot, int k, const manifold_scene *scene)
{
    const tribo_shape *a = &scene->shapes[0], *b = &scene->shapes[1];
    const tribo_manifold *contact = &scene->manifold;
    double x[3];

    fprintf(gnuplot, "$base%d << END\n", k);
    if (b->type == TRIBO_SHAPE_HALFSPACE)
        put_square(gnuplot, &scene->poses[1]);
    else
        put_silhouette(gnuplot, b, &scene->poses[1]);
    fprintf(gnuplot, "END\n$edges%d << END\n", k);
    if (b->type != TRIBO_SHAPE_HALFSPACE)
        put_faces(gnuplot, b, &scene->poses[1], 1);
    fprintf(gnuplot, "END\n$outline%d << END\n", k);
    put_silhouette(gnuplot, a, &scene->poses[0]);
    for (int side = 0; side < 2; side++) {
        fprintf(gnuplot, "END\n$%s%d << END\n", side ? "shown" : "hidden", k);
        put_faces(gnuplot, a, &scene->poses[0], side);
    }
    fprintf(gnuplot, "END\n$patch%d << END\n", k);
    for (uint32_t i = 0; i <= contact->count; i++) {
        tribo_vec3_add(scene->poses[0].position, contact->points[i % contact->count].arm_a, x);
        put_point(gnuplot, x);
    }
    fprintf(gnuplot, "END\n$normals%d << END\n", k);
    for (uint32_t i = 0; i < contact->count; i++) {
        tribo_vec3_add(scene->poses[0].position, contact->points[i].arm_a, x);
        fprintf(gnuplot, "%.5g %.5g %.5g %.5g\n", tribo_vec3_dot(VIEW[0], x),
                tribo_vec3_dot(VIEW[1], x), 0.3 * tribo_vec3_dot(VIEW[0], contact->normal),
                0.3 * tribo_vec3_dot(VIEW[1], contact->normal));
    }
    fputs("END\n", gnuplot);
}

/* A panel without frame; a block without lines is left out, as gnuplot has no use for it. */
static void plot_scene(FILE *gnuplot, int k, const manifold_scene *scene)
{
    const int faces = scene->shapes[0].type != TRIBO_SHAPE_CAPSULE;
    const int box = scene->shapes[1].type != TRIBO_SHAPE_HALFSPACE;

    fprintf(gnuplot,
            "set lmargin at screen %g\nset rmargin at screen %g\nset title '%s' font ',16' offset "
            "0,-0.6\n"
            "plot $base%d with filledcurves closed fillcolor '#e8edf2' fillstyle solid border"
            " linecolor '#8fa3b3'",
            k / 3.0 + 0.01, (k + 1) / 3.0 - 0.01, scene->title, k);
    if (box)
        fprintf(gnuplot, ", $edges%d with lines linecolor '#8fa3b3' linewidth 1.4", k);
    if (faces)
        fprintf(gnuplot, ", $hidden%d with lines linecolor '#7fb2d6' linewidth 0.9 dashtype 2", k);
    fprintf(gnuplot,
            ", $patch%d with filledcurves closed fillcolor '#E69F00' fillstyle transparent solid"
            " 0.45 noborder, $patch%d with lines linecolor '#D55E00' linewidth 1.2",
            k, k);
    if (faces)
        fprintf(gnuplot, ", $shown%d with lines linecolor '#0072B2' linewidth 1.4", k);
    fprintf(gnuplot,
            ", $outline%d with lines linecolor '#0072B2' linewidth 1.8"
            ", $normals%d using 1:2:3:4 with vectors filled head linecolor '#000000' linewidth 1.6"
            ", $normals%d using 1:2 with points pointtype 7 pointsize 0.8 linecolor '#D55E00'\n",
            k, k, k);
}

int plot_manifolds(const char *folder, const char *name, const manifold_scene *scenes)
{
    FILE *gnuplot = begin_plot(folder, name, 1200, 360);

    if (gnuplot == NULL)
        return CLI_BAD_INPUT;
    for (int k = 0; k < MANIFOLD_SCENES; k++)
        put_scene(gnuplot, k, &scenes[k]);
    /* All panels have 181 pixels to the metre. */
    fputs("set multiplot\n"
          "set label 1 'Contact manifolds: the points, and the normal from the lower body to the"
          " upper one' at screen 0.5,0.945 center font ',19'\n"
          "unset border\nunset tics\nunset grid\n"
          "set bmargin at screen 0.02\nset tmargin at screen 0.805\n"
          "set xrange [-1.04:1.04]\nset yrange [-0.83:0.733]\n",
          gnuplot);
    for (int k = 0; k < MANIFOLD_SCENES; k++) {
        plot_scene(gnuplot, k, &scenes[k]);
        fputs("unset label\n", gnuplot);
    }
    fputs("unset multiplot\n", gnuplot);
    return end_plot(gnuplot, name);
}

/* ---- many contacts --------------------------------------------------------------------------- */

static void put_curves(FILE *gnuplot, const stack_result *result, int panel)
{
    for (int curve = 0; curve < STACK_CURVES; curve++) {
        fprintf(gnuplot, "$curve%d%d << END\n", panel, curve);
        for (int k = 0; k < STACK_POINTS; k++) {
            const tribo_system_info *info = &result->points[curve][k].info;
            fprintf(gnuplot, "%g %g\n", 1e6 * info->seconds, fmax(info->eta, 1e-17));
        }
        fputs("END\n", gnuplot);
    }
}

static void plot_curves(FILE *gnuplot, const stack_result *result, int panel)
{
    static const int styles[STACK_CURVES] = {2, 4, 0};
    const double left = 0.09 + 0.48 * (panel % 2), bottom = 0.55 - 0.46 * (panel / 2);

    fprintf(gnuplot,
            "set lmargin at screen %g\nset rmargin at screen %g\n"
            "set bmargin at screen %g\nset tmargin at screen %g\n"
            "set title '%s, %zu contacts' font ',15' offset 0,-0.6\n"
            "set xlabel '%s' offset 0,0.4\nset ylabel '%s'\nplot 1/0",
            left, left + 0.40, bottom, bottom + 0.33, result->title, result->contacts,
            panel / 2 > 0 ? "time / \u03bcs" : "",
            panel % 2 == 0 ? "greatest \u03b7 of a contact" : "");
    for (int curve = 0; curve < STACK_CURVES; curve++) {
        const plot_style *style = &STYLES[styles[curve]];
        fprintf(gnuplot,
                ", $curve%d%d with linespoints pointtype %d pointsize 0.8 linewidth 2 linecolor "
                "'%s' title '%s'",
                panel, curve, style->point, style->colour, panel == 0 ? stack_names[curve] : "");
    }
    fputc('\n', gnuplot);
}

/* Decades that hold all times. */
static void put_time_range(FILE *gnuplot, const stack_result *results)
{
    double low = HUGE_VAL, high = 0.0;

    for (int i = 0; i < STACK_SCENES * STACK_CURVES * STACK_POINTS; i++) {
        const stack_result *result = &results[i % STACK_SCENES];
        const int point = i / STACK_SCENES;
        const stack_point *p = &result->points[point / STACK_POINTS][point % STACK_POINTS];
        low = fmin(low, 1e6 * p->info.seconds);
        high = fmax(high, 1e6 * p->info.seconds);
    }
    fprintf(gnuplot, "set xrange [1e%g:1e%g]\n", floor(log10(low)), ceil(log10(high)));
}

int plot_stacks(const char *folder, const char *name, const stack_result *results)
{
    FILE *gnuplot = begin_plot(folder, name, 1000, 800);

    if (gnuplot == NULL)
        return CLI_BAD_INPUT;
    for (int i = 0; i < STACK_SCENES; i++)
        put_curves(gnuplot, &results[i], i);
    put_time_range(gnuplot, results);
    fputs("set multiplot\n"
          "set label 1 'Speed against error of many contacts, from a cold start' at screen "
          "0.5,0.965 center font ',19'\n"
          "set logscale xy\nset yrange [1e-17:10]\n"
          "set format x '10^{%T}'\nset format y '10^{%T}'\nset ytics 1e4\n"
          "unset mytics\nset mxtics 10\n"
          "set key bottom right samplen 2\n",
          gnuplot);
    for (int i = 0; i < STACK_SCENES; i++) {
        plot_curves(gnuplot, &results[i], i);
        fputs("unset label\n", gnuplot);
    }
    fputs("unset multiplot\n", gnuplot);
    return end_plot(gnuplot, name);
}
