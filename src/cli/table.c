#include "table.h"

#include <csv.h>
#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli.h"

enum { IGNORED = 0xff };

typedef struct reader {
    struct csv_parser parser;
    size_t count;
    const char *const *names;
    table_function take;
    void *user;
    table_row row;

    unsigned long line, column;             /* of the byte that is being read */
    unsigned long field_line, field_column; /* of the first byte of the present field */
    size_t field_bytes;
    size_t field;                                /* index of the present field in its row */
    size_t width;                                /* fields in the header; 0: not read yet */
    unsigned char targets[TABLE_FIELDS_AT_MOST]; /* by field: which of the names, or IGNORED */
    int exit_status;
} reader;

/* A field as it can be shown in one line of a message. */
static const char *shown(const char *text, size_t length, char buffer[44])
{
    const size_t end = length < 40 ? length : 40;

    for (size_t i = 0; i < end; i++) {
        const unsigned char c = (unsigned char)text[i];
        buffer[i] = (char)(isprint(c) ? c : '?');
    }
    memcpy(buffer + end, length > end ? "..." : "", length > end ? 4 : 1);
    return buffer;
}

static int error_at_field(const reader *r, const char *problem, const char *text, size_t length)
{
    char buffer[44];

    return cli_error_at(r->row.file, r->field_line, r->field_column, "\"%s\" %s",
                        shown(text, length, buffer), problem);
}

static size_t find_name(const reader *r, const char *text, size_t length)
{
    size_t i = 0;

    while (i < r->count &&
           (strlen(r->names[i]) != length || memcmp(r->names[i], text, length) != 0))
        i++;
    return i;
}

/* ---- what libcsv reports --------------------------------------------------------------------- */

static void take_name(reader *r, const char *text, size_t length)
{
    const size_t found = find_name(r, text, length);

    if (r->field == TABLE_FIELDS_AT_MOST) {
        r->exit_status = cli_error_at(r->row.file, r->field_line, r->field_column,
                                      "more than %d columns", (int)TABLE_FIELDS_AT_MOST);
        return;
    }
    r->targets[r->field] = found < r->count ? (unsigned char)found : IGNORED;
    for (size_t i = 0; i < r->field && found < r->count; i++) {
        if (r->targets[i] == found)
            r->exit_status = error_at_field(r, "names a column for the second time", text, length);
    }
}

static void take_number(reader *r, const char *text, size_t length)
{
    char *end = NULL;

    if (r->field >= r->width) {
        r->exit_status = cli_error_at(r->row.file, r->field_line, r->field_column,
                                      "more fields than the %zu of the header", r->width);
        return;
    }
    const unsigned char target = r->targets[r->field];
    if (target == IGNORED)
        return;
    errno = 0;
    const double value = strtod(text, &end);
    if (length == 0 || isspace((unsigned char)text[0]) || end != text + length)
        r->exit_status = error_at_field(r, "is not a number", text, length);
    else if (errno == ERANGE && fabs(value) > 1.0)
        r->exit_status = error_at_field(r, "is beyond the range of a double", text, length);
    r->row.values[target] = value;
    r->row.value_lines[target] = r->field_line;
    r->row.value_columns[target] = r->field_column;
}

static void on_field(void *text, size_t length, void *user)
{
    reader *r = user;

    if (r->exit_status != 0)
        return;
    if (r->field == 0)
        r->row.line = r->field_line;
    if (r->width == 0)
        take_name(r, text, length);
    else
        take_number(r, text, length);
    r->field++;
    r->field_bytes = 0;
}

static void end_header(reader *r)
{
    r->width = r->field;
    for (size_t i = 0; i < r->count && r->exit_status == 0; i++) {
        if (memchr(r->targets, (int)i, r->width) == NULL)
            r->exit_status =
                cli_error_at(r->row.file, r->row.line, 1, "there is no column \"%s\"", r->names[i]);
    }
}

