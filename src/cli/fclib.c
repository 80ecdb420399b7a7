#define _GNU_SOURCE /* MAP_ANONYMOUS */

#include "fclib.h"

#include <errno.h>
#include <hdf5.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "cli.h"

/* Bytes that both processes see: the reader fills it, the other one copies out of it. */
typedef struct arena {
    size_t size, used;
    int done;          /* 1: `given` is whole */
    char message[240]; /* else: why */
    recorded given;    /* points into the arena */
    double numbers[];
} arena;

enum { MIB = 1 << 20, PATH_AT_MOST = 64 };

/* ---- in the process of its own --------------------------------------------------------------- */

typedef struct reader {
    arena *shared;
    size_t length; /* of the file, which bounds how many numbers it can hold */
    hid_t file;
} reader;

/* Never returns. */
static void give_up(reader *r, const char *format, ...)
{
    va_list arguments;

    va_start(arguments, format);
    vsnprintf(r->shared->message, sizeof r->shared->message, format, arguments);
    va_end(arguments);
    _exit(CLI_BAD_INPUT);
}

static void *take(reader *r, size_t count, size_t size)
{
    const size_t need = (count * size + 15) / 16 * 16;

    if (need > r->shared->size - r->shared->used)
        give_up(r, "not enough memory");
    r->shared->used += need;
    return (char *)r->shared + r->shared->used - need;
}

/* Numbers of a data set: int32_t, which are clamped, or double. */
static void *read_numbers(reader *r, const char *path, H5T_class_t kind, size_t *count)
{
    const hid_t set = H5Dopen2(r->file, path, H5P_DEFAULT);
    const hid_t type = set < 0 ? -1 : H5Dget_type(set), space = set < 0 ? -1 : H5Dget_space(set);
    const hssize_t points = space < 0 ? -1 : H5Sget_simple_extent_npoints(space);

    if (set < 0)
        give_up(r, "%s: there is no such data set", path);
    if (type < 0 || H5Tget_class(type) != kind)
        give_up(r, "%s: the numbers are not %s", path, kind == H5T_FLOAT ? "real" : "whole");
    if (points < 0 || (size_t)points > r->length)
        give_up(r, "%s: more numbers than the file can hold", path);
    *count = (size_t)points;
    void *numbers = take(r, *count, kind == H5T_FLOAT ? sizeof(double) : sizeof(int32_t));
    if (H5Dread(set, kind == H5T_FLOAT ? H5T_NATIVE_DOUBLE : H5T_NATIVE_INT32, H5S_ALL, H5S_ALL,
                H5P_DEFAULT, numbers) < 0)
        give_up(r, "%s: it can not be read", path);
    H5Sclose(space);
    H5Tclose(type);
    H5Dclose(set);
    return numbers;
}

static const int32_t *read_wholes(reader *r, const char *group, const char *name, size_t least)
{
    char path[PATH_AT_MOST];
    size_t count = 0;

    snprintf(path, sizeof path, "%s/%s", group, name);
    const int32_t *numbers = read_numbers(r, path, H5T_INTEGER, &count);
    if (count < least)
        give_up(r, "%s: %zu numbers, %zu are needed", path, count, least);
    return numbers;
}

static double *read_reals(reader *r, const char *group, const char *name, size_t *count)
{
    char path[PATH_AT_MOST];

    snprintf(path, sizeof path, "%s/%s", group, name);
    double *numbers = read_numbers(r, path, H5T_FLOAT, count);
    for (size_t i = 0; i < *count; i++) {
        if (!isfinite(numbers[i]))
            give_up(r, "%s: number %zu (from 0) is not finite", path, i);
    }
    return numbers;
}

static double *read_vector(reader *r, const char *group, const char *name, size_t count)
{
    size_t got = 0;
    double *numbers = read_reals(r, group, name, &got);

    if (got != count)
        give_up(r, "%s/%s: %zu numbers instead of %zu", group, name, got, count);
    return numbers;
}

static uint32_t read_size(reader *r, const char *group, const char *name)
{
    const int32_t size = *read_wholes(r, group, name, 1);

    if (size < 0)
        give_up(r, "%s/%s: %ld is negative", group, name, (long)size);
    return (uint32_t)size;
}

static void add(reader *r, const char *group, entries *out, int32_t row, int32_t column,
                double value)
{
    if (row < 0 || column < 0 || (uint32_t)row >= out->rows || (uint32_t)column >= out->columns)
        give_up(r, "%s: the entry at row %ld, column %ld is outside of the matrix", group,
                (long)row, (long)column);
    entries_add(out, (uint32_t)row, (uint32_t)column, value); /* has room */
}

