/* Properties of the readers of the program: src/cli/table.h (CSV) and src/cli/problem.h. */
#define _GNU_SOURCE /* memfd_create: a file on disk would be thousands of times slower */

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "../src/cli/cli.h"
#include "../src/cli/problem.h"
#include "../src/cli/table.h"
#include "support/make.h"

enum { NAMES = 4, FIELDS = 7, ROWS = 5, TEXT = 8192 };

static const char *const names[NAMES] = {"wnn", "un", "mu_s", "e"};

/* ---- files and messages ------------------------------------------------------------------- */

/* A file without a name, and standard error into another while a reader is at work. */
typedef struct channel {
    FILE *input;
    FILE *messages;
    char path[32];
    char message[1024];
    int kept_error;
} channel;

static channel *the_channel(void)
{
    static channel p;
    if (p.input == NULL) {
        p.input = fdopen(memfd_create("input", 0), "wb+");
        p.messages = fdopen(memfd_create("messages", 0), "wb+");
        if (p.input == NULL || p.messages == NULL) {
            perror("memfd_create");
            abort();
        }
        snprintf(p.path, sizeof p.path, "/dev/fd/%d", fileno(p.input));
    }
    return &p;
}

static channel *begin(const char *text, size_t length)
{
    channel *p = the_channel();
    rewind(p->input);
    rewind(p->messages);
    if (ftruncate(fileno(p->input), 0) != 0 || ftruncate(fileno(p->messages), 0) != 0 ||
        fwrite(text, 1, length, p->input) != length || fflush(p->input) != 0) {
        perror("temporary file");
        abort();
    }
    rewind(p->input);
    fflush(stderr);
    p->kept_error = dup(STDERR_FILENO);
    dup2(fileno(p->messages), STDERR_FILENO);
    return p;
}

static void end(channel *p)
{
    fflush(stderr);
    dup2(p->kept_error, STDERR_FILENO);
    close(p->kept_error);
    rewind(p->messages);
    const size_t length = fread(p->message, 1, sizeof p->message - 1, p->messages);
    p->message[length] = '\0';
}

/* "tribo: FILE:LINE:COLUMN: text", one line of printable characters. */
static int read_place(const channel *p, unsigned long *line, unsigned long *column)
{
    const char *text = p->message;
    const size_t length = strlen(text);
    const size_t prefix = strlen("tribo: ") + strlen(p->path) + 1;
    char *rest;
    if (length < prefix || memcmp(text, "tribo: ", 7) != 0 ||
        memcmp(text + 7, p->path, strlen(p->path)) != 0 || text[prefix - 1] != ':') {
        return 0;
    }
    for (size_t i = 0; i + 1 < length; i++) {
        if (!isprint((unsigned char)text[i])) {
            return 0;
        }
    }
    *line = strtoul(text + prefix, &rest, 10);
    if (*rest != ':') {
        return 0;
    }
    *column = strtoul(rest + 1, &rest, 10);
    return *rest == ':' && text[length - 1] == '\n';
}

/* ---- what is taken ------------------------------------------------------------------------ */

typedef struct taken {
    table_row rows[ROWS + 1];
    unsigned count;
    unsigned stop; /* answer with 77 at this row */
} taken;

static int take(void *user, const table_row *row)
{
    taken *t = user;
    if (t->count <= ROWS) {
        t->rows[t->count] = *row;
    }
    t->count++;
    return t->count == t->stop ? 77 : 0;
}

/* ---- a table as text ---------------------------------------------------------------------- */

typedef struct text {
    char bytes[TEXT];
    size_t length;
    unsigned long line;
    unsigned long column;
} text;

static void put(text *x, const char *s)
{
    for (; *s != '\0' && x->length < TEXT - 1; s++) {
        x->bytes[x->length++] = *s;
        x->column++;
        if (*s == '\n') {
            x->line++;
            x->column = 1;
        }
    }
}

typedef struct table {
    uint32_t width;
    uint32_t rows;
    uint32_t asked[FIELDS]; /* which of the names a column has; NAMES: none */
    double values[ROWS][FIELDS];
    unsigned long lines[ROWS][FIELDS];
    unsigned long columns[ROWS][FIELDS];
    uint32_t style;
    text x;
} table;

