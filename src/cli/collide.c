#include "collide.h"

#include <ctype.h>
#include <errno.h>
#include <getopt.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <tribo/collide.h>

#include "cli.h"

static const char USAGE[] =
    "usage: tribo collide FILE [--margin M]\n"
    "\n"
    "Find the contact manifold of each pair of shapes in FILE (-: standard input). One pair a "
    "line, words\n"
    "between blanks:\n"
    "  SHAPE POSE SHAPE POSE  the first is A, the second B\n"
    "SHAPE is one of these (half sizes, metres, axis z):\n"
    "  sphere r               capsule r h            cylinder r h           cone r h\n"
    "  box hx hy hz           ellipsoid a b c        hull n x1 y1 z1 ... xn yn zn\n"
    "  halfspace nx ny nz d   all points with n . x <= d\n"
    "POSE is px py pz qw qx qy qz: position, and orientation as a unit quaternion.\n"
    "Written are, line by line, 17 digits each:\n"
    "  status                 TRIBO_OK, or the status that says why there is no result\n"
    "  count                  of points, 0 (apart) to 4\n"
    "  nx ny nz               normal, from B to A; 0 0 0 without points\n"
    "  x y z distance         for each point: its place midway between the surfaces, and their "
    "distance\n"
    "                         along the normal, negative inside\n"
    "\n"
    "  --margin M             surfaces up to M apart count, too (0)\n"
    "\n"
    "A pair that the library refuses has a message on standard error, and makes the exit status 1 "
    "in the\n"
    "end. A malformed line ends the run.\n";

/* ---- words ----------------------------------------------------------------------------------- */

/* A buffer that grows and is used again. */
typedef struct room {
    void *bytes;
    size_t capacity;
} room;

typedef struct scanner {
    FILE *stream;
    int byte;             /* the next one, or EOF */
    unsigned long column; /* of it */
    unsigned long word_column;
    char word[COLLIDE_BYTES_AT_MOST + 1];
    size_t length; /* of the word; 0: the line ends */
    room points;
    room blocks[2];
    collide_pair pair;
    int exit_status;
} scanner;

static void advance(scanner *s)
{
    errno = 0;
    s->byte = getc(s->stream);
    s->column++;
    if (s->byte == EOF && ferror(s->stream) && s->exit_status == 0)
        s->exit_status = cli_error_at(s->pair.file, s->pair.line, s->column, "%s", strerror(errno));
}

static int at_end(const scanner *s)
{
    return s->byte == '\n' || s->byte == EOF;
}

static void complain(scanner *s, const char *problem)
{
    if (s->exit_status == 0)
        s->exit_status = cli_error_at(s->pair.file, s->pair.line, s->word_column, "%s", problem);
}

/* Shows the word in one line, or, if there is none, says that the line ends before `wanted`. */
static void complain_of_word(scanner *s, const char *problem, const char *wanted)
{
    if (s->exit_status != 0)
        return;
    for (size_t i = 0; i < s->length; i++) {
        if (!isprint((unsigned char)s->word[i]))
            s->word[i] = '?';
    }
    if (s->length == 0)
        s->exit_status = cli_error_at(s->pair.file, s->pair.line, s->word_column,
                                      "the line ends before %s", wanted);
    else
        s->exit_status = cli_error_at(s->pair.file, s->pair.line, s->word_column, "\"%.40s%s\" %s",
                                      s->word, s->length > 40 ? "..." : "", problem);
}

static void next_word(scanner *s)
{
    s->length = 0;
    if (s->exit_status != 0)
        return;
    while (!at_end(s) && isspace(s->byte))
        advance(s);
    s->word_column = s->column;
    while (!at_end(s) && !isspace(s->byte) && s->length < COLLIDE_BYTES_AT_MOST) {
        s->word[s->length++] = (char)s->byte;
        advance(s);
    }
    s->word[s->length] = '\0';
    if (!at_end(s) && !isspace(s->byte))
        complain_of_word(s, "is too long for a word", "");
}

static double next_number(scanner *s, const char *wanted)
{
    char *end = NULL;

    next_word(s);
    errno = 0;
    const double value = strtod(s->word, &end);
    if (s->length == 0 || end != s->word + s->length)
        complain_of_word(s, "is not a number", wanted);
    else if (errno == ERANGE && fabs(value) > 1.0)
        complain_of_word(s, "is beyond the range of a double", wanted);
    return value;
}

/* ---- shapes and poses ------------------------------------------------------------------------ */

typedef struct shape_form {
    const char *name;
    uint32_t type;
    const char *sizes[4];
} shape_form;

