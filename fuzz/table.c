/* Properties of the readers of the program: src/cli/table.h (CSV) and src/cli/collide.h. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../src/cli/cli.h"
#include "../src/cli/collide.h"
#include "../src/cli/table.h"
#include "support/channel.h"
#include "support/make.h"

enum { NAMES = 4, FIELDS = 7, ROWS = 5, TEXT = 8192 };

static const char *const names[NAMES] = {"wnn", "un", "mu_s", "e"};

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

static int same_numbers(const double *left, const double *right, size_t count)
{
    int same = 1;
    for (size_t i = 0; i < count; i++) {
        same = same && same_number(left[i], right[i]);
    }
    return same;
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
    channel *p = channel_begin(b.x.bytes, b.x.length);
    const int status = table_read(p->path, NAMES, names, take, &all);
    channel_end(p);
    REQUIRE(t, status == 0 && all.count == b.rows && p->message[0] == '\0');
    for (uint32_t row = 0; row < b.rows; row++) {
        REQUIRE(t, strcmp(all.rows[row].file, p->path) == 0);
        require_row(t, &b, row, &all.rows[row]);
    }
    ASSUME(t, b.rows > 0);
    memset(&all, 0, sizeof all);
    all.stop = 1 + make_choice(t, "stop", b.rows);
    p = channel_begin(b.x.bytes, b.x.length);
    const int stopped = table_read(p->path, NAMES, names, take, &all);
    channel_end(p);
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
    channel *p = channel_begin(b.x.bytes, b.x.length);
    const int status = table_read(p->path, NAMES, names, take, &all);
    channel_end(p);
    const int whole = kind == 2 && want[1] > 0 && all.count == b.rows + 1;
    ASSUME(t, !whole); /* "too few" happened to be all fields */
    REQUIRE(t, status == CLI_BAD_INPUT && all.count == b.rows);
    REQUIRE(t, channel_place(p, &got[0], &got[1]));
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
    channel *p = channel_begin(b.x.bytes, b.x.length);
    const int status = table_read(p->path, NAMES, names, take, &all);
    channel_end(p);
    REQUIRE(t, status == CLI_BAD_INPUT && all.count == 0);
    REQUIRE(t, channel_place(p, &got[0], &got[1]) && got[0] == 1);
}

/* ---- any bytes ---------------------------------------------------------------------------- */

static void require_place(property_trial *t, const channel *p, const char *bytes, size_t length)
{
    unsigned long got[2];
    unsigned long lines = 1;
    for (size_t i = 0; i < length; i++) {
        lines += bytes[i] == '\n';
    }
    REQUIRE(t, channel_place(p, &got[0], &got[1]));
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
    channel *p = channel_begin(bytes, length);
    const int status = table_read(p->path, NAMES, names, take, &all);
    channel_end(p);
    if (status == 0) {
        REQUIRE(t, p->message[0] == '\0');
        return;
    }
    REQUIRE(t, status == CLI_BAD_INPUT);
    require_place(t, p, bytes, length);
}

/* ---- pairs of shapes ---------------------------------------------------------------------- */

enum { PAIRS = 3, HULL_POINTS = 5, WORDS = 2 * (2 + 3 * HULL_POINTS + 7) + 1 };

typedef struct shape_word {
    const char *name;
    uint32_t type;
    uint32_t sizes;
} shape_word;

static const shape_word shape_words[8] = {
    {"sphere", TRIBO_SHAPE_SPHERE, 1},       {"box", TRIBO_SHAPE_BOX, 3},
    {"capsule", TRIBO_SHAPE_CAPSULE, 2},     {"cylinder", TRIBO_SHAPE_CYLINDER, 2},
    {"cone", TRIBO_SHAPE_CONE, 2},           {"ellipsoid", TRIBO_SHAPE_ELLIPSOID, 3},
    {"halfspace", TRIBO_SHAPE_HALFSPACE, 4}, {"hull", TRIBO_SHAPE_HULL, 0}};

/* A line as words, and what they mean. */
typedef struct pair_line {
    char words[WORDS][40];
    uint32_t count;
    uint32_t shape_at[2]; /* index of the word */
    uint32_t pose_at[2];
    uint32_t points[2];
    double hull[2][3 * HULL_POINTS];
    tribo_shape shapes[2];
    tribo_pose poses[2];
    unsigned long line;
    unsigned long columns[WORDS + 1]; /* of the words, and of the end of the line */
} pair_line;

typedef struct pair_text {
    pair_line lines[PAIRS];
    uint32_t count;
    uint32_t style;
    text x;
} pair_text;