/* The names in any order among other columns. */
static void make_columns(property_trial *t, table *b)
{
    b->width = NAMES + make_choice(t, "other columns", FIELDS - NAMES + 1);
    for (uint32_t i = 0; i < b->width; i++) {
        b->asked[i] = i < NAMES ? i : NAMES;
    }
    for (uint32_t i = b->width; i > 1; i--) {
        const uint32_t j = make_byte(t) % i;
        const uint32_t swap = b->asked[i - 1];
        b->asked[i - 1] = b->asked[j];
        b->asked[j] = swap;
    }
}

static void put_field(table *b, const char *s)
{
    const int quoted = (b->style & 1) != 0;
    put(&b->x, quoted ? "\"" : "");
    put(&b->x, s);
    put(&b->x, quoted ? "\"" : "");
}

static void put_end(table *b)
{
    put(&b->x, (b->style & 2) != 0 ? "\r\n" : "\n");
    if ((b->style & 4) != 0) {
        put(&b->x, (b->style & 2) != 0 ? "\r\n" : "\n"); /* a blank line is no row */
    }
}

static void put_header(table *b)
{
    if ((b->style & 8) != 0) {
        /* a byte order mark is no part of the text, but its bytes are counted by nobody */
        memcpy(b->x.bytes, "\xef\xbb\xbf", 3);
        b->x.length = 3;
    }
    for (uint32_t i = 0; i < b->width; i++) {
        put(&b->x, i == 0 ? "" : ",");
        put_field(b, b->asked[i] < NAMES ? names[b->asked[i]] : "other");
    }
    put_end(b);
}

static void put_number(table *b, uint32_t row, uint32_t i)
{
    char number[64];
    snprintf(number, sizeof number, (b->style & 16) != 0 ? "%a" : "%.17g", b->values[row][i]);
    b->lines[row][i] = b->x.line;
    b->columns[row][i] = b->x.column;
    put_field(b, number);
}

static void make_table(property_trial *t, table *b)
{
    memset(b, 0, sizeof *b);
    b->x.line = b->x.column = 1;
    b->style = make_byte(t);
    make_columns(t, b);
    b->rows = make_choice(t, "rows", ROWS + 1);
    put_header(b);
    for (uint32_t row = 0; row < b->rows; row++) {
        for (uint32_t i = 0; i < b->width; i++) {
            b->values[row][i] = make_any(t, "value");
            put(&b->x, i == 0 ? "" : ",");
            put_number(b, row, i);
        }
        put_end(b);
    }
}

static int same_number(double left, double right)
{
    return (isnan(left) && isnan(right)) || memcmp(&left, &right, sizeof left) == 0;
}

static void require_row(property_trial *t, const table *b, uint32_t row, const table_row *got)
{
    for (uint32_t i = 0; i < b->width; i++) {
        const uint32_t name = b->asked[i];
        if (name < NAMES) {
            REQUIRE(t, same_number(got->values[name], b->values[row][i]));
            REQUIRE(t, got->value_lines[name] == b->lines[row][i]);
            REQUIRE(t, got->value_columns[name] == b->columns[row][i]);
        }
    }
    REQUIRE(t, got->line == b->lines[row][0]);
}

/* What is written is read, to the bit, and its place too. */
static void table_rows(property_trial *t)
{
    static table b;
    static taken all;
    make_table(t, &b);
    memset(&all, 0, sizeof all);
    channel *p = begin(b.x.bytes, b.x.length);
    const int status = table_read(p->path, NAMES, names, take, &all);
    end(p);
    REQUIRE(t, status == 0 && all.count == b.rows && p->message[0] == '\0');
    for (uint32_t row = 0; row < b.rows; row++) {
        REQUIRE(t, strcmp(all.rows[row].file, p->path) == 0);
        require_row(t, &b, row, &all.rows[row]);
    }
    ASSUME(t, b.rows > 0);
    memset(&all, 0, sizeof all);
    all.stop = 1 + make_choice(t, "stop", b.rows);
    p = begin(b.x.bytes, b.x.length);
    const int stopped = table_read(p->path, NAMES, names, take, &all);
    end(p);
    REQUIRE(t, stopped == 77 && all.count == all.stop && p->message[0] == '\0');
}

