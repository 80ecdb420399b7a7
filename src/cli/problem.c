#include "problem.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli.h"
#include "condense.h"
#include "dat.h"
#include "fclib.h"

enum { MIB = 1 << 20 };

/* The whole of a stream and a 0 after it; null if there is not enough memory or an error. */
static char *read_stream(FILE *stream, size_t *length)
{
    size_t room = 65536, used = 0, got = 1;
    char *bytes = malloc(room);

    while (bytes != NULL && got > 0) {
        got = fread(bytes + used, 1, room - used - 1, stream);
        used += got;
        if (room - used < room / 4) {
            char *more = realloc(bytes, room *= 2);
            if (more == NULL)
                free(bytes);
            bytes = more;
        }
    }
    if (bytes != NULL && ferror(stream)) {
        free(bytes);
        bytes = NULL;
    }
    if (bytes != NULL)
        bytes[used] = '\0';
    *length = used;
    return bytes;
}

static char *read_bytes(const char *file, size_t *length)
{
    const int standard = strcmp(file, "-") == 0;
    FILE *stream = standard ? stdin : fopen(file, "rb");
    char *bytes = NULL;

    if (stream == NULL) {
        cli_error(CLI_BAD_INPUT, "%s: %s", file, strerror(errno));
        return NULL;
    }
    errno = 0;
    bytes = read_stream(stream, length);
    if (bytes == NULL)
        cli_error(CLI_BAD_INPUT, "%s: %s", file,
                  errno != 0 ? strerror(errno) : "it can not be read");
    if (!standard)
        fclose(stream);
    return bytes;
}

int problem_read(const char *file, problem *out)
{
    size_t length = 0;
    char *bytes = read_bytes(file, &length);
    recorded given = {0};
    int exit_status = CLI_BAD_INPUT;

    *out = (problem){0};
    if (bytes == NULL)
        return CLI_BAD_INPUT;
    if (fclib_recognise(bytes, length))
        exit_status = fclib_read(file, bytes, length, &given);
    else
        exit_status = dat_read(file, bytes, length, &given);
    free(bytes);
    if (exit_status == 0)
        exit_status = condense(file, &given, 256 * (size_t)MIB + 64 * length, out);
    recorded_free(&given);
    return exit_status;
}

void problem_free(problem *given)
{
    free(given->row_starts);
    free(given->columns);
    free(given->blocks);
    free(given->q);
    free(given->mu);
    *given = (problem){0};
}