static const shape_form FORMS[] = {
    {"sphere", TRIBO_SHAPE_SPHERE, {"r of the sphere"}},
    {"box", TRIBO_SHAPE_BOX, {"hx of the box", "hy of the box", "hz of the box"}},
    {"capsule", TRIBO_SHAPE_CAPSULE, {"r of the capsule", "h of the capsule"}},
    {"cylinder", TRIBO_SHAPE_CYLINDER, {"r of the cylinder", "h of the cylinder"}},
    {"cone", TRIBO_SHAPE_CONE, {"r of the cone", "h of the cone"}},
    {"ellipsoid",
     TRIBO_SHAPE_ELLIPSOID,
     {"a of the ellipsoid", "b of the ellipsoid", "c of the ellipsoid"}},
    {"hull", TRIBO_SHAPE_HULL, {NULL}},
    {"halfspace",
     TRIBO_SHAPE_HALFSPACE,
     {"nx of the half-space", "ny of the half-space", "nz of the half-space",
      "d of the half-space"}},
};

static const char *const POSE[7] = {"px of a pose", "py of a pose", "pz of a pose", "qw of a pose",
                                    "qx of a pose", "qy of a pose", "qz of a pose"};

/* 0, or -1 after a message. */
static int make_room(scanner *s, room *r, size_t bytes)
{
    if (bytes <= r->capacity)
        return 0;
    const size_t capacity = bytes < 2 * r->capacity ? 2 * r->capacity : bytes;
    void *grown = realloc(r->bytes, capacity);
    if (grown == NULL) {
        complain(s, "out of memory");
        return -1;
    }
    r->bytes = grown;
    r->capacity = capacity;
    return 0;
}

/* A count alone takes no memory: the points have to be there. */
static size_t read_points(scanner *s)
{
    const double number = next_number(s, "n of the hull");

    if (!(number >= 0.0 && number <= COLLIDE_POINTS_AT_MOST && number == floor(number)))
        complain_of_word(s, "is not a whole number from 0 to 16777216", "n of the hull");
    const size_t count = s->exit_status == 0 ? 3 * (size_t)number : 0;
    for (size_t i = 0; i < count && s->exit_status == 0; i++) {
        const double value = next_number(s, "the last coordinate of the hull");
        if (make_room(s, &s->points, (i + 1) * sizeof value) == 0)
            ((double *)s->points.bytes)[i] = value;
    }
    return count / 3;
}

static void read_hull(scanner *s, collide_item *item, room *block)
{
    static const double none[3] = {0.0, 0.0, 0.0};
    const size_t count = read_points(s);
    size_t needed = 0;

    if (s->exit_status != 0)
        return;
    const double *points = count > 0 ? s->points.bytes : none;
    item->built = tribo_hull_build(count, points, block->bytes, block->capacity, &needed);
    if (item->built == TRIBO_ERROR_CAPACITY && make_room(s, block, needed) == 0)
        item->built = tribo_hull_build(count, points, block->bytes, block->capacity, NULL);
    item->shape.data = item->built == TRIBO_OK ? block->bytes : NULL;
}

static void read_shape(scanner *s, collide_item *item, room *block)
{
    size_t form = 0;

    next_word(s);
    item->shape_column = s->word_column;
    while (form < sizeof FORMS / sizeof FORMS[0] && strcmp(FORMS[form].name, s->word) != 0)
        form++;
    if (form == sizeof FORMS / sizeof FORMS[0] || strlen(s->word) != s->length) {
        complain_of_word(s, "is no shape; see tribo collide --help", "a shape");
        return;
    }
    item->shape.type = FORMS[form].type;
    for (size_t i = 0; i < 4 && FORMS[form].sizes[i] != NULL; i++)
        item->shape.size[i] = next_number(s, FORMS[form].sizes[i]);
    if (item->shape.type == TRIBO_SHAPE_HULL)
        read_hull(s, item, block);
}

static void read_pose(scanner *s, collide_item *item)
{
    double values[7];

    for (size_t i = 0; i < 7; i++) {
        values[i] = next_number(s, POSE[i]);
        if (i == 0)
            item->pose_column = s->word_column;
    }
    memcpy(item->pose.position, values, sizeof item->pose.position);
    memcpy(item->pose.orientation, values + 3, sizeof item->pose.orientation);
}

/* ---- lines ----------------------------------------------------------------------------------- */

static void read_line(scanner *s, collide_function take, void *user)
{
    while (!at_end(s) && isspace(s->byte))
        advance(s);
    if (at_end(s))
        return;
    memset(s->pair.items, 0, sizeof s->pair.items);
    for (size_t i = 0; i < 2; i++) {
        read_shape(s, &s->pair.items[i], &s->blocks[i]);
        read_pose(s, &s->pair.items[i]);
    }
    next_word(s);
    if (s->length > 0)
        complain_of_word(s, "stands after the two shapes and their poses", "");
    if (s->exit_status == 0)
        s->exit_status = take(user, &s->pair);
}