/* ---- faults ------------------------------------------------------------------------------- */

/* (Blanks around a field that is not quoted are libcsv's, not the number's.) */
static const char *const not_numbers[] = {"",    "\" 1\"", "\"1 \"", "1x",     "one",   "1:5x",
                                          "--1", "1e999",  "0x",     "1e",     "+",     "1 2",
                                          "1_0", "\"",     "1;2",    "-1e999", "1.2.3", "\"1\n\""};

/* A row with one fault, after the good ones. The place that must be named. */
static uint32_t put_fault(property_trial *t, table *b, unsigned long *line, unsigned long *column)
{
    const uint32_t kind = make_choice(t, "fault", 3);
    uint32_t place = make_choice(t, "place", b->width);
    const uint32_t count = kind == 0 ? b->width : kind == 1 ? b->width + 1 : place + 1;
    const uint32_t bad = make_choice(t, "bad", (uint32_t)PROPERTY_COUNT(not_numbers));
    b->style &= ~1u;
    while (kind == 0 && b->asked[place] == NAMES) {
        place = (place + 1) % b->width;
    }
    for (uint32_t i = 0; i < count; i++) {
        put(&b->x, i == 0 ? "" : ",");
        if (kind == 1 ? i == b->width : i == place) {
            *line = b->x.line;
            *column = b->x.column;
        }
        put(&b->x, kind == 0 && i == place ? not_numbers[bad] : "7.5");
    }
    if (kind == 2) {
        *column = b->x.column;
    }
    put(&b->x, "\n7.5\n");
    return kind;
}

/* Wrong numbers, fields too many or too few: exit status and the right place; what came before
 * is taken. */
static void table_faults(property_trial *t)
{
    static table b;
    static taken all;
    unsigned long want[2] = {0, 0};
    unsigned long got[2];
    make_table(t, &b);
    const uint32_t kind = put_fault(t, &b, &want[0], &want[1]);
    ASSUME(t, kind != 2 || b.width > 1);
    memset(&all, 0, sizeof all);
    channel *p = begin(b.x.bytes, b.x.length);
    const int status = table_read(p->path, NAMES, names, take, &all);
    end(p);
    const int whole = kind == 2 && want[1] > 0 && all.count == b.rows + 1;
    ASSUME(t, !whole); /* "too few" happened to be all fields */
    REQUIRE(t, status == CLI_BAD_INPUT && all.count == b.rows);
    REQUIRE(t, read_place(p, &got[0], &got[1]));
    REQUIRE(t, got[0] == want[0] && got[1] == want[1]);
}

/* A name that is missing or comes twice. */
static void table_header_faults(property_trial *t)
{
    static table b;
    static taken all;
    unsigned long got[2];
    memset(&b, 0, sizeof b);
    b.x.line = b.x.column = 1;
    b.style = make_byte(t);
    make_columns(t, &b);
    const uint32_t place_of = make_choice(t, "place", b.width);
    const uint32_t name = b.asked[place_of];
    ASSUME(t, name < NAMES);
    b.asked[place_of] = make_choice(t, "twice", 2) == 1 ? (name + 1) % NAMES : NAMES;
    put_header(&b);
    memset(&all, 0, sizeof all);
    channel *p = begin(b.x.bytes, b.x.length);
    const int status = table_read(p->path, NAMES, names, take, &all);
    end(p);
    REQUIRE(t, status == CLI_BAD_INPUT && all.count == 0);
    REQUIRE(t, read_place(p, &got[0], &got[1]) && got[0] == 1);
}

/* ---- any bytes ---------------------------------------------------------------------------- */