static double add_number(property_trial *t, uint32_t style, uint32_t plain, pair_line *l)
{
    const double value = plain ? make_real(t, "number", -2, 2) : make_any(t, "number");
    snprintf(l->words[l->count++], sizeof l->words[0], (style & 1) != 0 ? "%a" : "%.17g", value);
    return value;
}

static void make_item(property_trial *t, uint32_t style, uint32_t i, pair_line *l)
{
    const shape_word *word = &shape_words[make_choice(t, "shape", 8)];
    l->shape_at[i] = l->count;
    snprintf(l->words[l->count++], sizeof l->words[0], "%s", word->name);
    l->shapes[i].type = word->type;
    for (uint32_t k = 0; k < word->sizes; k++) {
        l->shapes[i].size[k] = add_number(t, style, 0, l);
    }
    if (word->type == TRIBO_SHAPE_HULL) {
        l->points[i] = make_choice(t, "points", HULL_POINTS + 1);
        snprintf(l->words[l->count++], sizeof l->words[0], "%u", (unsigned)l->points[i]);
        const uint32_t plain = make_choice(t, "plain", 2);
        for (uint32_t k = 0; k < 3 * l->points[i]; k++) {
            l->hull[i][k] = add_number(t, style, plain, l);
        }
    }
    l->pose_at[i] = l->count;
    for (uint32_t k = 0; k < 7; k++) {
        double *to = k < 3 ? &l->poses[i].position[k] : &l->poses[i].orientation[k - 3];
        *to = add_number(t, style, 0, l);
    }
}

/* The first `count` words of a line between blanks of any kind. */
static void put_words(pair_text *b, pair_line *l, uint32_t count)
{
    l->line = b->x.line;
    put(&b->x, (b->style & 2) != 0 ? " \t" : "");
    for (uint32_t i = 0; i < count; i++) {
        put(&b->x, i == 0 ? "" : (b->style & 4) != 0 ? "\t  " : " ");
        l->columns[i] = b->x.column;
        put(&b->x, l->words[i]);
    }
    put(&b->x, (b->style & 8) != 0 ? "\r" : "");
    l->columns[count] = b->x.column;
    put(&b->x, "\n");
    put(&b->x, (b->style & 16) != 0 ? "\n \t\n" : ""); /* lines without a word are no pairs */
}

static void make_line(property_trial *t, uint32_t style, pair_line *l)
{
    memset(l, 0, sizeof *l);
    make_item(t, style, 0, l);
    make_item(t, style, 1, l);
}

static void make_pairs(property_trial *t, pair_text *b)
{
    b->x.length = 0;
    b->x.line = b->x.column = 1;
    b->style = make_byte(t);
    b->count = make_choice(t, "pairs", PAIRS);
    for (uint32_t i = 0; i < b->count; i++) {
        make_line(t, b->style, &b->lines[i]);
        put_words(b, &b->lines[i], b->lines[i].count);
    }
}

/* What is taken has to be compared at once: blocks of hulls last no longer than the call. */
typedef struct pairs_taken {
    const pair_text *want; /* null: anything goes */
    uint32_t count;
    uint32_t different;
    uint32_t stop; /* answer with 77 at this pair */
} pairs_taken;

/* A hull is that of its points, or refused as they are. */
static int same_hull(const pair_line *l, uint32_t i, const collide_item *got)
{
    static double block[1 << 11]; /* aligned to 8 */
    size_t needed = 0;
    const tribo_status status =
        tribo_hull_build(l->points[i], l->hull[i], block, sizeof block, &needed);
    return got->built == status && (status == TRIBO_OK ? memcmp(got->shape.data, block, needed) == 0
                                                       : got->shape.data == NULL);
}

static int same_item(const pair_line *l, uint32_t i, const collide_item *got)
{
    const int hull = l->shapes[i].type == TRIBO_SHAPE_HULL;
    return got->shape.type == l->shapes[i].type && got->shape.count == 0 &&
           same_numbers(got->shape.size, l->shapes[i].size, 4) &&
           same_numbers(got->pose.position, l->poses[i].position, 3) &&
           same_numbers(got->pose.orientation, l->poses[i].orientation, 4) &&
           got->shape_column == l->columns[l->shape_at[i]] &&
           got->pose_column == l->columns[l->pose_at[i]] &&
           (hull ? same_hull(l, i, got) : got->built == TRIBO_OK && got->shape.data == NULL);
}

static int take_pair(void *user, const collide_pair *pair)
{
    pairs_taken *all = user;
    if (all->want != NULL && all->count < all->want->count) {
        const pair_line *l = &all->want->lines[all->count];
        all->different += pair->line != l->line || !same_item(l, 0, &pair->items[0]) ||
                          !same_item(l, 1, &pair->items[1]);
    }
    all->count++;
    return all->count == all->stop ? 77 : 0;
}

