/**
 * @file table.h
 * Tables of numbers in CSV (RFC 4180), read row by row with libcsv.
 *
 * The first row names the columns. Columns are found by name, in any order; columns that are not
 * asked for are ignored, since measurements often carry more than is needed. Everything else is
 * strict: each row has as many fields as the header, and what is asked for is a number and nothing
 * else (decimal or hexadecimal, also "nan" and "inf", which are judged by whoever gets them).
 */
#ifndef TRIBO_CLI_TABLE_H
#define TRIBO_CLI_TABLE_H

#include <stddef.h>

enum {
    TABLE_COLUMNS_AT_MOST = 16,  /**< that can be asked for */
    TABLE_FIELDS_AT_MOST = 1024, /**< in a row */
    TABLE_BYTES_AT_MOST = 4096   /**< in a field */
};

/** One row: the numbers in the order asked for, and where each of them stands. */
typedef struct table_row {
    const char *file;
    unsigned long line; /**< of the row's first field, from 1 */
    double values[TABLE_COLUMNS_AT_MOST];
    unsigned long value_lines[TABLE_COLUMNS_AT_MOST];
    unsigned long value_columns[TABLE_COLUMNS_AT_MOST]; /**< byte in its line, from 1 */
} table_row;

/** Takes a row; returns 0 to go on, else the exit status to end with. */
typedef int (*table_function)(void *user, const table_row *row);

/** Read `file` ("-": standard input) and give each row to `take`.
 *  @param count number of columns that are asked for, by `names`
 *  @return 0; CLI_BAD_INPUT after a message with file, line and column; or what `take` returned. */
int table_read(const char *file, size_t count, const char *const *names, table_function take,
               void *user);

#endif