static void require_place(property_trial *t, const channel *p, const char *bytes, size_t length)
{
    unsigned long got[2];
    unsigned long lines = 1;
    for (size_t i = 0; i < length; i++) {
        lines += bytes[i] == '\n';
    }
    REQUIRE(t, read_place(p, &got[0], &got[1]));
    REQUIRE(t, got[0] >= 1 && got[0] <= lines && got[1] >= 1 && got[1] <= length + 1);
}

/* Bytes as they stand in the input, after a header or not. */
static size_t make_bytes(property_trial *t, const char *before, char *bytes)
{
    size_t length = strlen(before);
    memcpy(bytes, before, length);
    while (t->used < t->size && length < TEXT) {
        bytes[length++] = (char)make_byte(t);
    }
    return length;
}

static void table_bytes(property_trial *t)
{
    static char bytes[TEXT + 1];
    static taken all;
    const int header = make_choice(t, "header", 2) == 1;
    const size_t length = make_bytes(t, header ? "un,wnn,other,e,mu_s\n" : "", bytes);
    memset(&all, 0, sizeof all);
    channel *p = begin(bytes, length);
    const int status = table_read(p->path, NAMES, names, take, &all);
    end(p);
    if (status == 0) {
        REQUIRE(t, p->message[0] == '\0');
        return;
    }
    REQUIRE(t, status == CLI_BAD_INPUT);
    require_place(t, p, bytes, length);
}

/* ---- problems of one contact -------------------------------------------------------------- */

static int written_once(const char *message)
{
    const char *end_of_line = strchr(message, '\n');
    return end_of_line != NULL && end_of_line[1] == '\0' && memcmp(message, "tribo: ", 7) == 0;
}

/* W, q and mu as Siconos writes them. */
static void problem_dense(property_trial *t)
{
    problem want;
    problem got;
    text x = {.line = 1, .column = 1};
    char number[64];
    make_matrix(t, "w", want.w);
    for (int i = 0; i < 9; i++) {
        want.w[i] = make_real(t, NULL, -20, 20);
    }
    make_vector(t, "q", -20, 20, want.q);
    want.mu = make_friction(t, "mu");
    put(&x, "3\n1\n\n0\n3\n3\n\n3\t3\n");
    for (int i = 0; i < 9; i++) {
        /* by columns */
        snprintf(number, sizeof number, "%.17e%s", want.w[3 * (i % 3) + i / 3],
                 i % 3 == 2 ? "\n" : "\t");
        put(&x, number);
    }
    for (int i = 0; i < 3; i++) {
        snprintf(number, sizeof number, "%.17e\t", want.q[i]);
        put(&x, number);
    }
    snprintf(number, sizeof number, "\n%.17e\n", want.mu);
    put(&x, number);
    channel *p = begin(x.bytes, x.length);
    const int status = problem_read(p->path, 0, &got);
    end(p);
    REQUIRE(t, status == 0 && p->message[0] == '\0');
    REQUIRE(t, property_same(got.w, want.w, sizeof want.w));
    REQUIRE(t, property_same(got.q, want.q, sizeof want.q) && got.mu == want.mu);
}

static void problem_bytes(property_trial *t)
{
    static char bytes[TEXT + 1];
    static const char *const starts[4] = {"", "3\n1\n0\n3 3 3 3\n1 0 0 0 1 0 0 0 1\n",
                                          "3\n1\n1\n1\n3\n3\n1\n", "3\n1\n2\n"};
    problem got;
    const uint32_t start = make_choice(t, "start", 4);
    const int global = make_choice(t, "global", 2) == 1;
    const size_t length = make_bytes(t, starts[start], bytes);
    channel *p = begin(bytes, length);
    const int status = problem_read(p->path, global, &got);
    end(p);
    REQUIRE(t, status == 0 ? p->message[0] == '\0' : written_once(p->message));
}

const char *const property_room = "table";
const property property_list[] = {
    {"table_rows", table_rows, 1},
    {"table_faults", table_faults, 1},
    {"table_header_faults", table_header_faults, 1},
    {"table_bytes", table_bytes, 1},
    {"problem_dense", problem_dense, 1},
    {"problem_bytes", problem_bytes, 1},
};
const size_t property_count = PROPERTY_COUNT(property_list);
const unsigned property_trials = 10000;