static void read_lines(scanner *s, collide_function take, void *user)
{
    do {
        s->pair.line++;
        s->column = 0;
        advance(s);
        read_line(s, take, user);
    } while (s->exit_status == 0 && s->byte != EOF);
}

int collide_read(const char *file, collide_function take, void *user)
{
    const int standard = strcmp(file, "-") == 0;
    scanner s = {.exit_status = 0};

    s.pair.file = standard ? "<stdin>" : file;
    s.stream = standard ? stdin : fopen(file, "rb");
    if (s.stream == NULL)
        return cli_error(CLI_BAD_INPUT, "%s: %s", file, strerror(errno));
    read_lines(&s, take, user);
    free(s.points.bytes);
    free(s.blocks[0].bytes);
    free(s.blocks[1].bytes);
    if (!standard)
        fclose(s.stream);
    return s.exit_status;
}

/* ---- the command ----------------------------------------------------------------------------- */

typedef struct collide_run {
    tribo_collide_options options;
    unsigned long pairs, refused;
} collide_run;

/* The column of what a status is about: a shape or a pose if it is wrong by itself. */
static unsigned long blamed_column(const collide_pair *pair)
{
    for (size_t i = 0; i < 2; i++) {
        const collide_item *item = &pair->items[i];
        double low[3], high[3];
        if (item->built != TRIBO_OK || tribo_shape_check(&item->shape) != TRIBO_OK)
            return item->shape_column;
        if (tribo_shape_bounds(&item->shape, &item->pose, low, high) != TRIBO_OK)
            return item->pose_column;
    }
    return pair->items[0].shape_column;
}

static void print_manifold(const collide_pair *pair, uint32_t found, const tribo_manifold *manifold)
{
    const double *from = pair->items[0].pose.position;
    const double *n = manifold->normal;

    if (found == 0) {
        printf("%s 0 0 0 0\n", tribo_status_name(TRIBO_OK));
        return;
    }
    printf("%s %u %.17g %.17g %.17g", tribo_status_name(TRIBO_OK), (unsigned)manifold->count, n[0],
           n[1], n[2]);
    for (uint32_t k = 0; k < manifold->count; k++) {
        const tribo_point *point = &manifold->points[k];
        printf(" %.17g %.17g %.17g %.17g", from[0] + point->arm_a[0], from[1] + point->arm_a[1],
               from[2] + point->arm_a[2], point->distance);
    }
    putchar('\n');
}

static int take_pair(void *user, const collide_pair *pair)
{
    collide_run *run = user;
    const collide_item *a = &pair->items[0], *b = &pair->items[1];
    tribo_manifold manifold;
    uint32_t found = 0;

    tribo_status status = a->built != TRIBO_OK ? a->built : b->built;
    if (status == TRIBO_OK)
        status = tribo_collide_shapes(&a->shape, &a->pose, &b->shape, &b->pose, &run->options, 1,
                                      &manifold, &found, NULL);
    run->pairs++;
    if (status == TRIBO_OK) {
        print_manifold(pair, found, &manifold);
    } else {
        run->refused++;
        printf("%s 0 0 0 0\n", tribo_status_name(status));
        cli_error_at(pair->file, pair->line, blamed_column(pair), "%s: %s",
                     tribo_status_name(status), tribo_status_string(status));
    }
    return 0;
}

static int run_collide(const char *file, double margin)
{
    collide_run run = {.options = {.struct_size = sizeof run.options, .margin = margin}};
    const int exit_status = collide_read(file, take_pair, &run);

    if (exit_status == 0 && run.refused > 0)
        return cli_error(CLI_BAD_INPUT, "%s: %lu of %lu pairs have no result", file, run.refused,
                         run.pairs);
    return exit_status;
}

int cli_collide(int argc, char **argv)
{
    static const struct option options[] = {{"margin", required_argument, NULL, 'm'},
                                            {"help", no_argument, NULL, 'h'},
                                            {NULL, 0, NULL, 0}};
    double margin = 0.0;
    int option;

    while ((option = getopt_long(argc, argv, "h", options, NULL)) != -1) {
        switch (option) {
        case 'm':
            if (cli_number("--margin", optarg, &margin) != 0)
                return CLI_USAGE;
            break;
        case 'h':
            fputs(USAGE, stdout);
            return EXIT_SUCCESS;
        default:
            return CLI_USAGE;
        }
    }
    if (margin < 0.0)
        return cli_error(CLI_USAGE, "--margin: %g is negative", margin);
    if (optind != argc - 1)
        return cli_error(CLI_USAGE, "collide: one FILE is needed; see tribo collide --help");
    return run_collide(argv[optind], margin);
}