/* `count` rows (or columns) of places[starts[i]] to places[starts[i + 1] - 1]. */
static void add_compressed(reader *r, const char *group, entries *out, uint32_t count, int by_rows,
                           const double *values)
{
    const int32_t *starts = read_wholes(r, group, "p", (size_t)count + 1);

    for (uint32_t i = 0; i < count; i++) {
        if (starts[i] != 0 && (i == 0 || starts[i] < starts[i - 1]))
            give_up(r, "%s/p: number %lu (from 0) is less than the one before", group,
                    (unsigned long)i);
    }
    if (starts[count] < starts[count > 0 ? count - 1 : 0] || (size_t)starts[count] > out->room)
        give_up(r, "%s/p: it ends at %ld of %zu entries", group, (long)starts[count], out->room);
    const int32_t *places = read_wholes(r, group, "i", (size_t)starts[count]);
    for (uint32_t i = 0; i < count; i++) {
        for (int32_t k = starts[i]; k < starts[i + 1]; k++)
            add(r, group, out, by_rows ? (int32_t)i : places[k], by_rows ? places[k] : (int32_t)i,
                values[k]);
    }
}

/* CSparse's way of saying what is stored. */
enum { BY_COLUMNS = -1, BY_ROWS = -2 };

static void read_matrix(reader *r, const char *group, entries *out)
{
    const int32_t kind = *read_wholes(r, group, "nz", 1);
    const double *values = read_reals(r, group, "x", &out->room);

    out->rows = read_size(r, group, "m");
    out->columns = read_size(r, group, "n");
    out->places = take(r, out->room, 2 * sizeof *out->places);
    out->values = take(r, out->room, sizeof *out->values);
    if (kind >= 0) {
        if ((size_t)kind > out->room)
            give_up(r, "%s/x: %zu numbers, %ld are needed", group, out->room, (long)kind);
        const int32_t *rows = read_wholes(r, group, "i", (size_t)kind);
        const int32_t *columns = read_wholes(r, group, "p", (size_t)kind);
        for (int32_t k = 0; k < kind; k++)
            add(r, group, out, rows[k], columns[k], values[k]);
    } else if (kind == BY_COLUMNS) {
        add_compressed(r, group, out, out->columns, 0, values);
    } else if (kind == BY_ROWS) {
        add_compressed(r, group, out, out->rows, 1, values);
    } else {
        give_up(r, "%s/nz: %ld is no kind of matrix", group, (long)kind);
    }
}

static void expect_matrix(reader *r, const char *group, const entries *matrix, size_t rows,
                          size_t columns)
{
    if (matrix->rows != rows || matrix->columns != columns)
        give_up(r, "%s: the matrix is %lu x %lu instead of %zu x %zu", group,
                (unsigned long)matrix->rows, (unsigned long)matrix->columns, rows, columns);
}

static int has(reader *r, const char *path)
{
    return H5Lexists(r->file, path, H5P_DEFAULT) > 0;
}

static void refuse_bilateral(reader *r, const char *path)
{
    if (has(r, path))
        give_up(r, "%s: bilateral constraints are not known", path);
}

static void read_local(reader *r, recorded *out)
{
    const size_t rows = 3 * (size_t)out->contacts;

    refuse_bilateral(r, "/fclib_local/V");
    refuse_bilateral(r, "/fclib_local/R");
    out->q = read_vector(r, "/fclib_local/vectors", "q", rows);
    read_matrix(r, "/fclib_local/W", &out->matrix);
    expect_matrix(r, "/fclib_local/W", &out->matrix, rows, rows);
}

static void read_global(reader *r, recorded *out)
{
    const size_t rows = 3 * (size_t)out->contacts;
    size_t unknowns = 0;

    refuse_bilateral(r, "/fclib_global/G");
    out->q = read_vector(r, "/fclib_global/vectors", "w", rows);
    out->f = read_reals(r, "/fclib_global/vectors", "f", &unknowns);
    read_matrix(r, "/fclib_global/M", &out->matrix);
    expect_matrix(r, "/fclib_global/M", &out->matrix, unknowns, unknowns);
    read_matrix(r, "/fclib_global/H", &out->h);
    expect_matrix(r, "/fclib_global/H", &out->h, unknowns, rows);
}

static void read_problem(reader *r)
{
    recorded *out = &r->shared->given;
    const int local = has(r, "/fclib_local");
    const char *group = local ? "/fclib_local" : "/fclib_global";
    size_t contacts = 0;

    if (!local && !has(r, "/fclib_global"))
        give_up(r, "there is neither /fclib_local nor /fclib_global");
    const int32_t dimension = *read_wholes(r, group, "spacedim", 1);
    if (dimension != 3)
        give_up(r, "%s/spacedim: the problem is not in space: %ld instead of 3", group,
                (long)dimension);
    out->mu =
        read_reals(r, local ? "/fclib_local/vectors" : "/fclib_global/vectors", "mu", &contacts);
    if (contacts == 0 || contacts > INT32_MAX / 3)
        give_up(r, "%s/vectors/mu: there is no contact, or too many", group);
    out->contacts = (uint32_t)contacts;
    out->global = !local;
    if (local)
        read_local(r, out);
    else
        read_global(r, out);
}