/* Also called at the end of a blank line, which is no row. */
static void on_row(int terminator, void *user)
{
    reader *r = user;

    (void)terminator;
    if (r->exit_status == 0 && r->field > 0) {
        if (r->width == 0)
            end_header(r);
        else if (r->field < r->width)
            r->exit_status =
                cli_error_at(r->row.file, r->line, r->column,
                             "the row ends after %zu of %zu fields", r->field, r->width);
        else
            r->exit_status = r->take(r->user, &r->row);
    }
    r->field = 0;
    r->field_bytes = 0;
}

/* ---- bytes ----------------------------------------------------------------------------------- */

/* One byte at a time, so that its place is known whenever libcsv reports something. */
static void feed(reader *r, const char *byte)
{
    if (r->field_bytes == 0) {
        r->field_line = r->line;
        r->field_column = r->column;
    }
    r->field_bytes++;
    if (csv_parse(&r->parser, byte, 1, on_field, on_row, r) != 1 && r->exit_status == 0)
        r->exit_status =
            cli_error_at(r->row.file, r->line, r->column, "%s",
                         csv_error(&r->parser) == CSV_EPARSE ? "a quotation mark where none may be"
                                                             : csv_strerror(csv_error(&r->parser)));
    if (r->field_bytes > TABLE_BYTES_AT_MOST && r->exit_status == 0)
        r->exit_status = cli_error_at(r->row.file, r->field_line, r->field_column,
                                      "a field of more than %d bytes", (int)TABLE_BYTES_AT_MOST);
    r->column++;
    if (*byte == '\n') {
        r->line++;
        r->column = 1;
    }
}

/* A byte order mark, as spreadsheets write it, is not part of the first name. */
static size_t mark_length(const char *bytes, size_t length)
{
    return length >= 3 && memcmp(bytes, "\xef\xbb\xbf", 3) == 0 ? 3 : 0;
}

static void read_bytes(reader *r, FILE *stream)
{
    static char bytes[65536];
    int first = 1;
    size_t length;

    while (r->exit_status == 0 && (length = fread(bytes, 1, sizeof bytes, stream)) > 0) {
        for (size_t i = first ? mark_length(bytes, length) : 0; i < length && r->exit_status == 0;
             i++)
            feed(r, bytes + i);
        first = 0;
    }
    if (r->exit_status == 0 && ferror(stream))
        r->exit_status = cli_error_at(r->row.file, r->line, r->column, "%s", strerror(errno));
}

static void end_of_file(reader *r)
{
    if (r->exit_status == 0 && csv_fini(&r->parser, on_field, on_row, r) != 0 &&
        r->exit_status == 0)
        r->exit_status = cli_error_at(r->row.file, r->field_line, r->field_column,
                                      "a quotation mark is not closed");
    if (r->exit_status == 0 && r->width == 0)
        r->exit_status = cli_error_at(r->row.file, 1, 1, "there is no header");
}

int table_read(const char *file, size_t count, const char *const *names, table_function take,
               void *user)
{
    const unsigned char options = CSV_STRICT | CSV_STRICT_FINI | CSV_APPEND_NULL | CSV_REPALL_NL;
    const int standard = strcmp(file, "-") == 0;
    reader r = {.count = count, .names = names, .take = take, .user = user, .line = 1, .column = 1};
    FILE *stream = standard ? stdin : fopen(file, "rb");

    r.row.file = standard ? "<stdin>" : file;
    if (stream == NULL)
        return cli_error(CLI_BAD_INPUT, "%s: %s", file, strerror(errno));
    if (csv_init(&r.parser, options) != 0) {
        r.exit_status = cli_error(CLI_BAD_INPUT, "%s: the CSV parser cannot start", file);
    } else {
        read_bytes(&r, stream);
        end_of_file(&r);
        csv_free(&r.parser);
    }
    if (!standard)
        fclose(stream);
    return r.exit_status;
}