static int read_pairs(const text *x, pairs_taken *all)
{
    channel *p = channel_begin(x->bytes, x->length);
    const int status = collide_read(p->path, take_pair, all);
    channel_end(p);
    return status;
}

/* What is written is read, to the bit, and its place too. */
static void collide_rows(property_trial *t)
{
    static pair_text b;
    make_pairs(t, &b);
    pairs_taken all = {.want = &b};
    REQUIRE(t, read_pairs(&b.x, &all) == 0 && channel_get()->message[0] == '\0');
    REQUIRE(t, all.count == b.count && all.different == 0);
    ASSUME(t, b.count > 0);
    pairs_taken stopped = {.want = &b, .stop = 1 + make_choice(t, "stop", b.count)};
    REQUIRE(t, read_pairs(&b.x, &stopped) == 77 && channel_get()->message[0] == '\0');
    REQUIRE(t, stopped.count == stopped.stop);
}

static const char *const not_counts[] = {"-1", "2.5", "nan", "inf", "1e30", "16777217", "0x1p60"};
static const char *const no_words[] = {"x",       "1x", "1e999", "--1",  "0x",
                                       "sphere_", "1,", "1e",    "\x7f", "-1e999"};

/* A line with one fault, after the good ones. The index of the word that must be named. */
static uint32_t put_bad_line(property_trial *t, pair_text *b, pair_line *l)
{
    const uint32_t kind = make_choice(t, "fault", 4);
    const uint32_t place = make_choice(t, "place", l->count);
    const uint32_t bad = make_choice(t, "bad", (uint32_t)PROPERTY_COUNT(no_words));
    uint32_t at = place;
    if (kind == 0) {
        snprintf(l->words[at], sizeof l->words[0], "%s", no_words[bad]);
    } else if (kind == 1) { /* a word too many */
        at = l->count;
        snprintf(l->words[at], sizeof l->words[0], "%s", no_words[bad]);
        l->count++;
    } else if (kind == 2 && l->shapes[0].type == TRIBO_SHAPE_HULL) {
        at = 1;
        snprintf(l->words[at], sizeof l->words[0], "%s",
                 not_counts[bad % PROPERTY_COUNT(not_counts)]);
    } else { /* cut off */
        at = place > 0 ? place : 1;
        l->count = at;
    }
    put_words(b, l, l->count);
    return at;
}

/* Wrong words, words too many or too few: exit status and the right place; what came before is
 * taken. */
static void collide_faults(property_trial *t)
{
    static pair_text b;
    static pair_line bad;
    unsigned long got[2];
    make_pairs(t, &b);
    make_line(t, b.style, &bad);
    const uint32_t at = put_bad_line(t, &b, &bad);
    const unsigned long column = bad.columns[at];
    pairs_taken all = {.want = &b};
    REQUIRE(t, read_pairs(&b.x, &all) == CLI_BAD_INPUT);
    REQUIRE(t, all.count == b.count && all.different == 0);
    REQUIRE(t, channel_place(channel_get(), &got[0], &got[1]));
    REQUIRE(t, got[0] == bad.line && got[1] == column);
}

static void collide_bytes(property_trial *t)
{
    static char bytes[TEXT + 1];
    static const char *const starts[4] = {"", "sphere 1 0 0 0 1 0 0 0 ", "hull 4 0 0 0 1 0 0 0 1 ",
                                          "box 1 1 1 0 0 0 1 0 0 0 halfspace 0 0 1 0 0 0 0 1 0 "};
    const uint32_t start = make_choice(t, "start", 4);
    const size_t length = make_bytes(t, starts[start], bytes);
    pairs_taken all = {.want = NULL};
    channel *p = channel_begin(bytes, length);
    const int status = collide_read(p->path, take_pair, &all);
    channel_end(p);
    if (status == 0) {
        REQUIRE(t, p->message[0] == '\0');
        return;
    }
    REQUIRE(t, status == CLI_BAD_INPUT);
    require_place(t, p, bytes, length);
}

const char *const property_room = "table";
const property property_list[] = {
    {"table_rows", table_rows, 1},
    {"table_faults", table_faults, 1},
    {"table_header_faults", table_header_faults, 1},
    {"table_bytes", table_bytes, 1},
    {"collide_rows", collide_rows, 1},
    {"collide_faults", collide_faults, 1},
    {"collide_bytes", collide_bytes, 1},
};
const size_t property_count = PROPERTY_COUNT(property_list);
const unsigned property_trials = 10000;