/* Bytes of address space that this process has; 0 if the system does not say. */
static size_t address_space(void)
{
    FILE *stream = fopen("/proc/self/statm", "r");
    unsigned long pages = 0;

    if (stream == NULL)
        return 0;
    if (fscanf(stream, "%lu", &pages) != 1)
        pages = 0;
    fclose(stream);
    return (size_t)pages * (size_t)sysconf(_SC_PAGESIZE);
}

/* Never returns. */
static void run(arena *shared, const char *bytes, size_t length)
{
    reader r = {shared, length, -1};
    const size_t present = address_space();
    const rlim_t memory = present + 64 * (size_t)MIB + 16 * length;
    const rlim_t seconds = 20 + length / (4 * MIB);

    setrlimit(RLIMIT_CPU, &(struct rlimit){seconds, seconds});
    setrlimit(RLIMIT_CORE, &(struct rlimit){0, 0});
    if (present > 0)
        setrlimit(RLIMIT_AS, &(struct rlimit){memory, memory});
    /* A library that aborts says so; the message to the user is the other process's. */
    if (freopen("/dev/null", "w", stderr) == NULL)
        give_up(&r, "not enough memory");
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    if (access >= 0 && H5Pset_fapl_core(access, 65536, 0) >= 0 &&
        H5Pset_file_image(access, (void *)(size_t)bytes, length) >= 0)
        r.file = H5Fopen("problem", H5F_ACC_RDONLY, access);
    if (r.file < 0)
        give_up(&r, "it begins like an HDF5 file, but libhdf5 can not open it");
    read_problem(&r);
    shared->done = 1;
    _exit(0);
}

/* ---- in the process that asks for it --------------------------------------------------------- */

static void *copy(const void *from, size_t count, size_t size, int *failed)
{
    void *to = malloc((count + 1) * size);

    if (to == NULL)
        *failed = 1;
    else
        memcpy(to, from, count * size);
    return to;
}

static void copy_entries(const entries *from, entries *to, int *failed)
{
    *to = *from;
    to->room = from->count;
    to->places = copy(from->places, from->count, 2 * sizeof *to->places, failed);
    to->values = copy(from->values, from->count, sizeof *to->values, failed);
}

static int copy_out(const char *file, const recorded *from, recorded *out)
{
    const size_t rows = 3 * (size_t)from->contacts;
    int failed = 0;

    out->contacts = from->contacts;
    out->global = from->global;
    out->q = copy(from->q, rows, sizeof *out->q, &failed);
    out->mu = copy(from->mu, from->contacts, sizeof *out->mu, &failed);
    copy_entries(&from->matrix, &out->matrix, &failed);
    if (from->global) {
        copy_entries(&from->h, &out->h, &failed);
        out->f = copy(from->f, from->matrix.rows, sizeof *out->f, &failed);
    }
    return failed ? cli_error(CLI_BAD_INPUT, "%s: not enough memory", file) : 0;
}

static int judge(const char *file, int status, const arena *shared, recorded *out)
{
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0 && shared->done)
        return copy_out(file, &shared->given, out);
    if (shared->message[0] != '\0')
        return cli_error(CLI_BAD_INPUT, "%s: %s", file, shared->message);
    return cli_error(CLI_BAD_INPUT, "%s: it begins like an HDF5 file, but libhdf5 fails on it",
                     file);
}

int fclib_recognise(const char *bytes, size_t length)
{
    static const char signature[8] = {'\x89', 'H', 'D', 'F', '\r', '\n', '\x1a', '\n'};

    /* Behind a block of the user's own, which has a power of two as its size. */
    for (size_t at = 0; at + sizeof signature <= length; at = at > 0 ? 2 * at : 512) {
        if (memcmp(bytes + at, signature, sizeof signature) == 0)
            return 1;
    }
    return 0;
}

int fclib_read(const char *file, const char *bytes, size_t length, recorded *out)
{
    const size_t size = MIB + 64 * length;
    arena *shared =
        mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    int status = 0;

    if (shared == MAP_FAILED)
        return cli_error(CLI_BAD_INPUT, "%s: %s", file, strerror(errno));
    shared->size = size;
    shared->used = (sizeof *shared + 15) / 16 * 16;
    const pid_t child = fork();
    if (child == 0)
        run(shared, bytes, length);
    while (child > 0 && waitpid(child, &status, 0) < 0 && errno == EINTR)
        continue;
    const int exit_status = child > 0 ? judge(file, status, shared, out)
                                      : cli_error(CLI_BAD_INPUT, "%s: %s", file, strerror(errno));
    munmap(shared, size);
    return exit_status;
}
